#include "frictional_contact_sim/solver/ac_newton.h"

namespace frictional_contact_sim
{
namespace
{
template <int D, RadiusRule RULE>
ContactFunction<D> evaluateAlartCurnier(const Vector<D>& u, const Vector<D>& r, double mu, double rho_normal,
                                        double rho_tangential)
{
  return alartCurnierJacobian<D>(u, r, mu, rho_normal, rho_tangential, RULE);
}
}  // namespace

ContactMap alartCurnierMap(RadiusRule rule)
{
  if (rule == RadiusRule::IMPULSE)
    return {&evaluateAlartCurnier<3, RadiusRule::IMPULSE>, &evaluateAlartCurnier<2, RadiusRule::IMPULSE>};
  return {&evaluateAlartCurnier<3, RadiusRule::AUGMENTED>, &evaluateAlartCurnier<2, RadiusRule::AUGMENTED>};
}

const OptionTable<AcNewtonOptions>& AcNewtonOptions::table()
{
  static const OptionTable<AcNewtonOptions> table =
      OptionTable<AcNewtonOptions>("ac_newton", {{"radius_rule",
                                                  &AcNewtonOptions::radius_rule,
                                                  {"impulse", "augmented"},
                                                  "radius of the friction disc: mu r_N, or mu max(0, r_N - rho u_N)"}})
          .include(&AcNewtonOptions::newton, SemismoothNewtonOptions::table());
  return table;
}

void AcNewtonOptions::validate() const
{
  newton.validate();
}

AcNewton::AcNewton(const AcNewtonOptions& options) : AcNewton(options.newton, options.radius_rule)
{
}

AcNewton::AcNewton(const SemismoothNewtonOptions& options, RadiusRule rule)
  : SemismoothNewton("ac_newton", alartCurnierMap(rule), options)
{
}

}  // namespace frictional_contact_sim
