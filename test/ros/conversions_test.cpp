#include "frictional_contact_sim/ros/conversions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/ros/command.h"

namespace frictional_contact_sim
{
namespace
{
BodySpec makeBody(const std::string& name, const std::string& urdf, double x)
{
  BodySpec body;
  body.name = name;
  body.urdf_path = std::string(PROJECT_DIR) + urdf;
  body.pose = Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 0.1));
  return body;
}

/** @brief The 10 kg box of the rostests, resting on the ground after 100 steps. */
Scenario boxScenario()
{
  Scenario scenario;
  scenario.solver = "gauss_seidel";
  scenario.stopping.tolerance = 1e-11;
  scenario.ground = GroundSpec();
  scenario.bodies = {makeBody("box", "/test/ros/box_10kg.urdf", 0.0)};
  return scenario;
}

/** @brief Two double pendulums on fixed bases: every name occurs twice. */
Scenario twinScenario()
{
  Scenario scenario;
  scenario.solver = "gauss_seidel";
  scenario.bodies = {makeBody("left", "/urdf/double_pendulum.urdf", -1.0),
                     makeBody("right", "/urdf/double_pendulum.urdf", 1.0)};
  for (BodySpec& body : scenario.bodies)
  {
    body.base = BaseType::FIXED;
  }
  return scenario;
}

TEST(StampTest, IsRoundedToNanoseconds)
{
  EXPECT_EQ(toStamp(0.001), ros::Time(0, 1000000));
  EXPECT_EQ(toStamp(0.001 * 999), ros::Time(0, 999000000));
  EXPECT_EQ(toStamp(12345.6789), ros::Time(12345, 678900000));
}

TEST(ConversionsTest, ContactForcesOfARestingBoxAreItsWeight)
{
  Simulator simulator(boxScenario());
  for (int k = 0; k < 100; ++k)
  {
    simulator.step();
  }
  const NameTable names = makeNameTable(simulator);
  ContactArray message;
  fillContacts(simulator, names, toStamp(simulator.time()), message);
  ASSERT_EQ(message.contacts.size(), 4u);
  EXPECT_EQ(message.header.stamp, ros::Time(0, 100000000));
  EXPECT_EQ(message.header.frame_id, "world");
  double force = 0.0;
  for (const Contact& contact : message.contacts)
  {
    const bool on_box = contact.body_a == "box";
    EXPECT_TRUE(on_box != (contact.body_b == "box"));
    EXPECT_EQ(on_box ? contact.link_b : contact.link_a, "ground");
    force += on_box ? contact.force.z : -contact.force.z;
    EXPECT_EQ(contact.mode, Contact::STICKING);
    // force = impulse / dt to round-off of one division
    EXPECT_NEAR(contact.force.z, contact.impulse.z / 0.001, 1e-12 * std::abs(contact.force.z));
    EXPECT_GE(contact.cone_margin, 0.0);
  }
  EXPECT_NEAR(force, 98.1, 1e-6);  // solver tolerance 1e-11 relative, far below
}

TEST(ConversionsTest, StepReportCopiesTheSummary)
{
  Simulator simulator(boxScenario());
  simulator.step();
  const StepSummary& summary = simulator.report();
  StepReport message;
  fillStepReport(summary, 0.5, ros::Time(1, 2), message);
  EXPECT_EQ(message.step, 1u);
  EXPECT_EQ(message.dt, 0.001);
  EXPECT_EQ(message.real_time_factor, 0.5);
  EXPECT_EQ(message.velocities, 6u);
  EXPECT_EQ(message.status, StepReport::CONVERGED);
  EXPECT_EQ(message.existence, StepReport::NOT_CHECKED);
  EXPECT_EQ(message.existence_margin, 0.0);  // no NaN goes out
  EXPECT_EQ(message.kinetic, summary.energy.kinetic);
  EXPECT_EQ(message.potential, summary.energy.potential);
}

TEST(ConversionsTest, OdometryTwistIsInTheChildFrame)
{
  Scenario scenario = boxScenario();
  scenario.ground.reset();
  scenario.gravity.setZero();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  scenario.bodies[0].pose = pose;
  scenario.bodies[0].linear_velocity = Eigen::Vector3d(1.0, 0.0, 0.0);
  Simulator simulator(scenario);
  simulator.step();
  const NameTable names = makeNameTable(simulator);
  nav_msgs::Odometry message;
  fillOdometry(simulator, names, 0, ros::Time(1, 0), message);
  EXPECT_EQ(message.child_frame_id, "box");
  // Free flight along world x, which is -y of a box turned by +90 degrees; round-off only.
  EXPECT_NEAR(message.pose.pose.position.x, 0.001, 1e-15);
  EXPECT_NEAR(message.twist.twist.linear.x, 0.0, 1e-15);
  EXPECT_NEAR(message.twist.twist.linear.y, -1.0, 1e-15);
  EXPECT_NEAR(message.pose.pose.orientation.z, std::sqrt(0.5), 1e-15);
}

