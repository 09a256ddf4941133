#include "frictional_contact_sim/ros/end_request.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/xmlrpc_manager.h>

#include <csignal>

#include "frictional_contact_sim/ros/slave_api.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double MASTER_PERIOD = 0.1;  // between two questions [s]

std::atomic<bool> end_requested{false};
std::atomic<bool> in_order{false};

/** @brief Only what a signal handler may call. @return whether it is the first one */
bool requestEnd()
{
  const bool first = !end_requested.exchange(true);
  if (first && !in_order)
    ros::requestShutdown();
  return first;
}

/** @brief A signal raised in its handler arrives when the handler returns. */
void onSignal(int number)
{
  if (!requestEnd())
  {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}

}  // namespace

void endOnSignals()
{
  struct sigaction action
  {
  };
  action.sa_handler = onSignal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // rosnode kill, or a new node of this name: as a signal, where roscpp would close the connections at once. Bound
  // before roscpp binds its own (which then has no effect) and before its server thread looks anything up.
  ros::XMLRPCManager::instance()->bind("shutdown",
                                       [](XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue& result)
                                       {
                                         requestEnd();
                                         result = ros::xmlrpc::responseInt(1, "", 0);
                                       });
}

void endInOrder()
{
  in_order = true;
}

const std::atomic<bool>& endRequested()
{
  return end_requested;
}

bool waitForMaster()
{
  bool told = false;
  while (!end_requested && !masterAnswers())
  {
    if (!told)
      ROS_WARN_STREAM("waiting for the master at " << ros::master::getURI());
    told = true;
    ros::WallDuration(MASTER_PERIOD).sleep();
  }
  return !end_requested;
}

}  // namespace frictional_contact_sim
