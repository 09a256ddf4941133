// A single free link about its centre of mass (dynamics/free_link.h): what a tumbling body keeps, whatever its origin.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
struct Solid
{
  double mass = 1.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();  ///< about the centre, link axes
  std::string shape;  ///< collision geometry at the centre, or none
};

std::string urdfOf(const Solid& solid)
{
  std::ostringstream text;
  text.precision(17);
  const auto vector = [](const Eigen::Vector3d& x)
  {
    std::ostringstream numbers;
    numbers.precision(17);
    numbers << x.x() << ' ' << x.y() << ' ' << x.z();
    return numbers.str();
  };
  const Eigen::Matrix3d& inertia = solid.inertia;
  text << "<robot name='solid'><link name='solid'><inertial><origin xyz='" << vector(solid.center) << "'/><mass value='"
       << solid.mass << "'/><inertia ixx='" << inertia(0, 0) << "' ixy='" << inertia(0, 1) << "' ixz='" << inertia(0, 2)
       << "' iyy='" << inertia(1, 1) << "' iyz='" << inertia(1, 2) << "' izz='" << inertia(2, 2) << "'/></inertial>";
  if (!solid.shape.empty())
    text << "<collision><origin xyz='" << vector(solid.center) << "'/><geometry>" << solid.shape
         << "</geometry></collision>";
  text << "</link></robot>";
  return text.str();
}

class Draw
{
public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Eigen::Vector3d vector(double length)
  {
    const Eigen::Vector3d x(number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0));
    return length * x.normalized();
  }
  Eigen::Quaterniond turn()
  {
    Eigen::Quaterniond turn(number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0));
    return turn.normalized();
  }
  /** Mass from grams to tons; moments of three lengths, so that they are those of a body. */
  Solid solid(double center_distance)
  {
    Solid solid;
    solid.mass = std::pow(10.0, number(-2.0, 3.0));
    solid.center = vector(center_distance);
    const Eigen::Vector3d square(number(0.01, 1.0), number(0.01, 1.0), number(0.01, 1.0));
    const Eigen::Matrix3d axes = turn().toRotationMatrix();
    const Eigen::Vector3d moments(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
    solid.inertia = 0.1 * solid.mass * axes * moments.asDiagonal() * axes.transpose();
    return solid;
  }

private:
  std::mt19937 random_;
};

/** What a free motion keeps, from the state alone. */
struct Momenta
{
  Eigen::Vector3d center_velocity;
  Eigen::Vector3d center;
  Eigen::Vector3d angular;  ///< about the centre
  double spin_energy;
};

Momenta momentaOf(const Simulator& simulator, const Solid& solid)
{
  const Eigen::VectorXd& q = simulator.position(0);
  const Eigen::VectorXd& v = simulator.velocity(0);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(q.data() + 3).toRotationMatrix();
  const Eigen::Vector3d arm = turn * solid.center;
  const Eigen::Vector3d angular = v.tail<3>();
  const Eigen::Vector3d body = turn.transpose() * angular;
  Momenta momenta;
  momenta.center = q.head<3>() + arm;
  momenta.center_velocity = v.head<3>() + angular.cross(arm);
  momenta.angular = turn * (solid.inertia * body);
  momenta.spin_energy = 0.5 * body.dot(solid.inertia * body);
  return momenta;
}

Scenario freeScene(const Solid& solid, Draw& draw, double spin, bool gravity)
{
  Scenario scene = groundScene(0.0);
  scene.ground.reset();
  // The residual of M v + f = 0 alone has round-off times the condition of M, 1e4 with the centre 10 m away.
  scene.stopping.tolerance = 1e-10;
  if (!gravity)
    scene.gravity.setZero();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = draw.turn().toRotationMatrix();
  BodySpec& body = addBody(scene, "solid", urdfOf(solid), pose);
  body.angular_velocity = draw.vector(spin);
  const Eigen::Vector3d arm = pose.linear() * solid.center;
  body.linear_velocity = draw.vector(1.0) - body.angular_velocity.cross(arm);
  return scene;
}

