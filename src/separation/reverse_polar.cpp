#include "frictional_contact_sim/separation/reverse_polar.h"

#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
/// Columns without doubles and, where they are rays, of length one without those of length zero.
std::vector<Eigen::VectorXd> distinct(const Eigen::MatrixXd& columns, bool rays, double tolerance)
{
  std::vector<Eigen::VectorXd> result;
  const double size = columns.size() == 0 ? 0.0 : columns.cwiseAbs().maxCoeff();
  for (Eigen::Index j = 0; j < columns.cols(); ++j)
  {
    Eigen::VectorXd column = columns.col(j);
    if (rays && column.norm() <= tolerance * size)
      continue;
    if (rays)
      column.normalize();
    bool is_new = true;
    for (const Eigen::VectorXd& other : result)
      is_new = is_new && (column - other).norm() > tolerance * column.norm();
    if (is_new)
      result.push_back(column);
  }
  return result;
}

Eigen::MatrixXd matrixOf(const std::vector<Eigen::VectorXd>& columns, Eigen::Index rows)
{
  Eigen::MatrixXd result(rows, static_cast<Eigen::Index>(columns.size()));
  for (size_t j = 0; j < columns.size(); ++j)
    result.col(static_cast<Eigen::Index>(j)) = columns[j];
  return result;
}

/// Whether the origin is farther than `tolerance` from conv(points) + cone(rays).
bool isApart(const Eigen::MatrixXd& points, const Eigen::MatrixXd& rays, double tolerance)
{
  if (points.cols() == 0)
    return true;
  return nearestPoint(listOracle(points, rays), points.col(0)).point.norm() > tolerance;
}

void requireSeparable(const Polyhedron& polyhedron)
{
  validate(polyhedron, "polyhedron");
  if (!(polyhedron.b.size() > 0 && polyhedron.b.minCoeff() < 0.0))
    throw std::invalid_argument("polyhedron: the origin is in it, expected some b_i < 0");
}
}  // namespace

ReversePolar reversePolar(const Polyhedron& polyhedron, double tolerance)
{
  requireSeparable(polyhedron);
  const Eigen::Index n = polyhedron.dimension();
  std::vector<Eigen::VectorXd> points = distinct(reversePolarPoints(polyhedron), false, tolerance);
  std::vector<Eigen::VectorXd> rays = distinct(normalConeGenerators(polyhedron), true, tolerance);
  for (size_t j = 0; j < rays.size();)
  {
    std::vector<Eigen::VectorXd> others = rays;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(j));
    if (isApart(-rays[j], matrixOf(others, n), tolerance))
      ++j;
    else
      rays = std::move(others);
  }
  const Eigen::MatrixXd cone = matrixOf(rays, n);
  for (size_t j = 0; j < points.size();)
  {
    std::vector<Eigen::VectorXd> others = points;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(j));
    if (isApart(matrixOf(others, n).colwise() - points[j], cone, tolerance * points[j].norm()))
      ++j;
    else
      points = std::move(others);
  }
  return {matrixOf(points, n), cone};
}

NearestPoint deepestCut(const Polyhedron& polyhedron, const NearestPointOptions& options)
{
  requireSeparable(polyhedron);
  const Eigen::MatrixXd points = reversePolarPoints(polyhedron);
  return nearestPoint(listOracle(points, normalConeGenerators(polyhedron)), points.col(0), options);
}

}  // namespace frictional_contact_sim
