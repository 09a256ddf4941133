#include "frictional_contact_sim/ros/simulator_node.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/names.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>

#include <algorithm>

#include "frictional_contact_sim/ros/end_request.h"
#include "frictional_contact_sim/ros/parameter_error.h"
#include "frictional_contact_sim/ros/slave_api.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int FREE_RUN_WINDOW = 32;  // steps between two looks at the subscribers, below any queue (rosbag's: 100)
constexpr double HOLD_PERIOD = 0.0005;  // between two looks while the run is held [s]
constexpr std::uint32_t MAX_STEPS_PER_CALL = 100000;  // of ~step
constexpr double IDLE_PERIOD = 0.02;  // [s]
constexpr double CLOCK_PERIOD = 0.1;  // of /clock while nothing moves [s]
constexpr double SETTLING_TIME = 0.5;  // between a recorder's subscription and its readiness [s]
constexpr double ARRIVAL_TIME = 0.02;  // of a message at a subscriber on this machine [s]
constexpr double COMPLAINT_DELAY = 5.0;  // [s]
constexpr double FAILURE_PERIOD = 1.0;  // between two lines about failed steps of a run that goes on [s]

double wallSeconds()
{
  return ros::WallTime::now().toSec();
}

bool goesOn(FailurePolicy policy)
{
  return policy == FailurePolicy::HOLD || policy == FailurePolicy::ACCEPT;
}

/** @brief False when the node has to end: a signal, or ROS shuts down. */
bool going()
{
  return ros::ok() && !endRequested();
}

/** @brief Topics as users write them, ~name too. */
std::vector<std::string> resolved(ros::NodeHandle& node, ros::NodeHandle& private_node,
                                  const std::vector<std::string>& topics)
{
  std::vector<std::string> names;
  for (const std::string& topic : topics)
    names.push_back(topic.empty() || topic[0] != '~' ? node.resolveName(topic)
                                                     : private_node.resolveName(topic.substr(1)));
  return names;
}

void serveCallbacks(double timeout)
{
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(timeout));
}

}  // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle& node, ros::NodeHandle& private_node, const NodeParameters& parameters)
  : node_(node)
  , private_node_(private_node)
  , parameters_(parameters)
  , simulator_(parameters.scenario)
  , name_rules_(nameRules(simulator_, parameters.robots))
  , names_(makeNameTable(simulator_, name_rules_))
  , publisher_(std::make_unique<StepPublisher>(node, private_node, simulator_, names_, name_rules_, parameters))
  , delivery_(publisher_->dataTopics(),
              publisher_->losslessTopics(resolved(node, private_node, parameters.lossless_topics)),
              parameters.hold_limit)
  , commands_(private_node, simulator_, names_, parameters_.servo_gains)
  , trajectories_(private_node, simulator_, names_, parameters_.servo_gains)
  , frames_(simulator_, names_, true)
  , wrenches_(private_node, names_, simulator_)
  , pacer_(parameters.real_time_factor)
  , diagnostics_(node, private_node, [this] { return runState(); })
  , failure_lines_(goesOn(parameters.scenario.failure.policy) ? FAILURE_PERIOD : 0.0)
  , certificate_lines_(FAILURE_PERIOD)
  , services_(private_node)
  , paused_(parameters.start_paused)
  , waiting_(!parameters.wait_for_subscribers.empty())
{
  awaited_topics_ = resolved(node, private_node, parameters.wait_for_subscribers);
  for (const std::string& topic : awaited_topics_)
    publisher_->subscribers(topic);  // throws where it is none of this node's
  for (const std::string& warning : simulator_.warnings())
    ROS_WARN_STREAM(warning);
  if (parameters.publish_clock)
    for (const std::string& other : otherPublishers("/clock"))
      ROS_WARN_STREAM(other << " publishes /clock too: time would jump; set ~publish_clock to false in one of the two");
  for (const std::string& joint : names_.unsupported_joints)
    ROS_WARN_STREAM("joint '" << joint << "' has more than one coordinate: it is simulated, but not in joint_states");
  simulator_.setDumpFolder(parameters.dump_dir, parameters.max_dumps);
  for (const auto& gains : parameters_.servo_gains)
    if (gains.first != "default" && findJoint(names_, gains.first) < 0)
      throw ParameterError("~servo_gains: unknown joint '" + gains.first + "'");
  for (int body = 0; body < simulator_.bodyCount(); ++body)
    setServoGains(body);
  simulator_.setStart();  // a reset keeps the gains
  advertiseServices();
  reconfiguration_ = std::make_unique<Reconfiguration>(
      private_node, simulator_, parameters_.real_time_factor, [this](double factor) { followSettings(factor); });
  lossless_nodes_ = node.subscribe<std_msgs::String>(LOSSLESS_NODES_TOPIC, 100,
                                                     [this](const std_msgs::String::ConstPtr& message)
                                                     { delivery_.addLosslessNode(message->data); });
  publisher_->greetSubscribers(paused_);
  ROS_INFO_STREAM("loaded " << simulator_.scenario().name << " in " << simulator_.loadingSeconds() << " s, solver "
                            << simulator_.scenario().solver << (paused_ ? ", paused" : ""));
  if (judge("impact at the start") == Outcome::FAILED)
    outcome_ = Outcome::FAILED;
}

