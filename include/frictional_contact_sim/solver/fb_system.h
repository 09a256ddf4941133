#pragma once
/**
 * @file fb_system.h
 * @brief The incremental problem as a system of equations by Fischer-Burmeister functions, and steps for it.
 *
 *   Phi_alpha(z) = phi_alpha(c(z), z) = 0,   c(z) = W_s z + q_s      variables of solver/scaled_contacts.h, [J]^(1/2)
 *   J(z)         = A W_s + B,                A = dphi/dc, B = dphi/dz  block-diagonal
 *   merit        g(z) = 1/2 |Phi|^2,         grad g = W_s' (A' Phi) + B' Phi: products with W only
 *
 * phi of each law: math/complementarity_functions.h (Coulomb in the Jordan algebra, unilateral scalar, dry friction by
 * Billups's composition, bilateral c = 0). alpha = 0: plain; alpha > 0: smoothed.
 * Source: Cadoux (2009), 4.2.3, 4.3.2, 4.5; Fukushima, Luo, Tseng (2002).
 */
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <memory>

#include "frictional_contact_sim/solver/scaled_contacts.h"

namespace frictional_contact_sim
{
class FbSystem
{
public:
  /** @brief Refers to the problem until the next call. */
  void set(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths);

  ScaledContacts& contacts() { return contacts_; }
  int rows() const { return contacts_.rows(); }
  const DelassusProblem& problem() const { return *problem_; }
  /** @brief c(z). */
  void velocity(const Eigen::VectorXd& z, Eigen::VectorXd& c) { contacts_.velocity(z, c); }
  /** @brief Phi_alpha at (c, z), with A and B when asked for. @return 1/2 |Phi|^2 [J] */
  double evaluate(const Eigen::VectorXd& c, const Eigen::VectorXd& z, double alpha, bool jacobians);
  const Eigen::VectorXd& value() const { return phi_; }
  /** @brief grad g from the last evaluation with Jacobians. */
  void gradient(Eigen::VectorXd& g);
  /** @brief Visits the entries of row block i of J: visit(row, column, value); the diagonal block comes twice. */
  template <typename Visitor>
  void visitJacobian(int i, Visitor visit) const;

private:
  const DelassusProblem* problem_ = nullptr;
  ScaledContacts contacts_;
  Eigen::VectorXd phi_, work_;
  std::vector<double> by_c_, by_z_;  ///< A_i and B_i, 9 numbers a law, row-major
};

template <typename Visitor>
inline void FbSystem::visitJacobian(int i, Visitor visit) const
{
  const int d = problem_->W.dimension(i);
  const int first = contacts_.offset(i);
  const double* A = &by_c_[9 * static_cast<size_t>(i)];
  const double* B = &by_z_[9 * static_cast<size_t>(i)];
  const Eigen::VectorXd& root = contacts_.root();
  problem_->W.visitRow(i,
                       [&](int column, const double* w, int stride)
                       {
                         for (int a = 0; a < d; ++a)
                         {
                           double sum = 0.0;
                           for (int k = 0; k < d; ++k)
                             sum += A[d * a + k] * root[first + k] * w[k * stride];
                           visit(first + a, column, sum * root[column]);
                         }
                       });
  for (int a = 0; a < d; ++a)
    for (int b = 0; b < d; ++b)
      visit(first + a, first + b, B[d * a + b]);
}

/** @brief Linear algebra for steps on Phi = 0: dense when W is stored dense, sparse otherwise (which allocates), J' J
 * by its own density. */
class FbSteps
{
public:
  FbSteps();
  ~FbSteps();

  /** @brief Assembles J from the system's last evaluation with Jacobians. */
  void assemble(const FbSystem& system);
  /** @brief J d = -Phi by LU. @return false when the step is not finite */
  bool newton(const FbSystem& system, Eigen::VectorXd& d);
  /**
   * @brief (J' J + lambda I) d = -J' Phi by Cholesky. @param lambda [-], > 0
   * @param predicted 1/2 |Phi|^2 - 1/2 |Phi + J d|^2 [J]
   */
  bool leastSquares(const FbSystem& system, double lambda, Eigen::VectorXd& d, double& predicted);
  /** @brief J' Phi, of the last leastSquares. */
  const Eigen::VectorXd& gradient() const { return gradient_; }

private:
  void makeNormal(const FbSystem& system);

  struct Sparse;
  bool dense_ = true;
  bool normal_ready_ = false;
  bool dense_normal_ = true;
  Eigen::MatrixXd jacobian_, normal_, shifted_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  Eigen::VectorXd gradient_, product_;
  std::unique_ptr<Sparse> sparse_;
};

}  // namespace frictional_contact_sim
