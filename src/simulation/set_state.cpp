// A state from outside: checked, then taken as it is (setState), or with an impact solve (start, stateChanged).
#include <algorithm>
#include <cmath>
#include <exception>

#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
bool sameShape(const SimulationState& a, const SimulationState& b)
{
  const auto same_body = [](const BodyState& x, const BodyState& y)
  { return x.q.size() == y.q.size() && x.v.size() == y.v.size() && x.drives.size() == y.drives.size(); };
  const auto same_memory = [](const RowMemory& x, const RowMemory& y)
  { return x.name == y.name && x.impulses.size() == y.impulses.size(); };
  return std::equal(a.bodies.begin(), a.bodies.end(), b.bodies.begin(), b.bodies.end(), same_body) &&
         std::equal(a.rows.memory.begin(), a.rows.memory.end(), b.rows.memory.begin(), b.rows.memory.end(),
                    same_memory);
}

/** Of bodies and links that exist, and where they are not welded twice. */
void checkWelds(const Simulator& simulator, const SimulationState& state)
{
  const auto check = [&](int body, int frame, bool may_be_world)
  {
    if (may_be_world && body == -1 && frame == -1)
      return;
    if (body < 0 || body >= simulator.bodyCount())
      throw StateError("the body of a weld is " + std::to_string(body) + ", expected 0 to " +
                       std::to_string(simulator.bodyCount() - 1));
    if (simulator.workspace(body).model.solid)
      throw StateError("the body of a weld is " + std::to_string(body) + ", which is deformable, expected a rigid one");
    const int frames = static_cast<int>(simulator.model(body).frames.size());
    if (frame < 0 || frame >= frames)
      throw StateError("the link of a weld is " + std::to_string(frame) + ", expected 0 to " +
                       std::to_string(frames - 1));
  };
  for (const Closure& weld : state.rows.welds)
  {
    check(weld.body_a, weld.frame_a, false);
    check(weld.body_b, weld.frame_b, true);
    const Eigen::Matrix3d turn = weld.pose.linear();
    if (!weld.pose.matrix().allFinite() || !weld.impulse.allFinite() || !(turn.transpose() * turn).isIdentity(1e-6) ||
        turn.determinant() < 0.0)
      throw StateError("the pose or impulse of a weld is not one");
  }
}

/** A drive can follow a schedule only where the world has one; a trajectory comes with it. */
void checkDrives(const WorldModel& world, const SimulationState& state)
{
  for (size_t b = 0; b < state.bodies.size(); ++b)
    for (size_t j = 0; j < state.bodies[b].drives.size(); ++j)
    {
      const JointDrive& drive = state.bodies[b].drives[j];
      const std::string place =
          "joint '" + world.bodies[b].tree.joints[j].name + "' of body '" + world.bodies[b].name + "': ";
      if (drive.is_scheduled && world.bodies[b].schedules[j].empty())
        throw StateError(place + "follows a command over time, expected one that this scenario has");
      try
      {
        drive.trajectory.validate();
      }
      catch (const std::invalid_argument& error)
      {
        throw StateError(place + error.what());
      }
    }
}

/** Why q and v cannot be a body's; empty where they can. */
std::string motionFault(const BodyModel& model, const BodyState& state)
{
  if (!state.q.allFinite() || !state.v.allFinite())
    return "its position or velocity is not finite";
  if (model.regime != Regime::DYNAMIC && !state.v.isZero(0.0))
    return "it has a velocity, expected none where every step is an equilibrium";
  return "";
}

