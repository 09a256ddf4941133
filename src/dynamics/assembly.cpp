#include "frictional_contact_sim/dynamics/assembly.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/problem/residual_metric.h"

namespace frictional_contact_sim
{
StepAssembly::StepAssembly(std::vector<Body>& bodies, std::vector<std::unique_ptr<RowSource>> sources, RowState& state)
  : bodies_(bodies), sources_(std::move(sources)), state_(state)
{
  for (Body& body : bodies_)
  {
    body.v_offset = velocities_;
    velocities_ += body.model.nv;
    body_of_.resize(velocities_, static_cast<int>(&body - bodies_.data()));
    joint_body_.resize(joint_body_.size() + body.model.tree.joints.size(), static_cast<int>(&body - bodies_.data()));
  }
  acting_.resize(bodies_.size());
  misses_.resize(bodies_.size());
  last_bias_round_.resize(bodies_.size());
  is_settled_.resize(bodies_.size());
  settled_.resize(velocities_);
  last_bias_.resize(velocities_);
  last_miss_.resize(velocities_);
  // Entry (i, j) of M is structurally nonzero when one coordinate is the other's ancestor (Featherstone 2008, 6.3).
  mass_columns_.resize(velocities_);
  for (const Body& body : bodies_)
    for (int i = 0; i < body.model.tree.nv; ++i)
      for (int j = i; j >= 0; j = body.model.tree.dof_parent[j])
      {
        mass_columns_[body.v_offset + i].push_back(body.v_offset + j);
        if (i != j)
          mass_columns_[body.v_offset + j].push_back(body.v_offset + i);
      }
  for (const Body& body : bodies_)
    for (int i = 0; body.model.solid && i < body.model.nv; ++i)
      for (const int j : body.model.solid->massColumns()[static_cast<size_t>(i)])
        mass_columns_[body.v_offset + i].push_back(body.v_offset + j);
  for (std::vector<int>& columns : mass_columns_)
    std::sort(columns.begin(), columns.end());
  v_old_.resize(velocities_);
  clear();
}

void StepAssembly::begin(StepContext& context)
{
  for (Body& body : bodies_)
  {
    setStartVelocity(body, context.impact);
    v_old_.segment(body.v_offset, body.model.nv) = body.v_start;
  }
  context.v_old = &v_old_;
  for (const std::unique_ptr<RowSource>& source : sources_)
    source->begin(context);
  findLastActing(context);
}

int StepAssembly::assembleForces(const StepContext& context)
{
  mass_is_set_ = false;
  std::fill(is_settled_.begin(), is_settled_.end(), 0);
  momentum_.resize(velocities_);
  force_.resize(velocities_);
  int singular = -1;
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (bodies_[b].model.nv > 0 && !assembleForces(context, static_cast<int>(b)))
      singular = static_cast<int>(b);
  return singular;
}

void StepAssembly::assembleRows(const StepContext& context)
{
  sink_.clear(velocities_);
  for (const std::unique_ptr<RowSource>& source : sources_)
  {
    sink_.setOrigin({source->name(), -1, -1});
    source->addRows(context, sink_);
  }
  joint_rows_ = sink_.rows();
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    const std::vector<Joint>& joints = bodies_[b].model.tree.joints;
    for (size_t j = 0; j < joints.size(); ++j)
      if (velocitySize(joints[j].type) == 1)
        for (const std::unique_ptr<RowSource>& source : sources_)
        {
          sink_.setOrigin({source->name(), static_cast<int>(b), static_cast<int>(j)});
          source->addJointRows(context, static_cast<int>(b), static_cast<int>(j), sink_);
        }
  }
  bias_rounds_ = 0;
  std::fill(last_bias_round_.begin(), last_bias_round_.end(), -1);
}

void StepAssembly::makeGuess(const StepContext& context, Solution& guess, const Solution* answer) const
{
  const int rows = sink_.rows();
  const int bilaterals = sink_.bilaterals();
  const int last_rows = problem_.rows();  // those that `answer` is of
  guess.r.setZero(rows);
  guess.u.setZero(rows);
  guess.v.setZero(sink_.columns());
  guess.v.head(velocities_) = v_old_;
  guess.lambda.setZero(bilaterals);
  if (context.impact && !answer)
    return;
  for (int i = 0; i < rows; ++i)
    if (const double* memory = sink_.rowRecords()[i].memory)
      guess.r[i] = *memory;
  for (int k = 0; k < bilaterals; ++k)
    if (const double* memory = sink_.bilateralRecords()[k].memory)
      guess.lambda[k] = *memory;
  for (const std::unique_ptr<RowSource>& source : sources_)
    source->guess(context, answer != nullptr, guess);
  if (!answer)
    return;
  // Contacts know their impulses of the answer by id; other rows are the same ones, or start from the last step.
  guess.v.head(velocities_) = answer->v.head(velocities_);
  if (last_rows - last_joint_rows_ == rows - joint_rows_)
    guess.r.tail(rows - joint_rows_) = answer->r.tail(rows - joint_rows_);
  guess.lambda = answer->lambda;
}

