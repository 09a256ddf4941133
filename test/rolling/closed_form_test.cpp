/**
 * @file closed_form_test.cpp
 * @brief Hertz, Cattaneo-Mindlin and Carter: equal materials (beta = 0), n strips, convergence under refinement.
 *
 * Widths are counted in nodes, so they are right to one cell. Constant strips represent a traction with square-root
 * ends to order h^1.5 in the maximum norm away from the ends; at the ends half a cell of it is missing: order h^0.5
 * pointwise.
 */
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/rolling_motion.h"

using namespace frictional_contact_sim;

namespace
{
constexpr double MU = 0.3, RADIUS = 1.0, LOAD = 100.0;
const PlaneStrainMaterial RUBBER{94500.0, 0.1};
const MaterialPair EQUAL{RUBBER, RUBBER, false};

/// n strips over [-reach a, reach a]; a is half-width of Hertz' contact.
struct EqualBodies
{
  explicit EqualBodies(int n, double reach = 1.25) : hertz(hertzLine(LOAD, RADIUS, EQUAL.reducedModulus()))
  {
    Eigen::VectorXd x, w;
    makeUniformNodes(reach * hertz.half_width, n, x, w);
    F = halfPlaneFlexibility(EQUAL, x, w, 2.0);
    gap = x.array().square() / (2.0 * RADIUS);
    cell = w[0];
  }
  LoadedContact press(double load_share) const
  {
    LoadTarget target;
    target.P = LOAD;
    target.Q = load_share * MU * LOAD;
    return solveForLoads(FrictionalLcp(F, Eigen::VectorXd::Constant(1, MU)), gap, Eigen::VectorXd::Zero(gap.size()),
                         target, hertz.half_width * hertz.half_width, 0.0);
  }
  HertzLine hertz;
  ContactFlexibility F;
  Eigen::VectorXd gap;
  double cell;
};

template <typename Accept>
double widthOf(const FrictionalContact& c, double cell, Accept accept)
{
  double width = 0.0;
  for (NodeState state : c.states)
    width += accept(state) ? cell : 0.0;
  return width;
}

bool touches(NodeState state)
{
  return state != NodeState::SEPARATION;
}

bool sticks(NodeState state)
{
  return state == NodeState::STICK;
}

/// L1 error of a traction over its resultant, robust at the ends.
template <typename Exact>
double tractionError(const ContactFlexibility& F, const Eigen::VectorXd& r, Exact exact, double resultant)
{
  double error = 0.0;
  for (Eigen::Index i = 0; i < r.size(); ++i)
    error += F.width[i] * std::abs(r[i] - exact(F.x[i]));
  return error / resultant;
}
}  // namespace

TEST(HertzTest, HalfWidthIsRightToOneCellAndPressureConverges)
{
  double last = 0.0;
  for (int n : {25, 50, 100, 200})
  {
    const EqualBodies bodies(n);
    const FrictionalContact c = bodies.press(0.0).contact;
    EXPECT_NEAR(widthOf(c, bodies.cell, touches), 2.0 * bodies.hertz.half_width, 1.000001 * bodies.cell) << n;
    EXPECT_NEAR(c.r_N.maxCoeff(), bodies.hertz.peak_pressure, 0.02 * bodies.hertz.peak_pressure * 25 / n) << n;
    const double error = tractionError(
        bodies.F, c.r_N, [&](double x) { return bodies.hertz.pressure(x); }, LOAD);
    if (last > 0.0)
    {
      EXPECT_LT(error, 0.6 * last) << n;  // order 1.5 in the mean, 0.35 expected; the ends move by parts of a cell
    }
    last = error;
  }
  EXPECT_LT(last, 1e-3);
}

