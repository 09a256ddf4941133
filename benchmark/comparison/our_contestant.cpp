#include "comparison/contestant.h"
#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/cadoux_fixed_point.h"
#include "frictional_contact_sim/solver/convex/projected_gradient.h"
#include "frictional_contact_sim/solver/ds_fixed_point.h"
#include "frictional_contact_sim/solver/haslinger.h"
#include "frictional_contact_sim/solver/registry.h"

namespace comparison
{
namespace
{
using namespace frictional_contact_sim;

/// High enough that the time limit decides, as on Siconos's side.
constexpr int MAX_ITERATIONS = 1000000;

using Create = std::function<std::unique_ptr<Solver>()>;

class OurContestant : public Contestant
{
public:
  OurContestant(const DelassusProblem& problem, std::unique_ptr<Solver> solver)
    : problem_(problem), solver_(std::move(solver))
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

Entry makeEntry(const DelassusProblem& problem, const std::string& name, const Create& create)
{
  return {name, problem.W.isDense() ? "dense" : "block rows", true,
          [&problem, create] { return std::make_unique<OurContestant>(problem, create()); }};
}

std::unique_ptr<Solver> plainNewton()
{
  SemismoothNewtonOptions options;
  options.proximal_start = options.proximal_min;
  options.proximal_restart = options.proximal_min;
  options.proximal_max = options.proximal_min;
  return std::make_unique<AcNewton>(options);
}

std::unique_ptr<Solver> fixedStep()
{
  FixedPointOptions options;
  options.adapt = false;
  return std::make_unique<DsFixedPoint>(options);
}

std::unique_ptr<ConvexSolver> thesisInner()
{
  return std::make_unique<ProjectedGradient>(ProjectedGradientOptions::thesisOptions());
}

std::unique_ptr<Solver> thesisHaslinger()
{
  return std::make_unique<Haslinger>(HaslingerOptions(), thesisInner());
}

std::unique_ptr<Solver> thesisCadoux()
{
  CadouxOptions options;
  options.initial_slip = InitialSlip::ZERO;
  return std::make_unique<CadouxFixedPoint>(options, thesisInner());
}
}  // namespace

Entry ourEntry(const DelassusProblem& problem, const std::string& solver)
{
  createSolver(solver);  // an unknown name is refused here, not in a child
  return makeEntry(problem, solver, [solver] { return createSolver(solver); });
}

std::vector<Entry> thesisEntries(const DelassusProblem& problem)
{
  return {makeEntry(problem, "thesis AC", &plainNewton), makeEntry(problem, "thesis DS", &fixedStep),
          makeEntry(problem, "thesis H-pf", &thesisHaslinger), makeEntry(problem, "thesis NA-pf", &thesisCadoux)};
}

}  // namespace comparison
