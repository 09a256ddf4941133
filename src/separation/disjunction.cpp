#include "frictional_contact_sim/separation/disjunction.h"

#include <Eigen/QR>
#include <limits>
#include <stdexcept>

#include "dense_rows.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int SIMPLEX_ITERATIONS = 100000;
/// Rows that no point fulfils up to this: an empty term.
constexpr double EMPTY = 1e-8;
/// A face is looked at within a box of half size 1 around one of its points; thinner than this is flat.
constexpr double FLAT = 1e-6;

/**
 * x in Q with d.x = value, |x - point| <= 1: x = sum y_k, A_k y_k <= t_k b_k, sum t_k = 1 (Balas). Columns x, then y_k,
 * then t_k.
 */
class FaceProgram
{
public:
  FaceProgram(const Disjunction& disjunction, const Eigen::VectorXd& direction, double value,
              const Eigen::VectorXd& point)
    : n_(disjunction.dimension())
  {
    const auto terms = static_cast<int>(disjunction.terms.size());
    for (int j = 0; j < n_; ++j)
      program_.addColumn(point[j] - 1.0, point[j] + 1.0, 0.0);
    for (int j = 0; j < terms * n_; ++j)
      program_.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0);
    for (int k = 0; k < terms; ++k)
      program_.addColumn(0.0, 1.0, 0.0);
    const int weight = (terms + 1) * n_;
    ProgramRow sum;
    for (int k = 0; k < terms; ++k)
    {
      const Polyhedron unit = withUnitRows(disjunction.term(static_cast<size_t>(k)));
      for (int i = 0; i < unit.rows(); ++i)
      {
        ProgramRow row;
        row.add(unit.A.row(i), (k + 1) * n_);
        row.add(weight + k, -unit.b[i]);
        row.addTo(program_, -LinearProgram::INFINITE, 0.0);
      }
      sum.add(weight + k, 1.0);
    }
    sum.addTo(program_, 1.0, 1.0);
    for (int j = 0; j < n_; ++j)
    {
      ProgramRow row;
      row.add(j, 1.0);
      for (int k = 0; k < terms; ++k)
        row.add((k + 1) * n_ + j, -1.0);
      row.addTo(program_, 0.0, 0.0);
    }
    if (direction.norm() > 0.0)
      addDenseRow(program_, value, value, direction, 0);
    size_ = weight + terms;
    feasible_ = solveFirst(program_);
  }

  bool feasible() const { return feasible_; }
  Eigen::VectorXd point() const { return program_.solution().head(n_); }

  /** A point with the least direction.x. */
  Eigen::VectorXd lowest(const Eigen::VectorXd& direction)
  {
    Eigen::VectorXd costs = Eigen::VectorXd::Zero(size_);
    costs.head(n_) = direction;
    program_.setCosts(costs);
    if (!program_.solvePrimal(SIMPLEX_ITERATIONS))
      throw std::runtime_error("face: the simplex method lost its digits");
    return point();
  }

private:
  int n_;
  int size_ = 0;
  bool feasible_ = false;
  LinearProgram program_;
};
/// The least t >= 0 with A x <= b + t, rows of length one, is above zero. A term that is dropped though it has points
/// would make false cuts, so this asks for no INFEASIBLE of the simplex method.
bool isEmpty(const Polyhedron& polyhedron)
{
  const Polyhedron unit = withUnitRows(polyhedron);
  LinearProgram program;
  for (int j = 0; j < unit.dimension(); ++j)
    program.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0);
  const int slack = program.addColumn(0.0, LinearProgram::INFINITE, 1.0);
  for (int i = 0; i < unit.rows(); ++i)
  {
    ProgramRow row;
    row.add(unit.A.row(i), 0);
    row.add(slack, -1.0);
    row.addTo(program, -LinearProgram::INFINITE, unit.b[i]);
  }
  return solveFirst(program) && program.solution()[slack] > EMPTY;
}
}  // namespace