RunState SimulatorNode::runState() const
{
  return {paused_ || waiting_, parameters_.real_time_factor, pacer_.realTimeFactor(),
          simulator_.scenario().stopping.tolerance, delivery_.dropped()};
}

/** @brief ~servo_gains for the servos that hold the initial position of a body. */
void SimulatorNode::setServoGains(int of_body)
{
  for (const int index : names_.actuated)
  {
    const JointHandle& joint = names_.joints[index];
    if (joint.body != of_body)
      continue;
    const BodySpec& body = simulator_.scenario().bodies[joint.body];
    const std::string& urdf_name = simulator_.model(joint.body).joints[joint.joint].name;
    if (!parameters_.servo_gains.empty() && body.hold_initial_position && body.commands.count(urdf_name) == 0)
    {
      const double position = simulator_.position(joint.body)[joint.q_index];
      simulator_.setCommand(joint.body, joint.joint, positionCommand(position, joint.name, parameters_.servo_gains));
    }
  }
}

/** @brief Seam "service": one line each. */
void SimulatorNode::advertiseServices()
{
  const auto pause = [this] { setPaused(true); };
  const auto unpause = [this] { setPaused(false); };
  const auto reset_state = [this] { reset(); };
  const auto reset_all = [this]
  {
    reset();
    resetTime();
  };
  services_.add("pause", pause);
  services_.add("unpause", unpause);
  services_.add("reset", reset_state);
  services_.add("reset_time", [this] { resetTime(); });
  // Gazebo's names.
  services_.add("pause_physics", pause);
  services_.add("unpause_physics", unpause);
  services_.add("reset_world", reset_state);
  services_.add("reset_simulation", reset_all);
  services_.add<std_srvs::SetBool>("set_paused", [this](const auto& request, auto&) { setPaused(request.data); });
  advertiseRequests();
  services_.add<Step>("step", [this](const auto& request, auto& response) { takeSteps(request, response); });
  addWorldServices();
}

void SimulatorNode::setPaused(bool paused)
{
  paused_ = paused;
  publisher_->greetSubscribers(paused);
  if (paused)
    publisher_->publishRest();
  publisher_->publishClock();
  pacer_.restart(simulator_.time(), wallSeconds());
}

void SimulatorNode::reset()
{
  simulator_.reset();
  commands_.forgetPending();
  trajectories_.update();
  if (paused_)
    publisher_->publishState();
  if (judge("impact at the start") == Outcome::FAILED)
    outcome_ = Outcome::FAILED;
}

/** @brief Until what has been published is with its subscribers, as a rule. */
void SimulatorNode::settle()
{
  delivery_.flushPublishQueues();
  ros::WallDuration(ARRIVAL_TIME).sleep();
}

void SimulatorNode::resetTime()
{
  simulator_.resetTime();
  commands_.forgetPending();
  // Who keeps a tf buffer empties it when the clock jumps back: transforms from before must have arrived by then, and
  // those from after must come later, or they stay in it as the future and the past.
  publisher_->restartStamps();
  settle();
  publisher_->publishClock();
  settle();
  if (paused_)
    publisher_->publishState();
  pacer_.restart(simulator_.time(), wallSeconds());
}

