/**
 * @file property_test.cpp
 * @brief What any exact solver of the problem must respect, on random problems with fixed seeds
 * (docs/residuals.md). Velocities are compared where they are unique: little friction, or none. The tolerance 1e-11 on
 * E lets v move by that times the condition of the problem, below 1e3 here.
 */
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "frictional_contact_sim/solver/portfolio.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
constexpr double SAME_VELOCITY = 1e-8;
constexpr std::uint32_t SEEDS = 15;

IncrementalProblem lightFriction(std::uint32_t seed)
{
  RandomProblemOptions options;
  options.moving_externals = true;
  IncrementalProblem problem = randomProblem(options, seed);
  for (Law& law : problem.laws)
    law.coefficient = 0.05;
  return problem;
}

VectorXd velocity(const IncrementalProblem& problem)
{
  Portfolio portfolio;
  StoppingOptions stopping;
  stopping.tolerance = 1e-11;
  portfolio.setStopping(stopping);
  const SolverResult result = portfolio.solve(problem);
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message << " E = " << result.residual;
  return result.solution.v;
}

/** Rows of H and w, and the laws, picked contact by contact (3 rows each). */
IncrementalProblem pickContacts(const IncrementalProblem& problem, const std::vector<int>& order)
{
  IncrementalProblem picked = problem;
  const MatrixXd H = problem.H;
  MatrixXd rows(3 * order.size(), H.cols());
  picked.w.resize(rows.rows());
  picked.laws.clear();
  for (size_t k = 0; k < order.size(); ++k)
  {
    const auto target = 3 * static_cast<Eigen::Index>(k);
    rows.middleRows(target, 3) = H.middleRows(3 * order[k], 3);
    picked.w.segment<3>(target) = problem.w.segment<3>(3 * order[k]);
    picked.laws.push_back(problem.laws[static_cast<size_t>(order[k])]);
  }
  picked.H = sparse(rows);
  return picked;
}
}  // namespace

TEST(SolutionPropertyTest, TheOrderOfContactsDoesNotMatter)
{
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    const IncrementalProblem problem = lightFriction(seed);
    EXPECT_LT((velocity(problem) - velocity(pickContacts(problem, {4, 2, 0, 5, 1, 3}))).norm(), SAME_VELOCITY);
  }
}

TEST(SolutionPropertyTest, ADuplicatedContactLeavesTheVelocitiesUnchanged)
{
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    const IncrementalProblem problem = lightFriction(seed);
    EXPECT_LT((velocity(problem) - velocity(pickContacts(problem, {0, 1, 2, 3, 4, 5, 0, 3, 3}))).norm(), SAME_VELOCITY);
  }
}

TEST(SolutionPropertyTest, TurningTheTangentsDoesNotMatter)
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    const IncrementalProblem problem = lightFriction(seed);
    IncrementalProblem turned = problem;
    MatrixXd H = problem.H;
    for (int i = 0; i < 6; ++i)
    {
      H.middleRows(3 * i, 3) = turn * H.middleRows(3 * i, 3).eval();
      turned.w.segment<3>(3 * i) = turn * problem.w.segment<3>(3 * i);
    }
    turned.H = sparse(H);
    EXPECT_LT((velocity(problem) - velocity(turned)).norm(), SAME_VELOCITY);
  }
}

TEST(SolutionPropertyTest, WithoutFrictionTheTangentialRowsDoNotMatter)
{
  // mu = 0 is the unilateral problem, a convex QP with one v.
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    IncrementalProblem problem = lightFriction(seed);
    IncrementalProblem normal = problem;
    const MatrixXd H = problem.H;
    MatrixXd rows(6, H.cols());
    normal.w.resize(6);
    normal.laws.assign(6, {LawType::UNILATERAL, 0.0});
    for (int i = 0; i < 6; ++i)
    {
      problem.laws[static_cast<size_t>(i)].coefficient = 0.0;
      rows.row(i) = H.row(3 * i);
      normal.w[i] = problem.w[3 * i];
    }
    normal.H = sparse(rows);
    EXPECT_LT((velocity(problem) - velocity(normal)).norm(), SAME_VELOCITY);
  }
}

TEST(SolutionPropertyTest, PlaneContactsAreSpaceContactsWithoutASecondTangent)
{
  RandomProblemOptions options;
  options.contacts = 0;
  options.planar_contacts = 6;
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    IncrementalProblem plane = randomProblem(options, seed);
    for (Law& law : plane.laws)
      law.coefficient = 0.05;
    IncrementalProblem space = plane;
    const MatrixXd H = plane.H;
    MatrixXd rows = MatrixXd::Zero(18, H.cols());
    for (int i = 0; i < 6; ++i)
    {
      rows.middleRows(3 * i, 2) = H.middleRows(2 * i, 2);
      space.laws[static_cast<size_t>(i)].type = LawType::COULOMB_3D;
    }
    space.w.setZero(18);
    space.H = sparse(rows);
    EXPECT_LT((velocity(plane) - velocity(space)).norm(), SAME_VELOCITY);
  }
}

TEST(SolutionPropertyTest, EnormousFrictionSticksAsABilateralConstraint)
{
  // One contact pressed by its own free motion, mu = 100: v is that of the point held when that needs |r_T| < 100 r_N.
  // (More friction measures less: E contains mu |u_T|, so round-off of u counts mu times.)
  RandomProblemOptions options;
  options.contacts = 1;
  options.bodies = 1;
  int pressed = 0;
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    IncrementalProblem problem = randomProblem(options, seed);
    problem.laws[0].coefficient = 100.0;
    IncrementalProblem held = problem;
    held.laws.assign(3, {LawType::BILATERAL, 0.0});
    const MatrixXd M = problem.M, H = problem.H;
    const MatrixXd W = H * M.inverse() * H.transpose();
    const VectorXd r = -W.ldlt().solve(-H * M.inverse() * problem.f);
    if (r.tail<2>().norm() > 50.0 * r[0] || (H * M.inverse() * problem.f)[0] < 0.0)
      continue;
    ++pressed;
    EXPECT_LT((velocity(problem) - velocity(held)).norm(), SAME_VELOCITY);
  }
  EXPECT_GT(pressed, 2);
}

TEST(SolutionPropertyTest, FrictionNeverGivesEnergyToASystemWithoutMovingSurroundings)
{
  // w = 0 and f = -M v_k: the kinetic energy after the step is not above the one before.
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    IncrementalProblem problem = randomProblem({}, seed);
    const VectorXd before = -MatrixXd(problem.M).ldlt().solve(problem.f);
    const VectorXd after = velocity(problem);
    EXPECT_LE(after.dot(problem.M * after), before.dot(problem.M * before) * (1.0 + 1e-12));
  }
}
