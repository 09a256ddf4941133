#pragma once
/**
 * @file fixed_point.h
 * @brief Fixed-point iterations z <- P(z - theta F(z)) with a step length theta that adapts; products W r only.
 *
 *   trial    y = P(z - theta F(z));   ratio = theta |F(y) - F(z)| / |y - z|
 *   ratio > largest_ratio     theta <- shrink theta, try again
 *   else                      z <- y;  ratio < smallest_ratio:  theta <- theta / shrink
 * z, F in the variables of solver/scaled_contacts.h, where theta is dimensionless and 1 is the step of each contact
 * alone. What F and P are is the method's (ds_fixed_point, ac_fixed_point). An iteration is one product with W. The
 * best iterate is returned; these methods may diverge or cycle, and then say so.
 *
 * Source: Cadoux (2009), 4.4.4; Khobotov (1987) and Acary, Bremond, Huber (2018), self-adaptive step length. Plain
 * iterations with theta fixed: adapt = false.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/scaled_contacts.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct FixedPointOptions
{
  double first_step = 1.0;  ///< theta at the start [-], > 0
  bool adapt = true;  ///< false: theta stays at first_step
  double largest_ratio = 0.9;  ///< accepted theta |F(y) - F(z)| / |y - z| [-], in (0, 2)
  double smallest_ratio = 0.3;  ///< below it theta grows [-], in (0, largest_ratio)
  double shrink = 2.0 / 3.0;  ///< factor on theta [-], in (0, 1)

  /** @brief What each is, as data. */
  static const OptionTable<FixedPointOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief F and P of one law, on its 1 to 3 rows. */
struct FixedPointMap
{
  void (*field)(const Law& law, double* c);  ///< c <- F, given the velocity c
  void (*project)(const Law& law, const double* z, double* y);  ///< y <- P(y), z the iterate it comes from
};

class FixedPoint : public Solver
{
public:
  FixedPoint(std::string name, const FixedPointMap& map, ScaledContacts::Metric metric,
             const FixedPointOptions& options);
  void setOptions(const FixedPointOptions& options);
  OperatorUse operatorUse() const override { return OperatorUse::PRODUCTS; }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  double evaluate(const DelassusProblem& problem, const SolveContext& context, const Eigen::VectorXd& z,
                  Eigen::VectorXd& field);
  void advance(double theta);

  FixedPointMap map_;
  ScaledContacts::Metric metric_;
  FixedPointOptions options_;
  ScaledContacts scaled_;
  Eigen::VectorXd z_, field_, trial_, trial_field_, r_, u_;
};

}  // namespace frictional_contact_sim
