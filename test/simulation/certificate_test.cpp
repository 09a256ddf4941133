/**
 * @file certificate_test.cpp
 * @brief Verdicts on existence in a simulation, their warnings, and thresholds of scenarios.
 */
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/threshold.h"

using namespace frictional_contact_sim;

namespace
{
const std::string SCENARIOS = std::string(PROJECT_DIR) + "/config/scenarios/";

std::string incline(double degrees)
{
  const double angle = degrees * M_PI / 180.0;
  return "time_step: 0.002\nduration: 0.3\n"
         "gravity: [" +
         std::to_string(9.81 * std::sin(angle)) + ", 0, " + std::to_string(-9.81 * std::cos(angle)) +
         "]\nground: {}\nbodies:\n  - name: box\n    urdf: " + std::string(PROJECT_DIR) +
         "/urdf/block.urdf\n    pose: {xyz: [0, 0, 0.1]}\n";
}
}  // namespace

TEST(StepCertificateTest, PlatesThatCrushABlockAreForeseenThenRefutedAndNamed)
{
  Scenario scenario = loadScenarioFile(SCENARIOS + "crushed_block.yaml");
  Simulator simulator(scenario);
  double first_warning = -1.0, first_refusal = -1.0, foreseen = 0.0;
  for (int step = 0; step < 110; ++step)
  {
    simulator.step();
    const StepCertificate& certificate = simulator.report().certificate;
    ASSERT_TRUE(certificate.checked);
    EXPECT_EQ(certificate.step, simulator.report().step);
    if (first_warning < 0.0 && !certificate.warning.empty())
    {
      first_warning = certificate.time;
      foreseen = certificate.time + certificate.seconds_left;
      EXPECT_EQ(certificate.existence, Existence::CERTIFIED);
      EXPECT_NE(certificate.warning.find("left_plate"), std::string::npos) << certificate.warning;
    }
    if (first_refusal < 0.0 && certificate.existence == Existence::REFUTED)
    {
      first_refusal = certificate.time;
      const std::string names = joinNames(certificate.blocking);
      EXPECT_NE(names.find("left_plate"), std::string::npos) << names;
      EXPECT_NE(names.find("right_plate"), std::string::npos) << names;
      EXPECT_EQ(names.find("ground"), std::string::npos) << names;
      for (const NamedRow& row : certificate.blocking)
        EXPECT_NEAR(std::abs(row.position.x()), 0.025, 1e-3);
      EXPECT_NE(simulator.outcome().status, SolverStatus::CONVERGED);
    }
    EXPECT_EQ(certificate.existence, first_refusal > 0.0 ? Existence::REFUTED : Existence::CERTIFIED)
        << certificate.message;
  }
  EXPECT_NEAR(first_refusal, 0.1, 0.003);  // 1 mm at 0.01 m/s on either side
  EXPECT_GT(first_warning, 0.0);
  EXPECT_LT(first_warning, first_refusal);
  EXPECT_NEAR(foreseen, first_refusal, 0.003);
}

TEST(StepCertificateTest, AGripperWithLimitedEffortIsCertifiedInEveryStep)
{
  Simulator simulator(loadScenarioFile(SCENARIOS + "gripped_block.yaml"));
  for (int step = 0; step < 150; ++step)
  {
    ASSERT_TRUE(simulator.step().converged());
    const StepCertificate& certificate = simulator.report().certificate;
    ASSERT_EQ(certificate.existence, Existence::CERTIFIED) << certificate.message;
    EXPECT_TRUE(certificate.warning.empty()) << certificate.warning;
    if (certificate.rows > 0)
    {
      EXPECT_GT(certificate.margin, 0.0);
    }
  }
  const StepCertificate& certificate = simulator.report().certificate;
  EXPECT_GT(certificate.rows, certificate.rank);  // eight points on two pads
  EXPECT_GT(certificate.condition, 1.0);
}

TEST(StepCertificateTest, VerdictsChangeNoBitAndNothingIsCheckedUnlessAskedFor)
{
  Scenario scenario = loadScenarioFile(SCENARIOS + "gripped_block.yaml");
  scenario.certify_every = 0;
  Simulator plain(scenario);
  scenario.certify_every = 3;
  Simulator checked(scenario);
  for (int step = 1; step <= 30; ++step)
  {
    plain.step();
    checked.step();
    EXPECT_EQ(plain.stateHash(), checked.stateHash());
    EXPECT_FALSE(plain.report().certificate.checked);
    EXPECT_EQ(checked.report().certificate.checked, step % 3 == 0);
  }
  EXPECT_EQ(plain.certify().existence, Existence::CERTIFIED);
  plain.setCertifyEvery(1);
  plain.step();
  EXPECT_TRUE(plain.report().certificate.checked);
  EXPECT_THROW(plain.setCertifyEvery(-1), std::invalid_argument);
}

