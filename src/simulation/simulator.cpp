#include "frictional_contact_sim/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/dynamics/row_sources.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "frictional_contact_sim/solver/registry.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
StepContext makeContext(const Scenario& scenario)
{
  StepContext context;
  context.dt = scenario.time_step;
  context.gravity = scenario.gravity;
  context.tolerance = scenario.stopping.tolerance;
  context.normal_law.form = scenario.contact_law;
  // An approach slower than what gravity gives in one step is rest, not an impact.
  context.normal_law.closing_speed = std::max(1e-9, scenario.gravity.norm() * scenario.time_step);
  return context;
}

SimulationState makeState(const WorldModel& world)
{
  SimulationState state;
  state.dt = world.scenario.time_step;
  state.bodies = world.start;
  return state;
}

std::vector<Body> makeBodies(const WorldModel& world, SimulationState& state)
{
  std::vector<Body> bodies;
  bodies.reserve(world.bodies.size());
  for (size_t b = 0; b < world.bodies.size(); ++b)
    bodies.emplace_back(world.bodies[b], state.bodies[b]);
  return bodies;
}

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

/** What the sizes do not say of a state from outside. */
void checkNumbers(const Simulator& simulator, const SimulationState& state)
{
  if (!(state.dt > 0.0) || !std::isfinite(state.dt) || !std::isfinite(state.time()))
    throw StateError("dt or the time is not a finite number > 0");
  for (size_t b = 0; b < state.bodies.size(); ++b)
  {
    const BodyState& body = state.bodies[b];
    if (!body.q.allFinite() || !body.v.allFinite() || !body.base_pose.matrix().allFinite())
      throw StateError("the position or velocity of body " + std::to_string(b) + " is not finite");
    const int frames = static_cast<int>(simulator.model(static_cast<int>(b)).frames.size());
    for (const ExternalWrench& wrench : body.wrenches)
      if (wrench.frame < 0 || wrench.frame >= frames)
        throw StateError("wrench.frame is " + std::to_string(wrench.frame) + ", expected 0 to " +
                         std::to_string(frames - 1));
  }
  for (const ContactState& contact : state.rows.contacts)
    for (const int shape : {contact.shape_a, contact.shape_b})
      if (shape < 0 || shape >= simulator.shapeCount())
        throw StateError("a contact's shape is " + std::to_string(shape) + ", expected 0 to " +
                         std::to_string(simulator.shapeCount() - 1));
}
}  // namespace

Simulator::Impl::Impl(std::shared_ptr<const WorldModel> world_model)
  : world(std::move(world_model))
  , scenario(world->scenario)
  , collision(world->collision)
  , state(makeState(*world))
  , bodies(makeBodies(*world, state))
  , context(makeContext(scenario))
  , assembly(bodies, makeRowSources(bodies, collision, world->pairs, state.rows), state.rows)
  , solver(createSolver(scenario.solver))
  , island_of(bodies.size())
{
  solver->setStopping(scenario.stopping);
  applyState();
  setStart();
}

Simulator::Simulator(const Scenario& scenario) : Simulator(loadWorldModel(scenario))
{
}

Simulator::Simulator(std::shared_ptr<const WorldModel> world) : impl_(std::make_unique<Impl>(std::move(world)))
{
}

Simulator::~Simulator() = default;

/** The state as it stands in q and v becomes the state: impact solve, warm starts dropped, ledger anew. */
void Simulator::Impl::applyState()
{
  state.rows.contacts.clear();
  for (RowMemory& memory : state.rows.memory)
    std::fill(memory.impulses.begin(), memory.impulses.end(), 0.0);
  for (BodyState& body : state.bodies)
    for (JointDrive& drive : body.drives)
      drive.effort = 0.0;
  updateEnds();
  restartReport();
  restartLedger();
  impactSolve();
}

void Simulator::Impl::updateEnds()
{
  for (Body& body : bodies)
    updateEnd(body);
}

void Simulator::Impl::bookEnergies()
{
  state.energy.kinetic = 0.0;
  state.energy.potential = 0.0;
  for (const Body& body : bodies)
  {
    if (body.model.tree.nv == 0)
      continue;
    state.energy.kinetic += kineticEnergy(body.model.tree, body.end);
    state.energy.potential += potentialEnergy(body.model.tree, body.end, context.gravity);
  }
  report.energy = state.energy;
}

