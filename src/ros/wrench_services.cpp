#include "frictional_contact_sim/ros/wrench_services.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/ros/services.h"
#include "request_fields.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double STAMP_ROUNDING = 1e-9;  // of a start that was read off a message [s]
constexpr double LINE_PERIOD = 1.0;  // of the same line [s]
constexpr size_t MOST_LINES = 10;  // different ones within that time
constexpr std::uint32_t QUEUE = 10;

/** On the scenario's clock, which goes on with the simulated time but starts anew at a reset. */
void setWindow(const ApplyWrench::Request& request, const Simulator& simulator, ExternalWrench& wrench)
{
  const double dt = simulator.state().dt;
  const double now = simulator.time();
  const double start = request.start.isZero() ? now : request.start.toSec();
  const double duration = request.duration.toSec();
  if (duration < 0.0)
    throw RequestError("duration: found " + numberText(duration) +
                       " s, expected more than zero, or zero for until cleared");
  if (start < now - STAMP_ROUNDING)
    throw RequestError("start: found " + numberText(start) + " s, expected zero or at least the present time " +
                       numberText(now) + " s");
  const double delay = std::max(0.0, start - now);
  wrench.from = simulator.state().scenario_clock.time(dt) + delay;
  wrench.until = request.duration.isZero() ? std::numeric_limits<double>::infinity() : wrench.from + duration;
  const double first_middle = (std::max(0.0, std::ceil(delay / dt - 0.5)) + 0.5) * dt;
  if (!request.duration.isZero() && !(first_middle < delay + duration))
    throw RequestError("duration: found " + numberText(duration) +
                       " s, expected more, so that the middle of a step is within it, or zero for until cleared; "
                       "time_step is " +
                       numberText(dt) + " s");
}

}  // namespace

void applyWrench(const ApplyWrench::Request& request, const NameTable& names, FrameResolver& frames,
                 Simulator& simulator)
{
  const LinkHandle link = requireLink(simulator, names, request.body, request.link);
  ExternalWrench wrench;
  wrench.link = simulator.model(link.body).frames[link.frame].name;
  wrench.force = readVector("wrench.force", request.wrench.force, LARGEST_FORCE, "N");
  wrench.torque = readVector("wrench.torque", request.wrench.torque, LARGEST_FORCE, "N m");
  wrench.point = readPoint("point", request.point);
  setWindow(request, simulator, wrench);

  const std::optional<LinkHandle> axes = findLink(simulator, names, request.frame_id);
  wrench.world_frame = !(axes && axes->body == link.body && axes->frame == link.frame);
  if (wrench.world_frame)
  {
    const Eigen::Matrix3d turn = frames.pose("frame_id", request.frame_id).linear();
    wrench.force = turn * wrench.force;
    wrench.torque = turn * wrench.torque;
  }
  if (!request.point_frame_id.empty())
    wrench.point =
        linkPose(simulator, link).inverse() * (frames.pose("point_frame_id", request.point_frame_id) * wrench.point);
  simulator.addWrench(link.body, wrench);
}

void clearWrenches(const ClearWrenches::Request& request, const NameTable& names, Simulator& simulator)
{
  if (!request.link.empty())
  {
    const LinkHandle link = requireLink(simulator, names, request.body, request.link);
    simulator.clearWrenches(link.body, link.frame);
  }
  else if (!request.body.empty())
    simulator.clearWrenches(requireBody(names, request.body));
  else
    simulator.clearWrenches();
}

void takeWrench(const geometry_msgs::WrenchStamped& message, const NameTable& names, Simulator& simulator)
{
  const std::optional<LinkHandle> link = findLink(simulator, names, message.header.frame_id);
  if (!link)
    throw RequestError("header.frame_id: found '" + inOneLine(message.header.frame_id) + "', expected a link");
  ExternalWrench wrench;
  wrench.link = simulator.model(link->body).frames[link->frame].name;
  wrench.force = readVector("wrench.force", message.wrench.force, LARGEST_FORCE, "N");
  wrench.torque = readVector("wrench.torque", message.wrench.torque, LARGEST_FORCE, "N m");
  wrench.world_frame = false;
  simulator.replaceWrench(link->body, wrench);
}

WrenchListener::WrenchListener(ros::NodeHandle& private_node, const NameTable& names, Simulator& simulator)
  : lines_(LINE_PERIOD, MOST_LINES)
{
  subscriber_ = private_node.subscribe<geometry_msgs::WrenchStamped>(
      "wrench", QUEUE,
      [this, &names, &simulator](const geometry_msgs::WrenchStamped::ConstPtr& message)
      {
        try
        {
          takeWrench(*message, names, simulator);
        }
        catch (const std::exception& error)
        {
          const std::string line = std::string("~wrench: message ignored: ") + error.what();
          if (lines_.pass(line, ros::WallTime::now().toSec()))
            ROS_WARN_STREAM(line);
        }
      });
}

}  // namespace frictional_contact_sim
