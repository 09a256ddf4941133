#include "frictional_contact_sim/separation/polyhedron.h"

#include <limits>
#include <stdexcept>
#include <vector>

#include "dense_rows.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int SIMPLEX_ITERATIONS = 100000;
}  // namespace

void validate(const Polyhedron& polyhedron, const std::string& name)
{
  if (polyhedron.A.rows() != polyhedron.b.size())
    throw std::invalid_argument(name + ": A has " + std::to_string(polyhedron.A.rows()) + " rows, b " +
                                std::to_string(polyhedron.b.size()) + ", expected as many");
  if (!polyhedron.A.allFinite() || !polyhedron.b.allFinite())
    throw std::invalid_argument(name + ": a number is not finite");
}

Polyhedron intersection(const Polyhedron& first, const Polyhedron& second)
{
  if (first.dimension() != second.dimension())
    throw std::invalid_argument("polyhedra: dimensions are " + std::to_string(first.dimension()) + " and " +
                                std::to_string(second.dimension()) + ", expected the same");
  Polyhedron both;
  both.A.resize(first.rows() + second.rows(), first.dimension());
  both.A << first.A, second.A;
  both.b.resize(first.rows() + second.rows());
  both.b << first.b, second.b;
  return both;
}

Polyhedron translated(const Polyhedron& polyhedron, const Eigen::VectorXd& origin)
{
  return {polyhedron.A, polyhedron.b - polyhedron.A * origin};
}

Polyhedron withUnitRows(const Polyhedron& polyhedron)
{
  Polyhedron result = polyhedron;
  for (Eigen::Index i = 0; i < result.A.rows(); ++i)
  {
    const double length = result.A.row(i).norm();
    if (!(length > 0.0))
      continue;
    result.A.row(i) /= length;
    result.b[i] /= length;
  }
  return result;
}

Eigen::MatrixXd normalConeMultipliers(const Eigen::VectorXd& b)
{
  std::vector<Eigen::Index> negative, positive;
  for (Eigen::Index i = 0; i < b.size(); ++i)
    if (b[i] != 0.0)
      (b[i] < 0.0 ? negative : positive).push_back(i);
  const Eigen::Index single = b.size() - static_cast<Eigen::Index>(positive.size());
  Eigen::MatrixXd E =
      Eigen::MatrixXd::Zero(b.size(), single + static_cast<Eigen::Index>(negative.size() * positive.size()));
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < b.size(); ++i)
    if (b[i] <= 0.0)
      E(i, column++) = 1.0;
  for (const Eigen::Index i : negative)
    for (const Eigen::Index j : positive)
    {
      E(i, column) = b[j];
      E(j, column++) = -b[i];
    }
  return E;
}

Eigen::MatrixXd normalConeGenerators(const Polyhedron& polyhedron)
{
  return polyhedron.A.transpose() * normalConeMultipliers(polyhedron.b);
}

Eigen::MatrixXd reversePolarPoints(const Polyhedron& polyhedron)
{
  Eigen::MatrixXd points(polyhedron.dimension(), (polyhedron.b.array() < 0.0).count());
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < polyhedron.b.size(); ++i)
    if (polyhedron.b[i] < 0.0)
      points.col(column++) = -polyhedron.A.row(i).transpose() / polyhedron.b[i];
  return points;
}

SupportProgram::SupportProgram(const Polyhedron& polyhedron)
{
  for (int j = 0; j < polyhedron.dimension(); ++j)
    program_.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0);
  const Polyhedron unit = withUnitRows(polyhedron);
  for (int i = 0; i < unit.rows(); ++i)
    addDenseRow(program_, -LinearProgram::INFINITE, unit.b[i], unit.A.row(i), 0);
  feasible_ = solveFirst(program_);
}

Support SupportProgram::maximise(const Eigen::VectorXd& direction)
{
  Support support;
  if (!feasible_)
  {
    support.status = program_.status();
    support.value = -std::numeric_limits<double>::infinity();
    return support;
  }
  program_.setCosts(-direction);
  program_.solvePrimal(SIMPLEX_ITERATIONS);
  support.status = program_.status();
  if (support.status == LinearProgramStatus::OPTIMAL)
  {
    support.point = program_.solution();
    support.value = direction.dot(support.point);
  }
  else if (support.status == LinearProgramStatus::UNBOUNDED)
  {
    support.point = program_.unboundedRay();
    support.value = std::numeric_limits<double>::infinity();
  }
  return support;
}

}  // namespace frictional_contact_sim
