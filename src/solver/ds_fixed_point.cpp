#include "frictional_contact_sim/solver/ds_fixed_point.h"

#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
void shift(const Law& law, double* c)
{
  c[0] += deSaxceShift(law, c);
}

void project(const Law& law, const double*, double* y)
{
  projectImpulse(law, y);
}
}  // namespace

DsFixedPoint::DsFixedPoint(const FixedPointOptions& options)
  : FixedPoint("ds_fixed_point", {&shift, &project}, ScaledContacts::Metric::CONTACT, options)
{
}

}  // namespace frictional_contact_sim
