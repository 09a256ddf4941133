#include "frictional_contact_sim/problem/islands.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <new>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/allocation_counter.h"
#include "support/hand_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
const Law CONTACT{LawType::COULOMB_3D, 0.4};
const Law PLANAR{LawType::COULOMB_2D, 0.5};
const Law STOP{LawType::UNILATERAL, 0.0};

/** A well conditioned problem with the given laws, pressed together and sliding; numbers differ with `turn`. */
DelassusProblem part(const std::vector<Law>& laws, double turn)
{
  const int rows = rowCount(laws);
  MatrixXd half(rows, rows);
  VectorXd q(rows);
  for (int i = 0; i < rows; ++i)
  {
    q[i] = -1.0 + 0.5 * std::sin(turn + i);
    for (int j = 0; j < rows; ++j)
      half(i, j) = std::cos(turn * (1 + i) + 2.0 * j) / rows;
  }
  return localProblem(half * half.transpose() + MatrixXd::Identity(rows, rows), q, laws);
}

/** Where the laws of several parts stand in the whole: one of each part in turn. */
struct Union
{
  DelassusProblem problem;
  std::vector<std::vector<int>> rows;  ///< of each part, in the whole
};

Union unite(const std::vector<DelassusProblem>& parts)
{
  Union whole;
  whole.rows.resize(parts.size());
  int count = 0;
  size_t longest = 0;
  for (const DelassusProblem& part : parts)
    longest = std::max(longest, part.laws.size());
  for (size_t i = 0; i < longest; ++i)
    for (size_t k = 0; k < parts.size(); ++k)
      if (i < parts[k].laws.size())
      {
        whole.problem.laws.push_back(parts[k].laws[i]);
        for (int row = 0; row < parts[k].laws[i].dimension(); ++row)
          whole.rows[k].push_back(count++);
      }
  MatrixXd W = MatrixXd::Zero(count, count);
  whole.problem.q.resize(count);
  for (size_t k = 0; k < parts.size(); ++k)
  {
    const MatrixXd block = parts[k].W.toDense();
    for (size_t i = 0; i < whole.rows[k].size(); ++i)
    {
      whole.problem.q[whole.rows[k][i]] = parts[k].q[static_cast<Eigen::Index>(i)];
      for (size_t j = 0; j < whole.rows[k].size(); ++j)
        W(whole.rows[k][i], whole.rows[k][j]) = block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  whole.problem.W.assign(W, whole.problem.laws);
  return whole;
}

VectorXd slice(const VectorXd& whole, const std::vector<int>& rows)
{
  VectorXd values(static_cast<Eigen::Index>(rows.size()));
  for (size_t i = 0; i < rows.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = whole[rows[i]];
  return values;
}

std::vector<DelassusProblem> threeParts()
{
  return {part({CONTACT, CONTACT, CONTACT}, 0.3), part({STOP}, 1.1), part({PLANAR, CONTACT, STOP}, 2.7)};
}

/** Two stops that ask for opposite velocities of one body: no solution. */
DelassusProblem squeezed(double speed)
{
  MatrixXd W(2, 2);
  W << 1, -1, -1, 1;
  return localProblem(W, Eigen::Vector2d(-speed, -speed), {STOP, STOP});
}
/** Asks for more memory than there is. */
class Greedy : public Solver
{
public:
  Greedy() : Solver("greedy") {}

protected:
  void doSolve(const DelassusProblem&, const SolveContext&, SolverResult&) override { throw std::bad_alloc(); }
};
}  // namespace

TEST(SolverTest, RunningOutOfMemoryIsAStatus)
{
  Greedy solver;
  for (const DelassusProblem& problem : {unite(threeParts()).problem, threeParts()[0]})
  {
    const SolverResult result = solver.solve(problem);
    EXPECT_EQ(result.status, SolverStatus::NUMERICAL_FAILURE);
    EXPECT_NE(result.message.find("not enough memory"), std::string::npos) << result.message;
    EXPECT_EQ(result.solution.r.size(), problem.q.size());
  }
}

TEST(SolverTest, WithoutRowsAGuessChangesNothing)
{
  DelassusProblem empty;
  empty.W.assign(MatrixXd(0, 0), {});
  Solution guess;
  guess.r.resize(0);
  for (const SolverEntry& entry : solverRegistry())
  {
    const SolverResult result = entry.create()->solve(empty, &guess);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << entry.name;
    EXPECT_EQ(result.iterations, 0) << entry.name;
  }
}

TEST(IslandsTest, AreTheConnectedPartsOfW)
{
  // Chain 0-2-4, pair 1-5 coupled by one entry of one triangle, 3 alone.
  const std::vector<Law> laws(6, PLANAR);
  MatrixXd W = MatrixXd::Identity(12, 12);
  W(0, 5) = W(5, 0) = 0.1;
  W(4, 9) = W(9, 4) = -0.1;
  W(11, 2) = 1e-12;
  std::vector<int> begin = {0};
  std::vector<int> pattern;
  for (int i = 0; i < 6; ++i)
  {
    for (int j = 0; j < 6; ++j)
      pattern.push_back(j);
    begin.push_back(6 * (i + 1));
  }
  for (const bool dense : {true, false})
  {
    DelassusOperator matrix;
    matrix.assign(W, laws);
    if (!dense)
    {
      // Every block stored, most of them zero: zeros do not couple.
      matrix.resizeSparse(laws, begin, pattern);
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j)
          Eigen::Map<Eigen::Matrix2d>(matrix.block(i, j)) = W.block<2, 2>(2 * i, 2 * j);
    }
    ASSERT_EQ(matrix.isDense(), dense);
    Islands islands;
    ASSERT_EQ(islands.find(matrix), 3);
    std::vector<int> found;
    islands.laws(0, found);
    EXPECT_EQ(found, (std::vector<int>{3}));
    islands.laws(1, found);
    EXPECT_EQ(found, (std::vector<int>{1, 5}));
    islands.laws(2, found);
    EXPECT_EQ(found, (std::vector<int>{0, 2, 4}));
  }
  W(6, 0) = 1.0;
  W(7, 2) = 1.0;
  DelassusOperator matrix;
  matrix.assign(W, laws);
  Islands islands;
  EXPECT_EQ(islands.find(matrix), 1);
  EXPECT_EQ(islands.count(), 0);
}

TEST(IslandsTest, EveryMethodSolvesThemAsIfAlone)
{
  const std::vector<DelassusProblem> parts = threeParts();
  const Union whole = unite(parts);
  for (const SolverEntry& entry : solverRegistry())
  {
    SCOPED_TRACE(entry.name);
    const SolverResult together = entry.create()->solve(whole.problem);
    int iterations = 0;
    bool all = true;
    for (size_t k = 0; k < parts.size(); ++k)
    {
      const SolverResult alone = entry.create()->solve(parts[k]);
      iterations = std::max(iterations, alone.iterations);
      all = all && alone.status == SolverStatus::CONVERGED;
      // The same numbers in the same order, so the same bits.
      EXPECT_EQ((slice(together.solution.r, whole.rows[k]) - alone.solution.r).norm(), 0.0) << "part " << k;
    }
    EXPECT_EQ(together.iterations, iterations);
    EXPECT_EQ(together.status == SolverStatus::CONVERGED, all);
    if (all)
    {
      EXPECT_LT(validateAnswer(whole.problem, together.solution.r).worst(), 1e-7);
    }
    EXPECT_EQ((entry.create()->solve(whole.problem).solution.r - together.solution.r).norm(), 0.0) << "deterministic";
  }
}

TEST(IslandsTest, EachGetsItsPartOfTheGuess)
{
  const std::vector<DelassusProblem> parts = threeParts();
  const Union whole = unite(parts);
  for (const char* name : {"portfolio", "gauss_seidel", "ac_newton", "cadoux_fixed_point"})
  {
    SCOPED_TRACE(name);
    const auto solver = createSolver(name);
    const SolverResult first = solver->solve(whole.problem);
    ASSERT_EQ(first.status, SolverStatus::CONVERGED);
    const SolverResult second = solver->solve(whole.problem, &first.solution);
    EXPECT_EQ(second.status, SolverStatus::CONVERGED);
    EXPECT_EQ(second.iterations, 0);
    EXPECT_EQ((second.solution.r - first.solution.r).norm(), 0.0);
    // One island disturbed: only that one is solved again.
    Solution disturbed = first.solution;
    for (const int row : whole.rows[0])
      disturbed.r[row] = 0.0;
    const SolverResult third = solver->solve(whole.problem, &disturbed);
    EXPECT_EQ(third.status, SolverStatus::CONVERGED);
    for (const size_t k : {size_t(1), size_t(2)})
      EXPECT_EQ((slice(third.solution.r, whole.rows[k]) - slice(first.solution.r, whole.rows[k])).norm(), 0.0);
  }
}

TEST(IslandsTest, AHopelessOneLeavesTheOthersTheirAnswers)
{
  std::vector<DelassusProblem> parts = threeParts();
  parts.push_back(squeezed(1.0));
  const Union whole = unite(parts);
  for (const SolverEntry& entry : solverRegistry())
  {
    SCOPED_TRACE(entry.name);
    const SolverResult together = entry.create()->solve(whole.problem);
    EXPECT_NE(together.status, SolverStatus::CONVERGED);
    EXPECT_GT(together.residual, 1e-8);
    EXPECT_NE(together.message, "");
    for (size_t k = 0; k + 1 < parts.size(); ++k)
    {
      const SolverResult alone = entry.create()->solve(parts[k]);
      EXPECT_EQ((slice(together.solution.r, whole.rows[k]) - alone.solution.r).norm(), 0.0) << "part " << k;
    }
  }
  const SolverResult result = createSolver("gauss_seidel")->solve(whole.problem);
  EXPECT_NE(result.message.find("island of law 3"), std::string::npos) << result.message;
}

TEST(IslandsTest, OneAtRestWithRoundOffIsNoFailure)
{
  // The squeezed body's contradiction is 1e-15 of the others' velocities: nothing that the whole's residual could see.
  std::vector<DelassusProblem> parts = threeParts();
  parts.push_back(squeezed(1e-15));
  const Union whole = unite(parts);
  for (const char* name : {"portfolio", "gauss_seidel", "ac_newton", "interior_point"})
  {
    const SolverResult result = createSolver(name)->solve(whole.problem);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << name << ": " << result.message;
    // Whatever a method starts from there, 1e-15 or nothing, stays.
    EXPECT_LT(slice(result.solution.r, whole.rows[3]).norm(), 1e-14) << name;
  }
}

TEST(IslandsTest, SplittingChangesNothingButTheWay)
{
  const Union whole = unite(threeParts());
  const auto solver = createSolver("portfolio");
  StoppingOptions stopping;
  stopping.tolerance = 1e-12;
  solver->setStopping(stopping);
  const VectorXd apart = solver->solve(whole.problem).solution.r;
  stopping.split_islands = false;
  solver->setStopping(stopping);
  // W is positive definite with condition below 10 and friction is moderate: one solution, found to 10 times 1e-12.
  EXPECT_LT((solver->solve(whole.problem).solution.r - apart).norm(), 1e-10);
}

TEST(IslandsTest, LargeOnesKeepBlockStorage)
{
  // Two chains of 80 contacts, interleaved: 480 rows stored by blocks, islands of 240 rows each.
  constexpr int LINKS = 80;
  std::vector<Law> laws(2 * LINKS, CONTACT);
  MatrixXd W = 2.0 * MatrixXd::Identity(6 * LINKS, 6 * LINKS);
  for (int i = 0; i + 2 < 2 * LINKS; ++i)
    W.block<3, 3>(3 * i, 3 * i + 6) = W.block<3, 3>(3 * i + 6, 3 * i) = -0.4 * Eigen::Matrix3d::Identity();
  VectorXd q(6 * LINKS);
  for (int i = 0; i < q.size(); ++i)
    q[i] = -0.5 + std::sin(3.0 * i);
  DelassusProblem problem;
  problem.laws = laws;
  problem.q = q;
  problem.W.assign(W, laws);
  ASSERT_FALSE(problem.W.isDense());
  Islands islands;
  ASSERT_EQ(islands.find(problem.W), 2);
  std::vector<int> chain, position(laws.size(), -1);
  islands.laws(1, chain);
  for (size_t k = 0; k < chain.size(); ++k)
    position[static_cast<size_t>(chain[k])] = static_cast<int>(k);
  DelassusOperator island;
  island.assignBlocks(problem.W, chain, position, std::vector<Law>(LINKS, CONTACT));
  EXPECT_FALSE(island.isDense());
  MatrixXd expected(3 * LINKS, 3 * LINKS);
  for (int i = 0; i < LINKS; ++i)
    for (int j = 0; j < LINKS; ++j)
      expected.block<3, 3>(3 * i, 3 * j) =
          W.block<3, 3>(3 * chain[static_cast<size_t>(i)], 3 * chain[static_cast<size_t>(j)]);
  EXPECT_EQ((island.toDense() - expected).norm(), 0.0);
  EXPECT_EQ((island.diagonalBlock<3>(5) - 2.0 * Eigen::Matrix3d::Identity()).norm(), 0.0);
  for (const char* name : {"portfolio", "gauss_seidel"})
  {
    const SolverResult result = createSolver(name)->solve(problem);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << name << ": " << result.message;
    EXPECT_LT(validateAnswer(problem, result.solution.r).worst(), 1e-7) << name;
  }
}

TEST(IslandsTest, SeparateBodiesOfAGlobalProblemAreSolvedApart)
{
  // Two boxes that never meet: the block-diagonal problem of both gives what each gives.
  const IncrementalProblem left = restingBox(2.0, {0.1, 0.2, 0.3}, 0.5, {0.3, 0.0, -0.2}, {0.0, 0.0, -9.81}, 0.01);
  const IncrementalProblem right = restingBox(0.7, {0.3, 0.1, 0.1}, 0.2, {-1.0, 0.5, 0.0}, {0.0, 0.0, -9.81}, 0.01);
  const auto stack = [](const SparseRows& a, const SparseRows& b)
  {
    MatrixXd both = MatrixXd::Zero(a.rows() + b.rows(), a.cols() + b.cols());
    both.topLeftCorner(a.rows(), a.cols()) = a;
    both.bottomRightCorner(b.rows(), b.cols()) = b;
    return sparse(both);
  };
  IncrementalProblem both;
  both.M = stack(left.M, right.M);
  both.H = stack(left.H, right.H);
  both.f.resize(12);
  both.f << left.f, right.f;
  both.w.resize(24);
  both.w << left.w, right.w;
  both.laws = left.laws;
  both.laws.insert(both.laws.end(), right.laws.begin(), right.laws.end());
  both.G.resize(0, 12);
  both.b.resize(0);
  Islands islands;
  EXPECT_EQ(islands.find(reduce(both).W), 2);
  const auto solver = createSolver("portfolio");
  const SolverResult together = solver->solve(both);
  ASSERT_EQ(together.status, SolverStatus::CONVERGED);
  // Velocities are unique. Each is known to the residual 1e-8 times speeds of order 1 and a condition of W below 100.
  EXPECT_LT((together.solution.v.head(6) - solver->solve(left).solution.v).norm(), 1e-6);
  EXPECT_LT((together.solution.v.tail(6) - solver->solve(right).solution.v).norm(), 1e-6);
}

TEST(IslandsTest, RepeatedSolvesAllocateNothing)
{
  // Islands of three shapes, solved cold again and again as in a scene whose contacts stay.
  const Union whole = unite(threeParts());
  for (const char* name : {"portfolio", "gauss_seidel", "ac_newton"})
  {
    const auto solver = createSolver(name);
    SolverResult result;
    solver->solve(whole.problem, nullptr, result);
    solver->solve(whole.problem, nullptr, result);
    ASSERT_GT(result.iterations, 0) << name;
    const AllocationCounter counter;
    solver->solve(whole.problem, nullptr, result);
    EXPECT_EQ(counter.count(), 0) << name;
  }
}

TEST(IslandsTest, OptionsChangedLaterReachTheIslands)
{
  const Union whole = unite(threeParts());
  GaussSeidel solver;
  const SolverResult first = solver.solve(whole.problem);
  GaussSeidelOptions options;
  options.relaxation = 0.5;
  solver.setOptions(options);
  const SolverResult relaxed = solver.solve(whole.problem);
  EXPECT_EQ(relaxed.iterations, GaussSeidel(options).solve(whole.problem).iterations);
  EXPECT_GT(relaxed.iterations, first.iterations);
}
