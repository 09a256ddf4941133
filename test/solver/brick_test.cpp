/**
 * @file brick_test.cpp
 * @brief The brick on an incline (Cadoux 2009, figures 1.8 and 1.9) by Tresca's law and by Coulomb's, by every method.
 *
 * In the plane Tresca's contact is two laws of one row each: UNILATERAL and DRY_FRICTION with the threshold theta. It
 * holds the brick up to m g sin(angle) = theta, Coulomb's up to tan(angle) = mu: only there the weight does not count.
 */
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/problem/incremental_problem.h"
#include "judgement.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
constexpr double GRAVITY = 9.81;
constexpr double STEP = 0.01;
constexpr double FRICTION = 0.4;
constexpr double FORCE = 8.0;  ///< Tresca's threshold [N]
/// Residual 1e-8 on speeds of 0.1 m/s, condition one.
constexpr double SPEED = 1e-8;

/** v: down the incline, off it; one step from rest. */
IncrementalProblem brick(double mass, double angle, const std::vector<Law>& laws)
{
  IncrementalProblem problem;
  problem.M = sparse(mass * Eigen::Matrix2d::Identity());
  problem.f = STEP * mass * GRAVITY * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
  Eigen::Matrix2d H;
  H << 0.0, 1.0, 1.0, 0.0;
  problem.H = sparse(H);
  problem.w = Eigen::Vector2d::Zero();
  problem.laws = laws;
  problem.G.resize(0, 2);
  problem.b.resize(0);
  return problem;
}

const std::vector<Law> TRESCA = {{LawType::UNILATERAL, 0.0}, {LawType::DRY_FRICTION, FORCE* STEP}};
const std::vector<Law> COULOMB = {{LawType::COULOMB_2D, FRICTION}};

/** Speed down the incline by each method that converges; the others have said so. */
template <typename Check>
void forEverySolver(const IncrementalProblem& problem, const std::string& what, Check check)
{
  int converged = 0;
  for (const SolverEntry& entry : solverRegistry())
  {
    SCOPED_TRACE(std::string(entry.name) + " on " + what);
    const SolverResult result = solveAndJudge(entry, problem, what);
    if (result.status != SolverStatus::CONVERGED)
      continue;
    ++converged;
    check(result.solution);
  }
  EXPECT_EQ(converged, static_cast<int>(solverRegistry().size()));
}
}  // namespace

TEST(BrickTest, TrescaHoldsUpToTheThresholdOfTheForceWhateverTheNormalPart)
{
  for (const double mass : {0.5, 1.0, 4.0})
    for (const double share : {0.5, 0.999999, 1.000001, 1.5})
    {
      const double sine = share * FORCE / (mass * GRAVITY);
      if (sine > 0.99)
        continue;
      const double expected = std::max(0.0, GRAVITY * sine - FORCE / mass) * STEP;
      forEverySolver(brick(mass, std::asin(sine), TRESCA), "Tresca, " + std::to_string(mass) + " kg",
                     [&](const Solution& answer)
                     {
                       EXPECT_NEAR(answer.v[0], expected, SPEED);
                       EXPECT_NEAR(answer.v[1], 0.0, SPEED);
                       EXPECT_LE(std::abs(answer.r[1]), FORCE * STEP + mass * SPEED);
                     });
    }
}

TEST(BrickTest, CoulombHoldsUpToTheAngleOfFrictionWhateverTheWeight)
{
  for (const double mass : {0.5, 1.0, 4.0, 100.0})
    for (const double share : {0.5, 0.999999, 1.000001, 1.5})
    {
      const double angle = std::atan(share * FRICTION);
      const double expected = std::max(0.0, GRAVITY * (std::sin(angle) - FRICTION * std::cos(angle))) * STEP;
      forEverySolver(brick(mass, angle, COULOMB), "Coulomb, " + std::to_string(mass) + " kg",
                     [&](const Solution& answer)
                     {
                       EXPECT_NEAR(answer.v[0], expected, SPEED);
                       EXPECT_NEAR(answer.v[1], 0.0, SPEED);
                     });
    }
}

TEST(BrickTest, TheSamePushMovesALightAndAHeavyBrickByTrescaOnly)
{
  // Section 1.2.3: bricks of one shape and several weights on level ground.
  for (const double mass : {1.0, 4.0})
    for (const bool is_tresca : {true, false})
    {
      const double limit = is_tresca ? FORCE : FRICTION * mass * GRAVITY;
      for (const double push : {0.999999 * limit, 1.000001 * limit, 2.0 * limit})
      {
        IncrementalProblem problem = brick(mass, 0.0, is_tresca ? TRESCA : COULOMB);
        problem.f[0] -= STEP * push;
        const double expected = std::max(0.0, push - limit) / mass * STEP;
        forEverySolver(problem, (is_tresca ? "Tresca, " : "Coulomb, ") + std::to_string(mass) + " kg, pushed",
                       [&](const Solution& answer) { EXPECT_NEAR(answer.v[0], expected, SPEED); });
      }
    }
}
