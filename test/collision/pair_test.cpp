// Pairs of bodies: closed forms, then properties over random poses. Gaps are exact to round-off: 1e-14 for sizes of
// 0.1 to 1 m where nothing is ill-conditioned.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "collision_test_support.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double ROUND_OFF = 1e-14;

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle)
{
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

TEST(SpherePairTest, DistanceOfCentresMinusRadii)
{
  std::mt19937 random(1);
  const ConvexShape a = makeShape(Sphere{0.3});
  const ConvexShape b = makeShape(Sphere{0.2});
  for (int k = 0; k < 100; ++k)
  {
    const Eigen::Isometry3d relative = randomPose(random, 0.5);
    const double gap = relative.translation().norm() - 0.5;
    const auto points = contactsOf(a, b, relative, 0.1);
    ASSERT_EQ(points.size(), gap <= 0.1 ? 1u : 0u);
    if (!points.empty())
    {
      EXPECT_NEAR(points[0].gap, gap, ROUND_OFF);
      EXPECT_NEAR((points[0].normal - relative.translation().normalized()).norm(), 0.0, ROUND_OFF);
      EXPECT_NEAR((points[0].position - (0.2 + 0.5 * gap) * relative.translation().normalized()).norm(), 0.0,
                  ROUND_OFF);
    }
  }
}

TEST(SphereBoxTest, ClosestPointOfTheBoxIsTheClampedCentre)
{
  std::mt19937 random(2);
  const Eigen::Vector3d half(0.3, 0.2, 0.1);
  const ConvexShape sphere = makeShape(Sphere{0.15});
  const ConvexShape box = makeShape(Box{half});
  int inside = 0;
  for (int k = 0; k < 500; ++k)
  {
    const Eigen::Isometry3d relative = randomPose(random, 0.5);
    const Eigen::Vector3d center = relative.translation();
    const Eigen::Vector3d outside = center - center.cwiseMin(half).cwiseMax(-half);
    double gap = outside.norm() - 0.15;
    if (outside.norm() == 0.0)
    {
      gap = (center.cwiseAbs() - half).maxCoeff() - 0.15;
      ++inside;
    }
    const auto points = contactsOf(sphere, box, relative, 0.05);
    ASSERT_EQ(points.size(), gap <= 0.05 ? 1u : 0u) << k;
    if (!points.empty())
    {
      EXPECT_NEAR(points[0].gap, gap, ROUND_OFF);
      EXPECT_NEAR(points[0].normal.norm(), 1.0, ROUND_OFF);
    }
  }
  EXPECT_GT(inside, 10);
}

TEST(SphereCapsuleTest, ClosestPointOfTheAxisIsTheClampedHeight)
{
  std::mt19937 random(3);
  const ConvexShape sphere = makeShape(Sphere{0.15});
  const ConvexShape capsule = makeShape(Capsule{0.1, 0.3});
  for (int k = 0; k < 200; ++k)
  {
    const Eigen::Isometry3d relative = randomPose(random, 0.5);
    const Eigen::Vector3d center = relative.translation();
    const double gap = (center - std::clamp(center.z(), -0.3, 0.3) * Eigen::Vector3d::UnitZ()).norm() - 0.25;
    const auto points = contactsOf(sphere, capsule, relative, 0.05);
    ASSERT_EQ(points.size(), gap <= 0.05 ? 1u : 0u);
    if (!points.empty())
    {
      EXPECT_NEAR(points[0].gap, gap, ROUND_OFF);
    }
  }
}

TEST(CapsulePairTest, CrossedCapsulesTouchAtOnePoint)
{
  const ConvexShape capsule = makeShape(Capsule{0.1, 0.5});
  const auto points = contactsOf(capsule, capsule, pose(about({1, 0, 0}, 1.0), {0.21, 0.05, 0.1}), 0.05);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].gap, 0.01, ROUND_OFF);
  EXPECT_NEAR((points[0].normal - Eigen::Vector3d::UnitX()).norm(), 0.0, ROUND_OFF);
}

