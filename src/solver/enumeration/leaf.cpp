#include "leaf.h"

#include <Eigen/QR>
#include <algorithm>

#include "polytope.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double RANK = 1e-10;  ///< of equations whose data are about one
constexpr double CONSTANT = 1e-10;  ///< an inequality whose coefficients are that small says nothing
constexpr double SAME_POINT = 1e-7;  ///< relative distance of points that count as one
constexpr double SAME_VELOCITY = 1e-9;  ///< change of u over one of r; data are about one
constexpr int MAX_CUTS = 200;

/// The cell's equations for its free columns: rows x = y_F.
struct Equations
{
  std::vector<Eigen::Index> free;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

Eigen::MatrixXd columnsOf(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& columns)
{
  Eigen::MatrixXd result(matrix.rows(), columns.size());
  for (size_t j = 0; j < columns.size(); ++j)
    result.col(static_cast<Eigen::Index>(j)) = matrix.col(columns[j]);
  return result;
}

/// y with its free columns zero.
Eigen::VectorXd fixedPart(const Relaxation& relaxation, const std::vector<Eigen::Index>& free)
{
  Eigen::VectorXd fixed = relaxation.columnLower();
  for (const Eigen::Index j : free)
    fixed[j] = 0.0;
  return fixed;
}

Equations equationsOf(const Relaxation& relaxation)
{
  Equations equations;
  for (Eigen::Index j = 0; j < relaxation.columnLower().size(); ++j)
    if (relaxation.columnLower()[j] < relaxation.columnUpper()[j])
      equations.free.push_back(j);
  const Eigen::VectorXd fixed = fixedPart(relaxation, equations.free);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < relaxation.rowLower().size(); ++i)
    if (relaxation.rowLower()[i] == relaxation.rowUpper()[i])
      rows.push_back(i);
  const Eigen::MatrixXd free = columnsOf(relaxation.matrix(), equations.free);
  equations.matrix.resize(static_cast<Eigen::Index>(rows.size()), free.cols());
  equations.right.resize(static_cast<Eigen::Index>(rows.size()));
  for (size_t k = 0; k < rows.size(); ++k)
  {
    const auto row = static_cast<Eigen::Index>(k);
    equations.matrix.row(row) = free.row(rows[k]);
    equations.right[row] = relaxation.rowLower()[rows[k]] - relaxation.matrix().row(rows[k]).dot(fixed);
  }
  return equations;
}

/// Orthonormal basis of the null space, free.size() x nullity.
Eigen::MatrixXd nullSpace(const Eigen::MatrixXd& matrix)
{
  if (matrix.rows() == 0 || matrix.cols() == 0)
    return Eigen::MatrixXd::Identity(matrix.cols(), matrix.cols());
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
  factor.setThreshold(RANK);
  factor.compute(matrix.transpose());
  const Eigen::MatrixXd Q = factor.householderQ();
  return Q.rightCols(matrix.cols() - factor.rank());
}

/// The simplex method's point, moved on to the cell's equations.
Eigen::VectorXd pointOnEquations(const Relaxation& relaxation, const Equations& equations)
{
  Eigen::VectorXd y(equations.free.size());
  for (size_t j = 0; j < equations.free.size(); ++j)
    y[static_cast<Eigen::Index>(j)] = relaxation.point()[equations.free[j]];
  if (equations.matrix.size() == 0)
    return y;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(RANK);
  factor.compute(equations.matrix);
  return y + factor.solve(equations.right - equations.matrix * y);
}

/// The cell's inequalities on z, y_F = origin + basis z:  C z >= d.
void inequalities(const Relaxation& relaxation, const Equations& equations, const Eigen::VectorXd& origin,
                  const Eigen::MatrixXd& basis, Eigen::MatrixXd& C, Eigen::VectorXd& d)
{
  std::vector<Eigen::VectorXd> normals;
  std::vector<double> offsets;
  const auto add = [&](const Eigen::VectorXd& normal, double value, double lower, double upper)
  {
    if (normal.lpNorm<Eigen::Infinity>() < CONSTANT || lower == upper)
      return;
    if (lower > -LinearProgram::INFINITE)
    {
      normals.push_back(normal);
      offsets.push_back(lower - value);
    }
    if (upper < LinearProgram::INFINITE)
    {
      normals.emplace_back(-normal);
      offsets.push_back(value - upper);
    }
  };
  for (size_t j = 0; j < equations.free.size(); ++j)
  {
    const auto row = static_cast<Eigen::Index>(j);
    add(basis.row(row), origin[row], relaxation.columnLower()[equations.free[j]],
        relaxation.columnUpper()[equations.free[j]]);
  }
  const Eigen::VectorXd fixed = fixedPart(relaxation, equations.free);
  const Eigen::MatrixXd free = columnsOf(relaxation.matrix(), equations.free);
  const Eigen::MatrixXd slopes = free * basis;
  const Eigen::VectorXd values = free * origin + relaxation.matrix() * fixed;
  for (Eigen::Index i = 0; i < slopes.rows(); ++i)
    add(slopes.row(i), values[i], relaxation.rowLower()[i], relaxation.rowUpper()[i]);
  C.resize(static_cast<Eigen::Index>(normals.size()), basis.cols());
  d.resize(C.rows());
  for (size_t k = 0; k < normals.size(); ++k)
  {
    C.row(static_cast<Eigen::Index>(k)) = normals[k].transpose();
    d[static_cast<Eigen::Index>(k)] = offsets[k];
  }
}

