// The energy check against closed forms: what no impulse may do.
#include "frictional_contact_sim/problem/energy_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
constexpr double MASS = 2.0;
constexpr double SPEED = 3.0;
constexpr double TOLERANCE = 1e-8;

/** A mass point that falls on the ground at 3 m/s: v_free = (0, 0, -3), E_0 = 9 J; u = v + w, normal first. */
IncrementalProblem fallingPoint(double w = 0.0)
{
  const Eigen::Matrix3d H = (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
  return denseProblem(MASS * Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.0, 0.0, MASS * SPEED), H,
                      Eigen::Vector3d(w, 0.0, 0.0), {{LawType::COULOMB_3D, 0.5}});
}

EnergyCheck check(const IncrementalProblem& problem, const Eigen::Vector3d& r)
{
  DelassusReduction reduction;
  reduction.compute(problem);
  Solution solution;
  solution.r = r;
  reduction.recover(problem, solution);
  return checkEnergy(problem, solution, reduction.freeEnergy(), TOLERANCE);
}
}  // namespace

TEST(EnergyCheckTest, FreeEnergyIsThatOfTheFreeMotion)
{
  DelassusReduction reduction;
  reduction.compute(fallingPoint());
  EXPECT_NEAR(reduction.freeEnergy(), 0.5 * MASS * SPEED * SPEED, 1e-14);  // round-off
}

TEST(EnergyCheckTest, AnInelasticStopHoldsAndAReboundDoesNot)
{
  EXPECT_TRUE(check(fallingPoint(), {MASS * SPEED, 0.0, 0.0}).holds());
  EXPECT_TRUE(check(fallingPoint(), {0.5 * MASS * SPEED, 0.0, 0.0}).holds()) << "too little takes energy";
  // r (r/m - v): a rebound with 10 % of the speed, 6.6 N s at 0.3 m/s.
  const EnergyCheck rebound = check(fallingPoint(), {1.1 * MASS * SPEED, 0.0, 0.0});
  EXPECT_FALSE(rebound.holds());
  EXPECT_NEAR(rebound.work, 1.1 * MASS * SPEED * 0.1 * SPEED, 1e-13);
}

/** r.u = 6 (6 e/2) = 18 e J for an excess e N s of 6: the bound of 10 tolerance 9 J is crossed at e = 5e-8 N s. */
TEST(EnergyCheckTest, TheBoundIsTenTolerancesOfTheFreeEnergy)
{
  EXPECT_TRUE(check(fallingPoint(), {MASS * SPEED + 2.9e-7, 0.0, 0.0}).holds());
  EXPECT_FALSE(check(fallingPoint(), {MASS * SPEED + 3.1e-7, 0.0, 0.0}).holds());
}

TEST(EnergyCheckTest, FrictionAgainstTheSlipTakesEnergyAndAlongItCreatesSome)
{
  IncrementalProblem problem = fallingPoint();
  problem.f[0] = -MASS * 1.0;  // and slides along x at 1 m/s
  EXPECT_TRUE(check(problem, {MASS * SPEED, -0.5, 0.0}).holds());
  EXPECT_FALSE(check(problem, {MASS * SPEED, 0.5, 0.0}).holds());
}

/** With E_0 = 0 an answer that a moving wall asks for holds: u = v - 1 >= 0, within the residual's tolerance. */
TEST(EnergyCheckTest, WhatAMovingWallHitsAtRestHolds)
{
  IncrementalProblem problem = fallingPoint(-1.0);
  problem.f.setZero();
  EXPECT_TRUE(check(problem, {MASS * (1.0 + 1e-8), 0.0, 0.0}).holds()) << "2 N s at 1e-8 m/s, bound 1e-7 of 1 J";
  EXPECT_FALSE(check(problem, {MASS * 1.01, 0.0, 0.0}).holds());
}

/** At rest without forces both sides are zero. */
TEST(EnergyCheckTest, NothingMovingHoldsExactlyAndRoundOffOfALargeImpulseHolds)
{
  IncrementalProblem problem = fallingPoint();
  problem.f.setZero();
  EXPECT_TRUE(check(problem, Eigen::Vector3d::Zero()).holds());
  // Two opposite rows that carry 1e6 N s between moving walls: u is round-off of +-1 m/s, 1e-16.
  const Eigen::MatrixXd H = (Eigen::MatrixXd(2, 1) << 1.0, -1.0).finished();
  const IncrementalProblem pressed =
      denseProblem(Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, -1.0 / 3.0), H,
                   Eigen::Vector2d(-1.0 / 3.0, 1.0 / 3.0), {{LawType::UNILATERAL, 0.0}, {LawType::UNILATERAL, 0.0}});
  Solution solution;
  solution.v = Eigen::VectorXd::Constant(1, 1.0 / 3.0 + 5e-17);
  solution.r = Eigen::Vector2d(1e6, 1e6);
  solution.u = Eigen::Vector2d(1e-16, 0.0);
  EXPECT_TRUE(checkEnergy(pressed, solution, 1.0 / 18.0, 1e-13).holds());
  solution.u[0] = 1e-10;
  EXPECT_FALSE(checkEnergy(pressed, solution, 1.0 / 18.0, 1e-13).holds());
}

TEST(EnergyCheckTest, NotANumberDoesNotHold)
{
  const IncrementalProblem problem = fallingPoint();
  Solution solution;
  solution.v = Eigen::Vector3d::Constant(std::nan(""));
  solution.u = solution.v;
  solution.r = solution.v;
  EXPECT_FALSE(checkEnergy(problem, solution, 9.0, TOLERANCE).holds());
}
