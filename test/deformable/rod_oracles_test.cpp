// Rods at rest and in small motion against equations of Kirchhoff's rod that are solved here: elastica, curved and
// twisted rods under their weight, frequencies of a hanging rod from beam to chain, a stiff rod's pendulum.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "frictional_contact_sim/deformable/elastic_spec.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::text;

constexpr double PI = 3.141592653589793;
constexpr double GRAVITY = 9.81;

/** 0.2 m long, 2 mm thick, as soft as makes rho A g L^3/(E I) = load. */
RodSpec rodOf(double load, int pieces, int sections)
{
  RodSpec spec;
  spec.length = 0.2;
  spec.radius = 0.001;
  spec.pieces = pieces;
  spec.sections = sections;
  spec.density = 1300.0;
  spec.young_modulus = {4.0 * spec.density * GRAVITY * std::pow(spec.length, 3) / (std::pow(spec.radius, 2) * load)};
  return spec;
}

double bendingStiffness(const RodSpec& spec)
{
  return spec.young_modulus[0] * 0.25 * PI * std::pow(spec.radius, 4);
}

double weightPerLength(const RodSpec& spec)
{
  return spec.density * PI * spec.radius * spec.radius * GRAVITY;
}

Simulator makeSimulator(const RodSpec& spec, const Eigen::Matrix3d& root, Regime regime, double time_step)
{
  Scenario scenario;
  scenario.regime = regime;
  scenario.time_step = time_step;
  BodySpec body;
  body.name = "rod";
  auto elastic = std::make_shared<ElasticSpec>();
  elastic->rod = spec;
  body.elastic = elastic;
  body.pose = Eigen::Isometry3d(root);
  scenario.bodies.push_back(body);
  return Simulator(scenario);
}

/** Kirchhoff's rod under its weight: x' = R e_1, R' = R [kappa]x, kappa = natural + B^-1 R^T m, m' = -R e_1 x n with
 * n = the weight beyond s, m(L) = 0; B = diag(2 G I, E I, E I). Source: Audoly and Pomeau (2010), chapter 3. */
class KirchhoffRod
{
public:
  KirchhoffRod(const RodSpec& spec, const Eigen::Matrix3d& root) : spec_(spec), root_(root)
  {
    const double bending = bendingStiffness(spec);
    stiffness_ = Eigen::Vector3d(bending / (1.0 + spec.poisson_ratio), bending, bending);
    if (!spec.natural.empty())
      natural_ = Eigen::Vector3d(spec.natural[0], spec.natural[1], spec.natural[2]);
    // The weight grows in steps; each is Newton's method for the moment at the root.
    for (int step = 1; step <= 20; ++step)
    {
      weight_ = weightPerLength(spec) * step / 20;
      for (int round = 0; round < 20; ++round)
      {
        const Eigen::Vector3d miss = integrate(moment_).moment;
        Eigen::Matrix3d slope;
        const double change = 1e-6 * weight_ * spec.length * spec.length;
        for (int k = 0; k < 3; ++k)
          slope.col(k) = (integrate(moment_ + change * Eigen::Vector3d::Unit(k)).moment - miss) / change;
        moment_ -= slope.fullPivLu().solve(miss);
        residual_ = integrate(moment_).moment.norm() / (weight_ * spec.length * spec.length);
        if (residual_ < 1e-12)
          break;
      }
    }
  }
  double residual() const { return residual_; }
  Eigen::Vector3d tip() const { return integrate(moment_).x; }

private:
  struct State
  {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    State plus(const State& rate, double h) const { return {x + h * rate.x, R + h * rate.R, moment + h * rate.moment}; }
  };
  State rate(const State& at, double s) const
  {
    const Eigen::Vector3d kappa = natural_ + stiffness_.cwiseInverse().cwiseProduct(at.R.transpose() * at.moment);
    State rate;
    rate.x = at.R.col(0);
    for (int k = 0; k < 3; ++k)
      rate.R.col(k) = at.R * kappa.cross(Eigen::Vector3d::Unit(k));
    rate.moment = -at.R.col(0).cross(-weight_ * (spec_.length - s) * Eigen::Vector3d::UnitZ());
    return rate;
  }
  State integrate(const Eigen::Vector3d& moment) const  // Runge and Kutta's of order 4
  {
    constexpr int STEPS = 400;
    const double h = spec_.length / STEPS;
    State at;
    at.R = root_;
    at.moment = moment;
    for (int k = 0; k < STEPS; ++k)
    {
      const State k1 = rate(at, k * h);
      const State k2 = rate(at.plus(k1, 0.5 * h), (k + 0.5) * h);
      const State k3 = rate(at.plus(k2, 0.5 * h), (k + 0.5) * h);
      const State k4 = rate(at.plus(k3, h), (k + 1.0) * h);
      at = at.plus(k1, h / 6.0).plus(k2, h / 3.0).plus(k3, h / 3.0).plus(k4, h / 6.0);
    }
    return at;
  }

