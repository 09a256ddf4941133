/**
 * @file load_path_test.cpp
 * @brief Tangential loads that come, go and turn round: Mindlin and Deresiewicz (1953) for line contact, equal bodies.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/load_path.h"

using namespace frictional_contact_sim;

namespace
{
constexpr double MU = 0.3, RADIUS = 1.0, LOAD = 100.0, DATUM = 2.0, PI = 3.14159265358979323846;
const PlaneStrainMaterial RUBBER{94500.0, 0.1};
const MaterialPair EQUAL{RUBBER, RUBBER, false};

/// n strips over 1.25 times Hertz' contact; loads Q/(mu P) at constant P.
struct Bodies
{
  explicit Bodies(int n) : hertz(hertzLine(LOAD, RADIUS, EQUAL.reducedModulus()))
  {
    Eigen::VectorXd x, w;
    makeUniformNodes(1.25 * hertz.half_width, n, x, w);
    F = halfPlaneFlexibility(EQUAL, x, w, DATUM);
  }
  std::vector<LoadStep> follow(const std::vector<double>& shares) const
  {
    std::vector<LoadTarget> targets(shares.size());
    for (size_t k = 0; k < shares.size(); ++k)
    {
      targets[k].P = LOAD;
      targets[k].Q = shares[k] * MU * LOAD;
    }
    const std::vector<LoadStep> steps =
        followLoads(FrictionalLcp(F, Eigen::VectorXd::Constant(1, MU)), F.x.array().square() / (2.0 * RADIUS), targets,
                    hertz.half_width * hertz.half_width);
    EXPECT_EQ(steps.size(), shares.size());
    EXPECT_TRUE(steps.back().answer.converged);
    return steps;
  }
  /// L1 distance of the traction from the closed form, over mu P.
  double error(const LoadStep& step, const std::vector<double>& shares) const
  {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < F.size(); ++i)
      sum += F.width[i] * std::abs(step.answer.contact.r_T[i] - mindlinTraction(hertz, MU, shares, F.x[i]));
    return sum / (MU * LOAD);
  }
  HertzLine hertz;
  ContactFlexibility F;
};

/// -shift over mu P 2/(pi E*) of a first loading to the share s: the stick strip c = a sqrt(1 - s) moves by ln(2 D/c).
double backbone(const HertzLine& hertz, double s)
{
  const double rest = 1.0 - s;
  return s * std::log(2.0 * DATUM / hertz.half_width) + 0.5 * ((rest > 0.0 ? rest * std::log(rest) : 0.0) + s);
}

/// Its integral from 0 to s without the linear part, which loses nothing.
double backboneArea(double s)
{
  const double u = 1.0 - s;
  return 0.5 * (0.25 - (0.5 * u * u * std::log(u) - 0.75 * u * u + u));
}

const double UNIT = MU * LOAD * 2.0 / (PI * EQUAL.reducedModulus());  ///< of the backbone [m]
}  // namespace

TEST(LoadPathTest, TractionOfUnloadingIsMindlinAndDeresiewiczs)
{
  const std::vector<double> path = {0.8, 0.3, -0.2, -0.8, 0.1};
  double first = 0.0;
  std::vector<double> last;
  for (const int n : {25, 50, 100, 200})
  {
    const Bodies bodies(n);
    const std::vector<LoadStep> steps = bodies.follow(path);
    last.clear();
    for (size_t k = 0; k < path.size(); ++k)
      last.push_back(bodies.error(steps[k], {path.begin(), path.begin() + k + 1}));
    if (n == 25)
      first = *std::max_element(last.begin(), last.end());
  }
  for (const double error : last)
  {
    EXPECT_LT(error, 0.15 * first);  // eightfold refinement: order 1 gives 0.125
    EXPECT_LT(error, 5e-3);
  }
}

TEST(LoadPathTest, ShiftFollowsTheBackboneAndMasingsRule)
{
  // Loading to s: backbone(s); unloading from s to t: backbone(s) - 2 backbone((s - t)/2).
  std::vector<double> errors;
  for (const int n : {50, 100, 200})
  {
    const Bodies bodies(n);
    const std::vector<double> path = {0.4, 0.9, 0.2, -0.9};
    const std::vector<LoadStep> steps = bodies.follow(path);
    double worst = 0.0;
    for (size_t k = 0; k < path.size(); ++k)
    {
      const double exact = path[k] >= path[0]
                               ? backbone(bodies.hertz, path[k])
                               : backbone(bodies.hertz, 0.9) - 2.0 * backbone(bodies.hertz, 0.5 * (0.9 - path[k]));
      worst = std::max(worst, std::abs(-steps[k].answer.shift / UNIT - exact));
    }
    errors.push_back(worst);
  }
  EXPECT_LT(errors[2], 0.35 * errors[0]);
}

TEST(LoadPathTest, AClosedLoopLosesTheAreaOfMasingsLoop)
{
  for (const double amplitude : {0.3, 0.6, 0.9})
  {
    std::vector<double> errors;
    const double exact = UNIT * MU * LOAD *
                         (4.0 * amplitude * (0.5 * ((1.0 - amplitude) * std::log(1.0 - amplitude) + amplitude)) -
                          8.0 * backboneArea(amplitude));
    for (const int n : {50, 100, 200})
    {
      const Bodies bodies(n);
      const std::vector<LoadStep> steps = bodies.follow({amplitude, -amplitude, amplitude});
      errors.push_back(std::abs((steps[1].dissipated + steps[2].dissipated) / exact - 1.0));
      EXPECT_NEAR(steps[1].dissipated, steps[2].dissipated, 1e-9 * exact);
      EXPECT_LT((steps[2].answer.contact.r_T - steps[0].answer.contact.r_T).lpNorm<Eigen::Infinity>(),
                1e-9 * MU * bodies.hertz.peak_pressure)
          << "the loop closes";
    }
    EXPECT_LT(errors[2], 0.02);
  }
}

TEST(LoadPathTest, StepsInBetweenChangeNothing)
{
  // The slip zones only grow on the way: one step or twenty.
  const Bodies bodies(60);
  const std::vector<LoadStep> one = bodies.follow({0.7, -0.5});
  std::vector<double> path;
  for (int k = 1; k <= 7; ++k)
    path.push_back(0.1 * k);
  for (int k = 1; k <= 12; ++k)
    path.push_back(0.7 - 0.1 * k);
  const std::vector<LoadStep> many = bodies.follow(path);
  EXPECT_LT((one.back().answer.contact.r_T - many.back().answer.contact.r_T).lpNorm<Eigen::Infinity>(),
            1e-9 * MU * bodies.hertz.peak_pressure);
  EXPECT_NEAR(one.back().answer.shift, many.back().answer.shift, 1e-9 * UNIT);
  double dissipated = 0.0;
  for (const LoadStep& step : many)
  {
    EXPECT_GE(step.dissipated, -1e-12 * UNIT * MU * LOAD);
    dissipated += step.dissipated;
  }
  EXPECT_NEAR(dissipated, one[0].dissipated + one[1].dissipated, 1e-9 * UNIT * MU * LOAD);
}

TEST(LoadPathTest, RandomPathsForgetTheLoopsThatClose)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(-0.9, 0.9);
  const Bodies bodies(100);
  for (int run = 0; run < 5; ++run)
  {
    std::vector<double> path;
    for (int k = 0; k < 6; ++k)
      path.push_back(share(random));
    const std::vector<LoadStep> steps = bodies.follow(path);
    for (size_t k = 0; k < path.size(); ++k)
      EXPECT_LT(bodies.error(steps[k], {path.begin(), path.begin() + k + 1}), 0.01) << run << ' ' << k;
  }
}

TEST(LoadPathTest, WorkOfBothLoadsIsElasticEnergyAndDissipation)
{
  // P and Q change together, unequal materials: sum of load times displacement by the trapezoid rule on ever finer
  // paths, whose error is of order two, plus what the implicit slip of a step is off, of order one.
  const MaterialPair pair{RUBBER, {}, true};
  double error[2];
  for (int k = 0; k < 2; ++k)
  {
    const HertzLine hertz = hertzLine(LOAD, RADIUS, pair.reducedModulus());
    Eigen::VectorXd x, w;
    makeUniformNodes(1.4 * hertz.half_width, 60, x, w);
    const FrictionalLcp lcp(halfPlaneFlexibility(pair, x, w, DATUM), Eigen::VectorXd::Constant(1, MU));
    std::vector<LoadTarget> targets;
    const int count = 40 << k;
    for (int i = 1; i <= count; ++i)
    {
      const double t = static_cast<double>(i) / count;
      LoadTarget target;
      target.P = LOAD * (0.2 + 0.8 * std::sin(0.75 * PI * t));
      target.Q = 0.6 * MU * target.P * std::sin(2.0 * PI * t);
      targets.push_back(target);
    }
    const std::vector<LoadStep> steps = followLoads(lcp, x.array().square() / (2.0 * RADIUS), targets, 1e-4);
    ASSERT_EQ(steps.size(), targets.size());
    const auto energy = [&](const LoadStep& step)
    {
      const FrictionalContact& c = step.answer.contact;
      return 0.5 * (w.array() * (c.r_N.array() * c.u_N.array() + c.r_T.array() * c.u_T.array())).sum();
    };
    double work = 0.0, dissipated = 0.0;
    for (size_t i = 1; i < steps.size(); ++i)
    {
      const LoadedContact& a = steps[i - 1].answer;
      const LoadedContact& b = steps[i].answer;
      work += 0.5 * (a.contact.P + b.contact.P) * (b.approach - a.approach) -
              0.5 * (a.contact.Q + b.contact.Q) * (b.shift - a.shift);
      dissipated += steps[i].dissipated;
      EXPECT_GE(steps[i].dissipated, -1e-12);
    }
    error[k] = (work - dissipated - energy(steps.back()) + energy(steps.front())) / dissipated;
  }
  EXPECT_LT(std::abs(error[1]), 0.6 * std::abs(error[0]));
}

TEST(LoadPathTest, MisuseIsNamed)
{
  const Bodies bodies(20);
  const FrictionalLcp lcp(bodies.F, Eigen::VectorXd::Constant(1, MU));
  LoadTarget slips;
  slips.P = LOAD;
  slips.Q = MU * LOAD;
  EXPECT_THROW(followLoads(lcp, bodies.F.x.array().square() / 2.0, {slips}, 1e-3), std::invalid_argument);
}
