#include "frictional_contact_sim/ros/trajectory_command.h"

#include <frictional_contact_sim/FollowJointTrajectoryResult.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "frictional_contact_sim/ros/conversions.h"

namespace frictional_contact_sim
{
namespace
{
using Result = FollowJointTrajectoryResult;
using Point = trajectory_msgs::JointTrajectoryPoint;

constexpr size_t MOST_POINTS = 100000;
constexpr double FARTHEST_START = 3600.0;  ///< ahead of simulated time; wall clock would be for ever [s]
// Of points whose joint has no such limit: their polynomials stay finite.
constexpr double LARGEST_POSITION = 1e6;  ///< [rad] or [m]
constexpr double LARGEST_ACCELERATION = 1e6;  ///< [rad/s^2] or [m/s^2]

[[noreturn]] void fail(const std::string& line)
{
  throw TrajectoryError(Result::INVALID_GOAL, line);
}

/** @brief One number a joint, or none where the field is optional. */
void checkField(const std::vector<double>& values, size_t joints, bool optional, const std::string& field)
{
  if (values.size() != joints && !(optional && values.empty()))
    fail(field + ": found " + std::to_string(values.size()) + " numbers, expected " + std::to_string(joints) +
         ", one for each joint" + (optional ? ", or none" : ""));
  for (const double value : values)
    if (!std::isfinite(value))
      fail(field + ": found " + std::to_string(value) + ", expected a finite number");
}

void checkPoints(const trajectory_msgs::JointTrajectory& message)
{
  if (message.points.size() > MOST_POINTS)
    fail("points: found " + std::to_string(message.points.size()) + ", expected at most " +
         std::to_string(MOST_POINTS));
  ros::Duration last(0.0);
  for (size_t k = 0; k < message.points.size(); ++k)
  {
    const Point& point = message.points[k];
    const std::string place = "points[" + std::to_string(k) + "].";
    checkField(point.positions, message.joint_names.size(), false, place + "positions");
    checkField(point.velocities, message.joint_names.size(), true, place + "velocities");
    checkField(point.accelerations, message.joint_names.size(), true, place + "accelerations");
    if (point.velocities.empty() && !point.accelerations.empty())
      fail(place + "velocities: found none beside accelerations, expected one for each joint");
    if (point.time_from_start < last || (k > 0 && point.time_from_start == last))
    {
      std::ostringstream line;
      line << place << "time_from_start: found " << point.time_from_start.toSec() << " s, expected "
           << (k > 0 ? "later than the point before, at " : "at least ") << last.toSec() << " s";
      fail(line.str());
    }
    last = point.time_from_start;
  }
}

/** @brief What of a point one joint takes, in its limits. @return whether these had a say */
bool readPoint(const JointLimit& limit, const Point& point, size_t joint, TrajectoryPoint& read)
{
  JointMotion& motion = read.motion;
  const double position = point.positions[joint];
  motion.position =
      std::clamp(position, std::max(limit.lower, -LARGEST_POSITION), std::min(limit.upper, LARGEST_POSITION));
  bool same = motion.position == position;
  if (point.velocities.empty())
    return !same;
  read.order = 3;
  motion.velocity = reachableSpeed(limit, point.velocities[joint]);
  same = same && motion.velocity == point.velocities[joint];
  if (point.accelerations.empty())
    return !same;
  read.order = 5;
  motion.acceleration = std::clamp(point.accelerations[joint], -LARGEST_ACCELERATION, LARGEST_ACCELERATION);
  return !same || motion.acceleration != point.accelerations[joint];
}

/** @brief Start of the trajectory on the scenario's clock [s]. */
double beginOf(const Simulator& simulator, const trajectory_msgs::JointTrajectory& message)
{
  if (message.header.stamp.isZero())
    return simulator.scenarioTime();
  const double ahead = (message.header.stamp - toStamp(simulator.time())).toSec();
  if (ahead > FARTHEST_START)
    fail(
        "header.stamp is more than an hour ahead of simulated time, expected simulated time (is /use_sim_time set?) "
        "or zero");
  return simulator.scenarioTime() + ahead;
}

void readJoint(const Joint& joint, const trajectory_msgs::JointTrajectory& message, size_t index,
               TrajectoryCommand& command)
{
  JointTrajectory trajectory;
  for (const Point& point : message.points)
  {
    TrajectoryPoint& read = trajectory.points.emplace_back();
    read.time = command.begin + point.time_from_start.toSec();
    if (readPoint(joint.limit, point, index, read))
      command.clamped[message.joint_names[index]] =
          "joint '" + message.joint_names[index] + "': points of the trajectory are beyond its limits, which are taken";
  }
  try
  {
    trajectory.validate();  // times a nanosecond apart may be one in a long run
  }
  catch (const std::invalid_argument& error)
  {
    fail(error.what());
  }
  command.trajectories.push_back(trajectory);
}

}  // namespace

TrajectoryCommand readTrajectory(const Simulator& simulator, const NameTable& names,
                                 const trajectory_msgs::JointTrajectory& message)
{
  TrajectoryCommand command;
  try
  {
    command.joints = findJoints(names, message.joint_names);
  }
  catch (const CommandError& error)
  {
    throw TrajectoryError(Result::INVALID_JOINTS, error.what());
  }
  if (message.points.empty())
  {
    if (command.joints.empty())
      command.joints = names.actuated;
    return command;
  }
  if (command.joints.empty())
    throw TrajectoryError(Result::INVALID_JOINTS, "joint_names: found none, expected those that the points are of");
  checkPoints(message);
  command.begin = beginOf(simulator, message);
  for (size_t i = 0; i < command.joints.size(); ++i)
  {
    const JointHandle& handle = names.joints[command.joints[i]];
    readJoint(simulator.model(handle.body).joints[handle.joint], message, i, command);
  }
  command.end = command.trajectories.front().points.back().time;
  if (!(command.end > simulator.scenarioTime()))
    throw TrajectoryError(Result::OLD_HEADER_TIMESTAMP, "points: found none later than now, expected at least one");
  return command;
}

void giveTrajectory(const TrajectoryCommand& command, const NameTable& names,
                    const std::map<std::string, ServoGains>& servo_gains, Simulator& simulator)
{
  for (size_t i = 0; i < command.joints.size(); ++i)
  {
    const JointHandle& handle = names.joints[command.joints[i]];
    if (command.trajectories.empty())
      simulator.stopTrajectory(handle.body, handle.joint);
    else
      simulator.followTrajectory(handle.body, handle.joint, positionCommand(0.0, handle.name, servo_gains),
                                 command.begin, command.trajectories[i]);
  }
}

}  // namespace frictional_contact_sim
