#include <gtest/gtest.h>

#include <initializer_list>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/solver/cadoux_broyden.h"
#include "frictional_contact_sim/solver/cadoux_fixed_point.h"
#include "frictional_contact_sim/solver/haslinger.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/hand_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
constexpr double TOLERANCE = 1e-8;

StoppingOptions stopping(OperatorKind kind, int iterations = 20000)
{
  StoppingOptions options;
  options.tolerance = TOLERANCE;
  options.max_iterations = iterations;
  options.operator_kind = kind;
  return options;
}

/** Every law beside bilateral rows; immobile external objects, so that a solution exists. */
IncrementalProblem mixedProblem(std::uint32_t seed)
{
  RandomProblemOptions options;
  options.bodies = 6;
  options.contacts = 5;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 1;
  options.bilaterals = 3;
  return randomProblem(options, seed);
}

/**
 * Both runs are the same iterations up to round-off; where both converge their answers are two solutions to 1e-8 of the
 * same problem, and here velocities are unique up to that times the condition of the problem, below 1e3.
 */
int compare(Solver& method)
{
  int converged = 0;
  for (std::uint32_t seed = 1; seed <= 4; ++seed)
  {
    const IncrementalProblem problem = mixedProblem(seed);
    method.setStopping(stopping(OperatorKind::AUTOMATIC));
    const SolverResult with = method.solve(problem);
    method.setStopping(stopping(OperatorKind::MATRIX_FREE));
    const SolverResult without = method.solve(problem);
    EXPECT_EQ(with.status == SolverStatus::CONVERGED, without.status == SolverStatus::CONVERGED)
        << method.name() << " seed " << seed << ": " << with.message << " / " << without.message;
    if (with.status != SolverStatus::CONVERGED || without.status != SolverStatus::CONVERGED)
      continue;
    ++converged;
    EXPECT_LT((with.solution.v - without.solution.v).norm(), 1e-5 * (1.0 + with.solution.v.norm()))
        << method.name() << " seed " << seed;
    EXPECT_LT(validateAnswer(problem, without.solution.v, without.solution.r, without.solution.lambda).worst(), 1e-7)
        << method.name() << " seed " << seed;
  }
  return converged;
}
}  // namespace

TEST(OperatorTest, MethodsThatUseProductsGiveTheSameAnswerWithoutW)
{
  int methods = 0;
  for (const SolverEntry& entry : solverRegistry())
    if (entry.uses == OperatorUse::PRODUCTS)
    {
      ++methods;
      const auto method = entry.create();
      EXPECT_GT(compare(*method), 0) << entry.name << " solved nothing";
    }
  EXPECT_GE(methods, 5);
}

TEST(OperatorTest, OuterFixedPointsRunWithoutWOnEveryGradientMethod)
{
  for (const char* inner : {"projected_gradient", "accelerated_gradient", "spectral_gradient"})
  {
    SCOPED_TRACE(inner);
    CadouxFixedPoint cadoux({}, createConvexSolver(inner));
    Haslinger haslinger({}, createConvexSolver(inner));
    CadouxBroyden broyden({}, createConvexSolver(inner));
    for (Solver* method : std::initializer_list<Solver*>{&cadoux, &haslinger, &broyden})
    {
      EXPECT_EQ(method->operatorUse(), OperatorUse::PRODUCTS);
      EXPECT_GT(compare(*method), 0) << method->name();
    }
  }
  CadouxFixedPoint explicit_inner({}, createConvexSolver("convex_interior_point"));
  EXPECT_EQ(explicit_inner.operatorUse(), OperatorUse::BLOCK_ROWS);
}

TEST(OperatorTest, TheRegistrysColumnIsWhatTheMethodSays)
{
  for (const SolverEntry& entry : solverRegistry())
    EXPECT_EQ(entry.create()->operatorUse(), entry.uses) << entry.name;
}

TEST(OperatorTest, MethodsThatNeedEntriesSaySoInOneLine)
{
  const IncrementalProblem problem = mixedProblem(1);
  for (const SolverEntry& entry : solverRegistry())
  {
    const auto method = entry.create();
    method->setStopping(stopping(OperatorKind::MATRIX_FREE, 5));
    std::string message;
    try
    {
      method->solve(problem);
    }
    catch (const std::invalid_argument& error)
    {
      message = error.what();
    }
    EXPECT_EQ(message.empty(), entry.uses == OperatorUse::PRODUCTS) << entry.name;
    if (message.empty())
      continue;
    EXPECT_NE(message.find("matrix_free"), std::string::npos) << message;
    EXPECT_NE(message.find(entry.name), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  const auto method = createSolver("ds_fixed_point");
  method->setStopping(stopping(OperatorKind::MATRIX_FREE));
  EXPECT_THROW(method->solve(reduce(problem)), std::invalid_argument) << "a local problem is W";
}

TEST(OperatorTest, DenseAndSparseStorageGiveTheSameAnswer)
{
  for (const char* name : {"portfolio", "gauss_seidel", "ac_newton", "interior_point", "cadoux_fixed_point"})
    for (const bool global : {true, false})
    {
      SCOPED_TRACE(name);
      const IncrementalProblem problem = mixedProblem(2);
      const DelassusProblem local = reduce(problem);
      const auto solve = [&](OperatorKind kind)
      {
        const auto method = createSolver(name);
        method->setStopping(stopping(kind));
        return global ? method->solve(problem) : method->solve(local);
      };
      const SolverResult dense = solve(OperatorKind::DENSE);
      const SolverResult sparse = solve(OperatorKind::SPARSE);
      ASSERT_EQ(dense.status, SolverStatus::CONVERGED) << dense.message;
      ASSERT_EQ(sparse.status, SolverStatus::CONVERGED) << sparse.message;
      // As in compare(): two answers to 1e-8.
      EXPECT_LT((dense.solution.u - sparse.solution.u).norm(), 1e-5 * (1.0 + dense.solution.u.norm()));
    }
}

TEST(OperatorTest, NamesOfOperatorsAreReadBack)
{
  for (const OperatorKind kind :
       {OperatorKind::AUTOMATIC, OperatorKind::DENSE, OperatorKind::SPARSE, OperatorKind::MATRIX_FREE})
    EXPECT_EQ(operatorKind(toString(kind)), kind);
  try
  {
    operatorKind("magic");
    FAIL() << "an unknown operator was accepted";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("unknown operator 'magic', expected one of: automatic, dense"),
              std::string::npos)
        << error.what();
  }
}
