// Uniformly filled shapes against textbook moments, and hulls against the shapes they approximate.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <random>
#include <vector>

#include "frictional_contact_sim/collision/mass_distribution.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;

class MassDistributionTest : public testing::Test
{
protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::mt19937 random_{11};
};

TEST_F(MassDistributionTest, PrimitivesHaveTheirTextbookMoments)
{
  for (int k = 0; k < 50; ++k)
  {
    const double r = uniform(0.01, 2.0);
    const double h = uniform(0.01, 2.0);
    const Eigen::Vector3d half(r, h, uniform(0.01, 2.0));
    const MassDistribution box = fillUniformly(makeShape(Box{half}));
    EXPECT_NEAR(box.volume, 8.0 * half.prod(), 1e-13 * box.volume);
    EXPECT_NEAR(box.gyration_squared, half.squaredNorm() / 3.0, 1e-13 * box.gyration_squared);
    EXPECT_LT(box.center.norm(), 1e-14);
    const MassDistribution sphere = fillUniformly(makeShape(Sphere{r}));
    EXPECT_NEAR(sphere.gyration_squared, 0.6 * r * r, 1e-15);
    // m r^2/2 about the axis and m (r^2/4 + (2 h)^2/12) across: half of their sum.
    const MassDistribution cylinder = fillUniformly(makeShape(Cylinder{r, h}));
    EXPECT_NEAR(cylinder.volume, 2.0 * PI * r * r * h, 1e-13 * cylinder.volume);
    EXPECT_NEAR(cylinder.gyration_squared, 0.25 * r * r + 0.25 * r * r + h * h / 3.0, 1e-13);
  }
}

/// Points of the surface of a capsule: its hull has its volume and moments to the order of their distance squared.
TEST_F(MassDistributionTest, CapsuleIsItsHull)
{
  for (int k = 0; k < 5; ++k)
  {
    const double r = uniform(0.1, 1.0);
    const double h = uniform(0.0, 1.0);
    std::vector<Eigen::Vector3d> points;
    constexpr int CIRCLES = 40;
    for (int i = 0; i <= CIRCLES; ++i)
      for (int j = 0; j < 2 * CIRCLES; ++j)
      {
        const double polar = PI * i / CIRCLES;
        const double around = PI * j / CIRCLES;
        const Eigen::Vector3d on_sphere = r * Eigen::Vector3d(std::sin(polar) * std::cos(around),
                                                              std::sin(polar) * std::sin(around), std::cos(polar));
        points.push_back(on_sphere + Eigen::Vector3d(0.0, 0.0, i < CIRCLES / 2 ? h : -h));
        if (i == CIRCLES / 2)
          points.push_back(on_sphere + Eigen::Vector3d(0.0, 0.0, h));
      }
    const MassDistribution hull = fillUniformly(makeShape(convexHull(points)));
    const MassDistribution capsule = fillUniformly(makeShape(Capsule{r, h}));
    EXPECT_NEAR(hull.volume, capsule.volume, 5e-3 * capsule.volume);
    EXPECT_NEAR(hull.gyration_squared, capsule.gyration_squared, 5e-3 * capsule.gyration_squared);
  }
}

/// Volume and moments of a hull do not depend on where it stands; tetrahedra against the sum of their corners.
TEST_F(MassDistributionTest, MovedTetrahedronKeepsItsMoments)
{
  for (int k = 0; k < 50; ++k)
  {
    std::vector<Eigen::Vector3d> corners;
    const Eigen::Vector3d shift(uniform(-9.0, 9.0), uniform(-9.0, 9.0), uniform(-9.0, 9.0));
    for (int i = 0; i < 4; ++i)
      corners.push_back(shift + Eigen::Vector3d(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)));
    const Eigen::Vector3d center = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    double squares = 0.0;
    for (const Eigen::Vector3d& corner : corners)
      squares += (corner - center).squaredNorm();
    const double volume =
        std::abs((corners[1] - corners[0]).dot((corners[2] - corners[0]).cross(corners[3] - corners[0]))) / 6.0;
    const MassDistribution filled = fillUniformly(makeShape(convexHull(corners)));
    EXPECT_NEAR(filled.volume, volume, 1e-12);
    EXPECT_LT((filled.center - center).norm(), 1e-12);
    EXPECT_NEAR(filled.gyration_squared, squares / 20.0, 1e-12);
  }
}

}  // namespace
}  // namespace frictional_contact_sim
