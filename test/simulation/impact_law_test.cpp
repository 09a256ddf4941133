// Laws of impact against closed forms: unequal masses, simultaneous impacts, tangential restitution, the plain law of
// the thesis beside the gap law, chatter.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::AuditedSimulator;
using test_support::Dice;

Scenario spaceWith(double friction, double restitution)
{
  Scenario scenario = emptySpace();
  scenario.materials.fallback = {friction, restitution};
  return scenario;
}

TEST(UnequalMassesTest, LeaveTheImpactAsNewtonsLawSays)
{
  // Cadoux 2009, (1.15)-(1.16): v_1 = (m_1 - e m_2)/(m_1 + m_2) v_0, v_2 = (1 + e) m_1/(m_1 + m_2) v_0; with e = 1 they
  // are (1.13)-(1.14), conservation of momentum and of energy.
  Dice dice(1131);
  for (int trial = 0; trial < 60; ++trial)
  {
    const double e = trial % 3 == 0 ? 1.0 : dice.uniform(0.0, 1.0);
    const double m1 = dice.logUniform(0.01, 100.0);
    const double m2 = dice.logUniform(0.01, 100.0);
    const double v0 = dice.uniform(0.5, 2.0);
    const double gap = trial % 2 == 0 ? 0.0 : 0.01;
    Scenario scenario = spaceWith(0.3, e);
    addBody(scenario, "first", sphereUrdf(0.1, m1), poseAt(0.0, 0.0, 0.0)).linear_velocity.x() = v0;
    addBody(scenario, "second", sphereUrdf(0.1, m2), poseAt(0.2 + gap, 0.0, 0.0));
    AuditedSimulator simulator(scenario);
    for (int step = 0; step < 40 && gap > 0.0; ++step)
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const double sum = m1 + m2;
    // Without restitution the gap row stops them where they touch; both laws leave one common velocity.
    EXPECT_NEAR(simulator.velocity(0)[0], (m1 - e * m2) / sum * v0, 1e-11 * v0) << m1 << " " << m2 << " " << e;
    EXPECT_NEAR(simulator.velocity(1)[0], (1.0 + e) * m1 / sum * v0, 1e-11 * v0 * std::max(1.0, m1 / m2));
    const double lost = 0.5 * m1 * m2 / sum * (1.0 - e * e) * v0 * v0;
    EXPECT_NEAR(0.5 * m1 * v0 * v0 - simulator.report().energy.kinetic, lost, 1e-10 * m1 * v0 * v0);
  }
}

TEST(NewtonCradleTest, TouchingBallsFollowTheSimultaneousLawForEveryRestitution)
{
  // One impact for all: u_1 = e, u_2 = 0 (its balls were at rest against each other): v = (1 - 2s, s, s), s = (1 +
  // e)/3.
  for (const double e : {0.0, 0.25, 0.5, 0.9, 1.0})
  {
    Scenario scenario = spaceWith(0.0, e);
    for (int i = 0; i < 3; ++i)
      addBody(scenario, "ball" + std::to_string(i), sphereUrdf(0.1, 1.0), poseAt(0.2 * i, 0.0, 0.0));
    scenario.bodies[0].linear_velocity.x() = 1.0;
    const AuditedSimulator simulator(scenario);
    const double s = (1.0 + e) / 3.0;
    const double expected[3] = {1.0 - 2.0 * s, s, s};
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(simulator.velocity(i)[0], expected[i], 1e-12) << e << " ball " << i;
  }
}

/** Time from the drop until a ball with restitution e rests on the ground [s]. */
double timeToRest(double e, double height, double h)
{
  Scenario scenario = groundScene(0.0, e);
  scenario.time_step = h;
  addBody(scenario, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.1 + height));
  AuditedSimulator simulator(scenario);
  double moved = 0.0;
  const double until = 1.5 * std::sqrt(2.0 * height / GRAVITY) * (1.0 + e) / (1.0 - e);
  while (simulator.time() < until)
  {
    simulator.step();
    if (std::abs(simulator.velocity(0)[2]) > 1e-9)
      moved = simulator.time();
  }
  EXPECT_LT(std::abs(simulator.velocity(0)[2]), 1e-13);
  EXPECT_NEAR(simulator.position(0)[2], 0.1, 1e-12);
  return moved;
}

