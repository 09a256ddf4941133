// An elastic solid as it is made: what is free of its matrices, whether they are those of one, its surface.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/math/cross_matrix.h"
#include "frictional_contact_sim/model/model_error.h"
#include "frictional_contact_sim/problem/mass_factor.h"

namespace frictional_contact_sim
{
namespace
{
/// What K may have left against a translation, of the sum of its row's magnitudes: a file's last digits.
constexpr double TRANSLATION_ROUND_OFF = 1e-9;
/// Squares of frequencies over the highest: a motion that grows more slowly is round-off, one that is softer is free.
constexpr double GROWTH = 1e-10;
constexpr double SOFTEST = 1e-14;

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

/** Empty, or why a matrix is not positive definite. */
std::string indefiniteness(const SparseRows& matrix, MassFactor& factor)
{
  try
  {
    factor.compute(matrix);
    return "";
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
}
}  // namespace

ElasticSolid::ElasticSolid(const std::string& name, ElasticParts parts, const std::vector<int>& supports,
                           double damping)
  : name_(name), parts_(std::move(parts)), damping_(damping), is_supported_(!supports.empty())
{
  setMatrices(supports);
  checkMatrices();
  setRotations();
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
}

/** M is positive definite, K semi-definite; without supports neither knows of any. Sets is_held_. */
void ElasticSolid::checkMatrices()
{
  MassFactor factor;
  if (const std::string reason = indefiniteness(mass_, factor); !reason.empty())
    throw ModelError("the mass matrix is refused: " + reason);
  if (!is_supported_)
    checkFree();
  const double highest = std::max(1e-200, (stiffness_.diagonal().array().abs() / mass_.diagonal().array()).maxCoeff());
  if (!indefiniteness(stiffness_ + GROWTH * highest * mass_, factor).empty())
    throw ModelError(
        "the stiffness matrix is refused: found a deformation that it drives apart (a negative eigenvalue), expected a "
        "positive semi-definite matrix");
  is_held_ = is_supported_ && indefiniteness(stiffness_ - SOFTEST * highest * mass_, factor).empty();
}

/** A free body has one mass along all axes and resists no translation; constraints in its matrices break both. */
void ElasticSolid::checkFree() const
{
  const std::vector<int>& axes = axesOf(parts_.dimension);
  static const char* const NAMES[] = {"x", "y", "z"};
  const Eigen::VectorXd magnitudes = stiffness_.cwiseAbs() * Eigen::VectorXd::Ones(velocities());
  for (const int axis : axes)
  {
    const Eigen::VectorXd translation = rigidVelocity(Eigen::Vector3d::Unit(axis), Eigen::Vector3d::Zero());
    const double mass = translation.dot(mass_ * translation);
    if (!(std::abs(mass - total_mass_) <= TRANSLATION_ROUND_OFF * total_mass_))
      throw ModelError("the mass matrix is refused: found " + numberText(mass) + " kg along " + NAMES[axis] + " and " +
                       numberText(total_mass_) + " kg along " + NAMES[axes.back()] +
                       ", expected one mass: constraints belong into 'fixed', not into the matrices");
    const Eigen::VectorXd force = stiffness_ * translation;
    for (Eigen::Index row = 0; row < force.size(); ++row)
      if (!(std::abs(force[row]) <= TRANSLATION_ROUND_OFF * magnitudes[row]))
        throw ModelError("the stiffness matrix is refused: found that row " + std::to_string(row + 1) +
                         " resists a translation along " + NAMES[axis] + " with " + numberText(force[row]) +
                         " N/m, expected 0 of a body without 'fixed' nodes: constraints do not belong into the "
                         "matrices, and they need 10 digits");
  }
}

/** Rows of rotation_: half the curl of u on each cell; without cells the rigid rotation nearest to u (least squares
 * over the nodes). Bars have none. */
void ElasticSolid::setRotations()
{
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int first_row, int node, const Eigen::Matrix3d& of_u)
  {
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 3 && dofs_[node][axis] >= 0; ++k)
        if (of_u(k, axis) != 0.0)
          entries.emplace_back(first_row + k, dofs_[node][axis], of_u(k, axis));
  };
  int rows = 0;
  if (parts_.dimension > 1 && parts_.cells.empty())
  {
    rows = 3;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& node : parts_.nodes)
      center += node / static_cast<double>(parts_.nodes.size());
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& node : parts_.nodes)
      inertia -= crossMatrix(node - center) * crossMatrix(node - center);
    const Eigen::FullPivLU<Eigen::Matrix3d> factor(inertia);  // rows of nodes on one line do not turn about it
    for (size_t node = 0; node < parts_.nodes.size() && inertia.trace() > 0.0; ++node)
      add(0, static_cast<int>(node), factor.solve(crossMatrix(parts_.nodes[node] - center)));
  }
  else if (parts_.dimension > 1)
    for (const std::array<int, 4>& cell : parts_.cells)
    {
      const Eigen::Matrix<double, 4, 3> gradients = cellGradients(parts_, cell);
      for (int a = 0; a <= parts_.dimension; ++a)
        add(rows, cell[a], 0.5 * crossMatrix(gradients.row(a)));
      rows += 3;
    }
  rotation_.resize(rows, velocities());
  rotation_.setFromTriplets(entries.begin(), entries.end());
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

}  // namespace frictional_contact_sim
