// The world of several robots: which pairs are tested, ids, order, no allocation, far from the origin.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "allocation_count.h"
#include "collision_test_support.h"

namespace frictional_contact_sim
{
namespace
{
const Box CUBE{{0.1, 0.1, 0.1}};

/// Ten cubes on the ground; returns their robot numbers 0 to 9.
void addStack(CollisionWorld& world, const Eigen::Isometry3d& frame)
{
  world.addStatic(HalfSpace(), frame, "ground");
  for (int k = 0; k < 10; ++k)
  {
    const int robot = world.addBody(freeBody({CUBE}));
    world.setLinkPose(robot, 0, frame * at(0, 0, 0.1 + 0.2 * k));
  }
}

TEST(BoxStackTest, EachLevelHasFourPointsWithIdsThatPersist)
{
  CollisionWorld world;
  addStack(world, Eigen::Isometry3d::Identity());
  std::mt19937 random(1);
  std::set<ContactId> ids;
  for (int step = 0; step < 50; ++step)
  {
    for (int k = 0; k < 10; ++k)
    {
      const Eigen::Vector3d jitter = (step == 0 ? 0.0 : 1e-15) * randomVector(random);
      world.setLinkPose(k, 0, at(jitter.x(), jitter.y(), 0.1 + 0.2 * k + jitter.z()));
    }
    const std::vector<ContactPoint>& contacts = world.detect(1e-3);
    ASSERT_EQ(contacts.size(), 40u);
    for (const ContactPoint& contact : contacts)
    {
      EXPECT_NEAR(contact.gap, 0.0, 1e-14);
      ids.insert(contact.id);
    }
  }
  EXPECT_EQ(ids.size(), 40u);
}

TEST(BoxStackTest, ContactsKeepAllDigitsAKilometreAway)
{
  std::mt19937 random(2);
  const Eigen::Isometry3d frame = pose(randomRotation(random), {1000.0, -700.0, 300.0});
  CollisionWorld world;
  addStack(world, frame);
  const auto contacts = world.detect(1e-3);
  ASSERT_EQ(contacts.size(), 40u);
  for (const ContactPoint& contact : contacts)
  {
    EXPECT_NEAR(contact.gap, 0.0, 1e-12);  // round-off of the poses themselves: 1e3 times 2e-16, a few times
    const bool is_ground = world.shape(contact.shape_b).body < 0;
    EXPECT_NEAR((contact.normal - (is_ground ? 1.0 : -1.0) * frame.linear().col(2)).norm(), 0.0, 1e-14);
  }
}

TEST(CollisionWorldTest, ContactsAreOrderedAndTheGroundIsB)
{
  CollisionWorld world;
  addStack(world, Eigen::Isometry3d::Identity());
  const auto contacts = world.detect(1e-3);
  for (size_t i = 1; i < contacts.size(); ++i)
  {
    EXPECT_LT(contacts[i - 1].id, contacts[i].id);
  }
  for (const ContactPoint& contact : contacts)
  {
    if (contact.shape_b == 0)
    {
      EXPECT_EQ(contact.normal, Eigen::Vector3d::UnitZ());
      EXPECT_EQ(world.shape(contact.shape_b).link_name, "ground");
    }
    else
    {
      EXPECT_LT(contact.shape_a, contact.shape_b);
      EXPECT_NEAR((contact.normal + Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-15);  // a is below
    }
  }
}

TEST(CollisionWorldTest, TheSameInputGivesTheSameBitsWhateverWasBefore)
{
  std::mt19937 random(3);
  CollisionWorld world;
  CollisionWorld fresh;
  for (CollisionWorld* each : {&world, &fresh})
  {
    each->addStatic(HalfSpace(), Eigen::Isometry3d::Identity(), "ground");
    each->addBody(freeBody({CUBE, Capsule{0.05, 0.2}}));
    each->addBody(freeBody({Cylinder{0.1, 0.1}, Sphere{0.12}}));
  }
  for (int k = 0; k < 100; ++k)
  {
    const Eigen::Isometry3d pose_0 = randomPose(random, 0.2);
    const Eigen::Isometry3d pose_1 = randomPose(random, 0.2);
    world.setLinkPose(0, 0, pose_0);
    world.setLinkPose(1, 0, pose_1);
    const auto expected = world.detect(0.01);
    world.setLinkPose(0, 0, randomPose(random, 0.2));
    world.detect(0.01);
    fresh.setLinkPose(0, 0, pose_0);
    fresh.setLinkPose(1, 0, pose_1);
    const auto& again = fresh.detect(0.01);
    ASSERT_EQ(expected.size(), again.size());
    for (size_t i = 0; i < again.size(); ++i)
    {
      EXPECT_EQ(expected[i].id, again[i].id);
      EXPECT_EQ(expected[i].gap, again[i].gap);
      EXPECT_EQ(expected[i].position, again[i].position);
      EXPECT_EQ(expected[i].normal, again[i].normal);
    }
  }
}

/// Base, upper and lower link in a chain, all cubes, and a hand on the lower link.
MultibodyModel chain()
{
  MultibodyModel model = freeBody({CUBE}, "base");
  addLink(model, "upper", 0, CUBE);
  addLink(model, "lower", 1, CUBE);
  return model;
}

TEST(SelfCollisionTest, NeighboursNeverCollideOthersDo)
{
  CollisionWorld world;
  const int robot = world.addBody(chain());
  const MultibodyModel model = chain();
  MultibodyData data(model);
  data.link_pose = {at(0, 0, 0), at(0.15, 0, 0), at(0.19, 0, 0)};  // all overlap
  world.setPoses(robot, data);
  for (const ContactPoint& contact : world.detect(1e-3))
  {
    EXPECT_EQ(world.shape(contact.shape_a).link_name, "base");
    EXPECT_EQ(world.shape(contact.shape_b).link_name, "lower");
    EXPECT_NEAR(contact.gap, -0.01, 1e-15);
  }
  EXPECT_EQ(world.detect(1e-3).size(), 4u);
}

TEST(SelfCollisionTest, OverlapsOfTheInitialPoseAreDisabledAndNamed)
{
  CollisionWorld world;
  const int robot = world.addBody(chain());
  world.addBody(freeBody({CUBE}, "crate"));
  world.setLinkPose(robot, 0, at(0, 0, 0));
  world.setLinkPose(robot, 1, at(0.5, 0, 0));
  world.setLinkPose(robot, 2, at(0.19, 0, 0));
  world.setLinkPose(1, 0, at(0, 0, 0.15));  // another robot: its overlap stays
  EXPECT_THAT(world.disableOverlaps(), testing::ElementsAre("base - lower"));
  for (const ContactPoint& contact : world.detect(1e-3))
  {
    EXPECT_EQ(world.shape(contact.shape_b).link_name, "crate");
  }
  EXPECT_FALSE(world.detect(1e-3).empty());
  EXPECT_TRUE(world.disableOverlaps().empty());
}

TEST(SelfCollisionTest, LinksThatOnlyTouchAreNotDisabled)
{
  CollisionWorld world;
  world.addBody(chain());
  world.setLinkPose(0, 1, at(0.5, 0, 0));
  world.setLinkPose(0, 2, at(0.2, 0, 0));
  EXPECT_TRUE(world.disableOverlaps().empty());
  EXPECT_EQ(world.detect(1e-3).size(), 4u);
}

TEST(SelfCollisionTest, DisabledPairsDoNotCollide)
{
  CollisionWorld world;
  world.addBody(chain());
  world.setLinkPose(0, 2, at(0.19, 0, 0));
  world.disablePair(0, "lower", "base");
  EXPECT_TRUE(world.detect(1e-3).empty());
  EXPECT_THROW(world.disablePair(0, "base", "nose"), std::invalid_argument);
  EXPECT_THROW(world.disablePair(3, "base", "lower"), std::invalid_argument);
}

TEST(FixedBaseTest, DoesNotCollideWithStaticShapesNorOtherFixedBases)
{
  MultibodyModel fixed = freeBody({CUBE}, "bench");
  fixed.joints[0].type = JointType::FIXED;
  CollisionWorld world;
  world.addStatic(HalfSpace(), Eigen::Isometry3d::Identity(), "ground");
  world.addBody(fixed);
  world.addBody(fixed);
  EXPECT_TRUE(world.detect(1e-3).empty());
  world.addBody(freeBody({CUBE}));
  world.setLinkPose(2, 0, at(0.15, 0, 0));
  EXPECT_FALSE(world.detect(1e-3).empty());
}

TEST(LowestPointTest, IsTheSupportOfAllShapes)
{
  CollisionWorld world;
  world.addBody(freeBody({CUBE, Sphere{0.05}}));
  world.addBody(freeBody({}));
  world.setLinkPose(0, 0, pose(Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitX()).toRotationMatrix(), {0, 0, 1}));
  EXPECT_NEAR(world.lowestPoint(0), 1.0 - 0.1 * std::sqrt(2.0), 1e-15);
  EXPECT_EQ(world.lowestPoint(1), std::numeric_limits<double>::infinity());
}

/// Spheres in a cube-shaped heap; with many of them the tree is the broad phase.
std::vector<ContactPoint> heap(CollisionWorld& world, int count)
{
  std::mt19937 random(9);
  for (int k = 0; k < count; ++k)
  {
    world.addBody(freeBody({Sphere{0.1}}));
    world.setLinkPose(k, 0, randomPose(random, 0.5));
  }
  return world.detect(0.01);
}

TEST(BroadPhaseTest, TheTreeFindsExactlyThePairsOfTheExhaustiveSearch)
{
  const int count = 150;  // 11175 pairs: the tree
  CollisionWorld world;
  const auto contacts = heap(world, count);
  std::mt19937 random(9);
  std::vector<Eigen::Vector3d> centers;
  for (int k = 0; k < count; ++k)
  {
    centers.push_back(randomPose(random, 0.5).translation());
  }
  std::vector<std::pair<int, int>> expected;
  for (int i = 0; i < count; ++i)
  {
    for (int k = i + 1; k < count; ++k)
    {
      if ((centers[i] - centers[k]).norm() - 0.2 <= 0.01)
      {
        expected.emplace_back(i, k);
      }
    }
  }
  std::vector<std::pair<int, int>> found;
  for (const ContactPoint& contact : contacts)
  {
    found.emplace_back(contact.shape_a, contact.shape_b);
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(found, expected);
}

TEST(CollisionWorldTest, DetectDoesNotAllocateAfterWarmUp)
{
  CollisionWorld world;
  addStack(world, Eigen::Isometry3d::Identity());
  world.addBody(freeBody({Cylinder{0.1, 0.1}, Capsule{0.05, 0.2}, Sphere{0.1}}));
  std::mt19937 random(4);
  world.setLinkPose(10, 0, randomPose(random, 0.2));
  world.detect(0.01);
  size_t contacts = 0;
  size_t most = 0;
  for (int pass = 0; pass < 2; ++pass)
  {
    std::mt19937 same(4);
    const size_t before = allocationCount();
    for (int k = 0; k < 200; ++k)
    {
      world.setLinkPose(10, 0, randomPose(same, 0.2));
      contacts += world.detect(0.01).size();
    }
    most = allocationCount() - before;  // of the second pass in the end
  }
  EXPECT_GT(contacts, 400u);
  EXPECT_EQ(most, 0u);
}

}  // namespace
}  // namespace frictional_contact_sim
