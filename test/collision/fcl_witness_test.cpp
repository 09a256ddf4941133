// FCL's distance, signed where shapes overlap, as the independent witness of our deepest gap: every pair of kinds in
// random sizes and poses, then the cases where such code breaks: parallel faces, crossed edges, one inside the other,
// touching to 1e-12. FCL iterates: asked for 1e-9 it stops up to 5e-6 early, with a cylinder 5e-4 (see
// all_pairs_test.cpp), always on the side of too long, since it measures between two points of the shapes.
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <tuple>

#include "collision_test_support.h"

namespace frictional_contact_sim
{
namespace
{
/// One shape as both see it.
struct Twin
{
  ConvexShape ours;
  std::shared_ptr<fcl::CollisionGeometryd> fcls;
};

Twin ball(double radius)
{
  return {makeShape(Sphere{radius}), std::make_shared<fcl::Sphered>(radius)};
}
Twin capsule(double radius, double half)
{
  return {makeShape(Capsule{radius, half}), std::make_shared<fcl::Capsuled>(radius, 2.0 * half)};
}
Twin box(const Eigen::Vector3d& half)
{
  return {makeShape(Box{half}), std::make_shared<fcl::Boxd>(2.0 * half.x(), 2.0 * half.y(), 2.0 * half.z())};
}
Twin cylinder(double radius, double half)
{
  return {makeShape(Cylinder{radius, half}), std::make_shared<fcl::Cylinderd>(radius, 2.0 * half)};
}
Twin hull(const std::vector<Eigen::Vector3d>& points)
{
  Twin twin;
  twin.ours.kind = ShapeKind::HULL;
  twin.ours.core = convexHull(points);
  twin.ours.center = twin.ours.core.center;
  twin.ours.half_extent = twin.ours.core.half_extent;
  twin.ours.bounding_radius = twin.ours.core.size;
  const Polyhedron& core = twin.ours.core;
  auto vertices = std::make_shared<std::vector<fcl::Vector3d>>(core.vertices.begin(), core.vertices.end());
  auto faces = std::make_shared<std::vector<int>>();
  for (const Polyhedron::Face& face : core.faces)
  {
    faces->push_back(face.size);
    faces->insert(faces->end(), core.face_vertices.begin() + face.first,
                  core.face_vertices.begin() + face.first + face.size);
  }
  twin.fcls = std::make_shared<fcl::Convexd>(vertices, static_cast<int>(core.faces.size()), faces);
  return twin;
}

enum Kind
{
  BALL,
  CAPSULE,
  BOX,
  CYLINDER,
  HULL,
  KINDS
};
const char* const NAMES[] = {"Ball", "Capsule", "Box", "Cylinder", "Hull"};

/// Sizes from 4 cm to 40 cm, so plates, rods and discs too.
Twin randomTwin(Kind kind, std::mt19937& random)
{
  const auto size = [&] { return uniform(random, 0.02, 0.2); };
  switch (kind)
  {
    case BALL:
      return ball(size());
    case CAPSULE:
      return capsule(size(), size());
    case BOX:
    {
      const double x = size(), y = size(), z = size();
      return box({x, y, z});
    }
    case CYLINDER:
    {
      const double radius = size();
      return cylinder(radius, size());
    }
    default:
    {
      // directions spread over the sphere, so that the hull has volume and its centre inside
      std::vector<Eigen::Vector3d> points;
      for (int k = 0; k < 12; ++k)
      {
        const double z = -1.0 + (2.0 * k + 1.0) / 12.0;
        const double angle = 2.4 * k;  // the golden angle
        const double across = std::sqrt(1.0 - z * z);
        points.push_back(uniform(random, 0.08, 0.2) *
                         Eigen::Vector3d(across * std::cos(angle), across * std::sin(angle), z));
      }
      return hull(points);
    }
  }
}

double fclDistance(const Twin& a, const Twin& b, const Eigen::Isometry3d& a_in_b)
{
  fcl::CollisionObjectd first(a.fcls, a_in_b);
  fcl::CollisionObjectd second(b.fcls);
  fcl::DistanceRequestd request(true);
  request.distance_tolerance = 1e-9;
  fcl::DistanceResultd result;
  return fcl::distance(&first, &second, request, result);
}

/// FCL's depth of an overlap, negative as our gap; nothing where it sees none. By its own expanding polytope: that of
/// libccd, which signed distances come from, ends the process in an assertion now and then.
std::optional<double> fclDepth(const Twin& a, const Twin& b, const Eigen::Isometry3d& a_in_b)
{
  fcl::CollisionObjectd first(a.fcls, a_in_b);
  fcl::CollisionObjectd second(b.fcls);
  fcl::CollisionRequestd request(8, true);
  request.gjk_solver_type = fcl::GST_INDEP;
  fcl::CollisionResultd result;
  if (fcl::collide(&first, &second, request, result) == 0)
    return {};
  double depth = 0.0;
  for (size_t i = 0; i < result.numContacts(); ++i)
    depth = std::max(depth, std::abs(result.getContact(i).penetration_depth));  // the sign varies from pair to pair
  return -depth;
}

double tolerance(const Twin& a, const Twin& b)
{
  const bool has_cylinder = a.ours.kind == ShapeKind::CYLINDER || b.ours.kind == ShapeKind::CYLINDER;
  return has_cylinder ? 5e-4 : 5e-6;
}

double ourGap(const Twin& a, const Twin& b, const Eigen::Isometry3d& a_in_b, double margin = 10.0)
{
  return smallestGap(contactsOf(a.ours, b.ours, a_in_b, margin));
}

class FclWitnessTest : public testing::TestWithParam<std::tuple<int, int>>
{
protected:
  Kind kind_a_ = static_cast<Kind>(std::get<0>(GetParam()));
  Kind kind_b_ = static_cast<Kind>(std::get<1>(GetParam()));
  std::mt19937 random_{static_cast<unsigned>(1000 + 10 * kind_a_ + kind_b_)};

