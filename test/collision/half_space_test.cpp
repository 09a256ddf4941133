// Everything against the ground: closed forms at round-off (a few 1e-16 times the size of 1 m; 1e-14 asked).
#include <gtest/gtest.h>

#include <cmath>

#include "collision_test_support.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double ROUND_OFF = 1e-14;

std::vector<PairContact> onGround(const Geometry& geometry, const Eigen::Isometry3d& link_pose, double margin)
{
  return contactsOf(makeShape(geometry), makeShape(HalfSpace()), link_pose, margin);
}

TEST(SphereOnGroundTest, GapIsHeightMinusRadius)
{
  std::mt19937 random(1);
  for (int k = 0; k < 100; ++k)
  {
    const double radius = uniform(random, 0.01, 1.0);
    const double height = uniform(random, 0.0, 1.5);
    const auto points = onGround(Sphere{radius}, pose(randomRotation(random), {0.3, -0.2, height}), 0.2);
    ASSERT_EQ(points.size(), height - radius <= 0.2 ? 1u : 0u);
    if (!points.empty())
    {
      EXPECT_NEAR(points[0].gap, height - radius, ROUND_OFF);
      EXPECT_NEAR((points[0].position - Eigen::Vector3d(0.3, -0.2, 0.5 * (height - radius))).norm(), 0.0, ROUND_OFF);
      EXPECT_EQ(points[0].normal, Eigen::Vector3d::UnitZ());
    }
  }
}

TEST(BoxOnGroundTest, LyingFlatItHasItsFourLowerCorners)
{
  const auto points = onGround(Box{{0.5, 0.4, 0.05}}, at(0, 0, 0.05), 0.2);
  ASSERT_EQ(points.size(), 4u);  // the upper corners are 0.1 m up, within the margin, but no contact to come
  for (const PairContact& point : points)
  {
    EXPECT_NEAR(point.gap, 0.0, 1e-16);
    EXPECT_NEAR(std::abs(point.position.x()), 0.5, 1e-15);
    EXPECT_NEAR(std::abs(point.position.y()), 0.4, 1e-15);
  }
}

TEST(BoxOnGroundTest, SmallestGapIsTheSupportFunction)
{
  std::mt19937 random(2);
  for (int k = 0; k < 200; ++k)
  {
    const Eigen::Vector3d half(0.3, 0.2, 0.1);
    const Eigen::Isometry3d link_pose = randomPose(random, 0.4);
    const Eigen::Vector3d up = link_pose.linear().row(2).transpose();
    const double lowest = link_pose.translation().z() - up.cwiseAbs().dot(half);
    const auto points = onGround(Box{half}, link_pose, 0.01);
    ASSERT_EQ(points.empty(), lowest > 0.01);
    if (!points.empty())
    {
      EXPECT_NEAR(smallestGap(points), lowest, ROUND_OFF);
    }
  }
}

