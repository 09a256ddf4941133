/**
 * @file convex_solvers_test.cpp
 * @brief The inner convex solvers: first iterates by hand, agreement with each other, rank-deficient problems.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/convex/accelerated_gradient.h"
#include "frictional_contact_sim/solver/convex/convex_admm.h"
#include "frictional_contact_sim/solver/convex/convex_interior_point.h"
#include "frictional_contact_sim/solver/convex/lorentz_cone.h"
#include "frictional_contact_sim/solver/convex/projected_gradient.h"
#include "frictional_contact_sim/solver/convex/spectral_gradient.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/// Owns what a ConvexProblem points to.
struct Case
{
  DelassusProblem local;
  ConvexProblem convex;
};

Case coneCase(const Eigen::MatrixXd& W, const Eigen::VectorXd& c, const std::vector<Law>& laws)
{
  Case result;
  result.local = localProblem(W, c, laws);
  Eigen::VectorXd steps;
  computeStepLengths(result.local, steps);
  makeConeProblem(result.local, steps, result.convex);
  return result;
}

ConvexResult run(ConvexSolver& solver, Case& problem, double tolerance, Eigen::VectorXd& r)
{
  problem.convex.W = &problem.local.W;
  ConvexBudget budget;
  budget.tolerance = tolerance;
  r.setZero(problem.local.W.rows());
  Eigen::VectorXd u;
  return solver.solve(problem.convex, budget, r, u);
}

/// All kinds of sets in one problem, W of full rank.
Case mixedCase(std::uint32_t seed, bool cylinders)
{
  RandomProblemOptions options;
  options.contacts = 4;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 2;
  DelassusReduction reduction;
  const IncrementalProblem problem = randomProblem(options, seed);
  reduction.compute(problem);
  Case result;
  result.local = reduction.problem();
  result.local.laws[1].coefficient = 0.0;
  Eigen::VectorXd steps;
  computeStepLengths(result.local, steps);
  makeConeProblem(result.local, steps, result.convex);
  if (cylinders)
  {
    const Eigen::VectorXd thresholds = 0.3 * steps;
    makeCylinderProblem(result.local, steps, thresholds, result.convex);
  }
  return result;
}
}  // namespace

TEST(ProjectedGradientTest, ArmijoHalvesTheStepOnce)
{
  // W = 2 I, c = (-1, -3, 0), mu = 1. t = 1: r = P(-c) = (2, 2, 0), d'Wd/2 = 8 > 0.9 * 8 = 7.2: refused.
  // t = 1/2: r = P(-c/2) = (1, 1, 0), d'Wd/2 = 2 <= 0.9 * 4: taken, and it is the solution.
  Case problem = coneCase(2.0 * Eigen::Matrix3d::Identity(), Eigen::Vector3d(-1, -3, 0), {{LawType::COULOMB_3D, 1.0}});
  ProjectedGradientOptions options = ProjectedGradientOptions::thesisOptions();
  options.max_iterations = 1;
  ProjectedGradient solver(options);
  Eigen::VectorXd r;
  run(solver, problem, 1e-14, r);
  EXPECT_LT((r - Eigen::Vector3d(1, 1, 0)).norm(), 1e-15);  // round-off of three operations
}

TEST(ProjectedGradientTest, ThesisOptionsAreThoseOfTable56)
{
  const ProjectedGradientOptions options = ProjectedGradientOptions::thesisOptions();
  EXPECT_EQ(options.max_iterations, 250);
  EXPECT_EQ(options.change_tolerance, 1e-10);
  EXPECT_EQ(options.metric, Metric::UNIT);
}

TEST(AcceleratedGradientTest, ThirdIterateHasNesterovsMomentum)
{
  // One free row, W = 1, c = -1, t = 1/2:  r1 = y1 = 1/2, r2 = 3/4, y = r2 + (theta_2 - 1)/theta_3 (r2 - r1).
  Case problem =
      coneCase(Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, -1.0), {{LawType::BILATERAL, 0}});
  AcceleratedGradientOptions options;
  options.metric = Metric::UNIT;
  options.initial_step = 0.5;
  options.step_growth = 1.0;
  options.max_iterations = 3;
  AcceleratedGradient solver(options);
  Eigen::VectorXd r;
  run(solver, problem, 1e-14, r);
  const double second = 0.5 * (1.0 + std::sqrt(5.0));
  const double third = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * second * second));
  const double y = 0.75 + (second - 1.0) / third * 0.25;
  EXPECT_NEAR(r[0], y - 0.5 * (y - 1.0), 1e-15);
}

TEST(SpectralGradientTest, SecondStepIsBarzilaiBorweins)
{
  // Free rows, W = diag(1, 4), c = -(1, 1). First d = (1, 1), f(d) > f(0): exact step 2/5. Then
  // t = d'Wd / |Wd|^2 = 5/17 and the full step is taken.
  Eigen::Matrix2d W = Eigen::Vector2d(1, 4).asDiagonal();
  Case problem = coneCase(W, Eigen::Vector2d(-1, -1), {{LawType::BILATERAL, 0}, {LawType::BILATERAL, 0}});
  SpectralGradientOptions options;
  options.metric = Metric::UNIT;
  options.max_iterations = 2;
  SpectralGradient solver(options);
  Eigen::VectorXd r;
  run(solver, problem, 1e-14, r);
  EXPECT_NEAR(r[0], 0.4 + 5.0 / 17.0 * 0.6, 1e-15);
  EXPECT_NEAR(r[1], 0.4 - 5.0 / 17.0 * 0.6, 1e-15);
}

TEST(ConvexAdmmTest, FirstIterateByHand)
{
  // r >= 0, W = 1, c = -2, rho = 1, no relaxation: y = 0, x = -c = 2 -> dr = -(c + x)/2 = 0 -> x + r = 2, y = 2.
  Case problem =
      coneCase(Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, -2.0), {{LawType::UNILATERAL, 0}});
  ConvexAdmmOptions options;
  options.relaxation = 1.0;
  options.max_iterations = 1;
  ConvexAdmm solver(options);
  Eigen::VectorXd r;
  run(solver, problem, 1e-14, r);
  EXPECT_NEAR(r[0], 2.0, 1e-15);
}

TEST(LorentzConeTest, NesterovToddScalingMapsThePairOntoOnePoint)
{
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 50; ++k)
  {
    const Vector<3> x(2.0 + std::abs(normal(engine)) * 2, 0.9 * std::sin(k), 0.9 * std::cos(3 * k));
    const Vector<3> z(1.5 + std::abs(normal(engine)), std::cos(k), 0.5 * std::sin(2 * k));
    LorentzScaling scaling;
    ASSERT_TRUE(scalePair(x, z, 3, scaling));
    // Round-off times the condition of N, below 1e2 here.
    EXPECT_LT((scaling.inverse * x - scaling.lambda).norm(), 1e-13);
    EXPECT_LT((scaling.forward.transpose() * z - scaling.lambda).norm(), 1e-13);
    EXPECT_LT((scaling.forward * scaling.inverse - SquareMatrix<3>::Identity()).norm(), 1e-13);
    const LorentzSpectrum s = inverseSquareSpectrum(scaling);
    const double h = std::sqrt(0.5);
    const Vector<3> plus(h, h * s.direction[0], h * s.direction[1]), minus(h, -h * s.direction[0], -h * s.direction[1]);
    const Vector<3> normal_axis(0.0, -s.direction[1], s.direction[0]);
    const SquareMatrix<3> rebuilt = s.plus * plus * plus.transpose() + s.minus * minus * minus.transpose() +
                                    s.perpendicular * normal_axis * normal_axis.transpose();
    EXPECT_LT((rebuilt - scaling.inverse.transpose() * scaling.inverse).norm(), 1e-12);
    const Vector<3> b(0.3, -0.2, 0.5);
    EXPECT_LT((jordanProduct(scaling.lambda, jordanDivide(scaling.lambda, b)) - b).norm(), 1e-14);
  }
}

TEST(LorentzConeTest, LongestStepEndsOnTheBoundary)
{
  const Vector<3> x(2.0, 0.5, -0.3), d(-1.0, 0.7, 0.4);
  const double t = lorentzStep(x, d);
  const Vector<3> end = x + t * d;
  EXPECT_NEAR(end[0], std::hypot(end[1], end[2]), 1e-14);
}

TEST(ConvexSolversTest, AgreeOnProblemsWithAllKindsOfSets)
{
  for (std::uint32_t seed = 1; seed <= 4; ++seed)
    for (bool cylinders : {false, true})
    {
      Case problem = mixedCase(seed, cylinders);
      const double scale = problem.convex.c.lpNorm<Eigen::Infinity>();
      Eigen::VectorXd expected;
      ConvexInteriorPoint reference;
      ASSERT_EQ(run(reference, problem, 1e-12 * scale, expected).status, ConvexStatus::CONVERGED);
      for (const ConvexSolverEntry& entry : convexSolverRegistry())
      {
        const std::unique_ptr<ConvexSolver> solver = entry.create();
        Eigen::VectorXd r;
        const ConvexResult result = run(*solver, problem, 1e-9 * scale, r);
        EXPECT_EQ(result.status, ConvexStatus::CONVERGED) << entry.name << " seed " << seed << " " << result.error;
        // u = W r + c is unique; 1e-9 times the condition of the preconditioned W, up to 1e4.
        EXPECT_LT((problem.local.W.toDense() * (r - expected)).lpNorm<Eigen::Infinity>(), 1e-5 * scale) << entry.name;
      }
    }
}

TEST(ConvexInteriorPointTest, ReachesRoundOffWhenWIsRankDeficient)
{
  // Four corners of a box: 12 rows, rank 6. Any shift s > 0 makes C(s) qualified.
  DelassusReduction reduction;
  const IncrementalProblem box = restingBox(10, {0.5, 0.3, 0.2}, 0.5, {0.3, 0.1, 0}, {0, 0, -9.81}, 1e-2);
  reduction.compute(box);
  Case problem;
  problem.local = reduction.problem();
  problem.local.q[0] += 0.1;
  problem.local.q[6] += 0.05;
  Eigen::VectorXd steps;
  computeStepLengths(problem.local, steps);
  makeConeProblem(problem.local, steps, problem.convex);
  ConvexInteriorPoint solver;
  Eigen::VectorXd r;
  const double scale = problem.convex.c.lpNorm<Eigen::Infinity>();
  const ConvexResult result = run(solver, problem, 1e-12 * scale, r);
  EXPECT_EQ(result.status, ConvexStatus::CONVERGED) << result.error;
  EXPECT_LE(result.error, 1e-12 * scale);
}

TEST(ConvexSolversTest, OptionsAreChecked)
{
  ProjectedGradientOptions gradient;
  gradient.backtracking = 1.5;
  EXPECT_THROW(ProjectedGradient{gradient}, std::invalid_argument);
  ConvexInteriorPointOptions interior;
  interior.step.step_fraction = 1.0;
  EXPECT_THROW(ConvexInteriorPoint{interior}, std::invalid_argument);
  EXPECT_THROW(createConvexSolver("simplex"), std::invalid_argument);
}
