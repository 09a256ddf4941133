#pragma once
/**
 * @file cylinder_feature.h
 * @brief Numbers of the points of a cylinder that carry contacts; cap 0 is at -z, cap 1 at +z.
 */
#include <Eigen/Core>
#include <array>
#include <cmath>

#include "frictional_contact_sim/collision/narrow_phase.h"

namespace frictional_contact_sim
{
constexpr int RIM_POINTS = 8;

/// Body-fixed points on the rim, every 45 degrees.
inline Feature fixedRimFeature(int cap, int k)
{
  return makeFeature(FeatureKind::CURVE, RIM_POINTS * cap + k);
}
/// The point of the rim that is lowest along the normal: it wanders in the body, its number persists.
inline Feature lowestRimFeature(int cap)
{
  return makeFeature(FeatureKind::CURVE, 2 * RIM_POINTS + cap);
}
/// A point on the curved side, where something crosses or touches the generator line.
inline Feature sideFeature(int k)
{
  return makeFeature(FeatureKind::CURVE, 2 * RIM_POINTS + 2 + k);
}
inline Feature capFeature(int cap)
{
  return makeFeature(FeatureKind::FACE, cap);
}

/// Unit vector of fixed rim point k in the cylinder frame; exact zeros and ones on the axes.
inline Eigen::Vector3d rimDirection(int k)
{
  static const double half = std::sqrt(0.5);
  static const std::array<double, RIM_POINTS> cosine = {1.0, half, 0.0, -half, -1.0, -half, 0.0, half};
  return {cosine[k], cosine[(k + 6) % RIM_POINTS], 0.0};
}
}  // namespace frictional_contact_sim
