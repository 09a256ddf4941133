// Mass matrix and momentum of the incremental problem.
#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"

namespace frictional_contact_sim
{
namespace
{
/** Servo offsets, servo stiffness and joint damping of one robot: dt tau = offset - implicit v. */
void collectActuation(Robot& robot, double dt, VectorOut momentum)
{
  robot.implicit = dt * robot.damping;
  for (size_t j = 0; j < robot.actuators.size(); ++j)
  {
    const Actuator& actuator = robot.actuators[j];
    if (actuator.bounded || !robot.isActuated(static_cast<int>(j)))
      continue;
    const int index = robot.velocityIndex(static_cast<int>(j));
    robot.implicit[index] += actuator.impulse.stiffness;
    momentum[index] += actuator.impulse.offset;
  }
}
}  // namespace

void StepAssembly::assembleMass(bool with_implicit)
{
  rows_m_.clear();
  for (const Robot& robot : robots_)
    for (int i = 0; i < robot.model.nv; ++i)
    {
      for (const int column : mass_columns_[robot.v_offset + i])
      {
        const int j = column - robot.v_offset;
        rows_m_.push(column, robot.middle.mass_matrix(i, j) + (with_implicit && i == j ? robot.implicit[i] : 0.0));
      }
      rows_m_.endRow();
    }
  for (int k = 0; k < auxiliaries_; ++k)
  {
    rows_m_.push(velocities_ + k, auxiliary_mass_[k]);
    rows_m_.endRow();
  }
  rows_m_.copyTo(velocities_ + auxiliaries_, problem_.M);
}

void StepAssembly::assembleDynamics(const Solution& guess, const StepSettings& settings)
{
  const double dt = settings.dt;
  const int size = velocities_ + auxiliaries_;
  impulse_.setZero(size);
  if (problem_.rows() > 0)
    impulse_.noalias() += problem_.H.transpose() * guess.r;
  if (problem_.bilaterals() > 0)
    impulse_.noalias() += problem_.G.transpose() * guess.lambda;
  problem_.f.setZero(size);
  scratch_.resize(size);
  for (Robot& robot : robots_)
  {
    const int nv = robot.model.nv;
    if (nv == 0)
      continue;
    auto momentum = scratch_.segment(robot.v_offset, nv);  // M v_k + dt applied + c, without bias
    momentum.noalias() = robot.middle.mass_matrix * robot.v;
    momentum += dt * robot.external;
    collectActuation(robot, dt, momentum);

    computeBiasForces(robot.model, robot.v, settings.gravity, robot.middle, robot.bias);
    factorizeMassMatrix(robot.model, robot.implicit, robot.middle);
    robot.v_middle = momentum - dt * robot.bias + impulse_.segment(robot.v_offset, nv);
    solveMassMatrix(robot.model, robot.middle, robot.v_middle);
    robot.v_middle = 0.5 * (robot.v_middle + robot.v);
    computeBiasForces(robot.model, robot.v_middle, settings.gravity, robot.middle, robot.bias);
    problem_.f.segment(robot.v_offset, nv) = dt * robot.bias - momentum;
  }
  assembleMass(true);
}

void StepAssembly::assembleImpact(const std::vector<ContactPoint>& points)
{
  beginRows();
  for (size_t i = 0; i < points.size(); ++i)
    addContact(points[i], static_cast<int>(i), nullptr);
  for (size_t r = 0; r < robots_.size(); ++r)
    for (size_t j = 0; j < robots_[r].model.joints.size(); ++j)
    {
      const Joint& joint = robots_[r].model.joints[j];
      if (velocitySize(joint.type) != 1)
        continue;
      addLimits(static_cast<int>(r), static_cast<int>(j), nullptr);
      if (joint.mimic.joint >= 0)
        addMimic(static_cast<int>(r), static_cast<int>(j), 1.0);
    }
  b_.assign(b_.size(), 0.0);  // an impact changes velocities only; the position error is the next step's
  finishRows();
  problem_.f.resize(velocities_);
  for (const Robot& robot : robots_)
    problem_.f.segment(robot.v_offset, robot.model.nv).noalias() = -(robot.middle.mass_matrix * robot.v);
  assembleMass(false);
}

}  // namespace frictional_contact_sim
