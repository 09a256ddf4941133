#pragma once
/**
 * @file scaled_contacts.h
 * @brief A local problem in variables in which every contact's step length is one.
 *
 *   z = S r,   c = S^-1 u = (S^-1 W S^-1) z + S^-1 q,   S diagonal, S^-2 = rho                 z, c in [J]^(1/2)
 *   CONTACT    rho = 1/lambda_max(W_ii) for all rows of a law; laws keep their coefficient
 *   DIRECTION  rho_N = 1/W_NN, rho_T = 1/lambda_max(W_TT);     mu' = mu (rho_N/rho_T)^(1/2)
 *   threshold of a dry friction: S c
 *
 * (u, r) is in its law exactly when (c, z) is in the scaled one: S maps K_mu to K_mu' and S^-1 the duals, and
 * S^-1 (u + mu |u_T| e) = c + mu' |c_T| e. Nothing is copied but diagonals; W is only applied.
 * Source: Acary, Bremond, Huber (2018) on the choice of rho; a diagonal change of metric in Cadoux (2009), (4.8).
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"

namespace frictional_contact_sim
{
/** @brief rho_N and rho_T as above of a law; rho_i, given as rho, where W has none and for one-dimensional laws. */
void directionLengths(const DelassusOperator& W, int law, double rho, double& normal, double& tangential);

class ScaledContacts
{
public:
  enum class Metric
  {
    CONTACT,
    DIRECTION
  };

  /** @brief Refers to the problem until the next call. @param step_lengths 1/lambda_max(W_ii) a law [kg] */
  void set(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths, Metric metric);

  int rows() const { return static_cast<int>(root_.size()); }
  const std::vector<Law>& laws() const { return laws_; }
  int offset(int law) const { return problem_->W.offset(law); }
  const Eigen::VectorXd& freeVelocity() const { return free_; }  ///< S^-1 q
  const Eigen::VectorXd& root() const { return root_; }  ///< diagonal of S^-1 = rho^(1/2) [kg^(1/2)]

  void scaleImpulse(const Eigen::VectorXd& r, Eigen::VectorXd& z) const { z = r.cwiseQuotient(root_); }
  void unscaleImpulse(const Eigen::VectorXd& z, Eigen::VectorXd& r) const { r = z.cwiseProduct(root_); }
  void unscaleVelocity(const Eigen::VectorXd& c, Eigen::VectorXd& u) const { u = c.cwiseQuotient(root_); }
  /** @brief y = S^-1 W S^-1 x; y must not alias x. */
  void apply(const Eigen::VectorXd& x, Eigen::VectorXd& y);
  /** @brief y = S^-1 W' S^-1 x. */
  void applyTransposed(const Eigen::VectorXd& x, Eigen::VectorXd& y);
  /** @brief c = S^-1 W S^-1 z + S^-1 q. */
  void velocity(const Eigen::VectorXd& z, Eigen::VectorXd& c);

private:
  const DelassusProblem* problem_ = nullptr;
  std::vector<Law> laws_;
  Eigen::VectorXd root_, free_, work_;
};

}  // namespace frictional_contact_sim
