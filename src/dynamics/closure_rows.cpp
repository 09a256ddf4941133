#include "frictional_contact_sim/dynamics/closure_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
constexpr double CLOSED = 1e-11;  ///< at the next midpoint [m], [rad]
constexpr int MOST_ROUNDS = 5;  ///< what is left then is the next step's to mend
constexpr double CLOSING_SPEED = 0.1;  ///< of what is missing from outside [m/s]
constexpr double CLOSING_RATE = 1.0;  ///< [rad/s]
constexpr double ROUND_OFF = 16.0 * std::numeric_limits<double>::epsilon();

int linkOf(const Body& body, int frame)
{
  return body.model.tree.frames[static_cast<size_t>(frame)].link;
}

/** What of `error` may stay after a step that takes away at most `most`; all of a small one goes. */
Eigen::Vector3d leftOver(const Eigen::Vector3d& error, double most)
{
  const double size = error.norm();
  return size <= most ? Eigen::Vector3d::Zero() : Eigen::Vector3d((1.0 - most / size) * error);
}
}  // namespace

/** Where an answer takes a body. */
struct ClosureRows::Ahead
{
  explicit Ahead(const Body& body)
    : v(body.state.v), q_end(body.state.q), v_end(body.state.v), q(body.state.q), data(body.model.tree)
  {
  }
  Eigen::VectorXd v;  ///< the answer
  Eigen::VectorXd q_end;
  Eigen::VectorXd v_end;
  Eigen::VectorXd q;  ///< next midpoint
  MultibodyData data;
};

Eigen::Matrix3d closureBasis(LoopType type, const Eigen::Isometry3d& wanted)
{
  return type == LoopType::WELD ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(wanted.linear());
}

Vector6d closureError(LoopType type, const Eigen::Isometry3d& a, const Eigen::Isometry3d& wanted,
                      const Eigen::Matrix3d& basis)
{
  Vector6d error = Vector6d::Zero();
  error.head<3>() = a.translation() - wanted.translation();
  if (type == LoopType::WELD)
  {
    // As a quaternion: its vector part is exact to round-off for small angles too.
    Eigen::Quaterniond turn(Eigen::Matrix3d(a.linear() * wanted.linear().transpose()));
    if (turn.w() < 0.0)
      turn.coeffs() = -turn.coeffs();
    const double sine = turn.vec().norm();
    error.tail<3>() = (sine > 0.0 ? 2.0 * std::atan2(sine, turn.w()) / sine : 0.0) * turn.vec();
  }
  else if (type == LoopType::AXIS)
  {
    const Eigen::Vector3d across = wanted.linear().col(2).cross(a.linear().col(2));
    const double sine = across.norm();
    const double cosine = wanted.linear().col(2).dot(a.linear().col(2));
    const double factor = sine > 0.0 ? std::atan2(sine, cosine) / sine : 0.0;
    error.segment<2>(3) = factor * (basis.leftCols<2>().transpose() * across);
  }
  // What rests stays exactly where it is.
  if (error.head<3>().norm() <= ROUND_OFF * std::max(1.0, a.translation().norm() + wanted.translation().norm()))
    error.head<3>().setZero();
  if (error.tail<3>().norm() <= ROUND_OFF)
    error.tail<3>().setZero();
  return error;
}

ClosureRows::ClosureRows(const char* name, std::vector<Body>& bodies, std::vector<Closure>& closures)
  : name_(name), bodies_(bodies), closures_(closures), ahead_(bodies.size())
{
}

ClosureRows::~ClosureRows() = default;

void ClosureRows::begin(const StepContext&)
{
  rounds_ = 0;
  violation_ = 0.0;
  errors_.assign(closures_.size(), Error());
}

