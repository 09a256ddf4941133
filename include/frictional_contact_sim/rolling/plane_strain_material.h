#pragma once
/**
 * @file plane_strain_material.h
 * @brief Isotropic linear elasticity in plane strain, and what a pair of bodies makes of it.
 *
 *   G = E / (2 (1 + nu)),   1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2,
 *   beta = ((1 - 2 nu1)/G1 - (1 - 2 nu2)/G2) / (2 ((1 - nu1)/G1 + (1 - nu2)/G2))
 *
 * beta is Dundurs' constant: it couples normal and tangential displacements on the surface. 0 for equal materials, up
 * to 1/2 in size; (1 - 2 nu)/(2 (1 - nu)) on a rigid second body.   Source: Johnson, Contact Mechanics
 * (1985), 4.31, 5.1.
 */
namespace frictional_contact_sim
{
struct PlaneStrainMaterial
{
  double young_modulus = 94500.0;  ///< E [Pa], > 0
  double poisson_ratio = 0.1;  ///< nu [-], in (-1, 0.5)

  double shearModulus() const { return young_modulus / (2.0 * (1.0 + poisson_ratio)); }
  /** @brief (1 - nu^2)/E, the plane-strain compliance [1/Pa]. */
  double compliance() const { return (1.0 - poisson_ratio * poisson_ratio) / young_modulus; }
  /** @brief (1 - 2 nu)(1 + nu)/E, which makes pressure draw the surface sideways [1/Pa]. */
  double couplingCompliance() const { return (1.0 - 2.0 * poisson_ratio) * (1.0 + poisson_ratio) / young_modulus; }
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief The upper body, the lower one or a rigid one in its place (nullptr). */
struct MaterialPair
{
  PlaneStrainMaterial upper;
  PlaneStrainMaterial lower;
  bool lower_is_rigid = true;

  double reducedModulus() const;  ///< E* [Pa]
  double dundursBeta() const;  ///< beta [-]
};

}  // namespace frictional_contact_sim
