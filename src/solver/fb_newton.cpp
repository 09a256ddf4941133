#include "frictional_contact_sim/solver/fb_newton.h"

#include "frictional_contact_sim/math/complementarity_functions.h"

namespace frictional_contact_sim
{
namespace
{
template <int D>
ContactFunction<D> evaluateFischerBurmeister(const Vector<D>& u, const Vector<D>& r, double mu, double rho_normal,
                                             double rho_tangential)
{
  Vector<D> metric = Vector<D>::Constant(1.0 / std::sqrt(rho_tangential));
  metric[0] = 1.0 / std::sqrt(rho_normal);
  const Vector<D> inverse = metric.cwiseInverse();
  const double scaled_mu = mu * std::sqrt(rho_normal / rho_tangential);
  ContactFunction<D> f =
      coulombFischerBurmeister<D>(inverse.cwiseProduct(u), metric.cwiseProduct(r), scaled_mu, 0.0, true);
  f.value = inverse.cwiseProduct(f.value);
  f.by_u = inverse.asDiagonal() * f.by_u * inverse.asDiagonal();
  f.by_r = inverse.asDiagonal() * f.by_r * metric.asDiagonal();
  return f;
}
}  // namespace

ContactMap fischerBurmeisterMap()
{
  return {&evaluateFischerBurmeister<3>, &evaluateFischerBurmeister<2>};
}

FbNewton::FbNewton(const SemismoothNewtonOptions& options)
  : SemismoothNewton("fb_newton", fischerBurmeisterMap(), options)
{
}

}  // namespace frictional_contact_sim
