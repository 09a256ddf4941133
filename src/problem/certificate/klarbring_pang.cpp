#include "frictional_contact_sim/problem/certificate/klarbring_pang.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../contact_kinematics.h"
#include "../existence_certificate.h"
#include "frictional_contact_sim/problem/linear_program.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double PI = 3.14159265358979323846;
constexpr int FACETS = 8;  ///< of the first cone around K in 3D
/// Of r outside its cone, of sum r_N = 1, that is worth another tangent plane.
constexpr double CUT_TOLERANCE = 1e-11;
/// A self-stress that is in balance to this, in the unit of H, counts as one.
constexpr double BALANCED = 1e-9;
constexpr int SIMPLEX_ITERATIONS = 200000;

/** min w.r + b.lambda over the slice of a polyhedral cone around L. */
class StressProgram
{
public:
  explicit StressProgram(const ContactKinematics& kinematics) : kinematics_(kinematics)
  {
    height_ = std::max({largest(kinematics.H), largest(kinematics.E), 1e-300});
    const double speed = std::max(kinematics.w.size() > 0 ? kinematics.w.lpNorm<Eigen::Infinity>() : 0.0,
                                  kinematics.b.size() > 0 ? kinematics.b.lpNorm<Eigen::Infinity>() : 0.0);
    speed_ = speed > 0.0 ? speed : 1.0;
    std::vector<int> normals;
    column_.assign(static_cast<size_t>(kinematics.H.rows()), -1);
    for (const DualCone& cone : kinematics.cones)
    {
      const bool slips = cone.dimension > 1 && cone.friction > 0.0;
      for (int k = 0; k < (slips ? cone.dimension : 1); ++k)
        column_[static_cast<size_t>(cone.row + k)] = program_.addColumn(
            k == 0 ? 0.0 : -LinearProgram::INFINITE, LinearProgram::INFINITE, kinematics.w[cone.row + k] / speed_);
      normals.push_back(column_[static_cast<size_t>(cone.row)]);
    }
    first_lambda_ = -1;
    for (int k = 0; k < kinematics.E.rows(); ++k)
    {
      const int column =
          program_.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, kinematics.b[k] / speed_);
      first_lambda_ = k == 0 ? column : first_lambda_;
    }
    addBalance();
    program_.addRow(1.0, 1.0, normals, std::vector<double>(normals.size(), 1.0));
    for (const DualCone& cone : kinematics.cones)
      for (int k = 0; cone.friction > 0.0 && cone.dimension > 1 && k < (cone.dimension == 2 ? 2 : FACETS); ++k)
      {
        const double angle = 2.0 * PI * k / (cone.dimension == 2 ? 2 : FACETS);
        addPlane(cone, {std::cos(angle), std::sin(angle)});
      }
  }

  bool solve() { return program_.solve(SIMPLEX_ITERATIONS); }

  /** r and lambda of the last solve. @return largest distance of r_T from its disc */
  double read(Eigen::VectorXd& r, Eigen::VectorXd& lambda) const
  {
    const Eigen::VectorXd x = program_.solution();
    r.setZero(kinematics_.H.rows());
    for (Eigen::Index row = 0; row < r.size(); ++row)
      if (column_[static_cast<size_t>(row)] >= 0)
        r[row] = x[column_[static_cast<size_t>(row)]];
    lambda.setZero(kinematics_.E.rows());
    for (Eigen::Index k = 0; k < lambda.size(); ++k)
      lambda[k] = x[first_lambda_ + k];
    double outside = 0.0;
    for (const DualCone& cone : kinematics_.cones)
      if (cone.dimension > 1 && cone.friction > 0.0)
        outside = std::max(outside, r.segment(cone.row + 1, cone.dimension - 1).norm() - cone.friction * r[cone.row]);
    return outside;
  }

  /** The dual velocity: in the unit of v. */
  Eigen::VectorXd velocity() const { return -program_.prices().head(kinematics_.H.cols()) * speed_ / height_; }

  void cut(const Eigen::VectorXd& r)
  {
    for (const DualCone& cone : kinematics_.cones)
    {
      if (cone.dimension != 3 || cone.friction == 0.0)
        continue;
      const Eigen::Vector2d tangent = r.segment<2>(cone.row + 1);
      if (tangent.norm() > cone.friction * r[cone.row] + CUT_TOLERANCE)
        addPlane(cone, tangent.normalized());
    }
  }

