// Figure 3.4 of Cadoux 2009: where all that surrounds the loose bodies moves as one rigid thing, that motion proves
// that every step has a solution (silo, vibrating plate, washing drum).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::AuditedSimulator;

class OuterMotionTest : public testing::TestWithParam<const char*>
{
};

/** Velocities of all bodies when the loose ones, single links about their centres, go with the first body. */
Eigen::VectorXd outerMotion(const Simulator& simulator)
{
  const Body& outer = simulator.workspace(0);
  Eigen::VectorXd v(simulator.problem().velocities());
  for (int body = 1; body < simulator.bodyCount(); ++body)
  {
    const Body& loose = simulator.workspace(body);
    const Eigen::Vector3d arm =
        loose.middle.link_pose.front().translation() - outer.middle.link_pose.front().translation();
    v.segment<3>(loose.v_offset) = outer.base.linear + outer.base_turn * arm;
    v.segment<3>(loose.v_offset + 3) = outer.base.angular;
  }
  return v;
}

TEST_P(OuterMotionTest, ProvesThatEveryStepHasASolution)
{
  Scenario scenario = loadScenarioFile(std::string(PROJECT_DIR) + "/config/scenarios/" + GetParam() + ".yaml");
  scenario.certify_every = 10;
  AuditedSimulator simulator(scenario);
  int most = 0;
  int certified = 0;
  for (int step = 0; step < 600; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << step << ": " << simulator.outcome().message;
    const IncrementalProblem& problem = simulator.problem();
    if (problem.rows() == 0)
      continue;
    most = std::max(most, static_cast<int>(simulator.contacts().size()));
    // Against what surrounds them the bodies then rest: u = H v + w is the shift of the normal law and nothing else.
    // The drum's points end a step on its circle, on chords: dt omega^2 r/2 = 1.5e-3 m/s is missing from a rigid
    // motion.
    const Eigen::VectorXd u = problem.H * outerMotion(simulator) + problem.w;
    const bool turns = std::string(GetParam()) == "washing_drum";
    int row = 0;
    for (size_t i = 0; i < problem.laws.size(); ++i)
    {
      const double shift = simulator.contacts()[i].row_gap / simulator.report().dt;
      ASSERT_NEAR(u[row], shift, turns ? 2e-3 : 1e-9 * (1.0 + std::abs(shift))) << step;
      if (problem.laws[i].dimension() == 3)
      {
        ASSERT_LT(u.segment<2>(row + 1).norm(), turns ? 2e-3 : 1e-9) << step;
      }
      row += problem.laws[i].dimension();
    }
    if (simulator.report().certificate.checked)
    {
      ++certified;
      ASSERT_EQ(simulator.report().certificate.existence, Existence::CERTIFIED) << step;
    }
  }
  EXPECT_GT(most, 12);
  EXPECT_GT(certified, 25);
}

INSTANTIATE_TEST_SUITE_P(Figure, OuterMotionTest, testing::Values("silo", "vibrating_plate", "washing_drum"),
                         [](const testing::TestParamInfo<const char*>& info) { return std::string(info.param); });

}  // namespace
}  // namespace frictional_contact_sim
