// Further closed forms: rolling, spinning, oblique impacts, grasps.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
constexpr double DEGREE = 3.14159265358979323846 / 180.0;

TEST(BilliardBallTest, EndsWithTwoSeventhsOfItsSlipLess)
{
  const double mu = 0.2;
  const double radius = 0.03;
  const Eigen::Vector3d v0(1.5, 0.0, 0.0);
  const Eigen::Vector3d w0(20.0, -40.0, 0.0);
  const Eigen::Vector3d slip = v0 + w0.cross(Eigen::Vector3d(0.0, 0.0, -radius));
  Scenario scene = groundScene(mu);
  BodySpec& ball = addBody(scene, "ball", sphereUrdf(radius, 0.17), poseAt(0.0, 0.0, radius));
  ball.linear_velocity = v0;
  ball.angular_velocity = w0;
  AuditedSimulator simulator(scene);
  while (simulator.time() < 1.5 * 2.0 * slip.norm() / (7.0 * mu * GRAVITY))
    simulator.step();
  const Eigen::Vector3d expected = v0 - 2.0 / 7.0 * slip;
  EXPECT_LT((simulator.velocity(0).head<3>() - expected).norm(), 1e-10);
}

TEST(BilliardBallTest, SlidesOnAParabola)
{
  const double mu = 0.2;
  const double radius = 0.03;
  const Eigen::Vector3d v0(1.5, 0.0, 0.0);
  const Eigen::Vector3d w0(20.0, -40.0, 0.0);
  const Eigen::Vector3d direction = (v0 + w0.cross(Eigen::Vector3d(0.0, 0.0, -radius))).normalized();
  Scenario scene = groundScene(mu);
  BodySpec& ball = addBody(scene, "ball", sphereUrdf(radius, 0.17), poseAt(0.0, 0.0, radius));
  ball.linear_velocity = v0;
  ball.angular_velocity = w0;
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 100; ++i)
    simulator.step();
  // The slip keeps its direction, so the friction force is constant and the midpoint rule exact.
  const Eigen::Vector3d expected = 0.1 * v0 - 0.5 * mu * GRAVITY * 0.01 * direction;
  EXPECT_LT((simulator.position(0).head<2>() - expected.head<2>()).norm(), 1e-12);
}

TEST(SpinningDiscTest, StopsAfterTheTimeOfItsRimFriction)
{
  const double mu = 0.3;
  const double radius = 0.2;
  const double w0 = 10.0;
  Scenario scene = groundScene(mu);
  addBody(scene, "disc", cylinderUrdf(radius, 0.05, 1.0), poseAt(0.0, 0.0, 0.025)).angular_velocity.z() = w0;
  AuditedSimulator simulator(scene);
  double stopped = 0.0;
  while (simulator.time() < 0.5)
  {
    simulator.step();
    if (simulator.velocity(0).norm() > 1e-9)
      stopped = simulator.time();
  }
  EXPECT_NEAR(stopped, radius * w0 / (2.0 * mu * GRAVITY), 1e-3);
}

TEST(RollingTest, CylinderOnInclineRollsWithTwoThirdsOfTheSlope)
{
  const double angle = 0.3;
  const double mu = std::tan(angle) / 3.0 * (1.0 + 1e-6);
  Scenario scene = groundScene(mu);
  incline(scene, angle);
  BodySpec& cylinder = addBody(scene, "cylinder", cylinderUrdf(0.1, 0.4, 1.0), poseAt(0.0, 0.0, 0.1));
  cylinder.pose->linear() = Eigen::AngleAxisd(90.0 * DEGREE, Eigen::Vector3d::UnitX()).toRotationMatrix();
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 100; ++i)
    simulator.step();
  EXPECT_NEAR(simulator.velocity(0)[0] / 0.1, 2.0 / 3.0 * GRAVITY * std::sin(angle), 1e-9);
}

/** A thin rod of length 1 m and mass 1 kg along x with a small sphere at its lower end. */
std::string rodUrdf(double end_radius)
{
  std::ostringstream text;
  text.precision(17);
  text << "<robot name='rod'><link name='rod'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='"
       << 1.0 / 12.0 << "' iyz='0' izz='0.08333333333333333'/></inertial><collision><origin xyz='0.5 0 0'/>"
       << "<geometry><sphere radius='" << end_radius << "'/></geometry></collision></link></robot>";
  return text.str();
}

TEST(RodImpactTest, ImpulseIsThatOfTheEffectiveMass)
{
  const double e = 0.5;
  const double v0 = 2.0;
  const double radius = 1e-9;
  for (const double angle : {20.0 * DEGREE, 45.0 * DEGREE, 70.0 * DEGREE})
  {
    Scenario scene = groundScene(0.0, e);
    scene.gravity.setZero();
    BodySpec& rod = addBody(scene, "rod", rodUrdf(radius), poseAt(0.0, 0.0, 0.5 * std::sin(angle) + radius));
    rod.pose->linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    rod.linear_velocity.z() = -v0;
    const AuditedSimulator simulator(scene);
    const double expected = (1.0 + e) * v0 / (1.0 + 3.0 * std::cos(angle) * std::cos(angle));
    EXPECT_NEAR(simulator.velocity(0)[2] + v0, expected, 1e-10) << angle / DEGREE;
  }
}

