#pragma once
/**
 * @file rolling_motion.h
 * @brief Slip in rolling: the paper's formula on a static answer, rolling in time, and rolling at rest (steady).
 *
 * The contact patch travels to the right over both surfaces with speed V; seen from it, material enters at the right
 * (leading) edge and leaves at the left. x is fixed to the patch; xi: creepage, the rigid velocity of the upper surface
 * relative to the lower one over V, to the right positive.
 *
 *   (12)      s_i = xi + sgn(V) (u_T(x_{i+1}) - u_T(x_i))/h_i, explicitly, on the static answer (slip velocity over V)
 *   in time   in one step the material moves one node to the left, h = V dt. What is at node i was at node i + 1:
 *                y_T,i = u_T,i(new) - u_T,i+1(old) + xi h
 *             which is the LCP of frictional_lcp.h with d_T,i = xi h - u_T,i+1(old): the particles carry their strain.
 *             Backward Euler along the particles: first order in h, unconditionally dissipative.
 *   steady    old = new: y_T = D u_T + xi h, D = 1 on the diagonal, -1 right of it; the same LCP with D F_TN, D F_TT
 * for F_TN, F_TT. s_i = y_T,i/h is the slip velocity over V. With V to the right (12) has the sign sgn(V) = -1: u_T
 * grows where material meets it later.
 *
 * Nodes must be equally spaced and the rightmost one out of contact, since its material comes in unstrained.
 * Source: Addi, Adly, Goeleven, Thera (2006), (8)-(12); Kalker (1990), 1.3, for the particles' strain; Carter (1926).
 */
#include <vector>

#include "frictional_contact_sim/rolling/frictional_lcp.h"

namespace frictional_contact_sim
{
/** @brief (12); the last node repeats its neighbour's difference. @param direction sgn(V), +1 or -1 */
Eigen::VectorXd slipVelocity(const Eigen::VectorXd& x, const Eigen::VectorXd& u_T, double creepage, double direction);

struct RollingOptions
{
  double load = 0.0;  ///< P to be kept by the approach [N/m]; 0: the approach is kept
  int max_steps = 2000;  ///< of one node each
  double steady_tolerance = 1e-6;  ///< largest change of r_T in a step over mu max r_N that counts as steady [-]
  std::function<void(int step, double change)> progress;  ///< called after each step when set
  std::function<bool()> interrupted;  ///< asked at every step when set
};

struct RollingResult
{
  FrictionalContact contact;  ///< the last step's; y_T is the slip during that step [m]
  Eigen::VectorXd slip;  ///< n, slip velocity over V [-]
  std::vector<double> history;  ///< Q after each step [N/m]
  double approach = 0.0;  ///< of the rigid bodies at the end [m]
  int steps = 0;
  bool steady = false;
};

/**
 * @brief Rolls at a given creepage until steady.
 * @param gap n, before deformation; d_N = gap - approach [m]
 * @param u_T0 n, tangential displacements at the start (zeros: untouched) [m]
 * @throws std::invalid_argument when the nodes are not equally spaced or the rightmost one touches
 */
RollingResult roll(const FrictionalLcp& lcp, const Eigen::VectorXd& gap, double approach, const Eigen::VectorXd& u_T0,
                   double creepage, const RollingOptions& options = {});

/** @brief The steady state in one LCP (a few when a load is given). @throws as roll */
RollingResult rollSteadily(const ContactFlexibility& flexibility, double friction, const Eigen::VectorXd& gap,
                           double approach, double creepage, const RollingOptions& options = {});

}  // namespace frictional_contact_sim
