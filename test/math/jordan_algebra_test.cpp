#include "frictional_contact_sim/math/jordan_algebra.h"

#include <gtest/gtest.h>

#include <random>

#include "frictional_contact_sim/math/complementarity_functions.h"

using namespace frictional_contact_sim;

namespace
{
constexpr int DRAWS = 1000;
/// A handful of operations on numbers of order one to ten.
constexpr double ROUND_OFF = 1e-13;

template <int D>
class Sampler
{
public:
  Vector<D> vector()
  {
    Vector<D> x;
    for (int k = 0; k < D; ++k)
      x[k] = normal_(engine_);
    return x;
  }
  /// A point of the boundary of the Lorentz cone with the given axis.
  static Vector<D> boundary(const Vector<D - 1>& axis, double length)
  {
    Vector<D> x;
    x << length, length * axis.normalized();
    return x;
  }

private:
  std::mt19937 engine_{7};
  std::normal_distribution<double> normal_;
};

template <int D, typename Function>
SquareMatrix<D> differences(Function f, const Vector<D>& x)
{
  constexpr double h = 1e-6;
  SquareMatrix<D> jacobian;
  for (int k = 0; k < D; ++k)
  {
    const Vector<D> step = h * Vector<D>::Unit(k);
    jacobian.col(k) = (f(x + step) - f(x - step)) / (2.0 * h);
  }
  return jacobian;
}
}  // namespace

template <typename Dimension>
class JordanAlgebraTest : public testing::Test
{
};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(JordanAlgebraTest, Dimensions);

TYPED_TEST(JordanAlgebraTest, ProductIsCommutativeHasAUnitAndIsTheArrowMatrix)
{
  constexpr int D = TypeParam::value;
  Sampler<D> sample;
  for (int draw = 0; draw < DRAWS; ++draw)
  {
    const Vector<D> x = sample.vector(), y = sample.vector();
    const Vector<D> product = jordanProduct<D>(x, y);
    EXPECT_LT((product - jordanProduct<D>(y, x)).norm(), ROUND_OFF);
    EXPECT_LT((product - arrowMatrix<D>(x) * y).norm(), ROUND_OFF);
    EXPECT_EQ(jordanProduct<D>(x, Vector<D>::Unit(0)), x);
  }
}

TYPED_TEST(JordanAlgebraTest, SpectralDecompositionComposesAndSquareRootSquares)
{
  constexpr int D = TypeParam::value;
  Sampler<D> sample;
  for (int draw = 0; draw < DRAWS; ++draw)
  {
    const Vector<D> x = sample.vector();
    const SpectralDecomposition<D> spectrum = spectralDecomposition<D>(x);
    EXPECT_LT((spectrum.compose(spectrum.smallest, spectrum.largest) - x).norm(), ROUND_OFF);
    EXPECT_EQ(spectrum.smallest >= 0.0, inCone<D>(x, 1.0));
    const Vector<D> square = jordanProduct<D>(x, x);
    const Vector<D> root = jordanSquareRoot<D>(square);
    EXPECT_TRUE(inCone<D>(root, 1.0 + ROUND_OFF));
    // A root near the boundary has lost half of the digits of its small eigenvalue; its square has not.
    EXPECT_LT((jordanProduct<D>(root, root) - square).norm(), ROUND_OFF * (1.0 + square.norm()));
  }
}

TYPED_TEST(JordanAlgebraTest, FischerBurmeisterVanishesExactlyOnComplementaryPairs)
{
  constexpr int D = TypeParam::value;
  Sampler<D> sample;
  for (int draw = 0; draw < DRAWS; ++draw)
  {
    const Vector<D> any = sample.vector();
    const Vector<D - 1> axis = any.template tail<D - 1>();
    const Vector<D> inside = jordanProduct<D>(any, any), zero = Vector<D>::Zero();
    EXPECT_LT((fischerBurmeister<D>(inside, zero, 0.0, false).value.norm()), ROUND_OFF);
    EXPECT_LT((fischerBurmeister<D>(zero, inside, 0.0, false).value.norm()), ROUND_OFF);
    const Vector<D> x = Sampler<D>::boundary(axis, 0.7), y = Sampler<D>::boundary(-axis, 2.3);
    EXPECT_LT((fischerBurmeister<D>(x, y, 0.0, false).value.norm()), ROUND_OFF);
    // A pair that is not complementary: both inside the cone, then x outside.
    EXPECT_GT((fischerBurmeister<D>(Vector<D>(x + Vector<D>::Unit(0)), y, 0.0, false).value.norm()), 0.1);
    EXPECT_GT((fischerBurmeister<D>(Vector<D>(x - Vector<D>::Unit(0)), y, 0.0, false).value.norm()), 0.1);
  }
}

