#include "comparison/contestant.h"
#include "frictional_contact_sim/solver/registry.h"

namespace comparison
{
namespace
{
using namespace frictional_contact_sim;

/// High enough that the time limit decides, as on Siconos's side.
constexpr int MAX_ITERATIONS = 1000000;

class OurContestant : public Contestant
{
public:
  OurContestant(const DelassusProblem& problem, const std::string& solver, double time_limit)
    : problem_(problem), solver_(createSolver(solver)), time_limit_(time_limit)
  {
  }
  void prepare(double tolerance) override
  {
    StoppingOptions stopping;
    stopping.tolerance = tolerance;
    stopping.max_iterations = MAX_ITERATIONS;
    stopping.time_limit = time_limit_;
    solver_->setStopping(stopping);
  }
  bool solve() override
  {
    solver_->solve(problem_, nullptr, result_);
    return result_.status == SolverStatus::CONVERGED;
  }
  const Eigen::VectorXd& impulses() const override { return result_.solution.r; }

private:
  const DelassusProblem& problem_;
  std::unique_ptr<Solver> solver_;
  double time_limit_;
  SolverResult result_;
};
}  // namespace

Entry ourEntry(const DelassusProblem& problem, const std::string& solver, double time_limit)
{
  createSolver(solver);  // an unknown name is refused here, not in a child
  return {solver, problem.W.isDense() ? "dense" : "block rows", true,
          [&problem, solver, time_limit] { return std::make_unique<OurContestant>(problem, solver, time_limit); }};
}

}  // namespace comparison
