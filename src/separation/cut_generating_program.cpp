// The most violated cut under a linear normalisation, and the intersection cut (separation/polar_oracle.h).
#include <Eigen/QR>
#include <cmath>

#include "dense_rows.h"
#include "frictional_contact_sim/separation/polar_oracle.h"
#include "pivot_row.h"

namespace frictional_contact_sim
{
namespace
{
/// A row is active at the origin up to this distance.
constexpr double ACTIVE = 1e-9;

/**
 * Columns nu <= 0, then u_k of every term, then (norms of d only) d = p - q with p, q >= 0. Rows A_0^T u_0 = A_k^T u_k
 * and b_k.u_k - nu = 0 or <= 0.
 */
class CutProgram
{
public:
  CutProgram(const Disjunction& disjunction, Normalisation normalisation, double bound)
    : n_(disjunction.dimension()), by_multipliers_(normalisation == Normalisation::MULTIPLIERS)
  {
    // Under (7.27) the part 1 of the violation is fixed: nu = -1 - |b_kj| lambda_k.
    program_.addColumn(-LinearProgram::INFINITE, by_multipliers_ ? -1.0 : 0.0, 1.0);
    int column = 1;
    for (size_t k = 0; k < disjunction.terms.size(); ++k)
    {
      terms_.push_back(disjunction.term(k));
      firsts_.push_back(column);
      for (int i = 0; i < terms_.back().rows(); ++i)
        program_.addColumn(0.0, LinearProgram::INFINITE, 0.0);
      column += terms_.back().rows();
    }
    const bool has_norm = normalisation == Normalisation::ONE_NORM || normalisation == Normalisation::MAXIMUM_NORM;
    const double most = normalisation == Normalisation::MAXIMUM_NORM ? 1.0 : LinearProgram::INFINITE;
    for (int j = 0; has_norm && j < 2 * n_; ++j)
      program_.addColumn(0.0, most, 0.0);
    addTies();
    if (by_multipliers_)
      addMultiplierBound(bound);
    else if (normalisation == Normalisation::LIFT_AND_PROJECT)
      addDenseRow(program_, -LinearProgram::INFINITE, 1.0, Eigen::VectorXd::Ones(column - 1), 1);
    else
      addDirection(column, normalisation == Normalisation::ONE_NORM);
  }

  ViolatedCut solve()
  {
    ViolatedCut cut;
    if (!solveFirst(program_))
      return cut;
    const Eigen::VectorXd solution = program_.solution();
    cut.violation = -solution[0];
    cut.found = cut.violation > ACTIVE;
    for (size_t k = 0; cut.found && k < terms_.size(); ++k)
      cut.multipliers.emplace_back(solution.segment(firsts_[k], terms_[k].rows()) / cut.violation);
    if (cut.found)
      cut.direction = terms_.front().A.transpose() * cut.multipliers.front();
    return cut;
  }

private:
  void addTies()
  {
    for (size_t k = 0; k < terms_.size(); ++k)
    {
      ProgramRow right;
      right.add(terms_[k].b, firsts_[k]);
      right.add(0, -1.0);
      right.addTo(program_, by_multipliers_ ? 0.0 : -LinearProgram::INFINITE, 0.0);
      for (int j = 0; k > 0 && j < n_; ++j)
      {
        ProgramRow row;
        row.add(terms_.front().A.col(j), firsts_.front());
        row.add(terms_[k].A.col(j), firsts_[k], -1.0);
        row.addTo(program_, 0.0, 0.0);
      }
    }
  }

  /** sum over i != j of u_ki + lambda_k, lambda_k = (-nu - 1) / |b_kj|. */
  void addMultiplierBound(double bound)
  {
    ProgramRow sum;
    double slope = 0.0;
    for (size_t k = 0; k < terms_.size(); ++k)
    {
      const int pivot = pivotRow(terms_[k], "term " + std::to_string(k));
      slope += -1.0 / terms_[k].b[pivot];
      for (int i = 0; i < terms_[k].rows(); ++i)
        sum.add(firsts_[k] + i, i == pivot ? 0.0 : 1.0);
    }
    sum.add(0, -slope);
    sum.addTo(program_, -LinearProgram::INFINITE, bound + slope);
  }

  void addDirection(int first, bool bound_sum)
  {
    for (int j = 0; j < n_; ++j)
    {
      ProgramRow row;
      row.add(terms_.front().A.col(j), firsts_.front());
      row.add(first + j, -1.0);
      row.add(first + n_ + j, 1.0);
      row.addTo(program_, 0.0, 0.0);
    }
    if (bound_sum)
      addDenseRow(program_, -LinearProgram::INFINITE, 1.0, Eigen::VectorXd::Ones(2 * n_), first);
  }

  int n_;
  bool by_multipliers_;
  std::vector<Polyhedron> terms_;
  std::vector<int> firsts_;
  LinearProgram program_;
};
}  // namespace

ViolatedCut mostViolatedCut(const Disjunction& disjunction, Normalisation normalisation, double bound)
{
  validate(disjunction);
  return CutProgram(disjunction, normalisation, bound).solve();
}

IntersectionCut intersectionCut(const Disjunction& disjunction)
{
  validate(disjunction);
  IntersectionCut cut;
  const int n = disjunction.dimension();
  std::vector<int> active;
  for (int i = 0; i < disjunction.common.rows(); ++i)
    if (std::abs(disjunction.common.b[i]) <= ACTIVE * disjunction.common.A.row(i).norm())
      active.push_back(i);
  if (static_cast<int>(active.size()) < n)
    return cut;
  Eigen::MatrixXd rows(n, static_cast<Eigen::Index>(active.size()));
  for (size_t k = 0; k < active.size(); ++k)
    rows.col(static_cast<Eigen::Index>(k)) = disjunction.common.A.row(active[k]).transpose();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(rows);
  if (factor.rank() < n)
    return cut;
  Eigen::MatrixXd basis(n, n);  // A_B^T
  for (int k = 0; k < n; ++k)
  {
    const Eigen::Index chosen = factor.colsPermutation().indices()[k];
    basis.col(k) = rows.col(chosen);
    cut.basis.push_back(active[static_cast<size_t>(chosen)]);
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solve(basis);
  Eigen::MatrixXd coefficients(n, static_cast<Eigen::Index>(disjunction.terms.size()));
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
  {
    const Polyhedron& term = disjunction.terms[k];
    if (term.rows() != 1 || !(term.b[0] < 0.0))
      return {};
    coefficients.col(static_cast<Eigen::Index>(k)) = solve.solve(term.A.row(0).transpose()) / -term.b[0];
  }
  const Eigen::VectorXd largest = coefficients.rowwise().maxCoeff();
  cut.found = true;
  cut.direction = basis * largest;
  cut.bound = ((-coefficients).colwise() + largest).sum();
  return cut;
}

}  // namespace frictional_contact_sim