void Simulator::Impl::restartLedger()
{
  state.energy = EnergyLedger{};
  bookEnergies();
  state.energy_start = state.energy.kinetic + state.energy.potential;
}

/** Nothing is thrown; where the impact has no finite answer, velocities stay as they are. */
void Simulator::Impl::impactSolve()
{
  outcome = StepOutcome{};
  context.impact = true;
  try
  {
    solveImpact();
  }
  catch (const std::exception& error)
  {
    assembly.clear();
    fail(SolverStatus::NUMERICAL_FAILURE, error.what());
    storeOutcome();
  }
  context.impact = false;
}

void Simulator::Impl::solveImpact()
{
  for (const Body& body : bodies)
    if (!body.state.q.allFinite() || !body.state.v.allFinite())
      throw std::invalid_argument("body '" + body.model.name + "': its position or velocity is not finite");
  for (size_t b = 0; b < bodies.size(); ++b)
  {
    Body& body = bodies[b];
    body.middle.base_pose = body.state.base_pose;
    forwardKinematics(body.model.tree, body.state.q, body.middle);
    computeMassMatrix(body.model.tree, body.middle);
    collision.setPoses(static_cast<int>(b), body.middle);
  }
  context.points = &collision.detect(2.0 * CONTACT_GAP);
  assembly.begin(context);
  assembly.assembleRows(context);
  if (!assembly.closing())
    return;
  assembly.makeGuess(context, guess);
  assembly.assembleDynamics(context, guess);
  solve();
  if (result.status != SolverStatus::CONVERGED)
    dumpProblem(state.step == 0 ? "start" : "set_after_step_" + std::to_string(state.step));
  storeOutcome();
  if (!isMotion(result.solution))
    return;
  assembly.setMeanVelocity(result.solution);
  assembly.book(context, result.solution, state.energy);
  for (Body& body : bodies)
    body.state.v = result.solution.v.segment(body.v_offset, body.model.tree.nv);
  updateEnds();
  bookEnergies();
}

/** What is reported before the next step. */
void Simulator::Impl::restartReport()
{
  report = StepSummary{};
  report.step = state.step;
  report.time = state.time();
  report.dt = context.dt;
  bookEnergies();
}

const StepOutcome& Simulator::reset()
{
  SimulationState& state = impl_->state;
  state.bodies = impl_->start.bodies;
  state.rows = impl_->start.rows;
  state.energy = impl_->start.energy;
  state.energy_start = impl_->start.energy_start;
  state.scenario_clock = StepClock{};
  impl_->updateEnds();
  impl_->restartReport();
  impl_->outcome = impl_->start_outcome;
  return impl_->outcome;
}

void Simulator::Impl::setStart()
{
  start = state;
  start_outcome = outcome;
}

void Simulator::setStart()
{
  impl_->setStart();
}

void Simulator::resetTime()
{
  impl_->state.clock = StepClock{};
}

void Simulator::setTimeStep(double dt)
{
  if (!(dt > 0.0) || !std::isfinite(dt))
    throw std::invalid_argument("time_step is " + std::to_string(dt) +
                                ", expected a positive finite number of seconds");
  SimulationState& state = impl_->state;
  for (StepClock* clock : {&state.clock, &state.scenario_clock})
    clock->restart(clock->time(state.dt));
  state.dt = dt;
  impl_->scenario.time_step = dt;
  impl_->context = makeContext(impl_->scenario);
}

const SimulationState& Simulator::state() const
{
  return impl_->state;
}

const StepOutcome& Simulator::setState(const SimulationState& state)
{
  if (!sameShape(state, impl_->state))
    throw StateError("the state's bodies or joints differ in number from the simulator's");
  checkNumbers(*this, state);
  const double dt = impl_->state.dt;
  impl_->state = state;
  impl_->updateEnds();
  if (state.dt != dt)
    setTimeStep(dt);
  impl_->restartReport();
  impl_->outcome = StepOutcome{};
  return impl_->outcome;
}

const StepOutcome& Simulator::stateChanged()
{
  impl_->applyState();
  return impl_->outcome;
}

