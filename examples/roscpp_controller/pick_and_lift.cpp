// pick_and_lift: a roscpp controller. The arm of the scenario pick_and_place grasps the part, lifts it and holds it.
//
// Joint positions and velocities go out a hundred times a simulated second; the fingers close with an effort. The arm's
// angles follow from where the wrist shall be: the hand points down, upper arm and forearm are of one length.
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <array>
#include <cmath>

namespace
{
using Angles = std::array<double, 4>;  // yaw, shoulder, elbow, wrist [rad]

constexpr double LINK = 0.35;  // of upper arm and forearm [m]
constexpr double SHOULDER_HEIGHT = 0.4;  // [m]
constexpr double REACH = 0.45;  // where the part lies [m]
constexpr double LOW = 0.115;  // of the wrist: fingers around the part [m]
constexpr double HIGH = 0.33;  // [m]
constexpr double GRIP = -16.0;  // half of it on each pad [N]
constexpr double SECONDS = 1.0;  // of a move

/** Joint angles that bring the wrist to a height. */
Angles posture(double height)
{
  const double z = height - SHOULDER_HEIGHT;
  const double bend = std::acos(std::hypot(REACH, z) / (2.0 * LINK));
  const double shoulder = std::atan2(-z, REACH) - bend;
  return {0.0, shoulder, 2.0 * bend, M_PI / 2.0 - shoulder - 2.0 * bend};
}

class Arm
{
public:
  explicit Arm(ros::NodeHandle& node)
    : positions_(node.advertise<sensor_msgs::JointState>("/simulator_node/command/position", 10))
    , efforts_(node.advertise<sensor_msgs::JointState>("/simulator_node/command/effort", 10))
    , at_(posture(HIGH))
  {
    while (ros::ok() && (positions_.getNumSubscribers() == 0 || efforts_.getNumSubscribers() == 0))
      ros::WallDuration(0.01).sleep();
  }

  /** A smooth way in joint angles: 6 s^5 - 15 s^4 + 10 s^3, at rest at both ends. */
  void move(const Angles& goal)
  {
    const ros::Time begin = ros::Time::now();
    ros::Rate rate(100);  // of simulated time: simulate.launch sets /use_sim_time
    for (double s = 0.0; s < 1.0 && ros::ok(); rate.sleep())
    {
      s = std::min(1.0, (ros::Time::now() - begin).toSec() / SECONDS);
      const double share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
      const double speed = 30.0 * s * s * (1.0 - s) * (1.0 - s) / SECONDS;
      sensor_msgs::JointState command;
      command.name = {"yaw", "shoulder", "elbow", "wrist"};
      for (size_t i = 0; i < goal.size(); ++i)
      {
        command.position.push_back(at_[i] + share * (goal[i] - at_[i]));
        command.velocity.push_back(speed * (goal[i] - at_[i]));
      }
      positions_.publish(command);
    }
    at_ = goal;
  }

  void grip(double effort)
  {
    sensor_msgs::JointState command;
    command.name = {"left_finger"};
    command.effort = {effort};
    efforts_.publish(command);
    ros::Duration(0.3).sleep();
  }

private:
  ros::Publisher positions_;
  ros::Publisher efforts_;
  Angles at_;
};
}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "pick_and_lift");
  ros::NodeHandle node;
  Arm arm(node);
  arm.move(posture(LOW));
  arm.grip(GRIP);
  arm.move(posture(HIGH));
  ROS_INFO("pick_and_lift: the part is up");
  return 0;
}
