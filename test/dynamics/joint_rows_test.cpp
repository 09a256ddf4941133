// Rows of joints, each kind alone: against finite differences, warm start, readback, ledger.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/dynamics/dry_friction_rows.h"
#include "frictional_contact_sim/dynamics/limit_rows.h"
#include "frictional_contact_sim/dynamics/mimic_rows.h"
#include "frictional_contact_sim/dynamics/servo_rows.h"
#include "row_bench.h"

namespace frictional_contact_sim
{
namespace
{
/** Three links in a chain on a fixed base: a (dry friction), b (narrow limits), c (mimics a). */
std::string chainUrdf()
{
  const std::string inertial =
      "<inertial><origin xyz='0.1 0.02 0'/><mass value='1.5'/>"
      "<inertia ixx='0.02' ixy='0' ixz='0' iyy='0.03' iyz='0' izz='0.04'/></inertial>";
  const auto link = [&](const std::string& name) { return "<link name='" + name + "'>" + inertial + "</link>"; };
  const auto joint =
      [](const std::string& name, const std::string& type, const std::string& parent, const std::string& elements)
  {
    return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='link_" + name +
           "'/><origin xyz='0.2 0 0' rpy='0.3 0.1 0'/><axis xyz='0 1 0'/>" + elements + "</joint>";
  };
  return "<robot name='chain'><link name='world'/>" + link("link_a") + link("link_b") + link("link_c") +
         joint("a", "continuous", "world", "<dynamics friction='0.7'/>") +
         joint("b", "revolute", "link_a", "<limit lower='-0.004' upper='0.006' effort='4' velocity='9'/>") +
         joint("c", "prismatic", "link_b",
               "<limit lower='-9' upper='9' effort='50' velocity='9'/>"
               "<mimic joint='a' multiplier='-1.5' offset='0.1'/>") +
         "</robot>";
}

template <class Source>
std::unique_ptr<RowSource> make(std::vector<Body>& bodies, const CollisionWorld&, RowState& state)
{
  return std::make_unique<Source>(bodies, state.memory.front());
}

const int A = 1;  // joint indices: 0 is the base
const int B = 2;
const int C = 3;

void setRandomly(Body& body, std::mt19937& random)
{
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (Eigen::Index i = 0; i < body.state.q.size(); ++i)
    body.state.q[i] = number(random);
  for (Eigen::Index i = 0; i < body.state.v.size(); ++i)
    body.state.v[i] = number(random);
}

/** Generalized velocity of a joint from its work: sets solution.v and returns the ledger of one row's impulse. */
EnergyLedger ledgerOf(RowBench& bench, const Solution& solution)
{
  EnergyLedger ledger;
  bench.assembly().setMeanVelocity(solution);
  bench.assembly().book(bench.context(), solution, ledger);
  return ledger;
}

TEST(LimitRowsTest, RowsAreTheRateOfTheGapAndTheShiftClosesIt)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<LimitRows>);
  std::mt19937 random(1);
  int seen[2] = {0, 0};
  for (int draw = 0; draw < 50; ++draw)
  {
    setRandomly(bench.body(), random);
    bench.body().state.q[B - 1] = draw % 2 == 0 ? -0.0035 : 0.0055;  // near one of its limits
    bench.assemble();
    const double velocity = bench.body().state.v[B - 1];
    const double free_velocity = bench.body().v_free[B - 1];
    const double middle = bench.body().q_middle[B - 1];
    int row = 0;
    for (const int side : {0, 1})
    {
      const double sign = side == 0 ? 1.0 : -1.0;
      const double gap = side == 0 ? middle + 0.004 : 0.006 - middle;
      if (gap > std::max(1e-9, 2e-3 * std::max(-sign * velocity, -sign * free_velocity)))
        continue;  // twice what the free motion closes in a step does not reach it
      ++seen[side];
      ASSERT_LT(row, bench.problem().rows());
      EXPECT_NEAR(Eigen::VectorXd(bench.problem().H * bench.body().state.v)[row], sign * velocity, 1e-12);
      // u = 0 brings the gap at the midpoint to zero within the step, unless it is an overlap.
      EXPECT_DOUBLE_EQ(bench.problem().w[row], gap >= 0.0 ? gap / bench.context().dt : -std::min(-gap / 1e-3, 0.01));
      ++row;
    }
    EXPECT_EQ(row, bench.problem().rows()) << "limits of a and c are far away";
    for (const Law& law : bench.problem().laws)
      EXPECT_EQ(law.type, LawType::UNILATERAL);
  }
  EXPECT_GT(std::min(seen[0], seen[1]), 5);
}

