#include "frictional_contact_sim/rolling/creep_curve.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
namespace
{
/// |Q|/(mu P) that counts as full slip: the last stick node carries less than this.
constexpr double FULL_SLIP = 1.0 - 1e-9;

class CurveTracer
{
public:
  CurveTracer(const ContactFlexibility& flexibility, double friction, double load, const Eigen::VectorXd& gap,
              double approach, const std::function<bool()>& interrupted)
    : flexibility_(flexibility), friction_(friction), gap_(gap), approach_(approach)
  {
    options_.load = load;
    options_.interrupted = interrupted;
  }
  /// -Q/(mu P): positive for xi > 0, where the upper surface is braked.
  double share(double creepage);
  double worstResidual() const { return worst_residual_; }

private:
  const ContactFlexibility& flexibility_;
  double friction_;
  const Eigen::VectorXd& gap_;
  double approach_;
  RollingOptions options_;
  double worst_residual_ = 0.0;
};

double CurveTracer::share(double creepage)
{
  const RollingResult result = rollSteadily(flexibility_, friction_, gap_, approach_, creepage, options_);
  if (!result.steady)
    throw std::runtime_error("creep curve: the problem at creepage " + std::to_string(creepage) + " was not solved");
  approach_ = result.approach;
  worst_residual_ = std::max(worst_residual_, result.contact.residual);
  return -result.contact.Q / (friction_ * result.contact.P);
}

/// Creepage in [low, high] where `above` turns true, by halving.
template <typename Predicate>
double bisect(double low, double high, int halvings, Predicate above)
{
  for (int i = 0; i < halvings; ++i)
  {
    const double middle = 0.5 * (low + high);
    (above(middle) ? high : low) = middle;
  }
  return high;
}
std::string toText(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}
}  // namespace

CreepCurve computeCreepCurve(const ContactFlexibility& flexibility, double friction, double load,
                             const Eigen::VectorXd& gap, double approach, double creepage_unit,
                             const CreepCurveOptions& options)
{
  if (options.points < 3 || !(friction > 0.0) || !(load > 0.0) || !(creepage_unit > 0.0))
    throw std::invalid_argument("creep curve: found " + std::to_string(options.points) + " points, friction " +
                                std::to_string(friction) + ", load " + std::to_string(load) +
                                ", expected at least 3 points, friction > 0, load > 0");
  constexpr int HALVINGS = 30, WIDENINGS = 20;
  CurveTracer tracer(flexibility, friction, load, gap, approach, options.interrupted);
  CreepCurve curve;
  curve.friction = friction;
  curve.load = load;
  // Where the pair rolls freely. Without coupling Q(0) = 0 to round-off and nothing is searched.
  const double at_rest = tracer.share(0.0);
  if (std::abs(at_rest) > 1e-9)
  {
    double reach = at_rest > 0.0 ? -creepage_unit : creepage_unit;
    for (int i = 0; i < WIDENINGS && (tracer.share(reach) > 0.0) == (at_rest > 0.0); ++i)
      reach *= 1.5;
    if ((tracer.share(reach) > 0.0) == (at_rest > 0.0))
      throw std::runtime_error("creep curve: no free rolling up to a creepage of " + toText(reach) +
                               ", expected a sign change of Q");
    curve.free_creepage =
        bisect(std::min(0.0, reach), std::max(0.0, reach), HALVINGS, [&](double xi) { return tracer.share(xi) > 0.0; });
  }
  double saturation = creepage_unit;
  for (int i = 0; i < WIDENINGS && tracer.share(curve.free_creepage + saturation) < FULL_SLIP; ++i)
    saturation *= 1.5;
  if (tracer.share(curve.free_creepage + saturation) < FULL_SLIP)
    throw std::runtime_error("creep curve: no full slip up to a creepage of " + toText(saturation) +
                             ", expected it within Carter's saturation times " + toText(std::pow(1.5, WIDENINGS)));
  saturation =
      bisect(0.0, saturation, HALVINGS, [&](double xi) { return tracer.share(curve.free_creepage + xi) >= FULL_SLIP; });
  for (int i = 0; i < options.points; ++i)
  {
    const double share = static_cast<double>(i) / (options.points - 1);
    const double xi = saturation * share;
    const double traction = i == 0 ? 0.0 : std::min(1.0, tracer.share(curve.free_creepage + xi));
    if (i > 0 && traction < curve.traction.back() - 1e-6)
      throw std::runtime_error("creep curve: traction falls at creepage " + std::to_string(xi));
    curve.creepage.push_back(xi);
    curve.traction.push_back(i + 1 == options.points ? 1.0 : i == 0 ? 0.0 : std::max(traction, curve.traction.back()));
    if (i > 0 && curve.free_creepage != 0.0)
      curve.other_direction =
          std::max(curve.other_direction, std::abs(traction + tracer.share(curve.free_creepage - xi)));
    if (options.progress)
      options.progress(share);
  }
  curve.worst_residual = tracer.worstResidual();
  return curve;
}

void writeCreepCurve(std::ostream& out, const CreepCurve& curve, const PlaneStrainMaterial& upper, double radius)
{
  const auto list = [&](const std::vector<double>& values)
  {
    out << '[';
    for (size_t i = 0; i < values.size(); ++i)
      out << (i > 0 ? ", " : "") << values[i];
    out << "]\n";
  };
  out.precision(10);
  out << "creep_curve:\n  friction: " << curve.friction << "\n  reference_load: " << curve.load
      << "  # N per metre of width\n  young_modulus: " << upper.young_modulus
      << "\n  poisson_ratio: " << upper.poisson_ratio << "\n  radius: " << radius << "\n  creepage: ";
  list(curve.creepage);
  out << "  traction: ";
  list(curve.traction);
}

}  // namespace frictional_contact_sim
