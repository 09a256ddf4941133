#include "frictional_contact_sim/ros/frames.h"

#include <ros/duration.h>
#include <ros/time.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <algorithm>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/services.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LOOK_PERIOD = 0.01;  // [s]

std::vector<std::string> linkNames(const MultibodyModel& model)
{
  std::vector<std::string> names;
  for (const Frame& frame : model.frames)
    names.push_back(frame.name);
  return names;
}

std::vector<std::string> allLinkNames(const NameTable& names)
{
  std::vector<std::string> all;
  for (const std::vector<std::string>& frames : names.frames)
    all.insert(all.end(), frames.begin(), frames.end());
  return all;
}

Eigen::Isometry3d toPose(const geometry_msgs::Transform& transform)
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(transform.translation.x, transform.translation.y, transform.translation.z);
  const geometry_msgs::Quaternion& q = transform.rotation;
  pose.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return pose;
}

[[noreturn]] void failLink(const std::string& link, const std::vector<std::string>& known)
{
  throw RequestError("link: found '" + inOneLine(link) + "', " + didYouMean(link, known) + "expected one of " +
                     inOneLine(joinNames(known)));
}
}  // namespace

std::optional<LinkHandle> findLink(const Simulator& simulator, const NameTable& names, const std::string& name)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const std::vector<std::string>& frames = names.frames[body];
    for (size_t frame = 0; frame < frames.size(); ++frame)
      if (frames[frame] == name)
        return LinkHandle{body, static_cast<int>(frame)};
  }
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const std::string prefix = names.bodies[body] + "/";
    const int frame =
        name.compare(0, prefix.size(), prefix) == 0 ? simulator.model(body).findFrame(name.substr(prefix.size())) : -1;
    if (frame >= 0)
      return LinkHandle{body, frame};
  }
  return std::nullopt;
}

int requireBody(const NameTable& names, const std::string& body, const std::string& field)
{
  if (body.empty() && names.bodies.size() == 1)
    return 0;
  for (size_t i = 0; i < names.bodies.size(); ++i)
    if (names.bodies[i] == body)
      return static_cast<int>(i);
  throw RequestError(field + ": found '" + inOneLine(body) + "', " + didYouMean(body, names.bodies) +
                     "expected one of " + inOneLine(joinNames(names.bodies)));
}

LinkHandle requireLink(const Simulator& simulator, const NameTable& names, const std::string& body,
                       const std::string& link)
{
  if (body.empty() && names.bodies.size() != 1)
  {
    if (const std::optional<LinkHandle> found = findLink(simulator, names, link))
      return *found;
    failLink(link, allLinkNames(names));
  }
  const int index = requireBody(names, body);
  const int frame = simulator.model(index).findFrame(link);
  if (frame < 0)
    failLink(link, linkNames(simulator.model(index)));
  return {index, frame};
}

LinkHandle requireLinkOrRoot(const Simulator& simulator, const NameTable& names, const std::string& body,
                             const std::string& link)
{
  if (!link.empty())
    return requireLink(simulator, names, body, link);
  const int index = requireBody(names, body);
  const MultibodyModel& model = simulator.model(index);
  return {index, std::max(0, model.findFrame(model.links.front().name))};
}

Eigen::Isometry3d linkPose(const Simulator& simulator, const LinkHandle& link)
{
  return framePose(simulator.model(link.body), simulator.data(link.body), link.frame);
}

struct FrameResolver::Transforms
{
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener{buffer, true};  // a thread of its own: it only fills the buffer
};

FrameResolver::FrameResolver(const Simulator& simulator, const NameTable& names, bool use_tf)
  : simulator_(simulator), names_(names), use_tf_(use_tf)
{
}

FrameResolver::~FrameResolver() = default;

Eigen::Isometry3d FrameResolver::pose(const std::string& field, const std::string& frame_id)
{
  const std::string name = frame_id.compare(0, 1, "/") == 0 ? frame_id.substr(1) : frame_id;
  if (name.empty() || name == WORLD_FRAME)
    return Eigen::Isometry3d::Identity();
  if (const std::optional<LinkHandle> link = findLink(simulator_, names_, name))
    return linkPose(simulator_, *link);
  return foreignPose(field, name);
}

Eigen::Isometry3d FrameResolver::foreignPose(const std::string& field, const std::string& frame_id)
{
  std::optional<Eigen::Isometry3d> found;
  if (use_tf_)
  {
    const double start = ros::WallTime::now().toSec();
    const double wait = transforms_ == nullptr ? FIRST_WAIT : 0.0;
    if (transforms_ == nullptr)
      transforms_ = std::make_unique<Transforms>();
    found = lookUp(frame_id);
    while (!found && ros::WallTime::now().toSec() < start + wait)
    {
      ros::WallDuration(LOOK_PERIOD).sleep();
      found = lookUp(frame_id);
    }
  }
  if (!found)
    throw RequestError(field + ": found '" + inOneLine(frame_id) + "', " + didYouMean(frame_id, allLinkNames(names_)) +
                       "expected world, a link, or a frame that tf connects with one of them");
  return *found;
}

/** @brief Through the nearest own link above the frame, else through tf's own way to the world. */
std::optional<Eigen::Isometry3d> FrameResolver::lookUp(const std::string& frame_id) const
{
  const tf2_ros::Buffer& buffer = transforms_->buffer;
  const ros::Time latest(0);
  std::string ancestor = frame_id;
  std::optional<LinkHandle> link;
  while (!link && ancestor != WORLD_FRAME && buffer._getParent(ancestor, latest, ancestor))
    link = findLink(simulator_, names_, ancestor);
  const std::string reference = link ? ancestor : WORLD_FRAME;
  if (!buffer.canTransform(reference, frame_id, latest))
    return std::nullopt;
  const Eigen::Isometry3d pose = toPose(buffer.lookupTransform(reference, frame_id, latest).transform);
  return link ? linkPose(simulator_, *link) * pose : pose;
}

}  // namespace frictional_contact_sim