  RodSpec spec_;
  Eigen::Matrix3d root_;
  Eigen::Vector3d stiffness_;
  Eigen::Vector3d natural_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_ = Eigen::Vector3d::Zero();
  double weight_ = 0.0;
  double residual_ = 1.0;
};

/** The tip at equilibrium, from the middle of the last section on along its tangent: quasi-static steps until nothing
 *  moves, which they come to for loads up to about 5. */
Eigen::Vector3d restingTip(const RodSpec& spec, const Eigen::Matrix3d& root)
{
  Simulator simulator = makeSimulator(spec, root, Regime::QUASI_STATIC, 1.0);
  double change = 1.0;
  for (int steps = 0; steps < 400 && change > 1e-9; ++steps)
  {
    const Eigen::VectorXd last = simulator.position(0);
    EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    change = (simulator.position(0) - last).lpNorm<Eigen::Infinity>() * spec.length;
  }
  EXPECT_LT(change, 1e-9) << "it has come to rest";
  const double half = 0.5 * spec.length / (spec.pieces * spec.sections);
  return simulator.data(0).link_pose.back() * Eigen::Vector3d(half, 0.0, 0.0);
}

/** Distances of the resting tip from the exact one over the length, with 4, 8 and 16 pieces: order two. */
void expectOrderTwo(double load, const std::vector<double>& natural, const Eigen::Matrix3d& root,
                    const Eigen::Vector3d& exact, double finest)
{
  std::vector<double> errors;
  for (const int pieces : {4, 8, 16})
  {
    RodSpec spec = rodOf(load, pieces, 16);
    spec.natural = natural;
    errors.push_back((restingTip(spec, root) - exact).norm() / spec.length);
  }
  for (size_t k = 1; k < errors.size(); ++k)
    EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 2.0, 0.2) << errors[k - 1] << " then " << errors[k];
  EXPECT_LT(errors.back(), finest);
}

TEST(ElasticaTest, CantileverUnderItsWeightIsTheElasticaAtOrderTwo)
{
  // E I theta'' = -rho A g (L - s) cos(theta): the tip sags by 0.12 and 0.43 of the length.
  for (const auto& [load, sag] : {std::make_pair(1.0, 0.1235), std::make_pair(4.0, 0.4252)})
  {
    const Eigen::Matrix3d root = Eigen::Matrix3d::Identity();
    const KirchhoffRod exact(rodOf(load, 1, 1), root);
    ASSERT_LT(exact.residual(), 1e-10);
    EXPECT_NEAR(-exact.tip().z() / 0.2, sag, 1e-4);
    expectOrderTwo(load, {}, root, exact.tip(), 2e-3);
  }
}

TEST(ElasticaTest, CurvedAndTwistedRodsHangAsKirchhoffsEquationsSay)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> some(-1.0, 1.0);
  for (int run = 0; run < 5; ++run)
  {
    const Eigen::Quaterniond turn(some(random), some(random), some(random), some(random));
    const Eigen::Matrix3d root = turn.normalized().toRotationMatrix();
    RodSpec spec = rodOf(3.0, 1, 1);
    spec.natural = {15.0 * some(random), 15.0 * some(random), 15.0 * some(random)};
    const KirchhoffRod exact(spec, root);
    ASSERT_LT(exact.residual(), 1e-10) << run;
    RodSpec light = spec;
    light.density *= 1e-6;
    EXPECT_GT((exact.tip() - KirchhoffRod(light, root).tip()).norm(), 0.05 * spec.length) << "the weight matters";
    expectOrderTwo(3.0, spec.natural, root, exact.tip(), 3e-3);
  }
}

