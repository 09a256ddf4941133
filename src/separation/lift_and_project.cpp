#include "frictional_contact_sim/separation/lift_and_project.h"

#include <stdexcept>

#include "dense_rows.h"

namespace frictional_contact_sim
{
namespace
{
/// Violations below this are none, in units of rows of length one.
constexpr double NONE = 1e-9;

void checkVariable(const Polyhedron& polyhedron, int variable)
{
  validate(polyhedron, "lift-and-project");
  if (variable < 0 || variable >= polyhedron.dimension())
    throw std::invalid_argument("lift-and-project: variable is " + std::to_string(variable) + ", expected 0 to " +
                                std::to_string(polyhedron.dimension() - 1));
}

/// A without column j.
Eigen::MatrixXd without(const Eigen::MatrixXd& A, int column)
{
  Eigen::MatrixXd result(A.rows(), A.cols() - 1);
  result << A.leftCols(column), A.rightCols(A.cols() - column - 1);
  return result;
}
}  // namespace

Polyhedron liftedPolyhedron(const Polyhedron& polyhedron, int variable)
{
  checkVariable(polyhedron, variable);
  const Eigen::MatrixXd& A = polyhedron.A;
  const Eigen::MatrixXd rest = without(A, variable);
  const Eigen::VectorXd shift = A.col(variable) - polyhedron.b;
  const Eigen::Index m = A.rows(), n = A.cols();
  Polyhedron lifted = {Eigen::MatrixXd::Zero(2 * m, 2 * n - 1), Eigen::VectorXd::Zero(2 * m)};
  lifted.A.topRightCorner(m, n - 1) = rest;
  lifted.A.topLeftCorner(m, n).col(variable) = shift;
  lifted.A.bottomLeftCorner(m, n) = A;
  lifted.A.bottomLeftCorner(m, n).col(variable) -= shift;
  lifted.A.bottomRightCorner(m, n - 1) = -rest;
  lifted.b.tail(m) = polyhedron.b;
  return lifted;
}

LiftAndProjectCut liftAndProjectCut(const Polyhedron& polyhedron, int variable, const Eigen::VectorXd& point)
{
  checkVariable(polyhedron, variable);
  if (point.size() != polyhedron.dimension())
    throw std::invalid_argument("lift-and-project: the point has " + std::to_string(point.size()) +
                                " numbers, expected " + std::to_string(polyhedron.dimension()));
  const Polyhedron unit = withUnitRows(polyhedron);
  const Eigen::MatrixXd rest = without(unit.A, variable);
  const Eigen::VectorXd shift = unit.A.col(variable) - unit.b;
  const int m = unit.rows();
  // -(d.x - e) as costs of u_0 and u_1.
  const Eigen::VectorXd of_u0 = unit.A * point - point[variable] * shift - unit.b, of_u1 = point[variable] * shift;
  LinearProgram program;
  for (int i = 0; i < 2 * m; ++i)
    program.addColumn(0.0, LinearProgram::INFINITE, i < m ? -of_u0[i] : -of_u1[i - m]);
  for (Eigen::Index j = 0; j < rest.cols(); ++j)
  {
    ProgramRow row;
    row.add(rest.col(j), 0);
    row.add(rest.col(j), m, -1.0);
    row.addTo(program, 0.0, 0.0);
  }
  addDenseRow(program, -LinearProgram::INFINITE, 1.0, Eigen::VectorXd::Ones(2 * m), 0);
  LiftAndProjectCut cut;
  if (!solveFirst(program))
    return cut;
  const Eigen::VectorXd u = program.solution();
  cut.direction = unit.A.transpose() * u.head(m);
  cut.direction[variable] += shift.dot(u.tail(m) - u.head(m));
  cut.right_hand_side = unit.b.dot(u.head(m));
  cut.violation = cut.direction.dot(point) - cut.right_hand_side;
  cut.found = cut.violation > NONE;
  return cut;
}

}  // namespace frictional_contact_sim
