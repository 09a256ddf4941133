/**
 * @file method_property_test.cpp
 * @brief Properties that every method must respect where it converges and the velocities are unique: little friction.
 * property_test.cpp asks them of the portfolio to eleven digits; here the residual is 1e-8, and v is known to that
 * times the condition of the problem, below 1e3.
 */
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/solver/lemke.h"
#include "judgement.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
constexpr double SAME_VELOCITY = 1e-5;
constexpr std::uint32_t SEEDS = 3;

IncrementalProblem lightFriction(std::uint32_t seed, double friction = 0.05)
{
  RandomProblemOptions options;
  options.contacts = 4;
  IncrementalProblem problem = randomProblem(options, 20 + seed);
  for (Law& law : problem.laws)
    law.coefficient = friction;
  return problem;
}

VectorXd freeMotion(const IncrementalProblem& problem)
{
  return -MatrixXd(problem.M).ldlt().solve(problem.f);
}

/// check(solver's v) for every method that converges on each of `problem(seed)`; each but `excused` has to on most.
template <typename Problem, typename Check>
void forEveryMethod(Problem problem, Check check, const std::set<std::string>& excused = {})
{
  for (const SolverEntry& entry : solverRegistry())
  {
    SCOPED_TRACE(entry.name);
    int converged = 0;
    for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
    {
      const SolverResult result = solveAndJudge(entry, problem(seed), "seed " + std::to_string(seed), nullptr, 20000);
      if (result.status != SolverStatus::CONVERGED)
        continue;
      ++converged;
      check(seed, entry, result);
    }
    EXPECT_GE(converged, excused.count(entry.name) > 0 ? 0 : 2);
  }
}
}  // namespace

TEST(MethodPropertyTest, WithoutFrictionTheQuadraticProgram)
{
  // Its dual by Lemke: 0 <= r_N orthogonal W_NN r_N + q_N >= 0; v is the projection of the free motion, unique.
  const auto problem = [](std::uint32_t seed) { return lightFriction(seed, 0.0); };
  forEveryMethod(problem,
                 [&](std::uint32_t seed, const SolverEntry&, const SolverResult& result)
                 {
                   const IncrementalProblem plain = problem(seed);
                   const DelassusProblem local = reduce(plain);
                   const MatrixXd W = local.W.toDense();
                   const VectorXd r =
                       solveLemke(W(Eigen::seqN(0, 4, 3), Eigen::seqN(0, 4, 3)), local.q(Eigen::seqN(0, 4, 3))).x;
                   const MatrixXd normals = MatrixXd(plain.H)(Eigen::seqN(0, 4, 3), Eigen::all);
                   const VectorXd v = freeMotion(plain) + MatrixXd(plain.M).ldlt().solve(normals.transpose() * r);
                   EXPECT_LT((result.solution.v - v).norm(), SAME_VELOCITY) << seed;
                 });
}

TEST(MethodPropertyTest, PlanarContactsInSpaceAgreeWithLemkeInThePlane)
{
  const auto plane = [](std::uint32_t seed)
  {
    RandomProblemOptions options;
    options.contacts = 0;
    options.planar_contacts = 4;
    IncrementalProblem problem = randomProblem(options, 40 + seed);
    for (Law& law : problem.laws)
      law.coefficient = 0.05;
    return problem;
  };
  const auto space = [&](std::uint32_t seed)
  {
    IncrementalProblem problem = plane(seed);
    const MatrixXd H = problem.H;
    MatrixXd rows = MatrixXd::Zero(12, H.cols());
    for (int i = 0; i < 4; ++i)
    {
      rows.middleRows(3 * i, 2) = H.middleRows(2 * i, 2);
      problem.laws[static_cast<size_t>(i)].type = LawType::COULOMB_3D;
    }
    problem.H = sparse(rows);
    problem.w.setZero(12);
    return problem;
  };
  forEveryMethod(space,
                 [&](std::uint32_t seed, const SolverEntry&, const SolverResult& result)
                 {
                   const SolverResult lemke = createSolver("lcp_lemke")->solve(plane(seed));
                   ASSERT_EQ(lemke.status, SolverStatus::CONVERGED);
                   EXPECT_LT((result.solution.v - lemke.solution.v).norm(), SAME_VELOCITY) << seed;
                 });
}

