#include "frictional_contact_sim/ros/step_publisher.h"

#include <ros/single_subscriber_publisher.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/ros/parameter_error.h"
#include "frictional_contact_sim/simulation/body_document.h"

namespace frictional_contact_sim
{
namespace
{
/**
 * Well above what is in flight to those that hold a free run (DeliveryMonitor), a second or two of a paced one; and a
 * bound, since nobody waits for a subscriber that has stopped reading.
 */
constexpr std::uint32_t DATA_QUEUE = 2000;
/** Pictures, transforms and the clock: the newest counts. */
constexpr std::uint32_t LATEST_QUEUE = 10;
constexpr std::uint32_t TRANSFORM_QUEUE = 100;

bool listened(const ros::Publisher& publisher)
{
  return publisher.getNumSubscribers() > 0;
}

}  // namespace

/** @param fill the message of the present state, for those who subscribe while nothing moves */
template <typename Message>
ros::Publisher StepPublisher::advertise(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue,
                                        const Message& (StepPublisher::*fill)())
{
  return node.advertise<Message>(
      topic, queue,
      [this, fill](const ros::SingleSubscriberPublisher& subscriber)
      {
        if (greeting_)
          subscriber.publish((this->*fill)());
      });
}

StepPublisher::StepPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, const Simulator& simulator,
                             const NameTable& names, const NameRules& rules, const NodeParameters& parameters)
  : simulator_(simulator)
  , names_(names)
  , state_divider_(parameters.publish_rate, simulator.scenario().time_step)
  , clock_divider_(parameters.clock_rate, simulator.scenario().time_step)
  , tf_divider_(parameters.tf_rate, simulator.scenario().time_step)
  , marker_divider_(parameters.marker_rate, simulator.scenario().time_step)
  , publish_clock_(parameters.publish_clock)
  , marker_scale_(markerScale(simulator, parameters.force_scale))
  , body_markers_(simulator)
  , forces_(simulator)
  , body_joints_(node, simulator, names, rules.prefixed, [this] { return greeting_ ? stamp_ : ros::Time(); })
{
  joint_states_publisher_ = advertise(node, "joint_states", DATA_QUEUE, &StepPublisher::jointStates);
  contacts_publisher_ = advertise(private_node, "contacts", DATA_QUEUE, &StepPublisher::contacts);
  step_report_publisher_ = private_node.advertise<StepReport>("step_report", DATA_QUEUE);
  certificate_publisher_ = private_node.advertise<CertificateReport>("certificate", DATA_QUEUE);
  data_topics_ = {joint_states_publisher_.getTopic(), contacts_publisher_.getTopic(), step_report_publisher_.getTopic(),
                  certificate_publisher_.getTopic()};
  odometry_.resize(simulator.bodyCount());
  for (int body = 0; body < simulator.bodyCount(); ++body)
    advertiseOdometry(private_node, body,
                      simulator.bodyName(body) == rules.first ? "" : simulator.bodyName(body) + "/");
  for (const ros::Publisher& publisher : body_joints_.publishers())
    data_topics_.insert(publisher.getTopic());
  markers_publisher_ = advertise(private_node, "markers", LATEST_QUEUE, &StepPublisher::allMarkers);
  // Read from the files for each new subscriber; after a spawn or delete roscpp announces the old ones anew.
  bodies_publisher_ = private_node.advertise<Bodies>("bodies", LATEST_QUEUE,
                                                     [this](const ros::SingleSubscriberPublisher& subscriber)
                                                     { subscriber.publish(bodies()); });
  if (publish_clock_)
    clock_publisher_ = node.advertise<rosgraph_msgs::Clock>("/clock", LATEST_QUEUE);
  tf_publisher_ = advertise(node, "/tf", TRANSFORM_QUEUE, &StepPublisher::transforms);
  tf_.emplace(simulator, names, TransformChoice{parameters.publish_base_tf, parameters.publish_link_tf});
  sensors_.emplace(node, private_node, simulator, names, forces_, parameters.seed);
  for (const ros::Publisher& publisher : sensors_->publishers())
    data_topics_.insert(publisher.getTopic());
  links_.emplace(private_node, simulator, names, forces_, parameters.link_topics);
  data_topics_.merge(links_->topics());
  publishStaticTransforms();
}

