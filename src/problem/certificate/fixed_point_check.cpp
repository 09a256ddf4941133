#include "frictional_contact_sim/problem/certificate/fixed_point_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "frictional_contact_sim/problem/existence.h"
#include "frictional_contact_sim/problem/linear_program.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double PI = 3.14159265358979323846;
constexpr int FACETS = 8;
constexpr int SIMPLEX_ITERATIONS = 200000;
constexpr double CUT_TOLERANCE = 1e-12;
/// Where C(s) has no interior the simplex tolerance of 1e-9 opens it by its square root.
constexpr double FLAT = 2e-4;

double largest(const Eigen::VectorXd& x)
{
  return x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0.0;
}

class FixedPointCheck
{
public:
  FixedPointCheck(const IncrementalProblem& problem, const Eigen::VectorXd& v, const FixedPointCheckOptions& options)
    : problem_(problem), options_(options), v_(v)
  {
    u_ = problem.H * v + problem.w;
    momentum_ = problem.M * v + problem.f;
    const Eigen::VectorXd free = problem.f.cwiseQuotient(problem.M.diagonal());
    speed_ = std::max({largest(free), largest(u_), largest(problem.w), largest(v), largest(problem.b), 1e-300});
    // Beside M v and f themselves: where they cancel, round-off is left.
    force_ = std::max({largest(problem.M * v), largest(problem.f), 1e-300});
    for (Eigen::Index k = 0; k < problem.H.nonZeros(); ++k)
      height_ = std::max(height_, std::abs(problem.H.valuePtr()[k]));
    int row = 0;
    for (const Law& law : problem.laws)
    {
      first_.push_back(row);
      row += law.dimension();
    }
  }

  FixedPointReport run()
  {
    measure();
    report_.descent = descend();
    qualify();
    const double sharpness = report_.qualified ? options_.tolerance : std::max(options_.tolerance, FLAT);
    report_.is_fixed_point = report_.penetration <= options_.tolerance * speed_ &&
                             report_.descent <= sharpness * std::max(force_, momentum_.lpNorm<1>());
    report_.least_impulse = report_.is_fixed_point ? leastImpulse() : INFINITE;
    report_.is_solution = report_.is_fixed_point && std::isfinite(report_.least_impulse);
    return std::move(report_);
  }

private:
  bool slips(size_t law) const { return report_.slip[static_cast<Eigen::Index>(law)] > options_.tolerance * speed_; }
  bool open(size_t law) const
  {
    return problem_.laws[law].isOneSided() && u_[first_[law]] > options_.tolerance * speed_;
  }
  static bool hasFriction(const Law& law) { return law.isCoulomb() && law.coefficient > 0.0; }

  void measure()
  {
    report_.slip.setZero(static_cast<Eigen::Index>(problem_.laws.size()));
    for (size_t i = 0; i < problem_.laws.size(); ++i)
    {
      const Law& law = problem_.laws[i];
      const int row = first_[i];
      if (hasFriction(law))
        report_.slip[static_cast<Eigen::Index>(i)] = u_.segment(row + 1, law.dimension() - 1).norm();
      if (law.isOneSided())
        report_.penetration = std::max(report_.penetration, -u_[row]);
      else if (law.type == LawType::BILATERAL)
        report_.penetration = std::max(report_.penetration, std::abs(u_[row]));
    }
    if (problem_.bilaterals() > 0)
      report_.penetration = std::max(report_.penetration, largest(problem_.G * v_ + problem_.b));
  }

  /** The criterion with w + E s for w (theorem 3.20). */
  void qualify()
  {
    IncrementalProblem shifted = problem_;
    for (size_t i = 0; i < problem_.laws.size(); ++i)
      if (hasFriction(problem_.laws[i]) && slips(i))
        shifted.w[first_[i]] += problem_.laws[i].coefficient * report_.slip[static_cast<Eigen::Index>(i)];
    ExistenceOptions options;
    options.maximise = true;
    options.gap = 0.5;
    options.velocity_bound = 10.0 * (largest(v_) + speed_ / std::max(height_, 1e-300));
    const ExistenceReport best = checkExistence(shifted, options);
    report_.qualification = best.margin;
    report_.qualified = best.margin > options_.tolerance * speed_ || problem_.laws.empty();
    if (!report_.qualified)
      report_.unqualified = best.blocking;
  }

