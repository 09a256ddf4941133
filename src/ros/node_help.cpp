#include "frictional_contact_sim/ros/node_help.h"

#include <iomanip>
#include <sstream>

namespace frictional_contact_sim
{
const std::vector<ParameterHelp>& parameterHelp()
{
  static const std::vector<ParameterHelp> HELP = {
      {"scenario", "", "scenario file or a name in config/scenarios; robot_description is not used then"},
      {"robot_description", "", "URDF document; else robot_description of this namespace or one above"},
      {"robots", "{}",
       "{name: {description, pose, base, ...}}: robots beside the scenario's bodies; description: a URDF document or "
       "the "
       "name of a parameter; the keys of a scenario's body"},
      {"time_step", "0.001", "1e-9 to 1000 [s]; of a scenario: the file's unless set"},
      {"gravity", "[0, 0, -9.81]", "[m/s^2]; of a scenario: the file's unless set"},
      {"solver", "portfolio", "name of the registry: fclib_solve --list-solvers"},
      {"solver_options", "{}", "{name: value} of the method: fclib_solve --list-solvers"},
      {"tolerance", "1e-8", "largest residual E of a step [-]"},
      {"max_iterations", "1000", "iterations a step"},
      {"ground", "true", "plane z = 0; false, or {height [m], friction [-]}"},
      {"base", "auto", "auto, floating or fixed; auto: fixed when the root link is named world"},
      {"base_pose", "", "[x, y, z, roll, pitch, yaw] or {xyz, rpy} [m, rad]; not set: 1 mm above the ground"},
      {"initial_joint_positions", "{}", "{joint: position [rad or m]}"},
      {"hold_initial_position", "false", "servos hold the joints where they start"},
      {"gravity_compensation", "false", "servos also carry the weight of what hangs on their joints"},
      {"servo_gains", "{}",
       "{default or joint: {kp [N m/rad], kd, velocity_gain [N m s/rad], max_effort [N m]}}; prismatic: N/m ..."},
      {"default_friction", "0.8", "coefficient [-] of what ~materials does not say"},
      {"default_restitution", "0", "coefficient 0 to 1 [-] of what ~materials does not say"},
      {"materials", "{}", "default, pairs and single materials, as in a scenario file"},
      {"link_materials", "{}", "{link: material}"},
      {"disable_collisions", "[]", "[[link, link], ...]"},
      {"self_collision", "true", "false: no two links of the robot collide"},
      {"min_joint_inertia", "",
       "given to joints that move none [kg m^2], [kg] where they slide; not set: 1e-6 of the body"},
      {"pose", "", "as base_pose, the key of a scenario's body"},
      {"velocity", "0", "{linear [m/s], angular [rad/s]} of the root link at the start"},
      {"joints", "{}", "{joint: {position, velocity}} at the start"},
      {"commands", "{}", "{joint: {position, effort or velocity ..., or times and positions}}, as in a scenario file"},
      {"wrenches", "[]", "[{link, force, torque, point, frame, from, until}], as in a scenario file"},
      {"sensors", "[]",
       "[{type, link or joint, name, topic, pose, frame, rate, noise, bias, seed}], as in a scenario file"},
      {"motion", "", "of a fixed base, prescribed: {linear, angular}, or {type: sine or table, ...}"},
      {"surface_velocity", "{}", "{link: {linear, angular}} of surfaces that move [m/s, rad/s]"},
      {"springs", "{}", "{joint: {stiffness, rest, damping}} beside any command"},
      {"material", "default", "of the whole robot"},
      {"real_time_factor", "1", "simulated over wall-clock time [-]; 0 = free run, as fast as possible"},
      {"publish_rate", "0", "of the topics of every step [1/s simulated]; 0 = every step"},
      {"clock_rate", "0", "of /clock [1/s simulated]; 0 = every step"},
      {"tf_rate", "100", "of /tf [1/s simulated]; 0 = every step"},
      {"marker_rate", "30", "of ~markers [1/s simulated]; 0 = every step"},
      {"publish_base_tf", "true", "transforms of the root links, on /tf or, of fixed ones, on /tf_static"},
      {"publish_link_tf", "false", "transforms of all other links too, where no robot_state_publisher runs"},
      {"link_topics", "true",
       "~contacts/LINK, ~wrench/LINK, ~joint_wrench/JOINT are advertised: false for very many links"},
      {"publish_clock", "true", "false where another node publishes /clock"},
      {"force_scale", "0", "length of force arrows [m/N]; 0 = the largest body's size for the heaviest one's weight"},
      {"start_paused", "false", "the first step waits for ~unpause or ~step"},
      {"wait_for_subscribers", "[]", "topics that must have a subscriber before the first step"},
      {"lossless_topics", "[]",
       "topics of every step whose subscribers may hold a free run; record_bag needs no mention"},
      {"hold_limit", "5", "how long each of them may [s wall clock]; then its loss is counted and the run goes on"},
      {"num_steps", "0", "end after so many steps; 0 = never"},
      {"on_failure", "stop", "stop, pause, hold or accept; of a scenario: the file's unless set"},
      {"failure", "", "{policy, fallback, time_limit}, as in a scenario file"},
      {"contact_law", "gap", "or velocity: the thesis's plain law"},
      {"certify_every", "0", "steps between two verdicts on existence, on ~certificate and in ~step_report; 0 = none"},
      {"certify_bound", "0", "R of their margin [m/s, rad/s]; 0 = ten times what moves outside, at least 1"},
      {"broad_phase", "auto", "or fcl, list: the same contacts"},
      {"fallback", "true", "other methods are tried before a step is given up"},
      {"step_time_limit", "0", "of a whole step [s wall clock]; 0 = none"},
      {"dump_dir", "", "folder for FCLib files of failed steps"},
      {"max_dumps", "20", "at most so many files a run"},
      {"bag", "", "file that a recorder will write: its folder is checked at the start"},
      {"seed", "0", "of the noise of sensors, beside their own"},
  };
  return HELP;
}

std::string nodeHelp()
{
  std::ostringstream text;
  text
      << "usage: simulator_node [_PARAMETER:=VALUE ...] [TOPIC:=NAME ...]\n"
         "\n"
         "Simulates the robot of robot_description, or a scenario file, with exact Coulomb friction. Topics, services\n"
         "and messages: docs/interfaces.md. SIGINT and SIGTERM end it in order, a long step too; a second one ends it "
         "at once.\n"
         "\n"
         "  -h, --help     print this and end\n"
         "  --version      print the version and end\n"
         "\n"
         "Private parameters, SI units, defaults in parentheses:\n";
  for (const ParameterHelp& help : parameterHelp())
  {
    text << "  ~" << std::left << std::setw(24) << help.name << help.meaning;
    text << (help.default_value.empty() ? "" : " (" + help.default_value + ")") << '\n';
  }
  text << "\nExit code: 0 done or ended by a signal, 1 a step failed under ~on_failure stop, 2 bad input.\n";
  return text.str();
}

}  // namespace frictional_contact_sim