TEST(CapsulePairTest, ParallelCapsulesTouchAtTheEndsOfTheirOverlap)
{
  const ConvexShape capsule = makeShape(Capsule{0.1, 0.5});
  for (double tilt : {0.0, 1e-16, 1e-9, 1e-4})
  {
    const auto points = contactsOf(capsule, capsule, pose(about({1, 0, 0}, tilt), {0.2, 0.0, 0.3}), 0.05);
    ASSERT_GE(points.size(), 2u) << tilt;
    std::vector<double> heights;
    for (const PairContact& point : points)
    {
      EXPECT_NEAR(point.gap, 0.0, 1e-7);
      heights.push_back(point.position.z());
    }
    std::sort(heights.begin(), heights.end());
    EXPECT_NEAR(heights.front(), -0.2, 1e-3);
    EXPECT_NEAR(heights.back(), 0.5, 1e-3);
  }
}

TEST(BoxOnBoxTest, EqualBoxesInAStackShareFourPointsWhateverTheRoundOff)
{
  std::mt19937 random(4);
  const ConvexShape box = makeShape(Box{{0.1, 0.1, 0.05}});
  std::set<ContactId> features;
  for (int k = 0; k < 200; ++k)
  {
    const Eigen::Vector3d jitter = (k == 0 ? 0.0 : 1e-15) * randomVector(random);
    const Eigen::Matrix3d turn = about(randomVector(random), k == 0 ? 0.0 : 1e-15);
    const auto points = contactsOf(box, box, pose(turn, Eigen::Vector3d(0, 0, 0.1) + jitter), 1e-3);
    ASSERT_EQ(points.size(), 4u);
    for (const PairContact& point : points)
    {
      EXPECT_NEAR(point.gap, 0.0, 5e-15);
      EXPECT_NEAR(std::abs(point.position.x()), 0.1, 1e-14);
      EXPECT_NEAR(std::abs(point.position.y()), 0.1, 1e-14);
      features.insert(makeContactId(0, 0, point.feature_a, point.feature_b));
    }
  }
  EXPECT_EQ(features.size(), 4u);  // the same four ids in all cases
}

TEST(BoxOnBoxTest, OverhangingBoxTouchesOnTheCommonRectangle)
{
  const ConvexShape box = makeShape(Box{{0.1, 0.1, 0.05}});
  const auto points = contactsOf(box, box, at(0.08, -0.03, 0.1), 1e-3);
  ASSERT_EQ(points.size(), 4u);
  for (const PairContact& point : points)
  {
    EXPECT_NEAR(point.gap, 0.0, 1e-16);
    EXPECT_NEAR(std::abs(point.position.x() - 0.04), 0.06, ROUND_OFF);
    EXPECT_NEAR(std::abs(point.position.y() + 0.015), 0.085, ROUND_OFF);
  }
}

TEST(BoxOnBoxTest, PointsComeInTheOrderOfTheirFeatures)
{
  const ConvexShape box = makeShape(Box{{0.1, 0.1, 0.05}});
  const auto points = contactsOf(box, box, at(0.08, -0.03, 0.1), 1e-3);
  ASSERT_EQ(points.size(), 4u);
  // A corner of a on the face of b, two crossings of edges, a corner of b in the face of a.
  EXPECT_EQ(points.front().feature_a >> FEATURE_INDEX_BITS, static_cast<Feature>(FeatureKind::VERTEX));
  EXPECT_EQ(points.back().feature_a >> FEATURE_INDEX_BITS, static_cast<Feature>(FeatureKind::FACE));
  for (size_t i = 1; i < points.size(); ++i)
  {
    EXPECT_LT(std::make_pair(points[i - 1].feature_a, points[i - 1].feature_b),
              std::make_pair(points[i].feature_a, points[i].feature_b));
  }
}

TEST(BoxOnBoxTest, TurnedByFortyFiveDegreesTheCommonOctagonHasEightPoints)
{
  const ConvexShape box = makeShape(Box{{0.1, 0.1, 0.05}});
  const auto points = contactsOf(box, box, pose(about({0, 0, 1}, M_PI / 4), {0, 0, 0.1}), 1e-3);
  ASSERT_EQ(points.size(), 8u);
  for (const PairContact& point : points)
  {
    EXPECT_NEAR(std::max(std::abs(point.position.x()), std::abs(point.position.y())), 0.1, ROUND_OFF);
    EXPECT_NEAR(point.gap, 0.0, ROUND_OFF);
  }
}

