#include "frictional_contact_sim/ros/markers.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/ros/conversions.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int CONE_SIDES = 24;
constexpr double CONE_HEIGHT = 0.04;  // [m]
constexpr double CONE_OPACITY = 0.35;  // forces stay visible through it
constexpr double PI = 3.14159265358979323846;

std_msgs::ColorRGBA makeColor(double red, double green, double blue, double opacity)
{
  std_msgs::ColorRGBA color;
  color.r = static_cast<float>(red);
  color.g = static_cast<float>(green);
  color.b = static_cast<float>(blue);
  color.a = static_cast<float>(opacity);
  return color;
}

std_msgs::ColorRGBA colorOf(ContactMode mode, double opacity)
{
  switch (mode)
  {
    case ContactMode::STICKING:
      return makeColor(0.1, 0.75, 0.2, opacity);
    case ContactMode::SLIDING:
      return makeColor(1.0, 0.5, 0.0, opacity);
    case ContactMode::IMPACT:
      return makeColor(0.1, 0.35, 1.0, opacity);
    case ContactMode::OPEN:
      break;
  }
  return makeColor(0.6, 0.6, 0.6, opacity);
}

geometry_msgs::Point toPoint(const Eigen::Vector3d& source)
{
  geometry_msgs::Point point;
  point.x = source.x();
  point.y = source.y();
  point.z = source.z();
  return point;
}

void fillArrow(const ContactState& contact, double force_scale, double dt, visualization_msgs::Marker& arrow)
{
  arrow.ns = "force";
  arrow.type = visualization_msgs::Marker::ARROW;
  arrow.action = visualization_msgs::Marker::ADD;
  arrow.pose.orientation.w = 1.0;
  arrow.points.resize(2);
  arrow.points[0] = toPoint(contact.position);
  arrow.points[1] = toPoint(contact.position + contact.impulse * (force_scale / dt));
  arrow.scale.x = 0.01;  // shaft and head diameter, head length [m]
  arrow.scale.y = 0.02;
  arrow.scale.z = 0.03;
  arrow.color = colorOf(contact.mode, 1.0);
}

/** @brief Side faces of the cone |r_T| <= mu r_N with its tip at the contact, opening to the side of a. */
void appendCone(const ContactState& contact, visualization_msgs::Marker& cones)
{
  const double radius = std::min(contact.friction, 2.0) * CONE_HEIGHT;
  const std_msgs::ColorRGBA color = colorOf(contact.mode, CONE_OPACITY);
  const auto rim = [&](int side)
  {
    const double angle = 2.0 * PI * side / CONE_SIDES;
    return toPoint(contact.position + CONE_HEIGHT * contact.normal + radius * std::cos(angle) * contact.tangent_1 +
                   radius * std::sin(angle) * contact.tangent_2);
  };
  for (int side = 0; side < CONE_SIDES; ++side)
  {
    cones.points.push_back(toPoint(contact.position));
    cones.points.push_back(rim(side));
    cones.points.push_back(rim(side + 1));
    cones.colors.insert(cones.colors.end(), 3, color);
  }
}

}  // namespace

double defaultForceScale(const Simulator& simulator)
{
  double mass = 0.0;
  for (int body = 0; body < simulator.bodyCount(); ++body)
    mass += simulator.model(body).totalMass();
  const double weight = mass * simulator.scenario().gravity.norm();
  return weight > 0.0 ? 0.5 / weight : 0.01;
}

size_t fillMarkers(const Simulator& simulator, const ros::Time& stamp, double force_scale, size_t previous_arrows,
                   visualization_msgs::MarkerArray& message)
{
  const std::vector<ContactState>& contacts = simulator.contacts();
  const size_t arrows = contacts.size();
  message.markers.resize(std::max(arrows, previous_arrows) + 1);
  visualization_msgs::Marker& cones = message.markers.back();
  cones.ns = "cone";
  cones.type = visualization_msgs::Marker::TRIANGLE_LIST;
  cones.pose.orientation.w = 1.0;
  cones.scale.x = cones.scale.y = cones.scale.z = 1.0;
  cones.color = makeColor(1.0, 1.0, 1.0, 1.0);
  cones.points.clear();
  cones.colors.clear();
  for (size_t i = 0; i + 1 < message.markers.size(); ++i)
  {
    visualization_msgs::Marker& arrow = message.markers[i];
    arrow.ns = "force";
    arrow.colors.clear();  // the marker may have been the cones' one
    arrow.id = static_cast<int>(i);
    if (i < arrows)
    {
      fillArrow(contacts[i], force_scale, impulseTime(simulator), arrow);
      appendCone(contacts[i], cones);
    }
    else
    {
      arrow.action = visualization_msgs::Marker::DELETE;
    }
  }
  cones.id = 0;
  cones.action = cones.points.empty() ? visualization_msgs::Marker::DELETE : visualization_msgs::Marker::ADD;
  for (visualization_msgs::Marker& marker : message.markers)
  {
    marker.header.frame_id = WORLD_FRAME;
    marker.header.stamp = stamp;
  }
  return arrows;
}

}  // namespace frictional_contact_sim
