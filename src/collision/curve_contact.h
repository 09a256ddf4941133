#pragma once
/**
 * @file curve_contact.h
 * @brief Stationary points of the distance between a circle (rim of a cylinder) and a line, point or circle.
 *
 * Newton's method on the angle: exact to round-off, and regular also where the curves touch or have crossed, because
 * the equations are those of stationarity, not of distance.
 */
#include <Eigen/Core>

namespace frictional_contact_sim
{
struct Circle
{
  Eigen::Vector3d center;
  Eigen::Vector3d x;  ///< unit, in the plane
  Eigen::Vector3d y;  ///< unit, in the plane, across x
  double radius;

  Eigen::Vector3d at(double angle) const;
  Eigen::Vector3d tangent(double angle) const;  ///< derivative of at(): length = radius
  /** @brief Angle of the point of the circle farthest along a direction. */
  double farthest(const Eigen::Vector3d& direction) const;
};

/** @brief Angle where (p(angle) - q) is perpendicular to the tangent, q the nearest point on the line; from `angle`. */
double nearestToLine(const Circle& circle, const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                     double angle);

/** @brief Angles where the difference of the points is perpendicular to both tangents; Newton from the values given. */
void nearestOnCircles(const Circle& first, const Circle& second, double& angle_1, double& angle_2);

}  // namespace frictional_contact_sim
