#pragma once
/**
 * @file elastic_spec.h
 * @brief A linear elastic body or a rod as a scenario describes it, and what is made of it.
 */
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/deformable/super_helix.h"

namespace frictional_contact_sim
{
/** @brief A rod, or one of four sources, by what is not empty: box, bar (length > 0), mesh, mass (with stiffness and
 * nodes). */
struct ElasticSpec
{
  std::optional<RodSpec> rod;
  std::vector<double> box;  ///< two sizes (x, z) or three [m] > 0
  double bar = 0.0;  ///< length [m]
  std::vector<int> cells;  ///< of box and bar, one number a size
  std::string mesh;  ///< path of a Gmsh file
  std::string mass;  ///< paths of matrices, and of the table of their nodes
  std::string stiffness;
  std::string nodes;
  ElasticMaterial material;  ///< of the first three
  double damping = 0.0;  ///< D = damping K [s] >= 0
  std::vector<std::string> fixed;  ///< supports: sides or groups, see nodesNamed
};

/** @throws ModelError in one line */
std::shared_ptr<const ElasticSolid> buildElastic(const std::string& name, const ElasticSpec& spec);

}  // namespace frictional_contact_sim