/** The pattern of M: the trees', then the auxiliary columns' diagonal. */
void StepAssembly::setMassPattern()
{
  rows_m_.clear();
  for (const std::vector<int>& columns : mass_columns_)
  {
    for (const int column : columns)
      rows_m_.push(column, 0.0);
    rows_m_.endRow();
  }
  for (int column = velocities_; column < sink_.columns(); ++column)
  {
    rows_m_.push(column, 0.0);
    rows_m_.endRow();
  }
  rows_m_.copyTo(sink_.columns(), problem_.M);
}

void StepAssembly::assembleMass(bool with_implicit)
{
  if (problem_.M.rows() != sink_.columns())
    setMassPattern();
  double* value = problem_.M.valuePtr();
  for (const Body& body : bodies_)
    if (body.model.solid)
      body.model.solid->copyMass(body, value);
    else
      for (int i = 0; i < body.model.nv; ++i)
      {
        // Column i of the dense M, which has both triangles.
        const double* const dense = body.middle.mass_matrix.data() + static_cast<std::ptrdiff_t>(i) * body.model.nv;
        const std::vector<int>& columns = mass_columns_[body.v_offset + i];
        if (columns.size() == static_cast<size_t>(body.model.nv))
          std::copy(dense, dense + body.model.nv, value);
        else
          std::transform(columns.begin(), columns.end(), value,
                         [&](int column) { return dense[column - body.v_offset]; });
        if (with_implicit)
          value[std::lower_bound(columns.begin(), columns.end(), body.v_offset + i) - columns.begin()] +=
              body.implicit[i];
        value += columns.size();
      }
  for (const double mass : sink_.auxiliaryMass())
    *value++ = mass;
}

/** f of one body; false where its mass matrix is not positive definite. */
bool StepAssembly::assembleForces(const StepContext& context, int index)
{
  Body& body = bodies_[index];
  auto momentum = momentum_.segment(body.v_offset, body.model.nv);  // M v_k + dt applied + c, without bias
  if (body.model.solid)
    body.model.solid->multiply(body, body.v_start, momentum);
  else
    momentum.noalias() = body.middle.mass_matrix * body.v_start;
  if (context.impact)
  {
    force_.segment(body.v_offset, body.model.nv) = -momentum;
    body.speed = pointSpeed(body, body.v_start);
    body.speed_change = std::max(VELOCITY_FLOOR, context.dt * context.gravity.norm());  // of the step that follows
    return true;
  }
  momentum += context.dt * body.external;
  body.implicit = context.dt * body.model.damping;
  for (const std::unique_ptr<RowSource>& source : sources_)
    source->addMomentum(context, index, momentum);
  // A free link has its motion without a factor, and asks for one when its bias is to be put in again.
  if (!body.model.free_link && !factorizeMass(body))
    return false;
  predict(context, body);
  force_.segment(body.v_offset, body.model.nv) = context.dt * body.bias - momentum;
  return true;
}

/** What the residual is measured with, from the bodies that a row touches. */
LawScale StepAssembly::scaleOf(const SparseRows& rows, int row, const RowUnit& unit, double base_speed) const
{
  LawScale scale{unit.unit, unit.reach, 0.0, base_speed};
  for (SparseRows::InnerIterator entry(rows, row); entry; ++entry)
    if (entry.col() < velocities_)
    {
      const Body& body = bodies_[body_of_[entry.col()]];
      scale.speed_change = std::max(scale.speed_change, body.speed_change);
      scale.speed = std::max(scale.speed, body.speed);
    }
  return scale;
}

