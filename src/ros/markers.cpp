#include "frictional_contact_sim/ros/markers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "frictional_contact_sim/ros/conversions.h"

namespace frictional_contact_sim
{
std_msgs::ColorRGBA makeColor(double red, double green, double blue, double opacity)
{
  std_msgs::ColorRGBA color;
  color.r = static_cast<float>(red);
  color.g = static_cast<float>(green);
  color.b = static_cast<float>(blue);
  color.a = static_cast<float>(opacity);
  return color;
}

namespace
{
using visualization_msgs::Marker;

constexpr int CONE_SIDES = 24;
constexpr double CONE_OPACITY = 0.35;  // forces stay visible through it
constexpr double PI = 3.14159265358979323846;

// In sizes of the scene.
constexpr double WEIGHT_ARROW = 1.0;
constexpr double SHORTEST_ARROW = 0.1;
constexpr double LONGEST_ARROW = 1.5;
constexpr double SHAFT = 0.02;
constexpr double HEAD = 0.045;
constexpr double HEAD_LENGTH = 0.08;
constexpr double CONE_HEIGHT = 0.1;
constexpr double LETTERS = 0.06;
constexpr double BLOCKING_BALL = 0.12;
constexpr double LEGEND_GAP = 0.15;  // above the bodies

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

Marker makeMarker(const char* name_space, size_t id, int type, const ros::Time& stamp)
{
  Marker marker;
  marker.header.frame_id = WORLD_FRAME;
  marker.header.stamp = stamp;
  marker.ns = name_space;
  marker.id = static_cast<int>(id);
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  return marker;
}

/** @brief Those of the last message that this one does not have any more. */
void appendDeleted(const char* name_space, size_t now, size_t previous, const ros::Time& stamp,
                   visualization_msgs::MarkerArray& message)
{
  for (size_t id = now; id < previous; ++id)
  {
    message.markers.push_back(makeMarker(name_space, id, Marker::ARROW, stamp));
    message.markers.back().action = Marker::DELETE;
  }
}

/** @brief Along the force [N], as long as it may be drawn [m]. */
Eigen::Vector3d arrowOf(const Eigen::Vector3d& force, const MarkerScale& scale)
{
  const double length = force.norm() * scale.force;
  if (!(length > 0.0) || !std::isfinite(length))
    return Eigen::Vector3d::Zero();
  return std::clamp(length, SHORTEST_ARROW * scale.size, LONGEST_ARROW * scale.size) * force.normalized();
}

Marker makeArrow(const ContactState& contact, size_t id, const Eigen::Vector3d& arrow, const MarkerScale& scale,
                 const ros::Time& stamp)
{
  Marker marker = makeMarker("force", id, Marker::ARROW, stamp);
  marker.points = {toPoint(contact.position), toPoint(contact.position + arrow)};
  marker.scale.x = SHAFT * scale.size;  // diameter of the shaft, of the head, length of the head [m]
  marker.scale.y = HEAD * scale.size;
  marker.scale.z = std::min(HEAD_LENGTH * scale.size, 0.5 * arrow.norm());
  marker.color = colorOf(contact.mode, 1.0);
  return marker;
}

/** @brief Side faces of the cone |r_T| <= mu r_N with its tip at the contact, opening to the side of a. */
void appendCone(const ContactState& contact, const MarkerScale& scale, Marker& cones)
{
  const double height = CONE_HEIGHT * scale.size;
  const double radius = std::min(contact.friction, 2.0) * height;
  const std_msgs::ColorRGBA color = colorOf(contact.mode, CONE_OPACITY);
  const auto rim = [&](int side)
  {
    const double angle = 2.0 * PI * side / CONE_SIDES;
    return toPoint(contact.position + height * contact.normal + radius * std::cos(angle) * contact.tangent_1 +
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

Marker makeText(const char* name_space, size_t id, const std::string& text, const Eigen::Vector3d& place,
                const MarkerScale& scale, const ros::Time& stamp)
{
  Marker marker = makeMarker(name_space, id, Marker::TEXT_VIEW_FACING, stamp);
  marker.pose.position = toPoint(place);
  marker.scale.z = LETTERS * scale.size;  // height of a capital letter [m]
  marker.color = makeColor(0.1, 0.1, 0.1, 1.0);
  marker.text = text;
  return marker;
}

std::string newtons(double force)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.3g N", force);
  return text;
}

/** @brief The sum of the forces between two shapes, above the highest of their arrows. */
size_t appendValues(const std::vector<ContactState>& contacts, double dt, const MarkerScale& scale,
                    const ros::Time& stamp, visualization_msgs::MarkerArray& message)
{
  size_t values = 0;
  for (size_t first = 0, end = 0; first < contacts.size(); first = end)
  {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d place = contacts[first].position;
    // Contacts are ordered by their shapes.
    for (end = first; end < contacts.size() && contacts[end].shape_a == contacts[first].shape_a &&
                      contacts[end].shape_b == contacts[first].shape_b;
         ++end)
    {
      const Eigen::Vector3d force = contacts[end].impulse / dt;
      const Eigen::Vector3d tip = contacts[end].position + arrowOf(force, scale);
      sum += force;
      if (end == first || tip.z() > place.z())
        place = tip;
    }
    place.z() += LETTERS * scale.size;
    if (sum.norm() > 0.0)
      message.markers.push_back(makeText("value", values++, newtons(sum.norm()), place, scale, stamp));
  }
  return values;
}

void appendLegend(const MarkerScale& scale, const ros::Time& stamp, visualization_msgs::MarkerArray& message)
{
  const std::pair<const char*, ContactMode> LINES[] = {{"open", ContactMode::OPEN},
                                                       {"impact", ContactMode::IMPACT},
                                                       {"sliding", ContactMode::SLIDING},
                                                       {"sticking", ContactMode::STICKING}};
  Eigen::Vector3d place = scale.legend;
  char length[64];
  std::snprintf(length, sizeof length, "arrow of %.2g m: %.3g N", WEIGHT_ARROW * scale.size,
                WEIGHT_ARROW * scale.size / scale.force);
  message.markers.push_back(makeText("legend", 0, length, place, scale, stamp));
  for (size_t i = 0; i < 4; ++i)
  {
    place.z() += 1.5 * LETTERS * scale.size;
    message.markers.push_back(makeText("legend", i + 1, LINES[i].first, place, scale, stamp));
    message.markers.back().color = colorOf(LINES[i].second, 1.0);
  }
}

/** @brief Whether any coordinate moves the link: the mass of a fixed base weighs on nobody's contacts. */
bool moves(const MultibodyModel& model, size_t link)
{
  return model.link_dof[link] >= 0;
}

/** @brief Of a shape in the world. @param extent farthest point of the link's shapes from its origin [m]: a mesh is no
 * larger */
Eigen::AlignedBox3d boundingBox(const CollisionShape& shape, const Eigen::Isometry3d& link_pose, double extent)
{
  const Eigen::Isometry3d pose = link_pose * shape.placement;
  const Eigen::Matrix3d axes = pose.linear().cwiseAbs();
  Eigen::Vector3d center = pose.translation();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
    half.setConstant(sphere->radius);
  else if (const auto* box = std::get_if<Box>(&shape.geometry))
    half = axes * box->half_size;
  else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry))
    half = axes * Eigen::Vector3d(cylinder->radius, cylinder->radius, cylinder->half_length);
  else if (const auto* capsule = std::get_if<Capsule>(&shape.geometry))
    half = capsule->half_length * axes.col(2) + Eigen::Vector3d::Constant(capsule->radius);
  else
  {
    center = link_pose.translation();
    half.setConstant(extent);
  }
  return {center - half, center + half};
}

/** @brief Red balls at contacts that no velocity satisfies together, pale where that is only foreseen; with the words.
 */
size_t appendBlocking(const StepCertificate& certificate, const MarkerScale& scale, const ros::Time& stamp,
                      visualization_msgs::MarkerArray& message)
{
  size_t count = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  const bool refuted = certificate.existence == Existence::REFUTED;
  for (const NamedRow& row : certificate.blocking)
  {
    if (!row.is_contact)
      continue;
    Marker ball = makeMarker("blocking", count++, Marker::SPHERE, stamp);
    ball.pose.position = toPoint(row.position);
    ball.scale.x = ball.scale.y = ball.scale.z = BLOCKING_BALL * scale.size;
    ball.color = makeColor(1.0, 0.0, 0.0, refuted ? 1.0 : 0.4);
    message.markers.push_back(ball);
    place += row.position;
  }
  if (count == 0)
    return 0;
  const std::string text = refuted ? "REFUTED: " + joinNames(certificate.blocking) : certificate.warning;
  place = place / static_cast<double>(count) + Eigen::Vector3d(0.0, 0.0, 0.5 * scale.size);
  message.markers.push_back(makeText("blocking", count++, text, place, scale, stamp));
  message.markers.back().color = makeColor(1.0, 0.0, 0.0, 1.0);
  return count;
}
}  // namespace

MarkerScale markerScale(const Simulator& simulator, double force_scale)
{
  MarkerScale scale;
  double size = 0.0;
  double heaviest = 0.0;  // what of it moves [kg]
  Eigen::AlignedBox3d all;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator.model(body);
    const std::vector<Eigen::Isometry3d>& poses = simulator.data(body).link_pose;
    Eigen::AlignedBox3d box;
    double mass = 0.0;
    if (const DynamicBody* solid = simulator.workspace(body).model.solid.get())
    {
      mass = solid->totalMass();
      for (size_t link = 1; link < poses.size(); ++link)
        box.extend(poses[link].translation());
    }
    for (size_t link = 0; link < model.links.size(); ++link)
      if (moves(model, link))
      {
        mass += model.links[link].inertia.mass;
        box.extend(poses[link].translation());
      }
    for (const CollisionShape& shape : model.shapes)
      if (moves(model, shape.link))
        box.extend(boundingBox(shape, poses[shape.link], simulator.workspace(body).model.extents[shape.link]));
    if (!box.isEmpty())
      size = std::max(size, box.sizes().maxCoeff());
    heaviest = std::max(heaviest, mass);
    all.extend(box);
  }
  if (size > 0.0)
    scale.size = size;
  const double weight = heaviest * simulator.scenario().gravity.norm();
  if (force_scale > 0.0)
    scale.force = force_scale;
  else if (weight > 0.0)
    scale.force = WEIGHT_ARROW * scale.size / weight;
  if (!all.isEmpty())
    scale.legend = Eigen::Vector3d(all.center().x(), all.center().y(), all.max().z() + LEGEND_GAP * scale.size);
  return scale;
}

