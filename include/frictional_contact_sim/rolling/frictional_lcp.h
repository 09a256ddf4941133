#pragma once
/**
 * @file frictional_lcp.h
 * @brief The nonsymmetric linear complementarity problem of plane frictional contact and its solution by Lemke's
 * method.
 *
 *   y_N = F_NN r_N + F_NT r_T + d_N >= 0        gap after deformation; d_N: gap before, negative where pressed in [m]
 *   y_T = F_TN r_N + F_TT r_T + d_T             relative tangential displacement (slip); d_T: rigid one [m]
 *   gamma+ = mu r_N + r_T >= 0,  gamma- = mu r_N - r_T >= 0,   y_T = lambda+ - lambda-,  lambda >= 0
 *   0 <= y_N _|_ r_N >= 0,   0 <= gamma _|_ lambda >= 0
 * Slip to the right (lambda+ > 0) makes gamma+ = 0: r_T = -mu r_N, against the slip. Without slip |r_T| <= mu r_N.
 * With r_T = F_TT^-1 (T_T lambda - F_TN r_N - d_T):
 *   z = (r_N, lambda),  M = [ F_NN - F_NT F_TT^-1 F_TN,  F_NT F_TT^-1 T_T ;
 *                             T_N' - T_T' F_TT^-1 F_TN,  T_T' F_TT^-1 T_T ],
 *   b = (d_N - F_NT F_TT^-1 d_T, -T_T' F_TT^-1 d_T)                                                    (37), (38)
 *   T_N = diag [mu, mu] (n x 2n),  T_T = diag [1, -1] (n x 2n),  gamma = T_N' r_N + T_T' r_T           (27)-(30)
 *
 * DEPARTURE: (29) prints T_T^j as a 2 x 2 matrix with a row of zeros and says that F_TT is 2n x 2n; in the plane there
 * is one tangential direction: F_TT is n x n and T_T^j = [1, -1]. M is solved in units in which displacements and
 * flexibilities are of order one. lambda is ordered (all +, all -), so that T_T = [I, -I], T_N = [D, D] with D =
 * diag(mu_i). The law is that of total displacements (one loading step); with d_T carrying what came before it is that
 * of one step of a sequence (rolling_motion.h). Source: Addi, Adly, Goeleven, Thera (2006), (25)-(38); Klarbring and
 * Bjorkman (1988).
 */
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "frictional_contact_sim/rolling/contact_flexibility.h"
#include "frictional_contact_sim/solver/lemke.h"

namespace frictional_contact_sim
{
enum class NodeState
{
  SEPARATION,
  STICK,
  SLIP_RIGHT,  ///< y_T > 0, r_T = -mu r_N
  SLIP_LEFT  ///< y_T < 0, r_T = mu r_N
};

/** @brief The constant's name, for CSV files. */
const char* toString(NodeState state);

struct FrictionalContact
{
  Eigen::VectorXd r_N, r_T;  ///< n, tractions on the upper body [Pa]
  Eigen::VectorXd y_N, y_T;  ///< n, gap and slip [m]
  Eigen::VectorXd u_N, u_T;  ///< n, elastic displacements F r [m]
  std::vector<NodeState> states;  ///< n
  LcpStatus status = LcpStatus::NUMERICAL_FAILURE;
  int pivots = 0;
  double residual = 0.0;  ///< natural map max |min(z, M z + b)| in the units the LCP is solved in (order one) [-]
  double P = 0.0, Q = 0.0;  ///< resultants of r_N and r_T per width [N/m]
};

/** @brief M and b of (38) for one set of nodes; M is kept for many d_N, d_T. */
class FrictionalLcp
{
public:
  /**
   * @param friction mu_i, n values or one for all [-]
   * @throws std::invalid_argument on no nodes, wrong shapes, negative friction
   */
  FrictionalLcp(const ContactFlexibility& flexibility, const Eigen::VectorXd& friction);

  FrictionalContact solve(const Eigen::VectorXd& d_N, const Eigen::VectorXd& d_T,
                          const std::function<bool()>& interrupted = {}) const;
  /**
   * @brief Derivatives of (P, Q) by uniform shifts of (d_N, d_T), with every node's state kept: the answer is piecewise
   * linear in them. @return 2 x 2 [Pa]
   */
  Eigen::Matrix2d loadDerivative(const FrictionalContact& contact) const;

  const ContactFlexibility& flexibility() const { return flexibility_; }
  const Eigen::VectorXd& friction() const { return friction_; }
  /** @brief (38) in SI units. */
  const Eigen::MatrixXd& matrix() const { return M_; }
  Eigen::VectorXd vector(const Eigen::VectorXd& d_N, const Eigen::VectorXd& d_T) const;

private:
  void readStates(const Eigen::VectorXd& lambda, const Eigen::VectorXd& gamma, FrictionalContact& contact) const;

  ContactFlexibility flexibility_;
  Eigen::VectorXd friction_;
  Eigen::MatrixXd inverse_TT_, M_, M_scaled_;
  double unit_;  ///< of flexibility [m/Pa]
};

/** @brief Loads to be met by an outer loop over the rigid displacements. */
struct LoadTarget
{
  double P = 0.0;  ///< > 0 [N/m]
  double Q = 0.0;  ///< on the upper body's surface, |Q| < mu P [N/m]
  double tolerance = 1e-10;  ///< on both loads, relative to P [-]
  int max_iterations = 60;
};

/** @brief The answer and the rigid displacements that give it. */
struct LoadedContact
{
  FrictionalContact contact;
  double approach = 0.0;  ///< d_N = gap - approach [m]
  double shift = 0.0;  ///< d_T = shift + shift_before [m]
  int iterations = 0;
  bool converged = false;
};

/**
 * @brief Newton's method on (approach, shift) with loadDerivative, backtracking; exact once the states are right.
 * @param gap n, before deformation [m]
 * @param d_T0 n, tangential displacement from before, zeros at rest [m]
 * @param approach_guess, shift_guess start [m]
 */
LoadedContact solveForLoads(const FrictionalLcp& lcp, const Eigen::VectorXd& gap, const Eigen::VectorXd& d_T0,
                            const LoadTarget& target, double approach_guess, double shift_guess,
                            const std::function<bool()>& interrupted = {});

}  // namespace frictional_contact_sim
