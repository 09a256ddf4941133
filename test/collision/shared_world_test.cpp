// Copies of a world: one geometry, poses of their own, the same bits in any thread.
#include <gtest/gtest.h>

#include <thread>

#include "collision_test_support.h"

namespace frictional_contact_sim
{
namespace
{
/// Bodies of all kinds of shapes and the ground; with 200 of them the pairs are too many for a list: FCL's tree.
CollisionWorld loadHeap(int count)
{
  const std::vector<Geometry> shapes = {Box{{0.1, 0.1, 0.1}}, Sphere{0.12}, Capsule{0.05, 0.1}, Cylinder{0.1, 0.1}};
  CollisionWorld world;
  world.addStatic(HalfSpace(), Eigen::Isometry3d::Identity(), "ground");
  for (int k = 0; k < count; ++k)
  {
    world.addBody(freeBody({shapes[k % 4], shapes[(k + 1) % 4]}));
  }
  return world;
}

/// Contacts of some heaps drawn from `seed`.
std::vector<ContactPoint> dropHeaps(CollisionWorld& world, int count, int seed)
{
  std::mt19937 random(seed);
  std::vector<ContactPoint> all;
  for (int repeat = 0; repeat < 5; ++repeat)
  {
    for (int k = 0; k < count; ++k)
    {
      world.setLinkPose(k, 0, randomPose(random, 0.1 * std::cbrt(count)));
    }
    const std::vector<ContactPoint>& contacts = world.detect(0.01);
    all.insert(all.end(), contacts.begin(), contacts.end());
  }
  return all;
}

void expectSame(const std::vector<ContactPoint>& expected, const std::vector<ContactPoint>& found)
{
  ASSERT_EQ(expected.size(), found.size());
  for (size_t i = 0; i < found.size(); ++i)
  {
    ASSERT_EQ(expected[i].id, found[i].id);
    ASSERT_EQ(expected[i].gap, found[i].gap);
    ASSERT_EQ(expected[i].position, found[i].position);
    ASSERT_EQ(expected[i].normal, found[i].normal);
  }
}

class SharedWorldTest : public testing::TestWithParam<int>
{
};

TEST_P(SharedWorldTest, CopiesInTwoThreadsFindWhatOneWorldFinds)
{
  CollisionWorld alone = loadHeap(GetParam());
  const std::vector<ContactPoint> expected[2] = {dropHeaps(alone, GetParam(), 1), dropHeaps(alone, GetParam(), 2)};
  EXPECT_GT(expected[0].size(), 5u * GetParam());
  const CollisionWorld loaded = loadHeap(GetParam());
  for (const CollisionWorld* source : {&loaded, &static_cast<const CollisionWorld&>(alone)})  // one never used before
  {
    CollisionWorld copies[2] = {*source, *source};
    std::vector<ContactPoint> found[2];
    std::vector<std::thread> threads;
    for (int k = 0; k < 2; ++k)
    {
      threads.emplace_back([&, k] { found[k] = dropHeaps(copies[k], GetParam(), k + 1); });
    }
    for (std::thread& thread : threads)
    {
      thread.join();
    }
    expectSame(expected[0], found[0]);
    expectSame(expected[1], found[1]);
  }
}

INSTANTIATE_TEST_SUITE_P(ListAndTree, SharedWorldTest, testing::Values(20, 200));

TEST(SharedWorldTest, CopiesShareTheirShapesButNotTheirPoses)
{
  CollisionWorld world = loadHeap(2);
  world.setLinkPose(0, 0, at(0, 0, 5));
  world.setLinkPose(1, 0, at(0, 0, 9));
  CollisionWorld copy = world;
  for (int handle = 0; handle < world.shapeCount(); ++handle)
  {
    EXPECT_EQ(&world.convexShape(handle), &copy.convexShape(handle));
    EXPECT_EQ(&world.shape(handle), &copy.shape(handle));
  }
  EXPECT_EQ(world.lowestPoint(1), copy.lowestPoint(1));
  copy.setLinkPose(1, 0, at(0, 0, 5));
  EXPECT_FALSE(copy.detect(0.0).empty());
  EXPECT_TRUE(world.detect(0.0).empty());
}

TEST(SharedWorldTest, LoadingMoreIntoACopyLeavesTheOriginal)
{
  CollisionWorld world;
  world.addBody(freeBody({Sphere{0.1}}, "left"));
  world.addBody(freeBody({Sphere{0.1}}, "right"));
  world.setLinkPose(1, 0, at(0.15, 0, 0));
  CollisionWorld copy = world;
  copy.addStatic(HalfSpace(), Eigen::Isometry3d::Identity(), "ground");
  EXPECT_EQ(world.shapeCount(), 2);
  EXPECT_EQ(world.detect(0.0).size(), 1u);
  EXPECT_EQ(copy.detect(0.0).size(), 3u);
  copy = world;
  EXPECT_EQ(copy.detect(0.0).size(), 1u);
}

TEST(ShapeInfoTest, KnowsItsPlaceInTheModelOfItsRobot)
{
  const CollisionWorld world = loadHeap(3);
  std::vector<int> indices;
  for (int handle = 0; handle < world.shapeCount(); ++handle)
  {
    indices.push_back(world.shape(handle).index);
  }
  EXPECT_EQ(indices, (std::vector<int>{-1, 0, 1, 0, 1, 0, 1}));
}

}  // namespace
}  // namespace frictional_contact_sim
