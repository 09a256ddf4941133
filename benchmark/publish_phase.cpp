// The publishing phase of one step: filling and serializing the messages that a recorder of every step receives.
#include <benchmark/benchmark.h>
#include <ros/serialization.h>

#include <cstdint>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace fcs = frictional_contact_sim;

namespace
{
template <class Message>
void serialize(const Message& message, std::vector<std::uint8_t>& buffer)
{
  buffer.resize(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(buffer.data(), static_cast<std::uint32_t>(buffer.size()));
  ros::serialization::serialize(stream, message);
  benchmark::DoNotOptimize(buffer.data());
}

void publish(benchmark::State& state)
{
  fcs::Simulator simulator(fcs::loadScenarioFile(PROJECT_DIR "/config/scenarios/quadruped.yaml"));
  while (simulator.time() < 1.0)
    simulator.step();
  const fcs::NameTable names = fcs::makeNameTable(simulator);
  const ros::Time stamp = fcs::toStamp(simulator.time());
  sensor_msgs::JointState joints;
  fcs::ContactArray contacts;
  fcs::StepReport report;
  nav_msgs::Odometry odometry;
  std::vector<std::uint8_t> buffer;
  for (auto _ : state)
  {
    fcs::fillJointState(simulator, names, stamp, joints);
    serialize(joints, buffer);
    fcs::fillContacts(simulator, names, stamp, contacts);
    serialize(contacts, buffer);
    fcs::fillStepReport(simulator.report(), 1.0, stamp, report);
    serialize(report, buffer);
    fcs::fillOdometry(simulator, names, 0, stamp, odometry);
    serialize(odometry, buffer);
  }
}

BENCHMARK(publish);
}  // namespace

BENCHMARK_MAIN();
