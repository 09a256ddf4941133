// The penetration check itself: depths in closed form, hulls against support functions.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/penetration_check.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::ConvexSolid;
using test_support::PenetrationCheck;

/** Depth that is found of a body at `pose` in the ground or in a 0.2 m cube on it. */
double depthOf(const std::string& urdf, const Eigen::Isometry3d& pose, bool on_cube)
{
  Scenario scene = groundScene(0.5);
  addBody(scene, "a", urdf, poseAt(5.0, 0.0, 5.0));
  if (on_cube)
    addBody(scene, "cube", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1));
  Simulator simulator(scene);
  PenetrationCheck check(simulator);
  simulator.position(0).head<3>() = pose.translation();
  simulator.position(0).segment<4>(3) = Eigen::Quaterniond(pose.linear()).coeffs();
  simulator.stateChanged();
  return check.worst().depth;
}

TEST(PenetrationCheckTest, DepthsInTheGroundAreClosedForms)
{
  const Eigen::Isometry3d pose = poseAt(0.3, 0.2, 0.09);
  EXPECT_NEAR(depthOf(sphereUrdf(0.1, 1.0), pose, false), 0.01, 1e-15);
  EXPECT_NEAR(depthOf(boxUrdf({0.2, 0.2, 0.2}, 1.0), pose, false), 0.01, 1e-15);
  Eigen::Isometry3d tilted = pose;
  tilted.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  tilted.translation().z() = 0.05;
  EXPECT_NEAR(depthOf(cylinderUrdf(0.1, 0.05, 1.0), tilted, false), 0.1 * std::sin(0.3) + 0.025 * std::cos(0.3) - 0.05,
              1e-15);
  EXPECT_EQ(depthOf(sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.11), false), 0.0);
}

TEST(PenetrationCheckTest, DepthsInAnotherBodyAreClosedForms)
{
  // A sphere presses into a face between all samples: the climb finds its lowest point.
  EXPECT_NEAR(depthOf(sphereUrdf(0.1, 1.0), poseAt(0.013, 0.027, 0.299), true), 0.001, 1e-8);
  EXPECT_NEAR(depthOf(boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.01, 0.02, 0.249), true), 0.001, 1e-12);
  // An edge lies across the top face and beyond it: no corner of one is in the other.
  Eigen::Isometry3d crossed = poseAt(0.1, 0.0, 0.2 + 0.2 * std::sqrt(0.5) - 0.001);
  crossed.linear() = Eigen::AngleAxisd(0.25 * 3.14159265358979323846, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NEAR(depthOf(boxUrdf({0.4, 0.2, 0.2}, 1.0), crossed, true), 0.001, 1e-6);
  EXPECT_EQ(depthOf(sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.301), true), 0.0);
}

TEST(ConvexHullOfTest, HoldsEveryPointAndMeetsTheSupportFunction)
{
  std::mt19937 random(11);
  const auto unit = [&] { return random() / 4294967296.0 - 0.5; };
  for (int draw = 0; draw < 20; ++draw)
  {
    // Points of a ball, and a grid with many points on one plane.
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 200; ++i)
      points.push_back(draw % 2 == 0 ? Eigen::Vector3d(Eigen::Vector3d(unit(), unit(), unit()).normalized())
                                     : Eigen::Vector3d(std::round(4.0 * unit()), std::round(4.0 * unit()),
                                                       std::round(4.0 * unit())));
    const test_support::Hull hull = test_support::convexHullOf(points);
    ASSERT_GE(hull.planes.size(), 4u);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points)
    {
      middle += point / 200.0;
      for (const test_support::Plane& plane : hull.planes)
        ASSERT_LE(plane.normal.dot(point), plane.offset + 1e-12);
    }
    // From the inside every ray leaves the hull not before the farthest point along a direction allows, and the planes
    // must not let a point out that a direction's support excludes.
    for (int ray = 0; ray < 50; ++ray)
    {
      const Eigen::Vector3d direction = Eigen::Vector3d(unit(), unit(), unit()).normalized();
      double leaves = 1e9;
      for (const test_support::Plane& plane : hull.planes)
        if (plane.normal.dot(direction) > 1e-12)
          leaves = std::min(leaves, (plane.offset - plane.normal.dot(middle)) / plane.normal.dot(direction));
      const Eigen::Vector3d exit = middle + leaves * direction;
      for (int other = 0; other < 50; ++other)
      {
        const Eigen::Vector3d n = Eigen::Vector3d(unit(), unit(), unit()).normalized();
        double support = -1e9;
        for (const Eigen::Vector3d& point : points)
          support = std::max(support, n.dot(point));
        ASSERT_LE(n.dot(exit), support + 1e-12);
      }
    }
  }
}
}  // namespace
}  // namespace frictional_contact_sim
