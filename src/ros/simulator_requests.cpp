// The node's services about wrenches, state and settings: the table, each line a handler of its own file.
#include "frictional_contact_sim/ros/certificates.h"
#include "frictional_contact_sim/ros/setting_services.h"
#include "frictional_contact_sim/ros/simulator_node.h"

namespace frictional_contact_sim
{
void SimulatorNode::advertiseRequests()
{
  services_.add<ApplyWrench>(
      "apply_wrench", [this](const auto& request, auto&) { applyWrench(request, names_, frames_, simulator_); });
  services_.add<ClearWrenches>(
      "clear_wrenches", [this](const auto& request, auto&) { clearWrenches(request, names_, simulator_); });

  services_.add<SaveState>("save_state", [this](const auto& request, auto& response)
                           { storeState(request, simulator_, saved_state_, response); });
  services_.add<LoadState>("load_state",
                           [this](const auto& request, auto& response)
                           {
                             restoreState(request, saved_state_, simulator_, response);
                             commands_.forgetPending();  // as in another process, which has none
                             followSettings(parameters_.real_time_factor);
                             reconfiguration_->update();
                             showSetState();
                           });
  services_.add<SetLinkState>(
      "set_link_state",
      [this](const auto& request, auto& response)
      {
        placeLink(request, names_, frames_, simulator_, response);
        showSetState();
      });
  services_.add<GetLinkState>("get_link_state", [this](const auto& request, auto& response)
                              { readLinkState(request, names_, frames_, simulator_, response); });
  services_.add<SetJointPositions>("set_joint_positions",
                                   [this](const auto& request, auto& response)
                                   {
                                     setJointPositions(request, names_, simulator_, response);
                                     showSetState();
                                   });

  services_.add<SetFriction>("set_friction",
                             [this](const auto& request, auto&)
                             {
                               setFriction(request, simulator_);
                               reconfiguration_->update();
                             });
  services_.add<SetSolver>(
      "set_solver",
      [this](const auto& request, auto&)
      {
        setSolver(request, simulator_);
        reconfiguration_->update();
      });
  services_.add<DumpFclib>(
      "dump_fclib",
      [this](const auto& request, auto& response) { dumpFclib(request, simulator_, parameters_.dump_dir, response); });
  services_.add<Certify>("certify",
                         [this](const auto& request, auto& response) { certifyStep(request, simulator_, response); });
  services_.add<GetInfo>("get_info",
                         [this](const auto&, auto& response)
                         {
                           fillInfo(simulator_, names_, response);
                           response.paused = paused_;
                         });
}

}  // namespace frictional_contact_sim
