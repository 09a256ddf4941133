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
  OurContestant(const DelassusProblem& problem, const std::string& solver)
    : problem_(problem), solver_(createSolver(solver))
  {
  }
  void prepare(double tolerance, int, double time_limit) override
  {
    StoppingOptions stopping;
    stopping.tolerance = tolerance;
    stopping.max_iterations = MAX_ITERATIONS;
    stopping.time_limit = time_limit;
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
  SolverResult result_;
};
}  // namespace

Entry ourEntry(const DelassusProblem& problem, const std::string& solver)
{
  createSolver(solver);  // an unknown name is refused here, not in a child
  return {solver, problem.W.isDense() ? "dense" : "block rows", true,
          [&problem, solver] { return std::make_unique<OurContestant>(problem, solver); }};
}

}  // namespace comparison