void StepPublisher::advertiseOdometry(ros::NodeHandle& private_node, int body, const std::string& prefix)
{
  odometry_publishers_.push_back(
      private_node.advertise<nav_msgs::Odometry>("ground_truth/" + prefix + "odom", DATA_QUEUE,
                                                 [this, body](const ros::SingleSubscriberPublisher& subscriber)
                                                 {
                                                   if (greeting_)
                                                     subscriber.publish(odometry(body));
                                                 }));
  data_topics_.insert(odometry_publishers_.back().getTopic());
}

void StepPublisher::takeOver(StepPublisher& before)
{
  stamp_ = before.stamp_;
  greetSubscribers(before.greeting_);
  // Those who listen already are announced to the new publishers by roscpp as if they came now, and so greeted: with a
  // stamp of its own, as in publishState.
  if (greeting_)
    stamp_ += ros::Duration(0, 1);
  transforms_stamp_ = markers_stamp_ = stamp_;
  if (!listened(markers_publisher_))
    return;
  markers_.markers.resize(1);
  markers_.markers.front().action = visualization_msgs::Marker::DELETEALL;
  markers_publisher_.publish(markers_);
}

void StepPublisher::greetSubscribers(bool on)
{
  greeting_ = on;
  links_->greetSubscribers(on);
}

const std::set<std::string>& StepPublisher::dataTopics() const
{
  return data_topics_;
}

std::set<std::string> StepPublisher::losslessTopics(const std::vector<std::string>& resolved_names) const
{
  std::string known;
  for (const std::string& topic : data_topics_)
    if (links_->subscribers(topic) < 0)
      known += topic + ", ";
  for (const std::string& topic : resolved_names)
    if (data_topics_.count(topic) == 0)
      throw ParameterError("~lossless_topics: found '" + topic + "', expected topics of every step: " + known +
                           "or one of a link or joint");
  return {resolved_names.begin(), resolved_names.end()};
}

std::uint32_t StepPublisher::subscribers(const std::string& topic) const
{
  std::vector<const ros::Publisher*> publishers = {
      &joint_states_publisher_, &contacts_publisher_, &step_report_publisher_, &certificate_publisher_,
      &markers_publisher_,      &tf_publisher_,       &bodies_publisher_};
  if (publish_clock_)
    publishers.push_back(&clock_publisher_);
  for (const ros::Publisher& publisher : odometry_publishers_)
    publishers.push_back(&publisher);
  for (const ros::Publisher& publisher : sensors_->publishers())
    publishers.push_back(&publisher);
  for (const ros::Publisher& publisher : body_joints_.publishers())
    publishers.push_back(&publisher);
  std::string known;
  for (const ros::Publisher* publisher : publishers)
  {
    if (publisher->getTopic() == topic)
      return publisher->getNumSubscribers();
    known += (known.empty() ? "" : ", ") + publisher->getTopic();
  }
  if (const int listeners = links_->subscribers(topic); listeners >= 0)
    return static_cast<std::uint32_t>(listeners);
  throw ParameterError("~wait_for_subscribers: found '" + topic + "', expected topics of this node: " + known +
                       " or one of a link or joint");
}

StepReport StepPublisher::report(double real_time_factor) const
{
  StepReport report;
  fillStepReport(simulator_.report(), real_time_factor, std::max(ros::TIME_MIN, toStamp(simulator_.time())), report);
  return report;
}

/** @brief Of the step just done, when it was checked. */
void StepPublisher::publishCertificate()
{
  const StepCertificate& certificate = simulator_.report().certificate;
  if (!certificate.checked || !listened(certificate_publisher_))
    return;
  fillCertificate(certificate, std::max(ros::TIME_MIN, toStamp(simulator_.time())), certificate_);
  certificate_publisher_.publish(certificate_);
}

void StepPublisher::publishReport(double real_time_factor)
{
  if (!listened(step_report_publisher_))
    return;
  fillStepReport(simulator_.report(), real_time_factor, std::max(ros::TIME_MIN, toStamp(simulator_.time())),
                 step_report_);
  step_report_publisher_.publish(step_report_);
}

void StepPublisher::publishClock()
{
  if (publish_clock_ && listened(clock_publisher_))
  {
    clock_.clock = stamp_;
    clock_publisher_.publish(clock_);
  }
}

const sensor_msgs::JointState& StepPublisher::jointStates()
{
  fillJointState(simulator_, names_, stamp_, joint_states_);
  return joint_states_;
}

