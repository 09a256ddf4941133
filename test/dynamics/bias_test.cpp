// Forces of a step: bias at the midpoint of this very step, what scales it, the reach of joints.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/dynamics/dry_friction_rows.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "row_bench.h"

namespace frictional_contact_sim
{
namespace
{
/** Two links in a chain on a fixed base, a turns with dry friction, b slides between 0 and 0.5 m; no shapes. */
std::string armUrdf()
{
  const std::string inertial =
      "<inertial><origin xyz='0.1 0 0'/><mass value='1.5'/>"
      "<inertia ixx='0.02' ixy='0' ixz='0' iyy='0.03' iyz='0' izz='0.04'/></inertial>";
  return "<robot name='arm'><link name='world'/><link name='a'>" + inertial + "</link><link name='b'>" + inertial +
         "</link><link name='c'>" + inertial +
         "<collision><origin xyz='0 0 0.1'/><geometry><sphere radius='0.05'/></geometry></collision></link>"
         "<joint name='a' type='continuous'><parent link='world'/><child link='a'/><axis xyz='0 1 0'/>"
         "<dynamics friction='0.7'/></joint>"
         "<joint name='b' type='prismatic'><parent link='a'/><child link='b'/><origin xyz='0.3 0 0'/>"
         "<axis xyz='1 0 0'/><limit lower='0' upper='0.5' effort='9' velocity='9'/></joint>"
         "<joint name='c' type='continuous'><parent link='b'/><child link='c'/><origin xyz='0.2 0 0'/>"
         "<axis xyz='0 0 1'/></joint></robot>";
}

std::unique_ptr<RowSource> dryFriction(std::vector<Body>& bodies, const CollisionWorld&, RowState& state)
{
  return std::make_unique<DryFrictionRows>(bodies, state.memory.front());
}

class BiasTest : public testing::Test
{
protected:
  BiasTest() : bench_(armUrdf(), BaseType::FIXED, dryFriction)
  {
    bench_.body().state.q << 0.4, 0.1, -0.8;
    bench_.body().state.v << 3.0, 0.5, -2.0;
  }
  void assembleWith(double impulse)
  {
    bench_.rows().memory.front().impulses.assign(bench_.rows().memory.front().impulses.size(), impulse);
    bench_.assemble();
  }
  /** -M v_k + dt bias(q_m, v). */
  Eigen::VectorXd force(const Eigen::VectorXd& v)
  {
    Body& body = bench_.body();
    Eigen::VectorXd bias(v.size());
    computeBiasForces(body.model.tree, v, bench_.context().gravity, body.middle, bias);
    return bench_.context().dt * bias - body.middle.mass_matrix * body.state.v;
  }
  Eigen::VectorXd answerWithout() { return bench_.body().middle.mass_matrix.llt().solve(-bench_.problem().f); }

  RowBench bench_;
};

TEST_F(BiasTest, NoForceOfAnEarlierStepEntersThePrediction)
{
  assembleWith(1e-3);
  const Eigen::VectorXd f = bench_.problem().f;
  ASSERT_NE(bench_.guess().r[0], 0.0);
  assembleWith(-1e9);
  EXPECT_EQ(bench_.guess().r[0], -1e9);
  EXPECT_TRUE((bench_.problem().f - f).isZero(0.0));
}

TEST_F(BiasTest, WhereARowActedItIsTakenAtTheOldVelocityFirst)
{
  assembleWith(1e-3);
  EXPECT_LE((bench_.problem().f - force(bench_.body().state.v)).norm(), 1e-15);
}

TEST_F(BiasTest, WhereNoneActedItIsThatOfTheFreeMotionAtOnce)
{
  assembleWith(0.0);
  const Eigen::VectorXd v = answerWithout();
  // Rounds are left where they change v by less than 1e-8 of one step's change.
  EXPECT_LE((bench_.problem().f - force(0.5 * (bench_.body().state.v + v))).norm(), 1e-8 * 0.0098);
  Solution solution = bench_.blank();
  solution.v = v;
  EXPECT_EQ(bench_.assembly().again(bench_.context(), solution, true), Again::NO);
}

TEST_F(BiasTest, RoundsBringItToTheMidpointOfTheAnswer)
{
  assembleWith(1e-3);
  Solution solution = bench_.blank();
  int rounds = 0;
  Again again = Again::FORCES;
  for (; again == Again::FORCES && rounds < 10; ++rounds)
  {
    solution.v = answerWithout();
    again = bench_.assembly().again(bench_.context(), solution, true);
  }
  EXPECT_EQ(again, Again::NO);
  EXPECT_GE(rounds, 2);
  EXPECT_LE(rounds, 5);
  const Eigen::VectorXd middle = 0.5 * (bench_.body().state.v + solution.v);
  EXPECT_LE((bench_.problem().f - force(middle)).norm(), 1e-8 * 0.0098);
  EXPECT_EQ(bench_.assembly().again(bench_.context(), solution, false), Again::NO) << "a failed solve is not repeated";
}

TEST_F(BiasTest, ABiasThatDoesNotSettleIsSaid)
{
  assembleWith(1e-3);
  Solution solution = bench_.blank();
  solution.v = bench_.body().state.v;
  Again again = Again::FORCES;
  int rounds = 0;
  for (; again == Again::FORCES && rounds < 100; ++rounds)
  {
    solution.v *= -1.5;  // a solver whose answers run away
    again = bench_.assembly().again(bench_.context(), solution, true);
  }
  EXPECT_EQ(again, Again::NEVER);
  EXPECT_EQ(rounds, 31) << "thirty rounds and the look that gives up";
  EXPECT_STREQ(bench_.assembly().unsatisfied(), "bias at the midpoint");
}

TEST_F(BiasTest, ReachOfAJointIsToTheFarthestPointThatItMoves)
{
  const Eigen::VectorXd& reach = bench_.body().model.reach;
  const double gyration = std::sqrt(0.5 * 0.09 / 1.5);  // of a and b, which have no shapes
  ASSERT_EQ(reach.size(), 3);
  EXPECT_NEAR(reach[2], 0.15, 1e-15);  // the ball's far side
  EXPECT_EQ(reach[1], 1.0);
  const double of_b = std::max(0.2 + 0.15, 0.1 + gyration);
  EXPECT_NEAR(reach[0], 0.3 + 0.5 + of_b, 1e-15);
}

TEST(BodySpeedTest, OfABallThatFallsAndSpins)
{
  const std::string urdf =
      "<robot name='ball'><link name='ball'><inertial><mass value='2'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' "
      "iyz='0' izz='0.1'/></inertial><collision><geometry><sphere radius='0.2'/></geometry></collision></link></robot>";
  RowBench bench(urdf, BaseType::FLOATING, dryFriction);
  bench.body().state.v << 3.0, 0.0, 0.0, 0.0, 5.0, 0.0;
  bench.assemble();
  const double fall = 9.81 * bench.context().dt;
  EXPECT_NEAR(bench.body().speed_change, fall, 1e-15);
  EXPECT_NEAR(bench.body().speed, std::hypot(3.0, fall) + 1.0, 1e-14);
  EXPECT_EQ(bench.body().model.reach.head<3>(), Eigen::Vector3d::Ones());
  EXPECT_EQ(bench.body().model.reach.tail<3>(), Eigen::Vector3d::Constant(0.2));
  bench.context().gravity.setZero();
  bench.body().state.v.setZero();
  bench.assemble();
  EXPECT_EQ(bench.body().speed_change, 1e-12);
  EXPECT_EQ(bench.body().speed, 0.0);
}

}  // namespace
}  // namespace frictional_contact_sim