TEST(BoxOnBoxTest, CrossedEdgesTouchAtOnePointWithTheNormalOfBoth)
{
  const ConvexShape box = makeShape(Box{{0.1, 0.1, 0.1}});
  // b's edge along y at the top after turning it by 45 degrees about y; a's edge along x at its bottom
  const Eigen::Matrix3d turn_b = about({0, 1, 0}, M_PI / 4);
  const Eigen::Matrix3d turn_a = about({1, 0, 0}, M_PI / 4);
  const double reach = 0.2 * std::sqrt(2.0);
  for (double gap : {-1e-3, -1e-12, 0.0, 1e-15, 1e-6, 1e-3})
  {
    const Eigen::Isometry3d b = pose(turn_b, {0, 0, 0});
    const Eigen::Isometry3d a = pose(turn_a, {0.02, 0.03, reach + gap});
    const auto points = contactsOf(box, box, b.inverse(Eigen::Isometry) * a, 5e-3);
    ASSERT_EQ(points.size(), 1u) << gap;
    EXPECT_NEAR(points[0].gap, gap, 1e-15);
    EXPECT_NEAR((turn_b * points[0].normal - Eigen::Vector3d::UnitZ()).norm(), 0.0, ROUND_OFF);
    EXPECT_NEAR((turn_b * points[0].position - Eigen::Vector3d(0.02 - 0.02, 0.03 - 0.03, 0)).head<2>().norm(),
                std::hypot(0.0, 0.03), 0.04);
  }
}

TEST(BoxBesideBoxTest, CornersPastEachOtherAreMeasuredAcrossTheGap)
{
  const ConvexShape box = makeShape(Box{{0.1, 0.1, 0.1}});
  const auto points = contactsOf(box, box, at(0.203, 0.204, 0.2), 0.01);
  ASSERT_FALSE(points.empty());
  for (const PairContact& point : points)
  {
    EXPECT_NEAR(point.gap, 0.005, ROUND_OFF);
    EXPECT_NEAR((point.normal - Eigen::Vector3d(0.6, 0.8, 0)).norm(), 0.0, 1e-12);
  }
}

TEST(CapsuleOnBoxTest, LyingOnTheFaceItTouchesAtBothEnds)
{
  const ConvexShape capsule = makeShape(Capsule{0.1, 0.3});
  const ConvexShape box = makeShape(Box{{0.5, 0.5, 0.2}});
  for (double tilt : {0.0, 1e-15, 1e-6, 1e-3})
  {
    const auto points = contactsOf(capsule, box, pose(about({0, 1, 0}, M_PI / 2 + tilt), {0, 0, 0.3}), 1e-2);
    ASSERT_EQ(points.size(), 2u);
    EXPECT_NEAR(points[0].gap, 0.3 * std::sin(tilt), ROUND_OFF);
    EXPECT_NEAR(points[1].gap, -0.3 * std::sin(tilt), ROUND_OFF);
  }
}

TEST(CylinderPairTest, LogsSideBySideTouchAtBothEndsOfTheirLine)
{
  const ConvexShape log = makeShape(Cylinder{0.1, 0.5});
  for (double roll : {0.0, 0.3, 1.0})
  {
    for (double tilt : {0.0, 1e-16, 1e-12})
    {
      const Eigen::Matrix3d turn = about({0, 1, 0}, tilt) * about({0, 0, 1}, roll);
      const auto points = contactsOf(log, log, pose(turn, {0.12, 0.16, 0.0}), 1e-3);
      ASSERT_EQ(points.size(), 2u) << roll << " " << tilt;
      for (const PairContact& point : points)
      {
        EXPECT_NEAR(point.gap, 0.0, tilt + 1e-15);
        EXPECT_NEAR((point.normal - Eigen::Vector3d(0.6, 0.8, 0.0)).norm(), 0.0, 10 * tilt + 1e-14);
        EXPECT_NEAR((point.position.head<2>() - Eigen::Vector2d(0.06, 0.08)).norm(), 0.0, 1e-11);
        EXPECT_NEAR(std::abs(point.position.z()), 0.5, tilt + ROUND_OFF);
      }
    }
  }
}

TEST(CylinderPairTest, ShiftedLogsTouchAlongTheirOverlap)
{
  const ConvexShape log = makeShape(Cylinder{0.1, 0.5});
  const auto points = contactsOf(log, log, at(0.0, 0.2, 0.3), 1e-3);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(std::min(points[0].position.z(), points[1].position.z()), -0.2, ROUND_OFF);
  EXPECT_NEAR(std::max(points[0].position.z(), points[1].position.z()), 0.5, ROUND_OFF);
}

