#include "frictional_contact_sim/ros/trajectory_server.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "frictional_contact_sim/ros/conversions.h"

namespace frictional_contact_sim
{
namespace
{
using Result = FollowJointTrajectoryResult;

constexpr double LINE_PERIOD = 1.0;  // of the same line [s]
constexpr size_t MOST_LINES = 10;
constexpr std::uint32_t QUEUE = 10;
constexpr double FEEDBACK_PERIOD = 0.05;  // [s simulated]
constexpr double TIME_ROUND_OFF = 1e-9;  // of a stamp [s]

Result makeResult(int code, const std::string& line)
{
  Result result;
  result.error_code = code;
  result.error_string = line;
  return result;
}

/** @brief One for each joint of the goal; zero where none is given. */
std::vector<JointTolerance> byJoint(const std::vector<JointTolerance>& given, const NameTable& names,
                                    const std::vector<int>& joints, const std::string& field)
{
  std::vector<JointTolerance> tolerances(joints.size());
  for (const JointTolerance& tolerance : given)
  {
    const auto found = std::find(joints.begin(), joints.end(), findJoint(names, tolerance.name));
    if (found == joints.end())
      throw TrajectoryError(Result::INVALID_JOINTS,
                            field + ": found joint '" + tolerance.name + "', expected one of the trajectory's");
    if (!std::isfinite(tolerance.position) || !std::isfinite(tolerance.velocity) ||
        !std::isfinite(tolerance.acceleration))
      throw TrajectoryError(Result::INVALID_GOAL, field + ": a number of joint '" + tolerance.name +
                                                      "' is not finite, expected a finite number");
    tolerances[static_cast<size_t>(found - joints.begin())] = tolerance;
  }
  return tolerances;
}

bool exceeds(double error, double tolerance)
{
  return tolerance > 0.0 && std::abs(error) > tolerance;
}

void resize(size_t joints, trajectory_msgs::JointTrajectoryPoint& point)
{
  point.positions.resize(joints);
  point.velocities.resize(joints);
  point.accelerations.resize(joints);
}

void set(size_t joint, const JointMotion& motion, trajectory_msgs::JointTrajectoryPoint& point)
{
  point.positions[joint] = motion.position;
  point.velocities[joint] = motion.velocity;
  point.accelerations[joint] = motion.acceleration;
}

}  // namespace

TrajectoryServer::TrajectoryServer(ros::NodeHandle& private_node, Simulator& simulator, const NameTable& names,
                                   const std::map<std::string, ServoGains>& servo_gains)
  : simulator_(simulator)
  , names_(names)
  , servo_gains_(servo_gains)
  , lines_(LINE_PERIOD, MOST_LINES)
  , subscriber_(private_node.subscribe<trajectory_msgs::JointTrajectory>(
        "command/trajectory", QUEUE,
        [this](const trajectory_msgs::JointTrajectory::ConstPtr& message) { receive(*message); }))
  , server_(
        private_node, "follow_joint_trajectory", [this](Handle handle) { acceptGoal(handle); },
        [this](Handle handle) { cancelGoal(handle); }, false)
{
  server_.start();
}

void TrajectoryServer::receive(const trajectory_msgs::JointTrajectory& message)
{
  try
  {
    give(readTrajectory(simulator_, names_, message));
    update();
  }
  catch (const std::exception& error)
  {
    warn(std::string("~command/trajectory: ignored: ") + error.what());
  }
}

void TrajectoryServer::give(const TrajectoryCommand& command)
{
  giveTrajectory(command, names_, servo_gains_, simulator_);
  for (const auto& [joint, line] : command.clamped)
    if (clamped_.insert(joint).second)
      ROS_WARN_STREAM(line << "; further ones of this joint are not shown");
}

void TrajectoryServer::acceptGoal(Handle handle)
{
  try
  {
    const FollowJointTrajectoryGoal& wanted = *handle.getGoal();
    Goal goal;
    goal.command = readTrajectory(simulator_, names_, wanted.trajectory);
    if (goal.command.trajectories.empty())
      throw TrajectoryError(Result::INVALID_GOAL, "trajectory.points: found none, expected at least one");
    goal.path = byJoint(wanted.path_tolerance, names_, goal.command.joints, "path_tolerance");
    goal.end = byJoint(wanted.goal_tolerance, names_, goal.command.joints, "goal_tolerance");
    goal.patience = std::max(0.0, wanted.goal_time_tolerance.toSec());
    goal.handle = handle;
    goal.feedback.joint_names = wanted.trajectory.joint_names;
    for (auto* point : {&goal.feedback.desired, &goal.feedback.actual, &goal.feedback.error})
      resize(goal.command.joints.size(), *point);
    for (const int joint : goal.command.joints)
    {
      const JointHandle& of = names_.joints[joint];
      goal.last_velocities.push_back(simulator_.velocity(of.body)[of.v_index]);
    }
    goal.next_feedback = simulator_.scenarioTime();
    give(goal.command);
    update();  // goals that it preempts end before it begins
    handle.setAccepted();
    goals_.push_back(std::move(goal));
  }
  catch (const TrajectoryError& error)
  {
    handle.setRejected(makeResult(error.code, error.what()), error.what());
  }
  catch (const std::exception& error)
  {
    handle.setRejected(makeResult(Result::INVALID_GOAL, error.what()), error.what());
  }
}

void TrajectoryServer::cancelGoal(Handle handle)
{
  const auto goal = std::find_if(goals_.begin(), goals_.end(), [&](const Goal& one) { return one.handle == handle; });
  if (goal == goals_.end())
    return;
  if (follows(*goal))
  {
    TrajectoryCommand stop;
    stop.joints = goal->command.joints;
    give(stop);
  }
  goal->handle.setCanceled(Result(), "canceled");
  goals_.erase(goal);
}

/** @brief False when another command, a reset or a loaded state has taken one of its joints. */
bool TrajectoryServer::follows(const Goal& goal) const
{
  for (size_t i = 0; i < goal.command.joints.size(); ++i)
  {
    const JointHandle& handle = names_.joints[goal.command.joints[i]];
    const JointTrajectory& present = simulator_.trajectory(handle.body, handle.joint);
    const TrajectoryPoint& end = goal.command.trajectories[i].points.back();
    if (present.empty() || present.points.back().time != end.time ||
        present.points.back().motion.position != end.motion.position)
      return false;
  }
  return true;
}

void TrajectoryServer::update()
{
  for (auto goal = goals_.begin(); goal != goals_.end();)
    goal = isOver(*goal) ? goals_.erase(goal) : std::next(goal);
}

void TrajectoryServer::renumberJoints(const std::vector<int>& new_index)
{
  for (auto goal = goals_.begin(); goal != goals_.end();)
  {
    for (int& joint : goal->command.joints)
      joint = new_index[static_cast<size_t>(joint)];
    const auto gone = [](int joint) { return joint < 0; };
    if (std::any_of(goal->command.joints.begin(), goal->command.joints.end(), gone))
    {
      const std::string line = "a joint is gone: its body was deleted";
      goal->handle.setAborted(makeResult(Result::INVALID_JOINTS, line), line);
      goal = goals_.erase(goal);
    }
    else
      ++goal;
  }
}

bool TrajectoryServer::isOver(Goal& goal)
{
  if (!follows(goal))
  {
    const std::string line = "preempted: another command, a reset or a loaded state has taken a joint";
    goal.handle.setCanceled(makeResult(Result::SUCCESSFUL, line), line);
    return true;
  }
  compare(goal);
  const double now = simulator_.scenarioTime();
  const double end = goal.command.end - TIME_ROUND_OFF;
  const std::string violation = now < goal.command.begin ? "" : violated(goal, now < end ? goal.path : goal.end);
  if (now < end)
  {
    if (violation.empty())
    {
      if (now < goal.next_feedback)
        return false;
      goal.next_feedback = now + FEEDBACK_PERIOD - TIME_ROUND_OFF;
      goal.handle.publishFeedback(goal.feedback);
      return false;
    }
    abort(goal, Result::PATH_TOLERANCE_VIOLATED, "path_tolerance: " + violation);
    return true;
  }
  if (violation.empty())
  {
    goal.handle.publishFeedback(goal.feedback);
    goal.handle.setSucceeded(makeResult(Result::SUCCESSFUL, ""));
    return true;
  }
  if (now < end + goal.patience)
    return false;
  abort(goal, Result::GOAL_TOLERANCE_VIOLATED, "goal_tolerance: " + violation);
  return true;
}

/** @brief Fills the goal's feedback with the state at the end of the step. */
void TrajectoryServer::compare(Goal& goal) const
{
  FollowJointTrajectoryFeedback& feedback = goal.feedback;
  feedback.header.stamp = toStamp(simulator_.time());
  const ros::Duration since(simulator_.scenarioTime() - goal.command.begin);
  for (auto* point : {&feedback.desired, &feedback.actual, &feedback.error})
    point->time_from_start = since;
  for (size_t i = 0; i < goal.command.joints.size(); ++i)
  {
    const JointHandle& handle = names_.joints[goal.command.joints[i]];
    const JointMotion desired = simulator_.desiredMotion(handle.body, handle.joint);
    const double velocity = simulator_.velocity(handle.body)[handle.v_index];
    const JointMotion actual{simulator_.position(handle.body)[handle.q_index], velocity,
                             (velocity - goal.last_velocities[i]) / simulator_.state().dt};
    goal.last_velocities[i] = velocity;
    set(i, desired, feedback.desired);
    set(i, actual, feedback.actual);
    set(i,
        {desired.position - actual.position, desired.velocity - actual.velocity,
         desired.acceleration - actual.acceleration},
        feedback.error);
  }
}

/** @brief The first tolerance that the goal's feedback exceeds, as a line; empty when there is none. */
std::string TrajectoryServer::violated(const Goal& goal, const std::vector<JointTolerance>& tolerances) const
{
  const trajectory_msgs::JointTrajectoryPoint& error = goal.feedback.error;
  for (size_t i = 0; i < tolerances.size(); ++i)
  {
    const JointTolerance& tolerance = tolerances[i];
    const std::pair<const char*, std::pair<double, double>> checks[] = {
        {"position", {error.positions[i], tolerance.position}},
        {"velocity", {error.velocities[i], tolerance.velocity}},
        {"acceleration", {error.accelerations[i], tolerance.acceleration}}};
    for (const auto& [quantity, numbers] : checks)
      if (exceeds(numbers.first, numbers.second))
      {
        std::ostringstream line;
        line << "joint '" << goal.feedback.joint_names[i] << "' is off by " << numbers.first << " in " << quantity
             << ", expected at most " << numbers.second;
        return line.str();
      }
  }
  return "";
}

/** @brief The joints hold what is desired now. */
void TrajectoryServer::abort(Goal& goal, int code, const std::string& line)
{
  TrajectoryCommand stop;
  stop.joints = goal.command.joints;
  give(stop);
  goal.handle.setAborted(makeResult(code, line), line);
}

void TrajectoryServer::warn(const std::string& line)
{
  if (lines_.pass(line, ros::WallTime::now().toSec()))
    ROS_WARN_STREAM(line);
}

}  // namespace frictional_contact_sim
