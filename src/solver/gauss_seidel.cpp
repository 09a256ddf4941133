#include "frictional_contact_sim/solver/gauss_seidel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/solver/one_contact.h"

namespace frictional_contact_sim
{
namespace
{
/// The residual is worth a look when the largest change of a sweep, as a velocity, is below this multiple of tolerance.
constexpr double LIKELY = 2.0;
/// Above so many rows the clock is asked after every sweep, not only with the residual.
constexpr int LONG_SWEEP_ROWS = 300;

template <int D>
double updateContact(const DelassusProblem& problem, int i, double relaxation, Eigen::VectorXd& r, double& scale)
{
  auto impulse = r.segment<D>(problem.W.offset(i));
  const SquareMatrix<D> W = problem.W.diagonalBlock<D>(i);
  const Vector<D> old = impulse;
  const Vector<D> u = problem.W.rowProduct<D>(i, r) + problem.q.segment<D>(problem.W.offset(i));
  const Vector<D> free = u - W * old;
  impulse = solveCoulomb(W, free, problem.laws[static_cast<size_t>(i)].coefficient);
  if (relaxation != 1.0)
    impulse = old + relaxation * (Vector<D>(impulse) - old);
  const Vector<D> change = W * (Vector<D>(impulse) - old);
  scale = std::max(scale, free.cwiseAbs().maxCoeff());
  return change.norm();
}
}  // namespace

const OptionTable<GaussSeidelOptions>& GaussSeidelOptions::table()
{
  static const OptionTable<GaussSeidelOptions> table(
      "gauss_seidel",
      {
          {"check_interval", &GaussSeidelOptions::check_interval, atLeast(1), "sweeps",
           "between two forced evaluations of the residual"},
          {"stall_window", &GaussSeidelOptions::stall_window, atLeast(0), "sweeps",
           "after which the residual must have fallen by stall_factor, 0 = no matter"},
          {"stall_factor", &GaussSeidelOptions::stall_factor, inside(0.0, 1.0), "-",
           "required ratio of residuals over a window"},
          {"conjugate", &GaussSeidelOptions::conjugate, "sweeps are combined as conjugate gradients do"},
          {"relaxation", &GaussSeidelOptions::relaxation, inside(0.0, 2.0), "-", "r_i <- r_i + relaxation (new - old)"},
      });
  return table;
}

void GaussSeidelOptions::validate() const
{
  table().validate(*this);
}

GaussSeidel::GaussSeidel(const GaussSeidelOptions& options) : Solver("gauss_seidel"), options_(options)
{
  options_.validate();
}

void GaussSeidel::setOptions(const GaussSeidelOptions& options)
{
  options.validate();
  options_ = options;
  dropSiblings();
}

std::unique_ptr<Solver> GaussSeidel::sibling() const
{
  return std::make_unique<GaussSeidel>(options_);
}

double GaussSeidel::sweep(const DelassusProblem& problem, Eigen::VectorXd& r) const
{
  double change = 0.0;
  double scale = std::numeric_limits<double>::min();
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    if (law.type == LawType::COULOMB_3D)
      change = std::max(change, updateContact<3>(problem, i, options_.relaxation, r, scale));
    else if (law.type == LawType::COULOMB_2D)
      change = std::max(change, updateContact<2>(problem, i, options_.relaxation, r, scale));
    else
    {
      const int row = problem.W.offset(i);
      const double W = problem.W.diagonalBlock<1>(i)(0, 0);
      const double free = problem.W.rowProduct<1>(i, r)[0] + problem.q[row] - W * r[row];
      const double solved = solveOneDimensional(law, W, free, r[row]);
      const double step = options_.relaxation * (solved - r[row]);
      r[row] += step;
      change = std::max(change, std::abs(W * step));
      scale = std::max(scale, std::abs(free));
    }
  }
  return change / scale;
}

/** The step of conjugate sweeps between two of them, from the change r - previous_ of the last one. */
void GaussSeidel::extrapolate(const DelassusProblem& problem, const SolveContext& context, Eigen::VectorXd& r)
{
  double square = 0.0;
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int row = problem.W.offset(i);
    const int d = problem.W.dimension(i);
    square += (r.segment(row, d) - previous_.segment(row, d)).squaredNorm() / context.metric.step_lengths[i];
  }
  const double beta = previous_square_ > 0.0 ? square / previous_square_ : 0.0;
  previous_square_ = square;
  const bool restart = !(beta > 0.0 && beta <= 1.0);
  direction_ *= restart ? 0.0 : beta;
  velocity_ = r - previous_;
  r += direction_;
  direction_ += velocity_;
}

void GaussSeidel::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  Eigen::VectorXd& r = result.solution.r;
  const double tolerance = context.tolerance;
  double window_start = std::numeric_limits<double>::infinity();
  int window_end = options_.stall_window;
  previous_square_ = 0.0;
  direction_.setZero(r.size());
  for (int k = 0;; ++k)
  {
    const bool last = k >= context.max_iterations;
    if (options_.conjugate && !last)
    {
      if (k > 0)
        extrapolate(problem, context, r);
      previous_ = r;
    }
    const double change = last ? 0.0 : sweep(problem, r);
    result.iterations = last ? k : k + 1;
    context.spend(1.0);
    const bool check = last || change <= LIKELY * tolerance || (k + 1) % options_.check_interval == 0;
    if (!check && !(problem.W.rows() > LONG_SWEEP_ROWS && context.timeIsUp()))
      continue;
    problem.W.apply(r, velocity_);
    velocity_ += problem.q;
    const double value = context.residual(problem, velocity_, r);
    context.note(result.iterations, value);
    result.residual = value;
    if (value <= tolerance)
    {
      result.status = SolverStatus::CONVERGED;
      return;
    }
    if (last)
    {
      result.status = SolverStatus::MAX_ITERATIONS;
      result.message = "sweeps exhausted";
      return;
    }
    if (change == 0.0 ||
        (options_.stall_window > 0 && k + 1 >= window_end && value > options_.stall_factor * window_start))
    {
      result.status = SolverStatus::STAGNATED;
      result.message = "the sweeps no longer reduce the residual";
      return;
    }
    if (options_.stall_window > 0 && k + 1 >= window_end)
    {
      window_start = value;
      window_end = k + 1 + options_.stall_window;
    }
    if (context.timeIsUp())
    {
      result.status = SolverStatus::TIME_LIMIT;
      result.message = "time limit reached";
      return;
    }
  }
}

}  // namespace frictional_contact_sim
