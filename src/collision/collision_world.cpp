#include "frictional_contact_sim/collision/collision_world.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "frictional_contact_sim/collision/narrow_phase.h"
#include "mesh_library.h"
#include "oriented_boxes.h"
#include "shape_model.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double OVERLAP_GAP = -1e-9;  // [m] less is an overlap of the initial pose, not a touch

void insert(std::vector<std::array<int, 2>>& sorted, const std::array<int, 2>& pair)
{
  const auto place = std::lower_bound(sorted.begin(), sorted.end(), pair);
  if (place == sorted.end() || *place != pair)
    sorted.insert(place, pair);
}
}  // namespace

struct CollisionWorld::Impl
{
  std::shared_ptr<const ShapeModel> model = std::make_shared<ShapeModel>();
  MeshLibrary meshes;  ///< copies know what has been read, and read more for themselves
  std::vector<Eigen::Isometry3d> poses;  ///< of the shapes, world
  std::vector<Bounds> bounds;
  std::vector<int> rigid_sets;  ///< shapes, or empty
  BroadPhase broad_phase;
  Manifold manifold;
  std::vector<ContactPoint> contacts;

  Impl() = default;
  Impl(const Impl& other)
    : model(other.model)
    , meshes(other.meshes)
    , poses(other.poses)
    , bounds(other.bounds)
    , rigid_sets(other.rigid_sets)
    , broad_phase(other.broad_phase)
  {
    manifold.reserve(2 * model->most_vertices);
  }

  /// To load something: a model that is shared is copied first.
  ShapeModel& edit()
  {
    broad_phase.clear();
    if (model.use_count() > 1)
      model = std::make_shared<ShapeModel>(*model);
    return const_cast<ShapeModel&>(*model);  // nobody else has it
  }

  int addInstance(Instance instance, ShapeInfo info)
  {
    ShapeModel& shapes = edit();
    shapes.most_vertices = std::max(shapes.most_vertices, instance.shape.core.vertices.size());
    manifold.reserve(2 * shapes.most_vertices);
    shapes.instances.push_back(std::move(instance));
    shapes.infos.push_back(std::move(info));
    poses.push_back(Eigen::Isometry3d::Identity());
    bounds.emplace_back();
    return static_cast<int>(poses.size()) - 1;
  }

  /// See ShapeModel::arrange. Which shapes are rigid sets has to be said anew.
  void arrange(const std::vector<int>& old_handles)
  {
    edit().arrange(old_handles);
    const std::vector<Eigen::Isometry3d> old_poses = poses;
    const std::vector<Bounds> old_bounds = bounds;
    poses.clear();
    bounds.clear();
    for (const int old : old_handles)
    {
      poses.push_back(old_poses[old]);
      bounds.push_back(old_bounds[old]);
    }
    rigid_sets.clear();
  }

  void setPose(int handle, const Eigen::Isometry3d& pose)
  {
    const ConvexShape& shape = model->instances[handle].shape;
    poses[handle] = pose;
    Bounds& box = bounds[handle];
    box.radius = shape.bounding_radius;
    box.normal = pose.linear().col(2);
    box.center = pose * shape.center;
    box.half_extent = shape.half_extent;
    if (shape.kind != ShapeKind::HALF_SPACE)
      box.half_extent = pose.linear().cwiseAbs() * shape.half_extent;
  }

  /// Pairs within their margins, see Bounds::margin.
  const std::vector<ShapePair>& candidates() { return broad_phase.candidates(bounds, *model); }

  /// Fills the manifold of a pair, in the frame of b.
  void collidePair(const ShapePair& pair, double margin)
  {
    const Eigen::Isometry3d a_in_b = poses[pair.b].inverse(Eigen::Isometry) * poses[pair.a];
    const ConvexShape& a = model->instances[pair.a].shape;
    const ConvexShape& b = model->instances[pair.b].shape;
    manifold.count = 0;
    // a ball is quicker looked at than boxed
    const bool has_ball = a.kind == ShapeKind::SPHERE || b.kind == ShapeKind::SPHERE;
    if (has_ball || !boxesAreApart(a, b, a_in_b, margin))
      collide(a, b, a_in_b, margin, manifold);
  }

  /// Adds the points of a pair, in the world.
  void addPair(const ShapePair& pair, double margin)
  {
    collidePair(pair, margin);
    const Eigen::Isometry3d& pose = poses[pair.b];
    for (int i = 0; i < manifold.count; ++i)
    {
      const PairContact& point = manifold.points[i];
      contacts.push_back({makeContactId(pair.a, pair.b, point.feature_a, point.feature_b), pair.a, pair.b,
                          pose * point.position, pose.linear() * point.normal, point.gap});
    }
  }

