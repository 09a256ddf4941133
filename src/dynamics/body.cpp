#include "frictional_contact_sim/dynamics/body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frictional_contact_sim/dynamics/free_link.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/problem/residual_metric.h"

namespace frictional_contact_sim
{
namespace
{
/** Largest speed of a point of one link, from its velocity about the reference. */
double linkSpeed(const Body& body, size_t link, const Vector6d& velocity)
{
  const Eigen::Vector3d angular = velocity.tail<3>();
  const Eigen::Vector3d arm = body.middle.link_pose[link].translation() - body.middle.reference;
  const Eigen::Vector3d linear = velocity.head<3>() + angular.cross(arm);
  return linear.norm() + angular.norm() * body.model.sizes[link];
}
}  // namespace

Body::Body(const BodyModel& body_model, BodyState& body_state)
  : model(body_model)
  , state(body_state)
  , middle(model.tree)
  , end(model.tree)
  , q_middle(state.q)
  , v_start(Eigen::VectorXd::Zero(model.nv))
  , v_free(v_start)
  , v_middle(v_start)
  , external(v_middle)
  , bias(v_middle)
  , next_bias(v_middle)
  , change(v_middle)
  , implicit(v_middle)
  , base(model.base_motion.velocity)
  , base_turn(instantTurn(base.angular))
  , surface_turns(model.surfaces.size(), Eigen::Matrix3d::Zero())
  , work(model.solid ? model.solid->makeWork() : nullptr)
{
}

Eigen::Isometry3d basePose(const Body& body, double dt)
{
  const BaseMotion& motion = body.model.base_motion;
  Eigen::Isometry3d pose = body.state.base_pose;
  if (!motion.active)
    return pose;
  if (motion.isProgram())
    return programPose(motion, body.base_time + dt);
  pose.translation() = body.state.base_pose.translation() + dt * motion.velocity.linear;
  const double rate = motion.velocity.angular.norm();
  if (rate > 0.0)
    pose.linear() = Eigen::AngleAxisd(dt * rate, motion.velocity.angular / rate) * body.state.base_pose.linear();
  return pose;
}

void setBaseTime(Body& body, double time, double dt, bool in_step)
{
  const BaseMotion& motion = body.model.base_motion;
  body.base_time = time;
  const auto turn = [&](const Eigen::Vector3d& angular)
  { return in_step ? chordTurn(angular, dt) : instantTurn(angular); };
  for (size_t i = 0; i < body.model.surfaces.size(); ++i)
    body.surface_turns[i] = turn(body.model.surfaces[i].angular);
  if (!motion.active)
    return;
  body.base_turn = turn(motion.velocity.angular);
  if (!motion.isProgram())
    return;
  const auto mean = [&](double center)
  {
    const Eigen::Isometry3d from = programPose(motion, center - 0.5 * dt);
    const Eigen::Isometry3d to = programPose(motion, center + 0.5 * dt);
    return BaseVelocity{(to.translation() - from.translation()) / dt, rotationBetween(from.linear(), to.linear()) / dt};
  };
  // Rows speak of the next midpoint: the chord from this one to that one is what they need, exactly. (From rest to
  // rest: of the end of the step.)
  const BaseVelocity start = mean(time);
  body.base = in_step ? mean(time + (body.model.regime == Regime::DYNAMIC ? 1.0 : 0.5) * dt) : start;
  body.base_turn = turn(body.base.angular);
  body.base_rate = {(body.base.linear - start.linear) / dt, (body.base.angular - start.angular) / dt};
}

double springEnergy(const Body& body)
{
  double energy = 0.0;
  for (const JointSpring& spring : body.model.springs)
  {
    const double stretch =
        body.state.q[body.model.tree.joints[static_cast<size_t>(spring.joint)].q_index] - spring.rest;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  return energy;
}

void updateEnd(Body& body)
{
  body.end.base_pose = body.state.base_pose;
  setPoses(body.model, body.state.q, body.end);
  if (body.model.solid)
    body.model.solid->setVelocities(body.state.v, body.end);
  else
    forwardVelocities(body.model.tree, body.state.v, body.end);
  // A moving base carries all links along; `reference` is its origin.
  if (body.model.base_motion.active)
    for (Vector6d& velocity : body.end.link_velocity)
    {
      velocity.head<3>() += body.base.linear;
      velocity.tail<3>() += body.base.angular;
    }
}

void moveHalfStep(const Body& body, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double dt,
                  Eigen::VectorXd& q_middle)
{
  if (body.model.solid)
    q_middle = q + 0.5 * dt * v;
  else if (body.model.free_link)
    moveFreeLinkToMidpoint(body, q, v, dt, q_middle);
  else
    integrate(body.model.tree, q, v, 0.5 * dt, q_middle);
}

void moveToMidpoint(Body& body, double dt)
{
  // A step from rest to rest has the gaps and forces of where it starts.
  const bool is_motion = body.model.regime == Regime::DYNAMIC;
  if (is_motion)
    moveHalfStep(body, body.state.q, body.state.v, dt, body.q_middle);
  else
    body.q_middle = body.state.q;
  body.middle.base_pose = basePose(body, is_motion ? 0.5 * dt : 0.0);
  setPoses(body.model, body.q_middle, body.middle);
  if (body.model.solid)
    body.model.solid->prepare(body, dt);
  else
    computeMassMatrix(body.model.tree, body.middle);
}

void moveToImpact(Body& body)
{
  body.middle.base_pose = body.state.base_pose;
  setPoses(body.model, body.state.q, body.middle);
  body.q_middle = body.state.q;
  if (body.model.solid)
    body.model.solid->prepare(body, 0.0);
  else
    computeMassMatrix(body.model.tree, body.middle);
}

void setPoses(const BodyModel& model, const Eigen::VectorXd& q, MultibodyData& data)
{
  if (model.solid)
    model.solid->setPoses(q, data);
  else
    forwardKinematics(model.tree, q, data);
}

void setLinkPoses(const BodyModel& model, const Eigen::VectorXd& q, MultibodyData& data)
{
  if (model.solid)
    model.solid->setPoses(q, data);
  else
    computeLinkPoses(model.tree, q, data);
}

bool factorizeMass(Body& body)
{
  return body.model.solid ? body.model.solid->factorize(body)
                          : factorizeMassMatrix(body.model.tree, body.implicit, body.middle);
}

void solveMass(const Body& body, Eigen::VectorXd& v)
{
  if (body.model.solid)
    body.model.solid->solve(body, v);
  else
    solveMassMatrix(body.model.tree, body.middle, v);
}

void addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns)
{
  if (body.model.solid)
  {
    body.model.solid->addPointColumns(body, point, sign, columns);
    return;
  }
  const MultibodyData& data = body.middle;
  const Eigen::Vector3d arm = point.position - data.reference;
  const std::vector<int>& chain = body.model.chains[point.link];
  size_t next = columns.size();
  columns.resize(next + chain.size());
  for (const int j : chain)
  {
    const auto motion = data.motion_subspace.col(j);
    const Eigen::Vector3d angular = motion.tail<3>();
    columns[next].first = j;
    columns[next++].second = sign * (motion.head<3>() + angular.cross(arm));
  }
}

double kineticEnergy(const Body& body)
{
  return body.model.solid ? body.model.solid->kineticEnergy(body)
                          : kineticEnergy(body.model.tree, body.end, body.state.v);
}

double potentialEnergy(const Body& body, const Eigen::Vector3d& gravity)
{
  return body.model.solid ? body.model.solid->potentialEnergy(body, gravity)
                          : potentialEnergy(body.model.tree, body.end, gravity) + springEnergy(body);
}

void setStartVelocity(Body& body, bool impact)
{
  if (body.model.regime != Regime::DYNAMIC)
    body.v_start.setZero();
  else if (body.model.free_link && !impact)
    mapFreeLinkStart(body);
  else
    body.v_start = body.state.v;
}

void moveStep(const Body& body, const VectorIn& v, double dt, Eigen::VectorXd& q_end, Eigen::VectorXd& v_end)
{
  if (body.model.free_link)
  {
    moveFreeLinkToEnd(body, v, dt, q_end, v_end);
    return;
  }
  const bool is_motion = body.model.regime == Regime::DYNAMIC;
  if (is_motion)
    v_end = 0.5 * (body.v_start + v);
  else
    v_end = v;
  if (body.model.solid)
    q_end = body.state.q + dt * v_end;
  else
    integrate(body.model.tree, body.state.q, v_end, dt, q_end);
  if (is_motion)
    v_end = v;
  else
    v_end.setZero();
}

void moveToEnd(Body& body, const VectorIn& v, double dt)
{
  moveStep(body, v, dt, body.state.q, body.state.v);
  body.state.base_pose = basePose(body, dt);
  if (body.model.solid)
    body.model.solid->recentre(body.state);
  updateEnd(body);
}

void computeBias(Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity, Eigen::VectorXd& bias)
{
  if (body.model.regime != Regime::DYNAMIC && !v.isZero(0.0))
  {
    // v is a displacement over dt there: it has no centrifugal forces.
    computeBias(body, Eigen::VectorXd::Zero(v.size()), gravity, bias);
    return;
  }
  if (body.model.solid)
    body.model.solid->computeBias(body, v, gravity, bias);
  else if (body.model.free_link)
    computeFreeLinkBias(body, v, gravity, bias);
  else
    computeBiasForces(body.model.tree, v, gravity, body.middle, bias);
}

double pointSpeed(Body& body, const Eigen::VectorXd& v)
{
  if (body.model.solid)
    return body.model.solid->pointSpeed(body, v);
  forwardVelocities(body.model.tree, v, body.middle);
  double speed = 0.0;
  for (size_t link = 0; link < body.middle.link_velocity.size(); ++link)
    speed = std::max(speed, linkSpeed(body, link, body.middle.link_velocity[link]));
  return speed;
}

void setSpeeds(Body& body)
{
  if (body.model.solid)
  {
    const DynamicBody& solid = *body.model.solid;
    body.change = body.v_free - body.v_start;
    body.speed = std::max(solid.pointSpeed(body, body.v_start), solid.pointSpeed(body, body.v_free));
    body.speed_change = std::max(VELOCITY_FLOOR, solid.pointSpeed(body, body.change));
    return;
  }
  MultibodyData& data = body.middle;
  if (body.model.free_link)
    forwardVelocities(body.model.tree, body.v_start, data);  // its bias needs none
  std::swap(data.link_velocity, data.link_force);  // those at v_start, where the recursion has its scratch
  body.change = body.v_free - body.v_start;
  forwardVelocities(body.model.tree, body.change, data);
  body.speed = 0.0;
  body.speed_change = VELOCITY_FLOOR;
  for (size_t link = 0; link < data.link_velocity.size(); ++link)
  {
    const Vector6d& start = data.link_force[link];
    const Vector6d& change = data.link_velocity[link];
    body.speed = std::max({body.speed, linkSpeed(body, link, start), linkSpeed(body, link, start + change)});
    body.speed_change = std::max(body.speed_change, linkSpeed(body, link, change));
  }
}

void applyWrenches(Body& body, double now)
{
  body.external.setZero();
  if (body.model.solid)
  {
    body.model.solid->applyWrenches(body, now);
    return;
  }
  for (const ExternalWrench& wrench : body.state.wrenches)
  {
    if (now < wrench.from || now >= wrench.until)
      continue;
    const Frame& frame = body.model.tree.frames[wrench.frame];
    const Eigen::Isometry3d pose = body.middle.link_pose[frame.link] * frame.placement;
    const Eigen::Matrix3d axes = wrench.world_frame ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : pose.linear();
    addWrench(body.model.tree, body.middle, frame.link, pose * wrench.point, axes * wrench.force, axes * wrench.torque,
              body.external);
  }
}

std::string wrenchRefusal(const BodyModel& model, const ExternalWrench& wrench)
{
  if (!wrench.force.allFinite() || !wrench.torque.allFinite() || !wrench.point.allFinite() || std::isnan(wrench.from) ||
      std::isnan(wrench.until))
    return "found a number that is not finite, expected finite ones";
  return model.solid ? model.solid->wrenchRefusal(wrench) : "";
}

void removeExpiredWrenches(Body& body, double now)
{
  std::vector<ExternalWrench>& wrenches = body.state.wrenches;
  wrenches.erase(std::remove_if(wrenches.begin(), wrenches.end(),
                                [now](const ExternalWrench& wrench) { return now >= wrench.until; }),
                 wrenches.end());
}

}  // namespace frictional_contact_sim
