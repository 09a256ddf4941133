#include "frictional_contact_sim/ros/reconfiguration.h"

#include <dynamic_reconfigure/server.h>
#include <ros/console.h>
#include <ros/param.h>

#include <boost/thread/recursive_mutex.hpp>

#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/solver/registry.h"

namespace frictional_contact_sim
{
namespace
{
const std::string PLACE = "dynamic_reconfigure";  // below the node's name

void require(const NumberRange& range, const std::string& field, double value)
{
  if (!range.holds(value))
    throw std::invalid_argument(field + ": found " + numberText(value) + ", expected " + range.expected());
}

/** The node's own namespace for the services, PLACE for the values. */
ros::NodeHandle redirected(const ros::NodeHandle& private_node)
{
  ros::M_string names;
  for (const auto& description : SimulatorConfig::__getParamDescriptions__())
    names[description->name] = PLACE + "/" + description->name;
  return {private_node, "", names};
}
}  // namespace

SimulatorConfig presentConfig(const Simulator& simulator, double real_time_factor)
{
  const Scenario& scenario = simulator.scenario();
  SimulatorConfig config = SimulatorConfig::__getDefault__();
  config.time_step = scenario.time_step;
  config.gravity_x = scenario.gravity.x();
  config.gravity_y = scenario.gravity.y();
  config.gravity_z = scenario.gravity.z();
  config.solver = scenario.solver;
  config.tolerance = scenario.stopping.tolerance;
  config.default_friction = scenario.materials.fallback.friction;
  config.real_time_factor = real_time_factor;
  return config;
}

void applyConfig(const SimulatorConfig& config, Simulator& simulator)
{
  const Scenario& scenario = simulator.scenario();
  const Eigen::Vector3d gravity(config.gravity_x, config.gravity_y, config.gravity_z);
  StoppingOptions stopping = scenario.stopping;
  stopping.tolerance = config.tolerance;
  require(timeStepRange(), "time_step", config.time_step);
  require(notNegative(), "real_time_factor", config.real_time_factor);
  for (const double component : gravity)
    require(anyNumber(), "gravity", component);
  stopping.validate();
  findSolver(config.solver);
  // The only one that may still refuse comes first.
  if (config.default_friction != scenario.materials.fallback.friction)
    simulator.setDefaultFriction(config.default_friction);
  if (config.time_step != scenario.time_step)
    simulator.setTimeStep(config.time_step);
  if (gravity != scenario.gravity)
    simulator.setGravity(gravity);
  if (config.solver != scenario.solver)
    simulator.setSolver(config.solver);
  if (config.tolerance != scenario.stopping.tolerance)
    simulator.setStopping(stopping);
}

struct Reconfiguration::Server
{
  explicit Server(const ros::NodeHandle& node) : server(mutex, node) {}
  boost::recursive_mutex mutex;  // asked for by dynamic_reconfigure; there is one thread
  dynamic_reconfigure::Server<SimulatorConfig> server;
};

Reconfiguration::Reconfiguration(const ros::NodeHandle& private_node, Simulator& simulator, double real_time_factor,
                                 const std::function<void(double)>& changed)
  : simulator_(simulator)
  , real_time_factor_(real_time_factor)
  , changed_(changed)
  , server_(std::make_unique<Server>(redirected(private_node)))
{
  update();
  server_->server.setCallback([this](SimulatorConfig& config, std::uint32_t) { take(config); });
}

Reconfiguration::~Reconfiguration() = default;

void Reconfiguration::forget()
{
  ros::param::del("~" + PLACE);
}

void Reconfiguration::update()
{
  server_->server.updateConfig(presentConfig(simulator_, real_time_factor_));
}

/** @param config what was asked for; afterwards what is set */
void Reconfiguration::take(SimulatorConfig& config)
{
  try
  {
    applyConfig(config, simulator_);
    real_time_factor_ = config.real_time_factor;
    changed_(real_time_factor_);
  }
  catch (const std::exception& error)
  {
    ROS_WARN_STREAM("dynamic_reconfigure: request ignored: " << error.what());
  }
  config = presentConfig(simulator_, real_time_factor_);
}

}  // namespace frictional_contact_sim
