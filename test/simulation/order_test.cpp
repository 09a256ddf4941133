// Order of the scheme: 2 where nothing happens, 1 with an impact inside; and the momentum balance of every single step.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
std::string link(const std::string& name, double mass, const std::string& center, const std::string& shape = "")
{
  std::ostringstream text;
  text << "<link name='" << name << "'><inertial><origin xyz='" << center << "'/><mass value='" << mass
       << "'/><inertia ixx='" << 0.02 * mass << "' ixy='0' ixz='0' iyy='" << 0.03 * mass << "' iyz='0' izz='"
       << 0.015 * mass << "'/></inertial>";
  if (!shape.empty())
    text << "<collision><origin xyz='" << center << "'/><geometry>" << shape << "</geometry></collision>";
  text << "</link>";
  return text.str();
}

std::string joint(const std::string& parent, const std::string& child, const std::string& origin,
                  const std::string& axis)
{
  return "<joint name='" + child + "' type='continuous'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='" + origin + "'/><axis xyz='" + axis + "'/></joint>";
}

std::string robot(const std::string& content)
{
  return "<robot name='robot'>" + content + "</robot>";
}

Scenario treeScene(const std::string& urdf, BaseType base)
{
  Scenario scene = groundScene(0.0);
  scene.ground.reset();
  BodySpec& body = addBody(scene, "robot", urdf, poseAt(0.0, 0.0, 1.0));
  body.base = base;
  return scene;
}

Scenario doublePendulum()
{
  Scenario scene = treeScene(robot("<link name='world'/>" + link("a", 1.0, "0 0 -0.5") + link("b", 0.7, "0 0 -0.4") +
                                   joint("world", "a", "0 0 0", "0 1 0") + joint("a", "b", "0 0 -1", "0 1 0")),
                             BaseType::FIXED);
  scene.bodies[0].joints["a"] = {1.2, 0.0};
  scene.bodies[0].joints["b"] = {-0.5, 2.0};
  return scene;
}

Scenario tumblingTree()
{
  Scenario scene =
      treeScene(robot(link("trunk", 2.0, "0.1 0 0.05") + link("a", 0.5, "0.2 0 0") + link("b", 0.8, "0 -0.2 0.1") +
                      joint("trunk", "a", "0.2 0 0", "0 0 1") + joint("trunk", "b", "0 -0.2 0.1", "1 0 0")),
                BaseType::FLOATING);
  scene.gravity.setZero();
  scene.bodies[0].angular_velocity = {2.0, -3.0, 1.0};
  scene.bodies[0].joints["a"] = {0.3, 2.0};
  scene.bodies[0].joints["b"] = {-0.6, -1.0};
  return scene;
}

Scenario armWithServos()
{
  Scenario scene = treeScene(robot("<link name='world'/>" + link("a", 2.0, "0 0 0.2") + link("b", 1.5, "0.2 0 0") +
                                   link("c", 0.5, "0.1 0 0") + joint("world", "a", "0 0 0", "0 0 1") +
                                   joint("a", "b", "0 0 0.4", "0 1 0") + joint("b", "c", "0.4 0 0", "0 1 0")),
                             BaseType::FIXED);
  for (const auto& [name, target] : {std::make_pair("a", 1.0), std::make_pair("b", -0.7), std::make_pair("c", 0.5)})
  {
    JointCommand command;
    command.mode = JointCommand::Mode::POSITION;
    command.target = target;
    command.kp = 8.0;
    command.kd = 0.0;  // damping is taken at the end of the step, of order 1 by design
    scene.bodies[0].commands[name] = command;
  }
  return scene;
}