TYPED_TEST(JordanAlgebraTest, FischerBurmeisterIsTheTextbookFormula)
{
  constexpr int D = TypeParam::value;
  Sampler<D> sample;
  for (int draw = 0; draw < DRAWS; ++draw)
  {
    const Vector<D> x = sample.vector(), y = sample.vector();
    const double alpha = draw % 2 == 0 ? 0.0 : 0.3;
    const Vector<D> square = jordanProduct<D>(x, x) + jordanProduct<D>(y, y) + alpha * alpha * Vector<D>::Unit(0);
    const Vector<D> expected = x + y - jordanSquareRoot<D>(square);
    // The textbook's small eigenvalue is a difference of squares: an error eps / sqrt(lambda_1), at worst sqrt(eps).
    EXPECT_LT((fischerBurmeister<D>(x, y, alpha, false).value - expected).norm(), 1e-9);
  }
}

TYPED_TEST(JordanAlgebraTest, JacobiansAgreeWithDifferences)
{
  constexpr int D = TypeParam::value;
  Sampler<D> sample;
  for (int draw = 0; draw < DRAWS; ++draw)
  {
    const Vector<D> x = sample.vector(), y = sample.vector();
    const double alpha = draw % 2 == 0 ? 0.0 : 0.3;
    const FischerBurmeister<D> phi = fischerBurmeister<D>(x, y, alpha, true);
    const auto of_x = [&](const Vector<D>& z) { return fischerBurmeister<D>(z, y, alpha, false).value; };
    const auto of_y = [&](const Vector<D>& z) { return fischerBurmeister<D>(x, z, alpha, false).value; };
    // Central differences: h^2 / lambda_1^(3/2); the smallest of these draws is about 1e-2.
    EXPECT_LT((phi.by_x - differences<D>(of_x, x)).norm(), 1e-5) << draw;
    EXPECT_LT((phi.by_y - differences<D>(of_y, y)).norm(), 1e-5) << draw;
  }
}

TYPED_TEST(JordanAlgebraTest, KinksGiveTheLimitAlongTheUnit)
{
  constexpr int D = TypeParam::value;
  const Vector<D - 1> axis = Vector<D - 1>::Constant(0.6);
  const Vector<D> zero = Vector<D>::Zero();
  const Vector<D> pairs[3][2] = {{zero, zero},
                                 {Sampler<D>::boundary(axis, 0.7), zero},
                                 {Sampler<D>::boundary(axis, 0.7), Sampler<D>::boundary(axis, 1.9)}};
  for (const auto& pair : pairs)
  {
    const double t = 1e-7;
    const FischerBurmeister<D> kink = fischerBurmeister<D>(pair[0], pair[1], 0.0, true);
    const FischerBurmeister<D> near =
        fischerBurmeister<D>(pair[0] + t * Vector<D>::Unit(0), pair[1] + t * Vector<D>::Unit(0), 0.0, true);
    // The limit is reached at the rate t, and the unit vector's round-off 1e-16 over t is 1e-9.
    EXPECT_LT((kink.by_x - near.by_x).norm(), 1e-6);
    EXPECT_LT((kink.by_y - near.by_y).norm(), 1e-6);
  }
}