TEST(BouncingBallTest, ComesToRestAfterTheSumOfItsFlights)
{
  // T = sqrt(2 h_0/g) (1 + e)/(1 - e). A bounce is late or early by at most a step, which the later ones inherit by
  // e^n: h/(1 - e) for the impacts and as much for the tops. Then bounces of a step each, from g h to the 1e-9 m/s that
  // counts as rest here.
  for (const double e : {0.3, 0.6, 0.8})
  {
    const double height = 0.3;
    const double exact = std::sqrt(2.0 * height / GRAVITY) * (1.0 + e) / (1.0 - e);
    for (const double h : {2e-3, 1e-3, 5e-4, 2.5e-4})
    {
      const double last_bounces = std::log(GRAVITY * h / 1e-9) / std::log(1.0 / e);
      EXPECT_NEAR(timeToRest(e, height, h), exact + 0.5 * last_bounces * h, (0.5 * last_bounces + 2.0 / (1.0 - e)) * h)
          << "e " << e << " h " << h;
    }
  }
}

TEST(ChatterTest, RandomBodiesWithRestitutionEndAtRest)
{
  // Corners that hit in turn, ever faster: after finitely many steps all is still, and stays so to the bit.
  Dice dice(2718);
  for (int trial = 0; trial < 5; ++trial)
  {
    const double friction = dice.uniform(0.2, 0.9);
    Scenario scenario = groundScene(friction, dice.uniform(0.2, 0.6));
    scenario.stopping.tolerance = 1e-10;
    const Eigen::Vector3d size = Eigen::Vector3d::Constant(0.2) + dice.vector(0.1);
    const Eigen::Vector3d axis = dice.vector(1.0).normalized();
    BodySpec& box = addBody(scenario, "box", boxUrdf(size, 1.0), poseAt(0.0, 0.0, 0.4));
    box.pose->linear() = Eigen::AngleAxisd(dice.uniform(0.0, 1.5), axis).toRotationMatrix();
    AuditedSimulator simulator(scenario);
    for (int step = 0; step < 4000; ++step)
      ASSERT_TRUE(simulator.step().converged()) << "trial " << trial << " step " << step;
    EXPECT_LT(simulator.velocity(0).norm(), 1e-9) << "trial " << trial;
    EXPECT_LT(simulator.report().max_penetration, 1e-9);
  }
}

/** A ball that hits the ground of a scene without gravity; the state after the impact. */
class BallImpactTest : public testing::Test
{
protected:
  static constexpr double RADIUS = 0.05;
  static constexpr double MASS = 0.3;

  static Scenario scene(double friction, double e, double e_t, const Eigen::Vector3d& velocity,
                        const Eigen::Vector3d& spin)
  {
    Scenario scenario = groundScene(friction, e);
    scenario.gravity.setZero();
    scenario.materials.fallback.tangential_restitution = e_t;
    BodySpec& ball = addBody(scenario, "ball", sphereUrdf(RADIUS, MASS), poseAt(0.0, 0.0, RADIUS));
    ball.linear_velocity = velocity;
    ball.angular_velocity = spin;
    return scenario;
  }
};

TEST_F(BallImpactTest, TurnsItsSlipRoundWhereTheConeAllowsItElseSlides)
{
  // Of a ball W_TT = 7/(2 m): r_T = -(2/7) m (1 + e_T) u_T while |r_T| <= mu r_N, r_N = (1 + e) m |v_N|; beyond,
  // Coulomb.
  Dice dice(115);
  int turned = 0;
  int slid = 0;
  for (int trial = 0; trial < 200; ++trial)
  {
    const double mu = dice.uniform(0.02, 1.0);
    const double e = trial % 5 == 0 ? 0.0 : dice.uniform(0.0, 1.0);
    const double e_t = trial % 7 == 0 ? 1.0 : dice.uniform(0.0, 1.0);
    Eigen::Vector3d velocity = dice.vector(2.0);
    velocity.z() = -dice.uniform(0.5, 3.0);
    const Eigen::Vector3d spin = dice.vector(40.0);
    const Simulator simulator(scene(mu, e, e_t, velocity, spin));
    ASSERT_TRUE(simulator.outcome().converged()) << simulator.outcome().message;
    Eigen::Vector3d slip = velocity + spin.cross(Eigen::Vector3d(0.0, 0.0, -RADIUS));
    slip.z() = 0.0;
    const double normal = -(1.0 + e) * MASS * velocity.z();
    const double wanted = 2.0 / 7.0 * MASS * (1.0 + e_t) * slip.norm();
    const double tangential = std::min(wanted, mu * normal);
    (wanted < mu * normal ? turned : slid)++;
    const Eigen::Vector3d impulse = normal * Eigen::Vector3d::UnitZ() - tangential * slip.normalized();
    const Eigen::Vector3d turn = Eigen::Vector3d(0.0, 0.0, -RADIUS).cross(impulse) / (0.4 * MASS * RADIUS * RADIUS);
    const Eigen::VectorXd after = simulator.velocity(0);
    ASSERT_LT((after.head<3>() - velocity - impulse / MASS).norm(), 1e-10) << "trial " << trial;
    ASSERT_LT((after.tail<3>() - spin - turn).norm(), 1e-8) << "trial " << trial;
    EXPECT_LT(std::abs(simulator.report().energy.balance_error), 1e-12);
  }
  EXPECT_GT(turned, 20);
  EXPECT_GT(slid, 20);
}

