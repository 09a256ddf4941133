#pragma once
/**
 * @file trajectory_command.h
 * @brief trajectory_msgs/JointTrajectory to trajectories of the simulator: a message is taken as a whole or not at all.
 */
#include <trajectory_msgs/JointTrajectory.h>

#include <map>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/joint_trajectory.h"
#include "frictional_contact_sim/ros/command.h"

namespace frictional_contact_sim
{
/** @brief Why a trajectory was refused, with the code that the action has for it. */
class TrajectoryError : public CommandError
{
public:
  TrajectoryError(int error_code, const std::string& line) : CommandError(line), code(error_code) {}
  int code;  ///< INVALID_GOAL, INVALID_JOINTS or OLD_HEADER_TIMESTAMP of FollowJointTrajectoryResult
};

struct TrajectoryCommand
{
  std::vector<int> joints;  ///< indices into NameTable::joints
  std::vector<JointTrajectory> trajectories;  ///< one a joint, on the scenario's clock; none: stop where it is desired
  double begin = 0.0;  ///< on the scenario's clock [s]
  double end = 0.0;  ///< of the last point [s]
  std::map<std::string, std::string> clamped;  ///< one line for each joint whose points were taken into its limits
};

/**
 * @brief Times of points count from header.stamp, which is simulated time; zero: from now. Positions and velocities are
 * taken into the joints' limits. Without points: the named joints (without names: all) stop.
 * @throws TrajectoryError unknown, mimic or double joint; no number for each joint; times that do not increase; a
 * number that is not finite; a start more than an hour ahead; no point later than now
 */
TrajectoryCommand readTrajectory(const Simulator& simulator, const NameTable& names,
                                 const trajectory_msgs::JointTrajectory& message);

/** @brief From the next step on. */
void giveTrajectory(const TrajectoryCommand& command, const NameTable& names,
                    const std::map<std::string, ServoGains>& servo_gains, Simulator& simulator);

}  // namespace frictional_contact_sim
