#include "frictional_contact_sim/dynamics/weld_rows.h"

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
struct WeldRows::Ahead
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

Vector6d closureError(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const Eigen::Isometry3d& a_in_b)
{
  const Eigen::Isometry3d wanted = b * a_in_b;
  Vector6d error;
  error.head<3>() = a.translation() - wanted.translation();
  // As a quaternion: its vector part is exact to round-off for small angles too.
  Eigen::Quaterniond turn(Eigen::Matrix3d(a.linear() * wanted.linear().transpose()));
  if (turn.w() < 0.0)
    turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  error.tail<3>() = (sine > 0.0 ? 2.0 * std::atan2(sine, turn.w()) / sine : 0.0) * turn.vec();
  // What rests stays exactly where it is.
  const double length = a.translation().norm() + b.translation().norm() + a_in_b.translation().norm();
  if (error.head<3>().norm() <= ROUND_OFF * std::max(1.0, length))
    error.head<3>().setZero();
  if (error.tail<3>().norm() <= ROUND_OFF)
    error.tail<3>().setZero();
  return error;
}

WeldRows::WeldRows(std::vector<Body>& bodies, std::vector<Weld>& welds)
  : bodies_(bodies), welds_(welds), ahead_(bodies.size())
{
}

WeldRows::~WeldRows() = default;

void WeldRows::begin(const StepContext&)
{
  rounds_ = 0;
  violation_ = 0.0;
  closures_.assign(welds_.size(), Closure());
}

/** Motion that a moving base gives to a point (linear; angular). */
Vector6d WeldRows::baseMotion(int body, const Eigen::Vector3d& point) const
{
  Vector6d motion = Vector6d::Zero();
  if (body < 0 || !bodies_[static_cast<size_t>(body)].model.base_motion.active)
    return motion;
  const Body& moved = bodies_[static_cast<size_t>(body)];
  const BaseMotion& base = moved.model.base_motion;
  motion.head<3>() = base.linear + base.angular.cross(point - moved.middle.link_pose.front().translation());
  motion.tail<3>() = base.angular;
  return motion;
}

/** At the midpoint of this step or of the next one; the world's own where there is no body. */
Eigen::Isometry3d WeldRows::poseOf(int body, int frame, bool is_ahead) const
{
  if (body < 0)
    return Eigen::Isometry3d::Identity();
  const auto index = static_cast<size_t>(body);
  return framePose(bodies_[index].model.tree, is_ahead ? ahead_[index]->data : bodies_[index].middle, frame);
}

Vector6d WeldRows::errorOf(const Weld& weld, bool is_ahead) const
{
  return closureError(poseOf(weld.body_a, weld.frame_a, is_ahead), poseOf(weld.body_b, weld.frame_b, is_ahead),
                      weld.pose);
}

void WeldRows::close(const StepContext& context, const Weld& weld, Closure& closure) const
{
  closure.error = errorOf(weld, false);
  closure.point = poseOf(weld.body_a, weld.frame_a, false).translation() - 0.5 * closure.error.head<3>();
  closure.kept.head<3>() = leftOver(closure.error.head<3>(), CLOSING_SPEED * context.dt);
  closure.kept.tail<3>() = leftOver(closure.error.tail<3>(), CLOSING_RATE * context.dt);
  closure.is_known = true;
}