Scenario fallingHumanoid()
{
  std::string content = link("trunk", 20.0, "0 0 0.1");
  for (const std::string side : {"l", "r"})
  {
    const std::string y = side == "l" ? "0.15" : "-0.15";
    content += link(side + "_thigh", 6.0, "0 0 -0.2") + link(side + "_shin", 3.0, "0 0 -0.2") +
               link(side + "_arm", 2.0, "0 0 -0.15") + joint("trunk", side + "_thigh", "0 " + y + " -0.2", "0 1 0") +
               joint(side + "_thigh", side + "_shin", "0 0 -0.4", "0 1 0") +
               joint("trunk", side + "_arm", "0 " + y + " 0.3", "1 0 0");
  }
  Scenario scene = treeScene(robot(content), BaseType::FLOATING);
  scene.bodies[0].angular_velocity = {0.5, 1.5, -0.7};
  scene.bodies[0].joints["l_thigh"] = {0.4, 3.0};
  scene.bodies[0].joints["r_thigh"] = {-0.3, -2.0};
  scene.bodies[0].joints["l_shin"] = {0.8, -1.0};
  scene.bodies[0].joints["r_arm"] = {1.0, 4.0};
  return scene;
}

struct End
{
  Eigen::VectorXd q, v;
  double energy = 0.0;
};

End runTo(Scenario scene, double duration, int steps)
{
  scene.time_step = duration / steps;
  Simulator simulator(scene);
  for (int i = 0; i < steps; ++i)
    EXPECT_TRUE(simulator.step().converged()) << "step " << i << " of " << steps;
  const EnergyLedger& energy = simulator.report().energy;
  return {simulator.position(0), simulator.velocity(0), energy.kinetic + energy.potential};
}

struct OrderCase
{
  const char* name;
  Scenario (*scene)();
};

class OrderTest : public testing::TestWithParam<OrderCase>
{
};

TEST_P(OrderTest, IsTwoWithoutEvents)
{
  const Scenario scene = GetParam().scene();
  std::array<End, 4> ends;
  for (int i = 0; i < 4; ++i)
    ends[i] = runTo(scene, 0.64, 160 << i);
  const auto order = [](double coarse, double fine) { return std::log2(coarse / fine); };
  for (int i = 0; i < 2; ++i)
  {
    SCOPED_TRACE("h / " + std::to_string(1 << i));
    const double q = order((ends[i].q - ends[i + 1].q).norm(), (ends[i + 1].q - ends[i + 2].q).norm());
    const double v = order((ends[i].v - ends[i + 1].v).norm(), (ends[i + 1].v - ends[i + 2].v).norm());
    const double energy =
        order(std::abs(ends[i].energy - ends[i + 1].energy), std::abs(ends[i + 1].energy - ends[i + 2].energy));
    EXPECT_NEAR(q, 2.0, 0.2);
    EXPECT_NEAR(v, 2.0, 0.2);
    EXPECT_GT(energy, 1.8) << "the leading error of the energy may vanish, never be of lower order";
  }
}

INSTANTIATE_TEST_SUITE_P(Trees, OrderTest,
                         testing::Values(OrderCase{"double_pendulum", doublePendulum},
                                         OrderCase{"tumbling_tree", tumblingTree},
                                         OrderCase{"arm_with_servos", armWithServos},
                                         OrderCase{"falling_humanoid", fallingHumanoid}),
                         [](const testing::TestParamInfo<OrderCase>& info) { return info.param.name; });

TEST(OrderTest, IsOneWithAnImpactInside)
{
  // A jointed pair of balls falls on one of them and bounces. The error of one run depends on where in its step the
  // impact falls, so errors are root mean squares over starts.
  const int starts = 16;
  std::array<double, 4> q_error{};
  std::array<double, 4> v_error{};
  std::array<double, 4> energy_error{};
  for (int start = 0; start < starts; ++start)
  {
    Scenario scene = groundScene(0.0, 0.5);
    BodySpec& body =
        addBody(scene, "robot",
                robot(link("a", 1.0, "0 0 0", "<sphere radius='0.1'/>") +
                      link("b", 0.8, "0.4 0 0.3", "<sphere radius='0.1'/>") + joint("a", "b", "0 0 0", "0 1 0")),
                poseAt(0.0, 0.0, 0.3 + 0.0011 * start));
    body.angular_velocity = {0.2, 0.5, 0.1};
    const End reference = runTo(scene, 0.32, 160 << 7);
    for (int i = 0; i < 4; ++i)
    {
      const End end = runTo(scene, 0.32, 160 << i);
      q_error[i] += (end.q - reference.q).squaredNorm();
      v_error[i] += (end.v - reference.v).squaredNorm();
      energy_error[i] += std::pow(end.energy - reference.energy, 2);
    }
  }
  for (const auto* error : {&q_error, &v_error, &energy_error})
  {
    const double order = 0.5 * std::log2((*error)[0] / (*error)[3]) / 3.0;
    EXPECT_NEAR(order, 1.0, 0.2);
  }
}

