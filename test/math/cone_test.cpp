#include "frictional_contact_sim/math/cone.h"

#include <gtest/gtest.h>

#include <random>

#include "frictional_contact_sim/math/contact_functions.h"

using namespace frictional_contact_sim;

namespace
{
constexpr int DRAWS = 2000;
/// A projection is a handful of multiplications on numbers of order 1 to 10.
constexpr double ROUND_OFF = 1e-13;

template <int D>
class Sampler
{
public:
  Vector<D> vector()
  {
    Vector<D> x;
    for (int k = 0; k < D; ++k)
      x[k] = 2.0 * normal_(engine_);
    return x;
  }
  double friction()
  {
    static const double values[] = {0.0, 1e-6, 0.1, 0.7, 1.0, 10.0};
    return values[engine_() % 6];
  }

private:
  std::mt19937 engine_{20090};
  std::normal_distribution<double> normal_;
};

template <int D>
void checkProjection()
{
  Sampler<D> sampler;
  for (int k = 0; k < DRAWS; ++k)
  {
    const double mu = sampler.friction();
    const Vector<D> x = sampler.vector(), y = sampler.vector();
    const Vector<D> p = projectOntoCone<D>(x, mu);
    EXPECT_LE(p.template tail<D - 1>().norm(), mu * p[0] + ROUND_OFF);
    EXPECT_LT((projectOntoCone<D>(p, mu) - p).norm(), ROUND_OFF);
    // Moreau: x = P_K(x) - P_K*(-x), orthogonal; and P_K* lands in the dual cone.
    const Vector<D> dual = projectOntoDualCone<D>(-x, mu);
    EXPECT_LT((x - (p - dual)).norm(), ROUND_OFF);
    EXPECT_NEAR(p.dot(dual), 0.0, ROUND_OFF * (1.0 + x.squaredNorm()));
    EXPECT_GE(dual[0], mu * dual.template tail<D - 1>().norm() - ROUND_OFF);
    EXPECT_LE((p - projectOntoCone<D>(y, mu)).norm(), (x - y).norm() * (1.0 + 1e-14));
  }
}

/** Central differences of a smooth piece: error h^2 f''' / 6 + eps / h, about 1e-9 at h = 1e-6 times the curvature. */
template <int D, typename Function>
SquareMatrix<D> difference(Function function, const Vector<D>& x)
{
  constexpr double STEP = 1e-6;
  SquareMatrix<D> jacobian;
  for (int k = 0; k < D; ++k)
  {
    Vector<D> forward = x, backward = x;
    forward[k] += STEP;
    backward[k] -= STEP;
    jacobian.col(k) = (function(forward) - function(backward)) / (2.0 * STEP);
  }
  return jacobian;
}

/** True when x is further than a margin from the cone's and its polar's boundary and from the axis, where kinks are. */
template <int D>
bool awayFromKinks(const Vector<D>& x, double mu)
{
  const double t = x.template tail<D - 1>().norm();
  return std::abs(t - mu * x[0]) > 1e-2 && std::abs(mu * t + x[0]) > 1e-2 && t > 0.1;
}

template <int D>
void checkProjectionJacobian()
{
  Sampler<D> sampler;
  int checked = 0;
  for (int k = 0; k < DRAWS; ++k)
  {
    const double mu = sampler.friction();
    const Vector<D> x = sampler.vector();
    if (!awayFromKinks<D>(x, mu))
      continue;
    ++checked;
    const auto numeric = difference<D>([&](const Vector<D>& y) { return projectOntoCone<D>(y, mu); }, x);
    EXPECT_LT((coneProjectionJacobian<D>(x, mu) - numeric).norm(), 1e-7) << "x = " << x.transpose() << " mu = " << mu;
  }
  EXPECT_GT(checked, DRAWS / 2);
}

template <int D>
void checkAlartCurnierJacobian(RadiusRule rule)
{
  Sampler<D> sampler;
  int checked = 0;
  for (int k = 0; k < DRAWS; ++k)
  {
    const double mu = sampler.friction(), rho_n = 0.7, rho_t = 1.3;
    const Vector<D> u = sampler.vector(), r = sampler.vector();
    const double trial = r[0] - rho_n * u[0];
    const double radius = mu * (rule == RadiusRule::IMPULSE ? r[0] : trial);
    const double y = (r - rho_t * u).template tail<D - 1>().norm();
    if (std::abs(trial) < 1e-2 || std::abs(r[0]) < 1e-2 || std::abs(y - radius) < 1e-2 || y < 0.1)
      continue;
    ++checked;
    const ContactFunction<D> f = alartCurnierJacobian<D>(u, r, mu, rho_n, rho_t, rule);
    const auto by_u =
        difference<D>([&](const Vector<D>& x) { return alartCurnier<D>(x, r, mu, rho_n, rho_t, rule); }, u);
    const auto by_r =
        difference<D>([&](const Vector<D>& x) { return alartCurnier<D>(u, x, mu, rho_n, rho_t, rule); }, r);
    EXPECT_LT((f.by_u - by_u).norm(), 1e-6) << "u = " << u.transpose() << " r = " << r.transpose() << " mu = " << mu;
    EXPECT_LT((f.by_r - by_r).norm(), 1e-6) << "u = " << u.transpose() << " r = " << r.transpose() << " mu = " << mu;
  }
  EXPECT_GT(checked, DRAWS / 2);
}
}  // namespace

