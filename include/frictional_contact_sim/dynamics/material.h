#pragma once
/**
 * @file material.h
 * @brief Friction and restitution of a pair: the pair's entry, else the smaller of both sides' values.
 */
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "frictional_contact_sim/dynamics/creep_law.h"

namespace frictional_contact_sim
{
struct Material
{
  double friction = 0.8;  ///< Coulomb coefficient [-] >= 0
  double restitution = 0.0;  ///< of the normal velocity, Moreau's rule [-] in [0, 1]
  std::shared_ptr<const CreepTable> creep = nullptr;  ///< pairs only: the creep law; none: Coulomb's
};

struct MaterialTable
{
  Material fallback;  ///< `default`: of every name without its own entry
  std::map<std::string, Material> materials;  ///< by name
  std::map<std::pair<std::string, std::string>, Material> pairs;  ///< names in alphabetical order

  /** @brief The material's own values. */
  const Material& find(const std::string& name) const;
};

/** @brief One side of a contact: its material, and a friction value of its own (URDF's mu1) or a negative number. */
struct SurfaceSide
{
  std::string material = "default";
  double friction = -1.0;
};

/** @brief Values of a pair. Called once for each pair of shapes at start, never in a step. */
Material pairMaterial(const MaterialTable& table, const SurfaceSide& a, const SurfaceSide& b);

}  // namespace frictional_contact_sim
