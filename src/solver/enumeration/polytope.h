#pragma once
/**
 * @file polytope.h
 * @brief Vertices and rays of {x: C x >= d} by the double description method.
 *
 * The cone {(x, t): C x - d t >= 0, t >= 0} is intersected half space by half space; its extreme rays with t > 0 are
 * vertices x/t, the others rays. Two rays span a face when no third one lies on all half spaces that both lie on.
 * Degenerate polytopes, and such without interior, need no special care.
 *
 * Source: Motzkin, Raiffa, Thompson, Thrall (1953); Fukuda, Prodon (1996).
 */
#include <Eigen/Core>
#include <vector>

namespace frictional_contact_sim
{
struct Polytope
{
  bool complete = true;  ///< false: too many rays on the way; nothing is listed then
  std::vector<Eigen::VectorXd> vertices, rays;
};

/**
 * @param C m x k of full column rank (the polyhedron contains no line), rows of about unit size
 * @param max_rays given up when there are more on the way
 */
Polytope enumerateVertices(const Eigen::MatrixXd& C, const Eigen::VectorXd& d, size_t max_rays);

/** @brief Dimension of the affine hull of points and rays. @param tolerance on lengths, relative to the points' */
int affineDimension(const std::vector<Eigen::VectorXd>& points, const std::vector<Eigen::VectorXd>& rays,
                    double tolerance);

}  // namespace frictional_contact_sim
