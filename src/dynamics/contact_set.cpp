#include "frictional_contact_sim/dynamics/contact_set.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/collision/convex_shape.h"
#include "frictional_contact_sim/dynamics/contact_rows.h"
#include "frictional_contact_sim/dynamics/row_source.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double MINIMUM_MARGIN = 1e-3;  ///< contacts nearer than this are always known [m]
constexpr double CLOSING_MARGIN = 2.0;  ///< times what the free motion closes of a gap: forces of other rows may add
constexpr double OVERLAP = 1e-9;  ///< times the size: what may go through
constexpr int STRICT_ROUNDS = 2;  ///< with every round after these more may: crossing edges converge slowly
constexpr double LOOSER = 100.0;  ///< each of them
constexpr double LOOSEST = 1e-5;
constexpr double STILL = 1e-12;  ///< what moves less than this in a step closes no gap [m]
constexpr double TOUCHING = 1e-12;  ///< a gap ahead that is zero [m]
constexpr double NEAR = 1e-2;  ///< times the size: of points nearer than this the deepest gets a row first
constexpr int EXTRA = 1 << 20;  ///< feature index of a second row for one pair of features, plus the round
constexpr int MOST_ROUNDS = 10;
constexpr double TRACE = 1e-4;  ///< times the size: left after the most rounds, it is the next step's to mend
constexpr double UNSEEN = -1.0;  ///< margin of a pair that is not looked at

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
}  // namespace

ContactSet::Ahead::Ahead(const Body& body)
  : v(body.state.v), q_end(body.state.q), v_end(body.state.v), q(body.state.q), data(body.model.tree)
{
}

ContactSet::ContactSet(std::vector<Body>& bodies, CollisionWorld& world, const PairTable& pairs,
                       const std::vector<ContactState>& last)
  : bodies_(bodies), world_(world), pairs_(pairs), last_(last)
{
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
  return std::min(world_.convexShape(point.shape_a).bounding_radius, world_.convexShape(point.shape_b).bounding_radius);
}

/** Of the points of a prescribed base [m/s]. */
double ContactSet::baseSpeed(const Body& body)
{
  const BaseMotion& motion = body.model.base_motion;
  if (!motion.active)
    return 0.0;
  double reach = 0.0;
  const Eigen::Vector3d origin = body.middle.link_pose.front().translation();
  for (size_t link = 0; link < body.middle.link_pose.size(); ++link)
    reach =
        std::max(reach, (body.middle.link_pose[link].translation() - origin).norm() + body.model.extents[link]);
  return motion.linear.norm() + motion.angular.norm() * reach;
}

/** Of a relative to b along the normal, with moving bases; `velocities` gives the nv velocities of a body. */
template <class Velocities>
double ContactSet::normalSpeed(const ContactPoint& point, const Velocities& velocities) const
{
  double speed = 0.0;
  for (const int side : {0, 1})
  {
    const ShapeInfo& shape = world_.shape(side == 0 ? point.shape_a : point.shape_b);
    if (shape.body < 0)
      continue;
    const Body& body = bodies_[shape.body];
    double along = alongNormal(body, shape.link, point.position, point.normal, velocities(shape.body));
    if (body.model.base_motion.active)
      along += point.normal.dot(baseVelocity(bodies_, shape, point.position));
    speed += side == 0 ? along : -along;
  }
  return speed;
}

bool ContactSet::mayClose(const StepContext& context, const ContactPoint& point) const
{
  if (point.gap <= CONTACT_GAP || context.normal_law.form == ContactLawForm::VELOCITY || carriedBefore(point.id))
    return true;
  const double start =
      normalSpeed(point, [this](int body) -> const Eigen::VectorXd& { return bodies_[body].v_start; });
  const double free =
      context.impact ?
          start :
          normalSpeed(point, [this](int body) -> const Eigen::VectorXd& { return bodies_[body].v_free; });
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
  for (const ContactPoint& point : world_.detect(margins_))
    addCandidate(point, Use::IDLE);
  sortCandidates();
}

/** At the end of the list; of two with one id sortCandidates keeps the first. */
void ContactSet::addCandidate(const ContactPoint& point, Use use)
{
  candidates_.push_back({point, use});
}

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
  const auto found = std::lower_bound(candidates_.begin(), candidates_.end(), id,
                                      [](const Candidate& a, const ContactId& b) { return a.point.id < b; });
  return found != candidates_.end() && found->point.id == id ? &*found : nullptr;
}

