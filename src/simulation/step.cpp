// One time step, in the order of DESIGN.md.
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "frictional_contact_sim/model/kinematics.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double MINIMUM_MARGIN = 1e-3;  ///< contacts nearer than this are always in the problem [m]
constexpr double RUNAWAY_SPEED = 1e9;  ///< faster than light [m/s] or [rad/s]: not a motion, a failed step
}  // namespace

const StepOutcome& Simulator::step()
{
  Impl& sim = *impl_;
  sim.outcome.fclib_file.clear();
  try
  {
    sim.moveToMidpoint();
    sim.context.points = &sim.collision.detect(sim.lookAhead());
    sim.assembly.begin(sim.context);
    sim.solveStep();
  }
  catch (const std::exception& error)
  {
    sim.assembly.clear();
    sim.fail(SolverStatus::NUMERICAL_FAILURE, error.what());
  }
  sim.advance();
  sim.finishStep();
  return sim.outcome;
}

void Simulator::Impl::moveToMidpoint()
{
  const double middle = state.scenario_clock.time(state.dt) + 0.5 * context.dt;
  for (size_t b = 0; b < bodies.size(); ++b)
  {
    Body& body = bodies[b];
    frictional_contact_sim::moveToMidpoint(body, context.dt);
    collision.setPoses(static_cast<int>(b), body.middle);
    applyWrenches(body, middle);
  }
}

/** Farther than any point can travel in two steps at the present velocities. */
double Simulator::Impl::lookAhead() const
{
  double fastest = 0.0;
  for (const Body& body : bodies)
    for (size_t link = 0; link < body.model.tree.links.size(); ++link)
    {
      if (body.model.chains[link].empty() && !body.model.base_motion.active)
        continue;
      const Vector6d velocity = pointVelocity(body.end, static_cast<int>(link), body.end.link_pose[link].translation());
      fastest = std::max(fastest, velocity.head<3>().norm() + velocity.tail<3>().norm() * body.model.extents[link]);
    }
  return MINIMUM_MARGIN + 2.0 * context.dt * fastest;
}

void Simulator::Impl::solveStep()
{
  Again again = Again::FROM_GUESS;
  do
  {
    if (again != Again::FORCES)
    {
      assembly.assembleRows(context);
      assembly.makeGuess(context, guess);
      const bool from_answer = again == Again::FROM_ANSWER;
      const int singular = assembly.assembleDynamics(context, guess, from_answer ? &result.solution : nullptr);
      if (singular >= 0)
      {
        fail(SolverStatus::NUMERICAL_FAILURE,
             "the mass matrix of body '" + bodies[singular].model.name + "' is not positive definite");
        return;
      }
      if (from_answer && result.solution.r.size() == guess.r.size())
        guess.r = result.solution.r;
    }
    else
      guess = result.solution;
    solve();
    again = Again::NO;
    if (isMotion(result.solution))
      again = assembly.again(context, result.solution, result.status == SolverStatus::CONVERGED);
  } while (again == Again::FROM_GUESS || again == Again::FROM_ANSWER || again == Again::FORCES);
  if (isMotion(result.solution))
    assembly.settleFreeLinks(result.solution);
  if (again == Again::NEVER)
  {
    result.status = SolverStatus::MAX_ITERATIONS;
    result.message = std::string(assembly.unsatisfied()) + ": not met after the most repetitions of a step";
  }
}

bool Simulator::Impl::isMotion(const Solution& solution)
{
  return solution.r.allFinite() && solution.v.allFinite() && solution.u.allFinite() && solution.lambda.allFinite() &&
         (solution.v.size() == 0 || solution.v.cwiseAbs().maxCoeff() < RUNAWAY_SPEED);
}

/** A step without an answer: v is not a number, so that nobody takes it for one. */
void Simulator::Impl::fail(SolverStatus status, const std::string& message)
{
  result.status = status;
  result.message = message;
  result.solver.clear();
  result.tried.clear();
  result.iterations = 0;
  result.seconds = 0.0;
  result.residual = 1.0;
  result.law_errors.setZero(static_cast<Eigen::Index>(assembly.problem().laws.size()));
  result.solution.v.setConstant(assembly.problem().velocities(), std::numeric_limits<double>::quiet_NaN());
  result.solution.u.setZero(assembly.problem().rows());
  result.solution.r.setZero(assembly.problem().rows());
  result.solution.lambda.setZero(assembly.problem().bilaterals());
}

void Simulator::Impl::solve()
{
  // A state that has run away (after accepted failures) overflows here; it must not reach the solver as a NaN.
  if (!assembly.problem().f.allFinite() || !assembly.problem().w.allFinite())
  {
    fail(SolverStatus::NUMERICAL_FAILURE, "forces or velocities have run away");
    return;
  }
  try
  {
    solver->solve(assembly.problem(), &guess, result);
  }
  catch (const std::exception& error)
  {
    fail(SolverStatus::NUMERICAL_FAILURE, error.what());
    return;
  }
  if (!isMotion(result.solution))
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message = "the answer is not a motion";
    result.residual = 1.0;
  }
}

void Simulator::Impl::advance()
{
  const bool failed = result.status != SolverStatus::CONVERGED;
  if (failed)
    dumpProblem("step_" + std::to_string(state.step + 1));
  const bool held = failed && handleFailure();
  assembly.setMeanVelocity(result.solution);
  if (!held)
    assembly.book(context, result.solution, state.energy);
  for (Body& body : bodies)
    moveToEnd(body, result.solution.v.segment(body.v_offset, body.model.tree.nv), context.dt);
  assembly.accept(context, {result.solution, result.law_errors});
  ++state.clock.steps;
  ++state.scenario_clock.steps;
}

/** A step without a converged answer: keep the best iterate, or, where it is not finite or the policy says so, stand.
 */
bool Simulator::Impl::handleFailure()
{
  if (isMotion(result.solution) && policy != FailurePolicy::HOLD)
    return false;
  result.solution.v.setZero(assembly.problem().velocities());
  result.solution.u.setZero(assembly.problem().rows());
  result.solution.r.setZero(assembly.problem().rows());
  result.solution.lambda.setZero(assembly.problem().bilaterals());
  result.law_errors.setZero();  // of standing still
  for (Body& body : bodies)
    stand(body);
  return true;
}

}  // namespace frictional_contact_sim
