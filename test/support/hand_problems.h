#pragma once
/**
 * @file hand_problems.h
 * @brief Small problems with known answers and random families with fixed seeds, for the tests of several modules.
 */
#include <cstdint>
#include <random>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief Sparse rows from a dense matrix (exact zeros dropped). */
SparseRows sparse(const Eigen::MatrixXd& matrix);

/** @brief The local problem of W, q and laws. */
DelassusProblem localProblem(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws);

/**
 * @brief A box of mass m [kg], half sizes a, b, c [m], resting with its four lower corners on the ground z = 0.
 * Velocities: linear and angular velocity of the centre, world axes (nv = 6); H has rank 6 of 12 rows.
 * f = -m (velocity - dt gravity) on the linear part.
 */
IncrementalProblem restingBox(double mass, const Eigen::Vector3d& half_sizes, double friction,
                              const Eigen::Vector3d& velocity, const Eigen::Vector3d& gravity, double time_step);

/** @brief Cadoux (2009), example D.2: the square on two contacts, rows (normal, tangent). */
IncrementalProblem squareOnTwoContacts();

/** @brief What a random problem is made of. */
struct RandomProblemOptions
{
  int bodies = 4;  ///< blocks of 6 velocities
  int contacts = 6;  ///< Coulomb contacts in 3D between random pairs (or a body and the world)
  int planar_contacts = 0;  ///< Coulomb contacts in 2D
  int unilateral = 0;  ///< one-dimensional rows of each kind
  int dry = 0;
  int bilaterals = 0;  ///< rows of G
  bool moving_externals = false;  ///< w != 0 (otherwise 0: a solution always exists, Cadoux (2009), chapter 3)
};

/** @brief A random problem with a solution: immobile external objects, or w in the range of H when they move. */
IncrementalProblem randomProblem(const RandomProblemOptions& options, std::uint32_t seed);

}  // namespace test_support
}  // namespace frictional_contact_sim
