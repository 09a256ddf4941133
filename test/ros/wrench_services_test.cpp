// ~apply_wrench, ~clear_wrenches and ~wrench: momentum of a free cube tells what acted, where and for how long.
#include "frictional_contact_sim/ros/wrench_services.h"

#include <cmath>
#include <functional>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "request_bench.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double ROUND_OFF = 1e-12;

ApplyWrench::Request push(double x, double y, double z)
{
  ApplyWrench::Request request;
  request.body = "crate";
  request.link = "box";
  request.wrench.force.x = x;
  request.wrench.force.y = y;
  request.wrench.force.z = z;
  request.duration = ros::Duration(0.0);
  return request;
}

class WrenchTest : public testing::Test
{
protected:
  WrenchTest() : bench_(robotAndBox(false)) {}
  void apply(const ApplyWrench::Request& request)
  {
    applyWrench(request, bench_.names, bench_.frames, bench_.simulator);
  }
  Eigen::Vector3d linear() { return bench_.simulator.velocity(CRATE).head<3>(); }
  Eigen::Vector3d angular() { return bench_.simulator.velocity(CRATE).tail<3>(); }
  void turnCrate(double angle, const Eigen::Vector3d& axis)
  {
    bench_.simulator.position(CRATE).tail<4>() = Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)).coeffs();
    bench_.simulator.stateChanged();
  }
  RequestBench bench_;
};

TEST_F(WrenchTest, ActsInExactlyTheStepsOfItsWindow)
{
  bench_.run(5);
  ApplyWrench::Request request = push(20.0, 0.0, 0.0);
  request.start = ros::Time(0.010);
  request.duration = ros::Duration(0.007);
  apply(request);
  for (int step = 6; step <= 30; ++step)
  {
    const double before = linear().x();
    bench_.run(1);
    const bool acts = step > 10 && step <= 17;
    EXPECT_NEAR(linear().x() - before, acts ? 20.0 / CRATE_MASS * DT : 0.0, ROUND_OFF) << "step " << step;
  }
  EXPECT_TRUE(bench_.simulator.state().bodies[CRATE].wrenches.empty());
}

TEST_F(WrenchTest, ZeroStartIsTheNextStepAlsoAfterAReset)
{
  bench_.run(50);
  bench_.simulator.reset();
  bench_.run(3);
  ApplyWrench::Request request = push(0.0, 0.0, 5.0);
  request.duration = ros::Duration(0.010);
  apply(request);
  bench_.run(30);
  EXPECT_NEAR(linear().z(), 5.0 / CRATE_MASS * 0.010, ROUND_OFF);
}

TEST_F(WrenchTest, TheStampOfTheLastStepIsAStart)
{
  bench_.run(7);
  ApplyWrench::Request request = push(1.0, 0.0, 0.0);
  request.start = ros::Time(0.007);
  EXPECT_NO_THROW(apply(request));
  bench_.run(1);
  EXPECT_GT(linear().x(), 0.0);
}

TEST_F(WrenchTest, ForceAtAPointOfTheWorldTurnsTheCube)
{
  ApplyWrench::Request request = push(3.0, 0.0, 0.0);
  request.point_frame_id = "world";
  request.point.x = 2.0;
  request.point.z = 0.1 + 0.05;  // five centimetres above the centre
  apply(request);
  bench_.run(1);
  EXPECT_NEAR(linear().x(), 3.0 / CRATE_MASS * DT, ROUND_OFF);
  EXPECT_NEAR(angular().y(), 3.0 * 0.05 / CRATE_INERTIA * DT, ROUND_OFF);
}

TEST_F(WrenchTest, PointInAFrameOfAnotherBody)
{
  ApplyWrench::Request request = push(0.0, 3.0, 0.0);
  request.point_frame_id = "robot/arm";  // stands at (0, 0.12, 0.05)
  request.point.x = 2.1;
  request.point.y = -0.12;
  request.point.z = 0.05;
  apply(request);
  bench_.run(1);
  EXPECT_NEAR(angular().z(), 3.0 * 0.1 / CRATE_INERTIA * DT, ROUND_OFF);
  EXPECT_NEAR(angular().x(), 0.0, ROUND_OFF);
}