const ContactArray& StepPublisher::contacts()
{
  fillContacts(simulator_, names_, stamp_, contacts_);
  return contacts_;
}

Bodies StepPublisher::bodies() const
{
  Bodies message;
  message.header.frame_id = WORLD_FRAME;
  message.header.stamp = stamp_;
  const Scenario& scenario = simulator_.scenario();
  message.ground_height = scenario.ground ? scenario.ground->height : std::numeric_limits<double>::quiet_NaN();
  for (const BodySpec& body : scenario.bodies)
  {
    const BodyDocument document = bodyDocument(body);
    message.names.push_back(body.name);
    message.urdfs.push_back(document.urdf);
    message.folders.push_back(document.folder);
  }
  return message;
}

const nav_msgs::Odometry& StepPublisher::odometry(int body)
{
  fillOdometry(simulator_, names_, body, stamp_, odometry_[body]);
  return odometry_[body];
}

const tf2_msgs::TFMessage& StepPublisher::transforms()
{
  transforms_.transforms = tf_->moving(stamp_);
  return transforms_;
}

void StepPublisher::publishStaticTransforms()
{
  tf_->sendStatic(stamp_, sensors_->transforms());
}

MarkerCounts StepPublisher::fillMarkers(const MarkerCounts& previous)
{
  markers_.markers.clear();
  body_markers_.append(stamp_, marker_scale_.size, markers_);
  return appendContactMarkers(simulator_, stamp_, marker_scale_, previous, markers_);
}

/** @brief For one who has no arrows yet; what the others have still counts for the next message. */
const visualization_msgs::MarkerArray& StepPublisher::allMarkers()
{
  fillMarkers(MarkerCounts());
  return markers_;
}

void StepPublisher::publishJointsAndContacts()
{
  if (listened(joint_states_publisher_))
    joint_states_publisher_.publish(jointStates());
  body_joints_.publish(stamp_);
  if (listened(contacts_publisher_))
    contacts_publisher_.publish(contacts());
}

void StepPublisher::publishOdometry()
{
  for (size_t body = 0; body < odometry_publishers_.size(); ++body)
    if (listened(odometry_publishers_[body]))
      odometry_publishers_[body].publish(odometry(static_cast<int>(body)));
}

void StepPublisher::publishTransforms()
{
  transforms_stamp_ = stamp_;
  if (listened(tf_publisher_))
    tf_->send(stamp_);
}

void StepPublisher::publishMarkers()
{
  markers_stamp_ = stamp_;
  if (listened(markers_publisher_))
  {
    marker_counts_ = fillMarkers(marker_counts_);
    markers_publisher_.publish(markers_);
  }
}

void StepPublisher::publish(double real_time_factor)
{
  const std::uint64_t step = simulator_.report().step;
  stamp_ = std::max(ros::TIME_MIN, toStamp(simulator_.time()));
  forces_.restart();
  if (clock_divider_.due(step))
    publishClock();
  if (state_divider_.due(step))
  {
    publishJointsAndContacts();
    links_->publish(stamp_);
    publishReport(real_time_factor);
    publishOdometry();
  }
  publishCertificate();
  sensors_->publish(stamp_);
  if (tf_divider_.due(step))
    publishTransforms();
  if (marker_divider_.due(step))
    publishMarkers();
}

void StepPublisher::publishRest()
{
  if (transforms_stamp_ != stamp_)
    publishTransforms();
  if (markers_stamp_ != stamp_)
    publishMarkers();
}

void StepPublisher::publishState()
{
  stamp_ = std::max(stamp_ + ros::Duration(0, 1), toStamp(simulator_.time()));
  forces_.restart();
  publishJointsAndContacts();
  links_->publish(stamp_);
  publishOdometry();
  publishTransforms();
  publishStaticTransforms();
  publishMarkers();
}

void StepPublisher::setTimeStep(double time_step)
{
  for (StepDivider* divider : {&state_divider_, &clock_divider_, &tf_divider_, &marker_divider_})
    divider->setTimeStep(time_step);
  sensors_->setTimeStep(time_step);
}

void StepPublisher::restartStamps()
{
  stamp_ = std::max(ros::TIME_MIN, toStamp(simulator_.time()));
}

}  // namespace frictional_contact_sim
