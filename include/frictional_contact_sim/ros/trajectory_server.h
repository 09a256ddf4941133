#pragma once
/**
 * @file trajectory_server.h
 * @brief ~command/trajectory and the action ~follow_joint_trajectory, as joint_trajectory_controller of ros_controllers
 * offers them.
 *
 * Both give trajectories to the simulator, which follows them in simulated time. Goals are looked at after each step in
 * the node's one thread; goals for different joints run side by side, a trajectory for one of its joints preempts a
 * goal.
 */
#include <actionlib/server/action_server.h>
#include <frictional_contact_sim/FollowJointTrajectoryAction.h>
#include <ros/node_handle.h>

#include <list>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/throttle.h"
#include "frictional_contact_sim/ros/trajectory_command.h"

namespace frictional_contact_sim
{
class TrajectoryServer
{
public:
  TrajectoryServer(ros::NodeHandle& private_node, Simulator& simulator, const NameTable& names,
                   const std::map<std::string, ServoGains>& servo_gains);

  /** @brief Goals: feedback, results. After each step, and after a reset. */
  void update();
  /** @brief Bodies have come or gone; goals for joints that are gone end. @param new_index see newJointIndices */
  void renumberJoints(const std::vector<int>& new_index);

private:
  using Server = actionlib::ActionServer<FollowJointTrajectoryAction>;
  using Handle = Server::GoalHandle;

  struct Goal
  {
    Handle handle;
    TrajectoryCommand command;
    std::vector<JointTolerance> path;  ///< one a joint
    std::vector<JointTolerance> end;  ///< one a joint
    double patience = 0.0;  ///< goal_time_tolerance [s]
    std::vector<double> last_velocities;  ///< of the step before
    FollowJointTrajectoryFeedback feedback;
    double next_feedback = 0.0;  ///< on the scenario's clock [s]
  };

  void receive(const trajectory_msgs::JointTrajectory& message);
  void acceptGoal(Handle handle);
  void cancelGoal(Handle handle);
  void give(const TrajectoryCommand& command);
  bool follows(const Goal& goal) const;
  bool isOver(Goal& goal);
  void compare(Goal& goal) const;
  std::string violated(const Goal& goal, const std::vector<JointTolerance>& tolerances) const;
  void abort(Goal& goal, int code, const std::string& line);
  void warn(const std::string& line);

  Simulator& simulator_;
  const NameTable& names_;
  const std::map<std::string, ServoGains>& servo_gains_;
  LineThrottle lines_;
  std::set<std::string> clamped_;  // joints that have had their warning
  std::list<Goal> goals_;
  ros::Subscriber subscriber_;
  Server server_;
};

}  // namespace frictional_contact_sim
