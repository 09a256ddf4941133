#include "frictional_contact_sim/dynamics/contact_set.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/collision/convex_shape.h"
#include "frictional_contact_sim/dynamics/contact_rows.h"
#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double MINIMUM_MARGIN = 1e-3;  ///< contacts nearer than this are always known [m]
constexpr double LOOSER = 100.0;  ///< so many times more may go through with each round after the strict ones
constexpr double LOOSEST = 1e-5;
constexpr int MANY_ROUNDS = 10;  ///< after these a trace may be left
constexpr int MOST_ROUNDS = 30;
constexpr double TRACE = 1e-4;  ///< times the size: left after the most rounds, it is the next step's to mend

/** Sum over the coordinates of a link of direction . (motion of the point), velocities from `v` (of the body). */
double alongNormal(const Body& body, int link, const Eigen::Vector3d& position, const Eigen::Vector3d& normal,
                   const Eigen::VectorXd& v)
{
  const Eigen::Vector3d arm = position - body.middle.reference;
  // n . (a + w x arm) = n . a + (arm x n) . w
  const Eigen::Vector3d moment = arm.cross(normal);
  double speed = 0.0;
  for (const int j : body.model.chains[link])
  {
    const auto motion = body.middle.motion_subspace.col(j);
    speed += v[j] * (normal.dot(motion.head<3>()) + moment.dot(motion.tail<3>()));
  }
  return speed;
}

/** Of candidates ordered by id, const or not. @return nullptr where there is none of that id */
template <typename Candidates>
auto candidateOf(Candidates& candidates, const ContactId& id) -> decltype(candidates.data())
{
  const auto found = std::lower_bound(candidates.begin(), candidates.end(), id,
                                      [](const auto& candidate, const ContactId& b) { return candidate.point.id < b; });
  return found != candidates.end() && found->point.id == id ? &*found : nullptr;
}
}  // namespace

ContactSet::Ahead::Ahead(const Body& body)
  : v(body.state.v), q_end(body.state.q), v_end(body.state.v), q(body.state.q), data(body.model.tree)
{
}

ContactSet::ContactSet(std::vector<Body>& bodies, CollisionWorld& world, const PairTable& pairs,
                       const std::vector<ContactState>& last)
  : bodies_(bodies), world_(world), pairs_(pairs), last_(last)
{
  surfaces_ = SurfaceContacts(bodies_, world_);
  for (const Body& body : bodies_)
    ahead_.emplace_back(body);
  speeds_.resize(bodies_.size());
  margins_.resize(bodies_.size());
  margins_ahead_.resize(bodies_.size());
}

bool ContactSet::carriedBefore(const ContactId& id) const
{
  return std::binary_search(carried_.begin(), carried_.end(), id);
}

/** Times the size: how much may go through unmended in this round. */
double ContactSet::tolerance() const
{
  return std::min(LOOSEST, OVERLAP * std::pow(LOOSER, std::max(0, rounds_ - STRICT_ROUNDS)));
}

double ContactSet::sizeOf(const ContactPoint& point) const
{
  // A node counts with the mesh about it; a sphere of no radius is a point: there the link that it is a corner of.
  const auto size = [this](int handle)
  {
    const double radius = world_.convexShape(handle).bounding_radius;
    const ShapeInfo& shape = world_.shape(handle);
    if (shape.body < 0)
      return radius;
    const BodyModel& model = bodies_[static_cast<size_t>(shape.body)].model;
    if (model.solid)
      return model.solid->nodeDistance();
    return radius > 0.0 ? radius : model.sizes[shape.link];
  };
  return std::min(size(point.shape_a), size(point.shape_b));
}

/** Within the margins of the bodies, at the poses set: those at q_m, or where the answer takes them. */
const std::vector<ContactPoint>& ContactSet::detect(const std::vector<double>& margins, bool is_ahead)
{
  const std::vector<ContactPoint>& points = world_.detect(margins);
  if (surfaces_.empty())
    return points;
  const auto data = [&](int body) -> const MultibodyData&
  { return is_ahead ? ahead_[body].data : bodies_[body].middle; };
  surfaces_.find(points, margins, data, detected_);
  return detected_;
}