TEST(LimitRowsTest, ALimitThatAnAnswerGoesBeyondGetsItsRow)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<LimitRows>);
  bench.assemble();
  ASSERT_EQ(bench.problem().rows(), 0) << "4 and 6 mrad away, at rest";
  Solution solution = bench.blank();
  solution.v[B - 1] = -3.999;  // in the columns of a fixed base
  EXPECT_EQ(bench.source().lookAhead(bench.context(), solution), Again::NO);
  solution.v[B - 1] = -4.001;
  EXPECT_EQ(bench.source().lookAhead(bench.context(), solution), Again::FROM_ANSWER);
  bench.assembleAgain();
  ASSERT_EQ(bench.problem().rows(), 1);
  EXPECT_DOUBLE_EQ(bench.problem().w[0], 4.0);
}

TEST(LimitRowsTest, ImpulsesAreKeptByJointAndSideAndForgottenWithTheirRows)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<LimitRows>);
  bench.body().state.q[B - 1] = -0.004;  // at its lower limit
  bench.assemble();
  ASSERT_EQ(bench.problem().rows(), 1);
  Solution solution = bench.blank();
  solution.r << 3.0;
  bench.accept(solution);
  bench.assemble();
  EXPECT_EQ(bench.guess().r, solution.r);
  bench.body().state.q[B - 1] = 0.0;  // what carried an impulse in the last step has a row in this one
  bench.assemble();
  ASSERT_EQ(bench.problem().rows(), 1);
  EXPECT_EQ(bench.guess().r[0], 3.0);
  bench.accept(bench.blank());
  bench.assemble();
  EXPECT_EQ(bench.problem().rows(), 0);
}

TEST(LimitRowsTest, ItsWorkIsDissipatedInTheJoint)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<LimitRows>);
  bench.body().state.q[B - 1] = -0.0035;  // half a milliradian before its lower limit
  bench.body().state.v[B - 1] = -0.4;
  bench.assemble();
  ASSERT_EQ(bench.problem().rows(), 1);
  Solution solution = bench.blank();
  solution.v[B - 1] = 0.2;
  solution.r[0] = 2.0;
  const EnergyLedger ledger = ledgerOf(bench, solution);
  EXPECT_NEAR(ledger.joints, -2.0 * 0.5 * (-0.4 + 0.2), 1e-15);
  EXPECT_EQ(ledger.actuators, 0.0);
  EXPECT_EQ(ledger.friction, 0.0);
}

TEST(LimitRowsTest, AnImpactSeesOnlyWhatTouchesAndCloses)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<LimitRows>);
  bench.context().impact = true;
  bench.body().state.q[B - 1] = 0.006;
  for (const double speed : {-0.5, 0.5})
  {
    bench.body().state.v[B - 1] = speed;
    bench.assemble();
    EXPECT_EQ(bench.problem().rows(), 1);
    EXPECT_EQ(bench.assembly().closing(), speed > 0.0);
    EXPECT_EQ(bench.problem().w[0], 0.0);
  }
}

TEST(DryFrictionRowsTest, RowIsTheJointsVelocityWithItsThreshold)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<DryFrictionRows>);
  std::mt19937 random(2);
  for (int draw = 0; draw < 20; ++draw)
  {
    setRandomly(bench.body(), random);
    bench.assemble();
    ASSERT_EQ(bench.problem().rows(), 1);
    const Eigen::VectorXd u = bench.problem().H * bench.body().state.v + bench.problem().w;
    const double step = 1e-6;
    Eigen::VectorXd moved = bench.body().q_middle;
    integrate(bench.body().model.tree, bench.body().q_middle, bench.body().state.v, step, moved);
    EXPECT_NEAR(u[0], (moved[A - 1] - bench.body().q_middle[A - 1]) / step, 1e-9);
  }
  EXPECT_EQ(bench.problem().laws[0].type, LawType::DRY_FRICTION);
  EXPECT_DOUBLE_EQ(bench.problem().laws[0].coefficient, 1e-3 * 0.7);
}

TEST(DryFrictionRowsTest, WarmStartAndLedger)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<DryFrictionRows>);
  bench.body().state.v[A - 1] = 1.0;
  bench.assemble();
  Solution solution = bench.blank();
  solution.v[A - 1] = 0.6;
  solution.r[0] = -7e-4;
  EXPECT_NEAR(ledgerOf(bench, solution).joints, 7e-4 * 0.8, 1e-18);
  bench.accept(solution);
  bench.assemble();
  EXPECT_EQ(bench.guess().r[0], -7e-4);
  bench.context().impact = true;
  bench.assemble();
  EXPECT_EQ(bench.problem().rows(), 0) << "an impact is shorter than any friction force";
}

