#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/model/kinematics.h"
#include "model/random_tree.h"

namespace frictional_contact_sim
{
namespace
{
/** Rotation vector of the small rotation that takes `from` to `to`: exact to third order in the angle. */
Eigen::Vector3d smallRotation(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to)
{
  const Eigen::Matrix3d turn = to * from.transpose();
  return 0.5 * Eigen::Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
}

struct Case
{
  int bodies;
  JointType base;
  double branching;
};

class RandomTreeKinematicsTest : public testing::TestWithParam<Case>
{
protected:
  RandomTreeKinematicsTest()
    : random_(7), model_(random_.model(GetParam().bodies, GetParam().base, GetParam().branching))
  {
  }
  RandomTree random_;
  MultibodyModel model_;
};
}  // namespace

TEST_P(RandomTreeKinematicsTest, JacobianIsTheDerivativeOfThePositionOfABodyFixedPoint)
{
  // Central differences: error of order h^2 = 1e-10 times third derivatives of order 10, round-off 1e-16 / h = 1e-11.
  const double h = 1e-5;
  const double tolerance = 1e-7;
  for (int trial = 0; trial < 5; ++trial)
  {
    const Eigen::VectorXd q = random_.position(model_);
    const int body = random_.integer(0, GetParam().bodies - 1);
    const Eigen::Vector3d local = random_.vector();
    MultibodyData data(model_);
    forwardKinematics(model_, q, data);
    const Eigen::Vector3d point = data.link_pose[body] * local;
    Matrix6Xd jacobian(6, model_.nv);
    pointJacobian(model_, data, body, point, jacobian);
    for (int k = 0; k < model_.nv; ++k)
    {
      MultibodyData after(model_);
      MultibodyData before(model_);
      Eigen::VectorXd moved(model_.nq);
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(model_.nv, k);
      integrate(model_, q, unit, h, moved);
      forwardKinematics(model_, moved, after);
      integrate(model_, q, unit, -h, moved);
      forwardKinematics(model_, moved, before);
      const Eigen::Vector3d linear = (after.link_pose[body] * local - before.link_pose[body] * local) / (2.0 * h);
      const Eigen::Vector3d angular =
          smallRotation(before.link_pose[body].linear(), after.link_pose[body].linear()) / (2.0 * h);
      EXPECT_LT((jacobian.col(k).head<3>() - linear).norm(), tolerance) << "coordinate " << k;
      EXPECT_LT((jacobian.col(k).tail<3>() - angular).norm(), tolerance) << "coordinate " << k;
    }
  }
}

TEST_P(RandomTreeKinematicsTest, VelocityRowsAndJacobianAgree)
{
  const Eigen::VectorXd q = random_.position(model_);
  const Eigen::VectorXd v = random_.vector(model_.nv);
  MultibodyData data(model_);
  forwardKinematics(model_, q, data);
  forwardVelocities(model_, v, data);
  Matrix6Xd jacobian(6, model_.nv);
  for (int body = 0; body < GetParam().bodies; ++body)
  {
    const Eigen::Vector3d point = data.link_pose[body] * random_.vector();
    const Eigen::Vector3d direction = random_.vector();
    pointJacobian(model_, data, body, point, jacobian);
    // Round-off of sums of about 50 terms of size up to 100.
    EXPECT_LT((jacobian * v - pointVelocity(data, body, point)).norm(), 1e-12);
    Eigen::VectorXd row = Eigen::VectorXd::Ones(model_.nv);
    addPointJacobianRow(model_, data, body, point, direction, -2.0, row);
    const Eigen::VectorXd expected =
        Eigen::VectorXd::Ones(model_.nv) - 2.0 * jacobian.topRows<3>().transpose() * direction;
    EXPECT_LT((row - expected).norm(), 1e-12);
  }
  Eigen::VectorXd row = Eigen::VectorXd::Zero(model_.nv);
  addPointJacobianRow(model_, data, -1, Eigen::Vector3d::Ones(), Eigen::Vector3d::Ones(), 1.0, row);
  EXPECT_EQ(row.norm(), 0.0);
  EXPECT_EQ(pointVelocity(data, -1, Eigen::Vector3d::Ones()).norm(), 0.0);
}

TEST_P(RandomTreeKinematicsTest, RotationsStayRotationsAndQuaternionsUnit)
{
  Eigen::VectorXd q = random_.position(model_);
  const Eigen::VectorXd v = 5.0 * random_.vector(model_.nv);
  for (int step = 0; step < 10000; ++step)
  {
    integrate(model_, q, v, 1e-3, q);  // in place
  }
  MultibodyData data(model_);
  forwardKinematics(model_, q, data);
  for (const Joint& joint : model_.joints)
  {
    if (joint.type == JointType::FLOATING)
    {
      // Normalised at every step: what is left is the round-off of one.
      EXPECT_NEAR(q.segment<4>(joint.q_index + 3).norm(), 1.0, 4e-16);
    }
  }
  for (const Eigen::Isometry3d& pose : data.link_pose)
  {
    // A product of two rotations per body: round-off grows by some 1e-15 a level.
    EXPECT_LT((pose.linear().transpose() * pose.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, RandomTreeKinematicsTest,
                         testing::Values(Case{1, JointType::FLOATING, 0.0}, Case{2, JointType::FIXED, 0.0},
                                         Case{8, JointType::FLOATING, 0.0}, Case{12, JointType::FLOATING, 1.0},
                                         Case{15, JointType::FIXED, 0.5}, Case{20, JointType::FIXED, 1.0}));

TEST(IntegrateTest, ConstantRotationOfAFloatingJointIsExactForAnyStep)
{
  // exp(dt w) is exact for constant w, so ten steps of 0.3 s equal one rotation by 3 |w|.
  const MultibodyModel model = RandomTree(1).model(1, JointType::FLOATING, 0.0);
  Eigen::VectorXd q = zeroPosition(model);
  Eigen::VectorXd v(6);
  v << 1.0, -2.0, 0.5, 0.3, -0.4, 1.2;
  for (int step = 0; step < 10; ++step)
  {
    integrate(model, q, v, 0.3, q);
  }
  const Eigen::Vector3d w = v.tail<3>();
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(3.0 * w.norm(), w.normalized()));
  // Ten products of quaternions: round-off of some 1e-15; the sign of a quaternion is free.
  EXPECT_NEAR(std::abs(expected.dot(Eigen::Quaterniond(q.data() + 3))), 1.0, 1e-14);
  EXPECT_LT((q.head<3>() - 3.0 * v.head<3>()).norm(), 1e-14);
}

TEST(IntegrateTest, TinyRotationsAreNotLost)
{
  // Angles below 1e-5 take the series: compare with the rotation vector itself, relative error of the series 1e-20.
  const MultibodyModel model = RandomTree(1).model(1, JointType::FLOATING, 0.0);
  Eigen::VectorXd q = zeroPosition(model);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(6);
  v[4] = 1e-9;
  integrate(model, q, v, 1e-3, q);
  EXPECT_NEAR(q[4], 0.5e-12, 1e-27);
  EXPECT_EQ(q[6], 1.0);
}

TEST(ReferenceTest, IsTheRootOriginForEitherBase)
{
  RandomTree random(3);
  MultibodyModel fixed = random.model(3, JointType::FIXED, 0.0);
  MultibodyData fixed_data(fixed);
  forwardKinematics(fixed, random.position(fixed), fixed_data);
  EXPECT_TRUE(fixed_data.link_pose[0].isApprox(fixed.joints[0].placement, 1e-15));
  EXPECT_EQ(fixed_data.reference, fixed.joints[0].placement.translation());

  const MultibodyModel floating = random.model(3, JointType::FLOATING, 0.0);
  const Eigen::VectorXd q = random.position(floating);
  MultibodyData data(floating);
  forwardKinematics(floating, q, data);
  EXPECT_EQ(data.reference, Eigen::Vector3d(q.head<3>()));
  EXPECT_EQ(data.link_pose[0].translation(), data.reference);
}

TEST(PlanarAxesTest, AreATriadWithTheNormalAndXYForZ)
{
  RandomTree random(5);
  for (int trial = 0; trial < 100; ++trial)
  {
    Eigen::Vector3d normal = random.vector().normalized();
    if (trial == 0)
    {
      normal = -Eigen::Vector3d::UnitZ();
    }
    const Eigen::Matrix<double, 3, 2> axes = planarAxes(normal);
    const Eigen::Vector3d first = axes.col(0);
    const Eigen::Vector3d second = axes.col(1);
    // The closed form divides by 1 + cos: round-off 1e-16 over the least 1 + cos of the sample, 1e-3.
    EXPECT_NEAR(first.norm(), 1.0, 1e-13);
    EXPECT_LT((first.cross(second) - normal).norm(), 1e-13);
  }
  EXPECT_EQ(Eigen::Vector3d(planarAxes(Eigen::Vector3d::UnitZ()).col(0)), Eigen::Vector3d::UnitX());
  EXPECT_EQ(Eigen::Vector3d(planarAxes(Eigen::Vector3d::UnitZ()).col(1)), Eigen::Vector3d::UnitY());
}

TEST(FrameTest, PoseAndCentreOfMassFollowTheBodies)
{
  RandomTree random(11);
  const MultibodyModel model = random.model(6, JointType::FLOATING, 1.0);
  MultibodyData data(model);
  forwardKinematics(model, random.position(model), data);
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (int i = 0; i < 6; ++i)
  {
    const Eigen::Isometry3d expected = data.link_pose[i] * model.frames[i].placement;
    EXPECT_TRUE(framePose(model, data, i).isApprox(expected, 1e-15));
    mass += model.links[i].inertia.mass;
    moment += model.links[i].inertia.mass * (data.link_pose[i] * model.links[i].inertia.center);
  }
  EXPECT_NEAR(model.totalMass(), mass, 1e-12 * mass);
  EXPECT_LT((centerOfMass(model, data) - moment / mass).norm(), 1e-13);
}

TEST(FinalizeTest, RefusesInconsistentTreesInOneLine)
{
  MultibodyModel model = RandomTree(2).model(3, JointType::FLOATING, 0.0);
  model.joints[1].parent = 2;
  EXPECT_THROW(finalize(model), std::invalid_argument);
  model.joints[1].parent = 0;
  model.joints[1].type = JointType::REVOLUTE;
  model.joints[1].axis.setZero();
  EXPECT_THROW(finalize(model), std::invalid_argument);
  model.joints[1].axis = Eigen::Vector3d::UnitY();
  model.joints.pop_back();
  EXPECT_THROW(finalize(model), std::invalid_argument);
  model.links.pop_back();
  EXPECT_NO_THROW(finalize(model));
}

}  // namespace frictional_contact_sim