/** Of the points of a prescribed base [m/s]. */
double ContactSet::baseSpeed(const Body& body)
{
  if (!body.model.base_motion.active)
    return 0.0;
  double reach = 0.0;
  const Eigen::Vector3d origin = body.middle.link_pose.front().translation();
  for (size_t link = 0; link < body.middle.link_pose.size(); ++link)
    reach = std::max(reach, (body.middle.link_pose[link].translation() - origin).norm() + body.model.extents[link]);
  return body.base.linear.norm() + body.base.angular.norm() * reach;
}

const Eigen::VectorXd& ContactSet::velocities(Motion motion, int body) const
{
  if (motion == Motion::ANSWER)
    return ahead_[body].v;
  return motion == Motion::START ? bodies_[body].v_start : bodies_[body].v_free;
}

/** Of a relative to b along the normal, with moving bases. */
double ContactSet::normalSpeed(const ContactPoint& point, Motion motion) const
{
  double speed = 0.0;
  for (const int side : {0, 1})
  {
    const ShapeInfo& shape = world_.shape(side == 0 ? point.shape_a : point.shape_b);
    if (shape.body < 0)
      continue;
    const Body& body = bodies_[shape.body];
    const Eigen::VectorXd& v = velocities(motion, shape.body);
    double along = 0.0;
    if (body.model.solid)
    {
      columns_.clear();
      addPointColumns(body, {shape.link, side == 0 ? featureA(point.id) : featureB(point.id), point.position}, 1.0,
                      columns_);
      for (const auto& [column, direction] : columns_)
        along += v[column] * point.normal.dot(direction);
    }
    else
      along = alongNormal(body, shape.link, point.position, point.normal, v);
    if (body.model.base_motion.active)
      along += point.normal.dot(baseVelocity(bodies_, shape, point.position));
    speed += side == 0 ? along : -along;
  }
  return speed;
}

bool ContactSet::mayClose(const StepContext& context, const ContactPoint& point) const
{
  if (context.balance)
    return point.gap <= CONTACT_GAP;
  if (point.gap <= CONTACT_GAP || context.normal_law.form == ContactLawForm::VELOCITY || carriedBefore(point.id))
    return true;
  const double start = normalSpeed(point, Motion::START);
  const double free = context.impact ? start : normalSpeed(point, Motion::FREE);
  return point.gap <= -CLOSING_MARGIN * context.dt * std::min(start, free);
}

/** Candidates at q_m within the reach of speeds_; those that are known stay what they are. */
void ContactSet::detectAtMiddle(const StepContext& context)
{
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    margins_[b] = MINIMUM_MARGIN + 2.0 * context.dt * speeds_[b];
    world_.setPoses(static_cast<int>(b), bodies_[b].middle);
  }
  for (const ContactPoint& point : detect(margins_, false))
    candidates_.push_back({point});
  sortCandidates();
}

/** At its place; there is none of that id. */
ContactSet::Candidate& ContactSet::insert(const Candidate& candidate)
{
  const auto place = std::partition_point(candidates_.begin(), candidates_.end(),
                                          [&](const Candidate& a) { return a.point.id < candidate.point.id; });
  return *candidates_.insert(place, candidate);
}

/** Of two with one id the first stays. */
void ContactSet::sortCandidates()
{
  const auto before = [](const Candidate& a, const Candidate& b) { return a.point.id < b.point.id; };
  if (!std::is_sorted(candidates_.begin(), candidates_.end(), before))
    std::stable_sort(candidates_.begin(), candidates_.end(), before);
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end(),
                                [](const Candidate& a, const Candidate& b) { return a.point.id == b.point.id; }),
                    candidates_.end());
}

ContactSet::Candidate* ContactSet::known(const ContactId& id)
{
  return candidateOf(candidates_, id);
}

const std::vector<ContactPoint>& ContactSet::find(const StepContext& context)
{
  rounds_ = 0;
  ghosts_tried_ = is_last_ = false;
  is_lenient_ = !context.impact && !context.wedged.empty();
  carried_.clear();
  for (const ContactState& contact : last_)
    if (!contact.impulse.isZero(0.0))
      carried_.push_back(contact.id);
  std::sort(carried_.begin(), carried_.end());
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    speeds_[b] = (bodies_[b].model.nv > 0 ? bodies_[b].speed : 0.0) + baseSpeed(bodies_[b]);
    ahead_[b].is_known = ahead_[b].has_moved = false;
  }
  candidates_.clear();
  detectAtMiddle(context);
  for (Candidate& candidate : candidates_)
    if (mayClose(context, candidate.point))
      candidate.use = Use::ROW;
  takePoints();
  return points_;
}

