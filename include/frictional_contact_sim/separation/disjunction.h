#pragma once
/**
 * @file disjunction.h
 * @brief A disjunctive polyhedron Q = cl conv(union of Q_k), Q_k = common and terms[k], the origin in none of the Q_k.
 *
 * Its reverse polar is the intersection of theirs (lemma 6.4); sigma_Q is the largest of theirs. A split is the pair
 * pi.x <= pi_0 < 0, pi.x >= pi_1 > 0 on top of a relaxation that contains the origin; a complementarity x_i <= 0 or
 * y_i <= 0 is one of the same shape.
 *
 * Source: Cadoux (2009), lemma 6.4, definition 7.14, (7.13).
 */
#include <vector>

#include "frictional_contact_sim/separation/polyhedron.h"

namespace frictional_contact_sim
{
struct Disjunction
{
  Polyhedron common;  ///< may have no rows, but has the dimension
  std::vector<Polyhedron> terms;  ///< rows of each term on top of those

  int dimension() const { return common.dimension(); }
  Polyhedron term(size_t k) const { return intersection(common, terms[k]); }
};

/** @throws std::invalid_argument naming what is wrong: no term, sizes, numbers that are not finite */
void validate(const Disjunction& disjunction);

/** @brief (7.13) with the origin at the point to separate. @throws std::invalid_argument unless pi_0 < 0 < pi_1 */
Disjunction splitDisjunction(const Polyhedron& relaxation, const Eigen::VectorXd& pi, double pi_0, double pi_1);

/** @brief Without the terms that a linear program finds empty (7.3.3). */
Disjunction withoutEmptyTerms(const Disjunction& disjunction);

/** @brief sigma_Q(d), the largest of the terms'; empty terms have no say. */
Support support(const Disjunction& disjunction, const Eigen::VectorXd& direction);

/**
 * @brief The dimension of the face that d exposes, {x in Q; d.x = sigma_Q(d)}; d = 0: of Q itself. -1: empty, or
 * sigma_Q(d) is infinite. By linear programs, independent of any description of Q^-.
 */
int faceDimension(const Disjunction& disjunction, const Eigen::VectorXd& direction);

/** @brief The face that d exposes has one dimension less than Q. */
bool exposesFacet(const Disjunction& disjunction, const Eigen::VectorXd& direction);

}  // namespace frictional_contact_sim