TEST(HertzTest, NoFrictionAndCouplingGiveHertzWithTheRigidPlatesModulus)
{
  const int n = 100;
  const MaterialPair on_rigid{RUBBER, {}, true};
  const HertzLine hertz = hertzLine(LOAD, RADIUS, on_rigid.reducedModulus());
  Eigen::VectorXd x, w;
  makeUniformNodes(1.25 * hertz.half_width, n, x, w);
  const ContactFlexibility F = halfPlaneFlexibility(on_rigid, x, w, 2.0);
  LoadTarget target;
  target.P = LOAD;
  const LoadedContact answer =
      solveForLoads(FrictionalLcp(F, Eigen::VectorXd::Zero(1)), x.array().square() / 2.0, Eigen::VectorXd::Zero(n),
                    target, hertz.half_width * hertz.half_width, 0.0);
  ASSERT_TRUE(answer.converged);
  EXPECT_NEAR(answer.contact.r_N.maxCoeff(), hertz.peak_pressure, 2e-3 * hertz.peak_pressure);
  EXPECT_NEAR(widthOf(answer.contact, w[0], touches), 2.0 * hertz.half_width, w[0]);
}

TEST(HertzTest, BoundaryElementCylinderApproachesHertzUnderRefinement)
{
  // First order of the constant elements; (a/R)^2 = 1e-3 of the half-plane idealisation remains.
  const MaterialPair on_rigid{RUBBER, {}, true};
  const double P = 25.0;
  const HertzLine hertz = hertzLine(P, RADIUS, on_rigid.reducedModulus());
  double last = 0.0;
  for (int n : {25, 50, 100})
  {
    CylinderMesh mesh;
    mesh.half_angle = 1.25 * hertz.half_width;
    mesh.contact_elements = n;
    mesh.max_angle = 2.5 / n;
    const ContactFlexibility F = condense(makeCylinderContour(mesh), RUBBER, ContactFrames::FLAT);
    LoadTarget target;
    target.P = P;
    const LoadedContact answer =
        solveForLoads(FrictionalLcp(F, Eigen::VectorXd::Zero(1)), F.x.array().square() / 2.0, Eigen::VectorXd::Zero(n),
                      target, hertz.half_width * hertz.half_width, 0.0);
    ASSERT_TRUE(answer.converged) << n;
    EXPECT_NEAR(widthOf(answer.contact, F.width[0], touches), 2.0 * hertz.half_width, 2.0 * F.width[0]) << n;
    const double error = tractionError(
        F, answer.contact.r_N, [&](double x) { return hertz.pressure(x); }, P);
    RecordProperty("error_" + std::to_string(n), std::to_string(error));
    if (last > 0.0)
    {
      EXPECT_LT(error, 0.7 * last) << n;
    }
    last = error;
  }
  EXPECT_LT(last, 0.02);
}

TEST(CattaneoTest, StickWidthIsRightToOneCellAndTractionConverges)
{
  for (double share : {0.2, 0.5, 0.8})
  {
    double first = 0.0, last = 0.0;
    for (int n : {25, 50, 100, 200})
    {
      const EqualBodies bodies(n);
      const LoadedContact answer = bodies.press(share);
      ASSERT_TRUE(answer.converged);
      const FrictionalContact& c = answer.contact;
      EXPECT_NEAR(widthOf(c, bodies.cell, sticks), 2.0 * cattaneoStickHalfWidth(bodies.hertz, share), 2.0 * bodies.cell)
          << n << " " << share;  // one cell at each end
      last = tractionError(
          bodies.F, c.r_T, [&](double x) { return cattaneoTraction(bodies.hertz, MU, share, x); }, share * MU * LOAD);
      first = first > 0.0 ? first : last;
    }
    EXPECT_LT(last, 0.15 * first) << share;  // eightfold refinement: order 1 gives 0.125, 1.5 gives 0.04
    EXPECT_LT(last, 5e-3) << share;
  }
}

