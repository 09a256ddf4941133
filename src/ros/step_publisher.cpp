#include "frictional_contact_sim/ros/step_publisher.h"

#include <cmath>

#include "frictional_contact_sim/ros/parameter_error.h"

namespace frictional_contact_sim
{
namespace
{
/** Without bound: a subscriber that lags holds the run (DeliveryMonitor), the publisher never drops. */
constexpr std::uint32_t LOSSLESS_QUEUE = 0;
/** Pictures, transforms and the clock: the newest counts. */
constexpr std::uint32_t LATEST_QUEUE = 10;

bool listened(const ros::Publisher& publisher)
{
  return publisher.getNumSubscribers() > 0;
}

}  // namespace

StepDivider::StepDivider(double rate, double time_step)
{
  if (rate > 0.0)
  {
    // No run has so many steps; and beyond 2^63 llround has no answer.
    constexpr double NEVER = 1e18;
    steps_ = static_cast<std::uint64_t>(std::max(1LL, std::llround(std::min(NEVER, 1.0 / (rate * time_step)))));
  }
}

bool StepDivider::due(std::uint64_t step) const
{
  return step % steps_ == 0;
}

StepPublisher::StepPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, const Simulator& simulator,
                             const NameTable& names, const NodeParameters& parameters)
  : simulator_(simulator)
  , names_(names)
  , state_divider_(parameters.publish_rate, simulator.scenario().time_step)
  , clock_divider_(parameters.clock_rate, simulator.scenario().time_step)
  , tf_divider_(parameters.tf_rate, simulator.scenario().time_step)
  , marker_divider_(parameters.marker_rate, simulator.scenario().time_step)
  , publish_base_tf_(parameters.publish_base_tf)
  , force_scale_(parameters.force_scale > 0.0 ? parameters.force_scale : defaultForceScale(simulator))
{
  joint_states_publisher_ = node.advertise<sensor_msgs::JointState>("joint_states", LOSSLESS_QUEUE);
  contacts_publisher_ = private_node.advertise<ContactArray>("contacts", LOSSLESS_QUEUE);
  step_report_publisher_ = private_node.advertise<StepReport>("step_report", LOSSLESS_QUEUE);
  lossless_ = {joint_states_publisher_.getTopic(), contacts_publisher_.getTopic(), step_report_publisher_.getTopic()};
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const std::string prefix = body == 0 ? "" : simulator.bodyName(body) + "/";
    odometry_publishers_.push_back(
        private_node.advertise<nav_msgs::Odometry>("ground_truth/" + prefix + "odom", LOSSLESS_QUEUE));
    lossless_.insert(odometry_publishers_.back().getTopic());
  }
  odometry_.resize(odometry_publishers_.size());
  markers_publisher_ = private_node.advertise<visualization_msgs::MarkerArray>("markers", LATEST_QUEUE);
  clock_publisher_ = node.advertise<rosgraph_msgs::Clock>("/clock", LATEST_QUEUE);
  tf_publisher_ = node.advertise<tf2_msgs::TFMessage>("/tf", 100);
}

const std::set<std::string>& StepPublisher::losslessTopics() const
{
  return lossless_;
}

std::uint32_t StepPublisher::subscribers(const std::string& topic) const
{
  std::vector<const ros::Publisher*> publishers = {&joint_states_publisher_, &contacts_publisher_,
                                                   &step_report_publisher_,  &markers_publisher_,
                                                   &clock_publisher_,        &tf_publisher_};
  for (const ros::Publisher& publisher : odometry_publishers_)
    publishers.push_back(&publisher);
  std::string known;
  for (const ros::Publisher* publisher : publishers)
  {
    if (publisher->getTopic() == topic)
      return publisher->getNumSubscribers();
    known += (known.empty() ? "" : ", ") + publisher->getTopic();
  }
  throw ParameterError("~wait_for_subscribers: found '" + topic + "', expected topics of this node: " + known);
}

StepReport StepPublisher::report(double real_time_factor) const
{
  StepReport report;
  fillStepReport(simulator_.report(), real_time_factor, toStamp(simulator_.time()), report);
  return report;
}

void StepPublisher::publishReport(double real_time_factor)
{
  if (!listened(step_report_publisher_))
    return;
  fillStepReport(simulator_.report(), real_time_factor, toStamp(simulator_.time()), step_report_);
  step_report_publisher_.publish(step_report_);
}

void StepPublisher::publishClock(double seconds)
{
  if (listened(clock_publisher_))
  {
    clock_.clock = toStamp(seconds);
    clock_publisher_.publish(clock_);
  }
}

void StepPublisher::publishOdometry(const ros::Time& stamp)
{
  for (size_t body = 0; body < odometry_publishers_.size(); ++body)
  {
    if (listened(odometry_publishers_[body]))
    {
      fillOdometry(simulator_, names_, static_cast<int>(body), stamp, odometry_[body]);
      odometry_publishers_[body].publish(odometry_[body]);
    }
  }
}

void StepPublisher::publishTransforms(const ros::Time& stamp)
{
  if (!publish_base_tf_ || !listened(tf_publisher_))
    return;
  transforms_.transforms.clear();
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    if (names_.roots[body] != WORLD_FRAME)
    {
      transforms_.transforms.emplace_back();
      fillTransform(simulator_, names_, body, stamp, transforms_.transforms.back());
    }
  }
  if (!transforms_.transforms.empty())
    tf_publisher_.publish(transforms_);
}

void StepPublisher::publishMarkers(const ros::Time& stamp)
{
  if (listened(markers_publisher_))
  {
    arrows_ = fillMarkers(simulator_, stamp, force_scale_, arrows_, markers_);
    markers_publisher_.publish(markers_);
  }
}

void StepPublisher::publish(double real_time_factor)
{
  const std::uint64_t step = simulator_.report().step;
  const ros::Time stamp = toStamp(simulator_.time());
  if (clock_divider_.due(step))
    publishClock(simulator_.time());
  if (state_divider_.due(step))
  {
    if (listened(joint_states_publisher_))
    {
      fillJointState(simulator_, names_, stamp, joint_states_);
      joint_states_publisher_.publish(joint_states_);
    }
    if (listened(contacts_publisher_))
    {
      fillContacts(simulator_, names_, stamp, contacts_);
      contacts_publisher_.publish(contacts_);
    }
    publishReport(real_time_factor);
    publishOdometry(stamp);
  }
  if (tf_divider_.due(step))
    publishTransforms(stamp);
  if (marker_divider_.due(step))
    publishMarkers(stamp);
}

}  // namespace frictional_contact_sim