/** Kinetic energy after over before the impact of Kane and Levinson's double pendulum. */
double kaneLevinsonRatio(double restitution, double mu)
{
  const std::string rod =
      "<inertial><origin xyz='0 0 -0.5'/><mass value='1'/><inertia ixx='0.08333333333333333' "
      "ixy='0' ixz='0' iyy='0.08333333333333333' iyz='0' izz='1e-9'/></inertial>";
  const std::string limit = "<limit lower='-10' upper='10' effort='1000' velocity='100'/>";
  const double radius = 1e-7;
  BodySpec body;
  body.name = "pendulum";
  body.urdf_xml = "<robot name='pendulum'><link name='world'/><link name='upper'>" + rod +
                  "</link><link name='lower'>" + rod +
                  "<collision><origin xyz='0 0 -1'/><geometry><sphere radius='1e-7'/></geometry></collision></link>"
                  "<joint name='a' type='revolute'><parent link='world'/><child link='upper'/><axis xyz='0 1 0'/>" +
                  limit +
                  "</joint><joint name='b' type='revolute'><parent link='upper'/><child link='lower'/>"
                  "<origin xyz='0 0 -1'/><axis xyz='0 1 0'/>" +
                  limit + "</joint></robot>";
  const double upper = 20.0 * DEGREE;
  const double lower = 30.0 * DEGREE;
  body.joints["a"] = {upper, -0.1};
  body.joints["b"] = {lower - upper, -0.1};
  Scenario scene = groundScene(mu, restitution);
  scene.ground->height = -std::cos(upper) - std::cos(lower) - radius;
  scene.bodies.push_back(body);
  const AuditedSimulator simulator(scene);
  const double before = 0.5 * (4.0 / 3.0 * 0.01 + 1.0 / 3.0 * 0.04 + std::cos(upper - lower) * 0.02);
  return simulator.report().energy.kinetic / before;
}

TEST(DoublePendulumImpactTest, NewtonRestitutionGainsTheEnergyOfKaneAndLevinson)
{
  EXPECT_NEAR(kaneLevinsonRatio(0.5, 0.5), 1.587, 1e-3);
  EXPECT_NEAR(kaneLevinsonRatio(0.7, 0.5), 2.758, 1e-3);
  EXPECT_NEAR(kaneLevinsonRatio(0.0, 0.5), 0.514, 1e-3);
  EXPECT_NEAR(kaneLevinsonRatio(0.5, 0.0), 0.711, 1e-3);
}

/** Error of the ratio of angular velocities after and before a rocking block's impact. */
double housnerError(double h)
{
  const double width = 1.0;
  const double tall = 3.0;
  const double slenderness = std::atan(width / tall);
  const double tilt = 0.2;
  Scenario scene = groundScene(2.0);
  scene.time_step = h;
  BodySpec& block = addBody(scene, "block", boxUrdf({width, 0.5, tall}, 3.0), poseAt(0.0, 0.0, 0.0));
  // Tilted about the edge at x = +width/2.
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
  block.pose->linear() = turn;
  block.pose->translation() = turn * Eigen::Vector3d(-width / 2.0, 0.0, tall / 2.0);
  AuditedSimulator simulator(scene);
  // Angular velocities at the upright position follow from the energies before and after; the gap law spreads the
  // impact over two steps, so a rate read off a single step would miss part of it.
  const double upright = 3.0 * GRAVITY * tall / 2.0;
  const double before = simulator.report().energy.kinetic + simulator.report().energy.potential - upright;
  while (simulator.position(0)[4] > 0.0)
    simulator.step();
  for (int i = 0; i < 5; ++i)
    simulator.step();
  const double after = simulator.report().energy.kinetic + simulator.report().energy.potential - upright;
  const double expected = 1.0 - 1.5 * std::sin(slenderness) * std::sin(slenderness);
  return std::abs(std::sqrt(after / before) - expected);
}

TEST(RockingBlockTest, LosesTheEnergyOfHousner)
{
  EXPECT_LT(housnerError(1e-3), 4e-3);
  EXPECT_LT(housnerError(1e-4), 4e-4);
}

TEST(PinchGraspTest, HeldCubeDoesNotCreep)
{
  AuditedSimulator simulator(loadScenarioFile(std::string(PROJECT_DIR) + "/config/scenarios/grasp.yaml"));
  double creep = 0.0;
  for (int i = 0; i < 60000; ++i)
  {
    simulator.step();
    const StepSummary& report = simulator.report();
    ASSERT_EQ(report.status, SolverStatus::CONVERGED) << "step " << i << " residual " << report.residual;
    creep = std::max(creep, simulator.velocity(1).norm());
  }
  EXPECT_LT(creep, 1e-9);  // [m/s]; MuJoCo 2.2.2 creeps at 1.2e-3
  EXPECT_NEAR(simulator.position(1)[2], 0.4, 1e-9);
  for (const ContactState& contact : simulator.contacts())
    EXPECT_NE(contact.mode, ContactMode::SLIDING);
}
}  // namespace
}  // namespace frictional_contact_sim