TEST(CapsuleOnGroundTest, BothEndSpheresTouchWhenItLies)
{
  const double tilt = 1e-3;
  const Eigen::Matrix3d lying = Eigen::AngleAxisd(M_PI / 2 + tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const auto points = onGround(Capsule{0.1, 0.3}, pose(lying, {0, 0, 0.1}), 1e-2);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(points[0].gap, 0.3 * std::sin(tilt), ROUND_OFF);
  EXPECT_NEAR(points[1].gap, -0.3 * std::sin(tilt), ROUND_OFF);
  EXPECT_NE(points[0].feature_a, points[1].feature_a);
}

TEST(CylinderOnGroundTest, FlatEndHasEightFixedRimPoints)
{
  const auto points = onGround(Cylinder{0.2, 0.5}, at(1, 2, 0.5), 1e-3);
  ASSERT_EQ(points.size(), 8u);
  for (const PairContact& point : points)
  {
    EXPECT_NEAR(point.gap, 0.0, 1e-16);
    EXPECT_NEAR((point.position - Eigen::Vector3d(1, 2, 0)).norm(), 0.2, ROUND_OFF);
  }
}

TEST(CylinderOnGroundTest, LyingOnItsSideItHasTheEndsOfTheGenerator)
{
  for (double roll : {0.0, 0.3, 2.0})
  {
    const Eigen::Matrix3d lying =
        (Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    const auto points = onGround(Cylinder{0.1, 0.3}, pose(lying, {0, 0, 0.1}), 1e-2);
    ASSERT_EQ(points.size(), 2u);
    for (const PairContact& point : points)
    {
      EXPECT_NEAR(point.gap, 0.0, ROUND_OFF);
      EXPECT_NEAR(std::abs(point.position.x()), 0.3, ROUND_OFF);
      EXPECT_NEAR(point.position.y(), 0.0, ROUND_OFF);
    }
  }
}

TEST(CylinderOnGroundTest, TiltedDiscHasTheLowestPointOfItsRim)
{
  std::mt19937 random(3);
  for (double tilt : {1e-6, 1e-4, 0.01, 0.2, 1.0, 1.5})
  {
    const double heading = uniform(random, -3.0, 3.0);
    const double spin = uniform(random, -3.0, 3.0);
    const Eigen::Matrix3d rotation =
        (Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(spin, Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    const double lowest = -0.2 * std::sin(tilt) - 0.01 * std::cos(tilt);
    const auto points = onGround(Cylinder{0.2, 0.01}, pose(rotation, {0, 0, 0.0}), lowest + 1e-9);
    ASSERT_FALSE(points.empty());
    EXPECT_NEAR(smallestGap(points), lowest, 1e-15);
    // its place: the disc centre plus R down the slope of the disc; heading known to round-off / tilt
    const Eigen::Vector3d down = rotation * Eigen::Vector3d(-rotation(2, 0), -rotation(2, 1), 0).normalized();
    const Eigen::Vector3d expected = -0.01 * rotation.col(2) + 0.2 * down;
    double nearest = 1.0;
    for (const PairContact& point : points)
    {
      nearest = std::min(nearest, (point.position - expected).head<2>().norm());
    }
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST(CylinderOnGroundTest, RollingDiscKeepsItsContactId)
{
  Feature feature = 0;
  for (int k = 0; k < 100; ++k)
  {
    const Eigen::Matrix3d rotation =
        (Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.1 * k, Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    const double height = 0.2 * std::sin(1.2) + 0.01 * std::cos(1.2);
    const auto points = onGround(Cylinder{0.2, 0.01}, pose(rotation, {0.1 * k, 0, height}), 1e-4);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_NEAR(points[0].gap, 0.0, 1e-15);
    feature = k == 0 ? points[0].feature_a : feature;
    EXPECT_EQ(points[0].feature_a, feature);
  }
}

TEST(HalfSpaceTest, GapsDoNotDependOnThePlaneNorOnTheOrder)
{
  std::mt19937 random(4);
  const std::vector<Geometry> shapes = {Sphere{0.2}, Box{{0.2, 0.3, 0.1}}, Cylinder{0.2, 0.1}, Capsule{0.1, 0.2}};
  const ConvexShape plane = makeShape(HalfSpace());
  for (const Geometry& geometry : shapes)
  {
    const ConvexShape shape = makeShape(geometry);
    for (int k = 0; k < 50; ++k)
    {
      const Eigen::Isometry3d relative = pose(randomRotation(random), {0.2, 0.1, uniform(random, -0.1, 0.3)});
      const auto points = contactsOf(shape, plane, relative, 0.05);
      const auto swapped = contactsOf(plane, shape, relative.inverse(Eigen::Isometry), 0.05);
      ASSERT_EQ(points.size(), swapped.size());
      for (size_t i = 0; i < points.size(); ++i)
      {
        EXPECT_NEAR(points[i].gap, swapped[i].gap, ROUND_OFF);
        EXPECT_NEAR((points[i].normal + relative.linear() * swapped[i].normal).norm(), 0.0, ROUND_OFF);
        EXPECT_NEAR((points[i].position - relative * swapped[i].position).norm(), 0.0, ROUND_OFF);
      }
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
