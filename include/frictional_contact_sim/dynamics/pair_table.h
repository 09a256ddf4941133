#pragma once
/**
 * @file pair_table.h
 * @brief Friction and restitution by pair of shapes, from tables made when materials change.
 */
#include <vector>

#include "frictional_contact_sim/dynamics/material.h"

namespace frictional_contact_sim
{
class PairTable
{
public:
  PairTable() = default;
  /** @param sides one a shape handle */
  PairTable(const MaterialTable& materials, const std::vector<SurfaceSide>& sides);
  const Material& operator()(int shape_a, int shape_b) const
  {
    return table_[class_of_[shape_a] * classes_ + class_of_[shape_b]];
  }
  /** @brief True when pairs with the creep law have the friction of their curve, whose shape depends on it. */
  bool keepsCreepCurves() const;
  /** @brief True when some pair has the creep law. */
  bool hasCreep() const;

private:
  int classes_ = 0;
  std::vector<int> class_of_;
  std::vector<Material> table_;
};

}  // namespace frictional_contact_sim
