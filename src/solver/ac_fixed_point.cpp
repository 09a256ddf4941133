#include "frictional_contact_sim/solver/ac_fixed_point.h"

#include <algorithm>

#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
void keep(const Law&, double*)
{
}

template <int T>
void projectTangent(double radius, double* y)
{
  Eigen::Map<Vector<T>> tangential(y);
  tangential = projectOntoBall<T>(Vector<T>(tangential), radius);
}

void project(const Law& law, const double* z, double* y)
{
  if (!law.isCoulomb())
  {
    projectImpulse(law, y);
    return;
  }
  y[0] = std::max(0.0, y[0]);
  const double radius = law.coefficient * z[0];
  if (law.type == LawType::COULOMB_3D)
    projectTangent<2>(radius, y + 1);
  else
    projectTangent<1>(radius, y + 1);
}
}  // namespace

AcFixedPoint::AcFixedPoint(const FixedPointOptions& options)
  : FixedPoint("ac_fixed_point", {&keep, &project}, ScaledContacts::Metric::DIRECTION, options)
{
}

}  // namespace frictional_contact_sim
