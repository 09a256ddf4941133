#pragma once
/**
 * @file nearest_point.h
 * @brief The point of a closed convex set C that is nearest to the origin, from an oracle that minimises linear
 * functions over C, as a convex combination of what the oracle returned: algorithm 7.1 in the form of remark 7.2.
 *
 * Wolfe's method keeps a corral, affinely independent generators g_i whose positive combination x = sum a_i g_i is the
 * nearest point of their affine hull. The oracle is asked for the generator g with the least x.g; when that is no less
 * than |x|^2, x is the nearest point (lemma 6.14); else g joins, and generators whose weight would be negative leave.
 * |x| falls at every call (theorem 7.4); with finitely many extreme points the method ends.
 *
 * C may be unbounded, C = conv(points) + cone(rays) (7.2): a ray has no part in sum a_i = 1, and joins when x.g < 0.
 * Where the oracle returns what is in the corral already the method ends: that is what goes round for ever in figure
 * 7.3.
 *
 * Source: Wolfe (1976), "Finding the nearest point in a polytope"; Cadoux (2009), section 7.1.
 */
#include <Eigen/Core>
#include <functional>
#include <vector>

namespace frictional_contact_sim
{
/** @brief An extreme point of C, or the direction of an extreme ray. */
struct Generator
{
  Eigen::VectorXd value;
  bool is_ray = false;
};

/** @brief What an oracle found. */
enum class OracleStatus
{
  FOUND,
  EMPTY,  ///< C is empty
  FAILED  ///< no minimum could be computed
};

struct OracleAnswer
{
  OracleStatus status = OracleStatus::FAILED;
  Generator generator;
};

/** @brief The minimiser of direction.g over C, or a ray along which it falls for ever. */
using LinearOracle = std::function<OracleAnswer(const Eigen::VectorXd& direction)>;

enum class NearestPointStatus
{
  CONVERGED,  ///< gap <= tolerance; or no better within round-off, and gap below 1e-8 in the same units
  STALLED,  ///< the oracle finds nothing new, gap above that
  MAX_CALLS,
  FAILED  ///< the oracle failed, or C is empty
};

struct NearestPointOptions
{
  double tolerance = 1e-11;  ///< on |x|^2 - x.g over |x| (|x| + |g|), on -x.g over |x| |g| of a ray [-]
  int max_calls = 10000;  ///< of the oracle
};

struct NearestPoint
{
  NearestPointStatus status = NearestPointStatus::FAILED;
  Eigen::VectorXd point;  ///< x
  std::vector<Generator> generators;  ///< of x, rays among them
  Eigen::VectorXd weights;  ///< one a generator, > 0; those of points sum to one
  int calls = 0;  ///< of the oracle
  double gap = 0.0;  ///< last |x|^2 - x.g (-x.g of a ray); without rays |x - nearest|^2 <= gap
  std::vector<double> norms;  ///< |x| at the start and after each generator that joined
};

/**
 * @param oracle of C
 * @param first d_1, an extreme point of C, n
 */
NearestPoint nearestPoint(const LinearOracle& oracle, const Eigen::VectorXd& first,
                          const NearestPointOptions& options = {});

/** @brief The oracle of conv(points) + cone(rays), both as columns, points not none: looks at each. */
LinearOracle listOracle(const Eigen::MatrixXd& points, const Eigen::MatrixXd& rays);

}  // namespace frictional_contact_sim
