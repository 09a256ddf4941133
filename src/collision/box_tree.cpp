#include "box_tree.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include <algorithm>
#include <cstdint>

namespace frictional_contact_sim
{
namespace
{
int handleOf(const fcl::CollisionObjectd* object)
{
  return static_cast<int>(reinterpret_cast<std::intptr_t>(object->getUserData()));
}
}  // namespace

struct BoxTree::Impl
{
  fcl::DynamicAABBTreeCollisionManagerd manager;
  std::vector<std::shared_ptr<fcl::Boxd>> boxes;  ///< by handle, null outside the tree
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  std::vector<fcl::CollisionObjectd*> changed;

  std::shared_ptr<fcl::Boxd> probe_box = std::make_shared<fcl::Boxd>(1.0, 1.0, 1.0);
  fcl::CollisionObjectd probe{probe_box};

  Impl() { probe.setUserData(reinterpret_cast<void*>(static_cast<std::intptr_t>(-1))); }

  /// The objects stay at the identity: their local box is the world's. What has run away must not spoil the tree.
  static void set(const AxisBox& box, fcl::Boxd& geometry, fcl::CollisionObjectd& object)
  {
    const bool finite = box.lower.allFinite() && box.upper.allFinite();
    geometry.aabb_local.min_ = finite ? box.lower : Eigen::Vector3d::Zero();
    geometry.aabb_local.max_ = finite ? box.upper : Eigen::Vector3d::Zero();
    object.computeAABB();
  }

  void set(int handle, const AxisBox& box) { set(box, *boxes[handle], *objects[handle]); }
};

BoxTree::BoxTree(const std::vector<int>& members, const std::vector<AxisBox>& boxes) : impl_(std::make_unique<Impl>())
{
  impl_->boxes.resize(boxes.size());
  impl_->objects.resize(boxes.size());
  for (const int handle : members)
  {
    impl_->boxes[handle] = std::make_shared<fcl::Boxd>(1.0, 1.0, 1.0);
    std::unique_ptr<fcl::CollisionObjectd>& object = impl_->objects[handle];
    object = std::make_unique<fcl::CollisionObjectd>(impl_->boxes[handle]);
    object->setUserData(reinterpret_cast<void*>(static_cast<std::intptr_t>(handle)));
    impl_->set(handle, boxes[handle]);
    impl_->changed.push_back(object.get());
  }
  impl_->manager.registerObjects(impl_->changed);
  impl_->manager.setup();
}

BoxTree::~BoxTree() = default;

void BoxTree::update(const std::vector<int>& changed, const std::vector<AxisBox>& boxes)
{
  impl_->changed.clear();
  for (const int handle : changed)
    if (impl_->objects[handle])
    {
      impl_->set(handle, boxes[handle]);
      impl_->changed.push_back(impl_->objects[handle].get());
    }
  if (!impl_->changed.empty())
    impl_->manager.update(impl_->changed);
}

void BoxTree::refit(const std::vector<AxisBox>& boxes)
{
  for (size_t handle = 0; handle < boxes.size(); ++handle)
    if (impl_->objects[handle])
      impl_->set(static_cast<int>(handle), boxes[handle]);
  impl_->manager.update();
}

void BoxTree::find(const AxisBox& box, std::vector<int>& found)
{
  if (impl_->manager.empty())
    return;
  Impl::set(box, *impl_->probe_box, impl_->probe);
  impl_->manager.collide(&impl_->probe, &found,
                         [](fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* data)
                         {
                           const int handle = std::max(handleOf(first), handleOf(second));  // the probe's is -1
                           static_cast<std::vector<int>*>(data)->push_back(handle);
                           return false;
                         });
}

void BoxTree::findAll(std::vector<int>& found) const
{
  impl_->manager.collide(
      &found,
      [](fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* data)
      {
        auto& pairs = *static_cast<std::vector<int>*>(data);
        pairs.push_back(handleOf(first));
        pairs.push_back(handleOf(second));
        return false;
      });
}

}  // namespace frictional_contact_sim