/** Motion that a moving base gives to a point (linear; angular). */
Vector6d ClosureRows::baseMotion(int body, const Eigen::Vector3d& point) const
{
  Vector6d motion = Vector6d::Zero();
  if (body < 0 || !bodies_[static_cast<size_t>(body)].model.base_motion.active)
    return motion;
  const Body& moved = bodies_[static_cast<size_t>(body)];
  const BaseVelocity& base = moved.base;
  motion.head<3>() = base.linear + moved.base_turn * (point - moved.middle.link_pose.front().translation());
  motion.tail<3>() = base.angular;
  return motion;
}

/** At the midpoint of this step or of the next one; the world's own where there is no body. */
Eigen::Isometry3d ClosureRows::poseOf(int body, int frame, bool is_ahead) const
{
  if (body < 0)
    return Eigen::Isometry3d::Identity();
  const auto index = static_cast<size_t>(body);
  return framePose(bodies_[index].model.tree, is_ahead ? ahead_[index]->data : bodies_[index].middle, frame);
}

/** The anchor as link a has it. */
Eigen::Isometry3d ClosureRows::anchorOf(const Closure& closure, bool is_ahead) const
{
  return poseOf(closure.body_a, closure.frame_a, is_ahead) * closure.anchor;
}

/** The anchor as link b has it. */
Eigen::Isometry3d ClosureRows::wantedOf(const Closure& closure, bool is_ahead) const
{
  return poseOf(closure.body_b, closure.frame_b, is_ahead) * closure.pose;
}

void ClosureRows::close(const StepContext& context, const Closure& closure, Error& error) const
{
  const Eigen::Isometry3d anchor = anchorOf(closure, false);
  const Eigen::Isometry3d wanted = wantedOf(closure, false);
  error.basis = closureBasis(closure.type, wanted);
  error.error = closureError(closure.type, anchor, wanted, error.basis);
  error.point = anchor.translation() - 0.5 * error.error.head<3>();
  error.kept.head<3>() = leftOver(error.error.head<3>(), CLOSING_SPEED * context.dt);
  error.kept.tail<3>() = leftOver(error.error.tail<3>(), CLOSING_RATE * context.dt);
  error.is_known = true;
}

