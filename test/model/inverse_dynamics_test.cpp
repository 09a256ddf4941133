#include "frictional_contact_sim/model/inverse_dynamics.h"

#include <gtest/gtest.h>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/urdf_loader.h"
#include "model/random_tree.h"
#include "model/urdf_text.h"

namespace frictional_contact_sim
{
namespace
{
const Eigen::Vector3d GRAVITY(0.3, -0.2, -9.81);

/** Every link in two: half of its mass on a frame of its own behind a fixed joint, at a place of its own. */
void splitLinks(RandomTree& random, MultibodyModel& tree)
{
  std::vector<Frame> frames;
  for (size_t i = 0; i < tree.links.size(); ++i)
  {
    Frame frame{"link_" + std::to_string(i), static_cast<int>(i), Eigen::Isometry3d::Identity()};
    frame.parent = tree.joints[i].parent < 0 ? -1 : 2 * tree.joints[i].parent + 1;
    frame.joint = tree.joints[i].name;
    const RigidInertia& whole = tree.links[i].inertia;
    const Eigen::Vector3d shift = 0.1 * random.vector();
    frame.inertia = {0.5 * whole.mass, whole.center + shift, 0.5 * whole.rotational};
    Frame plate{"plate_" + std::to_string(i), static_cast<int>(i), Eigen::Isometry3d::Identity()};
    plate.placement.translation() = random.vector();
    plate.placement.linear() = Eigen::Quaterniond(Eigen::Vector4d(random.vector(4)).normalized()).toRotationMatrix();
    plate.parent = 2 * static_cast<int>(i);
    plate.joint = "fixed_" + std::to_string(i);
    const Eigen::Matrix3d axes = plate.placement.linear();
    plate.inertia = {0.5 * whole.mass, plate.placement.inverse() * Eigen::Vector3d(whole.center - shift),
                     axes.transpose() * (0.5 * whole.rotational) * axes};
    const Eigen::Matrix3d spread = shift.squaredNorm() * Eigen::Matrix3d::Identity() - shift * shift.transpose();
    tree.links[i].inertia.rotational += whole.mass * spread;
    frames.push_back(frame);
    frames.push_back(plate);
  }
  tree.frames = frames;
}

/** Linear and angular momentum about the world's origin, from masses and points alone. */
Vector6d totalMomentum(const MultibodyModel& tree, const Eigen::VectorXd& q, const Eigen::VectorXd& v)
{
  MultibodyData data(tree);
  forwardKinematics(tree, q, data);
  forwardVelocities(tree, v, data);
  Vector6d momentum = Vector6d::Zero();
  for (size_t i = 0; i < tree.links.size(); ++i)
  {
    const RigidInertia& inertia = tree.links[i].inertia;
    const Eigen::Vector3d center = data.link_pose[i] * inertia.center;
    const Vector6d velocity = pointVelocity(data, static_cast<int>(i), center);
    const Eigen::Matrix3d axes = data.link_pose[i].linear();
    const Eigen::Vector3d linear = inertia.mass * velocity.head<3>();
    momentum.head<3>() += linear;
    momentum.tail<3>() += center.cross(linear) + axes * inertia.rotational * axes.transpose() * velocity.tail<3>();
  }
  return momentum;
}

struct Case
{
  int links;
  JointType base;
};

class InverseDynamicsTest : public testing::TestWithParam<Case>
{
protected:
  InverseDynamicsTest() : random_(7), model_(random_.model(GetParam().links, GetParam().base, 0.5)), data_(model_)
  {
    splitLinks(random_, model_);
    q_ = random_.position(model_);
    v_ = random_.vector(model_.nv);
    rate_ = 3.0 * random_.vector(model_.nv);
    forwardKinematics(model_, q_, data_);
    for (size_t i = 0; i < model_.frames.size(); ++i)
      applied_.push_back(5.0 * random_.vector(6));
    computeLinkAccelerations(model_, v_, rate_, data_);
    computeJointWrenches(model_, data_, GRAVITY, applied_, wrenches_);
  }

