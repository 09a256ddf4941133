#pragma once
/**
 * @file thesis_problems.h
 * @brief Problems with closed-form answers of Cadoux (2009), sections 1.4 and 3.3, contact frames normal first.
 */
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief A problem from dense matrices, without bilateral rows. */
IncrementalProblem denseProblem(const Eigen::MatrixXd& M, const Eigen::VectorXd& f, const Eigen::MatrixXd& H,
                                const Eigen::VectorXd& w, const std::vector<Law>& laws);
/** @brief The same with M = I, f = 0, on which existence does not depend. */
IncrementalProblem kinematics(const Eigen::MatrixXd& H, const Eigen::VectorXd& w, const std::vector<Law>& laws);

/**
 * @brief Painleve's rod (1.38) with the thesis's values nu = 2, l = 1, h = 2/3, v_0 = 0: one velocity, one planar
 * contact,  M = 1,  f = -g sin(theta),  rows sin(theta) (normal) and cos(theta) (tangent),  w = (0, u_0).
 * @param gravity +1 upwards, (1.39); -1 downwards, (1.42)
 */
IncrementalProblem painleveRod(double angle, double friction, double gravity, double support_velocity);

/** @brief Example 3.21: m = 2, M = I, normal first H = [1 0; 1 0; 0 1], f = (0, 1), w = 0, mu = 1. */
IncrementalProblem example321();

/** @brief A mass on a spring above a stop, at rest: displacement v >= 0 downwards,  k v - m g = -r,  0 <= h - v. */
IncrementalProblem springAndStop(double weight, double stiffness, double height);

/**
 * @brief The subset-sum machine (1.48)-(1.50), mu = 2, velocities (v^1..v^k, v^g, v^d, v^s); solvable exactly when a
 * subset of `values` sums to `total`. (1.49) is misprinted: u^g = (-v^g - v^s, v^g + 1), u^d = (v^d - v^s, v^d + 1),
 * the only signs for which H is the transpose of what (1.48) multiplies r with.
 */
IncrementalProblem subsetSumMachine(const std::vector<double>& values, double total);
/** @brief The impulses of the machine when the bars of `chosen` slide: r^i = f^i (1, -2), the others zero. */
Eigen::VectorXd subsetSumImpulses(const std::vector<double>& values, const std::vector<bool>& chosen);

/** @brief Figure 3.2: a disc of mass 1 between a still plane and one that approaches with `speed`; no solution. */
IncrementalProblem squeezedDisc(double speed, double friction);

}  // namespace test_support
}  // namespace frictional_contact_sim
