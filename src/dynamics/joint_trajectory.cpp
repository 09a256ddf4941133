#include "frictional_contact_sim/dynamics/joint_trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
namespace
{
constexpr int FULL_ORDER = 5;

/** Index of the first point beyond `time`. */
size_t nextPoint(const std::vector<TrajectoryPoint>& points, double time)
{
  return static_cast<size_t>(std::upper_bound(
                                 points.begin(), points.end(), time,
                                 [](double value, const TrajectoryPoint& point) { return value < point.time; }) -
                             points.begin());
}

/**
 * The polynomial of b's order through a and b, `time` after a. Remainders of position, velocity and acceleration
 * after the Taylor part of a fix the higher coefficients.
 */
JointMotion interpolate(const TrajectoryPoint& a, const TrajectoryPoint& b, double time)
{
  const double length = b.time - a.time;
  const double s = time / length;
  const JointMotion& start = a.motion;
  const JointMotion& end = b.motion;
  if (b.order == 1)
  {
    const double slope = (end.position - start.position) / length;
    return {(1.0 - s) * start.position + s * end.position, slope, 0.0};
  }
  if (b.order == 3)
  {
    const double rise = end.position - start.position - length * start.velocity;
    const double turn = length * (end.velocity - start.velocity);
    const double c2 = 3.0 * rise - turn;
    const double c3 = turn - 2.0 * rise;
    return {start.position + time * start.velocity + s * s * (c2 + s * c3),
            start.velocity + s * (2.0 * c2 + 3.0 * s * c3) / length, (2.0 * c2 + 6.0 * s * c3) / (length * length)};
  }
  const double bend = length * length * start.acceleration;
  const double rise = end.position - start.position - length * start.velocity - 0.5 * bend;
  const double turn = length * (end.velocity - start.velocity) - bend;
  const double rest = length * length * (end.acceleration - start.acceleration);
  const double c3 = 10.0 * rise - 4.0 * turn + 0.5 * rest;
  const double c4 = -15.0 * rise + 7.0 * turn - rest;
  const double c5 = 6.0 * rise - 3.0 * turn + 0.5 * rest;
  return {
      start.position + time * (start.velocity + 0.5 * time * start.acceleration) + s * s * s * (c3 + s * (c4 + s * c5)),
      start.velocity + time * start.acceleration + s * s * (3.0 * c3 + s * (4.0 * c4 + 5.0 * s * c5)) / length,
      start.acceleration + s * (6.0 * c3 + s * (12.0 * c4 + 20.0 * s * c5)) / (length * length)};
}
}  // namespace

JointMotion JointTrajectory::at(double time) const
{
  const size_t next = nextPoint(points, time);
  if (next == 0)
    return {points.front().motion.position, 0.0, 0.0};
  if (next == points.size())
    return {points.back().motion.position, 0.0, 0.0};
  return interpolate(points[next - 1], points[next], time - points[next - 1].time);
}

void JointTrajectory::validate() const
{
  for (size_t k = 0; k < points.size(); ++k)
  {
    const TrajectoryPoint& point = points[k];
    const JointMotion& motion = point.motion;
    const std::string place = "point " + std::to_string(k) + " of a trajectory ";
    if (!std::isfinite(point.time) || !std::isfinite(motion.position) || !std::isfinite(motion.velocity) ||
        !std::isfinite(motion.acceleration))
      throw std::invalid_argument(place + "has a number that is not finite");
    if (k > 0 && !(point.time > points[k - 1].time))
      throw std::invalid_argument(place + "is at " + std::to_string(point.time) +
                                  " s, expected later than the one before");
    if (point.order != 1 && point.order != 3 && point.order != FULL_ORDER)
      throw std::invalid_argument(place + "has order " + std::to_string(point.order) + ", expected 1, 3 or 5");
  }
}

JointTrajectory continued(const JointTrajectory& present, const JointMotion& rest, double now, double begin,
                          const JointTrajectory& next)
{
  const double bridge = std::max(now, begin);
  JointTrajectory result;
  TrajectoryPoint cut;
  cut.time = bridge;
  if (present.empty())
  {
    cut.motion = bridge > now ? JointMotion{rest.position, 0.0, 0.0} : rest;
  }
  else
  {
    cut.motion = present.at(bridge);
    const size_t first = nextPoint(present.points, now);
    const size_t last = nextPoint(present.points, bridge);
    if (last < present.points.size())
      cut.order = present.points[last].order;  // a part of a polynomial is one of the same order
    for (size_t k = first == 0 ? 0 : first - 1; k < last; ++k)
      if (present.points[k].time < bridge)
        result.points.push_back(present.points[k]);
  }
  result.points.push_back(cut);
  int order = FULL_ORDER;  // all of the desired state is known
  for (const TrajectoryPoint& point : next.points)
  {
    if (!(point.time > bridge))
      continue;
    result.points.push_back(point);
    result.points.back().order = std::min(point.order, order);
    order = point.order;
  }
  return result;
}

}  // namespace frictional_contact_sim