void expectFreeMotion(Simulator& simulator, const Solid& solid, int steps)
{
  const Momenta start = momentaOf(simulator, solid);
  const Eigen::Vector3d gravity = simulator.scenario().gravity;
  for (int i = 0; i < steps; ++i)
  {
    const StepOutcome& outcome = simulator.step();
    ASSERT_TRUE(outcome.converged()) << outcome.message << ", E " << outcome.residual;
  }
  const Momenta end = momentaOf(simulator, solid);
  const double time = simulator.time();
  // Only the round-off of one conversion to the origin and back a step is left; it has no preferred sign. It is
  // relative to the origin's own velocity, which carries the angular velocity times the distance of the centre.
  const double origin_speed = simulator.velocity(0).head<3>().norm() + gravity.norm() * time;
  EXPECT_LE((end.center_velocity - start.center_velocity - time * gravity).norm(), 1e-12 * (1.0 + origin_speed));
  const Eigen::Vector3d fallen = start.center + time * start.center_velocity + 0.5 * time * time * gravity;
  EXPECT_LE((end.center - fallen).norm(), 1e-11 * (1.0 + time * origin_speed));
  EXPECT_LE((end.angular - start.angular).norm(), 1e-12 * start.angular.norm());
  EXPECT_NEAR(end.spin_energy, start.spin_energy, 1e-12 * start.spin_energy);
}

TEST(FreeLinkTest, ATumblingBodyKeepsEnergyAndMomentaOverAHundredThousandSteps)
{
  const std::array<double, 3> distances{0.0, 0.3, 10.0};
  for (size_t i = 0; i < distances.size(); ++i)
  {
    SCOPED_TRACE("centre of mass " + std::to_string(distances[i]) + " m from the origin");
    Draw draw(100 + static_cast<unsigned>(i));
    const Solid solid = draw.solid(distances[i]);
    Simulator simulator(freeScene(solid, draw, 10.0, false));
    expectFreeMotion(simulator, solid, 100000);
  }
}

TEST(FreeLinkTest, RandomBodiesAndSpinsKeepThemToo)
{
  for (unsigned seed = 1; seed <= 40; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(seed);
    const Solid solid = draw.solid(std::pow(10.0, draw.number(-2.0, 1.0)));
    Simulator simulator(freeScene(solid, draw, std::pow(10.0, draw.number(-1.0, 2.0)), seed % 2 == 0));
    expectFreeMotion(simulator, solid, 1000);
  }
}

TEST(FreeLinkTest, AnAxisymmetricTopPrecessesAtItsClosedFormRate)
{
  // Body axes: o_z constant, (o_x, o_y) turns at (J_z - J_x)/J_x o_z. Midpoint: its angle a step is
  // 2 atan(dt/2 rate), so the phase error is rate^3 dt^2 t / 12 to leading order, and that formula is met.
  Solid solid;
  solid.center = {0.2, -0.1, 0.4};
  solid.inertia = Eigen::Vector3d(0.2, 0.2, 0.35).asDiagonal();
  Scenario scene = groundScene(0.0);
  scene.ground.reset();
  BodySpec& body = addBody(scene, "solid", urdfOf(solid), poseAt(1.0, 2.0, 3.0));
  body.angular_velocity = {3.0, 0.0, 20.0};
  Simulator simulator(scene);
  const int steps = 1000;
  for (int i = 0; i < steps; ++i)
    simulator.step();
  const double rate = (0.35 - 0.2) / 0.2 * 20.0;
  const double angle = steps * 2.0 * std::atan(0.5 * scene.time_step * rate);
  const Eigen::VectorXd& q = simulator.position(0);
  const Eigen::Vector3d spin =
      Eigen::Quaterniond(q.data() + 3).toRotationMatrix().transpose() * simulator.velocity(0).tail<3>();
  EXPECT_NEAR(spin.x(), 3.0 * std::cos(angle), 1e-10);
  EXPECT_NEAR(spin.y(), 3.0 * std::sin(angle), 1e-10);
  EXPECT_NEAR(spin.z(), 20.0, 1e-10);
}

