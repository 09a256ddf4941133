#pragma once
/**
 * @file random_tree.h
 * @brief Random trees of bodies with all joint types, from a fixed seed.
 */
#include <random>
#include <string>

#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
class RandomTree
{
public:
  explicit RandomTree(unsigned seed) : generator_(seed) {}

  /** @param bodies number of bodies @param base FLOATING or FIXED @param branching 0 = chain, 1 = any parent */
  MultibodyModel model(int bodies, JointType base, double branching)
  {
    static constexpr JointType TYPES[] = {JointType::REVOLUTE, JointType::CONTINUOUS, JointType::PRISMATIC,
                                          JointType::PLANAR, JointType::FLOATING};
    MultibodyModel tree;
    tree.name = "random";
    for (int i = 0; i < bodies; ++i)
    {
      Joint joint;
      joint.name = "joint_" + std::to_string(i);
      joint.type = i == 0 ? base : TYPES[integer(0, 4)];
      joint.parent = i == 0 ? -1 : uniform() < branching ? integer(0, i - 1) : i - 1;
      if (i > 0 || base == JointType::FIXED)
      {
        joint.placement = pose();
      }
      joint.axis = vector().normalized();
      tree.joints.push_back(joint);
      tree.links.push_back({"body_" + std::to_string(i), inertia()});
      tree.frames.push_back({"body_" + std::to_string(i), i, pose()});
    }
    finalize(tree);
    return tree;
  }

  Eigen::VectorXd position(const MultibodyModel& tree)
  {
    Eigen::VectorXd q = vector(tree.nq);
    for (const Joint& joint : tree.joints)
    {
      if (joint.type == JointType::FLOATING)
      {
        q.segment<4>(joint.q_index + 3).normalize();
      }
    }
    return q;
  }

  /** Entries in [-1, 1]. */
  Eigen::VectorXd vector(Eigen::Index size)
  {
    return Eigen::VectorXd::NullaryExpr(size, [this]() { return 2.0 * uniform() - 1.0; });
  }
  Eigen::Vector3d vector() { return vector(3); }

  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(generator_); }
  int integer(int first, int last) { return std::uniform_int_distribution<int>(first, last)(generator_); }

private:
  Eigen::Isometry3d pose()
  {
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    placement.linear() = Eigen::Quaterniond(Eigen::Vector4d(vector(4)).normalized()).toRotationMatrix();
    placement.translation() = vector();
    return placement;
  }

  /** Of eight point masses: physically possible. */
  RigidInertia inertia()
  {
    RigidInertia inertia;
    inertia.center = 0.5 * vector();
    for (int k = 0; k < 8; ++k)
    {
      const double mass = 0.05 + uniform();
      const Eigen::Vector3d arm = 0.3 * vector();
      inertia.mass += mass;
      inertia.rotational += mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    }
    return inertia;
  }

  std::mt19937 generator_;
};

}  // namespace frictional_contact_sim
