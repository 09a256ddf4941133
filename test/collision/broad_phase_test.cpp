// Who looks for near pairs, and what was looked for before, changes nothing of what is found.
#include <gtest/gtest.h>

#include <algorithm>

#include "collision_test_support.h"

namespace frictional_contact_sim
{
namespace
{
constexpr BroadPhaseKind KINDS[] = {BroadPhaseKind::LIST, BroadPhaseKind::FCL, BroadPhaseKind::AUTO};

void expectSame(const std::vector<ContactPoint>& expected, const std::vector<ContactPoint>& found, int step)
{
  ASSERT_EQ(expected.size(), found.size()) << step;
  for (size_t i = 0; i < expected.size(); ++i)
  {
    ASSERT_EQ(expected[i].id, found[i].id) << step;
    ASSERT_EQ(expected[i].position, found[i].position) << step;
    ASSERT_EQ(expected[i].normal, found[i].normal) << step;
    ASSERT_EQ(expected[i].gap, found[i].gap) << step;
  }
}

/// A wheel between two cubes, on one body; a ball; a plate on a fixed base that nothing joins: some 3 shapes a body.
MultibodyModel someBody(int k)
{
  MultibodyModel model = k % 3 == 0   ? freeBody({Box{{0.05, 0.08, 0.06}}})
                         : k % 3 == 1 ? freeBody({Sphere{0.07}, Capsule{0.03, 0.1}})
                                      : freeBody({Box{{0.2, 0.2, 0.02}}});
  if (k % 3 == 0)
  {
    addLink(model, "wheel", 0, Cylinder{0.05, 0.04});
    addLink(model, "tip", 1, Sphere{0.06});
  }
  if (k % 3 == 2 && k % 2 == 0)
    model.joints[0].type = JointType::FIXED;
  return model;
}

struct Scene
{
  Scene(BroadPhaseKind kind, int count)
  {
    world.setBroadPhase(kind);
    world.addStatic(Box{{0.3, 0.3, 0.1}}, at(0.2, 0.0, -0.2), "step");
    for (int k = 0; k < count; ++k)
    {
      const MultibodyModel model = someBody(k);
      world.addBody(model);
      links.push_back(static_cast<int>(model.links.size()));
    }
    world.addStatic(HalfSpace(), at(0, 0, -0.4), "ground");
  }
  void move(int body, std::mt19937& random, double reach)
  {
    for (int link = 0; link < links[body]; ++link)
      world.setLinkPose(body, link, randomPose(random, reach));
  }
  CollisionWorld world;
  std::vector<int> links;
};

TEST(BroadPhaseKindTest, ListTreesAndAutoFindTheSameBitsWhateverMoves)
{
  // All bodies jump, a few jump, all creep within their fat boxes, nothing moves; margins grow and shrink by body.
  for (const int count : {5, 60})
  {
    std::vector<Scene> scenes;
    for (const BroadPhaseKind kind : KINDS)
      scenes.emplace_back(kind, count);
    std::mt19937 choice(5);
    size_t contacts = 0;
    for (int step = 0; step < 200; ++step)
    {
      const int moved = step % 5 == 0 ? count : step % 5 == 1 ? 0 : 1 + step % 7;
      std::vector<double> margins;
      for (int body = 0; body < count; ++body)
        margins.push_back(uniform(choice, 0.0, step % 4 == 0 ? 0.1 : 0.01));
      for (Scene& scene : scenes)
      {
        std::mt19937 random(100 + step);
        for (int k = 0; k < moved; ++k)
          scene.move(k * 13 % count, random, 0.5);
      }
      const std::vector<ContactPoint> expected = scenes[0].world.detect(margins);
      contacts += expected.size();
      for (size_t k = 1; k < scenes.size(); ++k)
        expectSame(expected, scenes[k].world.detect(margins), step);
      if (step % 10 == 0)
      {
        // a copy keeps nothing, and finds the same
        CollisionWorld copy(scenes[1].world);
        expectSame(expected, copy.detect(margins), step);
      }
    }
    EXPECT_GT(contacts, 500u);
  }
}

TEST(BroadPhaseKindTest, AFewShapesInFreeFallAreFoundWhenTheyArrive)
{
  // A fine motion: fat boxes are left one by one, never all together.
  for (const BroadPhaseKind kind : KINDS)
  {
    CollisionWorld world;
    world.setBroadPhase(kind);
    world.addStatic(HalfSpace(), Eigen::Isometry3d::Identity(), "ground");
    const int count = 100;
    for (int k = 0; k < count; ++k)
    {
      world.addBody(freeBody({Sphere{0.05}}));
      world.setLinkPose(k, 0, at(0.2 * (k % 10), 0.2 * (k / 10), 0.05));
    }
    for (double height = 0.5; height > 0.05; height -= 0.003)
    {
      world.setLinkPose(44, 0, at(0.8, 0.87, height));  // lands on number 44's neighbour 54 at (0.8, 1.0)
      const double neighbour = std::hypot(0.13, height - 0.05) - 0.1;
      size_t expected = count - 1 + (height - 0.05 <= 1e-3) + (neighbour <= 1e-3);
      expected += std::hypot(0.27, height - 0.05) - 0.1 <= 1e-3;  // 34
      EXPECT_EQ(world.detect(1e-3).size(), expected) << height;
    }
  }
}

TEST(BroadPhaseKindTest, AMovingBodyFindsAFixedOneListedBeforeIt)
{
  for (const BroadPhaseKind kind : {BroadPhaseKind::LIST, BroadPhaseKind::FCL})
  {
    CollisionWorld world;
    MultibodyModel table = freeBody({Box{Eigen::Vector3d(1.0, 1.0, 0.1)}}, "table");
    table.joints.front().type = JointType::FIXED;
    const int fixed = world.addBody(table);
    const int moving = world.addBody(freeBody({Box{Eigen::Vector3d(0.1, 0.1, 0.1)}}, "box"));
    world.setBroadPhase(kind);
    world.setLinkPose(fixed, 0, Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, -0.1)));
    world.setLinkPose(moving, 0, Eigen::Isometry3d(Eigen::Translation3d(0.3, 0.2, 0.1)));
    EXPECT_EQ(world.detect(1e-6).size(), 4u);
  }
}