void ContactSet::takePoints()
{
  points_.clear();
  for (const Candidate& candidate : candidates_)
    if (candidate.use == Use::ROW || candidate.use == Use::LINEARISED)
      points_.push_back(candidate.point);
}

ContactSet::Look ContactSet::lookAgain(const StepContext& context, const Eigen::VectorXd& v,
                                       const std::vector<double>& impulses)
{
  if (is_last_ || context.normal_law.form == ContactLawForm::VELOCITY || !setAnswer(context, v))
    return Look::CONTENT;
  size_t next = 0;
  for (Candidate& candidate : candidates_)
    if (candidate.use == Use::ROW || candidate.use == Use::LINEARISED)
    {
      candidate.impulse = impulses[next++];
      if (std::isnan(candidate.impulse))
        candidate.use = Use::HOPELESS;
    }
  worst_ = 0.0;
  bool changed = addClosing(context);
  if (!changed)
  {
    moveAhead(context);
    if (!context.impact && context.regime == Regime::DYNAMIC)  // else both poses are one
    {
      setPosesAhead(context, true);
      changed = mend(context, 0.5);
    }
    setPosesAhead(context, false);
    changed = mend(context, context.impact ? 0.5 : 1.0) || changed;
    if (!changed && !context.impact)
      changed = dropGhosts(context);
  }
  if (!changed)
    return Look::CONTENT;
  if (rounds_ >= MANY_ROUNDS && (worst_ <= TRACE || is_lenient_))
    return Look::CONTENT;
  if (rounds_ == MOST_ROUNDS)
    return Look::GIVEN_UP;
  ++rounds_;
  last_points_.swap(points_);
  takePoints();
  return Look::CHANGED;
}

bool ContactSet::canGoBack() const
{
  return rounds_ > 0 && !is_last_ && worst_ <= TRACE;
}

bool ContactSet::isNeeded(const ContactId& id) const
{
  const Candidate* const candidate = candidateOf(candidates_, id);
  return candidate != nullptr && std::isfinite(candidate->speed_without);
}

void ContactSet::beLenient()
{
  is_lenient_ = true;
}

void ContactSet::goBack()
{
  is_last_ = true;
  points_.swap(last_points_);
}

/** The answer's velocities and speeds. @return whether anything moves */
bool ContactSet::setAnswer(const StepContext& context, const Eigen::VectorXd& v)
{
  bool moves = false;
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    Body& body = bodies_[b];
    Ahead& ahead = ahead_[b];
    const int nv = body.model.nv;
    // Most bodies of a large scene answer as they did in the round before.
    if (!ahead.is_known || ahead.v != v.segment(body.v_offset, nv))
    {
      ahead.v = v.segment(body.v_offset, nv);
      ahead.is_known = true;
      ahead.has_moved = false;
      speeds_[b] = (nv > 0 ? pointSpeed(body, ahead.v) : 0.0) + baseSpeed(body);
    }
    moves = moves || context.dt * speeds_[b] > STILL;
  }
  return moves;
}

/** Points at q_m that the answer closes beyond zero. */
bool ContactSet::addClosing(const StepContext& context)
{
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (2.0 * context.dt * speeds_[b] > margins_[b])
    {
      detectAtMiddle(context);
      break;
    }
  const double time = context.impact ? 0.5 * context.dt : context.dt;
  bool added = false;
  for (Candidate& candidate : candidates_)
  {
    if (candidate.use != Use::IDLE)
      continue;
    const double speed = normalSpeed(candidate.point, Motion::ANSWER);
    const double missing = candidate.point.gap + time * speed;
    if (missing >= -tolerance() * sizeOf(candidate.point))
      continue;
    worst_ = std::max(worst_, -missing / sizeOf(candidate.point));
    candidate.use = Use::ROW;
    candidate.speed_without = speed;
    added = true;
  }
  return added;
}

}  // namespace frictional_contact_sim
