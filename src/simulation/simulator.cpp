#include "frictional_contact_sim/simulation/simulator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/energy.h"
#include "frictional_contact_sim/solver/registry.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
StepSettings makeSettings(const Scenario& scenario)
{
  StepSettings settings;
  settings.dt = scenario.time_step;
  settings.gravity = scenario.gravity;
  settings.normal_law.form = scenario.contact_law;
  // An approach slower than what gravity gives in one step is rest, not an impact.
  settings.normal_law.closing_speed = std::max(1e-9, scenario.gravity.norm() * scenario.time_step);
  return settings;
}

void checkScenario(const Scenario& scenario)
{
  if (!(scenario.time_step > 0.0) || !std::isfinite(scenario.time_step))
    throw std::invalid_argument("time_step is " + std::to_string(scenario.time_step) +
                                ", expected a positive finite number of seconds");
  if (!scenario.gravity.allFinite())
    throw std::invalid_argument("gravity has a component that is not finite");
  scenario.stopping.validate();
}
}  // namespace

Simulator::Impl::Impl(const Scenario& description)
  : scenario((checkScenario(description), description))
  , world(loadWorld(scenario))
  , settings(makeSettings(scenario))
  , assembly(world.robots, world.collision, world.pairs)
  , solver(createSolver(scenario.solver))
  , island_of(world.robots.size())
{
  solver->setStopping(scenario.stopping);
  for (const Robot& robot : world.robots)
  {
    q_initial.push_back(robot.q);
    v_initial.push_back(robot.v);
    base_initial.push_back(robot.base_pose);
    joint_impulses.emplace_back(robot.model.joints.size(), std::array<double, 4>{});
  }
  applyState();
}

