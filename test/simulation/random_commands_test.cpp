// A robot whose joints are sent to random places, some of them absurd, hundreds of times a second: every step audited.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/body.h"
#include "scene.h"
#include "support/audited_simulator.h"
#include "support/dice.h"
#include "support/long_seeds.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::AuditedSimulator;
using test_support::Dice;

constexpr int STEPS = 2000;

/** The quadruped with straight legs, in the air or a little in the ground. */
Scenario quadruped(double height)
{
  Scenario scenario;
  scenario.ground = GroundSpec{};
  BodySpec body;
  body.name = "quadruped";
  body.urdf_path = std::string(PROJECT_DIR) + "/urdf/quadruped.urdf";
  body.pose = poseAt(0.0, 0.0, height);
  body.hold_initial_position = true;
  scenario.bodies.push_back(body);
  return scenario;
}

class RandomCommandsTest : public testing::TestWithParam<std::uint32_t>
{
};

TEST_P(RandomCommandsTest, EveryStepHasAnAnswer)
{
  Dice dice(GetParam());
  const Scenario scenario = quadruped(dice.uniform(0.45, 0.7));
  const double commands_a_step = dice.uniform(0.1, 1.0);
  AuditedSimulator simulator(scenario);
  const MultibodyModel& model = simulator.model(0);
  std::vector<int> joints;
  for (int joint = 0; joint < static_cast<int>(model.joints.size()); ++joint)
    if (simulator.command(0, joint).mode == JointCommand::Mode::POSITION)
      joints.push_back(joint);
  ASSERT_EQ(joints.size(), 12u);
  for (int step = 1; step <= STEPS; ++step)
  {
    if (dice.chance(commands_a_step))
    {
      const int joint = joints[static_cast<size_t>(dice.integer(0, 11))];
      const double wanted = (dice.chance(0.5) ? 1.0 : -1.0) * std::pow(10.0, dice.uniform(-3.0, 300.0));
      JointCommand command = simulator.command(0, joint);
      command.target =
          reachableTarget(model.joints[joint].limit, simulator.position(0)[model.joints[joint].q_index], wanted);
      simulator.setCommand(0, joint, command);
    }
    const StepOutcome& outcome = simulator.step();
    ASSERT_TRUE(outcome.converged()) << "step " << step << ": " << outcome.message << ", residual " << outcome.residual;
  }
}

// Of 120 runs like these three ended in a step without an answer. What solves those was chosen on other seeds.
INSTANTIATE_TEST_SUITE_P(Seeds, RandomCommandsTest, testing::Range(1U, 25U));
INSTANTIATE_TEST_SUITE_P(Long, RandomCommandsTest, testing::ValuesIn(test_support::longSeeds()));

}  // namespace
}  // namespace frictional_contact_sim
