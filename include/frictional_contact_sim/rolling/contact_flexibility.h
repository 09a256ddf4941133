#pragma once
/**
 * @file contact_flexibility.h
 * @brief What tractions on the contact nodes do to the relative displacements there:  w = F r  (23), (24).
 *
 *   w = (w_N, w_T)  displacement of the upper body minus that of the lower one, along e_N (into the upper body) and
 *                   e_T (to the right) [m]
 *   r = (r_N, r_T)  traction on the upper body, constant on each node's element [Pa]: r_N >= 0 is pressure
 *
 * DEPARTURE: (23) has F = -[H_cc C' - ...]^-1 [G_cc C' - ...], negative definite since (17) turns the tractions round
 * but not the displacements. (33) to (38) need the positive one, which is what is computed here: both w and r are
 * counted along e_N and e_T.
 *
 * Two sources:
 *   half-plane   w_N, w_T of a strip of constant traction on an elastic half-plane, in closed form (Johnson 1985, 2.13,
 *                2.14, 2.22):  F_NN = F_TT = -(2/(pi E*)) int ln(|x - s|/D) ds,
 *                F_NT = -F_TN = (k1 - k2)/2 int sgn(x - s) ds,   k = (1 - 2 nu)(1 + nu)/E.
 *                D, the datum, is where the displacement counts as zero: a half-plane has no other support.
 *   cylinder     boundary elements, condensed (15)-(24): unknown t on the held elements and u on the free ones are
 *                eliminated.
 * Flexibilities of the two bodies add. n contact nodes; each block n x n [m/Pa].
 */
#include <Eigen/Core>

#include "frictional_contact_sim/rolling/boundary_elements.h"

namespace frictional_contact_sim
{
struct ContactFlexibility
{
  Eigen::VectorXd x;  ///< n, positions along the surface [m], ascending
  Eigen::VectorXd width;  ///< n, lengths of the elements [m]
  Eigen::MatrixXd NN, NT, TN, TT;  ///< n x n, [m/Pa]

  Eigen::Index size() const { return x.size(); }
  /** @brief [NN NT; TN TT]. */
  Eigen::MatrixXd full() const;
  /** @brief |F L - (F L)'| / |F L| (Frobenius), L = diag(1/width): forces instead of tractions. 0 for an exact F. */
  double asymmetry() const;
};

/** @brief Middle points and widths of n equal strips over [-half_width, half_width]. */
void makeUniformNodes(double half_width, int count, Eigen::VectorXd& x, Eigen::VectorXd& width);

/** @brief Of the upper half-plane alone. @param datum D [m], larger than the contact zone. */
ContactFlexibility halfPlaneFlexibility(const PlaneStrainMaterial& material, const Eigen::VectorXd& x,
                                        const Eigen::VectorXd& width, double datum);
/** @brief Of a pair of half-planes. */
ContactFlexibility halfPlaneFlexibility(const MaterialPair& materials, const Eigen::VectorXd& x,
                                        const Eigen::VectorXd& width, double datum);

enum class ContactFrames
{
  CONTOUR,  ///< e_N, e_T of each element (the paper's C_i)
  FLAT  ///< e_N = y, e_T = x for all
};

/**
 * @brief Of the upper body by boundary elements, condensed to its CONTACT elements.
 * @throws std::invalid_argument without contact or without held elements, or on a bad contour
 */
ContactFlexibility condense(const Contour& contour, const PlaneStrainMaterial& material, ContactFrames frames);

/** @brief The lower half-plane's share is added to an upper body's flexibility. */
void addLowerHalfPlane(const PlaneStrainMaterial& material, double datum, ContactFlexibility& flexibility);

}  // namespace frictional_contact_sim
