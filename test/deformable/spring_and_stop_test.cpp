// Cadoux (2009), section 0.1.3: a mass on a spring above a stop, exactly, by penalty and by the augmented Lagrangian. A
// bar of one cell is that spring: stiffness E A/L, half its weight on the free end, a third of its inertia.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "static_scene.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double GRAVITY = 9.81;
constexpr double MASS = 2.0;
constexpr double STIFFNESS = 50.0;  ///< k [N/m]
constexpr double HEIGHT = 0.1;  ///< h of the stop below the unstretched end; m g/k = 0.39 m
constexpr double FORCE = MASS * GRAVITY - STIFFNESS * HEIGHT;  ///< lambda, exactly

struct Answer
{
  double sink = 0.0;  ///< u of the mass [m]
  double force = 0.0;  ///< of the stop [N]
};

/** The bar hangs along -z from its left end, its free end HEIGHT above the ground. @param penalty stiffness of a spring
 *  that ties the mass to the stop, in place of the ground when positive. @param multiplier force of the stop beside it
 */
Scenario hanging(double penalty, double multiplier)
{
  const std::string stop = penalty > 0.0 ? "" : "ground: {}\n";
  return loadScenario("gravity: [0, 0, -9.81]\n" + stop +
                          "bodies:\n  - name: spring\n    elastic: {bar: 1.0, cells: 1, area: 1.0, young_modulus: " +
                          number(STIFFNESS + penalty) + ", density: " + number(2.0 * MASS) +
                          ", fixed: [left]}\n    pose: {xyz: [0, 0, " + number(0.5 + HEIGHT) +
                          "], rpy: [0, 1.5707963267948966, 0]}\n    wrenches: [{link: spring, point: [0.5, 0, 0], "
                          "force: [" +
                          number(penalty * HEIGHT - multiplier) + ", 0, 0], frame: link}]\n",
                      "spring");
}

Answer equilibrium(double penalty, double multiplier)
{
  Scenario scenario = hanging(penalty, multiplier);
  scenario.regime = Regime::STATIC;
  Simulator simulator(scenario);
  EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  Answer answer;
  answer.sink = simulator.position(0)[0];
  for (const ContactState& contact : simulator.contacts())
    answer.force += contact.impulse.z() / scenario.time_step;
  return answer;
}

TEST(SpringAndStopTest, MultiplierIsExact)
{
  // (1a), (1b): u = h, lambda = m g - k h.
  const Answer exact = equilibrium(0.0, 0.0);
  EXPECT_NEAR(exact.sink, HEIGHT, 1e-12);
  EXPECT_NEAR(exact.force, FORCE, 1e-8 * FORCE);
}

TEST(SpringAndStopTest, PenaltySinksInByTheForceOverBothStiffnesses)
{
  // u - h = (m g - k h)/(k + mu): order one in 1/mu. The thesis prints < 0 for it, which would be above the stop.
  double last = 0.0;
  for (const double penalty : {1e2, 1e3, 1e4, 1e5, 1e6})
  {
    const double depth = equilibrium(penalty, 0.0).sink - HEIGHT;
    EXPECT_NEAR(depth, FORCE / (STIFFNESS + penalty), 1e-10);
    EXPECT_GT(depth, 0.0);
    if (penalty > 1e3)
    {
      EXPECT_NEAR(std::log10(last / depth), 1.0, 0.03);
    }
    last = depth;
  }
}

TEST(SpringAndStopTest, AugmentedLagrangianConvergesAtTheRatioOfTheStiffnesses)
{
  // lambda += mu c(u) (Uzawa): each round divides the error by 1 + mu/k, at any finite mu.
  for (const double penalty : {25.0, 100.0, 1000.0})
  {
    double multiplier = 0.0;
    double error = FORCE;
    for (int round = 0; round < 60 && error > 1e-6 * FORCE; ++round)
    {
      const double depth = equilibrium(penalty, multiplier).sink - HEIGHT;
      multiplier = std::max(0.0, multiplier + penalty * depth);
      const double next = std::abs(multiplier - FORCE);
      EXPECT_NEAR(next / error, STIFFNESS / (STIFFNESS + penalty), 1e-3);
      error = next;
    }
    EXPECT_LT(error, 1e-6 * FORCE);
  }
}

TEST(SpringAndStopTest, PenaltyShakesTheMassWhereTheStopHoldsItStill)
{
  // Let go on the stop: the exact one holds it from the first step on, the penalty spring swings about its
  // equilibrium with the frequency of k + mu, twice as deep, whatever mu: "modes de vibration rapides et artificiels".
  for (const double penalty : {0.0, 1e3, 1e5})
  {
    Scenario scenario = hanging(penalty, 0.0);
    const double period = 2.0 * std::acos(-1.0) * std::sqrt(2.0 / 3.0 * MASS / (STIFFNESS + penalty));
    scenario.time_step = period / 100.0;
    Simulator simulator(scenario);
    simulator.position(0)[0] = HEIGHT;
    simulator.stateChanged();
    double deepest = 0.0;
    double fastest = 0.0;
    for (int step = 0; step < 200; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      deepest = std::max(deepest, simulator.position(0)[0] - HEIGHT);
      fastest = std::max(fastest, std::abs(simulator.velocity(0)[0]));
    }
    const double still = penalty > 0.0 ? FORCE / (STIFFNESS + penalty) : 0.0;
    EXPECT_NEAR(deepest, 2.0 * still, 1e-2 * still + 1e-12);
    EXPECT_NEAR(fastest, still * 2.0 * std::acos(-1.0) / period, 1e-2 * fastest + 1e-10);
  }
}

}  // namespace
}  // namespace frictional_contact_sim
