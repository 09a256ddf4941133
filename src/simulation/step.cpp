// One time step, in the order of DESIGN.md.
#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/energy.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double MINIMUM_MARGIN = 1e-3;  ///< contacts nearer than this are always in the problem [m]
constexpr double BOUNDED_FRACTION = 0.9;  ///< of its effort limit: from here on a servo is solved as a bounded row
constexpr double RUNAWAY_SPEED = 1e9;  ///< faster than light [m/s] or [rad/s]: not a motion, a failed step
constexpr int CREEP_ITERATIONS = 40;  ///< Newton iterations of the creep law in a step; two are usual
constexpr double EFFORT_TOLERANCE = 1e-9;  ///< relative overshoot of an effort limit that is round-off
}  // namespace

const StepSummary& Simulator::step()
{
  Impl& sim = *impl_;
  sim.moveToMidpoint();
  const std::vector<ContactPoint>& points = sim.world.collision.detect(sim.lookAhead());
  sim.prepareActuators();
  sim.solveStep(points);
  sim.advance();
  sim.finishStep(points);
  return sim.report;
}

void Simulator::Impl::moveToMidpoint()
{
  const double half = 0.5 * settings.dt;
  for (size_t r = 0; r < world.robots.size(); ++r)
  {
    Robot& robot = world.robots[r];
    integrate(robot.model, robot.q, robot.v, half, robot.q_middle);
    placeBase(robot, half);
    forwardKinematics(robot.model, robot.q_middle, robot.middle);
    computeMassMatrix(robot.model, robot.middle);
    world.collision.setPoses(static_cast<int>(r), robot.middle);
    robot.external.setZero();
    for (size_t k = 0; k < robot.wrenches.size(); ++k)
    {
      const ExternalWrench& wrench = robot.wrenches[k];
      const double middle = time + half;
      if (middle < wrench.from || middle >= wrench.until)
        continue;
      const Frame& frame = robot.model.frames[robot.wrench_frames[k]];
      const Eigen::Isometry3d pose = robot.middle.body_pose[frame.body] * frame.placement;
      const Eigen::Matrix3d axes = wrench.world_frame ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : pose.linear();
      frictional_contact_sim::addWrench(robot.model, robot.middle, frame.body, pose * wrench.point, axes * wrench.force,
                                        axes * wrench.torque, robot.external);
    }
  }
}

/** Farther than any point can travel in two steps at the present velocities. */
double Simulator::Impl::lookAhead() const
{
  double fastest = 0.0;
  for (const Robot& robot : world.robots)
    for (size_t body = 0; body < robot.model.bodies.size(); ++body)
    {
      if (robot.chains[body].empty() && !robot.base_motion.active)
        continue;
      const Vector6d velocity =
          pointVelocity(robot.end, static_cast<int>(body), robot.end.body_pose[body].translation());
      fastest = std::max(fastest, velocity.head<3>().norm() + velocity.tail<3>().norm() * robot.extents[body]);
    }
  return MINIMUM_MARGIN + 2.0 * settings.dt * fastest;
}

void Simulator::Impl::prepareActuators()
{
  for (Robot& robot : world.robots)
    for (size_t j = 0; j < robot.actuators.size(); ++j)
    {
      if (!robot.isActuated(static_cast<int>(j)))
        continue;
      Actuator& actuator = robot.actuators[j];
      const Joint& joint = robot.model.joints[j];
      actuator.impulse = servoImpulse(actuator.command, robot.q[joint.q_index], robot.v[joint.v_index], settings.dt);
      actuator.bounded = actuator.impulse.stiffness > 0.0 && std::isfinite(actuator.effort_limit) &&
                         std::abs(actuator.effort) >= BOUNDED_FRACTION * actuator.effort_limit;
    }
}

void Simulator::Impl::solveStep(const std::vector<ContactPoint>& points)
{
  // A servo found beyond its limit becomes a bounded row and the step is solved again; flags are only ever raised, so
  // this ends, and a servo that works near its limit is a bounded row from the start.
  // Contacts with the creep law are solved on their tangents, again until these are right.
  if (assembly.hasCreep())
    guessCreep(points);
  int creep_iterations = 0;
  bool servos = false;
  bool creep = false;
  do
  {
    assembly.assembleRows(points, settings);
    makeGuess(points);
    assembly.assembleDynamics(guess, settings);
    if (creep && result.solution.r.size() == guess.r.size())
      guess.r = result.solution.r;
    solve();
    servos = boundOverloadedServos();
    creep = !servos && assembly.hasCreep() && !step_failed &&
            assembly.updateCreep(result.solution, scenario.stopping.tolerance);
  } while (servos || (creep && ++creep_iterations < CREEP_ITERATIONS));
  if (!creep)
    return;
  result.status = SolverStatus::MAX_ITERATIONS;
  result.message = "the creep law was not met on its tangents";
  step_failed = true;
}

const ContactState* Simulator::Impl::lastContact(std::uint64_t id) const
{
  const auto entry = std::lower_bound(contact_index.begin(), contact_index.end(), std::make_pair(id, 0));
  if (entry == contact_index.end() || entry->first != id)
    return nullptr;
  const ContactState& last = contacts[entry->second];
  return last.mode == ContactMode::IMPACT ? nullptr : &last;
}

