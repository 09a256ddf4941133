#include "frictional_contact_sim/ros/markers.h"

#include <gtest/gtest.h>

#include "frictional_contact_sim/ros/body_markers.h"

namespace frictional_contact_sim
{
namespace
{
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/** @brief The 10 kg box of the rostests, at rest on the ground. */
Scenario boxScenario()
{
  Scenario scenario;
  scenario.stopping.tolerance = 1e-11;
  scenario.ground = GroundSpec();
  BodySpec body;
  body.name = "box";
  body.urdf_path = std::string(PROJECT_DIR) + "/test/ros/box_10kg.urdf";
  scenario.bodies = {body};
  return scenario;
}

BodySpec drawnBody(const std::string& link_content)
{
  BodySpec body;
  body.name = "drawn";
  body.urdf_xml =
      "<robot name='drawn'><material name='red'><color rgba='1 0 0 0.2'/></material><link name='base'>"
      "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>" +
      link_content + "</link></robot>";
  return body;
}

std::vector<Marker> ofNamespace(const MarkerArray& message, const std::string& name)
{
  std::vector<Marker> markers;
  for (const Marker& marker : message.markers)
    if (marker.ns == name)
      markers.push_back(marker);
  return markers;
}

Eigen::Vector3d vectorOf(const Marker& arrow)
{
  return {arrow.points[1].x - arrow.points[0].x, arrow.points[1].y - arrow.points[0].y,
          arrow.points[1].z - arrow.points[0].z};
}

TEST(ContactMarkersTest, ArrowsAreForcesAndTheValueIsTheirSum)
{
  Simulator simulator(boxScenario());
  for (int k = 0; k < 100; ++k)
    simulator.step();
  const MarkerScale scale = markerScale(simulator, 0.0);
  MarkerArray message;
  const MarkerCounts counts = appendContactMarkers(simulator, ros::Time(0, 1), scale, MarkerCounts(), message);
  ASSERT_EQ(simulator.contacts().size(), counts.arrows);
  const std::vector<Marker> arrows = ofNamespace(message, "force");
  for (size_t i = 0; i < arrows.size(); ++i)
  {
    const Eigen::Vector3d force = simulator.contacts()[i].impulse / 0.001;
    EXPECT_LT((vectorOf(arrows[i]) - scale.force * force).norm(), 1e-12);
    EXPECT_GT(arrows[i].color.g, 0.7F);  // it sticks
    EXPECT_LT(arrows[i].scale.z, vectorOf(arrows[i]).norm());
  }
  ASSERT_EQ(1u, counts.values);
  EXPECT_EQ("98.1 N", ofNamespace(message, "value").front().text);
  EXPECT_EQ(5u, ofNamespace(message, "legend").size());
  EXPECT_EQ(Marker::ADD, ofNamespace(message, "cone").front().action);
}

TEST(ContactMarkersTest, TheWeightIsAsLongAsTheBodyAndNoArrowIsTooShortOrTooLong)
{
  Simulator simulator(boxScenario());
  for (int k = 0; k < 100; ++k)
    simulator.step();
  const MarkerScale scale = markerScale(simulator, 0.0);
  EXPECT_NEAR(0.2, scale.size, 1e-12);
  EXPECT_NEAR(scale.size, scale.force * 98.1, 1e-12);
  for (const double factor : {1e-6, 1e6})
  {
    MarkerScale other = scale;
    other.force *= factor;
    MarkerArray message;
    appendContactMarkers(simulator, ros::Time(0, 1), other, MarkerCounts(), message);
    for (const Marker& arrow : ofNamespace(message, "force"))
      EXPECT_NEAR((factor < 1.0 ? 0.1 : 1.5) * scale.size, vectorOf(arrow).norm(), 1e-12);
  }
  EXPECT_EQ(0.25, markerScale(simulator, 0.25).force);
}

TEST(ContactMarkersTest, WhatIsGoneIsDeletedOnce)
{
  Simulator simulator(boxScenario());
  for (int k = 0; k < 100; ++k)
    simulator.step();
  const MarkerScale scale = markerScale(simulator, 0.0);
  MarkerArray message;
  MarkerCounts counts = appendContactMarkers(simulator, ros::Time(0, 1), scale, MarkerCounts(), message);
  simulator.position(0)[2] += 1.0;
  simulator.stateChanged();
  simulator.step();
  message.markers.clear();
  const MarkerCounts before = counts;
  counts = appendContactMarkers(simulator, ros::Time(0, 2), scale, before, message);
  EXPECT_EQ(0u, counts.arrows);
  EXPECT_EQ(before.arrows, ofNamespace(message, "force").size());
  for (const std::string name : {"force", "value", "cone"})
    for (const Marker& marker : ofNamespace(message, name))
      EXPECT_EQ(Marker::DELETE, marker.action) << name;
  message.markers.clear();
  appendContactMarkers(simulator, ros::Time(0, 3), scale, counts, message);
  EXPECT_TRUE(ofNamespace(message, "force").empty());
}

TEST(BodyMarkersTest, ALinkIsItsVisualElseItsCollisionAndTheGroundIsAPlane)
{
  Scenario scenario;
  scenario.ground = GroundSpec();
  scenario.ground->height = 0.3;
  const std::string collision = "<collision><geometry><box size='1 2 3'/></geometry></collision>";
  scenario.bodies = {
      drawnBody("<visual><origin xyz='0 0 0.5'/><geometry><cylinder radius='0.1' length='0.4'/></geometry>"
                "<material name='red'/></visual>" +
                collision),
      drawnBody("<visual><geometry><mesh filename='package://nowhere/mesh.dae'/></geometry></visual>" + collision)};
  scenario.bodies[1].name = "undrawn";
  scenario.bodies[0].pose = Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, 3.0));
  scenario.bodies[1].pose = Eigen::Isometry3d(Eigen::Translation3d(9.0, 2.0, 3.0));
  const Simulator simulator(scenario);
  BodyMarkers bodies(simulator);
  MarkerArray message;
  bodies.append(ros::Time(0, 1), 1.0, message);
  ASSERT_EQ(3u, message.markers.size());
  const Marker& ground = message.markers[0];
  ASSERT_EQ(6u, ground.points.size());
  for (const geometry_msgs::Point& point : ground.points)
    EXPECT_EQ(0.3, ground.pose.position.z + point.z);
  const Marker& drawn = message.markers[1];
  EXPECT_EQ(Marker::CYLINDER, drawn.type);
  EXPECT_EQ(0.2, drawn.scale.x);
  EXPECT_EQ(0.4, drawn.scale.z);
  EXPECT_EQ(1.0F, drawn.color.r);
  EXPECT_EQ(0.2F, drawn.color.a);
  EXPECT_EQ(3.5, drawn.pose.position.z);
  const Marker& undrawn = message.markers[2];  // its mesh is nowhere
  EXPECT_EQ(Marker::CUBE, undrawn.type);
  EXPECT_EQ(2.0, undrawn.scale.y);
  EXPECT_EQ(9.0, undrawn.pose.position.x);
}

TEST(BodyMarkersTest, CapsulesAreThreeShapesAndPosesFollow)
{
  Scenario scenario;
  scenario.bodies = {drawnBody("<collision><geometry><capsule radius='0.1' length='0.6'/></geometry></collision>")};
  scenario.bodies[0].pose = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 3.0));
  Simulator simulator(scenario);
  BodyMarkers bodies(simulator);
  MarkerArray message;
  bodies.append(ros::Time(0, 1), 1.0, message);
  ASSERT_EQ(3u, message.markers.size());
  EXPECT_NEAR(3.3, message.markers[1].pose.position.z, 1e-12);
  for (int k = 0; k < 100; ++k)
    simulator.step();
  message.markers.clear();
  bodies.append(ros::Time(0, 2), 1.0, message);
  EXPECT_NEAR(3.3 - 0.5 * 9.81 * 0.01, message.markers[1].pose.position.z, 1e-6);
}

}  // namespace
}  // namespace frictional_contact_sim
