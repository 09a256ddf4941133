#include "broad_phase.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
// Measured: a listed pair takes about 2 ns, and updating FCL's tree about 1 us for every moving body: the list is
// faster up to some 300 free bodies.
constexpr size_t MAX_LISTED = 50000;

bool isHalfSpace(const Bounds& bounds)
{
  return std::isinf(bounds.radius);
}

bool areNear(const Bounds& a, const Bounds& b, double margin)
{
  if (isHalfSpace(b))
    return b.normal.dot(a.center - b.center) - a.radius <= margin;
  if (isHalfSpace(a))
    return a.normal.dot(b.center - a.center) - b.radius <= margin;
  const Eigen::Vector3d difference = a.center - b.center;
  const double reach = a.radius + b.radius + margin;
  return difference.squaredNorm() <= reach * reach &&
         ((difference.cwiseAbs() - a.half_extent - b.half_extent).array() <= margin).all();
}
}  // namespace

struct BroadPhase::Allowed
{
  std::vector<ShapePair> listed;  ///< tested one by one: all for few shapes, else those with a half space
  std::vector<char> matrix;  ///< n x n, [a n + b]; empty when all are listed
  std::vector<int> bounded;  ///< handles of the shapes in the tree
  size_t shape_count = 0;
};

struct BroadPhase::Tree
{
  fcl::DynamicAABBTreeCollisionManagerd manager;
  std::vector<std::shared_ptr<fcl::Boxd>> boxes;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;

  explicit Tree(const std::vector<int>& handles)
  {
    std::vector<fcl::CollisionObjectd*> all;
    for (const int handle : handles)
    {
      boxes.push_back(std::make_shared<fcl::Boxd>(1.0, 1.0, 1.0));
      objects.push_back(std::make_unique<fcl::CollisionObjectd>(boxes.back()));
      objects.back()->setUserData(reinterpret_cast<void*>(static_cast<std::intptr_t>(handle)));
      all.push_back(objects.back().get());
    }
    manager.registerObjects(all);
    manager.setup();
  }

  static int handleOf(const fcl::CollisionObjectd* object)
  {
    return static_cast<int>(reinterpret_cast<std::intptr_t>(object->getUserData()));
  }
};

BroadPhase::BroadPhase() : allowed_(std::make_shared<Allowed>())
{
}
BroadPhase::~BroadPhase() = default;

BroadPhase::BroadPhase(const BroadPhase& other) : allowed_(other.allowed_)
{
  prepare();
}

void BroadPhase::reset(std::vector<ShapePair> pairs, const std::vector<Bounds>& bounds)
{
  const auto allowed = std::make_shared<Allowed>();
  allowed->shape_count = bounds.size();
  allowed->listed = std::move(pairs);
  std::vector<ShapePair>& listed = allowed->listed;
  if (listed.size() > MAX_LISTED)
  {
    const size_t n = bounds.size();
    allowed->matrix.assign(n * n, 0);
    for (const ShapePair& pair : listed)
      allowed->matrix[pair.a * n + pair.b] = 1;
    const auto has_no_plane = [&](const ShapePair& pair)
    { return !isHalfSpace(bounds[pair.a]) && !isHalfSpace(bounds[pair.b]); };
    listed.erase(std::remove_if(listed.begin(), listed.end(), has_no_plane), listed.end());
    for (size_t i = 0; i < n; ++i)
      if (!isHalfSpace(bounds[i]))
        allowed->bounded.push_back(static_cast<int>(i));
  }
  allowed_ = allowed;
  prepare();
}

/// The parts of one world alone: its tree, and room for what it finds.
void BroadPhase::prepare()
{
  tree_ = allowed_->matrix.empty() ? nullptr : std::make_unique<Tree>(allowed_->bounded);
  const size_t room = 16 * allowed_->shape_count;
  candidates_.clear();
  candidates_.reserve(std::min(allowed_->listed.size(), room) + room);
}

const std::vector<ShapePair>& BroadPhase::candidates(const std::vector<Bounds>& bounds, double margin)
{
  candidates_.clear();
  for (const ShapePair& pair : allowed_->listed)
    if (areNear(bounds[pair.a], bounds[pair.b], margin))
      candidates_.push_back(pair);
  if (!tree_)
    return candidates_;
  for (size_t k = 0; k < tree_->objects.size(); ++k)
  {
    // The objects stay at the identity: their local box is the world's, widened by half the margin.
    const Bounds& box = bounds[Tree::handleOf(tree_->objects[k].get())];
    const Eigen::Vector3d reach = box.half_extent.array() + 0.5 * margin;
    tree_->boxes[k]->aabb_local.min_ = box.center - reach;
    tree_->boxes[k]->aabb_local.max_ = box.center + reach;
    tree_->objects[k]->computeAABB();
  }
  tree_->manager.update();
  struct Query
  {
    const Allowed& allowed;
    const std::vector<Bounds>& bounds;
    double margin;
    std::vector<ShapePair>& found;
  } query{*allowed_, bounds, margin, candidates_};
  tree_->manager.collide(
      &query,
      [](fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* data)
      {
        Query& q = *static_cast<Query*>(data);
        const size_t n = q.allowed.shape_count;
        const int i = Tree::handleOf(first);
        const int k = Tree::handleOf(second);
        const bool ik = q.allowed.matrix[i * n + k] != 0;
        const bool ki = q.allowed.matrix[k * n + i] != 0;
        if ((ik || ki) && areNear(q.bounds[i], q.bounds[k], q.margin))
          q.found.push_back(ik ? ShapePair{i, k} : ShapePair{k, i});
        return false;
      });
  std::sort(candidates_.begin(), candidates_.end(),
            [](const ShapePair& p, const ShapePair& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  return candidates_;
}

}  // namespace frictional_contact_sim
