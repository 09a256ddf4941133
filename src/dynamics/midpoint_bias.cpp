// The bias at the midpoint of the step: first guess, rounds after the solve, what free links end with; see assembly.h.
#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/dynamics/free_link.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int GUESS_ROUNDS = 5;  ///< for the motion without any row
constexpr int MANY_BIAS_ROUNDS = 5;  ///< of a step, since rows changed last; after these it need not be settled wholly
constexpr int MOST_BIAS_ROUNDS = 30;

/** From which round on a body's bias is not taken as it is. */
struct Acceleration
{
  int anderson;  ///< extrapolated from two rounds
  int damped;  ///< half of a change, as contacts come and go with it
  int careful;  ///< a quarter
};
constexpr Acceleration SOLID{3, 6, 10};
constexpr Acceleration TREE{MANY_BIAS_ROUNDS, 14, 18};  ///< nearly all settle before

const Acceleration& acceleration(const Body& body)
{
  return body.model.solid ? SOLID : TREE;
}
constexpr double UNSETTLED = 1e-2;  ///< times the step's change of speed: what a bias may miss after the most rounds
constexpr double BIAS_ROUND_OFF = 1e-12;  ///< relative: a smaller tolerance asks for more than bias and factor hold
constexpr double AT_REST = 1e6;  ///< [1/m]: a bias changes v by far less than this times dt v^2
constexpr double SPEED_ROUND_OFF = 1e-14;  ///< relative to the speed itself

/** Whether Body::change is no more than the round-off of (J o) x o of a ball: a bound, without a factor of M. */
bool isSpinRoundOff(const Body& body, double tolerance)
{
  if (!body.model.free_link || !body.model.isotropic || !body.change.head<3>().isZero(0.0))
    return false;
  const RigidInertia& inertia = body.model.tree.links.front().inertia;
  const double spin = 3.0 * body.change.tail<3>().norm() / inertia.rotational.trace();
  return 2.0 * spin * (inertia.center.norm() + body.model.sizes.front()) <= tolerance * body.speed_change;
}
}  // namespace

/** Which bodies a row with an impulse touches. */
void StepAssembly::findActing(const Solution& solution)
{
  std::fill(acting_.begin(), acting_.end(), 0);
  const auto mark = [this](const SparseRows& rows, const Eigen::VectorXd& impulses)
  {
    for (int i = 0; i < rows.rows(); ++i)
      if (impulses[i] != 0.0)
        for (SparseRows::InnerIterator entry(rows, i); entry; ++entry)
          if (entry.col() < velocities_)
            acting_[body_of_[entry.col()]] = 1;
  };
  mark(problem_.H, solution.r);
  mark(problem_.G, solution.lambda);
}

const std::vector<char>& StepAssembly::acting(const Solution& solution)
{
  findActing(solution);
  return acting_;
}

/** Which bodies an impulse of the last step touches. */
void StepAssembly::findLastActing(const StepContext& context)
{
  std::fill(acting_.begin(), acting_.end(), 0);
  if (context.impact)
    return;
  for (const RowMemory& memory : state_.memory)
  {
    const size_t width = memory.impulses.size() / std::max<size_t>(1, joint_body_.size());
    for (size_t i = 0; i < memory.impulses.size(); ++i)
      if (memory.impulses[i] != 0.0)
        acting_[joint_body_[i / width]] = 1;
  }
  for (const std::unique_ptr<RowSource>& source : sources_)
    source->markActing(acting_);
}

/** Body::v_free, its speeds, and bias at the first guess of the mean velocity. */
void StepAssembly::predict(const StepContext& context, Body& body)
{
  const auto momentum = momentum_.segment(body.v_offset, body.model.nv);
  const auto move = [&](Eigen::VectorXd& v)
  {
    v = momentum - context.dt * body.bias;
    solveMass(body, v);
  };
  computeBias(body, body.v_start, context.gravity, body.bias);
  if (body.model.free_link)
    moveFreely(body, context.gravity, context.dt);
  else
    move(body.v_free);
  setSpeeds(body);
  if (acting_[body_of_[body.v_offset]])
    return;
  const double allowed = std::max(context.tolerance, BIAS_ROUND_OFF) * body.speed_change;
  for (int round = 0; round < GUESS_ROUNDS; ++round)
  {
    body.v_middle = 0.5 * (body.v_start + body.v_free);
    computeBias(body, body.v_middle, context.gravity, body.bias);
    if (body.model.free_link)
      return;
    body.change = body.v_free;
    move(body.v_free);
    body.change -= body.v_free;
    if (pointSpeed(body, body.change) <= allowed)
      return;
  }
}

