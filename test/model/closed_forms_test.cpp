#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/math/cross_matrix.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/urdf_loader.h"
#include "model/urdf_text.h"

namespace frictional_contact_sim
{
namespace
{
/** Cadoux's double pendulum (appendix A): point masses on massless rods, angle from straight down, in the plane xz. */
std::string thesisPendulum(double m1, double l1, double m2, double l2)
{
  const std::string axis = R"(<axis xyz="0 -1 0"/>)";
  return robot(
      R"(<link name="world"/>)" + link("first", inertial(m1, "0 0 0", {0, 0, -l1})) +
      link("second", inertial(m2, "0 0 0", {0, 0, -l2})) + joint("a", "continuous", "world", "first", axis) +
      joint("b", "continuous", "first", "second", axis + R"(<origin xyz="0 0 )" + std::to_string(-l1) + R"("/>)"));
}
}  // namespace

TEST(ThesisDoublePendulumTest, MassGyroscopicAndExternalTermsAreThoseOfAppendixA)
{
  // (A.7), (A.8) in absolute angles theta = T q, T = [1 0; 1 1], since a URDF's second angle is relative: M_q = T' M T,
  // N_q = T' N, F_q = T' F. The second entry of N is misprinted in (A.7): (A.5) - (A.6) gives -theta1'^2.
  const double m1 = 1.5;
  const double m2 = 0.75;
  const double l1 = 0.5;
  const double l2 = 0.25;
  const LoadedModel loaded = loadUrdf(thesisPendulum(m1, l1, m2, l2), "pendulum", BaseType::AUTO);
  const MultibodyModel& model = loaded.model;
  ASSERT_EQ(model.nv, 2);
  EXPECT_TRUE(loaded.warnings.empty());  // point masses off their axes: both joints move inertia

  Eigen::Matrix2d turn;
  turn << 1, 0, 1, 1;
  MultibodyData data(model);
  Eigen::VectorXd bias(2);
  for (const Eigen::Vector2d& theta : {Eigen::Vector2d(0.3, -0.9), Eigen::Vector2d(2.0, 2.0), Eigen::Vector2d(0, 0)})
  {
    const Eigen::Vector2d rate(1.3, -2.1);
    const Eigen::Vector3d gravity(0.7, 0.0, -9.81);
    const double difference = theta[0] - theta[1];
    const double coupling = m2 * l1 * l2;
    Eigen::Matrix2d mass;
    mass << (m1 + m2) * l1 * l1, coupling * std::cos(difference), coupling * std::cos(difference), m2 * l2 * l2;
    const Eigen::Vector2d inertial =
        coupling * std::sin(difference) * Eigen::Vector2d(rate[1] * rate[1], -rate[0] * rate[0]);
    const Eigen::Vector2d external(
        l1 * (m1 + m2) * (std::cos(theta[0]) * gravity.x() + std::sin(theta[0]) * gravity.z()),
        l2 * m2 * (std::cos(theta[1]) * gravity.x() + std::sin(theta[1]) * gravity.z()));

    const Eigen::VectorXd q = turn.inverse() * theta;
    const Eigen::VectorXd v = turn.inverse() * rate;
    forwardKinematics(model, q, data);
    computeMassMatrix(model, data);
    computeBiasForces(model, v, gravity, data, bias);
    // Round-off of a dozen operations on numbers of order 10.
    EXPECT_LT((data.mass_matrix - turn.transpose() * mass * turn).norm(), 1e-14);
    EXPECT_LT((bias - turn.transpose() * (inertial - external)).norm(), 1e-14 * 10);
    const Eigen::Vector3d tip = data.link_pose[2] * Eigen::Vector3d(0, 0, -l2);
    const Eigen::Vector3d expected(l1 * std::sin(theta[0]) + l2 * std::sin(theta[1]), 0.0,
                                   -l1 * std::cos(theta[0]) - l2 * std::cos(theta[1]));
    EXPECT_LT((tip - expected).norm(), 1e-15);
  }
}

TEST(FreeRigidBodyTest, FollowsNewtonAndEulerAboutACentreOffTheOrigin)
{
  // Euler: I w' + w x I w = 0 in body axes; the centre of mass is not accelerated, so a = -(w' x c + w x (w x c)).
  const LoadedModel loaded =
      loadUrdf(robot(link("stone", inertial(2.0, "0.02 0.05 0.06", {0.1, -0.2, 0.3}))), "stone", BaseType::AUTO);
  const MultibodyModel& model = loaded.model;
  Eigen::VectorXd q = zeroPosition(model);
  q << 0.4, 0.5, -0.6, Eigen::Vector4d(0.1, -0.5, 0.3, 0.8).normalized();
  Eigen::VectorXd v(6);
  v << 1.0, 2.0, -0.5, 3.0, -1.0, 2.0;
  MultibodyData data(model);
  forwardKinematics(model, q, data);
  computeMassMatrix(model, data);
  ASSERT_TRUE(factorizeMassMatrix(model, Eigen::VectorXd(), data));
  Eigen::VectorXd acceleration(6);
  computeBiasForces(model, v, Eigen::Vector3d::Zero(), data, acceleration);
  solveMassMatrix(model, data, acceleration);
  acceleration *= -1.0;

  const Eigen::Matrix3d axes = Eigen::Quaterniond(q.data() + 3).toRotationMatrix();
  const Eigen::Vector3d moments(0.02, 0.05, 0.06);
  const Eigen::Vector3d spin = axes.transpose() * v.tail<3>();
  const Eigen::Vector3d momentum = moments.cwiseProduct(spin);
  const Eigen::Vector3d body_rate = -spin.cross(momentum).cwiseQuotient(moments);
  const Eigen::Vector3d angular = axes * body_rate;  // w x w = 0: the rate of w is the same in both axes
  const Eigen::Vector3d arm = axes * Eigen::Vector3d(0.1, -0.2, 0.3);
  const Eigen::Vector3d w = v.tail<3>();
  const Eigen::Vector3d linear = -(angular.cross(arm) + w.cross(w.cross(arm)));
  // Round-off times the condition of M, about 2 / 0.02 = 1e2.
  EXPECT_LT((acceleration.tail<3>() - angular).norm(), 1e-12);
  EXPECT_LT((acceleration.head<3>() - linear).norm(), 1e-12);
}

TEST(FreeRigidBodyTest, TorqueFreeSpinKeepsEnergyAndAngularMomentumToSecondOrder)
{
  const LoadedModel loaded =
      loadUrdf(robot(link("stone", inertial(1.0, "0.02 0.05 0.06"))), "stone", BaseType::FLOATING);
  const MultibodyModel& model = loaded.model;
  const auto drift = [&](double dt)
  {
    Eigen::VectorXd q = zeroPosition(model);
    Eigen::VectorXd v(6);
    v << 0, 0, 0, 0.1, 4.0, 0.1;  // near the middle axis: it tumbles
    MultibodyData data(model);
    const auto acceleration = [&](const Eigen::VectorXd& position, const Eigen::VectorXd& velocity)
    {
      forwardKinematics(model, position, data);
      computeMassMatrix(model, data);
      factorizeMassMatrix(model, Eigen::VectorXd(), data);
      Eigen::VectorXd a(6);
      computeBiasForces(model, velocity, Eigen::Vector3d::Zero(), data, a);
      solveMassMatrix(model, data, a);
      return Eigen::VectorXd(-a);
    };
    const auto momentum = [&]()
    {
      forwardKinematics(model, q, data);
      return Eigen::Vector3d(data.link_inertia[0].rotational * v.tail<3>());
    };
    const Eigen::Vector3d start = momentum();
    for (int k = 0; k < std::lround(2.0 / dt); ++k)
    {
      Eigen::VectorXd middle(7);
      const Eigen::VectorXd v_middle = v + 0.5 * dt * acceleration(q, v);
      integrate(model, q, v_middle, 0.5 * dt, middle);
      v += dt * acceleration(middle, v_middle);
      integrate(model, q, v_middle, dt, q);
    }
    return (momentum() - start).norm();
  };
  const double coarse = drift(1e-3);
  const double fine = drift(5e-4);
  EXPECT_LT(fine, 1e-5);
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);  // order 2
}

