#pragma once
/**
 * @file residual_metric.h
 * @brief What the errors |e_i| of the laws are measured with, law by law, from the data of a problem alone.
 *
 *   rho_i = 1/lambda_max(W_ii)                                                          [kg]
 *   S_i   = max(|q| of the island's rows of the same unit, S_0 of the island)           [m/s], rows of angles [rad/s]
 *   S_0   = max(1e-12, 1e-6 |q| of the whole)                           a bare problem: nothing but M, H, f, w, ...
 *         = the largest change of speed of a point of the island's bodies that one step's smooth forces give [m/s],
 *           for rows of angles over the reach of the links they move   a simulation says it, LawScale
 *
 * Of a row that is one-sided (normal, joint limit) only the negative part of q counts: an idle limit 0.01 rad away has
 * q = 10 rad/s. q = w - H M^-1 f, bilaterals or not. Neither u nor r of an answer enters: with max |r_i|/rho_i in S a
 * self-stress of 1e8 N passed for an answer. Nor do other islands, in a simulation: an island's bits are its own.
 *
 * Why S_0 is not left to q: dry friction of a robot in free fall has q = round-off, and so have its joints' own shares
 * of M^-1 dt (bias - applied); only the bodies' speed, g dt, says what matters. See docs/residuals.md.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/islands.h"
#include "frictional_contact_sim/problem/law.h"
#include "frictional_contact_sim/problem/law_scale.h"

namespace frictional_contact_sim
{
/// Below any velocity that matters; keeps 0/0 away when everything is at rest without loads [m/s].
constexpr double VELOCITY_FLOOR = 1e-12;

class ResidualMetric
{
public:
  /// Times eps, relative to LawScale::speed: an error that small is the round-off of u = H v + w.
  static constexpr double ROUND_OFF = 64.0;

  Eigen::VectorXd step_lengths;  ///< rho_i, a law each
  Eigen::VectorXd scales;  ///< S_i, a law each
  Eigen::VectorXd round_off;  ///< errors up to this count as zero, a law each

  /**
   * @brief Sets scales and round_off.
   * @param given one a law, or empty: a bare problem, whose round_off is 0
   * @param q of all rows [m/s]
   * @param islands of W
   */
  void setScales(const std::vector<Law>& laws, const std::vector<LawScale>& given, const Eigen::VectorXd& q,
                 const Islands& islands);

private:
  /// Of an island: the largest q of each unit, and S_0 as a speed.
  struct Largest
  {
    double q[3] = {0.0, 0.0, 0.0};
    double speed_change = 0.0;
  };
  std::vector<Largest> largest_;
};

}  // namespace frictional_contact_sim
