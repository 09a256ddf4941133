#include "frictional_contact_sim/solver/one_contact.h"

#include <gtest/gtest.h>

#include <random>

#include "support/hand_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
template <int D>
void checkRandomContacts(double asymmetry)
{
  std::mt19937 engine(17);
  std::normal_distribution<double> normal;
  const double frictions[] = {0.0, 1e-6, 0.1, 0.7, 1.0, 10.0};
  for (int k = 0; k < 3000; ++k)
  {
    SquareMatrix<D> A, N;
    Vector<D> q;
    for (int i = 0; i < D; ++i)
    {
      q[i] = normal(engine);
      for (int j = 0; j < D; ++j)
      {
        A(i, j) = normal(engine);
        N(i, j) = normal(engine);
      }
    }
    const SquareMatrix<D> W = A * A.transpose() + 0.1 * SquareMatrix<D>::Identity() + asymmetry * (N - N.transpose());
    const double mu = frictions[engine() % 6];
    const Vector<D> r = solveCoulomb(W, q, mu);
    const Law law{D == 3 ? LawType::COULOMB_3D : LawType::COULOMB_2D, mu};
    // The root is found to eps; the condition of W, up to 1e3, and mu = 10 multiply it.
    EXPECT_LT(validateAnswer(localProblem(W, q, {law}), r).law, 1e-12) << "W = " << W << " q = " << q << " mu = " << mu;
  }
}
}  // namespace

TEST(OneContactTest, RandomContactsAreSolvedToRoundOff)
{
  checkRandomContacts<3>(0.0);
  checkRandomContacts<2>(0.0);
}

TEST(OneContactTest, SlightlyUnsymmetricContactsToo)
{
  checkRandomContacts<3>(1e-3);
  checkRandomContacts<2>(1e-3);
}

TEST(OneContactTest, PointMassHasTheClosedFormsOfTheTextbook)
{
  // W = I/m, m = 2 kg. Falling at 3 m/s: r_N = 6; sliding at 5 m/s with mu = 0.5: r_T = -3 along the motion.
  const SquareMatrix<3> W = 0.5 * SquareMatrix<3>::Identity();
  EXPECT_LT((solveCoulomb(W, Vector<3>(-3, 3, 4), 0.5) - Vector<3>(6, -1.8, -2.4)).norm(), 1e-13);
  EXPECT_LT((solveCoulomb(W, Vector<3>(-3, 0.3, 0.4), 0.5) - Vector<3>(6, -0.6, -0.8)).norm(), 1e-13);
  EXPECT_EQ(solveCoulomb(W, Vector<3>(1e-3, 3, 4), 0.5), Vector<3>(0, 0, 0));
}

TEST(OneContactTest, FrictionIsIsotropic)
{
  const SquareMatrix<3> W = 0.5 * SquareMatrix<3>::Identity();
  for (int degrees = 0; degrees < 360; ++degrees)
  {
    const double angle = degrees * M_PI / 180.0;
    const Vector<3> r = solveCoulomb(W, Vector<3>(-3, 5 * std::cos(angle), 5 * std::sin(angle)), 0.5);
    EXPECT_LT((r - Vector<3>(6, -3 * std::cos(angle), -3 * std::sin(angle))).norm(), 1e-13);
  }
}

TEST(OneContactTest, SingularBlocksStillGiveASolution)
{
  // A contact that cannot move sideways: any r_T in the cone would do; and one whose normal nothing moves.
  SquareMatrix<3> W = SquareMatrix<3>::Zero();
  W(0, 0) = 1.0;
  const Vector<3> r = solveCoulomb(W, Vector<3>(-2, 0, 0), 0.3);
  EXPECT_LT((r - Vector<3>(2, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(solveCoulomb(SquareMatrix<3>::Zero(), Vector<3>(-2, 1, 0), 0.3).allFinite());
}

TEST(OneContactTest, OneDimensionalLawsInClosedForm)
{
  EXPECT_EQ(solveOneDimensional({LawType::UNILATERAL, 0.0}, 0.5, -2.0, 0.0), 4.0);
  EXPECT_EQ(solveOneDimensional({LawType::UNILATERAL, 0.0}, 0.5, 2.0, 0.0), 0.0);
  EXPECT_EQ(solveOneDimensional({LawType::DRY_FRICTION, 3.0}, 0.5, 2.0, 0.0), -3.0);
  EXPECT_EQ(solveOneDimensional({LawType::DRY_FRICTION, 5.0}, 0.5, 2.0, 0.0), -4.0);
  EXPECT_EQ(solveOneDimensional({LawType::BILATERAL, 0.0}, 0.5, 2.0, 0.0), -4.0);
}