  const std::vector<ContactPoint>& detect()
  {
    contacts.clear();
    for (const ShapePair& pair : candidates())
      if (rigid_sets.empty() || rigid_sets[pair.a] != rigid_sets[pair.b])
        addPair(pair, std::max(bounds[pair.a].margin, bounds[pair.b].margin));
    return contacts;
  }

  const CollidingBody& body(int index) const
  {
    const std::vector<CollidingBody>& bodies = model->bodies;
    if (index < 0 || index >= static_cast<int>(bodies.size()))
    {
      throw std::invalid_argument("collision: no body " + std::to_string(index) + ", there are " +
                                  std::to_string(bodies.size()));
    }
    return bodies[index];
  }
};

CollisionWorld::CollisionWorld() : impl_(std::make_unique<Impl>())
{
}
CollisionWorld::~CollisionWorld() = default;
CollisionWorld::CollisionWorld(const CollisionWorld& other) : impl_(std::make_unique<Impl>(*other.impl_))
{
}
CollisionWorld& CollisionWorld::operator=(const CollisionWorld& other)
{
  impl_ = std::make_unique<Impl>(*other.impl_);
  return *this;
}
CollisionWorld::CollisionWorld(CollisionWorld&&) noexcept = default;
CollisionWorld& CollisionWorld::operator=(CollisionWorld&&) noexcept = default;

int CollisionWorld::addBody(const MultibodyModel& model, std::vector<std::string>* warnings)
{
  const int index = static_cast<int>(impl_->model->bodies.size());
  CollidingBody body;
  body.is_mounted = model.joints.front().type == JointType::FIXED &&
                    std::none_of(model.joints.begin(), model.joints.end(),
                                 [](const Joint& joint) { return joint.type == JointType::FLOATING; });
  for (const Joint& joint : model.joints)
    body.parent.push_back(joint.parent);
  for (const Frame& frame : model.frames)
    body.frame_names.push_back(frame.name);
  // all meshes first: when one cannot be read the world stays as it was
  std::vector<std::vector<ConvexShape>> parts;
  for (const CollisionShape& shape : model.shapes)
    parts.push_back(impl_->meshes.shapesOf(shape.geometry, body.frame_names.at(shape.frame), warnings));
  for (size_t k = 0; k < parts.size(); ++k)
  {
    const CollisionShape& shape = model.shapes[k];
    const Joint& joint = model.joints[shape.link];
    const bool is_immobile = joint.type == JointType::FIXED && joint.parent < 0;
    for (ConvexShape& part : parts[k])
    {
      const int handle = impl_->addInstance(
          {std::move(part), shape.placement, is_immobile},
          {index, shape.link, shape.frame, static_cast<int>(k), body.frame_names.at(shape.frame), shape.name});
      body.shapes.push_back(handle);
      impl_->setPose(handle, shape.placement);
    }
  }
  impl_->edit().bodies.push_back(std::move(body));
  return index;
}

int CollisionWorld::addStatic(const Geometry& geometry, const Eigen::Isometry3d& pose, const std::string& name)
{
  Instance instance;
  instance.shape = makeShape(geometry);
  instance.placement = pose;
  instance.is_immobile = true;
  const int handle = impl_->addInstance(std::move(instance), {-1, -1, -1, -1, name, name});
  impl_->setPose(handle, pose);
  return handle;
}

void CollisionWorld::disablePair(int body, const std::string& link_1, const std::string& link_2)
{
  const std::vector<std::string>& names = impl_->body(body).frame_names;
  std::array<int, 2> frames;
  for (int k = 0; k < 2; ++k)
  {
    const std::string& link = k == 0 ? link_1 : link_2;
    const auto found = std::find(names.begin(), names.end(), link);
    if (found == names.end())
      throw std::invalid_argument("disable_collisions: the body has no link '" + link + "'");
    frames[k] = static_cast<int>(found - names.begin());
  }
  std::sort(frames.begin(), frames.end());
  insert(impl_->edit().bodies[body].disabled, frames);
}

void CollisionWorld::disableJoined(std::array<int, 2> one, std::array<int, 2> other)
{
  if (other < one)
    std::swap(one, other);
  const std::array<int, 4> pair{one[0], one[1], other[0], other[1]};
  std::vector<std::array<int, 4>>& joined = impl_->edit().joined;
  const auto place = std::lower_bound(joined.begin(), joined.end(), pair);
  if (place == joined.end() || *place != pair)
    joined.insert(place, pair);
}

void CollisionWorld::disableSelfCollision(int body)
{
  static_cast<void>(impl_->body(body));
  impl_->edit().bodies[body].collides_with_itself = false;
}