MarkerCounts appendContactMarkers(const Simulator& simulator, const ros::Time& stamp, const MarkerScale& scale,
                                  const MarkerCounts& previous, visualization_msgs::MarkerArray& message)
{
  const std::vector<ContactState>& contacts = simulator.contacts();
  const double dt = impulseTime(simulator);
  Marker cones = makeMarker("cone", 0, Marker::TRIANGLE_LIST, stamp);
  cones.scale.x = cones.scale.y = cones.scale.z = 1.0;
  cones.color = makeColor(1.0, 1.0, 1.0, 1.0);
  MarkerCounts counts;
  for (const ContactState& contact : contacts)
  {
    const Eigen::Vector3d arrow = arrowOf(contact.impulse / dt, scale);
    if (!arrow.isZero(0.0))
      message.markers.push_back(makeArrow(contact, counts.arrows++, arrow, scale, stamp));
    appendCone(contact, scale, cones);
  }
  appendDeleted("force", counts.arrows, previous.arrows, stamp, message);
  if (cones.points.empty())
    cones.action = Marker::DELETE;
  message.markers.push_back(cones);
  counts.values = appendValues(contacts, dt, scale, stamp, message);
  appendDeleted("value", counts.values, previous.values, stamp, message);
  counts.blocking = appendBlocking(simulator.report().certificate, scale, stamp, message);
  appendDeleted("blocking", counts.blocking, previous.blocking, stamp, message);
  appendLegend(scale, stamp, message);
  return counts;
}

}  // namespace frictional_contact_sim