TEST(MimicRowsTest, RowIsTheRateOfTheConstraintAndBItsError)
{
  RowBench bench(chainUrdf(), BaseType::AUTO, make<MimicRows>);
  std::mt19937 random(3);
  const auto phi = [](const Eigen::VectorXd& q) { return q[C - 1] + 1.5 * q[A - 1] - 0.1; };
  for (int draw = 0; draw < 20; ++draw)
  {
    setRandomly(bench.body(), random);
    bench.assemble();
    ASSERT_EQ(bench.problem().bilaterals(), 1);
    const Eigen::VectorXd& q = bench.body().q_middle;
    const double step = 1e-6;
    EXPECT_NEAR((bench.problem().G * bench.body().state.v)[0], (phi(q + step * bench.body().state.v) - phi(q)) / step,
                1e-8);
    EXPECT_NEAR(bench.problem().b[0], phi(q) / bench.context().dt, 1e-9);
    EXPECT_NEAR(bench.assembly().bilateralViolation(), std::abs(phi(q)), 1e-15);
  }
  Solution solution = bench.blank();
  solution.lambda[0] = -0.3;
  bench.accept(solution);
  bench.assemble();
  EXPECT_EQ(bench.guess().lambda[0], -0.3);
}

class ServoRowsTest : public testing::Test
{
protected:
  ServoRowsTest() : bench_(chainUrdf(), BaseType::AUTO, make<ServoRows>)
  {
    JointCommand command;
    command.mode = JointCommand::Mode::POSITION;
    command.target = 0.5;
    command.kp = 100.0;
    command.kd = 3.0;
    bench_.body().state.drives[B] = makeDrive(bench_.body().model, B, command);
  }
  RowBench bench_;
};

TEST_F(ServoRowsTest, BelowItsLimitItIsStiffnessAndMomentumWithoutARow)
{
  bench_.assemble();
  EXPECT_EQ(bench_.problem().rows(), 0);
  const double dt = bench_.context().dt;
  const double stiffness = 0.25 * dt * dt * 100.0 + dt * 3.0;
  EXPECT_DOUBLE_EQ(bench_.body().implicit[B - 1], stiffness);
  EXPECT_NEAR(bench_.problem().M.coeff(B - 1, B - 1) - bench_.body().middle.mass_matrix(B - 1, B - 1), stiffness,
              1e-15);
}

TEST_F(ServoRowsTest, BeyondItsLimitItBecomesARowAndTheStepIsSolvedAgain)
{
  bench_.assemble();
  // kp 100 times 0.5 rad is 50 N m, its limit 4.
  EXPECT_EQ(bench_.source().again(bench_.context(), bench_.blank(), true), Again::FROM_GUESS);
  bench_.assembleAgain();
  ASSERT_EQ(bench_.problem().rows(), 1);
  EXPECT_DOUBLE_EQ(bench_.problem().laws[0].coefficient, 4e-3);
  EXPECT_EQ(bench_.body().implicit[B - 1], 0.0);
  // u = v_j - s - c/K with an auxiliary s of mass K: r = c - K v_j where u = 0.
  const int auxiliary = bench_.assembly().velocities();
  EXPECT_EQ(bench_.problem().H.coeff(0, B - 1), 1.0);
  EXPECT_EQ(bench_.problem().H.coeff(0, auxiliary), -1.0);
  EXPECT_EQ(bench_.source().again(bench_.context(), bench_.blank(), true), Again::NO);

  Solution solution = bench_.blank();
  solution.r[0] = 4e-3;
  solution.v[B - 1] = 0.2;
  EXPECT_NEAR(ledgerOf(bench_, solution).actuators, 4e-3 * 0.1, 1e-18);
  bench_.accept(solution);
  EXPECT_DOUBLE_EQ(bench_.body().state.drives[B].effort, 4.0);
  bench_.assemble();
  EXPECT_EQ(bench_.problem().rows(), 1) << "a servo that worked at its limit is a row from the start";
  EXPECT_EQ(bench_.guess().r[0], 4e-3);
}

TEST_F(ServoRowsTest, EffortAndWorkOfAServoInsideItsLimitAreThoseOfItsImpulse)
{
  bench_.body().state.q[B - 1] = 0.49;
  bench_.assemble();
  Solution solution = bench_.blank();
  solution.v[B - 1] = 0.1;
  const double dt = bench_.context().dt;
  const double impulse = dt * 100.0 * (0.5 - (0.49 + 0.25 * dt * 0.1)) - dt * 3.0 * 0.1;
  EXPECT_NEAR(ledgerOf(bench_, solution).actuators, impulse * 0.05, 1e-15);
  bench_.accept(solution);
  EXPECT_NEAR(bench_.body().state.drives[B].effort, impulse / dt, 1e-12);
}
}  // namespace
}  // namespace frictional_contact_sim
