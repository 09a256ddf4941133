#include "frictional_contact_sim/deformable/elastic_solid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "frictional_contact_sim/dynamics/surface_contacts.h"
#include "frictional_contact_sim/model/model_error.h"
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

/** Rows and columns of the coordinates that are kept. */
SparseRows restricted(const SparseRows& matrix, const std::vector<int>& kept, int size)
{
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < matrix.rows(); ++row)
    for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      if (kept[row] >= 0 && kept[entry.col()] >= 0)
        entries.emplace_back(kept[row], kept[entry.col()], entry.value());
  SparseRows result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}
}  // namespace

ElasticSolid::ElasticSolid(const std::string& name, ElasticParts parts, const std::vector<int>& supports,
                           double damping)
  : name_(name), parts_(std::move(parts)), damping_(damping), is_supported_(!supports.empty())
{
  setMatrices(supports);
  setSurface();
}

void ElasticSolid::setMatrices(const std::vector<int>& supports)
{
  const std::vector<int>& axes = axesOf(parts_.dimension);
  const int d = parts_.dimension;
  const auto count = parts_.nodes.size();
  std::vector<char> is_fixed(count, 0);
  for (const int node : supports)
    is_fixed[node] = 1;
  dofs_.assign(count, Eigen::Vector3i::Constant(-1));
  std::vector<int> kept(count * d, -1);
  int size = 0;
  for (size_t node = 0; node < count; ++node)
    for (int i = 0; i < d && is_fixed[node] == 0; ++i)
      dofs_[node][axes[i]] = kept[node * d + i] = size++;
  if (size == 0)
    throw ModelError("every node is fixed, expected one at least that moves");
  // One pattern for both, so that M + c K is entry by entry.
  mass_ = restricted(parts_.mass + 0.0 * parts_.stiffness, kept, size);
  stiffness_ = restricted(parts_.stiffness + 0.0 * parts_.mass, kept, size);
  mass_.makeCompressed();
  stiffness_.makeCompressed();
  columns_.resize(size);
  for (int row = 0; row < size; ++row)
    for (SparseRows::InnerIterator entry(mass_, row); entry; ++entry)
      columns_[row].push_back(static_cast<int>(entry.col()));
  for (int i = 0; i < 3; ++i)
    carried_[i] = Eigen::VectorXd::Zero(size);
  for (int i = 0; i < d; ++i)
  {
    Eigen::VectorXd translation = Eigen::VectorXd::Zero(parts_.mass.rows());
    for (size_t node = 0; node < count; ++node)
      translation[node * d + i] = 1.0;
    const Eigen::VectorXd product = parts_.mass * translation;
    total_mass_ = translation.dot(product);
    for (size_t row = 0; row < kept.size(); ++row)
      if (kept[row] >= 0)
        carried_[axes[i]][kept[row]] = product[row];
  }
  try
  {
    MassFactor().compute(mass_);
  }
  catch (const std::invalid_argument& error)
  {
    throw ModelError(std::string("the mass matrix is refused: ") + error.what());
  }
}

void ElasticSolid::setSurface()
{
  const std::vector<int>& surface = parts_.surface;
  const auto linkOf = [&](int node)
  { return 1 + static_cast<int>(std::lower_bound(surface.begin(), surface.end(), node) - surface.begin()); };
  node_distance_ = std::numeric_limits<double>::infinity();
  for (const std::array<int, 3>& nodes : parts_.facets)
  {
    Facet facet;
    facet.count = parts_.dimension;
    for (int k = 0; k < facet.count; ++k)
      facet.links[k] = linkOf(nodes[k]);
    for (int k = 1; k < facet.count; ++k)
      node_distance_ = std::min(node_distance_, (parts_.nodes[nodes[k]] - parts_.nodes[nodes[k - 1]]).norm());
    if (facet.count == 1)  // an end of a bar, which is about the origin
      facet.axis.x() = parts_.nodes[nodes[0]].x() < 0.0 ? -1.0 : 1.0;
    facets_.push_back(facet);
  }
  if (parts_.dimension == 1)
    for (const std::array<int, 4>& cell : parts_.cells)
      node_distance_ = std::min(node_distance_, (parts_.nodes[cell[1]] - parts_.nodes[cell[0]]).norm());
  if (std::isfinite(node_distance_))
    return;
  for (size_t i = 0; i < surface.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      node_distance_ = std::min(node_distance_, (parts_.nodes[surface[i]] - parts_.nodes[surface[k]]).norm());
  if (!std::isfinite(node_distance_))
    node_distance_ = 1.0;
}

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
  const std::vector<Eigen::Vector3d> u = displacements(q);
  double most = 0.0;
  if (parts_.dimension == 1)
    return most;
  for (const std::array<int, 4>& cell : parts_.cells)
    most = std::max(most, cellRotation(parts_, cell, u).norm());
  if (!parts_.cells.empty())
    return most;
  // The rigid rotation nearest to u (least squares over the nodes).
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < u.size(); ++i)
  {
    center += parts_.nodes[i] / static_cast<double>(u.size());
    shift += u[i] / static_cast<double>(u.size());
  }
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < u.size(); ++i)
  {
    const Eigen::Vector3d arm = parts_.nodes[i] - center;
    inertia += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    moment += arm.cross(u[i] - shift);
  }
  return inertia.trace() > 0.0 ? inertia.fullPivLu().solve(moment).norm() : 0.0;
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
  // Nothing holds a free body against its rigid motions but its inertia: a proximal term.
  const double of_mass = is_motion || !is_supported_ ? 1.0 : 0.0;
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

double ElasticSolid::potentialEnergy(const Body& body, const VectorIn& q, const Eigen::Vector3d& gravity) const
{
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
