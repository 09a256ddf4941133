// One time step, in the order of docs/architecture.md.
#include <algorithm>
#include <cmath>
#include <exception>
#include <sstream>

#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/problem/energy_check.h"
#include "frictional_contact_sim/solver/equilibrium.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double EQUILIBRIUM_ROUND_OFF = 1e-8;  ///< share of the loads that a balance may miss
constexpr double GAP_ROUND_OFF = 1e-14;  ///< a resting contact is no deeper [m]
/// Overlaps that could not be pushed out are left for so many steps: else every one would ask in vain.
constexpr int WEDGED_STEPS = 64;
constexpr double WEDGED_MARGIN = 1e-9;  ///< for what the solver's tolerance adds to them in these steps [m]
/// Solves of a step that leave the overlaps of their worst pairs only, before all are left.
constexpr int MOST_PARTIAL_PUSHES = 2;
constexpr double SHARE_OF_WORST = 0.01;  ///< a law with this share of the largest error is not met
/// Rounds (solve, look at the rows, solve again) that may end without an answer before the step is given up: a servo
/// that becomes a bounded row may be what makes the problem solvable, but a failed solve costs its whole budget.
constexpr int MOST_FAILED_ROUNDS = 2;

/** Why a solid's model does not hold where an answer takes it; empty where every one does. */
std::string refusal(const std::vector<Body>& bodies, const Solution& solution, double dt)
{
  Eigen::VectorXd q;
  Eigen::VectorXd v;
  for (const Body& body : bodies)
    if (body.model.solid)
    {
      q = v = body.state.q;
      moveStep(body, solution.v.segment(body.v_offset, body.model.nv), dt, q, v);
      if (std::string reason = body.model.solid->refusal(q); !reason.empty())
        return reason;
    }
  return "";
}

/** Whether another round makes sense after a solve. */
bool mayGoOn(SolverStatus status)
{
  return status != SolverStatus::TIME_LIMIT && status != SolverStatus::STOPPED_BY_USER;
}
}  // namespace

