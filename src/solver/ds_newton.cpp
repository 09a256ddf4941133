#include "frictional_contact_sim/solver/ds_newton.h"

namespace frictional_contact_sim
{
namespace
{
template <int D>
ContactFunction<D> evaluateDeSaxce(const Vector<D>& u, const Vector<D>& r, double mu, double rho_normal,
                                   double rho_tangential)
{
  Vector<D> metric = Vector<D>::Constant(1.0 / std::sqrt(rho_tangential));
  metric[0] = 1.0 / std::sqrt(rho_normal);
  const Vector<D> inverse = metric.cwiseInverse();
  const double scaled_mu = mu * std::sqrt(rho_normal / rho_tangential);
  const Vector<D> x = metric.cwiseProduct(r) - inverse.cwiseProduct(deSaxce<D>(u, mu));
  const SquareMatrix<D> projection = inverse.asDiagonal() * coneProjectionJacobian<D>(x, scaled_mu);
  ContactFunction<D> f;
  f.value = inverse.cwiseProduct(projectOntoCone<D>(x, scaled_mu)) - r;
  f.by_u = -projection * inverse.asDiagonal() * deSaxceJacobian<D>(u, mu);
  f.by_r = projection * metric.asDiagonal() - SquareMatrix<D>::Identity();
  return f;
}
}  // namespace

ContactMap deSaxceMap()
{
  return {&evaluateDeSaxce<3>, &evaluateDeSaxce<2>};
}

DsNewton::DsNewton(const SemismoothNewtonOptions& options) : SemismoothNewton("ds_newton", deSaxceMap(), options)
{
}

}  // namespace frictional_contact_sim