/** First mode of a rod that hangs from its clamp, by Ritz's method with powers s^2 ... s^9:
 *  E I u^(4) - (w (L - s) u')' = omega^2 rho A u. */
struct HangingMode
{
  static constexpr int TERMS = 8;
  explicit HangingMode(const RodSpec& spec)
  {
    using Matrix = Eigen::Matrix<long double, TERMS, TERMS>;
    const long double bending = bendingStiffness(spec) / std::pow(spec.length, 3);
    const long double weight = weightPerLength(spec);
    Matrix K;
    Matrix M;
    for (int i = 2; i < TERMS + 2; ++i)
      for (int j = 2; j < TERMS + 2; ++j)
      {
        const long double n = i + j;
        K(i - 2, j - 2) = bending * i * (i - 1) * j * (j - 1) / (n - 3) + weight * i * j * (1 / (n - 1) - 1 / n);
        M(i - 2, j - 2) = weight / GRAVITY * spec.length / (n + 1);
      }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(K, M);
    omega = static_cast<double>(std::sqrt(solver.eigenvalues()[0]));
    shape = solver.eigenvectors().col(0).cast<double>();
  }
  /** u' at s/L, up to a factor. */
  double slope(double s) const
  {
    double sum = 0.0;
    for (int i = 0; i < TERMS; ++i)
      sum += shape[i] * (i + 2) * std::pow(s, i + 1);
    return sum;
  }
  double omega = 0.0;  ///< [rad/s]
  Eigen::Matrix<double, TERMS, 1> shape;
};

/** From the zero crossings of the tip, started in the mode's shape with slopes below 1e-3. */
double simulatedFrequency(const RodSpec& spec, const HangingMode& mode)
{
  const Eigen::Matrix3d down = Eigen::AngleAxisd(0.5 * PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const double dt = 2.0 * PI / mode.omega / 200.0;
  Simulator simulator = makeSimulator(spec, down, Regime::DYNAMIC, dt);
  const double piece = spec.length / spec.pieces;
  for (int k = 0; k < spec.pieces; ++k)
    simulator.position(0)[3 * k + 1] =
        1e-3 / mode.slope(1.0) / piece * (mode.slope((k + 1.0) / spec.pieces) - mode.slope(1.0 * k / spec.pieces));
  simulator.stateChanged();
  const auto tip = [&] { return simulator.data(0).link_pose.back().translation().x(); };
  double last = tip();
  std::vector<double> crossings;
  for (int step = 0; step < 1000 && crossings.size() < 5; ++step)
  {
    EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const double now = tip();
    if (now * last < 0.0)
      crossings.push_back(simulator.time() - dt * now / (now - last));
    last = now;
  }
  EXPECT_EQ(crossings.size(), 5u);
  return 4.0 * PI / (crossings.back() - crossings.front());
}

TEST(HangingRodTest, SwingsBetweenBeamAndChain)
{
  // Limits of the frequency: 3.516 sqrt(E I/(rho A L^4)) of a beam, 1.2024 sqrt(g/L) of a chain (Bernoulli 1732, half
  // the first zero of J_0).
  const RodSpec stiff = rodOf(1e-4, 1, 1);
  EXPECT_NEAR(HangingMode(stiff).omega /
                  std::sqrt(bendingStiffness(stiff) * GRAVITY / (weightPerLength(stiff) * std::pow(stiff.length, 4))),
              3.516, 1e-3);
  EXPECT_NEAR(HangingMode(rodOf(1e4, 1, 1)).omega / std::sqrt(GRAVITY / 0.2), 1.2024, 0.02);
  for (const double load : {1.0, 10.0, 100.0})
  {
    const HangingMode mode(rodOf(load, 1, 1));
    std::vector<double> errors;
    for (const int pieces : {3, 6, 12})
      errors.push_back(std::abs(simulatedFrequency(rodOf(load, pieces, 8), mode) / mode.omega - 1.0));
    for (size_t k = 1; k < errors.size(); ++k)
      EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 2.0, 0.5) << load;
    EXPECT_LT(errors.back(), 2e-3) << load;
  }
}

