#pragma once
// A simulation without a master, as the handlers of requests see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "frictional_contact_sim/ros/frames.h"
#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();
constexpr double INFINITE = std::numeric_limits<double>::infinity();

inline BodySpec bodyFrom(const std::string& name, const std::string& file, double x, double y, double z)
{
  BodySpec body;
  body.name = name;
  body.urdf_path = std::string(PROJECT_DIR) + "/" + file;
  body.base = BaseType::FLOATING;
  body.pose = Eigen::Isometry3d::Identity();
  body.pose->translation() = Eigen::Vector3d(x, y, z);
  return body;
}

/** A robot of two links (base, arm) and a box of 10 kg, either on the ground or floating in empty space. */
inline Scenario robotAndBox(bool on_ground)
{
  Scenario scenario;
  scenario.name = "robot_and_box";
  scenario.bodies = {bodyFrom("robot", "examples/first_robot/first_robot.urdf", 0.0, 0.0, 0.05),
                     bodyFrom("crate", "test/ros/box_10kg.urdf", 2.0, 0.0, 0.1)};
  if (on_ground)
    scenario.ground = GroundSpec();
  else
    scenario.gravity.setZero();
  return scenario;
}

struct RequestBench
{
  explicit RequestBench(const Scenario& scenario)
    : simulator(scenario), names(makeNameTable(simulator)), frames(simulator, names, false)
  {
  }
  void run(int steps)
  {
    for (int i = 0; i < steps; ++i)
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  }
  /** The request is refused, with `reason` in the message, and the state is the same to the bit. */
  template <typename Call>
  void expectRefused(const std::string& reason, const Call& call)
  {
    const std::uint64_t hash = simulator.stateHash();
    try
    {
      call();
      ADD_FAILURE() << "was taken, expected: " << reason;
    }
    catch (const std::exception& error)
    {
      EXPECT_THAT(error.what(), testing::HasSubstr(reason));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
    EXPECT_EQ(simulator.stateHash(), hash) << reason;
  }

  Simulator simulator;
  NameTable names;
  FrameResolver frames;
};

constexpr int ROBOT = 0;
constexpr int CRATE = 1;
constexpr double DT = 0.001;  // [s]
constexpr double CRATE_MASS = 10.0;  // [kg]
constexpr double CRATE_INERTIA = CRATE_MASS * 0.04 / 6.0;  // of a cube of 0.2 m [kg m^2]

}  // namespace frictional_contact_sim