const StepOutcome& Simulator::outcome() const
{
  return impl_->outcome;
}

const StepSummary& Simulator::report() const
{
  return impl_->report;
}

const std::vector<ContactState>& Simulator::contacts() const
{
  return impl_->state.rows.contacts;
}

const ShapeInfo& Simulator::shape(int handle) const
{
  return impl_->collision.shape(handle);
}

int Simulator::shapeCount() const
{
  return impl_->collision.shapeCount();
}

std::uint64_t Simulator::stateHash() const
{
  return hashOf(impl_->state);
}

double Simulator::time() const
{
  return impl_->state.time();
}

const Scenario& Simulator::scenario() const
{
  return impl_->scenario;
}

const std::vector<std::string>& Simulator::warnings() const
{
  return impl_->world->warnings;
}

double Simulator::loadingSeconds() const
{
  return impl_->world->loading_seconds;
}

int Simulator::bodyCount() const
{
  return static_cast<int>(impl_->bodies.size());
}

const std::string& Simulator::bodyName(int body) const
{
  return impl_->bodies[body].model.name;
}

const MultibodyModel& Simulator::model(int body) const
{
  return impl_->bodies[body].model.tree;
}

const MultibodyData& Simulator::data(int body) const
{
  return impl_->bodies[body].end;
}

Eigen::VectorXd& Simulator::position(int body)
{
  return impl_->state.bodies[body].q;
}

const Eigen::VectorXd& Simulator::position(int body) const
{
  return impl_->state.bodies[body].q;
}

Eigen::VectorXd& Simulator::velocity(int body)
{
  return impl_->state.bodies[body].v;
}

const Eigen::VectorXd& Simulator::velocity(int body) const
{
  return impl_->state.bodies[body].v;
}

double Simulator::effort(int body, int joint) const
{
  return impl_->state.bodies[body].drives[joint].effort;
}

void Simulator::setCommand(int body, int joint, const JointCommand& command)
{
  JointDrive& drive = impl_->state.bodies[body].drives[joint];
  const double effort = drive.effort;
  drive = makeDrive(impl_->bodies[body].model, joint, command);
  drive.effort = effort;
}

const JointCommand& Simulator::command(int body, int joint) const
{
  return impl_->state.bodies[body].drives[joint].command;
}

void Simulator::addWrench(int body, const ExternalWrench& wrench)
{
  const BodyModel& model = impl_->bodies[body].model;
  const int frame = model.tree.findFrame(wrench.link);
  if (frame < 0)
    throw std::invalid_argument("body '" + model.name + "' has no link '" + wrench.link + "'");
  if (!wrench.force.allFinite() || !wrench.torque.allFinite() || !wrench.point.allFinite() || std::isnan(wrench.from) ||
      std::isnan(wrench.until))
    throw std::invalid_argument("wrench on link '" + wrench.link + "' has a number that is not finite");
  impl_->state.bodies[body].wrenches.push_back(wrench);
  impl_->state.bodies[body].wrenches.back().frame = frame;
}

void Simulator::clearWrenches()
{
  for (BodyState& body : impl_->state.bodies)
    body.wrenches.clear();
}

void Simulator::setSolver(const std::string& name)
{
  std::unique_ptr<Solver> solver = createSolver(name);
  solver->setStopping(impl_->scenario.stopping);
  impl_->solver = std::move(solver);
  impl_->scenario.solver = name;
}

void Simulator::setFailurePolicy(FailurePolicy policy)
{
  impl_->policy = policy;
}

void Simulator::setDumpFolder(const std::string& folder, int most)
{
  impl_->dump_folder = folder;
  impl_->dump_name.clear();
  impl_->dumps_left = most;
  if (impl_->state.step == 0 && !impl_->outcome.converged())
  {
    impl_->dumpProblem("start");  // of the start, from before anybody could say where to
    impl_->start_outcome.fclib_file = impl_->outcome.fclib_file;
  }
}

const IncrementalProblem& Simulator::problem() const
{
  return impl_->assembly.problem();
}

const Solution& Simulator::solution() const
{
  return impl_->result.solution;
}

}  // namespace frictional_contact_sim
