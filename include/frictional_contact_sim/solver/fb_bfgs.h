#pragma once
/**
 * @file fb_bfgs.h
 * @brief fb_bfgs: minimises g = 1/2 |Phi|^2 of solver/fb_system.h by a limited-memory quasi-Newton method.
 *
 *   z <- z + t d,   d = -B grad g, B the BFGS inverse of the last `memory` pairs s = dz, y = d(grad g)
 *   Wolfe:  g(z + t d) <= g + c1 t g',   |g'(z + t d)| <= c2 |g'|,   by bracketing and cubic interpolation
 *
 * Products with W and its transpose only. The first step and every restart are steepest descent of length 1/2 (the
 * merit of one frictionless contact alone has curvature at most 2 in these variables). g is not convex and not
 * everywhere smooth: slow is the rule, as in the thesis; a stationary point that is no solution ends as STAGNATED.
 * Source: Cadoux (2009), 4.3.2, 4.5.3; Nocedal, Wright (2006), algorithms 7.4, 3.5, 3.6.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/fb_system.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct FbBfgsOptions
{
  int memory = 20;  ///< pairs kept, >= 1
  double sufficient_decrease = 1e-4;  ///< c1 [-], in (0, 0.5)
  double curvature = 0.9;  ///< c2 [-], in (c1, 1)
  int line_search_steps = 30;  ///< evaluations a line search, >= 1

  /** @brief What each is, as data. */
  static const OptionTable<FbBfgsOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class FbBfgs : public Solver
{
public:
  explicit FbBfgs(const FbBfgsOptions& options = {});
  void setOptions(const FbBfgsOptions& options);
  OperatorUse operatorUse() const override { return OperatorUse::PRODUCTS; }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  struct Point
  {
    double t = 0.0;
    double merit = 0.0;
    double slope = 0.0;
  };
  Point evaluate(double t);
  bool lineSearch(const Point& start);
  void direction();
  void remember();

  FbBfgsOptions options_;
  FbSystem system_;
  Eigen::VectorXd z_, c_, gradient_, step_, step_velocity_, trial_z_, trial_c_, trial_gradient_, r_, u_;
  Eigen::MatrixXd moves_, changes_;  ///< columns s and y, ring buffer
  Eigen::VectorXd inverse_, weights_;  ///< 1/(s.y), two-loop recursion
  int pairs_ = 0, next_ = 0;
};

}  // namespace frictional_contact_sim