TEST(MarginTrendTest, IsTheSlopeOfTheLastChecks)
{
  MarginTrend trend;
  EXPECT_EQ(trend.rate(), 0.0);
  for (int k = 0; k < 20; ++k)
    trend.add(0.1 * k, k < 10 ? 5.0 : 5.0 - 2.0 * 0.1 * (k - 10));
  EXPECT_NEAR(trend.rate(), -2.0, 1e-12);
  trend.add(0.05, 1.0);  // time was set back
  EXPECT_EQ(trend.rate(), 0.0);
}

TEST(ThresholdTest, ABoxOnAnInclineHoldsAboveTheTangentOfItsAngle)
{
  const Scenario base = loadScenario(incline(25.0), "incline.yaml");
  const HoldExpression expression("max_speed < 1e-6");
  ThresholdOptions options;
  options.from = 0.1;
  options.to = 0.9;
  options.tolerance = 1e-3;
  const ThresholdResult result = findThreshold(options,
                                               [&](double friction)
                                               {
                                                 Scenario scenario = base;
                                                 scenario.materials.fallback.friction = friction;
                                                 const RunRecord record = recordRun(scenario);
                                                 expression.check(record.quantities);
                                                 return record.solved && expression.holds(record.quantities);
                                               });
  ASSERT_NE(result.widest(), nullptr);
  EXPECT_TRUE(result.monotone);
  EXPECT_TRUE(result.widest()->open_above);
  EXPECT_NEAR(result.widest()->from, std::tan(25.0 * M_PI / 180.0), 1e-3);
  EXPECT_LE(result.widest()->from - result.widest()->fails_below, 0.8e-3 * (1.0 + 1e-9));
  EXPECT_EQ(result.widest()->to, 0.9);
}

TEST(ThresholdTest, WhatIsNotMonotoneIsSaid)
{
  ThresholdOptions options;
  options.from = -2.0;
  options.to = 2.0;
  options.samples = 9;
  options.tolerance = 1e-6;
  const ThresholdResult band = findThreshold(options, [](double x) { return x > -0.3 && x <= 0.8; });
  ASSERT_EQ(band.intervals.size(), 1u);
  EXPECT_FALSE(band.monotone);
  EXPECT_NEAR(band.intervals[0].from, -0.3, 4e-6);
  EXPECT_NEAR(band.intervals[0].to, 0.8, 4e-6);
  EXPECT_GT(band.intervals[0].fails_above, 0.8);
  const ThresholdResult two = findThreshold(options, [](double x) { return std::abs(x) > 1.2; });
  ASSERT_EQ(two.intervals.size(), 2u);
  EXPECT_TRUE(two.intervals[0].open_below);
  EXPECT_TRUE(two.intervals[1].open_above);
  EXPECT_EQ(findThreshold(options, [](double) { return false; }).widest(), nullptr);
  const ThresholdResult all = findThreshold(options, [](double) { return true; });
  EXPECT_TRUE(all.monotone);
  EXPECT_EQ(all.runs.size(), 9u);
  options.to = -3.0;
  EXPECT_THROW(findThreshold(options, [](double) { return true; }), std::invalid_argument);
}

TEST(ThresholdTest, ExpressionsAreReadAndBadOnesNamed)
{
  const RunQuantities run = {{"max_speed", 0.5}, {"box.z", -1.0}};
  EXPECT_TRUE(HoldExpression("max_speed<=0.5 and box.z < -9e-1").holds(run));
  EXPECT_FALSE(HoldExpression("max_speed < 0.5 && box.z < 0").holds(run));
  EXPECT_THROW(HoldExpression("max_speed"), std::invalid_argument);
  EXPECT_THROW(HoldExpression("max_speed < fast"), std::invalid_argument);
  EXPECT_THROW(HoldExpression(""), std::invalid_argument);
  try
  {
    HoldExpression("max_sped < 1").check(run);
    FAIL();
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("max_speed"), std::string::npos) << error.what();
  }
}

TEST(ThresholdTest, OneNumberOfAScenarioFileIsChanged)
{
  const std::string file = SCENARIOS + "gripped_block.yaml";
  EXPECT_EQ(loadScenarioFile(file, "materials.default.friction", 0.25).materials.fallback.friction, 0.25);
  EXPECT_EQ(loadScenarioFile(file, "materials.rubber.friction", 0.25).materials.fallback.friction, 0.7);
  EXPECT_EQ(loadScenarioFile(file, "bodies.block.pose.xyz.2", 0.375).bodies[1].pose->translation().z(), 0.375);
  EXPECT_EQ(loadScenarioFile(file, "bodies.0.pose.xyz.0", 0.5).bodies[0].pose->translation().x(), 0.5);
  for (const char* wrong :
       {"materials.default.fricton", "bodies.nobody.pose.xyz.2", "bodies", "", "time_step.x", "materials..friction"})
    EXPECT_THROW(loadScenarioFile(file, wrong, 1.0), ScenarioError) << wrong;
}
