#include "broad_phase.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace frictional_contact_sim
{
namespace
{
/// AUTO: from this many bounded shapes on FCL's trees look, see docs/large_scenes.md.
constexpr size_t FEWEST_FOR_TREES = 100;
/// Room in a fat box: the larger of this share of the shape's least half extent...
constexpr double ROOM_OF_SIZE = 0.1;
/// ... and so many margins: the margin of a moving shape is some two steps of its travel.
constexpr double ROOM_OF_MARGIN = 4.0;
/// Fat boxes are wider than they need be by this share of the coordinates, so that no round-off loses a pair.
constexpr double ROUND_OFF = 1e-12;
/// When more than this share of the shapes has left, all are renewed: then they leave together again.
constexpr double SHARE_OF_ALL = 0.125;
/// Refits of a tree before its leaves are put in anew.
constexpr int MOST_REFITS = 8;

bool isHalfSpace(const Bounds& bounds)
{
  return std::isinf(bounds.radius);
}

bool isNearPlane(const Bounds& shape, const Bounds& plane, double margin)
{
  const double height = plane.normal.dot(shape.center - plane.center);
  return height - shape.radius <= margin && height - plane.normal.cwiseAbs().dot(shape.half_extent) <= margin;
}

bool areNear(const Bounds& a, const Bounds& b)
{
  const double margin = std::max(a.margin, b.margin);
  if (margin < 0.0)
    return false;
  if (isHalfSpace(b))
    return isNearPlane(a, b, margin);
  if (isHalfSpace(a))
    return isNearPlane(b, a, margin);
  const Eigen::Vector3d difference = a.center - b.center;
  const double reach = a.radius + b.radius + margin;
  return difference.squaredNorm() <= reach * reach &&
         ((difference.cwiseAbs() - a.half_extent - b.half_extent).array() <= margin).all();
}

bool isBefore(const ShapePair& p, const ShapePair& q)
{
  return p.a != q.a ? p.a < q.a : p.b < q.b;
}
}  // namespace

void BroadPhase::clear()
{
  is_ready_ = false;
  is_searched_ = false;
  kept_.clear();
}

/// Everything that depends on the shapes and their rule; all fat boxes are still to be made.
void BroadPhase::prepare(const std::vector<Bounds>& bounds, const PairRule& rule)
{
  const int count = static_cast<int>(bounds.size());
  clear();
  bounded_.clear();
  planes_.clear();
  for (const bool immobile : {false, true})
  {
    for (int i = 0; i < count; ++i)
      if (!isHalfSpace(bounds[i]) && rule.isImmobile(i) == immobile)
        bounded_.push_back(i);
    if (!immobile)
      moving_ = bounded_.size();
  }
  for (int i = 0; i < count; ++i)
    if (isHalfSpace(bounds[i]))
      planes_.push_back({i});
  boxes_.resize(bounds.size());
  has_left_.assign(bounds.size(), 0);
  for (const int handle : bounded_)
    fatten(handle, bounds[handle]);
  moving_tree_.reset();
  resting_tree_.reset();
  if (kind_ == BroadPhaseKind::FCL || (kind_ == BroadPhaseKind::AUTO && bounded_.size() >= FEWEST_FOR_TREES))
  {
    const auto middle = bounded_.begin() + static_cast<std::ptrdiff_t>(moving_);
    moving_tree_ = std::make_unique<BoxTree>(std::vector<int>(bounded_.begin(), middle), boxes_);
    resting_tree_ = std::make_unique<BoxTree>(std::vector<int>(middle, bounded_.end()), boxes_);
  }
  left_.reserve(bounded_.size());
  const size_t room = 16 * bounds.size();
  for (std::vector<ShapePair>* pairs : {&kept_, &added_, &merged_, &candidates_})
    pairs->reserve(room);
  found_.reserve(2 * room);
  is_ready_ = true;
}

/// Fat boxes must hold the box widened by its margin: boxes within the larger of two margins then overlap.
void BroadPhase::findLeft(const std::vector<Bounds>& bounds)
{
  left_.clear();
  for (const int handle : bounded_)
  {
    const Bounds& now = bounds[handle];
    const AxisBox& fat = boxes_[handle];
    const Eigen::Vector3d reach = now.half_extent.array() + now.widening();
    // Written so that a NaN has left.
    if (!((now.center - reach).array() >= fat.lower.array()).all() ||
        !((now.center + reach).array() <= fat.upper.array()).all())
      left_.push_back(handle);
  }
  const bool planes_moved =
      std::any_of(planes_.begin(), planes_.end(),
                  [&](const Plane& plane)
                  {
                    const Bounds& now = bounds[plane.handle];
                    return now.normal != plane.normal || now.center != plane.point || !(now.widening() <= plane.margin);
                  });
  if (!is_searched_ || planes_moved ||
      static_cast<double>(left_.size()) > SHARE_OF_ALL * static_cast<double>(bounded_.size()))
    left_ = bounded_;
}

void BroadPhase::fatten(int handle, const Bounds& bounds)
{
  const double room = std::max(ROOM_OF_SIZE * bounds.half_extent.minCoeff(), ROOM_OF_MARGIN * bounds.widening());
  const Eigen::Vector3d reach = bounds.half_extent.array() + (bounds.widening() + room);
  const Eigen::Vector3d round_off = ROUND_OFF * (bounds.center.cwiseAbs() + reach);
  boxes_[handle] = {bounds.center - reach - round_off, bounds.center + reach + round_off};
}

/// Of two shapes that have left, the later one of bounded_ is looked for by the earlier one.
void BroadPhase::consider(int handle, int other, const PairRule& rule)
{
  const bool is_earlier = rule.isImmobile(handle) == rule.isImmobile(other) ? handle < other : rule.isImmobile(other);
  if ((!has_left_[other] || is_earlier) && overlap(boxes_[handle], boxes_[other]))
    keep(handle, other, rule);
}

void BroadPhase::keep(int i, int k, const PairRule& rule)
{
  if (!rule.mayCollide(i, k))
    return;
  const bool swapped = rule.isStatic(i) || (i > k && !rule.isStatic(k));
  added_.push_back(swapped ? ShapePair{k, i} : ShapePair{i, k});
}

/// New fat boxes for the shapes that have left, and the pairs they are in.
void BroadPhase::renew(const std::vector<Bounds>& bounds, const PairRule& rule)
{
  for (const int handle : left_)
  {
    fatten(handle, bounds[handle]);
    has_left_[handle] = 1;
  }
  kept_.erase(std::remove_if(kept_.begin(), kept_.end(),
                             [&](const ShapePair& pair) { return has_left_[pair.a] || has_left_[pair.b]; }),
              kept_.end());
  added_.clear();
  searchPlanes(bounds, rule);
  if (moving_tree_)
    searchTrees(rule);
  else
    searchList(rule);
  sortAdded();
  merged_.resize(kept_.size() + added_.size());
  std::merge(kept_.begin(), kept_.end(), added_.begin(), added_.end(), merged_.begin(), isBefore);
  std::swap(kept_, merged_);
  for (const int handle : left_)
    has_left_[handle] = 0;
  is_searched_ = true;
}

/// By a with one count a handle, then the few of each a by b: linear, where a sort would cost more than the search.
void BroadPhase::sortAdded()
{
  if (std::is_sorted(added_.begin(), added_.end(), isBefore))
    return;
  begin_.assign(boxes_.size() + 1, 0);
  for (const ShapePair& pair : added_)
    ++begin_[pair.a + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  merged_.resize(added_.size());
  for (const ShapePair& pair : added_)
    merged_[begin_[pair.a]++] = pair;
  // begin_[a] is now the end of a's pairs
  int first = 0;
  for (const int last : begin_)
  {
    std::sort(merged_.begin() + first, merged_.begin() + last, isBefore);
    first = last;
  }
  std::swap(added_, merged_);
}

/// One by one.
void BroadPhase::searchList(const PairRule& rule)
{
  const bool all = left_.size() == bounded_.size();
  for (size_t i = 0; i < (all ? moving_ : left_.size()); ++i)
  {
    const int handle = left_[i];
    const size_t end = rule.isImmobile(handle) ? moving_ : bounded_.size();
    for (size_t k = all ? i + 1 : 0; k < end; ++k)
      consider(handle, bounded_[k], rule);
  }
}

void BroadPhase::searchTrees(const PairRule& rule)
{
  const bool all = left_.size() == bounded_.size();
  if (all && ++refits_ < MOST_REFITS)
    moving_tree_->refit(boxes_);
  else
    moving_tree_->update(left_, boxes_);
  resting_tree_->update(left_, boxes_);
  if (all)
  {
    refits_ %= MOST_REFITS;
    found_.clear();
    moving_tree_->findAll(found_);
    for (size_t k = 0; k < found_.size(); k += 2)
      consider(std::min(found_[k], found_[k + 1]), std::max(found_[k], found_[k + 1]), rule);
  }
  for (const int handle : left_)
  {
    found_.clear();
    const bool immobile = rule.isImmobile(handle);
    if (!all)
      moving_tree_->find(boxes_[handle], found_);
    if (!immobile)
      resting_tree_->find(boxes_[handle], found_);
    for (const int other : found_)
      if (other != handle)
        consider(handle, other, rule);
  }
}

/// Half spaces have no box: all shapes that have left against each.
void BroadPhase::searchPlanes(const std::vector<Bounds>& bounds, const PairRule& rule)
{
  for (Plane& plane : planes_)
  {
    const Bounds& now = bounds[plane.handle];
    if (left_.size() == bounded_.size())
      plane = {plane.handle, now.normal, now.center, 2.0 * now.widening()};
    for (const int handle : left_)
    {
      const AxisBox& box = boxes_[handle];
      const Eigen::Vector3d reach = 0.5 * (box.upper - box.lower);
      const double height = plane.normal.dot(box.lower + reach - plane.point);
      if (height - plane.normal.cwiseAbs().dot(reach) <= plane.margin)
        keep(handle, plane.handle, rule);
    }
  }
}

const std::vector<ShapePair>& BroadPhase::candidates(const std::vector<Bounds>& bounds, const PairRule& rule)
{
  if (!is_ready_)
    prepare(bounds, rule);
  findLeft(bounds);
  if (!left_.empty())
    renew(bounds, rule);
  candidates_.clear();
  for (const ShapePair& pair : kept_)
    if (areNear(bounds[pair.a], bounds[pair.b]))
      candidates_.push_back(pair);
  return candidates_;
}

}  // namespace frictional_contact_sim