/** How much the bias at the mean velocity of an answer misses, in units of what it may: Body::next_bias, change. */
double StepAssembly::biasMiss(const StepContext& context, const Solution& solution, Body& body)
{
  const auto v = solution.v.segment(body.v_offset, body.model.nv);
  const double tolerance = std::max(context.tolerance, BIAS_ROUND_OFF);
  // What rests has nothing to look at: velocities enter the bias as squares.
  const double fastest = std::max(body.v_start.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
  if (context.dt * AT_REST * fastest * fastest <= tolerance * body.speed_change)
    return 0.0;
  body.v_middle = 0.5 * (body.v_start + v);
  computeBias(body, body.v_middle, context.gravity, body.next_bias);
  body.change = context.dt * (body.next_bias - body.bias);
  if (body.change.isZero(0.0) || isSpinRoundOff(body, tolerance))
    return 0.0;
  if (body.model.free_link && !factorizeMass(body))
    return std::numeric_limits<double>::quiet_NaN();
  solveMass(body, body.change);
  const double change = pointSpeed(body, body.change);
  if (change <= tolerance * body.speed_change)
    return 0.0;
  // A body that was at rest and is hit has no smooth forces at the start; then those at its mean velocity count.
  body.change = v;
  double allowed = std::max(tolerance * body.speed_change, SPEED_ROUND_OFF * pointSpeed(body, body.change));
  body.change = context.dt * body.next_bias;
  solveMass(body, body.change);
  allowed = std::max(allowed, tolerance * pointSpeed(body, body.change));
  return change <= allowed ? 0.0 : change / allowed;
}

/** Of a free link that nothing touches: whether it was solved with its exact motion, else as biasMiss. */
double StepAssembly::freeMiss(const StepContext& context, const Solution& solution, Body& body)
{
  body.change = solution.v.segment<6>(body.v_offset) - body.v_free;
  const double change = pointSpeed(body, body.change);
  const double tolerance = std::max(context.tolerance, BIAS_ROUND_OFF);
  const double allowed = std::max(tolerance * body.speed_change, SPEED_ROUND_OFF * body.speed);
  if (change <= allowed)
    return 0.0;
  // It was touched in the last step, so that its first guess was another one.
  body.v_middle = 0.5 * (body.v_start + body.v_free);
  computeBias(body, body.v_middle, context.gravity, body.next_bias);
  return change / allowed;
}

/** Of every body, in units of what it may: misses_, with Body::next_bias. @return the largest */
double StepAssembly::missBias(const StepContext& context, const Solution& solution)
{
  double worst = 0.0;
  findActing(solution);
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    Body& body = bodies_[b];
    const bool free = body.model.free_link && !acting_[b];
    // Most bodies of a large scene answer as they did before: what settled then is settled.
    const auto v = solution.v.segment(body.v_offset, body.model.nv);
    auto settled = settled_.segment(body.v_offset, body.model.nv);
    const char way = free ? 1 : 2;
    if (is_settled_[b] == way && settled == v)
    {
      misses_[b] = 0.0;
      continue;
    }
    misses_[b] = body.model.nv == 0 ? 0.0
                 : free             ? freeMiss(context, solution, body)
                                    : biasMiss(context, solution, body);
    is_settled_[b] = misses_[b] == 0.0 ? way : 0;
    settled = v;
    if (!std::isfinite(misses_[b]))
      return misses_[b];
    worst = std::max(worst, misses_[b]);
  }
  return worst;
}

/** The bias of the bodies that miss to that of the mean velocity of the answer. */
void StepAssembly::moveBias(const StepContext& context)
{
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    if (misses_[b] == 0.0)
      continue;
    Body& body = bodies_[b];
    if (bias_rounds_ + 1 >= acceleration(body).anderson)  // with the round before the first one that is not plain
      accelerate(body, last_bias_round_[b]);
    force_.segment(body.v_offset, body.model.nv) += context.dt * (body.next_bias - body.bias);
    body.bias = body.next_bias;
  }
}

/**
 * Body::next_bias after some rounds: fixed-point iteration alone diverges where a soft rod cracks like a whip or a
 * light limb turns by much in a step, and swings between two answers. Source: Anderson (1965), of depth one; then
 * damped.
 */
void StepAssembly::accelerate(Body& body, int& last_round)
{
  auto last_bias = last_bias_.segment(body.v_offset, body.model.nv);  // as computed
  auto last_miss = last_miss_.segment(body.v_offset, body.model.nv);
  const Acceleration& begin = acceleration(body);
  body.change = body.next_bias - body.bias;
  if (bias_rounds_ >= begin.damped)
    body.next_bias = body.bias + (bias_rounds_ >= begin.careful ? 0.25 : 0.5) * body.change;
  else if (bias_rounds_ >= begin.anderson && last_round == bias_rounds_ - 1)
  {
    const double share = body.change.dot(body.change - last_miss) / (body.change - last_miss).squaredNorm();
    if (std::isfinite(share))
      body.next_bias -= share * (body.next_bias - last_bias);
  }
  last_bias = body.bias + body.change;
  last_miss = body.change;
  last_round = bias_rounds_;
}

void StepAssembly::followAnswer(const StepContext& context, const Solution& solution)
{
  if (!context.impact && std::isfinite(missBias(context, solution)))
    moveBias(context);
}

Again StepAssembly::biasAgain(const StepContext& context, const Solution& solution)
{
  const double worst = missBias(context, solution);
  const bool may_end = bias_rounds_ >= MANY_BIAS_ROUNDS;
  if (worst == 0.0 || (may_end && worst * std::max(context.tolerance, BIAS_ROUND_OFF) < UNSETTLED))
    return Again::NO;
  unsatisfied_ = "bias at the midpoint";
  if (bias_rounds_ == MOST_BIAS_ROUNDS || !std::isfinite(worst))
    return Again::NEVER;
  moveBias(context);
  ++bias_rounds_;
  problem_.f.head(velocities_) = force_;
  return Again::FORCES;
}

void StepAssembly::settleFreeLinks(Solution& solution)
{
  findActing(solution);
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (bodies_[b].model.free_link && !acting_[b])
      solution.v.segment<6>(bodies_[b].v_offset) = bodies_[b].v_free;
}

}  // namespace frictional_contact_sim