TEST_F(WrenchTest, AxesOfTheLinkTurnWithItAxesOfOthersStayAsTheyWere)
{
  turnCrate(M_PI / 2.0, Eigen::Vector3d::UnitZ());
  ApplyWrench::Request request = push(4.0, 0.0, 0.0);
  request.frame_id = "crate/box";
  request.duration = ros::Duration(0.001);
  apply(request);
  bench_.run(1);
  EXPECT_NEAR(linear().y(), 4.0 / CRATE_MASS * DT, ROUND_OFF);  // its x axis is the world's y
  EXPECT_NEAR(linear().x(), 0.0, ROUND_OFF);

  ApplyWrench::Request of_robot = push(4.0, 0.0, 0.0);
  of_robot.frame_id = "base";
  of_robot.duration = ros::Duration(0.001);
  apply(of_robot);
  bench_.run(1);
  EXPECT_NEAR(linear().x(), 4.0 / CRATE_MASS * DT, ROUND_OFF);

  bench_.simulator.velocity(CRATE).setZero();
  bench_.simulator.velocity(CRATE)[5] = M_PI / 2.0 / 0.1;  // a quarter turn in 100 steps
  bench_.simulator.stateChanged();
  request.duration = ros::Duration(0.1);
  apply(request);
  bench_.run(100);
  // Integral of F (cos, sin) over the quarter turn from the world's y axis on.
  const double impulse = 4.0 / CRATE_MASS * 0.1 * 2.0 / M_PI;
  EXPECT_NEAR(linear().y(), impulse, 1e-5 * impulse + 1e-6);  // midpoint rule: second order
  EXPECT_NEAR(linear().x(), -impulse, 1e-5 * impulse + 1e-6);
}

TEST_F(WrenchTest, ClearEndsThoseOfALinkABodyOrAll)
{
  ApplyWrench::Request on_arm = push(0.0, 1.0, 0.0);
  on_arm.body = "robot";
  on_arm.link = "arm";
  const auto count = [&](int body) { return bench_.simulator.state().bodies[body].wrenches.size(); };
  const auto give = [&]
  {
    bench_.simulator.clearWrenches();
    apply(push(1.0, 0.0, 0.0));
    apply(on_arm);
  };
  const auto clear = [&](const std::string& body, const std::string& link)
  {
    ClearWrenches::Request request;
    request.body = body;
    request.link = link;
    clearWrenches(request, bench_.names, bench_.simulator);
  };
  give();
  clear("robot", "base");
  EXPECT_EQ(count(ROBOT), 1U);
  clear("robot", "arm");
  EXPECT_EQ(count(ROBOT), 0U);
  EXPECT_EQ(count(CRATE), 1U);
  give();
  clear("crate", "");
  EXPECT_EQ(count(CRATE), 0U);
  EXPECT_EQ(count(ROBOT), 1U);
  give();
  clear("", "");
  EXPECT_EQ(count(ROBOT) + count(CRATE), 0U);
  apply(push(1.0, 0.0, 0.0));
  bench_.expectRefused("did you mean 'crate'", [&] { clear("crat", ""); });
  bench_.expectRefused("link: found 'lid'", [&] { clear("crate", "lid"); });
}

TEST_F(WrenchTest, TheTopicsWrenchIsReplacedByTheNextOneOnItsLink)
{
  const auto publish = [&](double force, const std::string& frame = "box")
  {
    geometry_msgs::WrenchStamped message;
    message.header.frame_id = frame;
    message.wrench.force.x = force;
    takeWrench(message, bench_.names, bench_.simulator);
  };
  apply(push(0.0, 1.0, 0.0));  // of the service: not touched
  publish(10.0);
  bench_.run(10);
  EXPECT_NEAR(linear().x(), 10.0 / CRATE_MASS * 10 * DT, ROUND_OFF);
  publish(-10.0);
  publish(5.0, "robot/base");
  bench_.run(10);
  EXPECT_NEAR(linear().x(), 0.0, ROUND_OFF);
  // The base drags the arm along, which yields: between the whole robot's mass and its own.
  EXPECT_GT(bench_.simulator.velocity(ROBOT)[0], 5.0 / 2.5 * 10 * DT);
  EXPECT_LT(bench_.simulator.velocity(ROBOT)[0], 5.0 / 2.0 * 10 * DT);
  publish(0.0);
  EXPECT_EQ(bench_.simulator.state().bodies[CRATE].wrenches.size(), 1U);
  bench_.run(10);
  EXPECT_NEAR(linear().x(), 0.0, ROUND_OFF);
  EXPECT_NEAR(linear().y(), 1.0 / CRATE_MASS * 30 * DT, ROUND_OFF);
  publish(7.0);
  bench_.expectRefused("header.frame_id", [&] { publish(1.0, "nowhere"); });
  bench_.expectRefused("wrench.force.x: found nan", [&] { publish(NOT_A_NUMBER); });
}

