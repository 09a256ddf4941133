#include "frictional_contact_sim/ros/services.h"

#include <std_srvs/Empty.h>

namespace frictional_contact_sim
{
void ServiceTable::add(const std::string& name, const std::function<void()>& action)
{
  add<std_srvs::Empty>(
      name, [action](const std_srvs::Empty::Request&, std_srvs::Empty::Response&) { action(); });
}

}  // namespace frictional_contact_sim
