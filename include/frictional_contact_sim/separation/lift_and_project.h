#pragma once
/**
 * @file lift_and_project.h
 * @brief Lift-and-project for a 0-1 variable: the lifted polyhedron (7.18) whose projection is conv(P_0 and P_1) (lemma
 * 7.19), and the cut generating program (7.21), (7.22).
 *
 *   P = {x; A x <= b}, 0 <= x <= 1 among its rows, P_0 = P with x_j = 0, P_1 = P with x_j = 1
 *   M_j = {(x, y), y_i = x_i x_j, i != j;  A_j y + (a_j - b) x_j <= 0,  A x - A_j y - (a_j - b) x_j <= b}
 *   C = {(d, e); u_0, u_1 >= 0, d = A^T u_0 + ((a_j - b).(u_1 - u_0)) e_j, e = b.u_0, A_j^T u_0 = A_j^T u_1}
 *
 * (d, e) in C is d.x <= e for all x of the projection. The program: max d.x - e at the point x, sum u_0 + sum u_1 <= 1.
 * This is the method the thesis compares with; for general integers and other disjunctions see polar_oracle.h.
 *
 * Source: Balas, Ceria, Cornuejols (1993); Cadoux (2009), section 7.2.5.
 */
#include "frictional_contact_sim/separation/polyhedron.h"

namespace frictional_contact_sim
{
/** @brief (7.18): columns x (n), then y (n - 1, without y_j). @throws std::invalid_argument unless 0 <= j < n */
Polyhedron liftedPolyhedron(const Polyhedron& polyhedron, int variable);

struct LiftAndProjectCut
{
  bool found = false;  ///< false: the point is in the projection
  Eigen::VectorXd direction;  ///< d
  double right_hand_side = 0.0;  ///< e
  double violation = 0.0;  ///< d.x - e at the point
};

/**
 * @brief (7.22) at a point.
 * @throws std::invalid_argument unless 0 <= variable < n and the point has n numbers
 */
LiftAndProjectCut liftAndProjectCut(const Polyhedron& polyhedron, int variable, const Eigen::VectorXd& point);

}  // namespace frictional_contact_sim
