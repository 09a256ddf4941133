#include "frictional_contact_sim/model/urdf_loader.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>

#include "frictional_contact_sim/model/kinematics.h"
#include "joint_inertia.h"
#include "lumped_inertia.h"
#include "urdf_document.h"
#include "urdf_schema.h"

namespace frictional_contact_sim
{
namespace
{
/** Takes what urdfdom would print. */
class FirstMessage : public console_bridge::OutputHandler
{
public:
  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/, int /*line*/) override
  {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.empty())
      text_ = text;
  }
  const std::string& text() const { return text_; }

private:
  std::string text_;
};

/** The output handler of console_bridge is global: put in place for the call only, one caller at a time. */
urdf::ModelInterfaceSharedPtr parseQuietly(const std::string& text, const std::string& source)
{
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  FirstMessage message;
  console_bridge::OutputHandler* const previous = console_bridge::getOutputHandler();
  console_bridge::useOutputHandler(&message);
  urdf::ModelInterfaceSharedPtr model;
  std::string reason;
  try
  {
    model = urdf::parseURDF(text);
    reason = message.text();
  }
  catch (const std::exception& error)
  {
    reason = error.what();
  }
  console_bridge::useOutputHandler(previous);
  if (!model || !model->getRoot())
    failAt(source, 0, "urdfdom: " + (reason.empty() ? "not a URDF" : reason));
  return model;
}

Eigen::Isometry3d toIsometry(const urdf::Pose& pose)
{
  Eigen::Quaterniond rotation;
  pose.rotation.getQuaternion(rotation.x(), rotation.y(), rotation.z(), rotation.w());
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = rotation.normalized().toRotationMatrix();
  isometry.translation() << pose.position.x, pose.position.y, pose.position.z;
  return isometry;
}

RigidInertia toInertia(const urdf::Inertial& inertial)
{
  RigidInertia inertia;
  inertia.mass = inertial.mass;
  inertia.rotational << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
      inertial.ixz, inertial.iyz, inertial.izz;
  return transform(inertia, toIsometry(inertial.origin));
}

JointType toJointType(int type)
{
  switch (type)
  {
    case urdf::Joint::REVOLUTE:
      return JointType::REVOLUTE;
    case urdf::Joint::CONTINUOUS:
      return JointType::CONTINUOUS;
    case urdf::Joint::PRISMATIC:
      return JointType::PRISMATIC;
    case urdf::Joint::PLANAR:
      return JointType::PLANAR;
    case urdf::Joint::FLOATING:
      return JointType::FLOATING;
    default:
      return JointType::FIXED;
  }
}

/** Walks the tree of links in document order and builds the model. */
class ModelBuilder
{
public:
  ModelBuilder(const UrdfDocument& document, const urdf::ModelInterface& urdf, const std::string& source)
    : document_(document), urdf_(urdf), source_(source)
  {
    model_.name = urdf.getName();
  }

  MultibodyModel build(BaseType base)
  {
    const urdf::Link& root = *urdf_.getRoot();
    const bool fixed = base == BaseType::FIXED || (base == BaseType::AUTO && root.name == "world");
    Joint joint;
    joint.type = fixed ? JointType::FIXED : JointType::FLOATING;
    addLink(root, joint);
    addFrame(root, 0, Eigen::Isometry3d::Identity());
    addDescendants(root);
    for (size_t i = 0; i < model_.links.size(); ++i)
      model_.links[i].inertia = combine(parts_[i]);
    addMimics();
    finalize(model_);
    addLoops();
    return model_;
  }

private:
  std::vector<const urdf::Joint*> childJoints(const urdf::Link& link) const
  {
    std::vector<const urdf::Joint*> joints;
    for (const urdf::JointSharedPtr& joint : link.child_joints)
      joints.push_back(joint.get());
    std::sort(joints.begin(), joints.end(),
              [this](const urdf::Joint* a, const urdf::Joint* b)
              { return document_.joint_order.at(a->name) < document_.joint_order.at(b->name); });
    return joints;
  }

