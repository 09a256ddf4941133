#pragma once
/**
 * @file fclib_encoding.h
 * @brief Mixed laws written as Coulomb contacts of one dimension; the exact encodings of problem/fclib.h. Internal.
 */
#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
using EncodedSolution = Solution;

struct EncodedGlobal
{
  IncrementalProblem problem;  ///< Coulomb contacts of one dimension and rows of G only
  std::vector<double> friction;
  int dimension = 3;
  EncodedSolution solution;
};

struct EncodedLocal
{
  SparseRows W, V, R;
  Eigen::VectorXd q, s;
  std::vector<LawScale> scales;  ///< of the contacts
  std::vector<double> friction;
  int dimension = 3;
  EncodedSolution solution;
};

/** @param solution may be nullptr */
EncodedGlobal encodeGlobal(const IncrementalProblem& problem, const Solution* solution);
EncodedLocal encodeLocal(const DelassusProblem& problem, const Solution* solution);

}  // namespace frictional_contact_sim
