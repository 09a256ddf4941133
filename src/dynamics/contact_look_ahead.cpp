// Contact sets: an answer looked at with the true geometry at the poses it leads to.
#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/dynamics/contact_set.h"
#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double TOUCHING = 1e-12;  ///< a gap ahead that is zero [m]
constexpr double UNSEEN = -1.0;  ///< margin of a pair that is not looked at
constexpr double NEAR = 1e-2;  ///< times the size: of points nearer than this the deepest gets a row first
constexpr int EXTRA = 1 << 20;  ///< feature index of a second row for one pair of features, plus the round
}  // namespace

void ContactSet::moveAhead(const StepContext& context)
{
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    const Body& body = bodies_[b];
    Ahead& ahead = ahead_[b];
    margins_ahead_[b] = context.dt * speeds_[b] > STILL ? TOUCHING : UNSEEN;
    if (body.model.nv == 0 || ahead.has_moved)
      continue;
    ahead.has_moved = true;
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
  const double next = context.regime == Regime::DYNAMIC ? 1.5 : 1.0;
  const double time = (at_end ? 1.0 : context.impact ? 0.5 : next) * context.dt;
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    Ahead& ahead = ahead_[b];
    ahead.data.base_pose = basePose(bodies_[b], time);
    setLinkPoses(bodies_[b].model, at_end ? ahead.q_end : ahead.q, ahead.data);
    world_.setPoses(static_cast<int>(b), ahead.data);
  }
}

/** How deep a pair may be: as deep as it is at q_m. */
double ContactSet::allowedGap(int shape_a, int shape_b) const
{
  double deepest = 0.0;
  const auto isBefore = [&](const Candidate& candidate) {
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
  for (const ContactPoint& point : detect(margins_ahead_, true))
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
                   [](const Overlap& a, const Overlap& b) {
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
      candidate = &insert({overlap.point});
    candidate->round = rounds_ + 1;
    mended = true;
    if (candidate->use == Use::DROPPED && pairs_(overlap.point.shape_a, overlap.point.shape_b).bounces())
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
      other.point.id =
          makeContactId(row.shape_a, row.shape_b, makeFeature(FeatureKind::CURVE, EXTRA + rounds_), featureB(row.id));
      insert(other);
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
    back[side] = shape.body < 0 ? Eigen::Isometry3d::Identity()
                                : bodies_[shape.body].middle.link_pose[shape.link] *
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
  // A deformable body on what only a program moves: in a step of a thin rod the two may part by more than its size.
  const auto isAlone = [this](int handle, int other)
  {
    const int body = world_.shape(handle).body;
    const int beside = world_.shape(other).body;
    return body >= 0 && bodies_[body].model.solid && (beside < 0 || bodies_[beside].model.nv == 0);
  };
  if (isAlone(found.shape_b, found.shape_a))
    row.position = on_b;
  else if (isAlone(found.shape_a, found.shape_b) || (kind_a == FeatureKind::VERTEX && kind_b != FeatureKind::VERTEX))
    row.position = on_a;
  else if (kind_b == FeatureKind::VERTEX && kind_a != FeatureKind::VERTEX)
    row.position = on_b;
  else
    row.position = 0.5 * (on_a + on_b);
  // An estimate, for reports; the pair was looked at, and is no deeper than this.
  row.gap = std::max(found.gap + row.normal.dot(on_a - on_b), allowedGap(found.shape_a, found.shape_b));
  const double speed = normalSpeed(row, Motion::ANSWER);
  row.is_linearised = true;
  row.row_gap = missing / share - context.dt * speed;
  return row;
}

/**
 * Rows that may be ghosts lose theirs. Poses and touching_pairs_ are those of the next midpoint. A suspect's linear gap
 * there is zero, its true one c: without the row it would be gap_m + dt u + c, u of the answer that had none of it, or
 * of the start of the step; twice c allows for what the other rows do.
 */
bool ContactSet::dropGhosts(const StepContext& context)
{
  if (ghosts_tried_ || rounds_ > STRICT_ROUNDS)
    return false;
  ghosts_tried_ = true;
  const auto isSuspect = [&](const Candidate& candidate)
  {
    return candidate.use == Use::ROW && !candidate.is_kept && candidate.impulse > 0.0 &&
           candidate.point.gap > OVERLAP * sizeOf(candidate.point) && !carriedBefore(candidate.point.id) &&
           !std::binary_search(touching_pairs_.begin(), touching_pairs_.end(), candidate.point.id.shapes);
  };
  if (std::none_of(candidates_.begin(), candidates_.end(), isSuspect))
    return false;
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (margins_ahead_[b] >= 0.0)
      margins_ahead_[b] = std::max(margins_ahead_[b], context.dt * speeds_[b]);
  const std::vector<ContactPoint>& ahead = detect(margins_ahead_, true);
  bool dropped = false;
  for (Candidate& candidate : candidates_)
  {
    if (!isSuspect(candidate))
      continue;
    double gap = std::numeric_limits<double>::infinity();
    for (const ContactPoint& point : ahead)
      if (point.id.shapes == candidate.point.id.shapes)
        gap = std::min(gap, point.gap);
    const double speed = std::min(normalSpeed(candidate.point, Motion::START), candidate.speed_without);
    if (candidate.point.gap + context.dt * speed + 2.0 * gap < 0.0)
      continue;
    candidate.use = Use::DROPPED;
    dropped = true;
  }
  return dropped;
}

}  // namespace frictional_contact_sim
