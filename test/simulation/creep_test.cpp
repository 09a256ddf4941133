// The opt-in creep law of a rolling contact against its own curve, and what must not change by it.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/allocation_counter.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
constexpr double RADIUS = 0.1;  ///< of the wheels here [m]
constexpr double LOAD = 50.0;  ///< of urdf/wheel_rig.urdf on level ground [N]
const std::string ROOT = PROJECT_DIR;
const std::string CURVE = ROOT + "/config/rolling/creep_curve_example.yaml";

/** Materials with the creep law between `wheel` and `plate`, `wheel` and `ground`. */
Scenario creepScene(const std::string& law = "creep, curve: " + CURVE)
{
  Scenario scene = loadScenario("materials:\n  pairs: [{between: [wheel, plate], law: " + law +
                                    "}, {between: [wheel, ground], law: " + law + "}]\nbodies: []\n",
                                "creep_test.yaml");
  scene.stopping.tolerance = 1e-13;
  return scene;
}

/** The rig of urdf/, `wheel` in place of its cylinder where given. */
BodySpec& addRig(Scenario& scene)
{
  BodySpec& rig = scene.bodies.emplace_back();
  rig.name = "rig";
  rig.urdf_path = ROOT + "/urdf/wheel_rig.urdf";
  rig.base = BaseType::FIXED;
  rig.material = "wheel";
  rig.pose = poseAt(0.0, 0.0, RADIUS);
  return rig;
}

/** A servo that keeps the velocity of a joint against anything here. */
JointCommand driven(double velocity)
{
  JointCommand command;
  command.mode = JointCommand::Mode::VELOCITY;
  command.target = velocity;
  command.kd = 1e8;
  return command;
}

/** The rig's wheel turning on a plate that moves below it; the carriage stands. */
Scenario plateScene(double speed, double creepage)
{
  Scenario scene = creepScene();
  BodySpec& rig = addRig(scene);
  const double turning = speed * (1.0 + 0.5 * creepage) / (1.0 - 0.5 * creepage) / RADIUS;
  rig.joints["axle"] = {0.0, turning};
  rig.commands["axle"] = driven(turning);
  rig.commands["drive"] = driven(0.0);
  BodySpec& plate = addBody(scene, "plate", boxUrdf({4.0, 1.0, 0.1}, 1.0), poseAt(0.0, 0.0, -0.05));
  plate.base = BaseType::FIXED;
  plate.material = "plate";
  plate.motion.emplace(Eigen::Vector3d(-speed, 0.0, 0.0), Eigen::Vector3d::Zero());
  return scene;
}

/** Sum of the contact forces on the wheel. */
Eigen::Vector3d contactForce(const Simulator& simulator)
{
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const ContactState& contact : simulator.contacts())
    force += contact.impulse / simulator.report().dt;
  return force;
}

double jointVelocity(const Simulator& simulator, const std::string& joint)
{
  const MultibodyModel& model = simulator.model(0);
  return simulator.velocity(0)[model.joints[model.findJoint(joint)].v_index];
}

template <typename AnySimulator>
void run(AnySimulator& simulator, int steps)
{
  for (int i = 0; i < steps; ++i)
  {
    simulator.step();
    ASSERT_EQ(simulator.report().status, SolverStatus::CONVERGED) << simulator.report().residual;
    for (const ContactState& contact : simulator.contacts())
      ASSERT_GE(contact.cone_margin, -1e-9 * contact.friction * contact.impulse.norm());  // solver's tolerance
  }
}

class PrescribedCreepTest : public testing::TestWithParam<double>
{
};

