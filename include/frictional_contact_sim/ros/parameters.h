#pragma once
/**
 * @file parameters.h
 * @brief The node's private parameters as one struct; a pure function reads and checks them (docs/interfaces.md).
 */
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/parameter_error.h"
#include "frictional_contact_sim/simulation/scenario.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace XmlRpc
{
class XmlRpcValue;
}

namespace frictional_contact_sim
{
/** @brief Gains of ~command/position, velocity and trajectory; unset numbers get defaults from the joint's inertia. */
struct ServoGains
{
  double kp = std::numeric_limits<double>::quiet_NaN();  ///< [N m/rad] or [N/m]
  double kd = std::numeric_limits<double>::quiet_NaN();  ///< [N m s/rad] or [N s/m]
  double max_effort = std::numeric_limits<double>::infinity();  ///< besides the URDF's limit [N m] or [N]
  double velocity_gain = std::numeric_limits<double>::quiet_NaN();  ///< kd of ~command/velocity [N m s/rad] or [N s/m]
};

struct NodeParameters
{
  Scenario scenario;  ///< of ~scenario, or made from robot_description and the parameters; what they override is in it
  std::set<std::string> robots;  ///< names of the bodies that come from ~robots
  double real_time_factor = 1.0;  ///< simulated over wall-clock time; 0 = as fast as possible
  double publish_rate = 0.0;  ///< of joint_states, contacts, step_report, odometry; 0 = every step [1/s simulated]
  double clock_rate = 0.0;  ///< of /clock; 0 = every step [1/s simulated]
  double tf_rate = 100.0;  ///< of /tf; 0 = every step [1/s simulated]
  double marker_rate = 30.0;  ///< of ~markers; 0 = every step [1/s simulated]
  double force_scale = 0.0;  ///< length of force arrows [m/N]; 0: see markerScale
  bool start_paused = false;
  std::vector<std::string> wait_for_subscribers;  ///< topics that must have a subscriber before the first step
  std::vector<std::string> lossless_topics;  ///< topics whose subscribers may hold a free run
  double hold_limit = 5.0;  ///< how long each of them may, and a recorder that has announced itself [s wall clock]
  std::int64_t num_steps = 0;  ///< exit after so many; 0 = never
  std::string dump_dir;  ///< FCLib files of failed steps; empty = none
  int max_dumps = 20;  ///< at most so many files a run
  std::string bag;  ///< file that a recorder is to write: its folder is checked
  bool publish_base_tf = true;
  bool link_topics = true;  ///< those of single links and joints are advertised
  bool publish_link_tf = false;  ///< of all links, where no robot_state_publisher does it
  bool publish_clock = true;  ///< false where another node publishes /clock
  std::map<std::string, ServoGains> servo_gains;  ///< by joint; `default` for all others
  int seed = 0;  ///< of the noise of sensors, beside their own
  std::vector<std::string> warnings;  ///< unknown or unused parameters, one line each
};

/** @brief The text of a parameter, searched from the node's namespace upwards; empty when there is none. */
using FindDescription = std::function<std::string(const std::string& parameter)>;

/**
 * @brief The document itself where `text` begins with `<`, else that of the parameter it names.
 * @throws ParameterError when there is none
 */
std::string findDocument(const std::string& text, const FindDescription& find);

/**
 * @param tree content of the node's private namespace (a struct; anything else counts as empty)
 * @param robot_description the URDF document, empty when there is none
 * @param find_description of parameters that ~robots names
 * @throws ParameterError, ScenarioError
 */
NodeParameters readParameters(const XmlRpc::XmlRpcValue& tree, const std::string& robot_description,
                              const FindDescription& find_description = nullptr);

/** @brief All private parameters that readParameters reads. */
std::vector<std::string> parameterNames();

}  // namespace frictional_contact_sim