  /** One row of a matrix times d, in columns 0 ..., beside other columns. */
  static int addRow(LinearProgram& program, const SparseRows& matrix, int row, double scale, double lower, double upper,
                    std::vector<int> columns = {}, std::vector<double> values = {})
  {
    for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
    {
      columns.push_back(static_cast<int>(entry.col()));
      values.push_back(scale * entry.value());
    }
    return program.addRow(lower, upper, columns, values);
  }

  /** u~_N - mu (c u_T1 + s u_T2) >= 0 for v + d; without friction u_N >= 0. */
  void addDualFacet(LinearProgram& program, size_t law, const Eigen::Vector2d& direction) const
  {
    const int row = first_[law];
    const double mu = problem_.laws[law].isCoulomb() ? problem_.laws[law].coefficient : 0.0;
    SparseRows combined = problem_.H.row(row);
    double value = std::max(u_[row], 0.0) + mu * report_.slip[static_cast<Eigen::Index>(law)];
    for (int k = 1; k < problem_.laws[law].dimension(); ++k)
    {
      const SparseRows tangent = problem_.H.row(row + k);
      combined = (combined - mu * direction[k - 1] * tangent).eval();
      value -= mu * direction[k - 1] * u_[row + k];
    }
    addRow(program, combined, 0, 1.0, -value, LinearProgram::INFINITE);
  }

  /** -min (M v + f).d + sum c (|u + H d| - |u|), from above. */
  double descend() const
  {
    LinearProgram program;
    for (int j = 0; j < problem_.velocities(); ++j)
      program.addColumn(-1.0, 1.0, momentum_[j]);
    std::vector<int> dry(problem_.laws.size(), -1);
    double constant = 0.0;
    for (size_t i = 0; i < problem_.laws.size(); ++i)
      if (problem_.laws[i].type == LawType::DRY_FRICTION)
      {
        dry[i] = program.addColumn(0.0, LinearProgram::INFINITE, problem_.laws[i].coefficient);
        constant += problem_.laws[i].coefficient * std::abs(u_[first_[i]]);
      }
    for (size_t i = 0; i < problem_.laws.size(); ++i)
    {
      const Law& law = problem_.laws[i];
      const int row = first_[i];
      if (dry[i] >= 0)
        for (const double side : {1.0, -1.0})
          addRow(program, problem_.H, row, -side, side * u_[row], LinearProgram::INFINITE, {dry[i]}, {1.0});
      else if (law.type == LawType::BILATERAL)
        addRow(program, problem_.H, row, 1.0, 0.0, 0.0);
      else if (!hasFriction(law))
        addDualFacet(program, i, Eigen::Vector2d::Zero());
      else
        addFan(law, [&](const Eigen::Vector2d& direction) { addDualFacet(program, i, direction); });
    }
    for (int k = 0; k < problem_.bilaterals(); ++k)
      addRow(program, problem_.G, k, 1.0, 0.0, 0.0);
    double bound = INFINITE;
    for (int round = 0; round < options_.max_rounds; ++round)
    {
      if (!program.solve(SIMPLEX_ITERATIONS))
        return bound;
      const Eigen::VectorXd x = program.solution();
      const Eigen::VectorXd d = x.head(problem_.velocities());
      double value = momentum_.dot(d) - constant;
      for (size_t i = 0; i < problem_.laws.size(); ++i)
        if (dry[i] >= 0)
          value += problem_.laws[i].coefficient * x[dry[i]];
      bound = std::min(bound, std::max(0.0, -value));
      const Eigen::VectorXd u = u_ + problem_.H * d;
      bool cut = false;
      for (size_t i = 0; i < problem_.laws.size(); ++i)
      {
        const Law& law = problem_.laws[i];
        if (law.type != LawType::COULOMB_3D || !hasFriction(law))
          continue;
        const Eigen::Vector2d tangent = u.segment<2>(first_[i] + 1);
        const double height = u[first_[i]] + law.coefficient * report_.slip[static_cast<Eigen::Index>(i)];
        if (law.coefficient * tangent.norm() > height + CUT_TOLERANCE * (speed_ + height_))
        {
          addDualFacet(program, i, tangent.normalized());
          cut = true;
        }
      }
      if (!cut)
        break;
    }
    return bound;
  }