/** What the sizes do not say of a state from outside. */
void checkNumbers(const Simulator& simulator, const SimulationState& state)
{
  if (!(state.dt > 0.0) || !std::isfinite(state.dt) || !std::isfinite(state.time()))
    throw StateError("dt or the time is not a finite number > 0");
  for (size_t b = 0; b < state.bodies.size(); ++b)
  {
    const BodyState& body = state.bodies[b];
    const BodyModel& model = simulator.workspace(static_cast<int>(b)).model;
    if (const std::string fault = motionFault(model, body); !fault.empty())
      throw StateError("body '" + model.name + "': " + fault);
    if (!body.base_pose.matrix().allFinite())
      throw StateError("body '" + model.name + "': the pose of its base is not finite");
    const int frames = static_cast<int>(model.tree.frames.size());
    for (const ExternalWrench& wrench : body.wrenches)
    {
      if (wrench.frame < 0 || wrench.frame >= frames)
        throw StateError("wrench.frame is " + std::to_string(wrench.frame) + ", expected 0 to " +
                         std::to_string(frames - 1));
      if (const std::string reason = wrenchRefusal(model, wrench); !reason.empty())
        throw StateError("a wrench on body '" + model.name + "': " + reason);
    }
  }
  const auto checkShapes = [&](const char* of, int shape_a, int shape_b)
  {
    for (const int shape : {shape_a, shape_b})
      if (shape < 0 || shape >= simulator.shapeCount())
        throw StateError(std::string(of) + " shape is " + std::to_string(shape) + ", expected 0 to " +
                         std::to_string(simulator.shapeCount() - 1));
  };
  for (const ContactState& contact : state.rows.contacts)
    checkShapes("a contact's", contact.shape_a, contact.shape_b);
  for (size_t i = 0; i < state.wedged.size(); ++i)
  {
    const WedgedPair& pair = state.wedged[i];
    checkShapes("a wedged pair's", pair.shape_a, pair.shape_b);
    if (!(pair.overlap >= 0.0) || !std::isfinite(pair.overlap) || pair.steps < 1)
      throw StateError("a wedged pair is left " + numberText(pair.overlap) + " m for " + std::to_string(pair.steps) +
                       " steps, expected a finite overlap >= 0 and at least one step");
    if (i > 0 && std::make_pair(state.wedged[i - 1].shape_a, state.wedged[i - 1].shape_b) >=
                     std::make_pair(pair.shape_a, pair.shape_b))
      throw StateError("wedged pairs are not in the order of their shapes");
  }
}
}  // namespace

/** The state as it stands in q and v becomes the state: impact solve, warm starts dropped, ledger anew. */
void Simulator::Impl::applyState()
{
  outcome = StepOutcome{};
  context.points = nullptr;
  is_solved = false;
  solver.begin();
  const SimulationState before = state;
  for (const Body& body : bodies)
    if (const std::string fault = motionFault(body.model, body.state); !fault.empty())
    {
      fail(SolverStatus::NUMERICAL_FAILURE, "body '" + body.model.name + "': " + fault);
      storeOutcome();
      goBack(before);
      return;
    }
  state.rows.contacts.clear();
  for (RowMemory& memory : state.rows.memory)
    std::fill(memory.impulses.begin(), memory.impulses.end(), 0.0);
  for (std::vector<Closure>* closures : {&state.rows.loops, &state.rows.welds})
    for (Closure& closure : *closures)
      closure.impulse.setZero();
  for (BodyState& body : state.bodies)
    for (JointDrive& drive : body.drives)
      drive.effort = 0.0;
  updateEnds();
  restartReport();
  restartLedger();
  impactSolve();
  if (!outcome.taken)
    goBack(before);
  else
    rememberGood();
}

/** All of it as it was before q and v were written. */
void Simulator::Impl::goBack(const SimulationState& before)
{
  outcome.taken = false;
  state = before;
  joinWelded();
  for (size_t b = 0; b < good.size(); ++b)
  {
    state.bodies[b].q = good[b].first;
    state.bodies[b].v = good[b].second;
  }
  updateEnds();
  restartReport();
}

/** Nothing is thrown; where the impact has no answer the failure policy says what is left. From rest to rest there are
 * no velocities, and no impacts. */
