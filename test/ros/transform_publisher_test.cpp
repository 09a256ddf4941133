// Which frames belong on /tf_static: those that do not move in a run, whatever the body is.
#include "frictional_contact_sim/ros/transform_publisher.h"

#include <gtest/gtest.h>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "request_bench.h"

namespace frictional_contact_sim
{
namespace
{
TEST(TransformPublisherTest, FramesOnTheStaticTopicStayAndTheOthersMove)
{
  Scenario scenario = loadScenario(R"(
bodies:
  - name: falling
    elastic: {box: [0.1, 0.1], cells: [2, 2], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000}
    pose: {xyz: [0, 0, 1]}
  - name: hanging
    elastic: {box: [0.1, 0.1], cells: [2, 2], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000, fixed: [top]}
    pose: {xyz: [1, 0, 1]}
  - name: dragged
    elastic: {box: [0.1, 0.1], cells: [2, 2], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000, fixed: [top]}
    pose: {xyz: [2, 0, 1]}
    motion: {linear: [1, 0, 0]}
  - name: hair
    rod: {length: 0.2, radius: 0.002, density: 1300, young_modulus: 1.0e9}
    pose: {xyz: [3, 0, 1]}
  - name: shaken
    rod: {length: 0.2, radius: 0.002, density: 1300, young_modulus: 1.0e9}
    pose: {xyz: [4, 0, 1]}
    motion: {type: sine, axis: [1, 0, 0], amplitude: 0.001, frequency: 10}
)",
                                   "test");
  scenario.bodies.push_back(bodyFrom("crate", "test/ros/box_10kg.urdf", 5.0, 0.0, 1.0));
  scenario.bodies.push_back(bodyFrom("post", "test/ros/box_10kg.urdf", 6.0, 0.0, 1.0));
  scenario.bodies.back().base = BaseType::FIXED;
  RequestBench bench(scenario);
  std::vector<Eigen::Isometry3d> before;
  for (int body = 0; body < bench.simulator.bodyCount(); ++body)
    before.push_back(bench.simulator.data(body).link_pose.front());
  bench.run(20);
  int fixed = 0;
  for (int body = 0; body < bench.simulator.bodyCount(); ++body)
  {
    const bool stays =
        bench.simulator.data(body).link_pose.front().matrix() == before[static_cast<size_t>(body)].matrix();
    EXPECT_EQ(isStatic(bench.simulator.workspace(body).model, 0), stays) << bench.simulator.bodyName(body);
    fixed += stays ? 1 : 0;
  }
  EXPECT_EQ(fixed, 3);
}

}  // namespace
}  // namespace frictional_contact_sim
