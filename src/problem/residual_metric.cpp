#include "frictional_contact_sim/problem/residual_metric.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
constexpr double QUIET_SHARE = 1e-6;  ///< of a bare problem's |q|: what an island at rest is measured with

/** Largest |q| of a law's rows, of a one-sided row only its negative part; q points to its rows. */
double countedVelocity(const Law& law, const double* q)
{
  double largest = law.isOneSided() ? std::max(0.0, -q[0]) : std::abs(q[0]);
  for (int k = 1; k < law.dimension(); ++k)
    largest = std::max(largest, std::abs(q[k]));
  return largest;
}
}  // namespace

void ResidualMetric::setScales(const std::vector<Law>& laws, const std::vector<LawScale>& given,
                               const Eigen::VectorXd& q, const Islands& islands)
{
  const auto count = static_cast<Eigen::Index>(laws.size());
  scales.resize(count);
  round_off.resize(count);
  largest_.assign(static_cast<size_t>(std::max(islands.count(), 1)), Largest{});
  static const LawScale BARE;
  double whole = 0.0;
  int row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const LawScale& scale = given.empty() ? BARE : given[i];
    Largest& island = largest_[static_cast<size_t>(islands.islandOf(static_cast<int>(i)))];
    const double velocity = countedVelocity(laws[i], q.data() + row);
    double& largest = island.q[static_cast<size_t>(scale.unit)];
    largest = std::max(largest, velocity);
    island.speed_change = std::max(island.speed_change, scale.speed_change);
    whole = std::max(whole, velocity);
    row += laws[i].dimension();
  }
  const double quiet = given.empty() ? QUIET_SHARE * whole : 0.0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const auto index = static_cast<Eigen::Index>(i);
    const LawScale& scale = given.empty() ? BARE : given[i];
    const Largest& island = largest_[static_cast<size_t>(islands.islandOf(static_cast<int>(i)))];
    scales[index] = std::max(island.q[static_cast<size_t>(scale.unit)],
                             std::max({island.speed_change, quiet, VELOCITY_FLOOR}) / scale.reach);
    round_off[index] = ROUND_OFF * std::numeric_limits<double>::epsilon() * scale.speed / scale.reach;
  }
}

}  // namespace frictional_contact_sim