void WeldRows::collectColumns(const Weld& weld, const Eigen::Vector3d& point)
{
  columns_.clear();
  for (const bool is_a : {true, false})
  {
    const int index = is_a ? weld.body_a : weld.body_b;
    if (index < 0)
      continue;
    const Body& body = bodies_[static_cast<size_t>(index)];
    const int link = linkOf(body, is_a ? weld.frame_a : weld.frame_b);
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
double WeldRows::reachOf(const Weld& weld) const
{
  const auto size = [this](int body, int frame)
  {
    const Body& moved = bodies_[static_cast<size_t>(body)];
    return moved.model.sizes[static_cast<size_t>(linkOf(moved, frame))];
  };
  const double reach =
      std::max(size(weld.body_a, weld.frame_a), weld.body_b < 0 ? 0.0 : size(weld.body_b, weld.frame_b));
  return reach > 0.0 ? reach : 1.0;
}

void WeldRows::addRows(const StepContext& context, RowSink& sink)
{
  violation_ = 0.0;
  for (size_t i = 0; i < welds_.size(); ++i)
  {
    Weld& weld = welds_[i];
    Closure& closure = closures_[i];
    if (!closure.is_known)
      close(context, weld, closure);
    violation_ = std::max({violation_, closure.error.head<3>().norm(), closure.error.tail<3>().norm()});
    collectColumns(weld, closure.point);
    const Vector6d base = baseMotion(weld.body_a, closure.point) - baseMotion(weld.body_b, closure.point);
    const RowUnit length{VelocityUnit::LENGTH, 1.0};
    const RowUnit angle{VelocityUnit::ANGLE, reachOf(weld)};
    for (int k = 0; k < 6; ++k)
    {
      for (const auto& [column, motion] : columns_)
        sink.pushBilateral(column, motion[k]);
      const double b = base[k] + (closure.error[k] - closure.kept[k]) / context.dt + closure.correction[k];
      const WorkAccount account = context.impact ? WorkAccount::IMPACT : WorkAccount::JOINTS;
      sink.endBilateral(b, {account, base[k], &weld.impulse[k]}, k < 3 ? length : angle);
    }
    if (context.impact)
      sink.noteClosing();  // the two may have been joined just now
  }
}

void WeldRows::moveAhead(const StepContext& context, const Solution& solution)
{
  for (const Weld& weld : welds_)
    for (const int index : {weld.body_a, weld.body_b})
    {
      if (index < 0)
        continue;
      const Body& body = bodies_[static_cast<size_t>(index)];
      std::unique_ptr<Ahead>& ahead = ahead_[static_cast<size_t>(index)];
      if (!ahead)
        ahead = std::make_unique<Ahead>(body);
      if (body.model.tree.nv > 0)
      {
        ahead->v = solution.v.segment(body.v_offset, body.model.tree.nv);
        moveStep(body, ahead->v, context.dt, ahead->q_end, ahead->v_end);
        moveHalfStep(body, ahead->q_end, ahead->v_end, context.dt, ahead->q);
      }
      ahead->data.base_pose = basePose(body, 1.5 * context.dt);
      forwardKinematics(body.model.tree, ahead->q, ahead->data);
    }
}

Again WeldRows::lookAhead(const StepContext& context, const Solution& solution)
{
  if (welds_.empty() || context.impact || rounds_ == MOST_ROUNDS)
    return Again::NO;
  moveAhead(context, solution);
  bool is_closed = true;
  for (size_t i = 0; i < welds_.size(); ++i)
  {
    const Vector6d miss = errorOf(welds_[i], true) - closures_[i].kept;
    if (!(miss.cwiseAbs().maxCoeff() > CLOSED))  // a number that is none is not mended here
      continue;
    closures_[i].correction += miss / context.dt;
    is_closed = false;
  }
  if (is_closed)
    return Again::NO;
  ++rounds_;
  return Again::FROM_ANSWER;
}

void WeldRows::markActing(std::vector<char>& bodies) const
{
  for (const Weld& weld : welds_)
    for (const int body : {weld.body_a, weld.body_b})
      if (body >= 0 && !weld.impulse.isZero(0.0))
        bodies[static_cast<size_t>(body)] = 1;
}

/** The assembly writes this step's impulses then; where there was no answer there are none. */
void WeldRows::accept(const StepContext&, const StepAnswer&)
{
  for (Weld& weld : welds_)
    weld.impulse.setZero();
}

}  // namespace frictional_contact_sim