TEST(ConversionsTest, OdometryOfAConveyorHasItsPrescribedMotion)
{
  Scenario scenario = boxScenario();
  scenario.ground.reset();
  scenario.bodies[0].base = BaseType::FIXED;
  scenario.bodies[0].pose = Eigen::Isometry3d(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()));
  scenario.bodies[0].motion.emplace(Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, 0.2));
  Simulator simulator(scenario);
  simulator.step();
  nav_msgs::Odometry message;
  fillOdometry(simulator, makeNameTable(simulator), 0, ros::Time(1, 0), message);
  // World x is -y of a box turned by +90 degrees, and by 0.0002 in the step; round-off beside that.
  EXPECT_NEAR(message.twist.twist.linear.x, -0.1 * std::sin(0.0002), 1e-15);
  EXPECT_NEAR(message.twist.twist.linear.y, -0.1 * std::cos(0.0002), 1e-15);
  EXPECT_NEAR(message.twist.twist.angular.z, 0.2, 1e-15);
  EXPECT_NEAR(message.pose.pose.position.x, 0.0001, 1e-15);
}

TEST(NamesTest, NamesThatOccurTwiceGetTheirRobot)
{
  const Simulator simulator(twinScenario());
  const NameTable names = makeNameTable(simulator);
  ASSERT_EQ(names.joints.size(), 4u);
  const std::string plain = simulator.model(0).joints.at(1).name;
  EXPECT_EQ(names.joints[0].name, "left/" + plain);
  EXPECT_EQ(names.joints[2].name, "right/" + plain);
  EXPECT_EQ(findJoint(names, "right/" + plain), 2);
  EXPECT_EQ(findJoint(names, plain), -1);
  EXPECT_EQ(names.actuated.size(), 4u);
  EXPECT_NE(names.roots[0], names.roots[1]);
}

TEST(NamesTest, AnUnambiguousJointIsAlsoUnderstoodWithItsRobot)
{
  Scenario scenario = twinScenario();
  scenario.bodies.pop_back();
  const Simulator simulator(scenario);
  const NameTable names = makeNameTable(simulator);
  EXPECT_EQ(findJoint(names, names.joints[1].name), 1);
  EXPECT_EQ(findJoint(names, "left/" + names.joints[1].name), 1);
  EXPECT_EQ(findJoint(names, "right/" + names.joints[1].name), -1);
}

TEST(JointStateTest, HasEveryJointInStableOrder)
{
  Scenario scenario = twinScenario();
  Simulator simulator(scenario);
  const NameTable names = makeNameTable(simulator);
  JointCommand command;
  command.target = 0.25;
  simulator.setCommand(1, names.joints[3].joint, command);
  simulator.step();
  sensor_msgs::JointState message;
  fillJointState(simulator, names, ros::Time(0, 1), message);
  ASSERT_EQ(message.name.size(), 4u);
  EXPECT_EQ(message.position[3], simulator.position(1)[1]);
  EXPECT_EQ(message.velocity[2], simulator.velocity(1)[0]);
  EXPECT_EQ(message.effort[3], 0.25);
  EXPECT_EQ(message.effort[2], 0.0);
}

TEST(CommandTest, IsTakenAsAWholeOrNotAtAll)
{
  const Simulator simulator(twinScenario());
  const NameTable names = makeNameTable(simulator);
  const std::string first = names.joints[0].name;
  const std::string second = names.joints[1].name;
  using Mode = JointCommand::Mode;
  const auto efforts = [&](const std::vector<std::string>& joints, const std::vector<double>& values)
  {
    sensor_msgs::JointState message;
    message.name = joints;
    message.effort = values;
    return namedTargets(names, Mode::EFFORT, message);
  };
  const std::vector<JointTarget> read = efforts({second, first}, {1.0, 2.0});
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].index, 1);
  EXPECT_EQ(read[0].target, 1.0);
  EXPECT_EQ(read[1].index, 0);
  EXPECT_EQ(read[1].target, 2.0);
  EXPECT_THROW(efforts({first, "nobody"}, {1.0, 2.0}), CommandError);
  EXPECT_THROW(efforts({first, first}, {1.0, 2.0}), CommandError);
  EXPECT_THROW(efforts({first, second}, {1.0}), CommandError);
  EXPECT_THROW(efforts({first}, {std::nan("")}), CommandError);
  EXPECT_EQ(orderedTargets(names, {1.0, 2.0, 3.0, 4.0}).size(), 4u);
  EXPECT_THROW(orderedTargets(names, {1.0}), CommandError);
  EXPECT_THROW(orderedTargets(names, {1.0, 2.0, 3.0, INFINITY}), CommandError);
}

