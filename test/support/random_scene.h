#pragma once
/**
 * @file random_scene.h
 * @brief Random robots and scenes from a seed, as the text of a scenario and of its URDFs: what no one would think of.
 *
 * A robot is a tree of 1 to 25 links with every joint type of URDF, chains of mimic joints, limits (some start at one,
 * some exclude zero), dry friction, damping, servos and efforts, masses from grams to tons, inertias with their
 * triangle inequality, centres of mass off the origin, and box, sphere, cylinder, capsule as shapes. Bodies stand apart
 * at the start (touching bounding circles at the least, or one above the other); links of one body may overlap, which
 * the world then leaves out. Some scenes begin with a clamp: two jaws and a block that touches both. Even seeds are for
 * tuning, odd ones for judging. From MESH_SEEDS on most shapes are meshes (random_mesh.h), often of a single body: they
 * fall and rest alone, in piles and as the links and feet of robots.
 *
 * | mode      | what happens                                                                                      |
 * | --------- | ------------------------------------------------------------------------------------------------- |
 * | FREE_FALL | nothing can be reached: no ground, bodies far apart; some without gravity                         |
 * | DROP      | from up to 0.3 m with random pose, speed and spin                                                  |
 * | REST      | from up to 1 mm without speed, servos hold: settles, then its forces are looked at                |
 * | PUSH      | the same with a push in the middle that goes away                                                 |
 */
#include <cstdint>
#include <string>
#include <vector>

#include "support/random_robot.h"

namespace frictional_contact_sim
{
namespace test_support
{
enum class SceneMode
{
  FREE_FALL,
  DROP,
  REST,
  PUSH
};
const char* toString(SceneMode mode);

constexpr std::uint32_t MESH_SEEDS = 100000;

struct RandomScene
{
  std::uint32_t seed = 0;
  SceneMode mode = SceneMode::FREE_FALL;
  std::string scenario;  ///< JSON, which is YAML; names the URDF of body k as seed_SEED_k.urdf
  std::vector<std::string> bodies;  ///< each body's entry of `scenario`
  std::vector<std::string> urdfs;
  std::vector<NamedMesh> meshes;
  std::string head;  ///< of the scenario, without its bodies

  /** @brief Of the first `count` bodies and, where not empty, one more entry. */
  std::string with(int count, const std::string& more = "") const;
  std::string name() const;  ///< "seed_SEED_MODE"
};

/** @brief The same scene for the same seed. Mode: seed / 2 mod 4. */
RandomScene randomScene(std::uint32_t seed);

/** @brief Writes `scenario` as FOLDER/NAME.yaml, the URDFs and meshes beside it. @return the path of the scenario */
std::string writeScene(const RandomScene& scene, const std::string& folder, const std::string& scenario,
                       const std::string& name);

}  // namespace test_support
}  // namespace frictional_contact_sim