const std::vector<ContactPoint>& ContactSet::find(const StepContext& context)
{
  rounds_ = 0;
  ghosts_tried_ = is_last_ = false;
  carried_.clear();
  for (const ContactState& contact : last_)
    if (!contact.impulse.isZero(0.0))
      carried_.push_back(contact.id);
  std::sort(carried_.begin(), carried_.end());
  for (size_t b = 0; b < bodies_.size(); ++b)
    speeds_[b] = (bodies_[b].model.tree.nv > 0 ? bodies_[b].speed : 0.0) + baseSpeed(bodies_[b]);
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
    if (!context.impact)
    {
      setPosesAhead(context, true);
      changed = mend(context, 0.5);
    }
    setPosesAhead(context, false);
    changed = mend(context, context.impact ? 0.5 : 1.0) || changed;
    if (!changed && !context.impact)
      changed = dropGhosts();
  }
  if (!changed)
    return Look::CONTENT;
  if (rounds_ == MOST_ROUNDS)
    return worst_ > TRACE ? Look::GIVEN_UP : Look::CONTENT;
  ++rounds_;
  last_points_.swap(points_);
  takePoints();
  return Look::CHANGED;
}

bool ContactSet::canGoBack() const
{
  return rounds_ > 0 && !is_last_ && worst_ <= TRACE;
}

void ContactSet::stopLooking()
{
  is_last_ = true;
}

void ContactSet::goBack()
{
  stopLooking();
  points_.swap(last_points_);
}

/** The answer's velocities and speeds. @return whether anything moves */
bool ContactSet::setAnswer(const StepContext& context, const Eigen::VectorXd& v)
{
  bool moves = false;
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    Body& body = bodies_[b];
    const int nv = body.model.tree.nv;
    ahead_[b].v = v.segment(body.v_offset, nv);
    speeds_[b] = (nv > 0 ? pointSpeed(body, ahead_[b].v) : 0.0) + baseSpeed(body);
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
    const double speed =
        normalSpeed(candidate.point, [this](int body) -> const Eigen::VectorXd& { return ahead_[body].v; });
    const double missing = candidate.point.gap + time * speed;
    if (missing >= -tolerance() * sizeOf(candidate.point))
      continue;
    worst_ = std::max(worst_, -missing / sizeOf(candidate.point));
    candidate.use = Use::ROW;
    added = true;
  }
  return added;
}

void ContactSet::moveAhead(const StepContext& context)
{
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    const Body& body = bodies_[b];
    Ahead& ahead = ahead_[b];
    margins_ahead_[b] = context.dt * speeds_[b] > STILL ? TOUCHING : UNSEEN;
    if (body.model.tree.nv == 0)
      continue;
    if (context.impact)
    {
      moveHalfStep(body, body.state.q, ahead.v, context.dt, ahead.q);
      continue;
    }
    moveStep(body, ahead.v, context.dt, ahead.q_end, ahead.v_end);
    moveHalfStep(body, ahead.q_end, ahead.v_end, context.dt, ahead.q);
  }
}

void ContactSet::setPosesAhead(const StepContext& context, bool at_end)
{
  const double time = (at_end ? 1.0 : context.impact ? 0.5 : 1.5) * context.dt;
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    Ahead& ahead = ahead_[b];
    ahead.data.base_pose = basePose(bodies_[b], time);
    forwardKinematics(bodies_[b].model.tree, at_end ? ahead.q_end : ahead.q, ahead.data);
    world_.setPoses(static_cast<int>(b), ahead.data);
  }
}

/** How deep a pair may be: as deep as it is at q_m. */
double ContactSet::allowedGap(int shape_a, int shape_b) const
{
  double deepest = 0.0;
  const auto isBefore = [&](const Candidate& candidate)
  {
    return candidate.point.shape_a != shape_a ? candidate.point.shape_a < shape_a : candidate.point.shape_b < shape_b;
  };
  const auto first = std::partition_point(candidates_.begin(), candidates_.end(), isBefore);
  for (auto candidate = first; candidate != candidates_.end(); ++candidate)
  {
    if (candidate->point.shape_a != shape_a || candidate->point.shape_b != shape_b)
      break;
    if (candidate->use != Use::LINEARISED)
      deepest = std::min(deepest, candidate->point.gap);
  }
  return deepest;
}

/** What overlaps at the poses set, by pair, the deepest first. */
void ContactSet::findOverlaps()
{
  touching_pairs_.clear();
  overlaps_.clear();
  for (const ContactPoint& point : world_.detect(margins_ahead_))
  {
    if (touching_pairs_.empty() || touching_pairs_.back() != point.id.shapes)
      touching_pairs_.push_back(point.id.shapes);
    const double most = tolerance() * sizeOf(point);
    if (point.gap >= -most)
      continue;
    const double missing = point.gap - allowedGap(point.shape_a, point.shape_b);
    if (missing < -most)
      overlaps_.push_back({point, missing});
  }
  std::stable_sort(overlaps_.begin(), overlaps_.end(),
                   [](const Overlap& a, const Overlap& b)
                   {
                     return a.point.id.shapes != b.point.id.shapes ? a.point.id.shapes < b.point.id.shapes
                                                                   : a.missing < b.missing;
                   });
}