void Simulator::Impl::impactSolve()
{
  if (scenario.regime != Regime::DYNAMIC)
  {
    const double kinetic = state.energy.kinetic;
    for (Body& body : bodies)
      body.state.v.setZero();
    updateEnds();
    bookEnergies();
    state.energy.impact += kinetic - state.energy.kinetic;
    return;
  }
  context.impact = true;
  try
  {
    solveImpact();
  }
  catch (const std::exception& error)
  {
    assembly.clear();
    fail(SolverStatus::NUMERICAL_FAILURE, error.what());
    finishImpact();
  }
  context.impact = false;
}

void Simulator::Impl::solveImpact()
{
  for (Body& body : bodies)
    moveToImpact(body);
  beginRows();
  assembly.begin(context);
  assembly.assembleForces(context);
  context.points = &contact_set.find(context);
  assembly.assembleRows(context);
  if (!assembly.closing())
    return;
  Again again = Again::FROM_GUESS;
  do
  {
    if (again == Again::FROM_ANSWER || context.inelastic)
      assembly.assembleRows(context);
    assembly.makeGuess(context, guess, again == Again::FROM_ANSWER ? &result.solution : nullptr);
    assembly.assembleProblem(context);
    solver.solve(assembly.problem(), guess, true, false, result);
    again = result.status == SolverStatus::CONVERGED ? assembly.again(context, result.solution, true) : Again::NO;
    if (again == Again::NO && dropRestitution())
      again = Again::FROM_GUESS;
  } while (again == Again::FROM_ANSWER || again == Again::FROM_GUESS);
  is_solved = true;
  if (again == Again::NEVER)
    setUnsatisfied();
  finishImpact();
}

void Simulator::Impl::finishImpact()
{
  const bool failed = result.status != SolverStatus::CONVERGED;
  if (failed && result.status != SolverStatus::STOPPED_BY_USER)
    dumpProblem(state.step == 0 ? "start" : "set_after_step_" + std::to_string(state.step));
  storeOutcome();
  const FailurePolicy policy = scenario.failure.policy;
  outcome.taken = !failed || (result.status != SolverStatus::STOPPED_BY_USER && policy != FailurePolicy::STOP &&
                              policy != FailurePolicy::PAUSE);
  if (!outcome.taken)
    return;
  const bool stands = failed && (policy == FailurePolicy::HOLD || !acceptable());
  const double kinetic = state.energy.kinetic;
  if (stands)
  {
    standStill();
  }
  else
  {
    assembly.setMeanVelocity(result.solution);
    assembly.book(context, result.solution, state.energy);
  }
  // What no impulse touches keeps its velocity to the bit.
  const std::vector<char>& acting = assembly.acting(result.solution);
  for (size_t b = 0; b < bodies.size(); ++b)
    if (stands || acting[b] != 0)
      bodies[b].state.v = result.solution.v.segment(bodies[b].v_offset, bodies[b].model.nv);
  updateEnds();
  bookEnergies();
  if (stands)
    state.energy.impact += kinetic - state.energy.kinetic;
}

const StepOutcome& Simulator::setState(const SimulationState& state, const RunSettings& settings)
{
  if (!sameShape(state, impl_->state))
    throw StateError("the state's bodies or joints differ in number from the simulator's");
  checkNumbers(*this, state);
  checkDrives(*impl_->world, state);
  checkWelds(*this, state);
  impl_->checkSettings(settings);
  takeSettings(settings);
  const double dt = impl_->state.dt;
  impl_->state = state;
  impl_->joinWelded();
  impl_->updateEnds();
  impl_->rememberGood();
  if (state.dt != dt)
    setTimeStep(dt);
  impl_->restartReport();
  impl_->moveLedgerZero(state.energy.potential);
  impl_->outcome = StepOutcome{};
  return impl_->outcome;
}

const StepOutcome& Simulator::stateChanged()
{
  impl_->applyState();
  if (impl_->outcome.taken && impl_->context.points != nullptr)
    for (const ContactPoint& point : *impl_->context.points)
      impl_->report.max_penetration = std::max(impl_->report.max_penetration, -point.gap);
  return impl_->outcome;
}

}  // namespace frictional_contact_sim