  /** Depth first, with a stack of our own: a chain of links may be long. */
  void addDescendants(const urdf::Link& root)
  {
    std::vector<const urdf::Joint*> waiting = childJoints(root);
    std::reverse(waiting.begin(), waiting.end());
    while (!waiting.empty())
    {
      const urdf::Joint& joint = *waiting.back();
      waiting.pop_back();
      const urdf::Link& child = *urdf_.getLink(joint.child_link_name);
      const Frame& parent = model_.frames[model_.findFrame(joint.parent_link_name)];
      const Eigen::Isometry3d placement = parent.placement * toIsometry(joint.parent_to_joint_origin_transform);
      if (joint.type == urdf::Joint::FIXED)
      {
        addFrame(child, parent.link, placement);
      }
      else
      {
        addLink(child, makeJoint(joint, parent.link, placement));
        addFrame(child, static_cast<int>(model_.links.size()) - 1, Eigen::Isometry3d::Identity());
      }
      model_.frames.back().parent = model_.findFrame(joint.parent_link_name);
      model_.frames.back().joint = joint.name;
      std::vector<const urdf::Joint*> next = childJoints(child);
      waiting.insert(waiting.end(), next.rbegin(), next.rend());
    }
  }

  Joint makeJoint(const urdf::Joint& urdf_joint, int parent, const Eigen::Isometry3d& placement) const
  {
    Joint joint;
    joint.name = urdf_joint.name;
    joint.type = toJointType(urdf_joint.type);
    joint.parent = parent;
    joint.placement = placement;
    if (joint.type != JointType::FLOATING)
      joint.axis = Eigen::Vector3d(urdf_joint.axis.x, urdf_joint.axis.y, urdf_joint.axis.z).stableNormalized();
    const bool one_coordinate = velocitySize(joint.type) == 1;
    if (urdf_joint.limits && one_coordinate)
    {
      if (joint.type != JointType::CONTINUOUS)
      {
        joint.limit.lower = urdf_joint.limits->lower;
        joint.limit.upper = urdf_joint.limits->upper;
      }
      joint.limit.effort = urdf_joint.limits->effort;
      joint.limit.velocity = urdf_joint.limits->velocity;
    }
    if (urdf_joint.dynamics)
    {
      joint.damping = urdf_joint.dynamics->damping;
      joint.dry_friction = urdf_joint.dynamics->friction;
    }
    return joint;
  }

  void addLink(const urdf::Link& link, const Joint& joint)
  {
    model_.links.push_back({link.name, RigidInertia()});
    model_.joints.push_back(joint);
    parts_.emplace_back();
  }

  void addFrame(const urdf::Link& link, int carrier, const Eigen::Isometry3d& placement)
  {
    model_.frames.push_back({link.name, carrier, placement});
    if (link.inertial)
    {
      model_.frames.back().inertia = toInertia(*link.inertial);
      parts_[carrier].push_back(transform(model_.frames.back().inertia, placement));
    }
    for (size_t k = 0; k < link.collision_array.size(); ++k)
      addShape(link, static_cast<int>(k));
  }

  void addShape(const urdf::Link& link, int place)
  {
    const urdf::Collision& collision = *link.collision_array[place];
    const Frame& frame = model_.frames.back();
    CollisionShape shape{collision.name.empty() ? link.name + "_collision_" + std::to_string(place) : collision.name,
                         static_cast<int>(model_.frames.size()) - 1,
                         frame.link,
                         toGeometry(link, place),
                         frame.placement * toIsometry(collision.origin),
                         -1.0};
    const auto friction = document_.friction.find(link.name);
    if (friction != document_.friction.end())
      shape.friction = friction->second;
    model_.shapes.push_back(shape);
  }

  Geometry toGeometry(const urdf::Link& link, int place) const
  {
    const urdf::Geometry& geometry = *link.collision_array[place]->geometry;
    switch (geometry.type)
    {
      case urdf::Geometry::SPHERE:
        return Sphere{static_cast<const urdf::Sphere&>(geometry).radius};
      case urdf::Geometry::BOX:
      {
        const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
        return Box{0.5 * Eigen::Vector3d(size.x, size.y, size.z)};
      }
      case urdf::Geometry::CYLINDER:
      {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        if (document_.capsules.count({link.name, place}) > 0)
          return Capsule{cylinder.radius, 0.5 * cylinder.length};
        return Cylinder{cylinder.radius, 0.5 * cylinder.length};
      }
      case urdf::Geometry::MESH:
        break;
    }
    return toMesh(link, static_cast<const urdf::Mesh&>(geometry));
  }

