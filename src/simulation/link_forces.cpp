#include "frictional_contact_sim/simulation/link_forces.h"

#include "frictional_contact_sim/dynamics/step_motion.h"
#include "frictional_contact_sim/model/inverse_dynamics.h"

namespace frictional_contact_sim
{
namespace
{
/** Middle of the last step on the scenario's clock, to the bit of the step's own. */
double middleOfStep(const SimulationState& state, double dt)
{
  StepClock clock = state.scenario_clock;
  clock.steps -= clock.steps > 0 ? 1 : 0;
  return clock.time(state.dt) + 0.5 * dt;
}
}  // namespace

LinkForces::LinkForces(const Simulator& simulator) : simulator_(simulator)
{
  bodies_.reserve(simulator.bodyCount());
  for (int body = 0; body < simulator.bodyCount(); ++body)
    bodies_.emplace_back(simulator.model(body));
}

void LinkForces::restart()
{
  ++state_;
}

bool LinkForces::hasStep() const
{
  return simulator_.report().status != SolverStatus::NOT_RUN;
}

/** Of the step; before one, what does not move is at its place. */
const MultibodyData& LinkForces::motion(int body)
{
  BodyForces& forces = bodies_[body];
  if (!hasStep())
    return simulator_.data(body);
  if (forces.motion_of != state_)
  {
    const Body& last = simulator_.workspace(body);
    computeStepMotion(last, simulator_.solution().v.segment(last.v_offset, last.model.nv), simulator_.report().dt,
                      forces.motion);
    forces.motion_of = state_;
  }
  return forces.motion;
}

/** Contact forces on the frames of a body: (force; torque about data.reference), world axes. */
template <typename Add>
void LinkForces::forEachContact(const MultibodyData& data, int body, const Add& add) const
{
  const double dt = simulator_.report().dt;
  for (const ContactState& contact : simulator_.contacts())
    for (const auto& [handle, sign] : {std::pair(contact.shape_a, 1.0), std::pair(contact.shape_b, -1.0)})
    {
      const ShapeInfo& shape = simulator_.shape(handle);
      if (shape.body != body)
        continue;
      const Eigen::Vector3d force = sign / dt * contact.impulse;
      Vector6d wrench;
      wrench << force, (contact.position - data.reference).cross(force);
      add(shape.frame, wrench);
    }
}

/** What welds and loops do to the frames of a body, the same way. */
void LinkForces::addClosureWrenches(const MultibodyData& data, int body, std::vector<Vector6d>& applied)
{
  const double dt = simulator_.report().dt;
  for (const std::vector<Closure>* closures : {&simulator_.welds(), &simulator_.loops()})
    for (const Closure& closure : *closures)
    {
      if (closure.body_a != body && closure.body_b != body)
        continue;
      const Eigen::Isometry3d anchor =
          framePose(simulator_.model(closure.body_a), motion(closure.body_a), closure.frame_a) * closure.anchor;
      Vector6d wrench = closure.worldImpulse() / dt;
      wrench.tail<3>() += (anchor.translation() - data.reference).cross(Eigen::Vector3d(wrench.head<3>()));
      if (closure.body_a == body)
        applied[static_cast<size_t>(closure.frame_a)] += wrench;
      if (closure.body_b == body)
        applied[static_cast<size_t>(closure.frame_b)] -= wrench;
    }
}

Vector6d LinkForces::contactWrench(int body, int frame)
{
  const MultibodyData& data = motion(body);
  Vector6d sum = Vector6d::Zero();
  forEachContact(data, body,
                 [&](int touched, const Vector6d& wrench)
                 {
                   if (touched == frame)
                     sum += wrench;
                 });
  return localWrench(data, framePose(simulator_.model(body), data, frame), sum);
}

Vector6d LinkForces::jointWrench(int body, int frame)
{
  BodyForces& forces = bodies_[body];
  const MultibodyModel& model = simulator_.model(body);
  const MultibodyData& data = motion(body);
  if (forces.wrenches_of != state_)
  {
    forces.applied.assign(model.frames.size(), Vector6d::Zero());
    forEachContact(data, body, [&](int touched, const Vector6d& wrench) { forces.applied[touched] += wrench; });
    addClosureWrenches(data, body, forces.applied);
    addExternalWrenches(simulator_.workspace(body), data, middleOfStep(simulator_.state(), simulator_.report().dt),
                        forces.applied);
    computeJointWrenches(model, data, simulator_.scenario().gravity, forces.applied, forces.joint_wrenches);
    forces.wrenches_of = state_;
  }
  return localWrench(data, framePose(model, data, frame), forces.joint_wrenches[frame]);
}

Eigen::Vector3d LinkForces::specificForce(int body, int frame, const Eigen::Isometry3d& placement)
{
  const MultibodyModel& model = simulator_.model(body);
  const MultibodyData& data = motion(body);
  const Eigen::Isometry3d pose = framePose(model, data, frame) * placement;
  const Eigen::Vector3d acceleration = pointAcceleration(data, model.frames[frame].link, pose.translation());
  return pose.linear().transpose() * (acceleration - simulator_.scenario().gravity);
}

}  // namespace frictional_contact_sim
