#pragma once
/**
 * @file material.h
 * @brief Friction and restitution of a pair: what was set for it, the pair's entry, else the smaller of both sides'
 * values.
 */
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/dynamics/creep_law.h"

namespace frictional_contact_sim
{
struct Material
{
  double friction = 0.8;  ///< Coulomb coefficient [-] >= 0
  double restitution = 0.0;  ///< of the normal velocity, Moreau's rule [-] in [0, 1]
  std::shared_ptr<const CreepTable> creep = nullptr;  ///< pairs only: the creep law; none: Coulomb's
  double tangential_restitution = 0.0;  ///< of the tangential velocity, within the cone [-] in [0, 1]

  bool bounces() const { return restitution > 0.0 || tangential_restitution > 0.0; }
};

struct SurfaceSide;

/** @brief Surfaces by what is not empty here: all of a material, of a body, or of a body's link. */
struct SurfaceGroup
{
  std::string material;
  std::string body;  ///< of the scenario
  std::string link;  ///< URDF link of the body
  bool holds(const SurfaceSide& side) const;
  bool operator==(const SurfaceGroup& other) const
  {
    return material == other.material && body == other.body && link == other.link;
  }
};

/** @brief What was set for a pair of groups while the simulation ran. */
struct PairRule
{
  SurfaceGroup a;
  SurfaceGroup b;
  double friction = 0.0;  ///< [-] >= 0
  std::optional<double> restitution;  ///< [-] in [0, 1]; none: as it is
  bool holds(const SurfaceSide& side_a, const SurfaceSide& side_b) const;
};

struct MaterialTable
{
  Material fallback;  ///< `default`: of every name without its own entry
  std::map<std::string, Material> materials;  ///< by name
  std::map<std::pair<std::string, std::string>, Material> pairs;  ///< names in alphabetical order
  std::vector<PairRule> rules;  ///< before all others; of two the later one

  /** @brief The material's own values. */
  const Material& find(const std::string& name) const;
};

/** @brief One side of a contact: its material, and a friction value of its own (URDF's mu1) or a negative number. */
struct SurfaceSide
{
  std::string material = "default";
  double friction = -1.0;
  std::string body = {};  ///< empty: the ground
  std::string link = {};
};

/** @brief Values of a pair. Called for each pair of classes at start and when a table changes, never in a step. */
Material pairMaterial(const MaterialTable& table, const SurfaceSide& a, const SurfaceSide& b);

}  // namespace frictional_contact_sim