  RandomTree random_;
  MultibodyModel model_;
  MultibodyData data_;
  Eigen::VectorXd q_;
  Eigen::VectorXd v_;
  Eigen::VectorXd rate_;
  std::vector<Vector6d> applied_;
  std::vector<Vector6d> wrenches_;
};

TEST_P(InverseDynamicsTest, AlongTheJointsItIsTheEquationOfMotion)
{
  computeMassMatrix(model_, data_);
  Eigen::VectorXd effort = data_.mass_matrix * rate_;
  Eigen::VectorXd bias(model_.nv);
  computeBiasForces(model_, v_, GRAVITY, data_, bias);
  effort += bias;
  for (size_t i = 0; i < model_.frames.size(); ++i)
    addWrench(model_, data_, model_.frames[i].link, data_.reference, -applied_[i].head<3>(), -applied_[i].tail<3>(),
              effort);
  for (int k = 0; k < model_.nv; ++k)
    EXPECT_NEAR(effort[k], data_.motion_subspace.col(k).dot(wrenches_[2 * model_.dof_link[k]]),
                1e-9 * (1.0 + std::abs(effort[k])))
        << k;
}

TEST_P(InverseDynamicsTest, WhatActsOnTheWholeIsItsRateOfMomentum)
{
  // Along q(t) with q' = v and v' = rate: central differences, extrapolated to a step of zero.
  const auto difference = [&](double h)
  {
    const auto momentum = [&](double t)
    {
      Eigen::VectorXd q(model_.nq);
      // Mean velocity over [0, t]; rotations of a floating joint do not commute, which is of third order and odd in t.
      integrate(model_, q_, v_ + 0.5 * t * rate_, t, q);
      return totalMomentum(model_, q, v_ + t * rate_);
    };
    return Vector6d((momentum(h) - momentum(-h)) / (2.0 * h));
  };
  const double h = 2e-3;
  const Vector6d coarse = difference(h);
  const Vector6d fine = difference(0.5 * h);
  const Vector6d finest = difference(0.25 * h);
  const Vector6d fine_2 = (4.0 * fine - coarse) / 3.0;
  const Vector6d finest_2 = (4.0 * finest - fine) / 3.0;
  const Vector6d rate = (16.0 * finest_2 - fine_2) / 15.0;
  Vector6d total = wrenches_.front();
  for (const Vector6d& wrench : applied_)
    total += wrench;
  total.head<3>() += model_.totalMass() * GRAVITY;
  total.tail<3>() += (centerOfMass(model_, data_) - data_.reference).cross(model_.totalMass() * GRAVITY);
  total.tail<3>() += data_.reference.cross(Eigen::Vector3d(total.head<3>()));
  EXPECT_LT((total - rate).norm(), 1e-9 * (1.0 + rate.norm()));
}

TEST_P(InverseDynamicsTest, AccelerationOfAPointIsTheRateOfItsVelocity)
{
  const int link = static_cast<int>(model_.links.size()) - 1;
  const Eigen::Vector3d local = random_.vector();
  const auto velocity = [&](double t)
  {
    MultibodyData data(model_);
    Eigen::VectorXd q(model_.nq);
    integrate(model_, q_, v_ + 0.5 * t * rate_, t, q);
    forwardKinematics(model_, q, data);
    forwardVelocities(model_, v_ + t * rate_, data);
    return Eigen::Vector3d(pointVelocity(data, link, data.link_pose[link] * local).head<3>());
  };
  const double h = 1e-3;
  const Eigen::Vector3d coarse = (velocity(h) - velocity(-h)) / (2.0 * h);
  const Eigen::Vector3d fine = (velocity(0.5 * h) - velocity(-0.5 * h)) / h;
  const Eigen::Vector3d expected = (4.0 * fine - coarse) / 3.0;
  const Eigen::Vector3d found = pointAcceleration(data_, link, data_.link_pose[link] * local);
  EXPECT_LT((found - expected).norm(), 1e-8 * (1.0 + expected.norm()));
}

INSTANTIATE_TEST_SUITE_P(Trees, InverseDynamicsTest,
                         testing::Values(Case{1, JointType::FLOATING}, Case{4, JointType::FIXED},
                                         Case{6, JointType::FLOATING}, Case{15, JointType::FLOATING}));

TEST(JointWrenchTest, AtRestAJointCarriesWhatHangsOnItByItsLever)
{
  // A base, an arm along x with a fixed sensor plate, and a hand beyond: 1 kg at 0.3 m of the shoulder, 0.2 kg at its
  // origin (0.5 m), 0.5 kg at 0.1 m of the wrist in y.
  const std::string moments = "0.01 0.01 0.01";
  const LoadedModel loaded = loadUrdf(
      robot(link("base", "") + link("arm", inertial(1.0, moments, {0.3, 0, 0})) +
            link("plate", inertial(0.2, moments)) + link("hand", inertial(0.5, moments, {0, 0.1, 0})) +
            joint("shoulder", "revolute", "base", "arm", "<axis xyz='0 1 0'/><limit effort='1' velocity='1'/>") +
            joint("mount", "fixed", "arm", "plate", "<origin xyz='0.5 0 0' rpy='0 0 1.5707963267948966'/>") +
            joint("wrist", "continuous", "plate", "hand", "<axis xyz='1 0 0'/>")),
      "test", BaseType::FIXED);
  const MultibodyModel& model = loaded.model;
  MultibodyData data(model);
  forwardKinematics(model, zeroPosition(model), data);
  computeLinkAccelerations(model, Eigen::VectorXd::Zero(model.nv), Eigen::VectorXd::Zero(model.nv), data);
  const double g = 9.81;
  std::vector<Vector6d> wrenches;
  computeJointWrenches(model, data, {0, 0, -g}, std::vector<Vector6d>(4, Vector6d::Zero()), wrenches);
  const auto local = [&](const std::string& name)
  {
    const int frame = model.findFrame(name);
    return localWrench(data, framePose(model, data, frame), wrenches[frame]);
  };
  const auto six = [](double fx, double fy, double fz, double tx, double ty, double tz)
  { return (Vector6d() << fx, fy, fz, tx, ty, tz).finished(); };
  // The plate is turned by a quarter: its x is the arm's y, its y the arm's -x; the hand's centre is at -x of the arm.
  EXPECT_LT((local("hand") - six(0, 0, 0.5 * g, 0.1 * 0.5 * g, 0, 0)).norm(), 1e-12);
  EXPECT_LT((local("plate") - six(0, 0, 0.7 * g, 0.1 * 0.5 * g, 0, 0)).norm(), 1e-12);
  EXPECT_LT((local("arm") - six(0, 0, 1.7 * g, 0, -(0.3 + 0.2 * 0.5 + 0.5 * 0.4) * g, 0)).norm(), 1e-12);
  EXPECT_LT((local("base") - local("arm")).norm(), 1e-12);  // no mass of its own, at the same place
}

}  // namespace
}  // namespace frictional_contact_sim
