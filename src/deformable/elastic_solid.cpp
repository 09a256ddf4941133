#include "frictional_contact_sim/deformable/elastic_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "frictional_contact_sim/dynamics/surface_contacts.h"
#include "frictional_contact_sim/problem/mass_factor.h"
#include "link_tree.h"

namespace frictional_contact_sim
{
namespace
{
struct ElasticWork : BodyWork
{
  double dt = -1.0;  ///< of the matrix
  SparseRows matrix;
  bool has_factor = false;
  MassFactor factor;
  mutable Eigen::VectorXd scratch;
};

ElasticWork& workOf(Body& body)
{
  return static_cast<ElasticWork&>(*body.work);
}
const ElasticWork& workOf(const Body& body)
{
  return static_cast<const ElasticWork&>(*body.work);
}
}  // namespace

Eigen::Vector3d ElasticSolid::displacement(const VectorIn& q, int node) const
{
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (dofs_[node][axis] >= 0)
      u[axis] = q[dofs_[node][axis]];
  return u;
}

/** Mean displacement by mass, body axes. */
Eigen::Vector3d ElasticSolid::centre(const VectorIn& q) const
{
  return Eigen::Vector3d(carried_[0].dot(q), carried_[1].dot(q), carried_[2].dot(q)) / total_mass_;
}

void ElasticSolid::recentre(BodyState& state) const
{
  if (is_supported_)
    return;
  const Eigen::Vector3d shift = centre(state.q);
  state.base_pose.translation() += state.base_pose.linear() * shift;
  state.q -= rigidVelocity(shift, Eigen::Vector3d::Zero());
}

std::vector<Eigen::Vector3d> ElasticSolid::displacements(const VectorIn& q) const
{
  std::vector<Eigen::Vector3d> all;
  for (size_t node = 0; node < dofs_.size(); ++node)
    all.push_back(displacement(q, static_cast<int>(node)));
  return all;
}

Eigen::VectorXd ElasticSolid::rigidVelocity(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) const
{
  Eigen::VectorXd v(velocities());
  for (size_t node = 0; node < dofs_.size(); ++node)
    for (int axis = 0; axis < 3; ++axis)
      if (dofs_[node][axis] >= 0)
        v[dofs_[node][axis]] = linear[axis] + angular.cross(parts_.nodes[node])[axis];
  return v;
}

double ElasticSolid::rotation(const VectorIn& q) const
{
  double most = 0.0;
  for (Eigen::Index first = 0; first < rotation_.rows(); first += 3)
  {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      for (SparseRows::InnerIterator entry(rotation_, first + k); entry; ++entry)
        turn[k] += entry.value() * q[entry.col()];
    most = std::max(most, turn.squaredNorm());
  }
  return std::sqrt(most);
}

std::unique_ptr<BodyWork> ElasticSolid::makeWork() const
{
  auto work = std::make_unique<ElasticWork>();
  work->matrix = mass_;
  work->dt = 0.0;
  return work;
}

void ElasticSolid::setPoses(const VectorIn& q, MultibodyData& data) const
{
  data.reference = data.base_pose.translation();
  data.link_pose.front() = data.base_pose;
  const Eigen::Matrix3d axes = data.base_pose.linear();
  for (size_t k = 0; k < parts_.surface.size(); ++k)
  {
    const int node = parts_.surface[k];
    Eigen::Isometry3d& pose = data.link_pose[k + 1];
    pose.linear() = axes;
    pose.translation() = data.reference + axes * (parts_.nodes[node] + displacement(q, node));
  }
}

void ElasticSolid::setVelocities(const VectorIn& v, MultibodyData& data) const
{
  const Eigen::Matrix3d axes = data.base_pose.linear();
  data.link_velocity.front().setZero();
  if (!is_supported_)
    data.link_velocity.front().head<3>() = axes * centre(v);
  for (size_t k = 0; k < parts_.surface.size(); ++k)
  {
    data.link_velocity[k + 1].setZero();
    data.link_velocity[k + 1].head<3>() = axes * displacement(v, parts_.surface[k]);
  }
}

void ElasticSolid::addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns) const
{
  const Eigen::Matrix3d axes = body.middle.base_pose.linear();
  const auto first = static_cast<std::ptrdiff_t>(columns.size());
  const auto add = [&](int link, double weight)
  {
    const Eigen::Vector3i& dofs = dofs_[parts_.surface[link - 1]];
    for (int axis = 0; axis < 3; ++axis)
      if (dofs[axis] >= 0 && weight != 0.0)
        columns.emplace_back(dofs[axis], sign * weight * axes.col(axis));
  };
  if (kindOf(point.feature) != FeatureKind::FACE)
  {
    if (point.link > 0)
      add(point.link, 1.0);
    return;
  }
  const Facet& facet = facets_[point.feature & ((Feature{1} << FEATURE_INDEX_BITS) - 1)];
  Eigen::Matrix3d nodes = Eigen::Matrix3d::Zero();
  for (int k = 0; k < facet.count; ++k)
    nodes.col(k) = body.middle.link_pose[facet.links[k]].translation();
  const Eigen::Vector3d weights = closestOnFacet(nodes, facet.count, point.position).weights;
  for (int k = 0; k < facet.count; ++k)
    add(facet.links[k], weights[k]);
  std::sort(columns.begin() + first, columns.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

double ElasticSolid::pointSpeed(const Body& /*body*/, const VectorIn& v) const
{
  double square = 0.0;
  for (size_t node = 0; node < dofs_.size(); ++node)
    square = std::max(square, displacement(v, static_cast<int>(node)).squaredNorm());
  return std::sqrt(square);
}

void ElasticSolid::prepare(Body& body, double dt) const
{
  ElasticWork& work = workOf(body);
  if (work.dt == dt)
    return;
  work.dt = dt;
  work.has_factor = false;
  const bool is_motion = body.model.regime == Regime::DYNAMIC || dt == 0.0;
  const double of_stiffness = is_motion ? dt * (0.25 * dt + 0.5 * damping_) : dt * dt;
  // What K does not hold has nothing against its rigid motions but its inertia: a proximal term.
  const double of_mass = is_motion || !is_held_ ? 1.0 : 0.0;
  for (Eigen::Index k = 0; k < mass_.nonZeros(); ++k)
    work.matrix.valuePtr()[k] = of_mass * mass_.valuePtr()[k] + of_stiffness * stiffness_.valuePtr()[k];
}

bool ElasticSolid::factorize(Body& body) const
{
  ElasticWork& work = workOf(body);
  if (work.has_factor)
    return true;
  try
  {
    work.factor.compute(work.matrix);
    work.has_factor = true;
  }
  catch (const std::invalid_argument&)
  {
  }
  return work.has_factor;
}

void ElasticSolid::solve(const Body& body, Eigen::VectorXd& v) const
{
  const ElasticWork& work = workOf(body);
  work.factor.halfSolve(v, work.scratch);
  work.factor.transposedHalfSolve(work.scratch, v);
}

void ElasticSolid::multiply(const Body& body, const Eigen::VectorXd& v, VectorOut product) const
{
  product = workOf(body).matrix * v;
}

void ElasticSolid::copyMass(const Body& body, double*& value) const
{
  const SparseRows& matrix = workOf(body).matrix;
  value = std::copy(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(), value);
}

void ElasticSolid::computeBias(const Body& body, const Eigen::VectorXd& /*v*/, const Eigen::Vector3d& gravity,
                               Eigen::VectorXd& bias) const
{
  bias.noalias() = stiffness_ * (body.q_middle + damping_ * body.v_start);
  const Eigen::Vector3d pull = body.middle.base_pose.linear().transpose() * gravity;
  for (int axis = 0; axis < 3; ++axis)
    bias -= pull[axis] * carried_[axis];
}

void ElasticSolid::applyWrenches(Body& body, double now) const
{
  const Eigen::Matrix3d axes = body.middle.base_pose.linear();
  for (const ExternalWrench& wrench : body.state.wrenches)
  {
    if (now < wrench.from || now >= wrench.until)
      continue;
    size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (size_t node = 0; node < dofs_.size(); ++node)
      if (const double distance = (parts_.nodes[node] - wrench.point).norm();
          dofs_[node].maxCoeff() >= 0 && distance < least)
      {
        least = distance;
        nearest = node;
      }
    const Eigen::Vector3d force = wrench.world_frame ? axes.transpose() * wrench.force : wrench.force;
    for (int axis = 0; axis < 3; ++axis)
      if (dofs_[nearest][axis] >= 0)
        body.external[dofs_[nearest][axis]] += force[axis];
  }
}

double ElasticSolid::kineticEnergy(const Body& body) const
{
  const Eigen::VectorXd& v = body.state.v;
  return 0.5 * v.dot(mass_ * v);
}

double ElasticSolid::potentialEnergy(const Body& body, const Eigen::Vector3d& gravity) const
{
  const Eigen::VectorXd& q = body.state.q;
  double energy = 0.5 * q.dot(stiffness_ * q);
  const Eigen::Vector3d pull = body.end.base_pose.linear().transpose() * gravity;
  for (int axis = 0; axis < 3; ++axis)
    energy -= pull[axis] * carried_[axis].dot(q);
  if (!is_supported_)
    energy -= total_mass_ * gravity.dot(body.end.base_pose.translation());
  return energy;
}

double ElasticSolid::dampingPower(const VectorIn& v) const
{
  return damping_ == 0.0 ? 0.0 : damping_ * v.dot(stiffness_ * v);
}

std::string ElasticSolid::refusal(const VectorIn& q) const
{
  const double turned = rotation(q);
  if (turned <= MOST_ROTATION)
    return "";
  return "elastic body '" + name_ + "' has turned by " + std::to_string(turned) + " rad, expected at most " +
         std::to_string(MOST_ROTATION) + " rad: linear elasticity in a fixed frame does not hold beyond";
}

std::string ElasticSolid::wrenchRefusal(const ExternalWrench& wrench) const
{
  return wrench.torque.isZero(0.0) ? "" : "found a torque, expected a force alone: nodes do not turn";
}

std::string ElasticSolid::staticsRefusal() const
{
  if (!is_supported_)
    return "moves freely beside an elastic body, expected bodies with supports alone";
  return is_held_ ? "" : "can move as a whole in spite of its supports, expected 'fixed' nodes that hold it";
}

MultibodyModel nodeTree(const std::string& name, const std::vector<Eigen::Vector3d>& nodes,
                        const std::vector<int>& surface)
{
  MultibodyModel tree = rootTree(name);
  for (const int node : surface)
    addLink("node_" + std::to_string(node), nodes[node], Sphere{0.0}, Eigen::Matrix3d::Identity(), tree);
  finalize(tree);
  return tree;
}

}  // namespace frictional_contact_sim
