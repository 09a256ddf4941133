#pragma once
/**
 * @file least_norm_dual.h
 * @brief The dual of one island of solver/least_norm.h: m scaled impulses s, n velocities y.
 *
 *     s = argmin |s|^2/2,  A^T s = b,  s_i in P_i        g(y) = b^T y - sum_i (s_i^T A_i y - |s_i|^2/2),  s_i = P_i(A_i
 * y)
 *
 * Every set holds a few rows of A with the same few columns. The Hessian sum_i A_i^T dP_i A_i is dense for small or
 * full islands, sparse (problem/mass_factor.h) for the others. Workspace only grows.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/problem/mass_factor.h"

namespace frictional_contact_sim
{
/** @brief Rows of A that one law confines; bound: mu, or c/sqrt(rho). */
struct DualSet
{
  enum Kind
  {
    CONE,  ///< 2 or 3 rows, normal first
    HALF_LINE,
    INTERVAL
  };
  int kind = CONE;
  int rows = 0;
  double bound = 0.0;
  int first_row = 0;
  size_t columns = 0, column_count = 0;  ///< into DualIsland's
  size_t values = 0;  ///< rows values a column
};

class DualIsland
{
public:
  enum class Outcome
  {
    AS_IT_WAS,  ///< s* is the answer already, or nothing better was found
    CHANGED  ///< shorter than s*
  };

  /** @brief Starts anew with n velocities and no set. */
  void clear(int velocities);
  /** @brief A new set; then columns (ascending) with `rows` values each, then its s*. */
  DualSet& addSet(int kind, int rows, double bound);
  void addColumn(int column, const double* values);
  void setImpulse(const double* impulse);

  /**
   * @brief Looks for the least-norm s.
   * @param exact false: s* stays where it is at most sqrt(2) times as long as a bound
   */
  Outcome solve(bool exact);
  /** @brief s of a set after solve(). */
  const double* impulse(size_t set) const { return s_.data() + sets_[set].first_row; }
  int iterations() const { return iterations_; }
  /** @brief Whether s is the least-norm one, to round-off. */
  bool isOptimal() const { return optimal_; }
  /** @brief |s*| / |s| */
  double ratio() const;

private:
  void evaluate(const std::vector<double>& y);
  void multiply(const std::vector<double>& y, std::vector<double>& t) const;
  void defect(const std::vector<double>& s, std::vector<double>& gap) const;
  void project();
  bool factorHessian(bool whole, double shift);
  void solveHessian(const std::vector<double>& right, std::vector<double>& x);
  template <typename Add>
  void addHessian(bool whole, Add add) const;
  bool useSparse() const;
  void prepareSparse();
  bool search(double slope);
  bool start();
  bool newton();
  bool isOld() const;
  void refine();
  bool accept();
  double roundOff() const;

  int n_ = 0, m_ = 0, iterations_ = 0;
  std::vector<DualSet> sets_;
  std::vector<int> columns_;
  std::vector<double> values_;
  std::vector<double> s_star_, b_;
  std::vector<double> y_, t_, s_, gap_, step_, trial_, best_s_;
  double scale_ = 0.0;  ///< largest diagonal entry of A^T A
  double gap_norm_ = 0.0, load_ = 0.0, value_ = 0.0, best_value_ = 0.0;
  std::vector<double> hessian_;  ///< dense, n x n
  bool sparse_ = false, optimal_ = false;
  SparseRows matrix_;
  MassFactor factor_;
  std::vector<int> pattern_columns_;  ///< columns_ and the ends of sets when matrix_ was laid out
  std::vector<size_t> pattern_ends_;
  std::vector<int> position_;  ///< of every pair of columns of every set in matrix_
  std::vector<int> diagonal_;
  Eigen::VectorXd right_, half_, solution_;
};

}  // namespace frictional_contact_sim
