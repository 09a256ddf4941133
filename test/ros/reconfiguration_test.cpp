// dynamic_reconfigure's settings without a master; services.py has the running node.
#include "frictional_contact_sim/ros/reconfiguration.h"

#include "frictional_contact_sim/solver/registry.h"
#include "request_bench.h"

namespace frictional_contact_sim
{
namespace
{
TEST(ReconfigurationTest, TheEnumHasTheMethodsOfTheRegistry)
{
  std::string methods;
  for (const auto& description : SimulatorConfig::__getParamDescriptions__())
    if (description->name == "solver")
      methods = description->edit_method;
  for (const SolverEntry& entry : solverRegistry())
    EXPECT_THAT(methods, testing::HasSubstr(std::string("'value': '") + entry.name + "'"));
}

TEST(ReconfigurationTest, WhatIsPresentIsTakenWithoutChangingAnything)
{
  RequestBench bench(robotAndBox(true));
  RequestBench untouched(robotAndBox(true));
  bench.run(10);
  untouched.run(10);
  applyConfig(presentConfig(bench.simulator, 1.0), bench.simulator);
  bench.run(10);
  untouched.run(10);
  EXPECT_EQ(bench.simulator.stateHash(), untouched.simulator.stateHash());
}

TEST(ReconfigurationTest, AllIsSetAndTold)
{
  RequestBench bench(robotAndBox(true));
  SimulatorConfig config = presentConfig(bench.simulator, 1.0);
  config.time_step = 0.002;
  config.gravity_x = 1.5;
  config.gravity_y = -0.5;
  config.gravity_z = -3.0;
  config.solver = "gauss_seidel";
  config.tolerance = 1e-9;
  config.default_friction = 0.25;
  applyConfig(config, bench.simulator);
  const SimulatorConfig told = presentConfig(bench.simulator, 1.0);
  EXPECT_EQ(told.time_step, 0.002);
  EXPECT_EQ(told.gravity_x, 1.5);
  EXPECT_EQ(told.gravity_y, -0.5);
  EXPECT_EQ(told.gravity_z, -3.0);
  EXPECT_EQ(told.solver, "gauss_seidel");
  EXPECT_EQ(told.tolerance, 1e-9);
  EXPECT_EQ(told.default_friction, 0.25);
  bench.run(1);
  EXPECT_EQ(bench.simulator.report().solver, "gauss_seidel");
  EXPECT_NEAR(bench.simulator.time(), 0.002, 1e-15);
}

TEST(ReconfigurationTest, OneBadValueIsRefusedWithAllOthers)
{
  const std::pair<const char*, void (*)(SimulatorConfig&)> changes[] = {
      {"time_step: found 0", [](auto& config) { config.time_step = 0.0; }},
      {"gravity: found nan", [](auto& config) { config.gravity_z = NOT_A_NUMBER; }},
      {"real_time_factor: found -1", [](auto& config) { config.real_time_factor = -1.0; }},
      {"tolerance", [](auto& config) { config.tolerance = 0.0; }},
      {"portfolio", [](auto& config) { config.solver = "portfolo"; }},
      {"default_friction: found -0.5", [](auto& config) { config.default_friction = -0.5; }},
  };
  RequestBench bench(robotAndBox(true));
  for (const auto& [reason, change] : changes)
  {
    SimulatorConfig config = presentConfig(bench.simulator, 1.0);
    config.gravity_x = 2.0;
    change(config);
    bench.expectRefused(reason, [&, &wanted = config] { applyConfig(wanted, bench.simulator); });
    EXPECT_EQ(bench.simulator.scenario().gravity.x(), 0.0);
  }
}

}  // namespace
}  // namespace frictional_contact_sim