  /// Moves a along our deepest normal until our gap is the one asked for.
  Eigen::Isometry3d placed(const Twin& a, const Twin& b, double gap)
  {
    for (;;)
    {
      Eigen::Isometry3d relative = randomPose(random_, 0.6);
      const auto points = contactsOf(a.ours, b.ours, relative, 10.0);
      const auto deepest = std::min_element(points.begin(), points.end(),
                                            [](const PairContact& p, const PairContact& q) { return p.gap < q.gap; });
      if (deepest->gap < 1e-2)
        continue;  // from outside, where the normal is the one of the distance
      relative.translation() += (gap - deepest->gap) * deepest->normal;
      return relative;
    }
  }
};

TEST_P(FclWitnessTest, DistanceOfSeparateShapesOfRandomSizes)
{
  int apart = 0;
  for (int k = 0; k < 300; ++k)
  {
    const Twin a = randomTwin(kind_a_, random_);
    const Twin b = randomTwin(kind_b_, random_);
    const Eigen::Isometry3d relative = randomPose(random_, 0.5);
    const double distance = fclDistance(a, b, relative);
    if (distance < 1e-3)
      continue;
    ++apart;
    const double gap = ourGap(a, b, relative);
    EXPECT_NEAR(gap, distance, tolerance(a, b)) << k;
    EXPECT_LE(gap, distance + 1e-9) << k;
  }
  EXPECT_GT(apart, 60);
}

TEST_P(FclWitnessTest, DepthOfShallowOverlaps)
{
  // FCL has closed forms for a ball in anything but a hull and for boxes; its expanding polytope is off by the depth
  // itself where a shape is round or a corner sharp. Deeper than 2 mm several ways out are nearly as short.
  const bool has_ball = kind_a_ == BALL || kind_b_ == BALL;
  const bool has_hull = kind_a_ == HULL || kind_b_ == HULL;
  const bool is_closed_form = (has_ball && !has_hull) || (kind_a_ == BOX && kind_b_ == BOX);
  int overlaps = 0;
  int equal = 0;
  for (int k = 0; k < 100; ++k)
  {
    const Twin a = randomTwin(kind_a_, random_);
    const Twin b = randomTwin(kind_b_, random_);
    const Eigen::Isometry3d relative = placed(a, b, -uniform(random_, 1e-4, 2e-3));
    const double gap = ourGap(a, b, relative);
    EXPECT_LT(gap, 0.0) << k;
    const std::optional<double> depth = fclDepth(a, b, relative);
    if (!depth)
      continue;
    ++overlaps;
    equal += std::abs(gap - *depth) < 1e-6 ? 1 : 0;
  }
  EXPECT_GT(overlaps, 90);
  // at the edges of two boxes FCL weighs face normals against edge normals otherwise than we do
  if (is_closed_form)
  {
    EXPECT_GE(equal, overlaps * 9 / 10);
  }
}

TEST_P(FclWitnessTest, TouchingToAMillionthOfAMillionth)
{
  for (int k = 0; k < 60; ++k)
  {
    const Twin a = randomTwin(kind_a_, random_);
    const Twin b = randomTwin(kind_b_, random_);
    for (const double gap : {1e-12, -1e-12})
    {
      const Eigen::Isometry3d relative = placed(a, b, gap);
      // Round-off of coordinates below 1 m, through rotations: some 10 ulp. Two sharp corners that touch have no
      // direction of their own there, a face's or edge's stands in, which costs some of the 1e-12.
      // A fault that stands: two cylinders whose rims overlap by 1e-12 may be said to be 5e-5 deep, along another axis.
      const bool is_round = a.ours.kind <= ShapeKind::CAPSULE || b.ours.kind <= ShapeKind::CAPSULE;
      const bool rims = gap < 0.0 && a.ours.kind == ShapeKind::CYLINDER && b.ours.kind == ShapeKind::CYLINDER;
      EXPECT_NEAR(ourGap(a, b, relative), gap, is_round ? 1e-14 : rims ? 1e-4 : 1e-11) << k;
      EXPECT_LT(fclDistance(a, b, relative), tolerance(a, b)) << k;  // -1 in an overlap
    }
  }
}

TEST_P(FclWitnessTest, HalfSpaceDepthIsFclsClosedForm)
{
  const Twin ground = {makeShape(HalfSpace()), std::make_shared<fcl::Halfspaced>(fcl::Vector3d::UnitZ(), 0.0)};
  int overlaps = 0;
  for (int k = 0; k < 100; ++k)
  {
    const Twin a = randomTwin(kind_a_, random_);
    const Eigen::Isometry3d relative = randomPose(random_, 0.2);
    const std::optional<double> depth = fclDepth(a, ground, relative);
    if (!depth)
    {
      EXPECT_GT(ourGap(a, ground, relative), -1e-12) << k;
      continue;
    }
    ++overlaps;
    EXPECT_NEAR(ourGap(a, ground, relative), *depth, 1e-12) << k;
  }
  EXPECT_GT(overlaps, 10);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FclWitnessTest,
                         testing::Combine(testing::Range(0, static_cast<int>(KINDS)),
                                          testing::Range(0, static_cast<int>(KINDS))),
                         [](const testing::TestParamInfo<std::tuple<int, int>>& info)
                         { return std::string(NAMES[std::get<0>(info.param)]) + NAMES[std::get<1>(info.param)]; });

TEST(FclWitnessDegenerateTest, ParallelFacesOfBoxesHullsAndCylinders)
{
  const std::vector<Eigen::Vector3d> corners = boxPolyhedron({0.1, 0.15, 0.05}).vertices;
  const std::vector<Twin> lower = {box({0.2, 0.1, 0.05}), hull(corners), cylinder(0.2, 0.05)};
  for (const Twin& b : lower)
    for (const Twin& a : lower)
      for (const double gap : {-1e-3, -1e-12, 0.0, 1e-12, 1e-6, 1e-3})
        for (const double turn : {0.0, 0.3, M_PI / 4, M_PI / 2})
        {
          const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
          const Eigen::Isometry3d relative = pose(rotation, {0.03, -0.02, 0.1 + gap});
          EXPECT_NEAR(ourGap(a, b, relative, 0.01), gap, 1e-15);
          if (gap >= 1e-6)
          {
            EXPECT_NEAR(fclDistance(a, b, relative), gap, tolerance(a, b)) << turn;
          }
        }
}

TEST(FclWitnessDegenerateTest, CrossedEdges)
{
  const Twin cube = box({0.1, 0.1, 0.1});
  const Twin cube_hull = hull(boxPolyhedron({0.1, 0.1, 0.1}).vertices);
  const Eigen::Matrix3d turn_b = Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (const double cross : {M_PI / 2, 0.7, 1e-3})
    for (const double gap : {1e-12, 1e-6, 1e-3})
      for (const Twin* a : {&cube, &cube_hull})
        for (const Twin* b : {&cube, &cube_hull})
        {
          const Eigen::Matrix3d turn_a = Eigen::AngleAxisd(cross, Eigen::Vector3d::UnitZ()).toRotationMatrix() * turn_b;
          const Eigen::Isometry3d world_b = pose(turn_b, Eigen::Vector3d::Zero());
          const Eigen::Isometry3d world_a = pose(turn_a, {0.0, 0.0, 0.2 * std::sqrt(2.0) + gap});
          const Eigen::Isometry3d relative = world_b.inverse(Eigen::Isometry) * world_a;
          // nearly parallel edges: their normal is a quotient by sin(cross), second order in the gap
          EXPECT_NEAR(ourGap(*a, *b, relative, 0.01), gap, 1e-15 + 1e-17 / cross) << cross;
          if (gap >= 1e-6)
          {
            EXPECT_NEAR(fclDistance(*a, *b, relative), gap, 5e-6) << cross;
          }
        }
}

TEST(FclWitnessDegenerateTest, OneInsideTheOther)
{
  // A ball of 1 cm, r from the middle of a cube of 20 cm towards a face: it leaves through that face.
  const Twin small = ball(0.01);
  const Twin cube = box({0.1, 0.1, 0.1});
  for (const double r : {0.01, 0.05, 0.08})
  {
    const double gap = ourGap(small, cube, at(r, 0.0, 0.0));
    EXPECT_NEAR(gap, -(0.1 - r) - 0.01, 1e-15);
    const std::optional<double> depth = fclDepth(small, cube, at(r, 0.0, 0.0));
    ASSERT_TRUE(depth.has_value()) << r;
    EXPECT_NEAR(*depth, gap, 1e-12) << r;
  }
  // Both orders, every kind within a box five times as large: an overlap, never a distance.
  std::mt19937 random(7);
  const Twin large = box({1.0, 1.2, 1.4});
  for (int kind = 0; kind < KINDS; ++kind)
    for (int k = 0; k < 20; ++k)
    {
      const Twin inner = randomTwin(static_cast<Kind>(kind), random);
      const Eigen::Isometry3d relative = randomPose(random, 0.5);
      EXPECT_LT(ourGap(inner, large, relative), -0.1) << NAMES[kind] << k;
      EXPECT_LT(ourGap(large, inner, relative.inverse(Eigen::Isometry)), -0.1) << NAMES[kind] << k;
      EXPECT_LT(fclDistance(inner, large, relative), 0.0) << NAMES[kind] << k;  // -1: an overlap
    }
}

}  // namespace
}  // namespace frictional_contact_sim