  template <typename Add>
  static void addFan(const Law& law, const Add& add)
  {
    const int count = law.dimension() == 2 ? 2 : FACETS;
    for (int k = 0; k < count; ++k)
      add(Eigen::Vector2d(std::cos(2.0 * PI * k / count), std::sin(2.0 * PI * k / count)));
  }

  /** min sum r_N over impulses that belong to v, in outer cones. */
  double leastImpulse() const
  {
    LinearProgram program;
    std::vector<int> column(static_cast<size_t>(problem_.rows()), -1);
    std::vector<size_t> sticking;
    for (size_t i = 0; i < problem_.laws.size(); ++i)
    {
      const Law& law = problem_.laws[i];
      const auto row = static_cast<size_t>(first_[i]);
      if (law.type == LawType::BILATERAL)
        column[row] = program.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0);
      else if (law.type == LawType::DRY_FRICTION)
      {
        const double rate = u_[first_[i]];
        const bool moves = std::abs(rate) > options_.tolerance * speed_;
        const double c = law.coefficient / force_;
        column[row] = program.addColumn(moves && rate < 0.0 ? c : -c, moves && rate > 0.0 ? -c : c, 0.0);
      }
      else if (!open(i))
      {
        column[row] = program.addColumn(0.0, LinearProgram::INFINITE, 1.0);
        if (hasFriction(law) && !slips(i))
        {
          for (int k = 1; k < law.dimension(); ++k)
            column[row + static_cast<size_t>(k)] =
                program.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0);
          sticking.push_back(i);
        }
      }
    }
    std::vector<int> lambda;
    for (int k = 0; k < problem_.bilaterals(); ++k)
      lambda.push_back(program.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0));
    addMomentum(program, column, lambda);
    const auto addPlane = [&](size_t law, const Eigen::Vector2d& direction)
    {
      const auto row = static_cast<size_t>(first_[law]);
      std::vector<int> columns = {column[row]};
      std::vector<double> values = {problem_.laws[law].coefficient};
      for (int k = 1; k < problem_.laws[law].dimension(); ++k)
      {
        columns.push_back(column[row + static_cast<size_t>(k)]);
        values.push_back(-direction[k - 1]);
      }
      program.addRow(0.0, LinearProgram::INFINITE, columns, values);
    };
    for (const size_t i : sticking)
      addFan(problem_.laws[i], [&](const Eigen::Vector2d& direction) { addPlane(i, direction); });
    double bound = 0.0;
    for (int round = 0; round < options_.max_rounds; ++round)
    {
      if (!program.solve(SIMPLEX_ITERATIONS))
        return INFINITE;
      const Eigen::VectorXd x = program.solution();
      bound = 0.0;
      bool cut = false;
      for (size_t i = 0; i < problem_.laws.size(); ++i)
        if (problem_.laws[i].isOneSided() && column[static_cast<size_t>(first_[i])] >= 0)
          bound += x[column[static_cast<size_t>(first_[i])]];
      for (const size_t i : sticking)
        if (problem_.laws[i].type == LawType::COULOMB_3D)
        {
          const auto row = static_cast<size_t>(first_[i]);
          const Eigen::Vector2d tangent(x[column[row + 1]], x[column[row + 2]]);
          const double radius = problem_.laws[i].coefficient * x[column[row]];
          if (tangent.norm() > radius * (1.0 + 1e-9) + CUT_TOLERANCE)
          {
            addPlane(i, tangent.normalized());
            cut = true;
          }
        }
      if (bound * height_ > options_.runaway)
        return INFINITE;
      if (!cut)
        break;
    }
    return bound * force_;
  }

  /** H^T r + G^T lambda = M v + f to the tolerance; impulses in units of force_. */
  void addMomentum(LinearProgram& program, const std::vector<int>& column, const std::vector<int>& lambda) const
  {
    const auto size = static_cast<size_t>(problem_.velocities());
    std::vector<std::vector<int>> columns(size);
    std::vector<std::vector<double>> values(size);
    const auto add = [&](const SparseRows& matrix, int row, int target, double factor)
    {
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      {
        columns[static_cast<size_t>(entry.col())].push_back(target);
        values[static_cast<size_t>(entry.col())].push_back(factor * entry.value());
      }
    };
    for (size_t i = 0; i < problem_.laws.size(); ++i)
    {
      const Law& law = problem_.laws[i];
      const int row = first_[i];
      const int normal = column[static_cast<size_t>(row)];
      if (normal < 0)
        continue;
      if (!hasFriction(law) || !slips(i))
      {
        for (int k = 0; k < law.dimension(); ++k)
          if (column[static_cast<size_t>(row + k)] >= 0)
            add(problem_.H, row + k, column[static_cast<size_t>(row + k)], 1.0);
        continue;
      }
      // r = r_N (1, -mu u_T/|u_T|): one column for the combined row.
      SparseRows combined = problem_.H.row(row);
      for (int k = 1; k < law.dimension(); ++k)
      {
        const SparseRows tangent = problem_.H.row(row + k);
        combined =
            (combined - law.coefficient * u_[row + k] / report_.slip[static_cast<Eigen::Index>(i)] * tangent).eval();
      }
      add(combined, 0, normal, 1.0);
    }
    for (size_t k = 0; k < lambda.size(); ++k)
      add(problem_.G, static_cast<int>(k), lambda[k], 1.0);
    for (size_t j = 0; j < size; ++j)
    {
      const double right = momentum_[static_cast<Eigen::Index>(j)] / force_;
      program.addRow(right - options_.tolerance, right + options_.tolerance, columns[j], values[j]);
    }
  }

  const IncrementalProblem& problem_;
  const FixedPointCheckOptions& options_;
  const Eigen::VectorXd& v_;
  Eigen::VectorXd u_;
  Eigen::VectorXd momentum_;  ///< M v + f
  std::vector<int> first_;  ///< row of each law
  double speed_ = 1.0, force_ = 1.0, height_ = 0.0;
  FixedPointReport report_;
};
}  // namespace