void CollisionWorld::putStaticLast()
{
  std::vector<int> order(impl_->poses.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_partition(order.begin(), order.end(), [this](int handle) { return shape(handle).body >= 0; });
  impl_->arrange(order);
}

void CollisionWorld::removeBody(int body)
{
  static_cast<void>(impl_->body(body));
  std::vector<int> order;
  for (int handle = 0; handle < shapeCount(); ++handle)
    if (shape(handle).body != body)
      order.push_back(handle);
  impl_->arrange(order);
  impl_->edit().eraseBody(body);
}

std::vector<std::string> CollisionWorld::disableOverlaps(int body)
{
  std::vector<std::string> disabled;
  for (Bounds& box : impl_->bounds)
    box.margin = 0.0;
  const std::vector<ShapePair> candidates = impl_->candidates();
  for (const ShapePair& pair : candidates)
  {
    const ShapeModel& model = *impl_->model;
    const ShapeInfo& a = model.infos[pair.a];
    const ShapeInfo& b = model.infos[pair.b];
    const bool is_mounted = b.body < 0 && model.bodies[a.body].is_mounted;
    if ((a.body != b.body && !is_mounted) || (body >= 0 && a.body != body) || !model.mayCollide(pair.a, pair.b))
      continue;
    const std::string names = a.link_name + " - " + b.link_name;  // the model may be another one after an edit
    impl_->collidePair(pair, 0.0);
    const Manifold& manifold = impl_->manifold;
    if (std::any_of(manifold.points.begin(), manifold.points.begin() + manifold.count,
                    [](const PairContact& point) { return point.gap < OVERLAP_GAP; }))
    {
      if (is_mounted)
        insert(impl_->edit().bodies[a.body].disabled_static, {a.frame, pair.b});
      else
        disablePair(a.body, a.link_name, b.link_name);
      disabled.push_back(names);
    }
  }
  return disabled;
}

void CollisionWorld::setPoses(int body, const MultibodyData& data)
{
  const ShapeModel& model = *impl_->model;
  for (int handle : impl_->body(body).shapes)
    impl_->setPose(handle, data.link_pose[model.infos[handle].link] * model.instances[handle].placement);
}

void CollisionWorld::setLinkPose(int body, int link, const Eigen::Isometry3d& pose)
{
  const ShapeModel& model = *impl_->model;
  for (int handle : impl_->body(body).shapes)
    if (model.infos[handle].link == link)
      impl_->setPose(handle, pose * model.instances[handle].placement);
}

const std::vector<ContactPoint>& CollisionWorld::detect(double margin)
{
  for (Bounds& box : impl_->bounds)
    box.margin = margin;
  return impl_->detect();
}

const std::vector<ContactPoint>& CollisionWorld::detect(const std::vector<double>& body_margins)
{
  const std::vector<ShapeInfo>& infos = impl_->model->infos;
  for (size_t i = 0; i < infos.size(); ++i)
    impl_->bounds[i].margin = infos[i].body < 0 ? -1.0 : body_margins[infos[i].body];
  return impl_->detect();
}

void CollisionWorld::setRigidSets(std::vector<int> set_of_shape)
{
  assert(set_of_shape.empty() || set_of_shape.size() == impl_->poses.size());
  impl_->rigid_sets = std::move(set_of_shape);
}

void CollisionWorld::setBroadPhase(BroadPhaseKind kind)
{
  impl_->broad_phase.setKind(kind);
}

std::vector<double> CollisionWorld::meshReach(int body) const
{
  std::vector<double> reach;
  for (const int handle : impl_->body(body).shapes)
  {
    const Instance& instance = impl_->model->instances[handle];
    const size_t index = static_cast<size_t>(impl_->model->infos[handle].index);
    reach.resize(std::max(reach.size(), index + 1), 0.0);
    if (instance.shape.kind == ShapeKind::HULL)
      for (const Eigen::Vector3d& vertex : instance.shape.core.vertices)
        reach[index] = std::max(reach[index], (instance.placement * vertex).norm());
  }
  return reach;
}

double CollisionWorld::lowestPoint(int body) const
{
  double lowest = std::numeric_limits<double>::infinity();
  for (int handle : impl_->body(body).shapes)
  {
    const Eigen::Isometry3d& pose = impl_->poses[handle];
    const Eigen::Vector3d up = pose.linear().row(2).transpose();
    lowest = std::min(lowest, pose.translation().z() + lowestAlong(convexShape(handle), up));
  }
  return lowest;
}

int CollisionWorld::shapeCount() const
{
  return static_cast<int>(impl_->poses.size());
}

const ShapeInfo& CollisionWorld::shape(int handle) const
{
  return impl_->model->infos.at(handle);
}

const ConvexShape& CollisionWorld::convexShape(int handle) const
{
  return impl_->model->instances.at(handle).shape;
}

}  // namespace frictional_contact_sim