TEST_F(WrenchTest, RefusalsNameTheFieldAndChangeNothing)
{
  bench_.run(20);
  const std::pair<const char*, std::function<void(ApplyWrench::Request&)>> changes[] = {
      {"body: found 'create', did you mean 'crate'", [](auto& r) { r.body = "create"; }},
      {"link: found 'lid', expected one of box", [](auto& r) { r.link = "lid"; }},
      {"link: found ''", [](auto& r) { r.link = ""; }},
      {"frame_id: found 'camera'", [](auto& r) { r.frame_id = "camera"; }},
      {"point_frame_id: found 'camera'", [](auto& r) { r.point_frame_id = "camera"; }},
      {"wrench.force.y: found nan", [](auto& r) { r.wrench.force.y = NOT_A_NUMBER; }},
      {"wrench.torque.z: found inf", [](auto& r) { r.wrench.torque.z = INFINITE; }},
      {"wrench.force.x: found 1e+300", [](auto& r) { r.wrench.force.x = 1e300; }},
      {"point.x: found nan", [](auto& r) { r.point.x = NOT_A_NUMBER; }},
      {"start: found 0.019", [](auto& r) { r.start = ros::Time(0.019); }},
      {"duration: found -1 s", [](auto& r) { r.duration = ros::Duration(-1.0); }},
      {"duration: found 4e-04 s", [](auto& r) { r.duration = ros::Duration(0.0004); }},
  };
  for (const auto& [reason, change] : changes)
  {
    ApplyWrench::Request request = push(1.0, 2.0, 3.0);
    change(request);
    bench_.expectRefused(reason, [&] { apply(request); });
  }
}

TEST_F(WrenchTest, ABodyNeedNotBeNamedWhereTheLinkSaysIt)
{
  ApplyWrench::Request request = push(1.0, 0.0, 0.0);
  request.body = "";
  apply(request);
  request.link = "crate/box";
  apply(request);
  EXPECT_EQ(bench_.simulator.state().bodies[CRATE].wrenches.size(), 2U);
  request.link = "lid";
  bench_.expectRefused("expected one of base, arm, box", [&] { apply(request); });
}

TEST(ElasticWrenchServiceTest, TorqueOnAnElasticBodyIsRefusedByServiceAndTopic)
{
  RequestBench bench(
      loadScenario("bodies:\n  - name: jelly\n    elastic: {box: [0.1, 0.1], cells: [2, 2], young_modulus: 1.0e6, "
                   "poisson_ratio: 0.3, "
                   "density: 1000}\n    pose: {xyz: [0, 0, 1]}\n",
                   "test"));
  ApplyWrench::Request request;
  request.body = request.link = "jelly";
  request.wrench.torque.y = 1.0;
  bench.expectRefused("expected a force alone",
                      [&] { applyWrench(request, bench.names, bench.frames, bench.simulator); });
  geometry_msgs::WrenchStamped message;
  message.header.frame_id = "jelly";
  message.wrench.torque.x = 1.0;
  bench.expectRefused("expected a force alone", [&] { takeWrench(message, bench.names, bench.simulator); });
  request.wrench.torque.y = 0.0;
  request.wrench.force.x = 1.0;
  applyWrench(request, bench.names, bench.frames, bench.simulator);
  bench.run(1);
  EXPECT_GT(bench.simulator.velocity(0).cwiseAbs().maxCoeff(), 0.0);
}

}  // namespace
}  // namespace frictional_contact_sim