Simulator::Simulator(const Scenario& scenario)
{
  const auto start = std::chrono::steady_clock::now();
  impl_ = std::make_unique<Impl>(scenario);
  impl_->loading_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Simulator::~Simulator() = default;

/** The state as it stands in q and v becomes the state: impact solve, warm starts dropped, ledger anew. */
void Simulator::Impl::applyState()
{
  contacts.clear();
  contact_index.clear();
  guess.lambda.resize(0);
  for (std::vector<std::array<double, 4>>& robot : joint_impulses)
    for (std::array<double, 4>& joint : robot)
      joint.fill(0.0);
  for (Robot& robot : world.robots)
  {
    for (Actuator& actuator : robot.actuators)
      actuator.effort = 0.0;
    updateEnd(robot);
  }
  restartLedger();
  impactSolve();
}

void Simulator::Impl::restartLedger()
{
  report.energy = EnergyLedger{};
  bookEnergies(world.robots, settings.gravity, report.energy);
  energy_start = report.energy.kinetic + report.energy.potential;
}

void Simulator::Impl::impactSolve()
{
  for (size_t r = 0; r < world.robots.size(); ++r)
  {
    Robot& robot = world.robots[r];
    forwardKinematics(robot.model, robot.q, robot.middle);
    computeMassMatrix(robot.model, robot.middle);
    world.collision.setPoses(static_cast<int>(r), robot.middle);
  }
  const std::vector<ContactPoint>& points = world.collision.detect(2.0 * CONTACT_GAP);
  assembly.assembleImpact(points);
  const bool closing = std::any_of(assembly.contactRows().begin(), assembly.contactRows().end(),
                                   [](const ContactRow& row) { return row.closing; }) ||
                       std::any_of(assembly.jointRows().begin(), assembly.jointRows().end(),
                                   [this](const JointRow& row)
                                   {
                                     const Robot& robot = world.robots[row.robot];
                                     const double velocity = robot.v[robot.velocityIndex(row.joint)];
                                     return row.kind == JointRow::Kind::LOWER_LIMIT ? velocity < 0.0 : velocity > 0.0;
                                   });
  if (!closing)
    return;
  makeGuess(points);
  guess.r.setZero();
  solve();
  if (!isMotion(result.solution))
    return;
  for (Robot& robot : world.robots)
    robot.v_middle = 0.5 * (robot.v + result.solution.v.segment(robot.v_offset, robot.model.nv));
  bookWork(assembly, world.robots, result.solution, settings.dt, true, report.energy);
  for (Robot& robot : world.robots)
  {
    robot.v = result.solution.v.segment(robot.v_offset, robot.model.nv);
    updateEnd(robot);
  }
  bookEnergies(world.robots, settings.gravity, report.energy);
}

void Simulator::reset()
{
  for (size_t r = 0; r < impl_->world.robots.size(); ++r)
  {
    Robot& robot = impl_->world.robots[r];
    robot.q = impl_->q_initial[r];
    robot.v = impl_->v_initial[r];
    robot.base_pose = impl_->base_initial[r];
    robot.model.joints.front().placement = robot.base_pose;
  }
  impl_->applyState();
}

void Simulator::resetTime()
{
  impl_->time = 0.0;
}

void Simulator::stateChanged()
{
  impl_->applyState();
}

const StepSummary& Simulator::report() const
{
  return impl_->report;
}

const std::vector<ContactState>& Simulator::contacts() const
{
  return impl_->contacts;
}

const ShapeInfo& Simulator::shape(int handle) const
{
  return impl_->world.collision.shape(handle);
}

double Simulator::time() const
{
  return impl_->time;
}

const Scenario& Simulator::scenario() const
{
  return impl_->scenario;
}

const std::vector<std::string>& Simulator::warnings() const
{
  return impl_->world.warnings;
}

double Simulator::loadingSeconds() const
{
  return impl_->loading_seconds;
}

int Simulator::bodyCount() const
{
  return static_cast<int>(impl_->world.robots.size());
}

const std::string& Simulator::bodyName(int body) const
{
  return impl_->world.robots[body].name;
}

const MultibodyModel& Simulator::model(int body) const
{
  return impl_->world.robots[body].model;
}

const MultibodyData& Simulator::data(int body) const
{
  return impl_->world.robots[body].end;
}

Eigen::VectorXd& Simulator::position(int body)
{
  return impl_->world.robots[body].q;
}

const Eigen::VectorXd& Simulator::position(int body) const
{
  return impl_->world.robots[body].q;
}

Eigen::VectorXd& Simulator::velocity(int body)
{
  return impl_->world.robots[body].v;
}

const Eigen::VectorXd& Simulator::velocity(int body) const
{
  return impl_->world.robots[body].v;
}

double Simulator::effort(int body, int joint) const
{
  return impl_->world.robots[body].actuators[joint].effort;
}

void Simulator::setCommand(int body, int joint, const JointCommand& command)
{
  Robot& robot = impl_->world.robots[body];
  const double effort = robot.actuators[joint].effort;
  robot.actuators[joint] = makeActuator(robot, joint, command);
  robot.actuators[joint].effort = effort;
}

const JointCommand& Simulator::command(int body, int joint) const
{
  return impl_->world.robots[body].actuators[joint].command;
}

void Simulator::addWrench(int body, const ExternalWrench& wrench)
{
  Robot& robot = impl_->world.robots[body];
  const int frame = robot.model.findFrame(wrench.link);
  if (frame < 0)
    throw std::invalid_argument("body '" + robot.name + "' has no link '" + wrench.link + "'");
  if (!wrench.force.allFinite() || !wrench.torque.allFinite() || !wrench.point.allFinite())
    throw std::invalid_argument("wrench on link '" + wrench.link + "' has a component that is not finite");
  robot.wrenches.push_back(wrench);
  robot.wrench_frames.push_back(frame);
}

void Simulator::clearWrenches()
{
  for (Robot& robot : impl_->world.robots)
  {
    robot.wrenches.clear();
    robot.wrench_frames.clear();
  }
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

void Simulator::setDumpFolder(const std::string& folder)
{
  impl_->dump_folder = folder;
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
