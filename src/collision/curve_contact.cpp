#include "curve_contact.h"

#include <Eigen/Geometry>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr int MAX_NEWTON = 30;
constexpr double CONVERGED = 1e-16;  // [rad] a step below changes nothing
}  // namespace

Eigen::Vector3d Circle::at(double angle) const
{
  return center + radius * (std::cos(angle) * x + std::sin(angle) * y);
}

Eigen::Vector3d Circle::tangent(double angle) const
{
  return radius * (std::cos(angle) * y - std::sin(angle) * x);
}

double Circle::farthest(const Eigen::Vector3d& direction) const
{
  return std::atan2(direction.dot(y), direction.dot(x));
}

double nearestToLine(const Circle& circle, const Eigen::Vector3d& point, const Eigen::Vector3d& direction, double angle)
{
  const Eigen::Vector3d along = direction.normalized();
  const auto across = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d { return v - along * along.dot(v); };
  for (int k = 0; k < MAX_NEWTON; ++k)
  {
    const Eigen::Vector3d difference = across(circle.at(angle) - point);
    const Eigen::Vector3d tangent = across(circle.tangent(angle));
    const double slope = tangent.squaredNorm() - difference.dot(across(circle.at(angle) - circle.center));
    const double convex = tangent.squaredNorm();
    const double step = difference.dot(tangent) / (slope > 0.1 * convex ? slope : convex);
    if (!std::isfinite(step))
      break;
    angle -= step;
    if (std::abs(step) <= CONVERGED)
      break;
  }
  return angle;
}

void nearestOnCircles(const Circle& first, const Circle& second, double& angle_1, double& angle_2)
{
  for (int k = 0; k < MAX_NEWTON; ++k)
  {
    const Eigen::Vector3d p = first.at(angle_1);
    const Eigen::Vector3d q = second.at(angle_2);
    const Eigen::Vector3d d = p - q;
    const Eigen::Vector3d s = first.tangent(angle_1);
    const Eigen::Vector3d t = second.tangent(angle_2);
    const Eigen::Vector2d gradient(d.dot(s), -d.dot(t));
    const double h12 = -s.dot(t);
    double h11 = s.squaredNorm() - d.dot(p - first.center);
    double h22 = t.squaredNorm() + d.dot(q - second.center);
    if (h11 * h22 - h12 * h12 < 1e-3 * s.squaredNorm() * t.squaredNorm())  // Gauss-Newton, damped
    {
      h11 = 1.1 * s.squaredNorm();
      h22 = 1.1 * t.squaredNorm();
    }
    const double determinant = h11 * h22 - h12 * h12;
    const double step_1 = (h22 * gradient.x() - h12 * gradient.y()) / determinant;
    const double step_2 = (h11 * gradient.y() - h12 * gradient.x()) / determinant;
    if (!std::isfinite(step_1) || !std::isfinite(step_2))
      break;
    angle_1 -= step_1;
    angle_2 -= step_2;
    if (std::abs(step_1) <= CONVERGED && std::abs(step_2) <= CONVERGED)
      break;
  }
}

}  // namespace frictional_contact_sim
