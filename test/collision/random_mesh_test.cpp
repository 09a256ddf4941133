// Hulls of random meshes: they hold the mesh, have its size and volume, and searches along them give the answer of a
// search through all vertices and faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "collision_test_support.h"
#include "support/random_mesh.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::makeRandomMesh;
using test_support::RandomMesh;

constexpr std::uint32_t SEEDS = 150;
/// Welding and merging leave out what is within 2.5e-7 + 5e-7 of the size, or 6 roundings of single precision.
constexpr double LEFT_OUT = 1e-6;

double areaOf(const Polyhedron& hull)
{
  double area = 0.0;
  for (const Polyhedron::Face& face : hull.faces)
    area += face.area;
  return area;
}

double volumeOf(const Polyhedron& hull)
{
  double volume = 0.0;
  for (const Polyhedron::Face& face : hull.faces)
    volume += face.area * (face.offset - face.normal.dot(hull.interior)) / 3.0;
  return volume;
}

double lowestOf(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& n)
{
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : points)
    lowest = std::min(lowest, n.dot(point));
  return lowest;
}

/// Directions that matter: any, axes, normals of faces, across edges, and these with a little noise.
std::vector<Eigen::Vector3d> directionsFor(const Polyhedron& hull, std::mt19937& random)
{
  std::vector<Eigen::Vector3d> directions;
  const auto pick = [&](size_t size) { return static_cast<size_t>(uniform(random, 0.0, 0.999999) * size); };
  for (int k = 0; k < 40; ++k)
  {
    const Polyhedron::Edge& edge = hull.edges[pick(hull.edges.size())];
    const Eigen::Vector3d across =
        hull.faces[edge.face[0]].normal + uniform(random, 0.0, 1.0) * hull.faces[edge.face[1]].normal;
    for (const Eigen::Vector3d& n : {randomVector(random), hull.faces[pick(hull.faces.size())].normal, across})
    {
      if (n.norm() < 1e-3)
        continue;
      directions.push_back(n.normalized());
      for (const double noise : {1e-15, 1e-9, 1e-6})
        directions.push_back((n.normalized() + noise * randomVector(random)).normalized());
    }
  }
  for (int i = 0; i < 3; ++i)
    for (const double sign : {1.0, -1.0})
      directions.push_back(sign * Eigen::Vector3d::Unit(i));
  return directions;
}

class RandomMeshTest : public testing::TestWithParam<std::uint32_t>
{
};

TEST_P(RandomMeshTest, HullHoldsTheMeshAndIsMadeOfItsVertices)
{
  const RandomMesh mesh = makeRandomMesh(GetParam());
  const Polyhedron hull = convexHull(mesh.vertices);
  SCOPED_TRACE(mesh.name + ", " + std::to_string(mesh.vertices.size()) + " vertices");
  EXPECT_EQ(static_cast<int>(hull.vertices.size() + hull.faces.size()) - static_cast<int>(hull.edges.size()), 2);
  std::set<std::array<double, 3>> known;
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    known.insert({vertex.x(), vertex.y(), vertex.z()});
  for (const Eigen::Vector3d& vertex : hull.vertices)
    ASSERT_EQ(known.count({vertex.x(), vertex.y(), vertex.z()}), 1u);
  std::mt19937 random(GetParam());
  for (const Eigen::Vector3d& n : directionsFor(hull, random))
  {
    // s of the mesh and of its hull, whatever the direction: no point is farther outside
    ASSERT_NEAR(lowestOf(hull.vertices, n), lowestOf(mesh.vertices, n), LEFT_OUT * mesh.size);
  }
  EXPECT_NEAR(volumeOf(hull), mesh.hull_volume, LEFT_OUT * mesh.size * areaOf(hull));
}

TEST_P(RandomMeshTest, LowestPointIsThatOfAllVertices)
{
  const ConvexShape shape = makeShape(convexHull(makeRandomMesh(GetParam()).vertices));
  std::mt19937 random(GetParam());
  for (const Eigen::Vector3d& n : directionsFor(shape.core, random))
    ASSERT_EQ(lowestAlong(shape, n), lowestOf(shape.core.vertices, n));
}

