#pragma once
/**
 * @file creep_curve.h
 * @brief The longitudinal creepage-force curve of a pair, from steady rolling at constant load, and its file.
 *
 * xi = |slip speed|/rolling speed [-] against |Q|/(mu P) [-]: from (0, 0) to the first creepage at which everything
 * slips, (xi_s, 1). Carter's curve for equal materials. Unequal materials roll freely (Q = 0) at a creepage of their
 * own, since pressure stretches one surface more than the other; xi counts from there, and braking and driving differ.
 * The curve is that of Q on the upper body pointing left (xi > 0); `other_direction` holds the largest difference of
 * |Q|/(mu P) to the other one.
 *
 *   creep_curve:
 *     friction, reference_load [N/m], young_modulus [Pa], poisson_ratio, radius [m]
 *     creepage: [0, ...]
 *     traction: [0, ..., 1]
 *
 * Between reference_load P0 and another load P the abscissa scales with the contact width: a ~ sqrt(P).
 */
#include <functional>
#include <iosfwd>
#include <vector>

#include "frictional_contact_sim/rolling/rolling_motion.h"

namespace frictional_contact_sim
{
struct CreepCurve
{
  double friction = 0.0;  ///< mu [-]
  double load = 0.0;  ///< P [N/m]
  double free_creepage = 0.0;  ///< at Q = 0 [-]
  double other_direction = 0.0;  ///< [-]
  std::vector<double> creepage;  ///< xi, ascending, from 0 [-]
  std::vector<double> traction;  ///< |Q|/(mu P), non-decreasing, from 0 to 1 [-]
  double worst_residual = 0.0;  ///< of the LCPs solved [-]
};

struct CreepCurveOptions
{
  int points = 21;  ///< of the curve, >= 3
  std::function<void(double share)> progress;
  std::function<bool()> interrupted;
};

/**
 * @param gap n, before deformation [m]
 * @param approach guess of the rigid approach [m]
 * @param creepage_unit about mu a/R, where everything slips [-]
 * @throws std::invalid_argument on bad options, std::runtime_error when an LCP is not solved or the curve is not
 * monotone
 */
CreepCurve computeCreepCurve(const ContactFlexibility& flexibility, double friction, double load,
                             const Eigen::VectorXd& gap, double approach, double creepage_unit,
                             const CreepCurveOptions& options = {});

void writeCreepCurve(std::ostream& out, const CreepCurve& curve, const PlaneStrainMaterial& upper, double radius);

}  // namespace frictional_contact_sim
