#include "frictional_contact_sim/ros/transform_publisher.h"

#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
bool sameButStamps(const std::vector<geometry_msgs::TransformStamped>& a,
                   const std::vector<geometry_msgs::TransformStamped>& b)
{
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const geometry_msgs::TransformStamped& x, const geometry_msgs::TransformStamped& y)
      { return x.child_frame_id == y.child_frame_id && x.transform == y.transform; });
}
}  // namespace

TransformPublisher::TransformPublisher(const Simulator& simulator, const NameTable& names,
                                       const TransformChoice& choice)
  : simulator_(simulator), names_(names), choice_(choice)
{
}

/** @brief A root link named world is the world: it has no transform. */
bool TransformPublisher::isChosen(int body, int frame) const
{
  const bool is_root = simulator_.model(body).frames[frame].parent < 0;
  return is_root ? choice_.bases && names_.frames[body][frame] != WORLD_FRAME : choice_.links;
}

bool isStatic(const BodyModel& body, int frame)
{
  const Frame& child = body.tree.frames[frame];
  return child.parent >= 0 ? body.tree.frames[child.parent].link == child.link : body.isFixed(child.link);
}

void TransformPublisher::append(int body, int frame, const ros::Time& stamp,
                                std::vector<geometry_msgs::TransformStamped>& transforms)
{
  const MultibodyModel& model = simulator_.model(body);
  const MultibodyData& data = simulator_.data(body);
  const int parent = model.frames[frame].parent;
  Eigen::Isometry3d pose = framePose(model, data, frame);
  if (parent >= 0)
    pose = framePose(model, data, parent).inverse() * pose;
  transforms.emplace_back();
  transforms.back().header.stamp = stamp;
  transforms.back().header.frame_id = parent >= 0 ? names_.frames[body][parent] : WORLD_FRAME;
  transforms.back().child_frame_id = names_.frames[body][frame];
  fillTransform(pose, transforms.back().transform);
}

const std::vector<geometry_msgs::TransformStamped>& TransformPublisher::moving(const ros::Time& stamp)
{
  moving_.clear();
  for (int body = 0; body < simulator_.bodyCount(); ++body)
    for (int frame = 0; frame < static_cast<int>(names_.frames[body].size()); ++frame)
      if (isChosen(body, frame) && !isStatic(simulator_.workspace(body).model, frame))
        append(body, frame, stamp, moving_);
  return moving_;
}

void TransformPublisher::send(const ros::Time& stamp)
{
  if (!moving(stamp).empty())
    broadcaster_.sendTransform(moving_);
}

void TransformPublisher::sendStatic(const ros::Time& stamp, const std::vector<geometry_msgs::TransformStamped>& others)
{
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (int body = 0; body < simulator_.bodyCount(); ++body)
    for (int frame = 0; frame < static_cast<int>(names_.frames[body].size()); ++frame)
      if (isChosen(body, frame) && isStatic(simulator_.workspace(body).model, frame))
        append(body, frame, stamp, transforms);
  transforms.insert(transforms.end(), others.begin(), others.end());
  for (geometry_msgs::TransformStamped& transform : transforms)
    transform.header.stamp = stamp;
  if (transforms.empty() || sameButStamps(transforms, static_))
    return;
  static_ = transforms;
  static_broadcaster_.sendTransform(static_);
}

}  // namespace frictional_contact_sim
