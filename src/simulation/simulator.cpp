#include "frictional_contact_sim/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/dynamics/row_sources.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/solver/registry.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
StepContext makeContext(const Scenario& scenario)
{
  StepContext context;
  context.balance =
      scenario.regime == Regime::STATIC &&
      std::none_of(scenario.bodies.begin(), scenario.bodies.end(), [](const BodySpec& body) { return body.elastic; });
  context.dt = scenario.time_step;
  context.gravity = scenario.gravity;
  context.regime = scenario.regime;
  context.tolerance = scenario.stopping.tolerance;
  context.normal_law.form = scenario.contact_law;
  // An approach slower than what gravity gives in one step is rest, not an impact.
  context.normal_law.closing_speed = std::max(1e-9, scenario.gravity.norm() * scenario.time_step);
  return context;
}

namespace
{
SimulationState makeState(const WorldModel& world)
{
  SimulationState state;
  state.dt = world.scenario.time_step;
  state.bodies = world.start;
  state.rows.loops = world.loops;
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

std::shared_ptr<StepSolver> makeSolver(const Scenario& scenario)
{
  return std::make_shared<StepSolver>(createSolver(scenario.solver, scenario.solver_options), scenario.stopping,
                                      scenario.failure);
}
}  // namespace

Simulator::Impl::Impl(std::shared_ptr<const WorldModel> world_model, std::shared_ptr<StepSolver> step_solver)
  : world(std::move(world_model))
  , scenario(world->scenario)
  , pairs(world->pairs)
  , collision(world->collision)
  , state(makeState(*world))
  , bodies(makeBodies(*world, state))
  , context(makeContext(scenario))
  , contact_set(bodies, collision, pairs, state.rows.contacts)
  , assembly(bodies, makeRowSources(bodies, collision, pairs, state.rows, &contact_set), state.rows)
  , solver_owner(std::move(step_solver))
  , solver(*solver_owner)
{
}

Simulator::Impl::Impl(std::shared_ptr<const WorldModel> world_model)
  : Impl(world_model, makeSolver(world_model->scenario))
{
  rememberGood();
  updateEnds();
  restartLedger();  // what a start whose impact fails goes back to
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

void Simulator::Impl::updateEnds()
{
  for (Body& body : bodies)
  {
    setBaseTime(body, state.scenario_clock.time(state.dt), state.dt, false);
    updateEnd(body);
  }
}

void Simulator::Impl::rememberGood()
{
  good.resize(state.bodies.size());
  for (size_t b = 0; b < good.size(); ++b)
  {
    good[b].first = state.bodies[b].q;
    good[b].second = state.bodies[b].v;
  }
}

void Simulator::Impl::bookEnergies()
{
  state.energy.kinetic = 0.0;
  state.energy.potential = 0.0;
  for (const Body& body : bodies)
  {
    if (body.model.nv == 0)
      continue;
    state.energy.kinetic += kineticEnergy(body);
    state.energy.potential += potentialEnergy(body, context.gravity);
  }
  report.energy = state.energy;
}

void Simulator::Impl::restartLedger()
{
  state.energy = EnergyLedger{};
  bookEnergies();
  state.energy_start = state.energy.kinetic + state.energy.potential;
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
  state.wedged = impl_->start.wedged;
  state.scenario_clock = StepClock{};
  impl_->joinWelded();
  impl_->updateEnds();
  impl_->rememberGood();
  impl_->restartReport();
  impl_->moveLedgerZero(impl_->start.energy.potential);
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

void Simulator::setStartCommands(int body)
{
  impl_->start.bodies[body].drives = impl_->state.bodies[body].drives;
}

void Simulator::resetTime()
{
  impl_->state.clock = StepClock{};
}

const SimulationState& Simulator::state() const
{
  return impl_->state;
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

const Body& Simulator::workspace(int body) const
{
  return impl_->bodies[body];
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

void Simulator::addWrench(int body, const ExternalWrench& wrench)
{
  const BodyModel& model = impl_->bodies[body].model;
  const int frame = model.tree.findFrame(wrench.link);
  if (frame < 0)
    throw std::invalid_argument("body '" + model.name + "' has no link '" + wrench.link + "'");
  if (const std::string reason = wrenchRefusal(model, wrench); !reason.empty())
    throw std::invalid_argument("wrench on link '" + wrench.link + "' of body '" + model.name + "': " + reason);
  impl_->state.bodies[body].wrenches.push_back(wrench);
  impl_->state.bodies[body].wrenches.back().frame = frame;
}

void Simulator::replaceWrench(int body, const ExternalWrench& wrench)
{
  addWrench(body, wrench);
  std::vector<ExternalWrench>& wrenches = impl_->state.bodies[body].wrenches;
  ExternalWrench added = wrenches.back();
  added.is_replaceable = true;
  wrenches.pop_back();
  const auto old = std::find_if(wrenches.begin(), wrenches.end(),
                                [&added](const ExternalWrench& other)
                                { return other.is_replaceable && other.frame == added.frame; });
  const bool is_zero = added.force.isZero(0.0) && added.torque.isZero(0.0);
  if (old == wrenches.end() && !is_zero)
    wrenches.push_back(added);
  else if (old != wrenches.end() && is_zero)
    wrenches.erase(old);
  else if (old != wrenches.end())
    *old = added;
}

void Simulator::clearWrenches()
{
  for (int body = 0; body < bodyCount(); ++body)
    clearWrenches(body);
}

void Simulator::clearWrenches(int body, int frame)
{
  std::vector<ExternalWrench>& wrenches = impl_->state.bodies[body].wrenches;
  wrenches.erase(std::remove_if(wrenches.begin(), wrenches.end(),
                                [frame](const ExternalWrench& wrench) { return frame < 0 || wrench.frame == frame; }),
                 wrenches.end());
}

void Simulator::setFailurePolicy(FailurePolicy policy)
{
  FailureOptions options = impl_->scenario.failure;
  options.policy = policy;
  setFailureOptions(options);
}

void Simulator::setFailureOptions(const FailureOptions& options)
{
  impl_->scenario.failure = options;
  impl_->solver.setOptions(options);
}

FailurePolicy Simulator::failurePolicy() const
{
  return impl_->scenario.failure.policy;
}

void Simulator::setStop(const std::atomic<bool>* stop)
{
  impl_->scenario.stopping.stop = stop;
  impl_->solver.setStop(stop);
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

bool Simulator::isProblemSolved() const
{
  return impl_->is_solved;
}

const Solution& Simulator::solution() const
{
  return impl_->result.solution;
}

}  // namespace frictional_contact_sim