TEST_F(BallImpactTest, ASuperballKeepsItsEnergyAndGoesToAndFro)
{
  // e = e_T = 1 and a cone that is wide enough (Garwin 1969): energy is exact, slip turns round at every bounce, and a
  // ball thrown without spin has v_x = 1, 3/7, 1, 3/7, ... An impact in flight acts up to v h above the ground: its arm
  // is off by half of that, v_x by O(h).
  for (const double h : {1e-3, 1e-4})
  {
    Scenario scenario = scene(10.0, 1.0, 1.0, {1.0, 0.0, -1.0}, Eigen::Vector3d::Zero());
    scenario.gravity = {0.0, 0.0, -GRAVITY};
    scenario.time_step = h;
    Simulator simulator(scenario);
    const double energy = simulator.report().energy.kinetic + simulator.report().energy.potential;
    std::vector<double> speeds = {1.0, simulator.velocity(0)[0]};
    EXPECT_NEAR(speeds[1], 3.0 / 7.0, 1e-12);  // at gap 0
    while (simulator.time() < 1.7)
    {
      ASSERT_TRUE(simulator.step().converged());
      if (std::abs(simulator.velocity(0)[0] - speeds.back()) > 0.1)
        speeds.push_back(simulator.velocity(0)[0]);
    }
    EXPECT_NEAR(simulator.report().energy.kinetic + simulator.report().energy.potential, energy, 1e-11 * energy);
    EXPECT_LT(std::abs(simulator.report().energy.balance_error), 1e-11 * energy);
    ASSERT_EQ(speeds.size(), 10U);
    for (size_t i = 0; i < speeds.size(); ++i)
      EXPECT_NEAR(speeds[i], i % 2 == 0 ? 1.0 : 3.0 / 7.0, h / RADIUS) << i;
  }
}

TEST_F(BallImpactTest, TheSmallerValueOfBothSidesCountsUnlessThePairHasItsOwn)
{
  const std::string body = "ground: {friction: 1.0}\nbodies: [{name: block, urdf: " + std::string(PROJECT_DIR) +
                           "/urdf/block.urdf, material: rubber}]\nmaterials: {default: {friction: 1.0, "
                           "tangential_restitution: 0.3}, rubber: {tangential_restitution: 0.8}";
  const Scenario smaller = loadScenario(body + "}", "cell.yaml");
  const auto ofPair = [](const Scenario& scenario)
  { return pairMaterial(scenario.materials, {"rubber"}, {"ground"}).tangential_restitution; };
  EXPECT_EQ(ofPair(smaller), 0.3);
  EXPECT_EQ(pairMaterial(smaller.materials, {"rubber"}, {"rubber"}).tangential_restitution, 0.8);
  const Scenario pair =
      loadScenario(body + ", pairs: [{between: [rubber, ground], tangential_restitution: 0.6}]}", "cell.yaml");
  EXPECT_EQ(ofPair(pair), 0.6);
  for (const std::string value : {"1.5", "-0.1", "soft", ".nan"})
    try
    {
      loadScenario("materials: {default: {tangential_restitution: " + value + "}}\nbodies: []", "cell.yaml");
      ADD_FAILURE() << value << " was taken";
    }
    catch (const std::exception& error)
    {
      EXPECT_THAT(error.what(),
                  testing::AllOf(testing::HasSubstr("cell.yaml"), testing::HasSubstr("tangential_restitution"),
                                 testing::HasSubstr(value)));
    }
}