TEST_P(RandomMeshTest, GapToAPlaneIsThatOfTheLowestVertexAndAllPointsWithinTheMarginAreFound)
{
  const RandomMesh mesh = makeRandomMesh(GetParam());
  const ConvexShape shape = makeShape(convexHull(mesh.vertices));
  const ConvexShape plane = makeShape(HalfSpace());
  std::mt19937 random(GetParam());
  for (const Eigen::Vector3d& down : directionsFor(shape.core, random))
  {
    Eigen::Isometry3d relative = Eigen::Isometry3d::Identity();
    relative.linear() = Eigen::Quaterniond::FromTwoVectors(down, -Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d up = relative.linear().row(2).transpose();
    relative.translation().z() = -lowestOf(shape.core.vertices, up) + uniform(random, -1e-3, 1e-3) * mesh.size;
    const double margin = uniform(random, 1e-3, 0.1) * mesh.size;
    const auto points = contactsOf(shape, plane, relative, margin);
    const double lowest = lowestOf(shape.core.vertices, up) + relative.translation().z();
    size_t within = 0;
    for (const Eigen::Vector3d& vertex : shape.core.vertices)
      within += up.dot(vertex) + relative.translation().z() <= margin ? 1 : 0;
    ASSERT_EQ(points.size(), std::min<size_t>(within, MAX_PAIR_POINTS));
    // of more than eight points those within 1e-6 of the size of the deepest count as equally deep (reduceManifold)
    const double least = smallestGap(points);
    ASSERT_NEAR(least, lowest, (within > MAX_PAIR_POINTS ? 1e-6 : 1e-12) * mesh.size);
    ASSERT_NEAR(least, lowestOf(mesh.vertices, up) + relative.translation().z(), 2.0 * LEFT_OUT * mesh.size);
    for (const PairContact& point : points)
    {
      const Eigen::Vector3d& vertex = shape.core.vertices.at(point.feature_a);  // of kind VERTEX, which is 0
      ASSERT_NEAR((relative * vertex).z(), point.gap, 1e-12 * (mesh.size + shape.center.norm()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomMeshTest, testing::Range<std::uint32_t>(0, SEEDS));

/// Point sets that are hard for a hull: nearly flat, nearly on a line, on a lattice, many in one plane or on one edge.
std::vector<Eigen::Vector3d> hardPoints(int kind, std::mt19937& random)
{
  const int count = 8 + static_cast<int>(std::exp(uniform(random, 0.0, 6.0)));
  const double thickness = std::exp(uniform(random, std::log(1e-9), 0.0));
  const double width = std::exp(uniform(random, std::log(1e-5), 0.0));
  const auto lattice = [&] { return std::floor(uniform(random, 0.0, 4.999)); };
  const Eigen::Matrix3d turn = uniform(random, 0.0, 1.0) < 0.3 ? Eigen::Matrix3d::Identity() : randomRotation(random);
  const bool is_single_precision = uniform(random, 0.0, 1.0) < 0.5;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i)
  {
    Eigen::Vector3d point = randomVector(random);
    const double angle = 2.0 * M_PI * (i / 2) / (count / 2 + 1);
    switch (kind)
    {
      case 0:  // plate
        point.z() *= thickness;
        break;
      case 1:
        point << lattice(), lattice(), lattice();
        break;
      case 2:  // needle
        point = point.cwiseProduct(Eigen::Vector3d(1.0, width, thickness * width));
        break;
      case 3:  // coin
        point << std::cos(angle), std::sin(angle), (i % 2 == 0 ? -thickness : thickness);
        break;
      case 4:  // two lattices next to each other
        point << lattice(), lattice(), thickness * (i % 2);
        break;
      case 5:  // dome
        point.z() = -thickness * point.head<2>().squaredNorm();
        break;
      default:  // cube with every second point on its surface
        point /= i % 2 == 0 ? 1.0 : point.cwiseAbs().maxCoeff();
    }
    point = turn * point;
    points.push_back(is_single_precision ? Eigen::Vector3d(point.cast<float>().cast<double>()) : point);
  }
  return points;
}

TEST(HardHullTest, LoadsHoldsAllPointsAndFindsItsLowestPoint)
{
  std::mt19937 random(12);
  for (int k = 0; k < 1400; ++k)
  {
    const std::vector<Eigen::Vector3d> points = hardPoints(k % 7, random);
    const ConvexShape shape = makeShape(convexHull(points));
    const Polyhedron& hull = shape.core;
    ASSERT_EQ(static_cast<int>(hull.vertices.size() + hull.faces.size()) - static_cast<int>(hull.edges.size()), 2) << k;
    for (const Polyhedron::Face& face : hull.faces)
      ASSERT_NEAR(face.normal.norm(), 1.0, 1e-12) << k;
    for (const Eigen::Vector3d& n : directionsFor(hull, random))
    {
      ASSERT_NEAR(lowestOf(hull.vertices, n), lowestOf(points, n), LEFT_OUT * hull.size) << k;
      ASSERT_EQ(lowestAlong(shape, n), lowestOf(hull.vertices, n)) << k;
    }
  }
}

/// Near each other: the gap is s(n) of all vertices along the normal, and no direction near it separates better.
TEST(RandomMeshPairTest, GapIsTheSeparationOfAllVertices)
{
  std::mt19937 random(11);
  const auto byGap = [](const PairContact& p, const PairContact& q) { return p.gap < q.gap; };
  for (std::uint32_t seed = 0; seed < 400; ++seed)
  {
    test_support::Dice dice(seed);
    const int kinds = static_cast<int>(test_support::MeshKind::KINDS);
    const auto kind = [&] { return static_cast<test_support::MeshKind>(dice.integer(0, kinds - 1)); };
    const auto first = kind();
    const auto second = kind();
    const RandomMesh mesh_a = makeRandomMesh(first, dice.logUniform(0.02, 1.0), dice);
    const RandomMesh mesh_b = makeRandomMesh(second, 0.1, dice);
    const ConvexShape a = makeShape(convexHull(mesh_a.vertices));
    const ConvexShape b = makeShape(convexHull(mesh_b.vertices));
    const Eigen::Matrix3d turn = randomRotation(random);
    const Eigen::Vector3d away = randomVector(random).normalized();
    // from far away along the normal until the gap is `apart`: the closest features stay the same
    const double apart = uniform(random, 0.0, 0.002);
    Eigen::Isometry3d relative = pose(turn, 3.0 * (mesh_a.size + mesh_b.size) * away);
    const auto far = contactsOf(a, b, relative, 10.0);
    ASSERT_FALSE(far.empty()) << seed;
    const PairContact& nearest = *std::min_element(far.begin(), far.end(), byGap);
    relative.translation() -= (nearest.gap - apart) * nearest.normal;
    const auto separation = [&](const Eigen::Vector3d& n)
    {
      return n.dot(relative.translation()) + lowestOf(a.core.vertices, turn.transpose() * n) +
             lowestOf(b.core.vertices, -n);
    };
    const auto points = contactsOf(a, b, relative, 0.01);
    ASSERT_FALSE(points.empty()) << seed;
    const PairContact& deepest = *std::min_element(points.begin(), points.end(), byGap);
    // a face within 1e-6 of the smaller size of the best axis carries the contact (FACE_PREFERENCE), over its plane to
    // the tolerance of merging
    const double size = std::min(mesh_a.size, mesh_b.size);
    EXPECT_NEAR(deepest.gap, separation(deepest.normal), 2e-6 * size) << seed;
    EXPECT_NEAR(deepest.gap, apart, 2e-6 * size) << seed;
    for (int k = 0; k < 200; ++k)
    {
      const Eigen::Vector3d n = (deepest.normal + std::pow(10.0, uniform(random, -6.0, 0.0)) * randomVector(random));
      EXPECT_LE(separation(n.normalized()), deepest.gap + 2e-6 * size) << seed;
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
