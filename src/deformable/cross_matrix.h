#pragma once
#include <Eigen/Core>

namespace frictional_contact_sim
{
/** [x]x, so that [x]x y = x x y. */
inline Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& x)
{
  Eigen::Matrix3d result;
  result << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  return result;
}

}  // namespace frictional_contact_sim