/** @brief The state, perhaps the time too, is another one. */
void SimulatorNode::showSetState()
{
  trajectories_.update();
  if (paused_)
    publisher_->publishState();
  pacer_.restart(simulator_.time(), wallSeconds());
}

/** @brief What depends on settings that have changed. */
void SimulatorNode::followSettings(double real_time_factor)
{
  publisher_->setTimeStep(simulator_.scenario().time_step);
  if (real_time_factor != parameters_.real_time_factor)
    pacer_ = Pacer(real_time_factor);
  parameters_.real_time_factor = real_time_factor;
  pacer_.restart(simulator_.time(), wallSeconds());
}

void SimulatorNode::takeSteps(const Step::Request& request, Step::Response& response)
{
  if (!paused_ || waiting_)
    throw RequestError(waiting_ ? "waiting for subscribers" : "the simulation runs: pause it first");
  // No other call is answered meanwhile.
  if (request.n == 0 || request.n > MAX_STEPS_PER_CALL)
    throw RequestError("n: found " + std::to_string(request.n) + ", expected 1 to " +
                       std::to_string(MAX_STEPS_PER_CALL) + "; unpause for longer runs");
  std::uint32_t done = 0;
  Outcome outcome = Outcome::GO_ON;
  while (done < request.n && outcome == Outcome::GO_ON && going())
  {
    outcome = advance();
    done += simulator_.outcome().taken;
    if (windowEnds())
      hold([] { ros::WallDuration(HOLD_PERIOD).sleep(); });  // no other call is served within this one
  }
  publisher_->publishRest();
  response.report = publisher_->report(pacer_.realTimeFactor());
  outcome_ = outcome == Outcome::PAUSED ? Outcome::GO_ON : outcome;
  if (done < request.n || outcome == Outcome::FAILED || outcome == Outcome::PAUSED)
    throw RequestError("stopped after " + std::to_string(done) + " of " + std::to_string(request.n) + " steps");
}

/** @brief A run that goes on may fail at every step: it gets a line a second. */
void SimulatorNode::reportFailure(const std::string& where)
{
  const StepOutcome& outcome = simulator_.outcome();
  if (const std::optional<int> held_back = failure_lines_.pass(wallSeconds()))
  {
    ROS_WARN_STREAM(where << ": " << toString(outcome.status) << ", residual " << outcome.residual
                          << (outcome.message.empty() ? "" : ", " + outcome.message)
                          << (outcome.fclib_file.empty() ? "" : ", problem in " + outcome.fclib_file)
                          << (*held_back > 0 ? "; not shown since: " + std::to_string(*held_back) : ""));
  }
  if (!outcome.fclib_file.empty() && ++dumps_ == parameters_.max_dumps)
    ROS_WARN_STREAM("~max_dumps: " << dumps_ << " problems are in " << parameters_.dump_dir << ", no more are written");
}

/** @brief A line a second at most about a scene that has no solution, or soon none. */
void SimulatorNode::reportCertificate()
{
  const StepCertificate& certificate = simulator_.report().certificate;
  if (!certificate.checked || certificate.warning.empty())
    return;
  if (const std::optional<int> held_back = certificate_lines_.pass(wallSeconds()))
    ROS_WARN_STREAM("step " << certificate.step << ": " << certificate.warning
                            << (*held_back > 0 ? "; not shown since: " + std::to_string(*held_back) : ""));
}

/** @brief What the policy makes of the last step, reset or set. @param where of the line that is logged */
SimulatorNode::Outcome SimulatorNode::judge(const std::string& where)
{
  if (simulator_.outcome().status == SolverStatus::STOPPED_BY_USER)
    return Outcome::FINISHED;
  if (!simulator_.outcome().converged())
  {
    reportFailure(where);
    if (simulator_.failurePolicy() == FailurePolicy::STOP)
      return Outcome::FAILED;
    if (simulator_.failurePolicy() == FailurePolicy::PAUSE)
    {
      setPaused(true);
      return Outcome::PAUSED;
    }
  }
  const bool finished = parameters_.num_steps > 0 && steps_done_ >= parameters_.num_steps;
  return finished ? Outcome::FINISHED : Outcome::GO_ON;
}