/** Rows for what overlaps at the poses set. @param share of the step from q_m to them */
bool ContactSet::mend(const StepContext& context, double share)
{
  findOverlaps();
  bool mended = false;
  size_t first = 0;  // of the pair
  for (size_t i = 0; i < overlaps_.size(); ++i)
  {
    const Overlap& overlap = overlaps_[i];
    if (overlap.point.id.shapes != overlaps_[first].point.id.shapes)
      first = i;
    const double size = sizeOf(overlap.point);
    Candidate* candidate = known(overlap.point.id);
    if (candidate != nullptr && (candidate->use == Use::HOPELESS || candidate->round == rounds_ + 1))
      continue;
    worst_ = std::max(worst_, -overlap.missing / size);
    const bool has_row = candidate != nullptr && (candidate->use == Use::ROW || candidate->use == Use::LINEARISED);
    const auto isNear = [&](const Overlap& other)
    { return (other.point.position - overlap.point.position).norm() < NEAR * size; };
    if (!has_row && std::any_of(overlaps_.begin() + static_cast<std::ptrdiff_t>(first),
                                overlaps_.begin() + static_cast<std::ptrdiff_t>(i), isNear))
      continue;  // a deeper one beside it speaks for it
    if (candidate == nullptr)
    {
      addCandidate(overlap.point, Use::IDLE);
      sortCandidates();
      candidate = known(overlap.point.id);
    }
    candidate->round = rounds_ + 1;
    mended = true;
    if (candidate->use == Use::DROPPED && pairs_(overlap.point.shape_a, overlap.point.shape_b).restitution > 0.0)
    {
      candidate->use = Use::ROW;
      candidate->is_kept = true;
      continue;
    }
    const ContactPoint row = linearised(context, overlap.point, overlap.missing, share);
    if (candidate->use == Use::LINEARISED && (row.position - candidate->point.position).norm() > NEAR * size)
    {
      // The crossing of two nearly parallel edges runs along them: it needs rows at both places.
      Candidate other = *candidate;
      other.point.id = makeContactId(row.shape_a, row.shape_b, makeFeature(FeatureKind::CURVE, EXTRA + rounds_),
                                     featureB(row.id));
      candidates_.push_back(other);
      sortCandidates();
      candidate = known(row.id);
    }
    candidate->point = row;
    candidate->use = Use::LINEARISED;
  }
  return mended;
}

/** A point found ahead as a row at q_m; see the head of contact_set.h. */
ContactPoint ContactSet::linearised(const StepContext& context, const ContactPoint& found, double missing,
                                    double share) const
{
  ContactPoint row = found;
  Eigen::Isometry3d back[2];  // from the pose ahead to q_m
  for (const int side : {0, 1})
  {
    const ShapeInfo& shape = world_.shape(side == 0 ? found.shape_a : found.shape_b);
    back[side] = shape.body < 0 ? Eigen::Isometry3d::Identity() :
                                  bodies_[shape.body].middle.link_pose[shape.link] *
                                      ahead_[shape.body].data.link_pose[shape.link].inverse(Eigen::Isometry);
  }
  const FeatureKind kind_a = kindOf(featureA(found.id));
  const FeatureKind kind_b = kindOf(featureB(found.id));
  if (kind_b == FeatureKind::FACE)
    row.normal = back[1].linear() * found.normal;
  else if (kind_a == FeatureKind::FACE)
    row.normal = back[0].linear() * found.normal;
  const Eigen::Vector3d on_a = back[0] * found.position;
  const Eigen::Vector3d on_b = back[1] * found.position;
  if (kind_a == FeatureKind::VERTEX && kind_b != FeatureKind::VERTEX)
    row.position = on_a;
  else if (kind_b == FeatureKind::VERTEX && kind_a != FeatureKind::VERTEX)
    row.position = on_b;
  else
    row.position = 0.5 * (on_a + on_b);
  // An estimate, for reports; the pair was looked at, and is no deeper than this.
  row.gap = std::max(found.gap + row.normal.dot(on_a - on_b), allowedGap(found.shape_a, found.shape_b));
  const double speed = normalSpeed(row, [this](int body) -> const Eigen::VectorXd& { return ahead_[body].v; });
  row.is_linearised = true;
  row.row_gap = missing / share - context.dt * speed;
  return row;
}

/** Rows that may be ghosts lose theirs. Poses and touching_pairs_ are those of the next midpoint. */
bool ContactSet::dropGhosts()
{
  if (ghosts_tried_ || rounds_ > STRICT_ROUNDS)
    return false;
  ghosts_tried_ = true;
  bool dropped = false;
  for (Candidate& candidate : candidates_)
    if (candidate.use == Use::ROW && !candidate.is_kept && candidate.impulse > 0.0 &&
        candidate.point.gap > OVERLAP * sizeOf(candidate.point) && !carriedBefore(candidate.point.id) &&
        !std::binary_search(touching_pairs_.begin(), touching_pairs_.end(), candidate.point.id.shapes))
    {
      candidate.use = Use::DROPPED;
      dropped = true;
    }
  return dropped;
}

}  // namespace frictional_contact_sim