void validate(const Disjunction& disjunction)
{
  if (disjunction.terms.empty())
    throw std::invalid_argument("disjunction: has no term, expected one at least");
  validate(disjunction.common, "disjunction: common rows");
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
  {
    const std::string name = "disjunction: term " + std::to_string(k);
    validate(disjunction.terms[k], name);
    if (disjunction.terms[k].dimension() != disjunction.dimension())
      throw std::invalid_argument(name + " has dimension " + std::to_string(disjunction.terms[k].dimension()) +
                                  ", expected " + std::to_string(disjunction.dimension()));
  }
}

Disjunction splitDisjunction(const Polyhedron& relaxation, const Eigen::VectorXd& pi, double pi_0, double pi_1)
{
  if (!(pi_0 < 0.0 && pi_1 > 0.0))
    throw std::invalid_argument("split: pi_0 is " + std::to_string(pi_0) + ", pi_1 " + std::to_string(pi_1) +
                                ", expected pi_0 < 0 < pi_1");
  Disjunction split = {
      relaxation,
      {{pi.transpose(), Eigen::VectorXd::Constant(1, pi_0)}, {-pi.transpose(), Eigen::VectorXd::Constant(1, -pi_1)}}};
  validate(split);
  return split;
}

Disjunction withoutEmptyTerms(const Disjunction& disjunction)
{
  Disjunction result = {disjunction.common, {}};
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
    if (!isEmpty(disjunction.term(k)))
      result.terms.push_back(disjunction.terms[k]);
  return result;
}

Support support(const Disjunction& disjunction, const Eigen::VectorXd& direction)
{
  Support largest;
  largest.status = LinearProgramStatus::INFEASIBLE;
  largest.value = -std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
  {
    const Support one = SupportProgram(disjunction.term(k)).maximise(direction);
    if (one.status == LinearProgramStatus::STOPPED)
      return one;
    if (one.status != LinearProgramStatus::INFEASIBLE &&
        (largest.status == LinearProgramStatus::INFEASIBLE || one.value > largest.value))
      largest = one;
  }
  return largest;
}

int faceDimension(const Disjunction& given, const Eigen::VectorXd& direction)
{
  validate(given);
  const Disjunction disjunction = withoutEmptyTerms(given);
  const int n = disjunction.dimension();
  const double length = direction.norm();
  const Eigen::VectorXd normal = length > 0.0 ? Eigen::VectorXd(direction / length) : direction;
  const Support top = support(disjunction, normal);
  if (top.status != LinearProgramStatus::OPTIMAL)
    return -1;
  FaceProgram face(disjunction, normal, top.value, top.point);
  if (!face.feasible())
    return -1;
  // Columns of `known` are an orthonormal basis: directions along the face, and those in which it is flat.
  Eigen::MatrixXd known(n, n);
  int count = 0, dimension = 0;
  if (length > 0.0)
    known.col(count++) = normal;
  while (count < n)
  {
    Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n, n);
    if (count > 0)
      all = known.leftCols(count).householderQr().householderQ() * all;
    const Eigen::VectorXd fresh = all.col(count);
    Eigen::VectorXd across = face.lowest(-fresh) - face.lowest(fresh);
    if (across.dot(fresh) > FLAT)
    {
      across -= known.leftCols(count) * (known.leftCols(count).transpose() * across);
      across -= known.leftCols(count) * (known.leftCols(count).transpose() * across);
      known.col(count++) = across.normalized();
      ++dimension;
    }
    else
      known.col(count++) = fresh;
  }
  return dimension;
}

bool exposesFacet(const Disjunction& disjunction, const Eigen::VectorXd& direction)
{
  const int face = faceDimension(disjunction, direction);
  return face >= 0 && face + 1 == faceDimension(disjunction, Eigen::VectorXd::Zero(direction.size()));
}

}  // namespace frictional_contact_sim
