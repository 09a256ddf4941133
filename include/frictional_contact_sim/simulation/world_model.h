#pragma once
/**
 * @file world_model.h
 * @brief What a scenario's simulations share and none of them changes: bodies, hulls, pair table, and the state that a
 * scenario starts from. Load it once, simulate it as often and in as many threads as you like.
 */
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/dynamics/closure.h"
#include "frictional_contact_sim/dynamics/pair_table.h"
#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
struct WorldModel
{
  Scenario scenario;
  std::vector<BodyModel> bodies;
  std::vector<Closure> loops;  ///< those of the URDFs body by body, then the scenario's; those of spawned bodies last
  std::vector<std::string> loop_names;  ///< for messages
  std::vector<BodyState> start;  ///< of each body, before the impact solve of the start
  CollisionWorld collision;  ///< copies share its shapes
  std::vector<SurfaceSide> sides;  ///< by shape handle
  PairTable pairs;
  std::vector<std::string> warnings;  ///< from loading, one line each
  double loading_seconds = 0.0;
};

/** @throws ModelError, ScenarioError, std::invalid_argument with one line that names the body and what is wrong */
std::shared_ptr<const WorldModel> loadWorldModel(const Scenario& scenario);

/**
 * @brief `world` and one body more, the last; only that is loaded, meshes that are known are not read again. Warnings
 * are the new body's. Whether it overlaps others is for those to ask who know where they are now.
 * @param scenario the world's, with what has been changed since
 * @throws as loadWorldModel
 */
std::shared_ptr<const WorldModel> withBody(const WorldModel& world, const Scenario& scenario, const BodySpec& spec);
/** @brief `world` without a body; those behind it and their shapes move up. */
std::shared_ptr<const WorldModel> withoutBody(const WorldModel& world, const Scenario& scenario, int body);

}  // namespace frictional_contact_sim