void FixedPointCheckOptions::validate() const
{
  const auto require = [](bool condition, const std::string& text)
  {
    if (!condition)
      throw std::invalid_argument("fixed point check: " + text);
  };
  require(tolerance > 0.0 && tolerance < 1.0, "tolerance is " + std::to_string(tolerance) + ", expected in (0, 1)");
  require(max_rounds >= 1, "max_rounds is " + std::to_string(max_rounds) + ", expected at least 1");
  require(runaway > 1.0, "runaway is " + std::to_string(runaway) + ", expected > 1");
}

const char* FixedPointReport::verdict() const
{
  if (!is_fixed_point)
    return "no fixed point";
  if (!is_solution)
    return "a fixed point that is no solution: no impulse belongs to it (theorem 3.20 does not apply)";
  return qualified ? "a solution, as theorem 3.20 says of every fixed point here"
                   : "a solution, although theorem 3.20 does not apply";
}

FixedPointReport checkFixedPoint(const IncrementalProblem& problem, const Eigen::VectorXd& v,
                                 const FixedPointCheckOptions& options)
{
  validate(problem);
  options.validate();
  if (v.size() != problem.velocities() || !v.allFinite())
    throw std::invalid_argument("fixed point check: v has " + std::to_string(v.size()) + " entries, expected " +
                                std::to_string(problem.velocities()) + " finite ones");
  return FixedPointCheck(problem, v, options).run();
}

}  // namespace frictional_contact_sim