TEST(ConeProjectionTest, IsIdempotentOrthogonalAndNonexpansiveInSpaceAndPlane)
{
  checkProjection<3>();
  checkProjection<2>();
}

TEST(ConeProjectionTest, JacobianAgreesWithDifferencesAwayFromKinks)
{
  checkProjectionJacobian<3>();
  checkProjectionJacobian<2>();
}

TEST(ConeProjectionTest, WithoutFrictionOnlyTheNormalRaySurvives)
{
  EXPECT_EQ(projectOntoCone<3>(Vector<3>(2.0, 3.0, -4.0), 0.0), Vector<3>(2.0, 0.0, 0.0));
  EXPECT_EQ(projectOntoCone<3>(Vector<3>(-2.0, 3.0, -4.0), 0.0), Vector<3>(0.0, 0.0, 0.0));
}

TEST(ConeProjectionTest, WithoutFrictionAPullAlongTheNormalIsOutsideTheCone)
{
  // |x_T| <= mu x_N reads 0 <= -0 here: only the sign of x_N tells the half line from its opposite. Exact values.
  const Vector<3> pull(-2.0, 0.0, 0.0);
  EXPECT_FALSE(inCone<3>(pull, 0.0));
  EXPECT_EQ(projectOntoCone<3>(pull, 0.0), Vector<3>(Vector<3>::Zero()));
  EXPECT_EQ(coneProjectionJacobian<3>(pull, 0.0), SquareMatrix<3>(SquareMatrix<3>::Zero()));
  EXPECT_EQ(projectOntoCone<2>(Vector<2>(-2.0, 0.0), 0.0), Vector<2>(Vector<2>::Zero()));
}

TEST(BallProjectionTest, JacobiansAgreeWithDifferencesAndAnEmptyBallGivesZero)
{
  Sampler<2> sampler;
  for (int k = 0; k < DRAWS; ++k)
  {
    const Vector<2> x = sampler.vector();
    const double radius = sampler.vector()[0];
    if (std::abs(x.norm() - radius) < 1e-2 || std::abs(radius) < 1e-2)
      continue;
    const BallJacobian<2> jacobian = ballProjectionJacobian<2>(x, radius);
    const auto by_x = difference<2>([&](const Vector<2>& y) { return projectOntoBall<2>(y, radius); }, x);
    const Vector<2> by_radius = (projectOntoBall<2>(x, radius + 1e-6) - projectOntoBall<2>(x, radius - 1e-6)) / 2e-6;
    EXPECT_LT((jacobian.by_x - by_x).norm(), 1e-6);
    EXPECT_LT((jacobian.by_radius - by_radius).norm(), 1e-8);
  }
  EXPECT_EQ(projectOntoBall<2>(Vector<2>(3.0, 4.0), -1.0), Vector<2>(0.0, 0.0));
}

TEST(AlartCurnierTest, JacobianAgreesWithDifferencesAwayFromKinks)
{
  for (const RadiusRule rule : {RadiusRule::IMPULSE, RadiusRule::AUGMENTED})
  {
    checkAlartCurnierJacobian<3>(rule);
    checkAlartCurnierJacobian<2>(rule);
  }
}

TEST(AlartCurnierTest, VanishesExactlyOnTheThreeModesOfCoulombsLaw)
{
  // Take-off, sticking, sliding (r_T opposite to u_T on the boundary of the cone), mu = 0.5, any rho.
  const Vector<3> cases[][2] = {
      {{0.3, 1.0, -2.0}, {0.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}, {2.0, 0.6, -0.5}}, {{0.0, 3.0, -4.0}, {2.0, -0.6, 0.8}}};
  for (const auto& [u, r] : cases)
    for (const RadiusRule rule : {RadiusRule::IMPULSE, RadiusRule::AUGMENTED})
      EXPECT_LT(alartCurnier<3>(u, r, 0.5, 0.3, 1.7, rule).norm(), 1e-15);
  EXPECT_GT(alartCurnier<3>({0.0, 3.0, -4.0}, {2.0, 0.6, -0.8}, 0.5, 0.3, 1.7, RadiusRule::IMPULSE).norm(), 0.1);
}

TEST(DeSaxceTest, ShiftMakesTheCoulombVelocityADualConeElementOrthogonalToTheImpulse)
{
  // Sliding: u~ = (mu |u_T|, u_T) is on the boundary of K*, and r . u~ = mu r_N |u_T| - |r_T||u_T| = 0.
  const double mu = 0.5;
  const Vector<3> u(0.0, 3.0, -4.0), r(2.0, -0.6, 0.8);
  const Vector<3> shifted = deSaxce<3>(u, mu);
  EXPECT_NEAR(shifted[0], 2.5, 1e-15);
  EXPECT_NEAR(shifted.dot(r), 0.0, 1e-14);
  const auto numeric = difference<3>([&](const Vector<3>& x) { return deSaxce<3>(x, mu); }, u);
  EXPECT_LT((deSaxceJacobian<3>(u, mu) - numeric).norm(), 1e-8);
}
