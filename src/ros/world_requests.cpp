// The part of the node that lets bodies come and go; see world_services.h for the requests.
#include <frictional_contact_sim/Delete.h>
#include <ros/console.h>
#include <ros/names.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/ros/parameter_error.h"
#include "frictional_contact_sim/ros/simulator_node.h"
#include "frictional_contact_sim/ros/world_services.h"

namespace frictional_contact_sim
{
std::string findDescription(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                            const std::string& parameter)
{
  std::string error;
  if (!ros::names::validate(parameter, error))
    throw ParameterError("found '" + inOneLine(parameter, 80) + "': " + error);
  const bool is_absolute = !parameter.empty() && parameter[0] == '/';
  XmlRpc::XmlRpcValue value;
  std::string key;
  const bool found =
      (!is_absolute && private_node.getParam(parameter, value)) ||
      (is_absolute ? node.getParam(parameter, value) : node.searchParam(parameter, key) && node.getParam(key, value));
  if (found && value.getType() != XmlRpc::XmlRpcValue::TypeString)
    throw ParameterError(parameter + ": expected a string with a URDF document");
  return found ? static_cast<std::string>(value) : std::string();
}

void SimulatorNode::addWorldServices()
{
  services_.add<Attach>(
      "attach", [this](const auto& request, auto& response) { attach(request, simulator_, names_, response); });
  services_.add<Detach>(
      "detach", [this](const auto& request, auto&) { detach(request, simulator_, names_); });
  services_.add<Spawn>(
      "spawn",
      [this](const auto& request, auto& response)
      {
        const auto find = [this](const std::string& parameter)
        { return findDescription(node_, private_node_, parameter); };
        const BodySpec spec = readSpawn(request, frames_, find);
        changeBodies(
            [&]
            {
              spawn(spec, simulator_);
              name_rules_.prefixed.insert(spec.name);
            });
        const int body = simulator_.findBody(spec.name);
        setServoGains(body);
        simulator_.setStartCommands(body);
        for (const std::string& warning : simulator_.warnings())
        {
          ROS_WARN_STREAM(warning);
          response.message += (response.message.empty() ? "" : "; ") + warning;
        }
      });
  services_.add<Delete>("delete",
                        [this](const auto& request, auto&) { changeBodies([&] { simulator_.remove(request.name); }); });
}

/** @brief The bodies become others: names, topics and pictures follow, topics that stay keep their subscribers. */
void SimulatorNode::changeBodies(const std::function<void()>& change)
{
  if (waiting_)
    throw RequestError("waiting for subscribers");
  change();
  const NameTable before = names_;
  names_ = makeNameTable(simulator_, name_rules_);
  const std::vector<int> new_index = newJointIndices(before, names_);
  commands_.renumberJoints(new_index);
  trajectories_.renumberJoints(new_index);
  // The old one goes after the new one has advertised: roscpp keeps what both have.
  auto next = std::make_unique<StepPublisher>(node_, private_node_, simulator_, names_, name_rules_, parameters_);
  next->takeOver(*publisher_);
  publisher_ = std::move(next);
  delivery_.setTopics(publisher_->dataTopics());
}

}  // namespace frictional_contact_sim
