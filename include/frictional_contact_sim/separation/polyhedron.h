#pragma once
/**
 * @file polyhedron.h
 * @brief Q = {x in R^n; A x <= b}: support function, normal cone, and the generators of its reverse polar.
 *
 *   sigma_Q(d) = sup {d.x; x in Q}                           (6.1)
 *   Q^- = {d; sigma_Q(d) <= -1},  N_Q = {d; sigma_Q(d) <= 0}   (6.2), (6.4); N_Q is the recession cone of Q^- (6.5)
 *   N_Q = cone A^T E,  E = {e_i; b_i <= 0} and {b_j e_i - b_i e_j; b_i < 0 < b_j}     (7.6), (7.7)
 *   Q^- = conv(P_i; b_i < 0) + cone A^T E,  P_i = -a_i / b_i                         (7.9), (7.10)
 *
 * The last two need Q non-empty (Farkas); (7.10) holds without full dimension too, only its points are then no longer
 * extreme. d is a cut, d.x <= -1 for all x in Q, exactly when d is in Q^-.
 *
 * Source: Cadoux (2009), sections 6.1, 7.2.1, 7.2.2.
 */
#include <Eigen/Core>
#include <string>

#include "frictional_contact_sim/problem/linear_program.h"

namespace frictional_contact_sim
{
struct Polyhedron
{
  Eigen::MatrixXd A;  ///< rows a_i, m x n
  Eigen::VectorXd b;  ///< m

  int rows() const { return static_cast<int>(A.rows()); }
  int dimension() const { return static_cast<int>(A.cols()); }
};

/** @throws std::invalid_argument naming `name` when sizes differ or a number is not finite */
void validate(const Polyhedron& polyhedron, const std::string& name);

/** @brief All rows of both. */
Polyhedron intersection(const Polyhedron& first, const Polyhedron& second);

/** @brief In coordinates x - origin. */
Polyhedron translated(const Polyhedron& polyhedron, const Eigen::VectorXd& origin);

/** @brief Every row divided by |a_i|; rows of zeros stay. */
Polyhedron withUnitRows(const Polyhedron& polyhedron);

/** @brief Rows of the multipliers E of (7.6), as columns: m x |E|. */
Eigen::MatrixXd normalConeMultipliers(const Eigen::VectorXd& b);

/** @brief A^T E (7.7): columns that generate N_Q, among them some that are not extreme. n x |E|. */
Eigen::MatrixXd normalConeGenerators(const Polyhedron& polyhedron);

/** @brief P_i of (7.9) as columns: all extreme points of Q^-, and others where the description is not minimal. */
Eigen::MatrixXd reversePolarPoints(const Polyhedron& polyhedron);

/** @brief sup {d.x}: OPTIMAL with value and point; UNBOUNDED: point is a ray; INFEASIBLE: Q is empty, value -infinity.
 */
struct Support
{
  LinearProgramStatus status = LinearProgramStatus::STOPPED;
  double value = 0.0;
  Eigen::VectorXd point;
};

/** @brief The linear program of one polyhedron, for many directions. */
class SupportProgram
{
public:
  explicit SupportProgram(const Polyhedron& polyhedron);
  /** @param direction d, n */
  Support maximise(const Eigen::VectorXd& direction);

private:
  LinearProgram program_;
  bool feasible_;
};

}  // namespace frictional_contact_sim
