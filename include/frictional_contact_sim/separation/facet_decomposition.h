#pragma once
/**
 * @file facet_decomposition.h
 * @brief Algorithm 7.1 on a disjunctive polyhedron: the deepest cut (Euclidean) and the facet cuts that imply it.
 *
 * The origin is projected on Q^- by nearestPoint() with PolarOracle; d = sum a_i d_i is the deepest cut, and the d_i
 * are extreme points of Q^-, so facets of Q where it has full dimension (theorem 6.6), except those where the bound N
 * of (7.27) is active (`on_bound`) or which are rays.
 *
 * Source: Cadoux (2009), algorithm 7.1, sections 7.1.4, 7.3.
 */
#include <string>

#include "frictional_contact_sim/separation/polar_oracle.h"

namespace frictional_contact_sim
{
/** @brief Where algorithm 7.1 begins. */
enum class DecompositionStart
{
  MOST_VIOLATED,  ///< section 7.3.5
  PROJECTION  ///< the projection on Q is known, only the face of Q^- that its cut is in is asked (7.1.4)
};

struct DecompositionOptions
{
  double bound_factor = 0.0;  ///< N = factor times that of the intersection cut [-]; 0: no bound, rays instead
  DecompositionStart start = DecompositionStart::MOST_VIOLATED;
  NearestPointOptions nearest;
};

struct FacetCut
{
  Eigen::VectorXd direction;  ///< d.x <= -1 on Q; of a ray d.x <= 0
  double weight = 0.0;  ///< in the deepest cut
  double depth = 0.0;  ///< of the hyperplane below the origin, 1/|d|; of a ray 0
  bool is_ray = false;
  bool on_bound = false;  ///< extreme by (7.27), not of Q^-
  std::vector<Eigen::VectorXd> multipliers;  ///< as of ViolatedCut; of a ray b_k.u_k <= 0
};

struct FacetDecomposition
{
  NearestPointStatus status = NearestPointStatus::FAILED;
  std::string message;  ///< why FAILED
  Eigen::VectorXd deepest;  ///< d: d.x <= -1 on Q, |d| least
  double depth = 0.0;  ///< 1/|d|
  std::vector<FacetCut> cuts;
  int calls = 0;  ///< of the oracle
  double bound = 0.0;  ///< N, 0: none
  double gap = 0.0;  ///< of NearestPoint
  std::vector<double> norms;  ///< |d_k| of the iterates: falling (theorem 7.4)
};

/**
 * @param disjunction without empty terms, else fewer cuts are found; the origin in no term
 * @throws std::invalid_argument when it is in one
 */
FacetDecomposition decomposeDeepestCut(const Disjunction& disjunction, const DecompositionOptions& options = {});

/** @brief q, the projection of the origin on Q itself, by the same method with the support function as its oracle. */
NearestPoint projectOrigin(const Disjunction& disjunction, const NearestPointOptions& options = {});

}  // namespace frictional_contact_sim