TEST(TangentialRestitutionTest, RandomBodiesKeepMomentumLedgerAndCones)
{
  for (std::uint32_t seed = 1; seed <= 12; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    const double friction = dice.uniform(0.1, 0.9);
    Scenario scenario = spaceWith(friction, seed % 3 == 0 ? 0.0 : dice.uniform(0.0, 0.8));
    scenario.materials.fallback.tangential_restitution = dice.uniform(0.1, 1.0);
    scenario.stopping.tolerance = 1e-10;
    for (int k = 0; k < 4; ++k)
    {
      const Eigen::Vector3d size = Eigen::Vector3d::Constant(0.15) + dice.vector(0.05);
      const double mass = dice.logUniform(0.1, 10.0);
      BodySpec& body = addBody(scenario, "body" + std::to_string(k),
                               k % 2 == 0 ? boxUrdf(size, mass) : sphereUrdf(size.x() / 2.0, mass), poseAt(0, 0, 0));
      body.pose->translation() = 0.3 * Eigen::Vector3d(k % 2, k / 2, 0.1 * k);
      body.linear_velocity = Eigen::Vector3d(0.15, 0.15, 0.0) - body.pose->translation() + dice.vector(0.1);
      body.angular_velocity = dice.vector(4.0);
    }
    Simulator simulator(scenario);
    const auto momentum = [&]
    {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int body = 0; body < simulator.bodyCount(); ++body)
        sum += simulator.model(body).totalMass() * simulator.velocity(body).head<3>();
      return sum;
    };
    const Eigen::Vector3d start = momentum();
    const double energy = simulator.report().energy.kinetic;
    int impacts = 0;
    for (int step = 0; step < 600; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << step << ": " << simulator.outcome().message;
      for (const ContactState& contact : simulator.contacts())
      {
        const double normal = contact.normal.dot(contact.impulse);
        const Eigen::Vector3d tangential = contact.impulse - normal * contact.normal;
        ASSERT_GE(normal, 0.0);
        ASSERT_LE(tangential.norm(), friction * normal * (1.0 + 1e-6) + 1e-12);
        impacts += contact.mode == ContactMode::IMPACT ? 1 : 0;
      }
    }
    EXPECT_GT(impacts, 0);
    EXPECT_LT((momentum() - start).norm(), 1e-11 * (1.0 + start.norm()));
    EXPECT_LT(std::abs(simulator.report().energy.balance_error), 1e-11 * energy);
  }
}

/** Deepest penetration and height between the first two bounces of a ball dropped from half a metre. */
std::pair<double, double> bounce(ContactLawForm law, double e, double h)
{
  Scenario scenario = groundScene(0.0, e);
  scenario.contact_law = law;
  scenario.time_step = h;
  addBody(scenario, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.6));
  Simulator simulator(scenario);
  double deepest = 0.0;
  double top = 0.0;
  bool has_bounced = false;
  while (simulator.time() < 0.8)
  {
    simulator.step();
    deepest = std::max(deepest, 0.1 - simulator.position(0)[2]);
    has_bounced = has_bounced || simulator.velocity(0)[2] > 0.0;
    if (has_bounced)
      top = std::max(top, simulator.position(0)[2] - 0.1);
  }
  return {deepest, top};
}

TEST(VelocityLawTest, BouncesAsHighAsTheGapLawButSeesTheGroundAStepLate)
{
  // The plain law acts once the midpoint is inside: v h deep at most, and stays so deep with e = 0. The gap law is
  // never inside. Both heights are of order one.
  const double speed = std::sqrt(2.0 * GRAVITY * 0.5);
  for (const double h : {1e-3, 2.5e-4})
    for (const double e : {0.0, 0.7})
    {
      const auto [gap_depth, gap_top] = bounce(ContactLawForm::GAP, e, h);
      const auto [depth, top] = bounce(ContactLawForm::VELOCITY, e, h);
      EXPECT_LT(gap_depth, 1e-12);
      EXPECT_GT(depth, 1e-3 * speed * h);
      EXPECT_LT(depth, 1.5 * speed * h);
      EXPECT_NEAR(gap_top, e * e * 0.5, 4.0 * speed * h);
      EXPECT_NEAR(top, e * e * 0.5, 4.0 * speed * h);
    }
}