TEST(CylinderPairTest, CrossedLogsTouchAtOnePoint)
{
  const ConvexShape log = makeShape(Cylinder{0.1, 0.5});
  const auto points = contactsOf(log, log, pose(about({1, 0, 0}, 1.0), {0.2 + 1e-4, 0.05, 0.1}), 1e-3);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].gap, 1e-4, ROUND_OFF);
  EXPECT_NEAR((points[0].normal - Eigen::Vector3d::UnitX()).norm(), 0.0, ROUND_OFF);
}

TEST(CylinderPairTest, StackedCylindersShareTheRimOfTheSmaller)
{
  const ConvexShape wide = makeShape(Cylinder{0.2, 0.1});
  const ConvexShape narrow = makeShape(Cylinder{0.1, 0.1});
  const auto points = contactsOf(narrow, wide, pose(about({0, 0, 1}, 0.3), {0.05, 0, 0.2}), 1e-3);
  ASSERT_EQ(points.size(), 8u);
  for (const PairContact& point : points)
  {
    EXPECT_NEAR(point.gap, 0.0, 1e-15);
    EXPECT_NEAR((point.position.head<2>() - Eigen::Vector2d(0.05, 0)).norm(), 0.1, ROUND_OFF);
  }
}

TEST(CylinderOnBoxTest, StandsOnTheRimAndIsCutByTheBorder)
{
  const ConvexShape cylinder = makeShape(Cylinder{0.1, 0.2});
  const ConvexShape box = makeShape(Box{{0.5, 0.5, 0.1}});
  const auto inside = contactsOf(cylinder, box, at(0.1, 0.2, 0.3), 1e-3);
  ASSERT_EQ(inside.size(), 8u);
  // centre 0.05 inside the border: nothing beyond it, and the cuts of the rim at y = +- sqrt(R^2 - 0.05^2)
  const auto cut = contactsOf(cylinder, box, at(0.45, 0.2, 0.3), 1e-3);
  ASSERT_GE(cut.size(), 4u);
  int cuts = 0;
  for (const PairContact& point : cut)
  {
    EXPECT_NEAR(point.gap, 0.0, 1e-15);
    EXPECT_LE(point.position.x(), 0.5 + ROUND_OFF);
    cuts += std::abs(std::abs(point.position.y() - 0.2) - std::sqrt(0.0075)) < 1e-13 ? 1 : 0;
  }
  EXPECT_EQ(cuts, 2);
}

TEST(CylinderOnBoxTest, LyingItTouchesAtTheEndsOfTheGenerator)
{
  const ConvexShape cylinder = makeShape(Cylinder{0.1, 0.2});
  const ConvexShape box = makeShape(Box{{0.5, 0.5, 0.1}});
  for (double tilt : {0.0, 1e-15, 1e-9, 1e-4})
  {
    const Eigen::Matrix3d turn = about({0, 1, 0}, M_PI / 2 + tilt);
    const auto points = contactsOf(cylinder, box, pose(turn, {0.1, 0.1, 0.2}), 1e-3);
    ASSERT_EQ(points.size(), 2u) << tilt;
    const double lowest = 0.1 - 0.2 * std::sin(tilt) - 0.1 * std::cos(tilt);
    EXPECT_NEAR(smallestGap(points), lowest, 1e-15);
  }
}

TEST(HullOnHullTest, CubesAsHullsHaveTheManifoldOfBoxes)
{
  const std::vector<Eigen::Vector3d> corners = boxPolyhedron({0.1, 0.1, 0.05}).vertices;
  ConvexShape hull = makeShape(Box{{0.1, 0.1, 0.05}});
  hull.kind = ShapeKind::HULL;
  hull.core = convexHull(corners);
  ASSERT_EQ(hull.core.faces.size(), 6u);
  std::mt19937 random(7);
  for (int k = 0; k < 50; ++k)
  {
    const Eigen::Vector3d jitter = 1e-15 * randomVector(random);
    const auto points =
        contactsOf(hull, hull, pose(about(randomVector(random), 1e-15), Eigen::Vector3d(0, 0, 0.1) + jitter), 1e-3);
    ASSERT_EQ(points.size(), 4u);
    for (const PairContact& point : points)
    {
      EXPECT_NEAR(point.gap, 0.0, 5e-15);
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