TEST(CarterTest, CreepForceLawHoldsToTwoPercentAtAHundredCells)
{
  // 100 cells across 2a: reach 1.25 needs 125 nodes. Upwind differences: first order, half a cell of the stick edge.
  const EqualBodies bodies(125);
  const LoadedContact pressed = bodies.press(0.0);
  const double saturation = carterSaturation(bodies.hertz, RADIUS, MU);
  for (double xi : {0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 1.2})
  {
    const RollingResult result = rollSteadily(bodies.F, MU, bodies.gap, pressed.approach, xi * saturation);
    ASSERT_TRUE(result.steady) << xi;
    EXPECT_LT(result.contact.residual, 1e-12) << xi;
    EXPECT_NEAR(-result.contact.Q / (MU * LOAD), carterLoadShare(bodies.hertz, RADIUS, MU, xi * saturation), 0.02)
        << xi;
    const double error = tractionError(
        bodies.F, -result.contact.r_T,
        [&](double x) { return carterTraction(bodies.hertz, RADIUS, MU, xi * saturation, x); }, MU * LOAD);
    EXPECT_LT(error, 0.02) << xi;
  }
}

TEST(CarterTest, ConvergesAtFirstOrder)
{
  double last = 0.0;
  for (int n : {25, 50, 100, 200})
  {
    const EqualBodies bodies(n);
    const double xi = 0.4 * carterSaturation(bodies.hertz, RADIUS, MU);
    const RollingResult result = rollSteadily(bodies.F, MU, bodies.gap, bodies.press(0.0).approach, xi);
    const double error = tractionError(
        bodies.F, -result.contact.r_T, [&](double x) { return carterTraction(bodies.hertz, RADIUS, MU, xi, x); },
        MU * LOAD);
    RecordProperty("error_" + std::to_string(n), std::to_string(error));
    if (last > 0.0)
    {
      EXPECT_LT(error, 0.65 * last) << n;
    }
    last = error;
  }
}

TEST(CarterTest, StickStripSitsAtTheLeadingEdge)
{
  const EqualBodies bodies(125);
  const double xi = 0.5 * carterSaturation(bodies.hertz, RADIUS, MU);
  const RollingResult result = rollSteadily(bodies.F, MU, bodies.gap, bodies.press(0.0).approach, xi);
  // Stick over the leading half [0, a], slip over the trailing half, to two cells.
  const double a = bodies.hertz.half_width;
  for (Eigen::Index i = 0; i < bodies.F.size(); ++i)
  {
    const double x = bodies.F.x[i];
    const NodeState state = result.contact.states[static_cast<size_t>(i)];
    if (x > 2.0 * bodies.cell && x < a - 2.0 * bodies.cell)
    {
      EXPECT_EQ(state, NodeState::STICK) << x / a;
      EXPECT_NEAR(result.slip[i], 0.0, 1e-12);
    }
    else if (x < -2.0 * bodies.cell && x > -a + 2.0 * bodies.cell)
    {
      EXPECT_EQ(state, NodeState::SLIP_RIGHT) << x / a;
      EXPECT_GT(result.slip[i], 0.0);
    }
  }
}

TEST(CarterTest, FrictionalPowerIsTheCreepPowerAtFirstOrder)
{
  // Elastic energy is given back in steady rolling: sum w r_T s = Q xi. Upwind differences dissipate of order h.
  double last = 0.0;
  for (int n : {50, 100, 200})
  {
    const EqualBodies bodies(n);
    const double xi = 0.5 * carterSaturation(bodies.hertz, RADIUS, MU);
    const RollingResult result = rollSteadily(bodies.F, MU, bodies.gap, bodies.press(0.0).approach, xi);
    const double friction = (bodies.F.width.array() * result.contact.r_T.array() * result.slip.array()).sum();
    const double supplied = result.contact.Q * xi;
    EXPECT_LT(friction, 0.0);
    EXPECT_LE(supplied, friction);  // what is missing is numerical dissipation, never a gain
    const double error = (friction - supplied) / std::abs(supplied);
    if (last > 0.0)
    {
      EXPECT_LT(error, 0.65 * last) << n;
    }
    last = error;
  }
  EXPECT_LT(last, 0.05);
}

