#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What a file or a caller may get wrong: one clear line that names the field, what was found and what was expected.
namespace
{
constexpr double NAN_VALUE = std::numeric_limits<double>::quiet_NaN();
constexpr double INFINITE = std::numeric_limits<double>::infinity();

std::string message(const std::function<void()>& call)
{
  try
  {
    call();
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "";
}

void expectLine(const std::string& found, const std::string& part)
{
  EXPECT_NE(found.find(part), std::string::npos) << "'" << found << "' lacks '" << part << "'";
  EXPECT_EQ(found.find('\n'), std::string::npos) << found;
  EXPECT_NE(found.find("expected"), std::string::npos) << found;
}

IncrementalProblem box()
{
  IncrementalProblem problem = restingBox(1.0, {0.1, 0.1, 0.1}, 0.5, Eigen::Vector3d::Zero(), {0.0, 0.0, -9.81}, 0.01);
  problem.G = sparse(MatrixXd::Ones(1, 6));
  problem.b = VectorXd::Zero(1);
  return problem;
}
}  // namespace

TEST(BadDataTest, EveryFieldOfAGlobalProblemIsChecked)
{
  ASSERT_NO_THROW(validate(box()));
  const auto broken = [](const std::function<void(IncrementalProblem&)>& change)
  {
    IncrementalProblem problem = box();
    change(problem);
    return message([&] { validate(problem); });
  };
  expectLine(broken([](IncrementalProblem& p) { p.M = sparse(MatrixXd::Identity(6, 5)); }), "M is 6 x 5");
  expectLine(broken([](IncrementalProblem& p) { p.H = sparse(MatrixXd::Ones(12, 7)); }), "H is 12 x 7");
  expectLine(broken([](IncrementalProblem& p) { p.H = sparse(MatrixXd::Ones(11, 6)); }), "H is 11 x 6");
  expectLine(broken([](IncrementalProblem& p) { p.laws.pop_back(); }), "H is 12 x 6, expected 9 x 6");
  expectLine(broken([](IncrementalProblem& p) { p.f.conservativeResize(5); }), "M is 6 x 6, expected 5 x 5");
  expectLine(broken([](IncrementalProblem& p) { p.w.conservativeResize(11); }), "w has 11 entries");
  expectLine(broken([](IncrementalProblem& p) { p.b.resize(0); }), "G is 1 x 6, expected 0 x 6");
  expectLine(broken([](IncrementalProblem& p) { p.M.coeffRef(2, 2) = NAN_VALUE; }), "M entry");
  expectLine(broken([](IncrementalProblem& p) { p.H.valuePtr()[4] = INFINITE; }), "H entry 4 is inf");
  expectLine(broken([](IncrementalProblem& p) { p.G.valuePtr()[0] = NAN_VALUE; }), "G entry 0 is");
  expectLine(broken([](IncrementalProblem& p) { p.f[1] = -INFINITE; }), "f entry 1 is -inf");
  expectLine(broken([](IncrementalProblem& p) { p.w[0] = NAN_VALUE; }), "w entry 0 is");
  expectLine(broken([](IncrementalProblem& p) { p.b[0] = NAN_VALUE; }), "b entry 0 is");
  expectLine(broken([](IncrementalProblem& p) { p.laws[2].coefficient = -0.1; }), "laws[2].coefficient is -0.1");
  expectLine(broken([](IncrementalProblem& p) { p.laws[2].coefficient = NAN_VALUE; }), "laws[2].coefficient is");
  expectLine(broken([](IncrementalProblem& p) { p.M.uncompress(); }), "M is not compressed");
}

TEST(BadDataTest, EveryFieldOfALocalProblemIsChecked)
{
  IncrementalProblem global = box();
  global.G.resize(0, 6);
  global.b.resize(0);
  const DelassusProblem good = reduce(global);
  ASSERT_NO_THROW(validate(good));
  const auto broken = [&good](const std::function<void(DelassusProblem&)>& change)
  {
    DelassusProblem problem = good;
    change(problem);
    return message([&] { validate(problem); });
  };
  expectLine(broken([](DelassusProblem& p) { p.q.conservativeResize(11); }), "q has 11 entries");
  expectLine(broken([](DelassusProblem& p) { p.q[3] = NAN_VALUE; }), "q entry 3 is");
  expectLine(broken([](DelassusProblem& p) { p.W.dense()(0, 1) = INFINITE; }), "W entry 1 is inf");
  expectLine(broken([](DelassusProblem& p) { p.laws.pop_back(); }), "W has 12 rows in 4 blocks, expected 9 in 3");
  expectLine(broken([](DelassusProblem& p) { p.laws[0].coefficient = -1.0; }), "laws[0].coefficient is -1");
  DelassusOperator W;
  expectLine(message([&] { W.assign(MatrixXd(MatrixXd::Identity(3, 4)), {Law()}); }), "W is 3 x 4");
}

TEST(BadDataTest, ASingularOrIndefiniteMassNamesARow)
{
  IncrementalProblem problem = box();
  MatrixXd M = problem.M;
  M.row(4).setZero();
  M.col(4).setZero();
  problem.M = sparse(M);
  DelassusReduction reduction;
  expectLine(message([&] { reduction.compute(problem); }), "M is not positive definite: pivot of row 4 is 0");
  // The next good problem is not spoiled by the failed one.
  EXPECT_NO_THROW(reduction.compute(box()));
  problem = box();
  problem.M.coeffRef(0, 0) = -1.0;
  expectLine(message([&] { reduction.compute(problem); }), "pivot of row 0 is -1");
}

TEST(BadDataTest, NoContactsAndNoVelocitiesAreProblemsToo)
{
  IncrementalProblem problem = box();
  problem.H.resize(0, 6);
  problem.w.resize(0);
  problem.laws.clear();
  ASSERT_NO_THROW(validate(problem));
  for (const OperatorKind kind : {OperatorKind::AUTOMATIC, OperatorKind::SPARSE, OperatorKind::MATRIX_FREE})
  {
    DelassusReduction reduction;
    reduction.compute(problem, kind);
    EXPECT_EQ(reduction.problem().W.rows(), 0);
    Solution solution;
    solution.r.resize(0);
    reduction.recover(problem, solution);
    EXPECT_LT(std::abs(solution.v.sum()), 1e-15) << "the bilateral row";
  }
  const IncrementalProblem nothing;
  ASSERT_NO_THROW(validate(nothing));
  EXPECT_EQ(reduce(nothing).W.rows(), 0);
}
