#pragma once
/**
 * @file boundary_elements.h
 * @brief Plane-strain elasticity by direct boundary elements with constant elements:  H u = G t.
 *
 *   u_i(x)/2 + int T_ij(x, y) u_j(y) ds = int U_ij(x, y) t_j(y) ds,      x at the middle of each element,
 *   U_ij = [ (3 - 4 nu) ln(1/r) delta_ij + r,i r,j ] / (8 pi G (1 - nu))                        (Kelvin)
 *   T_ij = -[ r,n ((1 - 2 nu) delta_ij + 2 r,i r,j) + (1 - 2 nu)(n_i r,j - n_j r,i) ] / (4 pi (1 - nu) r)
 *
 * u, t: displacement [m] and traction [Pa], constant on each flat element, 2 n, x and y of element 0, then of
 * element 1. All integrals in closed form, also on the element of the collocation point (where the principal value of T
 * vanishes). Rigid translations fulfil H u = 0 to round-off; rotations and linear fields to the order of the elements.
 * Lengths inside the logarithm are divided by `length_unit`, which adds a constant displacement for tractions with a
 * resultant. It must differ from the contour's critical size (about the radius), where G is singular.
 * Source: Brebbia and Dominguez, Boundary Elements (1989), chapter 3; Addi, Adly, Goeleven, Thera (2006), (13).
 */
#include <Eigen/Core>

#include "frictional_contact_sim/rolling/contour.h"
#include "frictional_contact_sim/rolling/plane_strain_material.h"

namespace frictional_contact_sim
{
struct BoundaryMatrices
{
  Eigen::MatrixXd H;  ///< 2n x 2n [-]
  Eigen::MatrixXd G;  ///< 2n x 2n [m/Pa]
};

/** @brief Integrals of the kernels over one flat element, in the x, y frame. */
struct KernelIntegrals
{
  Eigen::Matrix2d displacement;  ///< int U ds [m/Pa]
  Eigen::Matrix2d traction;  ///< int T ds, principal value [-]
};

/**
 * @param point collocation point
 * @param on_element the point lies on the element: the angle term is that of the principal value, zero
 */
KernelIntegrals integrateKernels(const Eigen::Vector2d& point, const Eigen::Vector2d& begin, const Eigen::Vector2d& end,
                                 bool on_element, const PlaneStrainMaterial& material, double length_unit);

/** @param length_unit [m]; 0 = eight times the largest extent of the contour */
BoundaryMatrices assembleBoundaryMatrices(const Contour& contour, const PlaneStrainMaterial& material,
                                          double length_unit = 0.0);

struct BoundarySolution
{
  Eigen::VectorXd u;  ///< 2n [m]
  Eigen::VectorXd t;  ///< 2n [Pa]
};

/**
 * @brief Mixed problem: of each component either u or t is given (14).
 * @param displacement_given 2n flags
 * @param given 2n, the given u [m] or t [Pa]
 * @throws std::invalid_argument on wrong shapes
 */
BoundarySolution solveBoundaryProblem(const BoundaryMatrices& matrices, const std::vector<bool>& displacement_given,
                                      const Eigen::VectorXd& given);

}  // namespace frictional_contact_sim