TEST(LumpedFixedJointsTest, InertiaIsTheParallelAxisSum)
{
  // A bar of 2 kg along x with a turned 3 kg bar welded on: centre (2 c1 + 3 c2) / 5, each moment moved to it.
  const std::string weld = R"(<origin xyz="0.4 0.1 -0.2" rpy="0 0 1.5707963267948966"/>)";
  const LoadedModel lumped =
      loadUrdf(robot(link("a", inertial(2.0, "0.1 0.2 0.25", {0.05, 0, 0})) +
                     link("b", inertial(3.0, "0.3 0.5 0.6", {0, 0.1, 0})) + joint("w", "fixed", "a", "b", weld)),
               "bars", BaseType::FLOATING);
  ASSERT_EQ(lumped.model.links.size(), 1u);
  ASSERT_EQ(lumped.model.frames.size(), 2u);
  const Eigen::Vector3d first(0.05, 0, 0);
  const Eigen::Vector3d second(0.4 - 0.1, 0.1, -0.2);  // b's y is a's -x
  const Eigen::Vector3d center = (2.0 * first + 3.0 * second) / 5.0;
  Eigen::Matrix3d moments = Eigen::Vector3d(0.1 + 0.5, 0.2 + 0.3, 0.25 + 0.6).asDiagonal();
  moments -= 2.0 * crossMatrix(first - center) * crossMatrix(first - center) +
             3.0 * crossMatrix(second - center) * crossMatrix(second - center);
  const RigidInertia& inertia = lumped.model.links[0].inertia;
  EXPECT_EQ(inertia.mass, 5.0);
  EXPECT_LT((inertia.center - center).norm(), 1e-15);
  EXPECT_LT((inertia.rotational - moments).norm(), 1e-15);
  EXPECT_LT((lumped.model.frames[1].placement * Eigen::Vector3d(0, 0.1, 0) - second).norm(), 1e-15);
}

