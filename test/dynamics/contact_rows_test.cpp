// Rows of contacts alone: against finite differences of the gap, warm start by id, readback, ledger.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/dynamics/contact_rows.h"
#include "row_bench.h"

namespace frictional_contact_sim
{
namespace
{
const char* const BALL =
    "<robot name='ball'><link name='ball'><inertial><origin xyz='0.02 0 0.01'/><mass value='2'/>"
    "<inertia ixx='0.02' ixy='0' ixz='0' iyy='0.03' iyz='0' izz='0.04'/></inertial>"
    "<collision><origin xyz='0.03 -0.02 0.05'/><geometry><sphere radius='0.1'/></geometry></collision></link></robot>";

class ContactRowsTest : public testing::Test
{
protected:
  ContactRowsTest()
    : bench_(BALL, BaseType::FLOATING,
             [this](std::vector<Body>& bodies, CollisionWorld& world, RowState& state)
             {
               state.memory.clear();
               world.addStatic(HalfSpace{}, Eigen::Isometry3d::Identity(), "ground");
               MaterialTable materials;
               materials.fallback = {0.6, 0.5};
               pairs_ = PairTable(materials, {{"default", -1.0}, {"default", -1.0}});
               return std::make_unique<ContactRows>(bodies, world, pairs_, state.contacts, nullptr);
             })
  {
  }
  /** Random orientation and velocity, the ball's surface `gap` above the ground at the midpoint, approximately. */
  void place(std::mt19937& random, double gap)
  {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    BodyState& state = bench_.body().state;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(number(random), number(random), number(random), number(random)).normalized();
    state.q.segment<4>(3) = turn.coeffs();
    for (int i = 0; i < 6; ++i)
      state.v[i] = number(random);
    const Eigen::Vector3d centre = turn * Eigen::Vector3d(0.03, -0.02, 0.05);
    state.q.head<3>() = Eigen::Vector3d(number(random), number(random), 0.1 + gap - centre.z());
  }
  PairTable pairs_;
  RowBench bench_;
};

TEST_F(ContactRowsTest, NormalRowIsTheRateOfTheGapAndTangentsThatOfTheMaterialPoint)
{
  std::mt19937 random(4);
  for (int draw = 0; draw < 50; ++draw)
  {
    place(random, 0.01);
    bench_.assemble(0.1);
    ASSERT_EQ(bench_.points().size(), 1u);
    ASSERT_EQ(bench_.problem().rows(), 3);
    const ContactPoint point = bench_.points().front();
    Body& body = bench_.body();
    const Eigen::VectorXd& v = body.state.v;
    const Eigen::VectorXd rate = bench_.problem().H * v;

    // The same body-fixed point and the gap a moment later; central differences, errors of order step^2.
    const double step = 1e-5;
    double gap[2];
    Eigen::Vector3d moved[2];
    const Eigen::Vector3d local = body.middle.link_pose[0].inverse() * point.position;
    for (const int side : {0, 1})
    {
      MultibodyData data(body.model.tree);
      Eigen::VectorXd q = body.q_middle;
      integrate(body.model.tree, body.q_middle, v, side == 0 ? -step : step, q);
      forwardKinematics(body.model.tree, q, data);
      bench_.world().setPoses(0, data);
      gap[side] = bench_.world().detect(0.1).front().gap;
      moved[side] = data.link_pose[0] * local;
    }
    EXPECT_NEAR(rate[0], (gap[1] - gap[0]) / (2.0 * step), 1e-8);
    const Eigen::Vector3d velocity = (moved[1] - moved[0]) / (2.0 * step);
    EXPECT_NEAR(rate.tail<2>().norm(), velocity.head<2>().norm(), 1e-8);
  }
}

TEST_F(ContactRowsTest, ShiftIsTheGapOverTheStepAndRestitutionForWhatCloses)
{
  std::mt19937 random(5);
  place(random, 2e-4);
  BodyState& state = bench_.body().state;
  state.v.setZero();
  bench_.assemble();
  EXPECT_DOUBLE_EQ(bench_.problem().w[0], bench_.points().front().gap / bench_.context().dt);
  state.v[2] = -0.7;
  bench_.assemble();
  EXPECT_NEAR(bench_.problem().w[0], 0.5 * -0.7, 1e-15);
  EXPECT_DOUBLE_EQ(bench_.problem().laws[0].coefficient, 0.6);
}

TEST_F(ContactRowsTest, ForcesOfTheLastStepAreTheGuessUnlessTheyWereAnImpact)
{
  std::mt19937 random(6);
  place(random, 1e-5);
  bench_.body().state.v.setZero();
  bench_.assemble();
  Solution solution = bench_.blank();
  solution.r << 0.02, 0.003, -0.004;
  bench_.accept(solution);
  ASSERT_EQ(bench_.rows().contacts.size(), 1u);
  const ContactState& contact = bench_.rows().contacts.front();
  EXPECT_NEAR(contact.impulse.norm(), solution.r.norm(), 1e-15);
  EXPECT_NEAR(contact.cone_margin, 0.6 * 0.02 - 0.005, 1e-15);
  EXPECT_EQ(contact.mode, ContactMode::STICKING);
  bench_.assemble();
  EXPECT_LT((bench_.guess().r - solution.r).norm(), 1e-15);

  bench_.body().state.v[2] = -0.7;
  bench_.assemble();
  EXPECT_EQ(bench_.guess().r.norm(), 0.0) << "a closing contact starts from nothing";
  bench_.accept(solution);
  EXPECT_EQ(bench_.rows().contacts.front().mode, ContactMode::IMPACT);
  bench_.body().state.v.setZero();
  bench_.assemble();
  EXPECT_EQ(bench_.guess().r.norm(), 0.0) << "impulses of impacts are not repeated";
}

TEST_F(ContactRowsTest, NormalWorkGoesToImpactAndTangentialWorkToFriction)
{
  std::mt19937 random(7);
  place(random, 1e-5);
  bench_.assemble();
  Solution solution = bench_.blank();
  solution.v = bench_.body().v_start;  // mean velocity is that of the start, in the columns of the problem
  solution.r << 0.5, -0.2, 0.1;
  EnergyLedger ledger;
  bench_.assembly().setMeanVelocity(solution);
  bench_.assembly().book(bench_.context(), solution, ledger);
  const Eigen::VectorXd u = bench_.problem().H * solution.v;
  EXPECT_NEAR(ledger.impact, -0.5 * u[0], 1e-15);
  EXPECT_NEAR(ledger.friction, 0.2 * u[1] - 0.1 * u[2], 1e-15);
  EXPECT_EQ(ledger.joints, 0.0);
}
}  // namespace
}  // namespace frictional_contact_sim