TYPED_TEST(JordanAlgebraTest, DigitsSurviveNearTheBoundary)
{
  // Sticking close to sliding: x has eigenvalues 1e-12 and 1, y eigenvalue 1e-10 across: phi is known in closed form,
  // x and y having one axis: the scalar function of each pair of eigenvalues.
  constexpr int D = TypeParam::value;
  const SpectralDecomposition<D> frame =
      spectralDecomposition<D>(Vector<D>(Sampler<D>::boundary(Vector<D - 1>::Unit(0), 1.0)));
  const Vector<D> x = frame.compose(std::ldexp(1.0, -40), 1.0), y = frame.compose(std::ldexp(1.0, -34), 0.0);
  const double small = fischerBurmeister(std::ldexp(1.0, -40), std::ldexp(1.0, -34), 0.0).value;
  const Vector<D> expected = frame.compose(small, 0.0);
  // x_N -/+ x_T is exact for these numbers, so that phi is relative to its own size.
  EXPECT_LT((fischerBurmeister<D>(x, y, 0.0, false).value - expected).norm(), 1e-14 * std::ldexp(1.0, -40));
}

TEST(ComplementarityFunctionTest, LawsAreTheZeros)
{
  EXPECT_NEAR(unilateralFischerBurmeister(0.0, 2.0, 0.0).value[0], 0.0, ROUND_OFF);
  EXPECT_NEAR(unilateralFischerBurmeister(2.0, 0.0, 0.0).value[0], 0.0, ROUND_OFF);
  EXPECT_GT(unilateralFischerBurmeister(1.0, 1.0, 0.0).value[0], 0.1);
  EXPECT_LT(unilateralFischerBurmeister(-1.0, 1.0, 0.0).value[0], -0.1);
  // Dry friction with threshold 2: holding, sliding either way, and three violations.
  EXPECT_NEAR(dryFrictionFischerBurmeister(0.0, 1.3, 2.0, 0.0).value[0], 0.0, ROUND_OFF);
  EXPECT_NEAR(dryFrictionFischerBurmeister(0.7, -2.0, 2.0, 0.0).value[0], 0.0, ROUND_OFF);
  EXPECT_NEAR(dryFrictionFischerBurmeister(-0.7, 2.0, 2.0, 0.0).value[0], 0.0, ROUND_OFF);
  EXPECT_GT(std::abs(dryFrictionFischerBurmeister(0.7, 2.0, 2.0, 0.0).value[0]), 0.1);
  EXPECT_GT(std::abs(dryFrictionFischerBurmeister(0.0, 3.0, 2.0, 0.0).value[0]), 0.1);
  EXPECT_GT(std::abs(dryFrictionFischerBurmeister(0.7, 1.0, 2.0, 0.0).value[0]), 0.1);
  for (const double mu : {0.0, 1e-6, 0.5, 3.0})
  {
    const Vector<3> sliding_u(0, 3, 4), sliding_r(2, -0.6 * 2 * mu, -0.8 * 2 * mu), zero(0, 0, 0);
    EXPECT_LT(coulombFischerBurmeister<3>(sliding_u, sliding_r, mu, 0.0, false).value.norm(), 10 * ROUND_OFF) << mu;
    EXPECT_LT(coulombFischerBurmeister<3>({1, 3, 4}, zero, mu, 0.0, false).value.norm(), 10 * ROUND_OFF) << mu;
    EXPECT_LT(coulombFischerBurmeister<3>(zero, {2, 0.5 * mu, -mu}, mu, 0.0, false).value.norm(), ROUND_OFF) << mu;
  }
}

TEST(ComplementarityFunctionTest, ScalarJacobiansAgreeWithDifferences)
{
  constexpr double h = 1e-6;
  Sampler<2> sample;
  for (int draw = 0; draw < DRAWS; ++draw)
  {
    const Vector<2> x = 2.0 * sample.vector();
    const double alpha = draw % 2 == 0 ? 0.0 : 0.2;
    const auto dry = [&](double u, double r) { return dryFrictionFischerBurmeister(u, r, 1.5, alpha); };
    const ContactFunction<1> f = dry(x[0], x[1]);
    // h^2 times a third derivative that grows like the inverse square of the distance to the kink (above 1e-3 here).
    EXPECT_NEAR(f.by_u(0, 0), (dry(x[0] + h, x[1]).value[0] - dry(x[0] - h, x[1]).value[0]) / (2 * h), 1e-5);
    EXPECT_NEAR(f.by_r(0, 0), (dry(x[0], x[1] + h).value[0] - dry(x[0], x[1] - h).value[0]) / (2 * h), 1e-5);
  }
}