  Mesh toMesh(const urdf::Link& link, const urdf::Mesh& mesh) const
  {
    try
    {
      const std::string folder = std::filesystem::path(source_).parent_path().string();
      return Mesh{resolvePath(mesh.filename, folder), Eigen::Vector3d(mesh.scale.x, mesh.scale.y, mesh.scale.z)};
    }
    catch (const ModelError& error)
    {
      failAt(source_, 0, "link '" + link.name + "': collision mesh " + error.what());
    }
  }

  void addMimics()
  {
    for (Joint& joint : model_.joints)
    {
      const urdf::JointConstSharedPtr urdf_joint = urdf_.getJoint(joint.name);
      if (urdf_joint && urdf_joint->mimic)
      {
        joint.mimic.joint = model_.findJoint(urdf_joint->mimic->joint_name);
        joint.mimic.multiplier = urdf_joint->mimic->multiplier;
        joint.mimic.offset = urdf_joint->mimic->offset;
      }
    }
  }

  /** Where the child has the joint is said, or follows from the zero position. */
  void addLoops()
  {
    if (document_.loops.empty())
      return;
    MultibodyData zero(model_);
    forwardKinematics(model_, zeroPosition(model_), zero);
    for (const LoopElement& element : document_.loops)
    {
      LoopJoint loop;
      loop.name = element.name;
      loop.type = element.type;
      loop.frame_a = model_.findFrame(element.child);
      loop.frame_b = model_.findFrame(element.parent);
      if (model_.frames[loop.frame_a].link == model_.frames[loop.frame_b].link)
        failAt(source_, element.line,
               "loop_joint '" + element.name + "': links '" + element.child + "' and '" + element.parent +
                   "' are one rigid thing, expected two that move against each other");
      Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
      if (element.type == LoopType::AXIS)
        turn.linear() = orientationAlong(element.axis);
      loop.pose = element.origin * turn;
      loop.anchor = element.child_origin ? *element.child_origin * turn
                                         : framePose(model_, zero, loop.frame_a).inverse() *
                                               framePose(model_, zero, loop.frame_b) * loop.pose;
      model_.loops.push_back(loop);
    }
  }

  const UrdfDocument& document_;
  const urdf::ModelInterface& urdf_;
  const std::string& source_;
  MultibodyModel model_;
  std::vector<std::vector<RigidInertia>> parts_;  ///< links: inertia of the URDF links they carry, in the link frame
};
}  // namespace

LoadedModel loadUrdf(const std::string& xml, const std::string& source, BaseType base,
                     const std::optional<double>& min_joint_inertia)
{
  const UrdfDocument document = readDocument(xml, source);
  const urdf::ModelInterfaceSharedPtr urdf = parseQuietly(document.text, source);
  LoadedModel loaded;
  loaded.model = ModelBuilder(document, *urdf, source).build(base);
  loaded.warnings = document.warnings;
  for (const std::vector<std::string>& lines :
       {checkInertia(loaded.model, source), addJointInertia(loaded.model, min_joint_inertia)})
    loaded.warnings.insert(loaded.warnings.end(), lines.begin(), lines.end());
  return loaded;
}

LoadedModel loadUrdfFile(const std::string& path, BaseType base, const std::optional<double>& min_joint_inertia)
{
  std::ifstream file(path);
  std::error_code ignored;
  if (!file || std::filesystem::is_directory(path, ignored))
    failAt(path, 0, "cannot be read, expected a URDF file");
  std::ostringstream content;
  content << file.rdbuf();
  return loadUrdf(content.str(), path, base, min_joint_inertia);
}

BaseType parseBaseType(const std::string& text)
{
  if (text == "auto")
    return BaseType::AUTO;
  if (text == "floating")
    return BaseType::FLOATING;
  if (text == "fixed")
    return BaseType::FIXED;
  throw std::invalid_argument("base '" + text + "', expected auto, floating or fixed");
}

}  // namespace frictional_contact_sim
