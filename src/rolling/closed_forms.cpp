#include "frictional_contact_sim/rolling/closed_forms.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;

/// sqrt(1 - (x/a)^2) inside, 0 outside.
double ellipse(double x, double a)
{
  return a > 0.0 && std::abs(x) < a ? std::sqrt(1.0 - x * x / (a * a)) : 0.0;
}
}  // namespace

double HertzLine::pressure(double x) const
{
  return peak_pressure * ellipse(x, half_width);
}

HertzLine hertzLine(double load, double radius, double reduced_modulus)
{
  HertzLine hertz;
  hertz.half_width = std::sqrt(4.0 * std::max(load, 0.0) * radius / (PI * reduced_modulus));
  hertz.peak_pressure = hertz.half_width > 0.0 ? 2.0 * load / (PI * hertz.half_width) : 0.0;
  return hertz;
}

double cattaneoStickHalfWidth(const HertzLine& hertz, double load_share)
{
  return hertz.half_width * std::sqrt(std::max(0.0, 1.0 - load_share));
}

double cattaneoTraction(const HertzLine& hertz, double friction, double load_share, double x)
{
  const double c = cattaneoStickHalfWidth(hertz, load_share);
  return friction * hertz.peak_pressure * (ellipse(x, hertz.half_width) - c / hertz.half_width * ellipse(x, c));
}

double mindlinTraction(const HertzLine& hertz, double friction, const std::vector<double>& load_shares, double x)
{
  // Where the load has turned round and how far it has come; a branch that goes beyond the start of the one before
  // closes a loop, which is forgotten.
  std::vector<double> turns;
  for (const double share : load_shares)
  {
    const bool goes_on =
        !turns.empty() &&
        (share - turns.back()) * (turns.size() > 1 ? turns.back() - turns[turns.size() - 2] : turns.back()) >= 0.0;
    if (goes_on)
      turns.pop_back();
    turns.push_back(share);
    for (size_t n = turns.size(); n > 1; n = turns.size())
    {
      const double before = n > 2 ? std::abs(turns[n - 2] - turns[n - 3]) : 2.0 * std::abs(turns[0]);
      if (std::abs(share - turns[n - 2]) < before)
        break;
      turns.erase(turns.end() - (n > 2 ? 3 : 2), turns.end() - 1);
    }
  }
  double traction = 0.0;
  for (size_t k = 0; k < turns.size(); ++k)
  {
    const double change = k == 0 ? turns[0] : 0.5 * (turns[k] - turns[k - 1]);
    traction += (k == 0 ? 1.0 : 2.0) * std::copysign(cattaneoTraction(hertz, friction, std::abs(change), x), change);
  }
  return traction;
}

double carterSaturation(const HertzLine& hertz, double radius, double friction)
{
  return friction * hertz.half_width / radius;
}

double carterLoadShare(const HertzLine& hertz, double radius, double friction, double creepage)
{
  const double stick = std::max(0.0, 1.0 - creepage / carterSaturation(hertz, radius, friction));
  return 1.0 - stick * stick;
}

double carterTraction(const HertzLine& hertz, double radius, double friction, double creepage, double x)
{
  const double a = hertz.half_width;
  const double c = a * std::max(0.0, 1.0 - creepage / carterSaturation(hertz, radius, friction));
  return friction * hertz.peak_pressure * (ellipse(x, a) - c / a * ellipse(x - a + c, c));
}

}  // namespace frictional_contact_sim
