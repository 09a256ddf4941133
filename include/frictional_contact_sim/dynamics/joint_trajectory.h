#pragma once
/**
 * @file joint_trajectory.h
 * @brief The desired motion of one joint over time, as trajectory_msgs/JointTrajectory has it and as the
 * joint_trajectory_controller of ros_controllers follows it: between two points a polynomial of the order that both
 * determine.
 *
 *     order 1: positions       order 3: and velocities       order 5: and accelerations
 *
 * Before the first point and after the last one the joint is desired at rest there. On the scenario's clock.
 */
#include <cstddef>
#include <vector>

namespace frictional_contact_sim
{
struct JointMotion
{
  double position = 0.0;  ///< [rad] or [m]
  double velocity = 0.0;  ///< [rad/s] or [m/s]
  double acceleration = 0.0;  ///< [rad/s^2] or [m/s^2]
};

struct TrajectoryPoint
{
  double time = 0.0;  ///< [s]
  JointMotion motion;
  int order = 1;  ///< 1, 3 or 5: the polynomial that ends here; in a message: what the point gives
};

struct JointTrajectory
{
  std::vector<TrajectoryPoint> points;  ///< at increasing times

  bool empty() const { return points.empty(); }
  JointMotion at(double time) const;
  /** @throws std::invalid_argument unless all numbers are finite, times increase and orders are 1, 3 or 5 */
  void validate() const;
};

/**
 * @brief What is followed from `now` on when `next` is to begin at `begin`: the present trajectory until then, from its
 * desired state a bridge to the first point of `next` beyond, and the rest of `next`.
 * @param present may be empty: the joint is at `rest`, and stays there until `begin`
 * @param next its points' orders are what each of them gives; those not later than `begin` and `now` are left out
 */
JointTrajectory continued(const JointTrajectory& present, const JointMotion& rest, double now, double begin,
                          const JointTrajectory& next);

}  // namespace frictional_contact_sim