/** @brief One step, its messages, and whatever keeps them from being lost. Of a step that is not taken the report. */
SimulatorNode::Outcome SimulatorNode::advance()
{
  commands_.giveDue();
  const double start = wallSeconds();
  const bool taken = simulator_.step().taken;
  summary_.add(simulator_.report(), simulator_.outcome());
  diagnostics_.addStep(simulator_.report(), simulator_.outcome().converged(), wallSeconds() - start);
  if (!taken)
  {
    publisher_->publishReport(pacer_.realTimeFactor());
    publisher_->publishCertificate();
    if (simulator_.report().certificate.checked)
      publisher_->publishMarkers();  // where it cannot go on
    reportCertificate();
    return judge("step " + std::to_string(simulator_.report().step));
  }
  ++steps_done_;
  pacer_.measure(simulator_.time(), wallSeconds());
  publisher_->publish(pacer_.realTimeFactor());
  reportCertificate();
  trajectories_.update();
  return judge("step " + std::to_string(simulator_.report().step));
}

/** @brief Steps as fast as possible stop now and then for roscpp's own thread and for those that must get everything.
 */
bool SimulatorNode::windowEnds() const
{
  const bool free_run = parameters_.real_time_factor <= 0.0 || paused_;
  return free_run && simulator_.outcome().taken && steps_done_ % FREE_RUN_WINDOW == 0;
}

/** @brief Until they have it, at most ~hold_limit. @param pass passes a little time */
void SimulatorNode::hold(const std::function<void()>& pass)
{
  delivery_.flushPublishQueues();
  const double start = wallSeconds();
  while (going() && delivery_.lagging(wallSeconds() - start))
    pass();
  diagnostics_.addHold(wallSeconds() - start);
}

bool SimulatorNode::subscribersStand()
{
  // A topic named n times needs n subscribers.
  const auto stands = [this](const std::string& topic)
  { return publisher_->subscribers(topic) >= std::count(awaited_topics_.begin(), awaited_topics_.end(), topic); };
  return std::all_of(awaited_topics_.begin(), awaited_topics_.end(), stands);
}

/** @brief Nothing to step: serve callbacks, and give the time to those who come now (a recorder waits for a clock). */
void SimulatorNode::idle()
{
  const double due = wallSeconds() + CLOCK_PERIOD;
  publisher_->publishClock();
  while (going() && (paused_ || waiting_) && outcome_ == Outcome::GO_ON && wallSeconds() < due)
  {
    serveCallbacks(IDLE_PERIOD);
    if (waiting_)
    {
      const double now = wallSeconds();
      standing_since_ = subscribersStand() ? std::min(standing_since_, now) : now;
      waiting_ = now - standing_since_ < SETTLING_TIME;
    }
  }
  pacer_.restart(simulator_.time(), wallSeconds());
}

void SimulatorNode::runStep()
{
  outcome_ = advance();
  if (outcome_ == Outcome::PAUSED)
    outcome_ = Outcome::GO_ON;
  if (windowEnds())
    hold([] { serveCallbacks(HOLD_PERIOD); });
  double wait = pacer_.wait(simulator_.time(), wallSeconds());
  serveCallbacks(0.0);
  while (going() && wait > 0.0 && !paused_)
  {
    serveCallbacks(std::min(wait, IDLE_PERIOD));
    wait = pacer_.wait(simulator_.time(), wallSeconds());
  }
}

int SimulatorNode::run()
{
  endInOrder();
  pacer_.restart(simulator_.time(), wallSeconds());
  while (going() && outcome_ == Outcome::GO_ON)
    if (paused_ || waiting_)
      idle();
    else
      runStep();
  delivery_.flush();  // the last messages, before the connections close
  if (failure_lines_.heldBack() > 0)
    ROS_WARN_STREAM("failed steps not shown at the end: " << failure_lines_.heldBack());
  for (const auto& [subscriber, count] : delivery_.dropped())
    ROS_INFO_STREAM(subscriber << ": the subscriber dropped " << count << " messages");
  ROS_INFO_STREAM(summary_.line(pacer_.meanRealTimeFactor()));
  return outcome_ == Outcome::FAILED ? 1 : 0;
}

}  // namespace frictional_contact_sim
