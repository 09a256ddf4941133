#include "frictional_contact_sim/solver/portfolio.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/ds_newton.h"
#include "frictional_contact_sim/solver/fb_newton_smoothed.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/one_contact.h"

namespace frictional_contact_sim
{
namespace
{
/// Sweeps after which Gauss-Seidel must have halved the residual to go on.
constexpr int STALL_WINDOW = 20;
/// Above Newton's first proximal parameter, below its restart.
constexpr double WATCHDOG_MIN = 1e-5;
/// Newton on a small problem aims this far below the tolerance: its last step costs little, and a scene at rest then
/// stays within the tolerance for many warm-started steps instead of drifting out of it at once.
constexpr double NEWTON_MARGIN = 1e-2;

void require(bool condition, const char* name, int value, int least)
{
  if (!condition)
    throw std::invalid_argument(std::string("portfolio.") + name + " is " + std::to_string(value) +
                                ", expected >= " + std::to_string(least));
}
}  // namespace

void PortfolioOptions::validate() const
{
  require(newton_first_rows >= 0, "newton_first_rows", newton_first_rows, 0);
  require(newton_first_steps >= 1, "newton_first_steps", newton_first_steps, 1);
  require(first_sweeps >= 0, "first_sweeps", first_sweeps, 0);
  require(newton_steps >= 1, "newton_steps", newton_steps, 1);
  require(later_sweeps >= 1, "later_sweeps", later_sweeps, 1);
  require(max_rounds >= 0, "max_rounds", max_rounds, 0);
}

Portfolio::Portfolio(const PortfolioOptions& options)
  : Solver("portfolio")
  , options_(options)
  , gauss_seidel_(std::make_unique<GaussSeidel>())
  , newton_(std::make_unique<AcNewton>())
{
  options_.validate();
  GaussSeidelOptions sweeps;
  sweeps.stall_window = STALL_WINDOW;
  sweeps.conjugate = true;
  gauss_seidel_->setOptions(sweeps);
  last_resort_.push_back(std::make_unique<FbNewtonSmoothed>());
  last_resort_.push_back(std::make_unique<DsNewton>());
}

Portfolio::~Portfolio() = default;

void Portfolio::setOptions(const PortfolioOptions& options)
{
  options.validate();
  options_ = options;
  dropSiblings();
}

std::unique_ptr<Solver> Portfolio::sibling() const
{
  return std::make_unique<Portfolio>(options_);
}

double Portfolio::criterion(const DelassusProblem& problem, const Eigen::VectorXd& r)
{
  problem.W.apply(r, velocity_);
  velocity_ += problem.q;
  return residual(problem, velocity_, r);
}

bool Portfolio::run(Solver& method, const DelassusProblem& problem, int budget, SolverResult& result, double margin)
{
  budget = std::min(budget, stopping().max_iterations - used_);
  if (budget <= 0)
    return false;
  result.tried.push_back(method.name());
  result.iterations = 0;
  delegate(method, problem, margin * stopping().tolerance, budget, result);
  used_ += result.iterations;
  result.iterations = used_;
  const double value = criterion(problem, result.solution.r);
  if (value < best_value_)
  {
    best_value_ = value;
    best_r_ = result.solution.r;
    result.solver = method.name();
  }
  else
    result.solution.r = best_r_;
  return best_value_ <= stopping().tolerance;
}

bool Portfolio::start(const DelassusProblem& problem, Eigen::VectorXd& r, Eigen::VectorXd& u)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<std::size_t>(i)];
    const int row = problem.W.offset(i);
    if (law.type == LawType::COULOMB_3D)
      r.segment<3>(row) = solveCoulomb(problem.W.diagonalBlock<3>(i), problem.q.segment<3>(row), law.coefficient);
    else if (law.type == LawType::COULOMB_2D)
      r.segment<2>(row) = solveCoulomb(problem.W.diagonalBlock<2>(i), problem.q.segment<2>(row), law.coefficient);
    else
      r[row] = solveOneDimensional(law, problem.W.diagonalBlock<1>(i)(0, 0), problem.q[row], 0.0);
  }
  problem.W.apply(r, u);
  const double power = r.dot(u);
  const double t = power > 0.0 ? std::min(1.0, -problem.q.dot(r) / power) : 0.0;
  if (!(t > 0.0))
  {
    r.setZero();
    return false;
  }
  r *= t;
  u = t * u + problem.q;
  return true;
}

void Portfolio::doSolve(const DelassusProblem& problem, SolverResult& result)
{
  used_ = 0;
  best_r_ = result.solution.r;
  best_value_ = criterion(problem, best_r_);
  bool done = best_value_ <= stopping().tolerance;
  const bool newton_first = problem.W.rows() <= options_.newton_first_rows;
  SemismoothNewtonOptions newton;
  // Far from a solution a first failure should cost one step, not a whole excursion; near one it is the other way
  // round.
  newton.watchdog_min = newton_first ? WATCHDOG_MIN : 0.0;
  newton_->setOptions(newton);
  if (!done)
    done = newton_first ? run(*newton_, problem, options_.newton_first_steps, result, NEWTON_MARGIN)
                        : run(*gauss_seidel_, problem, options_.first_sweeps, result) ||
                              run(*newton_, problem, options_.newton_steps, result);
  newton.watchdog_min = 0.0;
  newton_->setOptions(newton);
  for (int round = 0; !done && round < options_.max_rounds && used_ < stopping().max_iterations && !timeIsUp(); ++round)
  {
    done = run(*gauss_seidel_, problem, options_.later_sweeps << round, result) ||
           run(*newton_, problem, options_.newton_steps << round, result);
    for (std::unique_ptr<Solver>& method : last_resort_)
      done = done || run(*method, problem, options_.newton_steps << round, result);
  }
  result.solution.r = best_r_;
  if (done)
  {
    result.status = SolverStatus::CONVERGED;
    return;
  }
  result.status = timeIsUp()                           ? SolverStatus::TIME_LIMIT
                  : used_ >= stopping().max_iterations ? SolverStatus::MAX_ITERATIONS
                                                       : SolverStatus::STAGNATED;
  result.message = "no method of the portfolio reached the tolerance";
}

}  // namespace frictional_contact_sim