TEST(BroadPhaseKindTest, AMarginOfAFastBodyDoesNotReachThirdBodies)
{
  CollisionWorld world;
  for (int k = 0; k < 3; ++k)
  {
    world.addBody(freeBody({Sphere{0.1}}));
    world.setLinkPose(k, 0, at(0.25 * k, 0, 0));
  }
  const auto& points = world.detect(std::vector<double>{0.0, 0.0, 0.1});
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].shape_a, 1);
  EXPECT_EQ(points[0].shape_b, 2);
}

TEST(BroadPhaseKindTest, AMovingHalfSpaceFindsWhatItReaches)
{
  for (const BroadPhaseKind kind : KINDS)
  {
    CollisionWorld world;
    world.setBroadPhase(kind);
    world.addBody(freeBody({HalfSpace()}));
    for (int k = 0; k < 80; ++k)
    {
      world.addBody(freeBody({Sphere{0.1}}));
      world.setLinkPose(1 + k, 0, at(0.3 * k, 0, 0.1 + 0.01 * k));
    }
    for (int k = 0; k < 80; ++k)
    {
      world.setLinkPose(0, 0, at(0, 0, 0.01 * k + 0.001));
      EXPECT_EQ(world.detect(0.0).size(), static_cast<size_t>(k + 1));
    }
  }
}

TEST(BroadPhaseKindTest, WhatIsNotANumberTouchesNothingAndSpoilsNothing)
{
  for (const BroadPhaseKind kind : KINDS)
  {
    CollisionWorld world;
    world.setBroadPhase(kind);
    for (int k = 0; k < 80; ++k)
    {
      world.addBody(freeBody({Sphere{0.1}}));
      world.setLinkPose(k, 0, at(0.2 * k, 0, 0));
    }
    EXPECT_EQ(world.detect(1e-3).size(), 79u);
    world.setLinkPose(40, 0, at(std::numeric_limits<double>::quiet_NaN(), 0, 0));
    EXPECT_EQ(world.detect(1e-3).size(), 77u);
    EXPECT_EQ(world.detect(1e-3).size(), 77u);
    world.setLinkPose(40, 0, at(8.0, 0, 0));
    EXPECT_EQ(world.detect(1e-3).size(), 79u);
  }
}

TEST(OrientedBoxesTest, NeverPartWhatTheNarrowPhaseFindsNear)
{
  // Long, flat and round shapes in random poses: the world, which asks the boxes first, against the narrow phase alone.
  const std::vector<Geometry> kinds = {Capsule{0.02, 0.3}, Box{{0.3, 0.2, 0.01}}, Cylinder{0.2, 0.02},
                                       Cylinder{0.01, 0.3}, Box{{0.1, 0.1, 0.1}}};
  std::mt19937 random(11);
  size_t contacts = 0;
  int apart = 0;
  for (const Geometry& first : kinds)
    for (const Geometry& second : kinds)
    {
      CollisionWorld world;
      world.addBody(freeBody({first}));
      world.addBody(freeBody({second}));
      for (int k = 0; k < 400; ++k)
      {
        const double margin = k % 2 == 0 ? 0.0 : uniform(random, 0.0, 0.1);
        const Eigen::Isometry3d relative = randomPose(random, 0.4);
        world.setLinkPose(0, 0, relative);
        const auto expected = contactsOf(makeShape(first), makeShape(second), relative, margin);
        const auto& found = world.detect(margin);
        ASSERT_EQ(found.size(), expected.size()) << k;
        for (size_t i = 0; i < found.size(); ++i)
        {
          EXPECT_EQ(found[i].gap, expected[i].gap) << k;
        }
        contacts += found.size();
        apart += found.empty() ? 1 : 0;
      }
    }
  EXPECT_GT(contacts, 3000u);
  EXPECT_GT(apart, 3000);
}

TEST(BroadPhaseKindTest, TenThousandShapesTakeMemoryInProportion)
{
  // n^2 bits alone would be 12 MB; nothing is asked here but that it works, times are in docs/large_scenes.md.
  CollisionWorld world;
  for (int k = 0; k < 10000; ++k)
  {
    world.addBody(freeBody({Sphere{0.1}}));
    world.setLinkPose(k, 0, at(0.2 * (k % 100), 0.2 * (k / 100), 0));
  }
  EXPECT_EQ(world.detect(1e-3).size(), 2u * 99u * 100u);
}

}  // namespace
}  // namespace frictional_contact_sim