TEST(TransientRollingTest, EndsInTheSteadyStateFromAnyStart)
{
  // The sequence contracts slowly (the log of the datum is a soft spring): what is left is change per step times that.
  const EqualBodies bodies(40);
  const LoadedContact pressed = bodies.press(0.0), pulled = bodies.press(0.8);
  const double xi = 0.5 * carterSaturation(bodies.hertz, RADIUS, MU);
  const FrictionalLcp lcp(bodies.F, Eigen::VectorXd::Constant(1, MU));
  const RollingResult steady = rollSteadily(bodies.F, MU, bodies.gap, pressed.approach, xi);
  for (const LoadedContact* start : {&pressed, &pulled})
  {
    const RollingResult result = roll(lcp, bodies.gap, pressed.approach, start->contact.u_T, xi);
    ASSERT_TRUE(result.steady);
    EXPECT_GT(result.steps, 40);
    EXPECT_LT((result.contact.r_T - steady.contact.r_T).lpNorm<Eigen::Infinity>(),
              1e-3 * MU * bodies.hertz.peak_pressure);
    EXPECT_NEAR(result.history.back(), steady.contact.Q, 1e-3 * MU * LOAD);
  }
}

TEST(TransientRollingTest, FirstStepsBuildUpTractionInProportionToDistance)
{
  // From rest the whole contact sticks but its ends: Q grows in proportion to the distance rolled for the first steps.
  const EqualBodies bodies(80);
  const LoadedContact pressed = bodies.press(0.0);
  RollingOptions options;
  options.max_steps = 4;
  const FrictionalLcp lcp(bodies.F, Eigen::VectorXd::Constant(1, MU));
  const RollingResult result = roll(lcp, bodies.gap, pressed.approach, pressed.contact.u_T,
                                    0.02 * carterSaturation(bodies.hertz, RADIUS, MU), options);
  ASSERT_EQ(result.history.size(), 4u);
  EXPECT_LT(result.history[0], 0.0);
  EXPECT_NEAR(result.history[1] / result.history[0], 2.0, 0.15);
  EXPECT_NEAR(result.history[3] / result.history[0], 4.0, 0.6);
}

TEST(TransientRollingTest, MisuseIsNamed)
{
  const EqualBodies narrow(20, 0.5);  // the contact fills the zone
  const FrictionalLcp lcp(narrow.F, Eigen::VectorXd::Constant(1, MU));
  EXPECT_THROW(roll(lcp, narrow.gap, 5e-3, Eigen::VectorXd::Zero(20), 1e-3), std::invalid_argument);
  ContactFlexibility uneven = EqualBodies(20).F;
  uneven.x[3] += 0.5 * uneven.width[0];
  EXPECT_THROW(rollSteadily(uneven, MU, narrow.gap, 1e-3, 1e-3), std::invalid_argument);
}

TEST(SlipVelocityTest, IsTheForwardDifferenceOfThePaper)
{
  const Eigen::Vector4d x(0.0, 0.1, 0.3, 0.4), u(0.0, 0.01, 0.01, -0.01);
  const Eigen::VectorXd s = slipVelocity(x, u, 0.5, -1.0);
  EXPECT_NEAR(s[0], 0.4, 1e-15);
  EXPECT_NEAR(s[1], 0.5, 1e-15);
  EXPECT_NEAR(s[2], 0.7, 1e-15);
  EXPECT_NEAR(s[3], 0.7, 1e-15);
}

TEST(SlipVelocityTest, StaticStickGivesTheCreepageNotZero)
{
  // Where the static answer sticks, u_T is constant: (12) yields s = xi there, though sticking in rolling means s = 0.
  const EqualBodies bodies(100);
  const FrictionalContact c = bodies.press(0.5).contact;
  const Eigen::VectorXd s = slipVelocity(bodies.F.x, c.u_T, 0.01, 1.0);
  for (size_t i = 0; i + 1 < c.states.size(); ++i)
    if (c.states[i] == NodeState::STICK && c.states[i + 1] == NodeState::STICK)
    {
      EXPECT_NEAR(s[static_cast<Eigen::Index>(i)], 0.01, 1e-10);
    }
}
