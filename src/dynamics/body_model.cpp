// A body as it is loaded: extents, chains, what never changes.
#include "frictional_contact_sim/dynamics/body.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "frictional_contact_sim/dynamics/free_link.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{

struct Reach
{
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Box& box) const { return box.half_size.norm(); }
  double operator()(const Cylinder& cylinder) const { return std::hypot(cylinder.radius, cylinder.half_length); }
  double operator()(const Capsule& capsule) const { return capsule.radius + capsule.half_length; }
  double operator()(const Mesh&) const { return 0.0; }
  double operator()(const HalfSpace&) const { return 0.0; }
};

std::vector<double> linkExtents(const MultibodyModel& model)
{
  std::vector<double> extents(model.links.size(), 0.0);
  for (const CollisionShape& shape : model.shapes)
    if (!std::holds_alternative<Mesh>(shape.geometry))  // known when it is loaded: BodyModel::setMeshReach
      extents[shape.link] =
          std::max(extents[shape.link], shape.placement.translation().norm() + std::visit(Reach(), shape.geometry));
  return extents;
}

void addMeshes(const MultibodyModel& model, const std::vector<double>& mesh_reach, std::vector<double>& extents)
{
  for (size_t k = 0; k < mesh_reach.size(); ++k)
    extents[model.shapes[k].link] = std::max(extents[model.shapes[k].link], mesh_reach[k]);
}

std::vector<double> linkSizes(const MultibodyModel& model, const std::vector<double>& extents)
{
  std::vector<double> sizes = extents;
  std::vector<bool> shaped(sizes.size(), false);
  for (const CollisionShape& shape : model.shapes)
    shaped[shape.link] = true;
  for (size_t link = 0; link < sizes.size(); ++link)
  {
    const RigidInertia& inertia = model.links[link].inertia;
    // The largest radius of gyration is at most that of the polar moment, half the trace.
    if (!shaped[link] && inertia.mass > 0.0)
      sizes[link] = inertia.center.norm() + std::sqrt(0.5 * inertia.rotational.trace() / inertia.mass);
  }
  return sizes;
}

/** See BodyModel::reach. Leaves first: what hangs on a link is known before the link's own joint asks. */
Eigen::VectorXd jointReach(const MultibodyModel& model, const std::vector<double>& sizes)
{
  std::vector<double> farthest = sizes;  // of the subtree, from the link's origin
  Eigen::VectorXd reach = Eigen::VectorXd::Ones(model.nv);
  for (int link = static_cast<int>(model.links.size()) - 1; link >= 0; --link)
  {
    const Joint& joint = model.joints[link];
    double slide = 0.0;
    if (joint.type == JointType::PRISMATIC && std::isfinite(joint.limit.upper - joint.limit.lower))
      slide = std::max(std::abs(joint.limit.lower), std::abs(joint.limit.upper));
    const int size = velocitySize(joint.type);
    const int linear = joint.type == JointType::FLOATING    ? 3
                       : joint.type == JointType::PLANAR    ? 2
                       : joint.type == JointType::PRISMATIC ? 1
                                                            : 0;
    for (int k = linear; k < size; ++k)
      reach[joint.v_index + k] = farthest[link] > 0.0 ? farthest[link] : 1.0;
    if (joint.parent >= 0)
      farthest[joint.parent] =
          std::max(farthest[joint.parent], joint.placement.translation().norm() + slide + farthest[link]);
  }
  return reach;
}

std::vector<std::vector<int>> linkChains(const MultibodyModel& model)
{
  std::vector<std::vector<int>> chains(model.links.size());
  for (size_t link = 0; link < model.joints.size(); ++link)
  {
    const Joint& joint = model.joints[link];
    if (joint.parent >= 0)
      chains[link] = chains[joint.parent];
    for (int k = 0; k < velocitySize(joint.type); ++k)
      chains[link].push_back(joint.v_index + k);
  }
  return chains;
}
}  // namespace

BodyModel::BodyModel(MultibodyModel multibody_model, std::shared_ptr<const DynamicBody> mechanics)
  : name(multibody_model.name)
  , tree(std::move(multibody_model))
  , solid(std::move(mechanics))
  , nq(solid ? solid->velocities() : tree.nq)
  , nv(solid ? solid->velocities() : tree.nv)
  , damping(Eigen::VectorXd::Zero(nv))
  , servo_inertia(tree.joints.size(), 0.0)
  , chains(linkChains(tree))
  , extents(linkExtents(tree))
  , sizes(linkSizes(tree, extents))
  , reach(jointReach(tree, sizes))
  , free_link(isFreeLink(tree))
  , isotropic(isIsotropic(tree))
  , schedules(tree.joints.size())
{
  for (const Joint& joint : tree.joints)
    if (velocitySize(joint.type) == 1)
      damping[joint.v_index] = joint.damping;
}

void BodyModel::setMeshReach(const std::vector<double>& mesh_reach)
{
  addMeshes(tree, mesh_reach, extents);
  sizes = linkSizes(tree, extents);
  reach = jointReach(tree, sizes);
}

bool BodyModel::isActuated(int joint) const
{
  return velocitySize(tree.joints[joint].type) == 1 && tree.joints[joint].mimic.joint < 0;
}

BodyState::BodyState(const BodyModel& model)
  : q(model.solid ? Eigen::VectorXd(Eigen::VectorXd::Zero(model.nq)) : zeroPosition(model.tree))
  , v(Eigen::VectorXd::Zero(model.nv))
  , base_pose(model.tree.joints.front().placement)
  , drives(model.tree.joints.size())
{
  for (size_t j = 0; j < drives.size(); ++j)
  {
    drives[j].command.kp = 0.0;
    drives[j].command.kd = 0.0;
    drives[j].effort_limit = model.tree.joints[j].limit.effort;
  }
}

}  // namespace frictional_contact_sim