private:
  static double largest(const SparseRows& matrix)
  {
    double value = 0.0;
    for (Eigen::Index k = 0; k < matrix.nonZeros(); ++k)
      value = std::max(value, std::abs(matrix.valuePtr()[k]));
    return value;
  }

  /** H^T r + E^T lambda = 0, a row for each velocity. */
  void addBalance()
  {
    const auto size = static_cast<size_t>(kinematics_.H.cols());
    std::vector<std::vector<int>> columns(size);
    std::vector<std::vector<double>> values(size);
    const auto add = [&](const SparseRows& matrix, int row, int column)
    {
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      {
        columns[static_cast<size_t>(entry.col())].push_back(column);
        values[static_cast<size_t>(entry.col())].push_back(entry.value() / height_);
      }
    };
    for (int row = 0; row < kinematics_.H.rows(); ++row)
      if (column_[static_cast<size_t>(row)] >= 0)
        add(kinematics_.H, row, column_[static_cast<size_t>(row)]);
    for (int k = 0; k < kinematics_.E.rows(); ++k)
      add(kinematics_.E, k, first_lambda_ + k);
    for (size_t j = 0; j < size; ++j)
      program_.addRow(0.0, 0.0, columns[j], values[j]);
  }

  /** mu r_N - d.r_T >= 0: a tangent plane of K. */
  void addPlane(const DualCone& cone, const Eigen::Vector2d& direction)
  {
    std::vector<int> columns = {column_[static_cast<size_t>(cone.row)]};
    std::vector<double> values = {cone.friction};
    for (int k = 0; k + 1 < cone.dimension; ++k)
    {
      columns.push_back(column_[static_cast<size_t>(cone.row + 1 + k)]);
      values.push_back(-direction[k]);
    }
    program_.addRow(0.0, LinearProgram::INFINITE, columns, values);
  }

  const ContactKinematics& kinematics_;
  LinearProgram program_;
  std::vector<int> column_;  ///< of a row of H, -1: r there is zero or takes no part
  int first_lambda_ = -1;
  double height_ = 1.0;  ///< of H
  double speed_ = 1.0;  ///< of w
};

/** Pulls r_T back into its cone; returns w.r + b.lambda and the error of balance. */
void readStress(const ContactKinematics& kinematics, KlarbringPangReport& report)
{
  verifiedExclusion(kinematics, report.r, report.lambda);  // shortens r_T
  report.upper = report.r.dot(kinematics.w) + report.lambda.dot(kinematics.b);
  report.equilibrium_error =
      (kinematics.H.transpose() * report.r + kinematics.E.transpose() * report.lambda).lpNorm<1>();
}

KlarbringPangReport solve(const ContactKinematics& kinematics, const ExistenceReport& homogeneous, int max_rounds)
{
  KlarbringPangReport report;
  report.lower = -INFINITE;
  report.upper = INFINITE;
  report.rounds = homogeneous.rounds;
  if (kinematics.cones.empty() || homogeneous.margin > 0.0)
  {
    report.unconditional = true;
    report.lower = INFINITE;
    report.v = homogeneous.v;
    return report;
  }
  StressProgram program(kinematics);
  const BilateralCorrection correction(kinematics);
  while (report.rounds < max_rounds)
  {
    ++report.rounds;
    if (!program.solve())
      break;
    const double outside = program.read(report.r, report.lambda);
    const Eigen::VectorXd outer = report.r;
    readStress(kinematics, report);
    if (report.equilibrium_error > BALANCED)
      report.upper = INFINITE;
    Eigen::VectorXd v = program.velocity();
    const double missing = correction.apply(v);
    if (const double margin = verifiedMargin(kinematics, v, missing); margin > report.lower)
    {
      report.lower = margin;
      report.v = v;
    }
    if (outside <= CUT_TOLERANCE)
      break;
    program.cut(outer);
  }
  return report;
}

ExistenceOptions homogeneousOptions()
{
  ExistenceOptions options;
  options.maximise = true;
  options.velocity_bound = 1.0;
  options.gap = 0.5;  // only whether it is positive
  return options;
}
}  // namespace

KlarbringPangReport klarbringPang(const IncrementalProblem& problem, int max_rounds)
{
  IncrementalProblem homogeneous = problem;
  homogeneous.w.setZero();
  homogeneous.b.setZero();
  const ExistenceReport report = checkExistence(homogeneous, homogeneousOptions());
  return solve(collectKinematics(problem.H, problem.w, problem.laws, &problem.G, &problem.b), report, max_rounds);
}

KlarbringPangReport klarbringPang(const DelassusProblem& problem, int max_rounds)
{
  DelassusProblem homogeneous = problem;
  homogeneous.q.setZero();
  const ExistenceReport report = checkExistence(homogeneous, homogeneousOptions());
  return solve(collectKinematics(problem.W.toSparse(), problem.q, problem.laws, nullptr, nullptr), report, max_rounds);
}

}  // namespace frictional_contact_sim