void Simulator::Impl::guessCreep(const std::vector<ContactPoint>& points)
{
  assembly.startCreep(points.size());
  for (size_t i = 0; i < points.size(); ++i)
    if (const ContactState* last = lastContact(points[i].id))
      assembly.setCreepNormal(static_cast<int>(i), std::max(0.0, points[i].normal.dot(last->impulse)));
}

bool Simulator::Impl::isMotion(const Solution& solution)
{
  return solution.r.allFinite() && solution.v.allFinite() &&
         (solution.v.size() == 0 || solution.v.cwiseAbs().maxCoeff() < RUNAWAY_SPEED);
}

void Simulator::Impl::solve()
{
  // A state that has run away (after accepted failures) overflows here; it must not reach the solver as a NaN.
  if (assembly.problem().f.allFinite() && assembly.problem().w.allFinite())
    solver->solve(assembly.problem(), &guess, result);
  else
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.residual = 1.0;
    result.solution.v.setConstant(assembly.problem().velocities(), std::numeric_limits<double>::quiet_NaN());
    result.solution.u.setZero(assembly.problem().rows());
    result.solution.r.setZero(assembly.problem().rows());
    result.solution.lambda.setZero(assembly.problem().bilaterals());
  }
  if (!isMotion(result.solution))
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.residual = 1.0;
  }
  step_failed = result.status != SolverStatus::CONVERGED;
}

/** Last impulses of contacts and joint rows that persist; those of impacts are not repeated. */
void Simulator::Impl::makeGuess(const std::vector<ContactPoint>& points)
{
  const IncrementalProblem& problem = assembly.problem();
  guess.r.setZero(problem.rows());
  guess.u.setZero(problem.rows());
  guess.v.setZero(problem.H.cols());
  for (const Robot& robot : world.robots)
    guess.v.segment(robot.v_offset, robot.model.nv) = robot.v;
  if (guess.lambda.size() != problem.bilaterals())
    guess.lambda.setZero(problem.bilaterals());
  for (const ContactRow& row : assembly.contactRows())
  {
    const ContactPoint& point = points[row.point];
    const ContactState* last = lastContact(point.id);
    if (last == nullptr || row.closing)
      continue;
    guess.r[row.row] = point.normal.dot(last->impulse);
    guess.r[row.row + 1] = row.tangent_1.dot(last->impulse);
    guess.r[row.row + 2] = row.tangent_2.dot(last->impulse);
  }
  for (const JointRow& row : assembly.jointRows())
    guess.r[row.row] = joint_impulses[row.robot][row.joint][static_cast<int>(row.kind)];
}

bool Simulator::Impl::boundOverloadedServos()
{
  bool found = false;
  if (!isMotion(result.solution))
    return found;
  for (Robot& robot : world.robots)
    for (size_t j = 0; j < robot.actuators.size(); ++j)
    {
      Actuator& actuator = robot.actuators[j];
      if (actuator.bounded || actuator.impulse.stiffness == 0.0 || !robot.isActuated(static_cast<int>(j)))
        continue;
      const double velocity = result.solution.v[robot.v_offset + robot.velocityIndex(static_cast<int>(j))];
      const double effort = (actuator.impulse.offset - actuator.impulse.stiffness * velocity) / settings.dt;
      if (std::abs(effort) > actuator.effort_limit * (1.0 + EFFORT_TOLERANCE))
      {
        actuator.bounded = true;
        found = true;
      }
    }
  return found;
}

void Simulator::Impl::advance()
{
  const bool held = step_failed && handleFailure();
  for (Robot& robot : world.robots)
    robot.v_middle = 0.5 * (robot.v + result.solution.v.segment(robot.v_offset, robot.model.nv));
  if (!held)
    bookWork(assembly, world.robots, result.solution, settings.dt, false, report.energy);
  for (Robot& robot : world.robots)
  {
    robot.v = result.solution.v.segment(robot.v_offset, robot.model.nv);
    integrate(robot.model, robot.q, robot.v_middle, settings.dt, robot.q);
    if (robot.base_motion.active)
    {
      placeBase(robot, settings.dt);
      robot.base_pose = robot.model.joints.front().placement;
    }
    updateEnd(robot);
    for (size_t j = 0; j < robot.actuators.size(); ++j)
    {
      Actuator& actuator = robot.actuators[j];
      if (!actuator.bounded && robot.isActuated(static_cast<int>(j)))
        actuator.effort =
            (actuator.impulse.offset - actuator.impulse.stiffness * robot.v[robot.velocityIndex(static_cast<int>(j))]) /
            settings.dt;
    }
  }
  for (const JointRow& row : assembly.jointRows())
    if (row.kind == JointRow::Kind::BOUNDED_SERVO)
      world.robots[row.robot].actuators[row.joint].effort = result.solution.r[row.row] / settings.dt;
  time += settings.dt;
}

/** A step without a converged answer: keep the best iterate, or, where it is not finite or the policy says so, stand.
 */
bool Simulator::Impl::handleFailure()
{
  if (!dump_folder.empty())
    dumpProblem();
  if (isMotion(result.solution) && policy != FailurePolicy::HOLD)
    return false;
  result.solution.v.setZero(assembly.problem().velocities());
  result.solution.u.setZero(assembly.problem().rows());
  result.solution.r.setZero(assembly.problem().rows());
  result.solution.lambda.setZero(assembly.problem().bilaterals());
  result.law_errors.setZero();  // of standing still
  for (Robot& robot : world.robots)
    robot.v.setZero();
  return true;
}

}  // namespace frictional_contact_sim
