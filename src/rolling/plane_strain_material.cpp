#include "frictional_contact_sim/rolling/plane_strain_material.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
void PlaneStrainMaterial::validate() const
{
  if (!(young_modulus > 0.0) || !std::isfinite(young_modulus))
    throw std::invalid_argument("young_modulus is " + std::to_string(young_modulus) + ", expected > 0");
  if (!(poisson_ratio > -1.0 && poisson_ratio < 0.5))
    throw std::invalid_argument("poisson_ratio is " + std::to_string(poisson_ratio) + ", expected in (-1, 0.5)");
}

double MaterialPair::reducedModulus() const
{
  return 1.0 / (upper.compliance() + (lower_is_rigid ? 0.0 : lower.compliance()));
}

double MaterialPair::dundursBeta() const
{
  // (1 - 2 nu)/G = 2 couplingCompliance and (1 - nu)/G = 2 compliance.
  const double below = lower_is_rigid ? 0.0 : lower.couplingCompliance();
  return 0.5 * (upper.couplingCompliance() - below) * reducedModulus();
}

}  // namespace frictional_contact_sim