TEST(LumpedFixedJointsTest, JointsAndShapesBehindAWeldMoveAsIfNotLumped)
{
  // base -weld-> bracket -hinge-> arm -weld-> tool with a sphere: compare with the chain of poses written out.
  const std::string sphere =
      R"(<collision><origin xyz="0 0 0.1"/><geometry><sphere radius="0.05"/></geometry></collision>)";
  const std::string body = inertial(1.0, "0.1 0.1 0.1");
  const LoadedModel loaded = loadUrdf(
      robot(link("base", body) + link("bracket", "") + link("arm", body) + link("tool", sphere) +
            joint("weld", "fixed", "base", "bracket", R"(<origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>)") +
            joint("hinge", "continuous", "bracket", "arm", R"(<origin xyz="0 2 0"/><axis xyz="1 0 0"/>)") +
            joint("mount", "fixed", "arm", "tool", R"(<origin xyz="0 0 3"/>)")),
      "arm", BaseType::FIXED);
  const MultibodyModel& model = loaded.model;
  ASSERT_EQ(model.links.size(), 2u);
  ASSERT_EQ(model.shapes.size(), 1u);
  EXPECT_EQ(model.shapes[0].name, "tool_collision_0");
  EXPECT_EQ(model.frames[model.shapes[0].frame].name, "tool");
  EXPECT_EQ(model.shapes[0].link, 1);
  MultibodyData data(model);
  const double angle = 0.4;
  forwardKinematics(model, Eigen::VectorXd::Constant(1, angle), data);
  Eigen::Isometry3d expected = Eigen::Translation3d(1, 0, 0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()) *
                               Eigen::Translation3d(0, 2, 0) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()) *
                               Eigen::Translation3d(0, 0, 3);
  const Eigen::Isometry3d tool = framePose(model, data, model.findFrame("tool"));
  EXPECT_LT((tool.matrix() - expected.matrix()).norm(), 1e-14);
  const Eigen::Isometry3d shape = data.link_pose[1] * model.shapes[0].placement;
  EXPECT_LT((shape.translation() - expected * Eigen::Vector3d(0, 0, 0.1)).norm(), 1e-14);
}

TEST(EnergyTest, OfAThrownBlockIsTheTextbookSum)
{
  const LoadedModel loaded = loadUrdf(robot(link("block", inertial(3.0, "0.1 0.2 0.25"))), "block", BaseType::FLOATING);
  Eigen::VectorXd q = zeroPosition(loaded.model);
  q[2] = 1.5;
  Eigen::VectorXd v(6);
  v << 1, 2, 2, 0.5, 1.0, 2.0;
  MultibodyData data(loaded.model);
  forwardKinematics(loaded.model, q, data);
  forwardVelocities(loaded.model, v, data);
  // 1/2 m v^2 + 1/2 w.I w = 13.5 + (0.1 x 0.25 + 0.2 x 1 + 0.25 x 4) / 2; m g h = 3 x 9.81 x 1.5
  EXPECT_NEAR(kineticEnergy(loaded.model, data, v), 13.5 + 0.6125, 1e-14);
  EXPECT_NEAR(potentialEnergy(loaded.model, data, Eigen::Vector3d(0, 0, -9.81)), 44.145, 1e-13);
}

}  // namespace frictional_contact_sim
