#pragma once
/**
 * @file simulator_node.h
 * @brief The ROS node around one Simulator: services, commands and the run in real time. One thread: callbacks are
 * served between steps, so that a run without commands depends on nothing but its input.
 */
#include <frictional_contact_sim/Step.h>
#include <ros/node_handle.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/command_listener.h"
#include "frictional_contact_sim/ros/delivery.h"
#include "frictional_contact_sim/ros/diagnostics.h"
#include "frictional_contact_sim/ros/frames.h"
#include "frictional_contact_sim/ros/pacer.h"
#include "frictional_contact_sim/ros/reconfiguration.h"
#include "frictional_contact_sim/ros/run_summary.h"
#include "frictional_contact_sim/ros/services.h"
#include "frictional_contact_sim/ros/state_services.h"
#include "frictional_contact_sim/ros/step_publisher.h"
#include "frictional_contact_sim/ros/throttle.h"
#include "frictional_contact_sim/ros/trajectory_server.h"
#include "frictional_contact_sim/ros/wrench_services.h"

namespace frictional_contact_sim
{
/** @brief Text of ~parameter, else of the parameter in this namespace or one above, else empty.
 *  @throws ParameterError when it is not a text */
std::string findDescription(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                            const std::string& parameter);

class SimulatorNode
{
public:
  /** @throws ParameterError, ModelError, ScenarioError, std::invalid_argument: one line */
  SimulatorNode(ros::NodeHandle& node, ros::NodeHandle& private_node, const NodeParameters& parameters);

  /** @brief Runs until ~num_steps, a failed step under ~on_failure stop, or a shutdown. @return exit code 0 or 1 */
  int run();

private:
  enum class Outcome
  {
    GO_ON,
    PAUSED,
    FINISHED,
    FAILED
  };

  void advertiseServices();
  void advertiseRequests();
  void setServoGains(int of_body);
  RunState runState() const;
  void addWorldServices();
  void changeBodies(const std::function<void()>& change);

  Outcome advance();
  Outcome judge(const std::string& where);
  void reportFailure(const std::string& where);
  void reportCertificate();
  void runStep();
  void idle();
  bool windowEnds() const;
  void hold(const std::function<void()>& pass);
  bool subscribersStand();
  void setPaused(bool paused);
  void reset();
  void resetTime();
  void showSetState();
  void followSettings(double real_time_factor);
  void takeSteps(const Step::Request& request, Step::Response& response);
  void settle();

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  NodeParameters parameters_;
  Simulator simulator_;
  NameRules name_rules_;
  NameTable names_;
  std::unique_ptr<StepPublisher> publisher_;
  DeliveryMonitor delivery_;
  CommandListener commands_;
  TrajectoryServer trajectories_;
  FrameResolver frames_;
  WrenchListener wrenches_;
  StateSlot saved_state_;
  std::unique_ptr<Reconfiguration> reconfiguration_;
  Pacer pacer_;
  DiagnosticsPublisher diagnostics_;
  RunSummary summary_;
  Throttle failure_lines_;
  Throttle certificate_lines_;
  int dumps_ = 0;
  std::vector<std::string> awaited_topics_;  // resolved
  ServiceTable services_;
  ros::Subscriber lossless_nodes_;
  bool paused_ = false;
  bool waiting_ = false;
  double standing_since_ = std::numeric_limits<double>::infinity();  // wall clock: all awaited subscribers are there
  std::int64_t steps_done_ = 0;
  Outcome outcome_ = Outcome::GO_ON;
};

/**
 * @brief The whole program, without main's frame.
 * @return exit code: 0 done or ended by SIGINT or SIGTERM, which end a long solve too, 1 a step failed (~on_failure
 * stop), 2 bad input
 */
int runSimulatorNode(int argc, char** argv);

}  // namespace frictional_contact_sim