TEST(CommandTest, FieldsBesideTheModesOwnAreTakenWholeOrLeftOut)
{
  using Mode = JointCommand::Mode;
  const Simulator simulator(twinScenario());
  const NameTable names = makeNameTable(simulator);
  sensor_msgs::JointState message;
  message.name = {names.joints[0].name, names.joints[1].name};
  message.position = {0.1, 0.2};
  message.velocity = {1.0, 2.0};
  message.effort = {10.0, 20.0};
  const JointTarget position = namedTargets(names, Mode::POSITION, message)[1];
  EXPECT_EQ(position.target, 0.2);
  EXPECT_EQ(position.rate, 2.0);
  EXPECT_EQ(position.feedforward, 20.0);
  const JointTarget velocity = namedTargets(names, Mode::VELOCITY, message)[1];
  EXPECT_EQ(velocity.target, 2.0);
  EXPECT_EQ(velocity.rate, 0.0);
  EXPECT_EQ(velocity.feedforward, 20.0);
  const JointTarget effort = namedTargets(names, Mode::EFFORT, message)[1];
  EXPECT_EQ(effort.target, 20.0);
  EXPECT_EQ(effort.feedforward, 0.0);
  message.velocity = {1.0};
  EXPECT_THROW(namedTargets(names, Mode::POSITION, message), CommandError);
  EXPECT_NO_THROW(namedTargets(names, Mode::EFFORT, message));
  message.velocity = {1.0, INFINITY};
  EXPECT_THROW(namedTargets(names, Mode::POSITION, message), CommandError);
  message.velocity.clear();
  EXPECT_EQ(namedTargets(names, Mode::POSITION, message)[0].rate, 0.0);
}

TEST(CommandTest, AJointsOwnGainsComeBeforeTheDefault)
{
  std::map<std::string, ServoGains> gains;
  EXPECT_TRUE(std::isnan(positionCommand(0.1, "knee", gains).kp));
  gains["default"].kp = 10.0;
  gains["knee"].kp = 20.0;
  EXPECT_EQ(positionCommand(0.1, "knee", gains).kp, 20.0);
  EXPECT_EQ(positionCommand(0.1, "hip", gains).kp, 10.0);
}

/** @brief Effort of the last joint of two pendulums, one step after a command to it. */
double effortAfter(const JointCommand& command)
{
  Simulator simulator(twinScenario());
  simulator.setCommand(1, makeNameTable(simulator).joints[3].joint, command);
  simulator.step();
  return simulator.effort(1, makeNameTable(simulator).joints[3].joint);
}

TEST(CommandTest, AServosEffortLimitDoesNotCutACommandedEffort)
{
  std::map<std::string, ServoGains> gains;
  gains["default"] = {100.0, 1.0, 0.1};
  EXPECT_EQ(effortAfter(positionCommand(1.0, "knee", gains)), 0.1);  // asked for some 100 N m
  EXPECT_EQ(effortAfter(effortCommand(0.25)), 0.25);
}

TEST(LinkContactsTest, TheLinkIsSideAOfEach)
{
  // Two boxes, one on the other: what the lower one carries is on it, what carries it too.
  Scenario scenario = boxScenario();
  scenario.bodies.push_back(makeBody("upper", "/test/ros/box_10kg.urdf", 0.0));
  scenario.bodies[1].pose->translation().z() = 0.3;
  Simulator simulator(scenario);
  for (int k = 0; k < 300; ++k)
    simulator.step();
  const NameTable names = makeNameTable(simulator);
  const auto lift = [&](int body)
  {
    ContactArray message;
    message.contacts.resize(50);  // of some other step
    fillLinkContacts(simulator, names, body, 0, ros::Time(0, 1), message);
    double sum = 0.0;
    for (const Contact& contact : message.contacts)
    {
      EXPECT_EQ(names.bodies[body], contact.body_a);
      EXPECT_GT(contact.force.z * contact.normal.z, 0.0);  // a push, towards the link
      sum += contact.force.z;
    }
    return sum;
  };
  EXPECT_NEAR(98.1, lift(0), 1e-6);
  EXPECT_NEAR(98.1, lift(1), 1e-6);
}

TEST(NamesTest, FixedJointsHaveNamesAndTopicsTakeAnyName)
{
  const Simulator simulator(twinScenario());
  const NameTable names = makeNameTable(simulator);
  EXPECT_EQ("", names.frame_joints[0][0]);
  EXPECT_EQ("right/" + simulator.model(1).frames[1].joint, names.frame_joints[1][1]);
  EXPECT_EQ("left_foot_1/sole", topicName("left foot-1/sole"));
}

}  // namespace
}  // namespace frictional_contact_sim
