#pragma once
/**
 * @file criterion_program.h
 * @brief The linear program of problem/existence.h on a polyhedral cone that facets build up.
 *
 *   min -s,   H v - u = -w,   E v = -b,   u_N - s - c d.u_T >= 0 for every facet (cone, d, c),   |v|_inf <= R
 *
 * The velocities u are columns of their own, so that a facet has four entries.
 */
#include <vector>

#include "contact_kinematics.h"
#include "frictional_contact_sim/problem/linear_program.h"

namespace frictional_contact_sim
{
/** @brief The program's units: |w| for u and s, |w|/max|H_i| for v, so that its data are about one. */
struct CriterionUnits
{
  double height = 1.0;  ///< of H
  double velocity = 1.0;  ///< of u and s
};

class CriterionProgram
{
public:
  /** @param bound R @param cap s is not driven beyond it, in units.velocity */
  CriterionProgram(const ContactKinematics& kinematics, const CriterionUnits& units, double bound, double cap);

  /** @brief u_N - s >= slope d.u_T for a cone; slope = 0: the normal alone. */
  void addFacet(int cone, const Eigen::Vector2d& direction, double slope);
  /** @return true when an optimum was found */
  bool solve(int max_iterations);

  /** @brief In the problem's units. */
  Eigen::VectorXd v() const { return (units_.velocity / units_.height) * x_.head(first_u_); }
  /** @brief In units.velocity. */
  double s() const { return x_[s_]; }
  double u(int row) const { return x_[first_u_ + row]; }
  /** @brief The multipliers of the facets as impulses in L, which sum up to one, and those of E. */
  void multipliers(Eigen::VectorXd& r, Eigen::VectorXd& lambda) const;

private:
  struct Facet
  {
    int row;
    int cone;
    Eigen::Vector2d slope;
  };

  int addMatrix(const SparseRows& matrix, const Eigen::VectorXd& offset, int first_slack);

  const ContactKinematics& kinematics_;
  CriterionUnits units_;
  LinearProgram program_;
  int first_u_ = 0;
  int s_ = 0;
  int first_bilateral_ = 0;
  std::vector<Facet> facets_;
  Eigen::VectorXd x_;
};

}  // namespace frictional_contact_sim