/** Bodies that loops join are driven by each other: what one step's forces change of one, they change of all. */
void StepAssembly::shareSpeedChanges()
{
  for (bool changed = true; changed;)
  {
    changed = false;
    for (int row = 0; row < problem_.bilaterals(); ++row)
    {
      double largest = 0.0;
      for (SparseRows::InnerIterator entry(problem_.G, row); entry; ++entry)
        largest = std::max(largest, bodies_[body_of_[entry.col()]].speed_change);
      for (SparseRows::InnerIterator entry(problem_.G, row); entry; ++entry)
        if (double& own = bodies_[body_of_[entry.col()]].speed_change; own < largest)
        {
          own = largest;
          changed = true;
        }
    }
  }
}

void StepAssembly::setScales()
{
  shareSpeedChanges();
  problem_.scales.clear();
  int row = 0;
  for (size_t i = 0; i < problem_.laws.size(); ++i)
  {
    double base_speed = 0.0;
    for (int k = 0; k < problem_.laws[i].dimension(); ++k)
      base_speed = std::max(base_speed, std::abs(sink_.rowRecords()[row + k].base_velocity));
    problem_.scales.push_back(scaleOf(problem_.H, row, sink_.units()[i], base_speed));
    row += problem_.laws[i].dimension();
  }
  problem_.bilateral_scales.clear();
  for (int k = 0; k < problem_.bilaterals(); ++k)
    problem_.bilateral_scales.push_back(scaleOf(problem_.G, k, sink_.bilateralUnits()[k], 0.0));
}

void StepAssembly::assembleProblem(const StepContext& context)
{
  sink_.copyTo(context.impact, problem_);
  last_joint_rows_ = joint_rows_;
  problem_.f.setZero(sink_.columns());
  problem_.f.head(velocities_) = force_;
  const bool has_auxiliaries = sink_.columns() > velocities_;
  if (!mass_is_set_ || has_auxiliaries)
    assembleMass(!context.impact);
  mass_is_set_ = !has_auxiliaries;
  setScales();
}

void StepAssembly::clear()
{
  for (const std::unique_ptr<RowSource>& source : sources_)
    source->clear();
  sink_.clear(velocities_);
  sink_.copyTo(false, problem_);
  mass_is_set_ = false;
  problem_.f.setZero(velocities_);
  problem_.scales.clear();
  problem_.bilateral_scales.clear();
  for (Body& body : bodies_)
    if (body.model.solid)
      body.model.solid->prepare(body, 0.0);
    else
      body.middle.mass_matrix.setIdentity();
  assembleMass(false);
}

Again StepAssembly::again(const StepContext& context, const Solution& solution, bool converged)
{
  for (const std::unique_ptr<RowSource>& source : sources_)
    if (const Again again = source->again(context, solution, converged); again != Again::NO)
    {
      unsatisfied_ = source->name();
      return again;
    }
  if (!converged)
    return Again::NO;
  if (!context.impact)
    if (const Again again = biasAgain(context, solution); again != Again::NO)
      return again;
  for (const std::unique_ptr<RowSource>& source : sources_)
    if (const Again again = source->lookAhead(context, solution); again != Again::NO)
    {
      unsatisfied_ = source->name();
      return again;
    }
  return Again::NO;
}

void StepAssembly::accept(const StepContext& context, const StepAnswer& answer)
{
  for (const std::unique_ptr<RowSource>& source : sources_)
    source->accept(context, answer);
  for (RowMemory& memory : state_.memory)
    std::fill(memory.impulses.begin(), memory.impulses.end(), 0.0);
  for (int i = 0; i < problem_.rows(); ++i)
    if (double* memory = sink_.rowRecords()[i].memory)
      *memory = answer.solution.r[i];
  for (int k = 0; k < problem_.bilaterals(); ++k)
    if (double* memory = sink_.bilateralRecords()[k].memory)
      *memory = answer.solution.lambda[k];
}

const ContactPoint* StepAssembly::contactOf(const StepContext& context, int law) const
{
  for (const std::unique_ptr<RowSource>& source : sources_)
    if (const ContactPoint* point = source->contactOf(context, law))
      return point;
  return nullptr;
}

Eigen::VectorXd StepAssembly::closedOffsets() const
{
  Eigen::VectorXd w = problem_.w;
  int row = 0;
  for (const Law& law : problem_.laws)
  {
    if (law.isOneSided())
      w[row] = std::min(w[row], sink_.rowRecords()[static_cast<size_t>(row)].base_velocity);
    row += law.dimension();
  }
  return w;
}

double StepAssembly::bilateralViolation() const
{
  double violation = 0.0;
  for (const std::unique_ptr<RowSource>& source : sources_)
    violation = std::max(violation, source->violation());
  return violation;
}

}  // namespace frictional_contact_sim
