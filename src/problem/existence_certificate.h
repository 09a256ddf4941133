#pragma once
/**
 * @file existence_certificate.h
 * @brief Checks certificates of problem/existence.h with outward bounds on every rounding error.
 *
 * A sum of k products computed in floating point differs from the exact one by at most (k + 2) eps times the sum of
 * absolute values (Higham (2002), section 3.1); every quantity below is widened by that before it is judged.
 */
#include "contact_kinematics.h"

namespace frictional_contact_sim
{
/** @brief Moves v onto E v + b = 0 and bounds what is left. */
class BilateralCorrection
{
public:
  explicit BilateralCorrection(const ContactKinematics& kinematics);
  /** @brief Corrects v in place. @return bound on the 2-norm of the correction that is still missing. */
  double apply(Eigen::VectorXd& v) const;

private:
  const ContactKinematics& kinematics_;
  Eigen::MatrixXd pseudo_inverse_;  ///< nv x bilateral rows, least norm on the independent rows
};

/**
 * @brief How far the data must move for v to be exact: with w changed in row j by at most this many units of round-off
 * of |H||v| + |w| the margin is at least 0 (rounding errors of this evaluation counted in).
 * @param distance as in verifiedMargin. @param change the largest change of w itself [m/s]
 * @return units of DBL_EPSILON; infinite where no change of that kind helps
 */
double roundOffMissing(const ContactKinematics& kinematics, const Eigen::VectorXd& v, double distance, double& change);

/** @brief A lower bound of min_i (u_N - mu |u_T|), u = H v' + w, over all v' within `distance` of v (2-norm). */
double verifiedMargin(const ContactKinematics& kinematics, const Eigen::VectorXd& v, double distance);

/**
 * @brief r in L (enforced here by shortening r_T) and lambda prove that no v with |v|_inf below the returned bound has
 * H v + w in L* and E v + b = 0: there r.(H v + w) + lambda.(E v + b) = z.v + r.w + lambda.b would be both >= 0 and <
 * 0.
 * @return the bound, 0 when nothing is proved
 */
double verifiedExclusion(const ContactKinematics& kinematics, Eigen::VectorXd& r, const Eigen::VectorXd& lambda);

/**
 * @brief lambda of contradicting bilateral rows: the part of -b that no velocity makes. verifiedExclusion() with r = 0
 * says whether it proves anything.
 */
Eigen::VectorXd contradiction(const ContactKinematics& kinematics);

}  // namespace frictional_contact_sim
