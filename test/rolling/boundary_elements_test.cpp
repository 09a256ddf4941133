/**
 * @file boundary_elements_test.cpp
 * @brief Kernels, rigid-body modes, patch tests, the pressurised ring.
 *
 * Constant elements: displacements are exact to second order at the nodes in smooth problems, tractions to first order;
 * rotations and linear fields are not in the space and converge.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/rolling/boundary_elements.h"

using namespace frictional_contact_sim;

namespace
{
constexpr double PI = 3.14159265358979323846;
const PlaneStrainMaterial STEEL_LIKE{2.0, 0.3};

Contour circle(double radius, int n, bool hole)
{
  Eigen::Matrix2Xd points(2, n);
  for (int i = 0; i < n; ++i)
  {
    const double angle = (hole ? -2.0 : 2.0) * PI * i / n;
    points.col(i) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return makePolygon(points);
}

/// Square [0, 1]^2 with n elements on each side, the sides in the order bottom, right, top, left.
Contour square(int n)
{
  Eigen::Matrix2Xd points(2, 4 * n);
  for (int i = 0; i < n; ++i)
  {
    const double s = static_cast<double>(i) / n;
    points.col(i) << s, 0.0;
    points.col(n + i) << 1.0, s;
    points.col(2 * n + i) << 1.0 - s, 1.0;
    points.col(3 * n + i) << 0.0, 1.0 - s;
  }
  return makePolygon(points);
}

/// Kelvin's U and T at one point, written from the definition.
void kelvin(const Eigen::Vector2d& r_vector, const Eigen::Vector2d& n, const PlaneStrainMaterial& material,
            Eigen::Matrix2d& U, Eigen::Matrix2d& T)
{
  const double nu = material.poisson_ratio, r = r_vector.norm();
  const Eigen::Vector2d e = r_vector / r;
  U = ((3.0 - 4.0 * nu) * std::log(1.0 / r) * Eigen::Matrix2d::Identity() + e * e.transpose()) /
      (8.0 * PI * material.shearModulus() * (1.0 - nu));
  T = -(e.dot(n) * ((1.0 - 2.0 * nu) * Eigen::Matrix2d::Identity() + 2.0 * e * e.transpose()) +
        (1.0 - 2.0 * nu) * (n * e.transpose() - e * n.transpose())) /
      (4.0 * PI * (1.0 - nu) * r);
}

double order(double coarse, double fine)
{
  return std::log2(coarse / fine);
}
}  // namespace

TEST(KelvinIntegralTest, AgreesWithQuadratureOffTheElement)
{
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k < 50; ++k)
  {
    const Eigen::Vector2d a(uniform(engine), uniform(engine)), b(uniform(engine), uniform(engine));
    const double length = (b - a).norm();
    const Eigen::Vector2d t = (b - a) / length, n(t.y(), -t.x());
    const Eigen::Vector2d x = a + uniform(engine) * (b - a) + (0.3 + uniform(engine) * 0.1) * (k % 2 ? 1.0 : -1.0) * n;
    Eigen::Matrix2d U = Eigen::Matrix2d::Zero(), T = U, u, tau;
    const int intervals = 400;
    for (int i = 0; i <= intervals; ++i)
    {
      const double weight = (i == 0 || i == intervals ? 1.0 : i % 2 ? 4.0 : 2.0) * length / (3.0 * intervals);
      kelvin(a + (b - a) * i / intervals - x, n, STEEL_LIKE, u, tau);
      U += weight * u;
      T += weight * tau;
    }
    const KernelIntegrals exact = integrateKernels(x, a, b, false, STEEL_LIKE, 1.0);
    // Simpson's rule: (h/r)^4 with h/r <= 3/400/0.2, about 2e-6^... = 2e-9 at worst.
    EXPECT_LT((exact.displacement - U).norm(), 1e-8) << k;
    EXPECT_LT((exact.traction - T).norm(), 1e-8) << k;
  }
}

TEST(KelvinIntegralTest, SelfElementIsTheLimitFromBesideTheElement)
{
  // The displacement kernel is continuous; the traction kernel jumps by -+1/2 I about the principal value.
  const Eigen::Vector2d a(-0.4, 0.1), b(0.2, 0.3), middle = 0.5 * (a + b);
  const Eigen::Vector2d t = (b - a).normalized(), n(t.y(), -t.x());
  const KernelIntegrals self = integrateKernels(middle, a, b, true, STEEL_LIKE, 1.0);
  const KernelIntegrals inside = integrateKernels(middle - 1e-9 * n, a, b, false, STEEL_LIKE, 1.0);
  // Distance 1e-9 times kernels' slopes of order 1/length.
  EXPECT_LT((self.displacement - inside.displacement).norm(), 1e-7);
  EXPECT_LT((self.traction - 0.5 * Eigen::Matrix2d::Identity() - inside.traction).norm(), 1e-7);
}

TEST(BoundaryElementTest, RigidTranslationsNeedNoTraction)
{
  for (int n : {3, 8, 50})
  {
    const Contour body = n == 8 ? join(circle(2.0, 40, false), circle(0.7, 20, true)) : circle(1.3, n, false);
    const BoundaryMatrices matrices = assembleBoundaryMatrices(body, STEEL_LIKE);
    for (int axis = 0; axis < 2; ++axis)
    {
      Eigen::VectorXd u = Eigen::VectorXd::Zero(2 * body.size());
      for (Eigen::Index i = 0; i < body.size(); ++i)
        u[2 * i + axis] = 1.0;
      // Angles around a closed polygon sum up exactly: round-off of some dozens of terms.
      EXPECT_LT((matrices.H * u).lpNorm<Eigen::Infinity>(), 1e-13);
    }
  }
}

TEST(BoundaryElementTest, RigidRotationConvergesToNoTraction)
{
  double last = 0.0;
  for (int n : {32, 64, 128, 256})
  {
    const Contour body = circle(1.0, n, false);
    const BoundaryMatrices matrices = assembleBoundaryMatrices(body, STEEL_LIKE);
    Eigen::VectorXd u(2 * n);
    for (Eigen::Index i = 0; i < n; ++i)
      u.segment<2>(2 * i) << -body.middle(i).y(), body.middle(i).x();
    const double error = (matrices.H * u).lpNorm<Eigen::Infinity>();
    if (last > 0.0)
    {
      // Measured 2.0 (the linear part integrates to zero on each element's own middle).
      EXPECT_GT(order(last, error), 0.9) << n;
    }
    last = error;
  }
  EXPECT_LT(last, 0.02);
}

TEST(BoundaryElementPatchTest, UniformTensionIsRecoveredUnderRefinement)
{
  // sigma_xx = 1 in plane strain: u_x = (1 - nu^2)/E x, u_y = -nu (1 + nu)/E y; the displacements given on left and
  // bottom (their normal component), tractions elsewhere.
  const double c = STEEL_LIKE.compliance();
  const double d = -STEEL_LIKE.poisson_ratio * (1.0 + STEEL_LIKE.poisson_ratio) / STEEL_LIKE.young_modulus;
  double last = 0.0;
  for (int n : {8, 16, 32, 64})
  {
    const Contour body = square(n);
    std::vector<bool> given_u(static_cast<size_t>(2 * body.size()), false);
    Eigen::VectorXd given = Eigen::VectorXd::Zero(2 * body.size());
    for (Eigen::Index i = 0; i < body.size(); ++i)
    {
      const Eigen::Index side = i / n;
      if (side == 1)
        given[2 * i] = 1.0;
      given_u[static_cast<size_t>(2 * i)] = side == 3;
      given_u[static_cast<size_t>(2 * i + 1)] = side == 0;
    }
    const BoundarySolution solution = solveBoundaryProblem(assembleBoundaryMatrices(body, STEEL_LIKE), given_u, given);
    double error = 0.0;
    for (Eigen::Index i = 0; i < body.size(); ++i)
      error = std::max(
          error,
          (solution.u.segment<2>(2 * i) - Eigen::Vector2d(c * body.middle(i).x(), d * body.middle(i).y())).norm());
    error /= c;
    if (last > 0.0)
    {
      EXPECT_GT(order(last, error), 0.8) << n;  // first order at the corners, where u jumps by a step of an element
    }
    last = error;
  }
  EXPECT_LT(last, 5e-3);
}

TEST(BoundaryElementPatchTest, PressurisedRingIsLames)
{
  // Inner pressure 1 at a = 1, outer contour b = 2 held: u = A r + B/r, A b + B/b = 0, sigma_r(a) = -1 with
  // sigma_r = 2 (lambda + G) A - 2 G B/r^2.
  const double a = 1.0, b = 2.0, G = STEEL_LIKE.shearModulus(), nu = STEEL_LIKE.poisson_ratio;
  const double lambda = 2.0 * G * nu / (1.0 - 2.0 * nu);
  const double B = 1.0 / (2.0 * G / (a * a) + 2.0 * (lambda + G) / (b * b)), A = -B / (b * b);
  const double u_a = A * a + B / a, sigma_b = 2.0 * (lambda + G) * A - 2.0 * G * B / (b * b);
  double last_u = 0.0, last_t = 0.0;
  for (int n : {24, 48, 96})
  {
    const Contour body = join(circle(b, 2 * n, false), circle(a, n, true));
    std::vector<bool> given_u(static_cast<size_t>(2 * body.size()), false);
    std::fill_n(given_u.begin(), 4 * n, true);
    Eigen::VectorXd given = Eigen::VectorXd::Zero(2 * body.size());
    for (Eigen::Index i = 2 * n; i < body.size(); ++i)
      given.segment<2>(2 * i) = -body.normal(i);
    const BoundarySolution solution = solveBoundaryProblem(assembleBoundaryMatrices(body, STEEL_LIKE), given_u, given);
    double error_u = 0.0, error_t = 0.0;
    for (Eigen::Index i = 0; i < body.size(); ++i)
    {
      const Eigen::Vector2d out = body.middle(i).normalized();
      if (i < 2 * n)
        error_t = std::max(error_t, (solution.t.segment<2>(2 * i) - sigma_b * out).norm() / std::abs(sigma_b));
      else
        error_u = std::max(error_u, (solution.u.segment<2>(2 * i) - u_a * out).norm() / u_a);
    }
    if (last_u > 0.0)
    {
      EXPECT_GT(order(last_u, error_u), 0.8) << n;
      EXPECT_GT(order(last_t, error_t), 0.8) << n;
    }
    last_u = error_u;
    last_t = error_t;
  }
  EXPECT_LT(last_u, 0.02);
  EXPECT_LT(last_t, 0.02);
}

TEST(BoundaryElementTest, ReactionsOfTheHeldArcBalanceTheLoad)
{
  // Collocation does not enforce equilibrium: it is a check of the mesh, converging with it.
  double last = 0.0;
  for (double max_angle : {0.2, 0.1, 0.05})
  {
    CylinderMesh mesh;
    mesh.half_angle = 0.3;
    mesh.contact_elements = static_cast<int>(4.0 / max_angle);
    mesh.max_angle = max_angle;
    const Contour body = makeCylinderContour(mesh);
    std::vector<bool> given_u(static_cast<size_t>(2 * body.size()), false);
    Eigen::VectorXd given = Eigen::VectorXd::Zero(2 * body.size());
    Eigen::Vector2d load(0.0, 0.0);
    for (Eigen::Index i = 0; i < body.size(); ++i)
    {
      const auto kind = body.kinds[static_cast<size_t>(i)];
      if (kind == ElementKind::CONTACT)
      {
        given.segment<2>(2 * i) << 0.3, 1.0;
        load += body.length(i) * Eigen::Vector2d(0.3, 1.0);
      }
      if (kind == ElementKind::HELD)
        given_u[static_cast<size_t>(2 * i)] = given_u[static_cast<size_t>(2 * i + 1)] = true;
    }
    const BoundarySolution solution = solveBoundaryProblem(assembleBoundaryMatrices(body, STEEL_LIKE), given_u, given);
    Eigen::Vector2d sum(0.0, 0.0);
    double moment = 0.0;
    for (Eigen::Index i = 0; i < body.size(); ++i)
    {
      const Eigen::Vector2d force = body.length(i) * solution.t.segment<2>(2 * i);
      sum += force;
      moment += body.middle(i).x() * force.y() - body.middle(i).y() * force.x();
    }
    const double error = std::max(sum.norm(), std::abs(moment)) / load.norm();
    if (last > 0.0)
    {
      EXPECT_GT(order(last, error), 0.8) << max_angle;
    }
    last = error;
  }
  EXPECT_LT(last, 0.01);
}

TEST(ContourTest, CylinderMeshIsClosedGradedAndRound)
{
  CylinderMesh mesh;
  mesh.radius = 2.0;
  mesh.contact_elements = 41;
  const Contour body = makeCylinderContour(mesh);
  body.validate();
  EXPECT_EQ(body.select(ElementKind::CONTACT).size(), 41u);
  EXPECT_GE(body.select(ElementKind::HELD).size(), 4u);
  // Inscribed polygon: area lacks (angle^2)/6 of the circle's.
  EXPECT_NEAR(body.area(), PI * 4.0, PI * 4.0 * mesh.max_angle * mesh.max_angle / 6.0);
  for (Eigen::Index i = 0; i < body.size(); ++i)
  {
    const double ratio = body.length((i + 1) % body.size()) / body.length(i);
    const bool held_border =
        body.kinds[static_cast<size_t>(i)] != body.kinds[static_cast<size_t>((i + 1) % body.size())];
    if (!held_border)
    {
      EXPECT_LT(std::max(ratio, 1.0 / ratio), mesh.growth + 1e-9) << i;
    }
    EXPECT_NEAR((body.begin.col(i) - Eigen::Vector2d(0.0, 2.0)).norm(), 2.0, 1e-14);
  }
}

TEST(ContourTest, BadContoursAreNamed)
{
  Eigen::Matrix2Xd points(2, 4);
  points << 0, 1, 0, 1, 0, 0, 1, 1;  // a bow tie
  try
  {
    makePolygon(points).validate();
    FAIL() << "accepted";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("crosses element"), std::string::npos) << error.what();
  }
  points << 0, 0, 1, 1, 0, 1, 1, 0;  // clockwise
  EXPECT_THROW(makePolygon(points).validate(), std::invalid_argument);
  points << 0, 1, 1, 1, 0, 0, 0, 1;  // an element without length
  EXPECT_THROW(makePolygon(points).validate(), std::invalid_argument);
  CylinderMesh mesh;
  mesh.contact_elements = 0;
  EXPECT_THROW(makeCylinderContour(mesh), std::invalid_argument);
  EXPECT_THROW(assembleBoundaryMatrices(square(2), {-1.0, 0.3}), std::invalid_argument);
  EXPECT_THROW(assembleBoundaryMatrices(square(2), {1.0, 0.5}), std::invalid_argument);
}
