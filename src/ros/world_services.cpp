#include "frictional_contact_sim/ros/world_services.h"

#include <geometry_msgs/Pose.h>

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/ros/services.h"
#include "frictional_contact_sim/ros/simulator_node.h"
#include "request_fields.h"

namespace frictional_contact_sim
{
namespace
{
/** A body's own name for the link that `name` is on topics or in its URDF; empty when it has none. */
std::string linkOf(const Simulator& simulator, const NameTable& names, int body, const std::string& name)
{
  const std::vector<Frame>& frames = simulator.model(body).frames;
  for (size_t frame = 0; frame < frames.size(); ++frame)
    if (frames[frame].name == name || names.frames[static_cast<size_t>(body)][frame] == name ||
        names.bodies[static_cast<size_t>(body)] + "/" + frames[frame].name == name)
      return frames[frame].name;
  return "";
}

std::vector<std::string> linkNames(const Simulator& simulator, const NameTable& names, int body)
{
  std::vector<std::string> known;
  for (int b = 0; b < simulator.bodyCount(); ++b)
    for (size_t frame = 0; frame < names.frames[static_cast<size_t>(b)].size(); ++frame)
      if (body < 0 || b == body)
        known.push_back(body < 0 ? names.frames[static_cast<size_t>(b)][frame] : simulator.model(b).frames[frame].name);
  return known;
}

/** All zero, as a request leaves it where nobody fills it in. */
bool isGiven(const geometry_msgs::Pose& pose)
{
  const double numbers[] = {pose.position.x,    pose.position.y,    pose.position.z,   pose.orientation.x,
                            pose.orientation.y, pose.orientation.z, pose.orientation.w};
  return std::any_of(std::begin(numbers), std::end(numbers), [](double number) { return number != 0.0; });
}

BaseType readBase(const std::string& base)
{
  if (base.empty() || base == "auto")
    return BaseType::AUTO;
  if (base == "floating")
    return BaseType::FLOATING;
  if (base == "fixed")
    return BaseType::FIXED;
  throw RequestError("base: found '" + inOneLine(base) + "', expected auto, floating or fixed");
}

void readJoints(const Spawn::Request& request, BodySpec& spec)
{
  if (request.joint_names.size() != request.joint_positions.size())
    throw RequestError("joint_positions: found " + std::to_string(request.joint_positions.size()) +
                       ", expected one a name, " + std::to_string(request.joint_names.size()));
  for (size_t i = 0; i < request.joint_names.size(); ++i)
  {
    if (!std::isfinite(request.joint_positions[i]))
      throw RequestError("joint_positions: that of '" + inOneLine(request.joint_names[i]) + "' is not finite");
    spec.joints[request.joint_names[i]].position = request.joint_positions[i];
  }
}
}  // namespace

LinkRef readLink(const std::string& side, const std::string& body, const std::string& link, const Simulator& simulator,
                 const NameTable& names)
{
  const bool is_world = body == WORLD_FRAME && (link.empty() || link == WORLD_FRAME);
  if (is_world && simulator.findBody(body) < 0)
    return {};
  const int named = body.empty() ? -1 : requireBody(names, body, "body" + side);
  std::vector<LinkRef> found;
  for (int b = 0; b < simulator.bodyCount(); ++b)
  {
    const std::string own = named >= 0 && named != b ? "" : linkOf(simulator, names, b, link);
    if (!own.empty())
      found.push_back({b, own});
  }
  if (found.size() == 1)
    return found.front();
  if (body.empty() && link == WORLD_FRAME)
    return {};
  const std::string field = "link" + side;
  if (found.size() > 1)
    throw RequestError(field + ": found '" + inOneLine(link) + "', which " + std::to_string(found.size()) +
                       " bodies have: name one of them");
  const std::vector<std::string> known = linkNames(simulator, names, named);
  throw RequestError(field + ": found '" + inOneLine(link) + "', " + didYouMean(link, known) + "expected one of " +
                     inOneLine(joinNames(known)));
}

void attach(const Attach::Request& request, Simulator& simulator, const NameTable& names, Attach::Response& response)
{
  const LinkRef a = readLink("_a", request.body_a, request.link_a, simulator, names);
  const LinkRef b = readLink("_b", request.body_b, request.link_b, simulator, names);
  const StepOutcome& outcome = simulator.attach(a, b);
  if (!outcome.taken)
    throw RequestError("the impact of the weld has no answer: " + outcome.message);
  const Closure& weld = simulator.welds().back();
  const bool is_swapped = a.body < 0;  // the simulator's link a is never the world
  response.pose = toMessage(is_swapped ? weld.pose.inverse() : weld.pose);
}

void detach(const Detach::Request& request, Simulator& simulator, const NameTable& names)
{
  simulator.detach(readLink("_a", request.body_a, request.link_a, simulator, names),
                   readLink("_b", request.body_b, request.link_b, simulator, names));
}

BodySpec readSpawn(const Spawn::Request& request, FrameResolver& frames, const FindDescription& find)
{
  if (!isTopicPart(request.name) || request.name == WORLD_FRAME)
    throw RequestError("name: found '" + inOneLine(request.name) +
                       "', expected a letter, then letters, digits and _, and not 'world'");
  if (request.urdf.empty() == request.description.empty())
    throw RequestError("urdf, description: found " + std::string(request.urdf.empty() ? "neither" : "both") +
                       ", expected one of them");
  BodySpec spec;
  spec.name = request.name;
  try
  {
    spec.urdf_xml = request.urdf.empty() ? findDocument(request.description, find) : request.urdf;
  }
  catch (const ParameterError& error)
  {
    throw RequestError("description: " + std::string(error.what()));
  }
  spec.base = readBase(request.base);
  const Eigen::Isometry3d frame = frames.pose("frame_id", request.frame_id);
  if (isGiven(request.pose))
    spec.pose = frame * readPose("pose", request.pose);
  spec.linear_velocity = frame.linear() * readVector("twist.linear", request.twist.linear, LARGEST_SPEED, "m/s");
  spec.angular_velocity = frame.linear() * readVector("twist.angular", request.twist.angular, LARGEST_SPEED, "rad/s");
  readJoints(request, spec);
  spec.hold_initial_position = request.hold_initial_position;
  return spec;
}

void spawn(const BodySpec& spec, Simulator& simulator)
{
  const StepOutcome& outcome = simulator.spawn(spec);
  if (!outcome.taken)
    throw RequestError("the impact of the new body has no answer: " + outcome.message);
}

}  // namespace frictional_contact_sim