TEST_P(PrescribedCreepTest, GivesTheCurvesTraction)
{
  const double speed = 1.0;
  const CreepTable curve = *creepScene().materials.pairs.at({"plate", "wheel"}).creep;
  const double wanted = GetParam() * curve.creepage.back();
  AuditedSimulator simulator(plateScene(speed, wanted));
  run(simulator, 100);
  const double rim = RADIUS * jointVelocity(simulator, "axle");
  const double slip = jointVelocity(simulator, "drive") - rim + speed;
  const double creepage = 2.0 * std::abs(slip) / (rim + speed);
  // The servos of 1e8 N s/m and N m s give way by 15 N and 1.5 N m.
  EXPECT_NEAR(creepage, std::abs(wanted), 1e-6);
  const Eigen::Vector3d force = contactForce(simulator);
  EXPECT_NEAR(force.z(), LOAD, 1e-8);
  // Solver tolerance 1e-13 of 1 m/s on a slip of 1e-5 m/s: 1e-8 of the traction.
  EXPECT_NEAR(force.x(), -std::copysign(0.3 * LOAD * curve.value(creepage), slip), 0.3 * LOAD * 1e-7);
  EXPECT_NEAR(force.y(), 0.0, 0.3 * LOAD * 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Creepage, PrescribedCreepTest, testing::Values(0.2, -0.5, 0.9, 3.0, -40.0));

TEST(CreepTest, DrivenWheelSettlesAtTheCreepageOfItsTraction)
{
  Scenario scene = loadScenarioFile(ROOT + "/config/scenarios/rolling_wheel.yaml");
  scene.stopping.tolerance = 1e-13;
  const CreepTable curve = *scene.materials.pairs.at({"ground", "wheel"}).creep;
  AuditedSimulator simulator(scene);
  run(simulator, 300);
  const double rim = RADIUS * jointVelocity(simulator, "axle");
  const double speed = jointVelocity(simulator, "drive");
  const double creepage = 2.0 * (rim - speed) / (rim + speed);
  EXPECT_NEAR(contactForce(simulator).x(), 9.0, 1e-6);
  EXPECT_NEAR(curve.value(creepage), 0.6, 1e-6);
  // Carter: 1 - sqrt(1 - 0.6) of the last creepage; chords of 32 segments cut off at most (1/32)^2 / 4 of the traction.
  EXPECT_NEAR(creepage / curve.creepage.back(), 1.0 - std::sqrt(0.4), 1.0 / 4096.0 / (2.0 * std::sqrt(0.4)) + 1e-6);
  // Slip times force is lost, no more: 3.67e-5 m/s times 9 N.
  const double before = simulator.report().energy.friction;
  run(simulator, 100);
  EXPECT_NEAR((simulator.report().energy.friction - before) / 0.1, 9.0 * (rim - speed), 1e-8);
  // Constant M: every impulse's work is booked to round-off of the 5 J of the wheel.
  EXPECT_NEAR(simulator.report().energy.balance_error, 0.0, 1e-11);
}

TEST(CreepTest, StepSizeDoesNotMatterInTheSteadyState)
{
  // The traction is taken at the end of the step: stiff (relaxation in 1e-6 s) but without jitter at any step.
  for (const double dt : {1e-4, 1e-3, 1e-2})
  {
    Scenario scene = loadScenarioFile(ROOT + "/config/scenarios/rolling_wheel.yaml");
    scene.stopping.tolerance = 1e-13;
    scene.time_step = dt;
    AuditedSimulator simulator(scene);
    run(simulator, 100);
    for (int i = 0; i < 20; ++i)
    {
      simulator.step();
      EXPECT_NEAR(contactForce(simulator).x(), 9.0, 1e-6) << dt;
    }
  }
}

TEST(CreepTest, CurvesWithFlatAndConvexPartsAreMetToo)
{
  auto table = std::make_shared<CreepTable>();
  table->friction = 0.3;
  table->reference_load = 1000.0;
  table->creepage = {0.0, 1e-5, 2e-5, 5e-5, 1e-4};
  table->traction = {0.0, 0.05, 0.5, 0.5, 1.0};
  Scenario scene = loadScenarioFile(ROOT + "/config/scenarios/rolling_wheel.yaml");
  scene.stopping.tolerance = 1e-13;
  for (auto& [between, material] : scene.materials.pairs)
    material.creep = table;
  AuditedSimulator simulator(scene);
  run(simulator, 200);
  const double rim = RADIUS * jointVelocity(simulator, "axle");
  const double speed = jointVelocity(simulator, "drive");
  EXPECT_NEAR(2.0 * (rim - speed) / (rim + speed), 6e-5, 1e-9);  // 0.6 lies on the last segment
}

TEST(CreepTest, StartsFromRestAsARollingWheelDoes)
{
  Scenario scene = loadScenarioFile(ROOT + "/config/scenarios/rolling_wheel.yaml");
  scene.stopping.tolerance = 1e-13;
  scene.bodies[0].joints.clear();
  scene.bodies[0].wrenches.clear();
  AuditedSimulator simulator(scene);
  run(simulator, 500);
  // Torque over radius moves fork, wheel, the wheel's turning inertia and the carriage of 0.1 kg; creep costs 1e-4.
  const double mass = LOAD / GRAVITY + 0.1 + 0.01 / (RADIUS * RADIUS);
  EXPECT_NEAR(jointVelocity(simulator, "drive"), 0.5 * 9.0 / mass, 1e-4);
  EXPECT_LT(jointVelocity(simulator, "drive"), RADIUS * jointVelocity(simulator, "axle"));
}

TEST(CreepTest, LockedWheelSlidesWithCoulombsFriction)
{
  Scenario scene = plateScene(1.0, 0.0);
  scene.bodies[0].joints["axle"] = {0.0, 0.0};
  scene.bodies[0].commands["axle"] = driven(0.0);
  AuditedSimulator simulator(scene);
  run(simulator, 50);
  EXPECT_NEAR(contactForce(simulator).x(), -0.3 * LOAD, 1e-7);
}

TEST(CreepTest, SphereRollingOnASphereTransmitsItsCurve)
{
  // Two balls of 0.1 m and 0.3 m turn about fixed axes; both surfaces run at about 1 m/s, c = 0.
  Scenario scene = creepScene();
  scene.gravity.setZero();
  const auto wheel = [](double radius, const std::string& more)
  {
    return "<robot name='w'><link name='rail'/><link name='w'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' "
           "ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial><collision><geometry><sphere radius='" +
           std::to_string(radius) + "'/></geometry></collision></link>" + more + "</robot>";
  };
  const std::string axle =
      "<joint name='axle' type='continuous'><parent link='rail'/><child link='w'/>"
      "<axis xyz='0 1 0'/></joint>";
  const std::string pressed =
      "<link name='fork'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' "
      "izz='0.01'/></inertial></link><joint name='lift' type='prismatic'><parent link='rail'/><child link='fork'/>"
      "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='100' velocity='9'/></joint><joint name='axle' "
      "type='continuous'><parent link='fork'/><child link='w'/><axis xyz='0 1 0'/></joint>";
  BodySpec& upper = addBody(scene, "upper", wheel(0.1, pressed), poseAt(0.0, 0.0, 0.4));
  upper.base = BaseType::FIXED;
  upper.material = "wheel";
  upper.joints["axle"] = {0.0, 10.0};
  upper.commands["axle"] = driven(10.0);
  upper.wrenches.push_back({});
  upper.wrenches.back().link = "fork";
  upper.wrenches.back().force.z() = -LOAD;
  const double creepage = 0.4e-4;
  BodySpec& lower = addBody(scene, "lower", wheel(0.3, axle), poseAt(0.0, 0.0, 0.0));
  lower.base = BaseType::FIXED;
  lower.material = "plate";
  lower.joints["axle"] = {0.0, -1.0 / 0.3 * (1.0 - creepage)};
  lower.commands["axle"] = driven(-1.0 / 0.3 * (1.0 - creepage));
  const CreepTable curve = *scene.materials.pairs.at({"plate", "wheel"}).creep;
  AuditedSimulator simulator(scene);
  run(simulator, 50);
  const double rim_a = 0.1 * simulator.velocity(0)[1];
  const double rim_b = -0.3 * simulator.velocity(1)[0];
  const double expected = 0.3 * LOAD * curve.value(2.0 * std::abs(rim_a - rim_b) / (rim_a + rim_b));
  EXPECT_GT(expected, 1.0);
  EXPECT_NEAR(std::abs(contactForce(simulator).x()), expected, 0.3 * LOAD * 1e-7);
}

TEST(CreepTest, SidewaysTheWheelHoldsAsCoulombSays)
{
  // A ball rolls along x at the curve's creepage and is pushed along y by less than friction can take.
  Scenario scene = creepScene();
  scene.ground = GroundSpec{};
  BodySpec& rig = addRig(scene);
  std::ifstream file(rig.urdf_path);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::string y_slide =
      "<joint name='side' type='prismatic'><parent link='fork'/><child link='holder'/><axis xyz='0 1 0'/><limit "
      "lower='-1' upper='1' effort='100' velocity='9'/></joint><link name='holder'><inertial><mass "
      "value='0.5'/><inertia "
      "ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>";
  text.replace(text.find("<parent link=\"fork\"/>\n    <child link=\"wheel\"/>"), 21, "<parent link=\"holder\"/>");
  text.replace(text.find("</robot>"), 8, y_slide + "</robot>");
  rig.urdf_path.clear();
  rig.urdf_xml = text;
  rig.joints["drive"] = {0.0, 1.0};
  rig.joints["axle"] = {0.0, 10.0};
  JointCommand torque;
  torque.target = 0.5;
  rig.commands["axle"] = torque;
  ExternalWrench wrench;
  wrench.link = "holder";
  wrench.force = {-5.0, 8.0, 0.0};
  rig.wrenches.push_back(wrench);
  AuditedSimulator simulator(scene);
  run(simulator, 200);
  EXPECT_NEAR(contactForce(simulator).x(), 5.0, 1e-6);
  EXPECT_NEAR(contactForce(simulator).y(), -8.0, 1e-6);
  EXPECT_NEAR(jointVelocity(simulator, "side"), 0.0, 1e-10);
  EXPECT_GT(RADIUS * jointVelocity(simulator, "axle") - jointVelocity(simulator, "drive"), 1e-6);
}

TEST(CreepTest, WheelAtRestStaysAtRest)
{
  Scenario scene = creepScene();
  scene.ground = GroundSpec{};
  addRig(scene).commands["axle"] = driven(0.0);
  ExternalWrench push;
  push.link = "fork";
  push.force.x() = 14.0;  // friction takes 15 N, and the brake on the axle holds
  scene.bodies[0].wrenches.push_back(push);
  AuditedSimulator simulator(scene);
  run(simulator, 1000);
  // The brake is a damper of 1e8 N m s: 1.4 N m turn it by 1.4e-8 rad/s, and the wheel follows: that is at rest.
  EXPECT_NEAR(jointVelocity(simulator, "drive"), 1.4e-9, 1e-11);
  EXPECT_NEAR(contactForce(simulator).x(), -14.0, 1e-6);
  simulator.clearWrenches();
  run(simulator, 10);
  EXPECT_NEAR(simulator.velocity(0).norm(), 0.0, 1e-12);
  EXPECT_NEAR(contactForce(simulator).x(), 0.0, 1e-9);
}

TEST(CreepTest, OtherPairsKeepTheirBits)
{
  // A creep curve in the table, but not between these bodies: every bit is as without it.
  const auto hash = [](bool with_curve)
  {
    Scenario scene = loadScenarioFile(ROOT + "/config/scenarios/quadruped.yaml");
    if (with_curve)
      scene.materials.pairs = creepScene().materials.pairs;
    AuditedSimulator simulator(scene);
    run(simulator, 300);
    return simulator.stateHash();
  };
  EXPECT_EQ(hash(false), hash(true));
}

TEST(CreepTest, LawCoulombIsTheDefault)
{
  Scenario scene = plateScene(1.0, 0.5e-4);
  scene.materials = creepScene("coulomb, friction: 0.3").materials;
  AuditedSimulator simulator(scene);
  run(simulator, 20);
  EXPECT_NEAR(std::abs(contactForce(simulator).x()), 0.3 * LOAD, 1e-7);  // any prescribed slip is sliding
}

TEST(CreepTest, StepsDoNotAllocate)
{
  Simulator simulator(loadScenarioFile(ROOT + "/config/scenarios/rolling_wheel.yaml"));
  run(simulator, 50);
  const test_support::AllocationCounter counter;
  for (int i = 0; i < 100; ++i)
    simulator.step();
  EXPECT_EQ(counter.count(), 0);
}

TEST(CreepCurveFileTest, IsReadWithTheKeysTheRollingToolWrites)
{
  const std::string path = testing::TempDir() + "tool_curve.yaml";
  std::ofstream(path) << "creep_curve:\n  friction: 0.25\n  reference_load: 500  # N per metre of width\n"
                         "  young_modulus: 94500\n  poisson_ratio: 0.1\n  radius: 0.1\n"
                         "  creepage: [0, 1e-3, 2e-3, 3e-3]\n  traction: [0, 0.75, 1, 1]\n";
  const Scenario scene = creepScene("creep, restitution: 0.2, curve: " + path);
  const Material& material = scene.materials.pairs.at({"plate", "wheel"});
  EXPECT_EQ(material.friction, 0.25);
  EXPECT_EQ(material.restitution, 0.2);
  EXPECT_EQ(material.creep->reference_load, 500.0);
  EXPECT_DOUBLE_EQ(material.creep->value(0.5e-3), 0.375);
  EXPECT_EQ(material.creep->value(2.5e-3), 1.0);
  EXPECT_NEAR(material.creep->slope(1.5e-3), 250.0, 1e-9);
}

struct BadCurve
{
  const char* name;
  const char* text;
  const char* key;
  const char* found;
};

class BadCreepCurveTest : public testing::TestWithParam<BadCurve>
{
};

TEST_P(BadCreepCurveTest, IsOneClearLine)
{
  const std::string path = testing::TempDir() + "bad_curve_" + GetParam().name + ".yaml";
  std::ofstream(path) << GetParam().text;
  try
  {
    creepScene("creep, curve: " + path);
    FAIL() << "accepted";
  }
  catch (const ScenarioError& error)
  {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().key), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().found), std::string::npos) << message;
    EXPECT_NE(message.find("expected"), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadCreepCurveTest,
    testing::Values(
        BadCurve{"no_map", "creepage: [0, 1]\n", "creepage", "unknown key"},
        BadCurve{"negative_mu",
                 "creep_curve: {friction: -0.3, reference_load: 1, creepage: [0, 1], traction: [0, 1]}\n",
                 "creep_curve.friction", "-0.3"},
        BadCurve{"no_load", "creep_curve: {friction: 0.3, creepage: [0, 1], traction: [0, 1]}\n",
                 "creep_curve.reference_load", "nothing"},
        BadCurve{"short", "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0], traction: [0, 1]}\n",
                 "creep_curve.creepage", "1 entries"},
        BadCurve{"lengths", "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0, 1, 2], traction: [0, 1]}\n",
                 "creep_curve.traction", "2 entries"},
        BadCurve{"descending",
                 "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0, 2, 1], traction: [0, 0.5, 1]}\n",
                 "creep_curve.creepage[2]", "'1'"},
        BadCurve{
            "falling",
            "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0, 1, 2, 3], traction: [0, 0.6, 0.5, 1]}\n",
            "creep_curve.traction[2]", "'0.5'"},
        BadCurve{"offset", "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0, 1], traction: [0.1, 1]}\n",
                 "creep_curve.traction[0]", "'0.1'"},
        BadCurve{"end", "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0, 1], traction: [0, 0.9]}\n",
                 "creep_curve.traction[1]", "'0.9'"},
        BadCurve{"word", "creep_curve: {friction: 0.3, reference_load: 1, creepage: [0, x], traction: [0, 1]}\n",
                 "creep_curve.creepage[1]", "'x'"}),
    [](const testing::TestParamInfo<BadCurve>& info) { return info.param.name; });

TEST(BadCreepPairTest, IsOneClearLine)
{
  const auto message = [](const std::string& law) -> std::string
  {
    try
    {
      creepScene(law);
    }
    catch (const ScenarioError& error)
    {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(message("sticky").find("expected coulomb or creep"), std::string::npos) << message("sticky");
  EXPECT_NE(message("creep").find("expected curve: FILE"), std::string::npos) << message("creep");
  EXPECT_NE(message("creep, curve: nowhere.yaml").find("nowhere.yaml"), std::string::npos);
  EXPECT_NE(message("coulomb, curve: a.yaml").find("expected none"), std::string::npos);
  EXPECT_NE(message("creep, friction: 0.5, curve: " + CURVE).find("expected the curve's friction"), std::string::npos);
}
}  // namespace
}  // namespace frictional_contact_sim
