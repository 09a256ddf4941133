#pragma once
/**
 * @file reverse_polar.h
 * @brief The reverse polar of a polyhedron from its generators: extreme points and rays, the deepest cut and what it is
 * made of.
 *
 * Theorem 6.6: where Q has full dimension, d in Q^- with sigma_Q(d) = -1 exposes a facet exactly when it is an extreme
 * point of Q^-. Lemma 6.15: with q the projection of the origin on Q and d that on Q^-, d = -q / |q|^2 (6.10), and
 * d.x <= -1 is the deepest cut, at the distance |q| = 1 / |d| from the origin.
 *
 * Theorem 6.11 is printed with the wrong signs: for x in Q and dual norm(d) <= 1 it is norm(x) >= -sigma_Q(d), and at
 * the optimum min norm(x) = max -sigma_Q(d).
 *
 * Source: Cadoux (2009), sections 6.1, 6.2, 7.2.
 */
#include <vector>

#include "frictional_contact_sim/separation/nearest_point.h"
#include "frictional_contact_sim/separation/polyhedron.h"

namespace frictional_contact_sim
{
/** @brief Generators of Q^- without those that others make (and without doubles), as columns, rays of length one. */
struct ReversePolar
{
  Eigen::MatrixXd points;  ///< with Q of full dimension: one a facet that separates
  Eigen::MatrixXd rays;
};

/**
 * @param tolerance a generator nearer than this to what the others make, over its length, is left out [-]
 * @throws std::invalid_argument when the origin is in Q (no b_i < 0)
 */
ReversePolar reversePolar(const Polyhedron& polyhedron, double tolerance = 1e-9);

/**
 * @brief The deepest cut d from the generators of (7.10): with rays among result.generators the deepest cut is not
 * implied by cuts that expose facets alone (figure 7.2).
 * @throws std::invalid_argument when the origin is in Q
 */
NearestPoint deepestCut(const Polyhedron& polyhedron, const NearestPointOptions& options = {});

}  // namespace frictional_contact_sim
