#pragma once
/**
 * @file cross_matrix.h
 * @brief The cross product as a matrix.
 */
#include <Eigen/Core>

namespace frictional_contact_sim
{
/** @brief [x]x, 3 x 3 and skew, so that [x]x y is the cross product of x and y. */
inline Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& x)
{
  Eigen::Matrix3d result;
  result << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  return result;
}

}  // namespace frictional_contact_sim