/** A random floating tree of four to eight links with balls as shapes, jointed about random axes. */
std::string randomTree(std::mt19937& random)
{
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto vector = [&](double scale)
  {
    std::ostringstream text;
    text << scale * number(random) << ' ' << scale * number(random) << ' ' << scale * number(random);
    return text.str();
  };
  const int links = 4 + static_cast<int>(2.0 * (number(random) + 1.0));
  std::string content;
  for (int i = 0; i < links; ++i)
    content += link("l" + std::to_string(i), std::pow(10.0, number(random)), vector(0.05), "<sphere radius='0.06'/>");
  for (int i = 1; i < links; ++i)
  {
    Eigen::Vector3d axis(number(random), number(random), number(random));
    axis.normalize();
    std::ostringstream text;
    text.precision(17);
    text << axis.x() << ' ' << axis.y() << ' ' << axis.z();
    const int parent = std::min(i - 1, static_cast<int>(0.5 * (number(random) + 1.0) * i));
    content += joint("l" + std::to_string(parent), "l" + std::to_string(i), vector(0.4), text.str());
  }
  return robot(content);
}

TEST(MomentumTest, OfEveryStepOfRandomTreesIsTheImpulseFromOutside)
{
  int touching = 0;
  for (unsigned seed = 1; seed <= 20; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Scenario scene = groundScene(0.6);
    BodySpec& body = addBody(scene, "robot", randomTree(random), poseAt(0.0, 0.0, 1.0));
    body.angular_velocity = {1.0, 2.0, -1.5};
    body.pose.reset();  // 1 mm above the ground
    scene.stopping.tolerance = 1e-12;
    Simulator simulator(scene);
    const MultibodyModel& model = simulator.model(0);
    MultibodyData middle(model);
    Eigen::VectorXd q_middle = simulator.position(0);
    Eigen::VectorXd bias(model.nv);
    for (int i = 0; i < 150; ++i)
    {
      const Eigen::VectorXd v = simulator.velocity(0);
      integrate(model, simulator.position(0), v, 0.5 * scene.time_step, q_middle);
      ASSERT_TRUE(simulator.step().converged()) << "step " << i << ": " << simulator.outcome().message;
      const Eigen::VectorXd& v_new = simulator.velocity(0);
      forwardKinematics(model, q_middle, middle);
      computeMassMatrix(model, middle);
      computeBiasForces(model, 0.5 * (v + v_new), scene.gravity, middle, bias);
      Vector6d change = (middle.mass_matrix * (v_new - v) + scene.time_step * bias).head<6>();
      double scale = (middle.mass_matrix * v_new).head<6>().norm() + scene.time_step * bias.head<6>().norm();
      for (const ContactState& contact : simulator.contacts())
      {
        scale += contact.impulse.norm();
        if (simulator.shape(contact.shape_b).body >= 0)
          continue;  // within the tree
        touching += contact.impulse.norm() > 0.0;
        change.head<3>() -= contact.impulse;
        change.tail<3>() -= (contact.position - middle.reference).cross(contact.impulse);
      }
      // The bias may miss 1e-12 of one step's change of velocity, the solver 1e-12 of its scale.
      ASSERT_LE(change.norm(), 3e-12 * scale) << "step " << i;
    }
  }
  EXPECT_GT(touching, 1000);
}

}  // namespace
}  // namespace frictional_contact_sim