/** Time of the third passage through the vertical of the last section's axis, or of the last link's [s]. */
double thirdPassage(Simulator& simulator)
{
  const auto angle = [&]
  {
    const Eigen::Vector3d axis = simulator.data(0).link_pose.back().linear().col(0);
    return std::atan2(axis.x(), -axis.z());
  };
  double before = angle();
  for (int passages = 0; simulator.time() < 5.0;)
  {
    EXPECT_TRUE(simulator.step().converged());
    const double after = angle();
    if (before * after < 0.0 && ++passages == 3)
      return simulator.time() - simulator.scenario().time_step * after / (after - before);
    before = after;
  }
  return 0.0;
}

/** A rigid rod from its hinge down, as thick as `spec`. */
Simulator rigidPendulum(const RodSpec& spec, double angle, double time_step)
{
  const double mass = spec.density * PI * spec.radius * spec.radius * spec.length;
  const double across = mass * (std::pow(spec.length, 2) / 12.0 + 0.25 * std::pow(spec.radius, 2));
  const std::string inertial = "<inertial><origin xyz='" + text(0.5 * spec.length) + " 0 0'/><mass value='" +
                               text(mass) + "'/><inertia ixx='" + text(0.5 * mass * std::pow(spec.radius, 2)) +
                               "' ixy='0' ixz='0' iyy='" + text(across) + "' iyz='0' izz='" + text(across) +
                               "'/></inertial>";
  Scenario scenario;
  scenario.time_step = time_step;
  BodySpec body;
  body.name = "pendulum";
  body.base = BaseType::FIXED;
  body.urdf_xml = "<robot name='p'><link name='root'/><link name='rod'>" + inertial +
                  "</link><joint name='hinge' type='continuous'><parent link='root'/><child link='rod'/><axis xyz='0 1 "
                  "0'/></joint></robot>";
  body.joints["hinge"].position = 0.5 * PI - angle;  // turns x towards -z
  scenario.bodies.push_back(body);
  return Simulator(scenario);
}

TEST(RodOraclesTest, StiffRodOnASoftPieceSwingsAsTheRigidPendulum)
{
  // The first piece, of length e L, bends without resistance to speak of and stands for the hinge. As an arc of uniform
  // curvature it turns about its middle, but lifts what hangs on it as a hinge at a third of it would: with moments
  // 1/3 - e/2 and 1/2 - 2/3 e the square of the period is less by e/6.
  constexpr double STEP = 1e-3;
  constexpr double START = 0.3;  // [rad]
  Simulator rigid = rigidPendulum(rodOf(1e-4, 1, 1), START, STEP);
  const double exact = thirdPassage(rigid);
  const double small_swing = 2.0 * PI * std::sqrt(2.0 * 0.2 / (3.0 * GRAVITY));
  EXPECT_NEAR(exact, 1.25 * small_swing * (1.0 + START * START / 16.0), 1e-3 * exact);
  std::vector<double> times;
  for (const int pieces : {4, 8, 16})
  {
    RodSpec spec = rodOf(1e-4, pieces, 256 / pieces);
    spec.young_modulus.resize(pieces, spec.young_modulus[0]);
    spec.young_modulus[0] = 1.0;
    spec.start.assign(3 * pieces, 0.0);
    spec.start[1] = START * pieces / spec.length;
    Simulator rod = makeSimulator(spec, Eigen::AngleAxisd(0.5 * PI, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                                  Regime::DYNAMIC, STEP);
    times.push_back(thirdPassage(rod));
    EXPECT_NEAR((1.0 - times.back() / exact) * 12.0 * pieces, 1.0, 0.15) << pieces;
  }
  // With what is of order one taken out the rest is of order two.
  const double coarse = 2.0 * times[1] - times[0] - exact;
  const double fine = 2.0 * times[2] - times[1] - exact;
  EXPECT_LT(std::abs(fine), 5e-4 * exact);
  EXPECT_NEAR(std::log2(std::abs(coarse / fine)), 2.0, 0.5);
}

}  // namespace
}  // namespace frictional_contact_sim
