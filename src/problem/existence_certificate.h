#pragma once
/**
 * @file existence_certificate.h
 * @brief Checks certificates of problem/existence.h with outward bounds on every rounding error.
 *
 * A sum of k products computed in floating point differs from the exact one by at most (k + 2) eps times the sum of
 * absolute values (Higham (2002), section 3.1); every quantity below is widened by that before it is judged.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
/** @brief A row group of H whose velocity must lie in a dual cone. */
struct DualCone
{
  int law;  ///< index in the problem's laws
  int row;  ///< first row in H
  int dimension;  ///< 1, 2 or 3
  double friction;  ///< [-]
};

/** @brief What the criterion looks at: kinematics only. */
struct ContactKinematics
{
  SparseRows H;  ///< rows x nv
  Eigen::VectorXd w;  ///< rows
  SparseRows E;  ///< bilateral rows x nv
  Eigen::VectorXd b;  ///< bilateral rows
  std::vector<DualCone> cones;
};

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

/** @brief A lower bound of min_i (u_N - mu |u_T|), u = H v' + w, over all v' within `distance` of v (2-norm). */
double verifiedMargin(const ContactKinematics& kinematics, const Eigen::VectorXd& v, double distance);

/**
 * @brief r in L (enforced here by shortening r_T) and lambda prove that no v with |v|_inf below the returned bound has
 * H v + w in L* and E v + b = 0: there r.(H v + w) + lambda.(E v + b) = z.v + r.w + lambda.b would be both >= 0 and <
 * 0.
 * @return the bound, 0 when nothing is proved
 */
double verifiedExclusion(const ContactKinematics& kinematics, Eigen::VectorXd& r, const Eigen::VectorXd& lambda);

}  // namespace frictional_contact_sim