/// Points that are one but for round-off are listed once.
void dropRepeated(std::vector<Eigen::VectorXd>& points)
{
  std::vector<Eigen::VectorXd> kept;
  for (const Eigen::VectorXd& point : points)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const Eigen::VectorXd& other) {
                       return (point - other).lpNorm<Eigen::Infinity>() <=
                              SAME_POINT * std::max(1.0, point.lpNorm<Eigen::Infinity>());
                     }))
      kept.push_back(point);
  points = std::move(kept);
}

bool sticksInSpace(const Relaxation& relaxation, const Cell& cell)
{
  for (size_t i = 0; i < cell.modes.size(); ++i)
    if (cell.modes[i] == LawMode::STICK && relaxation.isSpatial(static_cast<int>(i)))
      return true;
  return false;
}

/// One point and the dimension, from the linear programs of the relative interior.
void describeByPoint(Relaxation& relaxation, const Equations& equations, Leaf& leaf)
{
  Eigen::VectorXd point = relaxation.point();
  const Eigen::MatrixXd implied = columnsOf(relaxation.impliedEquations(), equations.free);
  Eigen::MatrixXd all(equations.matrix.rows() + implied.rows(), equations.matrix.cols());
  all << equations.matrix, implied;
  const Eigen::MatrixXd directions = nullSpace(all);
  leaf.piece.dimension = static_cast<int>(directions.cols());
  leaf.piece.unique_velocity =
      directions.cols() == 0 ||
      (columnsOf(relaxation.velocities(), equations.free) * directions).cwiseAbs().maxCoeff() < SAME_VELOCITY;
  leaf.piece.vertices_complete = leaf.piece.dimension == 0;
  if (!relaxation.leavesCones(leaf.cell))
    point = relaxation.point();  // in the relative interior of the polyhedron and in the cones
  leaf.piece.vertices = {relaxation.impulses(point)};
  leaf.piece.bounded = leaf.piece.dimension == 0 || relaxation.isBounded();
}
}  // namespace

std::optional<Leaf> makeLeaf(Relaxation& relaxation, const Cell& cell, const EnumerateOptions& options, bool& closed)
{
  closed = true;
  for (int cuts = 0; relaxation.cutCones(cell); ++cuts)
  {
    const Feasibility feasibility = cuts < MAX_CUTS ? relaxation.solve(cell) : Feasibility::UNPROVED;
    closed = feasibility != Feasibility::UNPROVED;
    if (feasibility != Feasibility::FEASIBLE)
      return std::nullopt;
  }
  Leaf leaf;
  leaf.cell = cell;
  leaf.piece.modes = cell.modes;
  const Equations equations = equationsOf(relaxation);
  const Eigen::VectorXd origin = pointOnEquations(relaxation, equations);
  const Eigen::MatrixXd basis = nullSpace(equations.matrix);
  const auto impulses = [&](const Eigen::VectorXd& free)
  {
    Eigen::VectorXd y = fixedPart(relaxation, equations.free);
    for (size_t j = 0; j < equations.free.size(); ++j)
      y[equations.free[j]] = free[static_cast<Eigen::Index>(j)];
    return relaxation.impulses(y);
  };
  if (basis.cols() == 0)
  {
    leaf.piece.vertices = {impulses(origin)};
    return leaf;
  }
  Polytope polytope;
  polytope.complete = false;
  if (!sticksInSpace(relaxation, cell))
  {
    Eigen::MatrixXd C;
    Eigen::VectorXd d;
    inequalities(relaxation, equations, origin, basis, C, d);
    polytope = enumerateVertices(C, d, static_cast<size_t>(options.max_vertices));
  }
  if (!polytope.complete || polytope.vertices.empty())
  {
    describeByPoint(relaxation, equations, leaf);
    return leaf;
  }
  for (const Eigen::VectorXd& vertex : polytope.vertices)
    leaf.piece.vertices.push_back(impulses(origin + basis * vertex));
  dropRepeated(leaf.piece.vertices);
  for (const Eigen::VectorXd& ray : polytope.rays)
    leaf.piece.rays.push_back(impulses(origin + basis * ray) - impulses(origin));
  leaf.piece.bounded = leaf.piece.rays.empty();
  leaf.piece.dimension = affineDimension(leaf.piece.vertices, leaf.piece.rays, SAME_POINT);
  return leaf;
}

}  // namespace frictional_contact_sim
