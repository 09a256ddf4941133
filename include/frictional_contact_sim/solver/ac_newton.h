#pragma once
/**
 * @file ac_newton.h
 * @brief ac_newton: semismooth Newton (solver/semismooth_newton.h) on the Alart-Curnier function.
 *
 *   f_N = max(0, r_N - rho_N u_N) - r_N,   f_T = P_B(0, mu R)(r_T - rho_T u_T) - r_T,   rho_N = 1/W_NN, rho_T =
 * 1/lambda_max(W_TT) The registry's method takes R = max(0, r_N - rho_N u_N); the thesis's R = r_N is the other choice
 * of the factory. Source: Alart, Curnier (1991); Cadoux (2009), (1.23), (1.24), (4.6), appendix D.
 */
#include "frictional_contact_sim/solver/semismooth_newton.h"

namespace frictional_contact_sim
{
/** @brief The Alart-Curnier function with the given rule for the radius of the friction disc. */
ContactMap alartCurnierMap(RadiusRule rule);

struct AcNewtonOptions
{
  SemismoothNewtonOptions newton;
  RadiusRule radius_rule = RadiusRule::AUGMENTED;  ///< radius of the friction disc

  /** @brief What each is, as data. */
  static const OptionTable<AcNewtonOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class AcNewton : public SemismoothNewton
{
public:
  explicit AcNewton(const AcNewtonOptions& options);
  explicit AcNewton(const SemismoothNewtonOptions& options = {}, RadiusRule rule = RadiusRule::AUGMENTED);
};

}  // namespace frictional_contact_sim