TEST(MethodPropertyTest, ADuplicatedContactLeavesTheVelocityUnchanged)
{
  const auto doubled = [](std::uint32_t seed)
  {
    IncrementalProblem problem = lightFriction(seed);
    const MatrixXd H = problem.H;
    MatrixXd rows(H.rows() + 3, H.cols());
    rows << H, H.topRows(3);
    problem.H = sparse(rows);
    problem.w.setZero(rows.rows());
    problem.laws.push_back(problem.laws.front());
    return problem;
  };
  forEveryMethod(doubled,
                 [&](std::uint32_t seed, const SolverEntry& entry, const SolverResult& result)
                 {
                   const SolverResult single =
                       solveAndJudge(entry, lightFriction(seed), "the single contact", nullptr, 20000);
                   ASSERT_EQ(single.status, SolverStatus::CONVERGED);
                   EXPECT_LT((result.solution.v - single.solution.v).norm(), SAME_VELOCITY) << seed;
                 });
}

TEST(MethodPropertyTest, UnitsDoNotMatter)
{
  // Mass in units of 4^-6, velocity in units of 4^3: powers of four, whose roots are exact, so that only a constant
  // with a hidden unit can change an iterate. v scales to round-off, the count of iterations stays.
  const double mass = std::pow(4.0, 6), speed = std::pow(4.0, -3);
  const auto rescaled = [&](std::uint32_t seed)
  {
    IncrementalProblem problem = lightFriction(seed);
    problem.M *= mass;
    problem.f *= mass * speed;
    return problem;
  };
  forEveryMethod(rescaled,
                 [&](std::uint32_t seed, const SolverEntry& entry, const SolverResult& result)
                 {
                   const SolverResult plain =
                       solveAndJudge(entry, lightFriction(seed), "the plain units", nullptr, 20000);
                   EXPECT_LT((result.solution.v / speed - plain.solution.v).norm(), SAME_VELOCITY) << seed;
                   EXPECT_EQ(result.iterations, plain.iterations) << seed;
                 });
}

TEST(MethodPropertyTest, OrderAndTangentsDoNotMatter)
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const auto shuffled = [&](std::uint32_t seed)
  {
    IncrementalProblem problem = lightFriction(seed);
    const MatrixXd H = problem.H;
    MatrixXd rows = H;
    for (int i = 0; i < 4; ++i)
      rows.middleRows(3 * i, 3) = turn * H.middleRows(3 * (3 - i), 3);
    problem.H = sparse(rows);
    return problem;
  };
  forEveryMethod(shuffled,
                 [&](std::uint32_t seed, const SolverEntry& entry, const SolverResult& result)
                 {
                   const SolverResult plain =
                       solveAndJudge(entry, lightFriction(seed), "the plain order", nullptr, 20000);
                   ASSERT_EQ(plain.status, SolverStatus::CONVERGED);
                   EXPECT_LT((result.solution.v - plain.solution.v).norm(), SAME_VELOCITY) << seed;
                 });
}

TEST(MethodPropertyTest, EnormousFrictionSticksAsABilateralConstraint)
{
  // A contact pushed with r = (2, 0.3, -0.2) to rest: |r_T| is far below 100 r_N, so v is that of the point held. The
  // fixed points contract with 1/mu^2, and the bipotential's product mu r_N |u_T| outweighs any penalty.
  const auto stuck = [](std::uint32_t seed)
  {
    RandomProblemOptions options;
    options.contacts = 1;
    options.bodies = 1;
    IncrementalProblem problem = randomProblem(options, 60 + seed);
    problem.laws[0].coefficient = 100.0;
    const MatrixXd H = problem.H;
    problem.f = H.transpose() * Eigen::Vector3d(2, 0.3, -0.2);
    return problem;
  };
  forEveryMethod(stuck,
                 [&](std::uint32_t seed, const SolverEntry&, const SolverResult& result)
                 { EXPECT_LT(result.solution.v.norm(), SAME_VELOCITY) << seed; },
                 {"ds_fixed_point", "bipotential", "haslinger", "cadoux_fixed_point", "cadoux_broyden"});
}
