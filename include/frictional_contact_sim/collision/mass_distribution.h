#pragma once
/**
 * @file mass_distribution.h
 * @brief Volume, centre and polar radius of gyration of a collision shape filled uniformly.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
struct MassDistribution
{
  double volume = 0.0;  ///< [m^3]; 0 for what has none (points, flat polygons, the half space)
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< shape frame [m]
  double gyration_squared = 0.0;  ///< mean squared distance from the centre: half the trace of inertia over mass [m^2]
};

MassDistribution fillUniformly(const ConvexShape& shape);

}  // namespace frictional_contact_sim
