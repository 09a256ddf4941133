#pragma once
/**
 * @file method_test_support.h
 * @brief What the tests of the Newton, fixed-point and merit-function methods share. Inline, for several test files.
 */
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <functional>
#include <random>
#include <string>

#include "frictional_contact_sim/solver/registry.h"
#include "support/hand_problems.h"

namespace frictional_contact_sim
{
namespace test_support
{
using VectorFunction = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

inline StoppingOptions stopAfter(int iterations, double tolerance = 1e-8)
{
  StoppingOptions options;
  options.max_iterations = iterations;
  options.tolerance = tolerance;
  return options;
}

/**
 * Two contacts in 3D, W = 2 I plus a weak symmetric coupling: all step lengths are 1/2 but for the coupling inside a
 * block, which is none. q pushes the first contact to slide, the second to stick.
 */
inline DelassusProblem twoCoupledContacts()
{
  Eigen::MatrixXd W = 2.0 * Eigen::MatrixXd::Identity(6, 6);
  Eigen::Matrix3d coupling;
  coupling << 0.3, -0.1, 0.2, 0.1, 0.2, -0.2, -0.3, 0.1, 0.2;
  W.topRightCorner<3, 3>() = coupling;
  W.bottomLeftCorner<3, 3>() = coupling.transpose();
  Eigen::VectorXd q(6);
  q << -1.0, -1.5, 0.7, -2.0, 0.3, -0.4;
  return localProblem(W, q, {{LawType::COULOMB_3D, 0.4}, {LawType::COULOMB_3D, 0.9}});
}

/**
 * One contact, W = I, q = (-1, -2, 0), mu = 1/2: slides with r = (1, 1/2, 0), u = (0, -3/2, 0).
 * By hand: r(s) = P_K(1 - s/2, 2, 0) = ((2 - s/2)/1.25) (1, 1/2, 0), so F(s) = 2 - (2 - s/2)/2.5 = 1.2 + 0.2 s.
 */
inline DelassusProblem slidingContact()
{
  return localProblem(Eigen::Matrix3d::Identity(), Eigen::Vector3d(-1, -2, 0), {{LawType::COULOMB_3D, 0.5}});
}

/// Jacobian by central differences; error of order h^2 = 1e-12 and round-off 1e-16 / h = 1e-10.
inline Eigen::MatrixXd numericalJacobian(const VectorFunction& f, const Eigen::VectorXd& x)
{
  constexpr double h = 1e-6;
  Eigen::MatrixXd jacobian(f(x).size(), x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k)
  {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(x.size(), k);
    jacobian.col(k) = (f(x + step) - f(x - step)) / (2.0 * h);
  }
  return jacobian;
}

/// Textbook Fischer-Burmeister function of the Lorentz cone, by spectral decompositions; slow and plain on purpose.
inline Eigen::Vector3d textbookFischerBurmeister(const Eigen::Vector3d& x, const Eigen::Vector3d& y, double alpha)
{
  Eigen::Vector3d w;
  w << x.squaredNorm() + y.squaredNorm() + alpha * alpha, 2.0 * (x[0] * x.tail<2>() + y[0] * y.tail<2>());
  const double norm = w.tail<2>().norm();
  const double low = std::sqrt(w[0] - norm), high = std::sqrt(w[0] + norm);
  Eigen::Vector3d root;
  root << 0.5 * (low + high), (0.5 * (high - low) / norm) * w.tail<2>();
  return x + y - root;
}

/// Phi_alpha of twoCoupledContacts() as a function of z = 2^(1/2) r, written out from (4.11).
inline VectorFunction textbookSystem(const DelassusProblem& problem, double alpha)
{
  return [problem, alpha](const Eigen::VectorXd& z)
  {
    const double root = std::sqrt(2.0);
    const Eigen::VectorXd c = (problem.W.toDense() * (z / root) + problem.q) / root;
    Eigen::VectorXd phi(6);
    for (int i = 0; i < 2; ++i)
    {
      const double mu = problem.laws[static_cast<size_t>(i)].coefficient;
      const Eigen::Vector3d r = z.segment<3>(3 * i), u = c.segment<3>(3 * i);
      const Eigen::Vector3d x(mu * r[0], r[1], r[2]);
      const Eigen::Vector3d y(u[0] + mu * u.tail<2>().norm(), mu * u[1], mu * u[2]);
      phi.segment<3>(3 * i) = textbookFischerBurmeister(x, y, alpha);
    }
    return phi;
  };
}

/// True when x = 2^-k direction for some k: a step shortened by halving, or not.
inline bool isHalvedStep(const Eigen::VectorXd& x, const Eigen::VectorXd& direction, double tolerance)
{
  for (double t = 1.0; t > 1e-4; t *= 0.5)
    if ((x - t * direction).norm() <= tolerance * t * direction.norm())
      return true;
  return false;
}

/// One Newton iteration from `start` follows the direction of the given equations, whose Jacobian is taken numerically.
inline void expectFirstIterateIsNewton(Solver& solver, const DelassusProblem& problem, const VectorFunction& equations,
                                       const Eigen::VectorXd& start)
{
  solver.setStopping(stopAfter(1, 1e-14));
  Solution guess;
  guess.r = start;
  const SolverResult result = solver.solve(problem, &guess);
  EXPECT_EQ(result.iterations, 1);
  const Eigen::VectorXd direction = -numericalJacobian(equations, start).partialPivLu().solve(equations(start));
  // 1e-5: the proximal term of 1e-6 and the differences, times the condition of a problem of order one.
  EXPECT_TRUE(isHalvedStep(result.solution.r - start, direction, 1e-5))
      << (result.solution.r - start).transpose() << " against " << direction.transpose();
}

inline void expectFirstIterateIsNewton(Solver& solver, const DelassusProblem& problem, const VectorFunction& equations)
{
  expectFirstIterateIsNewton(solver, problem, equations, Eigen::VectorXd::Zero(problem.q.size()));
}

/**
 * The method solves small problems of full rank with little friction, where the velocities are unique, and agrees with
 * Gauss-Seidel; all laws together too. 1e-5: tolerance 1e-8 times the condition (up to 1e3) of these problems.
 */
inline void expectAgreementWithGaussSeidel(const std::string& name, int iterations)
{
  for (std::uint32_t seed = 1; seed <= 6; ++seed)
  {
    RandomProblemOptions options;
    options.contacts = 3;
    options.planar_contacts = static_cast<int>(seed % 2);
    options.unilateral = static_cast<int>(seed % 3);
    options.dry = static_cast<int>(seed % 2);
    options.bilaterals = seed > 3 ? 2 : 0;
    IncrementalProblem problem = randomProblem(options, 100 + seed);
    for (Law& law : problem.laws)
      if (law.isCoulomb())
        law.coefficient *= 0.1;
    problem.laws[0].coefficient = 0.0;  // a contact without friction among the others
    const std::unique_ptr<Solver> reference = createSolver("gauss_seidel");
    reference->setStopping(stopAfter(20000, 1e-10));
    const SolverResult expected = reference->solve(problem);
    ASSERT_EQ(expected.status, SolverStatus::CONVERGED) << "seed " << seed;
    const std::unique_ptr<Solver> solver = createSolver(name);
    solver->setStopping(stopAfter(iterations));
    const SolverResult result = solver->solve(problem);
    ASSERT_EQ(result.status, SolverStatus::CONVERGED)
        << name << " seed " << seed << ": " << result.message << ", E = " << result.residual;
    EXPECT_LT((result.solution.v - expected.solution.v).norm(), 1e-5) << name << " seed " << seed;
  }
}

/**
 * Cadoux (2009), figure 3.2: something squeezed between a still and an approaching wall, u_1 + u_2 = q_1 + q_2 < 0:
 * there is no solution. The residual is relative to the impulses: it can only fall below the tolerance with impulses
 * that exceed the scale of the problem by its inverse, which is no answer for anyone but not the method's to judge.
 */
inline void expectHonestWithoutSolution(const std::string& name)
{
  Eigen::MatrixXd W = Eigen::MatrixXd::Identity(6, 6);
  W(0, 3) = W(3, 0) = -1.0;
  Eigen::VectorXd q(6);
  q << -1, 0.2, 0, -1, 0.5, 0;
  const std::unique_ptr<Solver> solver = createSolver(name);
  solver->setStopping(stopAfter(200));
  const SolverResult result =
      solver->solve(localProblem(W, q, {{LawType::COULOMB_3D, 0.5}, {LawType::COULOMB_3D, 0.5}}));
  EXPECT_NE(result.status, SolverStatus::NOT_RUN);
  EXPECT_TRUE(result.solution.r.allFinite());
  if (result.status == SolverStatus::CONVERGED)
    EXPECT_GT(result.solution.r.lpNorm<Eigen::Infinity>(), 0.1 / solver->stopping().tolerance) << name;
  else
    EXPECT_FALSE(result.message.empty()) << name;
}

/// From the start of Cadoux (2009), example D.2, in the order (normal, tangent).
inline void expectConvergenceFromExampleD2(const std::string& name, int iterations)
{
  const IncrementalProblem problem = squareOnTwoContacts();
  Solution start;
  start.v.setZero(3);
  start.u.setZero(4);
  start.r.resize(4);
  start.r << 6, 1, 8, 9;
  start.lambda.resize(0);
  const std::unique_ptr<Solver> solver = createSolver(name);
  solver->setStopping(stopAfter(iterations));
  const SolverResult result = solver->solve(problem, &start);
  ASSERT_EQ(result.status, SolverStatus::CONVERGED) << name << ": " << result.message;
  // v = 0 is the only velocity: the square rests.
  EXPECT_LT(result.solution.v.norm(), 1e-7);
}

}  // namespace test_support
}  // namespace frictional_contact_sim
