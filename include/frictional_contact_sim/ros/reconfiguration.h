#pragma once
/**
 * @file reconfiguration.h
 * @brief dynamic_reconfigure: settings of a running simulation, applied between steps (cfg/Simulator.cfg).
 *
 * The parameters with which the node starts are the first values. What dynamic_reconfigure keeps on the parameter
 * server goes to ~dynamic_reconfigure/..., so that the next node in this namespace reads no leftovers as its
 * parameters.
 */
#include <frictional_contact_sim/SimulatorConfig.h>
#include <ros/node_handle.h>

#include <functional>
#include <memory>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief The present settings. */
SimulatorConfig presentConfig(const Simulator& simulator, double real_time_factor);

/**
 * @brief Sets what differs from the present settings, all of it or nothing.
 * @param config but real_time_factor, which is only checked
 * @throws std::invalid_argument naming the field, what was found and what is expected
 */
void applyConfig(const SimulatorConfig& config, Simulator& simulator);

class Reconfiguration
{
public:
  /** @param changed called after settings were taken, with the real-time factor */
  Reconfiguration(const ros::NodeHandle& private_node, Simulator& simulator, double real_time_factor,
                  const std::function<void(double real_time_factor)>& changed);
  ~Reconfiguration();

  /** @brief Deletes what an earlier node has left of it on the parameter server; before parameters are read. */
  static void forget();
  /** @brief Tells clients the present settings, after a service has changed them. */
  void update();

private:
  struct Server;
  void take(SimulatorConfig& config);

  Simulator& simulator_;
  double real_time_factor_;
  std::function<void(double)> changed_;
  std::unique_ptr<Server> server_;
};

}  // namespace frictional_contact_sim