TEST(FreeLinkTest, AWrenchDoesTheWorkAndGivesTheMomentumItShould)
{
  for (unsigned seed = 1; seed <= 10; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(seed);
    const Solid solid = draw.solid(0.5);
    Scenario scene = freeScene(solid, draw, 5.0, false);
    ExternalWrench wrench;
    wrench.link = "solid";
    wrench.force = draw.vector(20.0 * solid.mass);
    wrench.point = solid.center;
    scene.bodies[0].wrenches.push_back(wrench);
    Simulator simulator(scene);
    const Momenta start = momentaOf(simulator, solid);
    for (int i = 0; i < 500; ++i)
      simulator.step();
    const Momenta end = momentaOf(simulator, solid);
    const Eigen::Vector3d gain = simulator.time() / solid.mass * wrench.force;
    // A constant force through the centre: exact; it leaves the angular momentum alone.
    EXPECT_LE((end.center_velocity - start.center_velocity - gain).norm(), 1e-11 * gain.norm());
    EXPECT_LE((end.angular - start.angular).norm(), 1e-11 * start.angular.norm());
    const EnergyLedger& energy = simulator.report().energy;
    EXPECT_NEAR(energy.balance_error, 0.0, 1e-12 * (energy.kinetic + std::abs(energy.actuators)));
  }
}

TEST(FreeLinkTest, ATumblingBodyThatBouncesWithoutLossKeepsItsEnergyToRoundOff)
{
  for (unsigned seed = 1; seed <= 10; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(seed);
    Solid solid = draw.solid(0.3);
    solid.shape = "<box size='0.3 0.5 0.2'/>";
    Scenario scene = groundScene(0.0, 1.0);
    Eigen::Isometry3d pose = poseAt(0.0, 0.0, 1.0);
    pose.linear() = draw.turn().toRotationMatrix();
    BodySpec& body = addBody(scene, "solid", urdfOf(solid), pose);
    body.angular_velocity = draw.vector(8.0);
    body.linear_velocity = {0.5, 0.2, -1.0};
    Simulator simulator(scene);
    bool hit = false;
    for (int i = 0; i < 1500; ++i)
    {
      {
        const StepOutcome& outcome = simulator.step();
        ASSERT_TRUE(outcome.converged()) << outcome.message << ", E " << outcome.residual;
      }
      for (const ContactState& contact : simulator.contacts())
        hit = hit || contact.mode == ContactMode::IMPACT;
    }
    EXPECT_TRUE(hit);
    const EnergyLedger& energy = simulator.report().energy;
    const double total = energy.kinetic + std::abs(energy.potential);
    // The ledger is exact by construction: what is left is round-off of 1500 sums of terms of that size.
    EXPECT_NEAR(energy.balance_error, 0.0, 1e-13 * total);
    EXPECT_NEAR(energy.friction, 0.0, 1e-13 * total);
  }
}

TEST(FreeLinkTest, HoldStandsToTheBitAndRestIsExact)
{
  Draw draw(3);
  Solid solid = draw.solid(2.0);
  Scenario scene = freeScene(solid, draw, 0.0, false);
  scene.bodies[0].linear_velocity.setZero();
  Simulator simulator(scene);
  simulator.step();  // normalises the quaternion
  const Eigen::VectorXd q = simulator.position(0);
  for (int i = 0; i < 100; ++i)
    simulator.step();
  EXPECT_TRUE((simulator.position(0).head<3>() - q.head<3>()).isZero(0.0));
  EXPECT_LE((simulator.position(0) - q).norm(), 1e-15) << "normalising may flip the last bit of a quaternion";
  EXPECT_TRUE(simulator.velocity(0).isZero(0.0));
}

}  // namespace
}  // namespace frictional_contact_sim