void ClosureRows::collectColumns(const Closure& closure, const Eigen::Vector3d& point)
{
  columns_.clear();
  for (const bool is_a : {true, false})
  {
    const int index = is_a ? closure.body_a : closure.body_b;
    if (index < 0)
      continue;
    const Body& body = bodies_[static_cast<size_t>(index)];
    const int link = linkOf(body, is_a ? closure.frame_a : closure.frame_b);
    for (const int j : body.model.chains[static_cast<size_t>(link)])
    {
      Vector6d motion = body.middle.motion_subspace.col(j);
      motion.head<3>() += motion.tail<3>().cross(point - body.middle.reference);
      columns_.emplace_back(body.v_offset + j, is_a ? motion : Vector6d(-motion));
    }
  }
  std::sort(columns_.begin(), columns_.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  // A coordinate that moves both links of one body moves neither against the other.
  size_t kept = 0;
  for (size_t i = 0; i < columns_.size(); ++i)
    if (i + 1 < columns_.size() && columns_[i].first == columns_[i + 1].first)
      ++i;
    else
      columns_[kept++] = columns_[i];
  columns_.erase(columns_.begin() + static_cast<std::ptrdiff_t>(kept), columns_.end());
}

/** Farthest point that a rotation of one against the other moves [m]. */
double ClosureRows::reachOf(const Closure& closure) const
{
  const auto size = [this](int body, int frame)
  {
    const Body& moved = bodies_[static_cast<size_t>(body)];
    return moved.model.sizes[static_cast<size_t>(linkOf(moved, frame))];
  };
  const double reach =
      std::max(size(closure.body_a, closure.frame_a), closure.body_b < 0 ? 0.0 : size(closure.body_b, closure.frame_b));
  return reach > 0.0 ? reach : 1.0;
}

void ClosureRows::addRows(const StepContext& context, RowSink& sink)
{
  violation_ = 0.0;
  for (size_t i = 0; i < closures_.size(); ++i)
  {
    Closure& closure = closures_[i];
    Error& error = errors_[i];
    if (!error.is_known)
      close(context, closure, error);
    closure.basis = error.basis;
    violation_ = std::max({violation_, error.error.head<3>().norm(), error.error.tail<3>().norm()});
    collectColumns(closure, error.point);
    const Vector6d base = baseMotion(closure.body_a, error.point) - baseMotion(closure.body_b, error.point);
    const RowUnit length{VelocityUnit::LENGTH, 1.0};
    const RowUnit angle{VelocityUnit::ANGLE, reachOf(closure)};
    const WorkAccount account = context.impact ? WorkAccount::IMPACT : WorkAccount::JOINTS;
    for (int k = 0; k < rowsOf(closure.type); ++k)
    {
      const auto component = [&](const Vector6d& motion)
      { return k < 3 ? motion[k] : error.basis.col(k - 3).dot(motion.tail<3>()); };
      for (const auto& [column, motion] : columns_)
        sink.pushBilateral(column, component(motion));
      const double moved = component(base);
      const double b = moved + (error.error[k] - error.kept[k]) / context.dt + error.correction[k];
      sink.endBilateral(b, {account, moved, &closure.impulse[k]}, k < 3 ? length : angle);
    }
    if (context.impact)
      sink.noteClosing();  // the two may have been joined just now
  }
}

void ClosureRows::moveAhead(const StepContext& context, const Solution& solution)
{
  for (const Closure& closure : closures_)
    for (const int index : {closure.body_a, closure.body_b})
    {
      if (index < 0)
        continue;
      const Body& body = bodies_[static_cast<size_t>(index)];
      std::unique_ptr<Ahead>& ahead = ahead_[static_cast<size_t>(index)];
      if (!ahead)
        ahead = std::make_unique<Ahead>(body);
      if (body.model.nv > 0)
      {
        ahead->v = solution.v.segment(body.v_offset, body.model.nv);
        moveStep(body, ahead->v, context.dt, ahead->q_end, ahead->v_end);
        moveHalfStep(body, ahead->q_end, ahead->v_end, context.dt, ahead->q);
      }
      ahead->data.base_pose = basePose(body, 1.5 * context.dt);
      computeLinkPoses(body.model.tree, ahead->q, ahead->data);
    }
}

Again ClosureRows::lookAhead(const StepContext& context, const Solution& solution)
{
  if (closures_.empty() || context.impact || rounds_ == MOST_ROUNDS)
    return Again::NO;
  moveAhead(context, solution);
  bool is_closed = true;
  for (size_t i = 0; i < closures_.size(); ++i)
  {
    const Closure& closure = closures_[i];
    const Eigen::Isometry3d wanted = wantedOf(closure, true);
    const Vector6d miss =
        closureError(closure.type, anchorOf(closure, true), wanted, closureBasis(closure.type, wanted)) -
        errors_[i].kept;
    if (!(miss.cwiseAbs().maxCoeff() > CLOSED))  // a number that is none is not mended here
      continue;
    errors_[i].correction += miss / context.dt;
    is_closed = false;
  }
  if (is_closed)
    return Again::NO;
  ++rounds_;
  return Again::FROM_ANSWER;
}

void ClosureRows::markActing(std::vector<char>& bodies) const
{
  for (const Closure& closure : closures_)
    for (const int body : {closure.body_a, closure.body_b})
      if (body >= 0 && !closure.impulse.isZero(0.0))
        bodies[static_cast<size_t>(body)] = 1;
}

/** The assembly writes this step's impulses then; where there was no answer there are none. */
void ClosureRows::accept(const StepContext&, const StepAnswer&)
{
  for (Closure& closure : closures_)
    closure.impulse.setZero();
}

}  // namespace frictional_contact_sim