const StepOutcome& Simulator::step()
{
  Impl& sim = *impl_;
  sim.outcome.fclib_file.clear();
  sim.solver.begin();
  sim.is_solved = false;
  try
  {
    sim.moveToMidpoint();
    sim.assembly.begin(sim.context);
    sim.solveStep();
    sim.is_solved = true;
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
  context.middle = state.scenario_clock.time(state.dt) + 0.5 * context.dt;
  const double time = state.scenario_clock.time(state.dt);
  for (Body& body : bodies)
  {
    setBaseTime(body, time, context.dt, true);
    frictional_contact_sim::moveToMidpoint(body, context.dt);
    applyWrenches(body, context.middle);
  }
}

void Simulator::Impl::solveStep()
{
  Again again = Again::FROM_GUESS;
  int failed_rounds = 0;
  beginRows();
  do
  {
    if (again == Again::FROM_GUESS)
      if (const int singular = assembly.assembleForces(context); singular >= 0)
      {
        assembly.clear();
        fail(SolverStatus::NUMERICAL_FAILURE,
             "the mass matrix of body '" + bodies[singular].model.name + "' is not positive definite");
        return;
      }
    if (context.points == nullptr)
      context.points = &contact_set.find(context);
    if (again == Again::FORCES)
      guess = result.solution;
    else
    {
      if (again == Again::FROM_ANSWER)
        assembly.followAnswer(context, result.solution);
      assembly.assembleRows(context);
      assembly.makeGuess(context, guess, again == Again::FROM_ANSWER ? &result.solution : nullptr);
      assembly.assembleProblem(context);
    }
    if (context.balance)
    {
      judgeEquilibrium();
      return;
    }
    const bool pushes = pushesOut();
    const bool can_ask_less = pushes || mayRecoverLess() || contact_set.canGoBack();
    solver.solve(assembly.problem(), guess, !can_ask_less, pushes, result);
    again = Again::NO;
    failed_rounds += result.status != SolverStatus::CONVERGED;
    if (mayGoOn(result.status) && failed_rounds <= MOST_FAILED_ROUNDS && isMotion(result.solution))
      again = assembly.again(context, result.solution, result.status == SolverStatus::CONVERGED);
    if (again == Again::NO && mayGoOn(result.status) && result.status != SolverStatus::CONVERGED && can_ask_less)
    {
      askLess();
      again = Again::FROM_GUESS;
    }
    if (again == Again::NO && dropRestitution())
      again = Again::FROM_GUESS;
  } while (again == Again::FROM_GUESS || again == Again::FROM_ANSWER || again == Again::FORCES);
  if (isMotion(result.solution))
    assembly.settleFreeLinks(result.solution);
  if (again == Again::NEVER)
    setUnsatisfied();
  solver.takeLeastNorm(assembly.problem(), result);
  if (result.status == SolverStatus::CONVERGED)
    if (const std::string reason = refusal(bodies, result.solution, context.dt); !reason.empty())
      fail(SolverStatus::NUMERICAL_FAILURE, reason);
}

/** Statics of rigid bodies, see solver/equilibrium.h: forces at rest, or the proof that there are none. */
void Simulator::Impl::judgeEquilibrium()
{
  const IncrementalProblem& problem = assembly.problem();
  Equilibrium found = findEquilibrium(problem, std::max(context.tolerance, EQUILIBRIUM_ROUND_OFF));
  if (!found.exists)
  {
    size_t fastest = 0;
    double speed = -1.0;
    for (Body& body : bodies)
    {
      body.change = found.solution.v.segment(body.v_offset, body.model.nv);
      if (const double own = body.model.nv > 0 ? pointSpeed(body, body.change) : 0.0; own > speed)
      {
        speed = own;
        fastest = static_cast<size_t>(&body - bodies.data());
      }
    }
    std::ostringstream message;
    message << (found.is_proven
                    ? "no equilibrium exists: no contact force opposes a motion on which the loads do work, "
                    : "no equilibrium was found, nor a proof that there is none: ")
            << "body '" << bodies[fastest].model.name << "' moves most, " << found.share
            << " of the loads is not balanced";
    fail(SolverStatus::STAGNATED, message.str());
    return;
  }
  result = SolverResult();
  result.solver = "equilibrium";
  result.tried = {result.solver};
  result.status = SolverStatus::CONVERGED;
  result.iterations = found.iterations;
  result.solution = found.solution;
  result.solution.u = problem.w;  // v = 0
  result.residual = found.residual;
  result.law_errors.setZero(static_cast<Eigen::Index>(problem.laws.size()));
}

/** No points yet, and what the last problem asked less of is asked again. */
void Simulator::Impl::beginRows()
{
  context.points = nullptr;
  context.normal_law.recovery_speed = NormalLaw().recovery_speed;
  context.wedged = state.wedged;
  context.wedged_ahead.clear();
  context.inelastic = false;
  failed_pushes = 0;
}

/** Whether the row of a point asks for a separation, not for round-off only. */
bool Simulator::Impl::pushesOut(const ContactPoint& point) const
{
  const double gap = point.is_linearised ? point.row_gap : point.gap;
  return gap < -GAP_ROUND_OFF && context.normalLaw(point).gapToMend(gap) < -GAP_ROUND_OFF;
}

bool Simulator::Impl::pushesOut() const
{
  return context.normal_law.recovery_speed > 0.0 && std::any_of(
                                                        context.points->begin(), context.points->end(),
                                                        [this](const ContactPoint& point) { return pushesOut(point); });
}

/** Beside wedged pairs what is beyond a joint's limit may be wedged as well. */
bool Simulator::Impl::mayRecoverLess() const
{
  return context.normal_law.recovery_speed > 0.0 && !context.wedged.empty();
}

/**
 * After a solve without an answer: a link that friction jams cannot part again at the speed it came with.
 * @return whether there is restitution to drop: the rows are others then
 */
bool Simulator::Impl::dropRestitution()
{
  if (result.status == SolverStatus::CONVERGED || !mayGoOn(result.status) || context.inelastic || !assembly.bouncing())
    return false;
  context.inelastic = true;
  return true;
}

/** Points that are pushed out and whose law the last solve has not met. */
std::vector<const ContactPoint*> Simulator::Impl::unmetPushes() const
{
  std::vector<const ContactPoint*> points;
  const double worst = result.law_errors.size() == 0 ? 0.0 : result.law_errors.maxCoeff();
  for (Eigen::Index law = 0; law < result.law_errors.size(); ++law)
    if (result.law_errors[law] > SHARE_OF_WORST * worst)
      if (const ContactPoint* point = assembly.contactOf(context, static_cast<int>(law)); point && pushesOut(*point))
        points.push_back(point);
  return points;
}

/**
 * After a solve without an answer: overlaps that are not pushed out (see dynamics/wedged_pairs.h), those of the pairs
 * whose law is not met first, then all; else fewer rows.
 */
void Simulator::Impl::askLess()
{
  if (!pushesOut())
  {
    if (mayRecoverLess())
      context.normal_law.recovery_speed = 0.0;
    else
      contact_set.goBack();
    return;
  }
  contact_set.beLenient();
  std::vector<const ContactPoint*> left;
  if (++failed_pushes <= MOST_PARTIAL_PUSHES)
    left = unmetPushes();
  else
    context.normal_law.recovery_speed = 0.0;
  if (left.empty())
    for (const ContactPoint& point : *context.points)
      if (pushesOut(point))
        left.push_back(&point);
  for (const ContactPoint* point : left)
  {
    const double overlap = -(point->is_linearised ? point->row_gap : point->gap);
    leaveOverlap({point->shape_a, point->shape_b, overlap + WEDGED_MARGIN, WEDGED_STEPS},
                 point->is_linearised ? context.wedged_ahead : context.wedged);
  }
}

/** Solves converged, but not the rows' own law. */
void Simulator::Impl::setUnsatisfied()
{
  result.status = SolverStatus::MAX_ITERATIONS;
  result.message = std::string(assembly.unsatisfied()) + ": not met after the most repetitions of a step";
}

/** A step without an answer. */
void Simulator::Impl::fail(SolverStatus status, const std::string& message)
{
  setNoAnswer(assembly.problem(), status, message, result);
}

/** The step is over: what is left of it is the answer's, or what the failure policy says. */
void Simulator::Impl::advance()
{
  outcome.taken = true;
  if (result.status == SolverStatus::CONVERGED)
  {
    take();
    return;
  }
  const bool stopped = result.status == SolverStatus::STOPPED_BY_USER;
  if (!stopped)
    dumpProblem("step_" + std::to_string(state.step + 1));
  const FailurePolicy policy = scenario.failure.policy;
  if (stopped || policy == FailurePolicy::STOP || policy == FailurePolicy::PAUSE)
    outcome.taken = false;  // nothing before this line has written to the state
  else if (policy == FailurePolicy::ACCEPT && acceptable())
    take();
  else
    hold();
}

void Simulator::Impl::take()
{
  state.wedged = context.wedged;
  countStep(state.wedged);
  assembly.setMeanVelocity(result.solution);
  assembly.book(context, result.solution, state.energy);
  for (Body& body : bodies)
  {
    moveToEnd(body, result.solution.v.segment(body.v_offset, body.model.nv), context.dt);
    removeExpiredWrenches(body, context.middle);
  }
  assembly.accept(context, {result.solution, result.law_errors});
  ++state.clock.steps;
  ++state.scenario_clock.steps;
}

bool Simulator::Impl::acceptable() const
{
  return isMotion(result.solution) &&
         checkEnergy(assembly.problem(), result.solution, result.free_energy, context.tolerance).holds();
}

void Simulator::Impl::standStill()
{
  result.solution.v.setZero(assembly.problem().velocities());
  result.solution.u.setZero(assembly.problem().rows());
  result.solution.r.setZero(assembly.problem().rows());
  result.solution.lambda.setZero(assembly.problem().bilaterals());
  result.law_errors.setZero();  // of standing still
}

/**
 * Everything stops where it is; time and prescribed bases go on. The kinetic energy taken is booked as an impact's,
 * what moving bases do to the potential energy of what they carry as their work.
 */
void Simulator::Impl::hold()
{
  standStill();
  bookEnergies();
  const double kinetic = state.energy.kinetic;
  const double potential = state.energy.potential;
  for (size_t b = 0; b < bodies.size(); ++b)
  {
    Body& body = bodies[b];
    if (!body.state.q.allFinite())
      body.state.q = good[b].first;
    body.state.v.setZero();
    body.state.base_pose = basePose(body, context.dt);
    removeExpiredWrenches(body, context.middle);
    updateEnd(body);
  }
  assembly.accept(context, {result.solution, result.law_errors});
  bookEnergies();
  if (std::isfinite(kinetic) && std::isfinite(potential))
  {
    state.energy.impact += kinetic - state.energy.kinetic;
    state.energy.actuators += state.energy.potential - potential;
  }
  ++state.clock.steps;
  ++state.scenario_clock.steps;
}

}  // namespace frictional_contact_sim