TEST(VelocityLawTest, SlidesAndSticksAsTheGapLawOnceItTouches)
{
  // A block that starts on the incline. Round-off lifts it off by 1e-17 m at times: the gap law does not care, the
  // plain one lets it fall for a step, so that its speed is that of the formula to g h only.
  for (const double angle : {0.2, 0.6})
  {
    double speed[2];
    for (const ContactLawForm law : {ContactLawForm::GAP, ContactLawForm::VELOCITY})
    {
      Scenario scenario = groundScene(0.4);
      scenario.contact_law = law;
      incline(scenario, angle);
      addBody(scenario, "block", boxUrdf({0.4, 0.4, 0.02}, 2.0), poseAt(0.0, 0.0, 0.01));
      Simulator simulator(scenario);
      for (int step = 0; step < 300; ++step)
        ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      speed[law == ContactLawForm::GAP ? 0 : 1] = simulator.velocity(0)[0];
    }
    const double expected = std::max(0.0, GRAVITY * (std::sin(angle) - 0.4 * std::cos(angle)) * 0.3);
    EXPECT_NEAR(speed[0], expected, 1e-10);
    EXPECT_NEAR(speed[1], expected, GRAVITY * 1e-3);
  }
}

TEST(JammingTest, AnArmThatFrictionHoldsDoesNotBounceAnyOther)
{
  // An arm on a hinge swings down into the ground. To part it has to slide outwards, against mu r_N: it can where
  // mu < x/z, its foot x beside the hinge and z below; there it leaves at e times its speed. Else no impulse turns it
  // round, Coulomb's problem with restitution has no solution, and it stops.
  Dice dice(29);
  int jammed = 0;
  for (int trial = 0; trial < 40; ++trial)
  {
    const double angle = dice.uniform(0.2, 0.9), length = dice.uniform(0.2, 1.0), radius = 0.02;
    const double e = dice.uniform(0.1, 0.9);
    const double slope = length * std::sin(angle) / (length * std::cos(angle) + radius);
    const double friction = slope * (dice.chance(0.5) ? dice.uniform(0.1, 0.9) : dice.uniform(1.1, 4.0));
    Scenario scenario = groundScene(friction, e);
    scenario.stopping.tolerance = 1e-8;
    BodySpec body;
    body.name = "arm";
    body.urdf_xml = "<robot name='arm'><link name='hinge'/><link name='foot'><inertial><origin xyz='0 0 " +
                    std::to_string(-length) +
                    "'/><mass value='1'/><inertia ixx='1e-3' iyy='1e-3' izz='1e-3' ixy='0' ixz='0' iyz='0'/></inertial>"
                    "<collision><origin xyz='0 0 " +
                    std::to_string(-length) +
                    "'/><geometry><sphere radius='0.02'/></geometry></collision></link><joint name='j' "
                    "type='continuous'><parent link='hinge'/><child link='foot'/><axis xyz='0 1 0'/></joint></robot>";
    body.base = BaseType::FIXED;
    body.pose = poseAt(0.0, 0.0, length * std::cos(angle) + radius);
    body.joints["j"] = {angle + 0.1, 0.0};
    scenario.bodies.push_back(body);
    AuditedSimulator simulator(scenario);
    double before = 0.0;
    do
    {
      before = simulator.velocity(0)[0];
      simulator.step();
      ASSERT_LT(simulator.state().time(), 2.0);
    } while (simulator.velocity(0)[0] < before);
    ASSERT_EQ(simulator.contacts().size(), 1u);
    const bool jams = friction > slope;
    jammed += jams ? 1 : 0;
    EXPECT_EQ(simulator.contacts()[0].restitution, jams ? 0.0 : e);
    for (int step = 0; jams && step < 10; ++step)  // stops where it touches, as without restitution
      simulator.step();
    EXPECT_NEAR(simulator.velocity(0)[0], jams ? 0.0 : -e * before, 1e-6) << angle << " " << friction;
  }
  EXPECT_GT(jammed, 10);
}

}  // namespace
}  // namespace frictional_contact_sim
