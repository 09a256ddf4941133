#pragma once
/**
 * @file closed_forms.h
 * @brief Line contact of two elastic cylinders in closed form (Dundurs' beta = 0).
 *
 *   Hertz             a^2 = 4 P R/(pi E*),  p0 = 2 P/(pi a),  p(x) = p0 sqrt(1 - x^2/a^2)
 *   Cattaneo-Mindlin  c/a = sqrt(1 - |Q|/(mu P)),  q(x) = mu p0 [ sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2) ]
 *   Carter            |Q|/(mu P) = 1 - (1 - xi R/(mu a))^2,  c = a - xi R/mu,  the stick strip [a - 2c, a] at the
 * leading edge x = a,  q(x) = mu p0 [ sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - (x - a + c)^2/c^2) ] R: 1/R = 1/R1 + 1/R2 [m];
 * P, Q: loads per width [N/m]; xi: creepage [-]. Source: Johnson, Contact Mechanics
 * (1985), 4.42, 4.45, 7.23-7.28, 8.39-8.47; Mindlin and Deresiewicz (1953) for loads that turn round.
 */
#include <vector>

namespace frictional_contact_sim
{
struct HertzLine
{
  double half_width = 0.0;  ///< a [m]
  double peak_pressure = 0.0;  ///< p0 [Pa]
  double pressure(double x) const;
};

HertzLine hertzLine(double load, double radius, double reduced_modulus);

/** @brief c [m]. */
double cattaneoStickHalfWidth(const HertzLine& hertz, double load_share);
double cattaneoTraction(const HertzLine& hertz, double friction, double load_share, double x);

/** @brief |Q|/(mu P) at a creepage xi >= 0, 1 once everything slips. */
double carterLoadShare(const HertzLine& hertz, double radius, double friction, double creepage);
/**
 * @brief Q coming and going at constant P: a branch from one turning point to the next adds twice Cattaneo's traction
 * of half the change, and a loop that closes is forgotten (Masing's rules).
 * @param load_shares Q/(mu P) in order, each in (-1, 1), from Q = 0 @return q(x) [Pa]
 */
double mindlinTraction(const HertzLine& hertz, double friction, const std::vector<double>& load_shares, double x);

/** @brief xi R = mu a: from here on everything slips. */
double carterSaturation(const HertzLine& hertz, double radius, double friction);
/** @brief |q|(x), the leading edge at x = +a. */
double carterTraction(const HertzLine& hertz, double radius, double friction, double creepage, double x);

}  // namespace frictional_contact_sim
