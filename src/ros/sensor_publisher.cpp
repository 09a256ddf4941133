#include "frictional_contact_sim/ros/sensor_publisher.h"

#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
constexpr std::uint32_t QUEUE = 2000;  // as the other topics of every step

void setCovariance(double deviation, boost::array<double, 9>& covariance)
{
  covariance.fill(0.0);
  for (const int i : {0, 4, 8})
    covariance[i] = deviation * deviation;
}

std::string frameId(const SensorSpec& sensor, const std::string& link)
{
  if (!sensor.frame.empty())
    return sensor.frame;
  return sensor.pose.isApprox(Eigen::Isometry3d::Identity(), 0.0) ? link : sensor.name;
}
}  // namespace

void fillImu(const Simulator& simulator, LinkForces& forces, int body, const SensorSpec& sensor, int seed,
             std::uint64_t sample, const ros::Time& stamp, sensor_msgs::Imu& message)
{
  const MultibodyModel& model = simulator.model(body);
  const int frame = sensorFrame(model, sensor);
  const Eigen::Isometry3d pose = framePose(model, simulator.data(body), frame) * sensor.pose;
  const Eigen::Vector3d turn = simulator.data(body).link_velocity[model.frames[frame].link].tail<3>();
  Eigen::Vector3d angular = pose.linear().transpose() * turn;
  Eigen::Vector3d linear = forces.specificForce(body, frame, sensor.pose);
  addSensorError(sensor, seed, sample, linear, angular);
  message.header.stamp = stamp;
  geometry_msgs::Pose whole;
  fillPose(pose, whole);
  message.orientation = whole.orientation;
  message.orientation_covariance.fill(0.0);
  fillVector(angular, message.angular_velocity);
  setCovariance(sensor.angular.noise, message.angular_velocity_covariance);
  fillVector(linear, message.linear_acceleration);
  setCovariance(sensor.linear.noise, message.linear_acceleration_covariance);
}

SensorPublisher::SensorPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, const Simulator& simulator,
                                 const NameTable& names, LinkForces& forces, int seed)
  : simulator_(simulator), names_(names), forces_(forces), seed_(seed)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
    for (const SensorSpec& spec : simulator.scenario().bodies[body].sensors)
    {
      const int frame = sensorFrame(simulator.model(body), spec);
      sensors_.push_back({body, frame, &spec, frameId(spec, names.frames[body][frame]),
                          StepDivider(spec.rate, simulator.scenario().time_step)});
      const std::string prefix = body == 0 ? "~sensors/" : "~sensors/" + simulator.bodyName(body) + "/";
      const std::string topic = spec.topic.empty() ? prefix + spec.name : spec.topic;
      const bool is_private = topic.front() == '~';
      ros::NodeHandle& handle = is_private ? private_node : node;
      const std::string name = is_private ? topic.substr(1) : topic;
      publishers_.push_back(spec.type == SensorSpec::Type::IMU
                                ? handle.advertise<sensor_msgs::Imu>(name, QUEUE)
                                : handle.advertise<geometry_msgs::WrenchStamped>(name, QUEUE));
    }
}

void SensorPublisher::send(const Sensor& sensor, const ros::Publisher& publisher, std::uint64_t sample,
                           const ros::Time& stamp)
{
  if (sensor.spec->type == SensorSpec::Type::IMU)
  {
    fillImu(simulator_, forces_, sensor.body, *sensor.spec, seed_, sample, stamp, imu_);
    imu_.header.frame_id = sensor.frame_id;
    publisher.publish(imu_);
    return;
  }
  const Vector6d wrench = forces_.jointWrench(sensor.body, sensor.frame);
  Eigen::Vector3d force = wrench.head<3>();
  Eigen::Vector3d torque = wrench.tail<3>();
  addSensorError(*sensor.spec, seed_, sample, force, torque);
  fillWrench((Vector6d() << force, torque).finished(), sensor.frame_id, stamp, wrench_);
  publisher.publish(wrench_);
}

void SensorPublisher::publish(const ros::Time& stamp)
{
  if (sensors_.empty() || !forces_.hasStep())
    return;
  const std::uint64_t sample = simulator_.state().scenario_clock.steps;
  for (size_t i = 0; i < sensors_.size(); ++i)
    if (sensors_[i].divider.due(sample) && publishers_[i].getNumSubscribers() > 0)
      send(sensors_[i], publishers_[i], sample, stamp);
}

void SensorPublisher::setTimeStep(double time_step)
{
  for (Sensor& sensor : sensors_)
    sensor.divider.setTimeStep(time_step);
}

const std::vector<ros::Publisher>& SensorPublisher::publishers() const
{
  return publishers_;
}

std::vector<geometry_msgs::TransformStamped> SensorPublisher::transforms() const
{
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (const Sensor& sensor : sensors_)
  {
    const std::string& link = names_.frames[sensor.body][sensor.frame];
    if (sensor.spec->type != SensorSpec::Type::IMU || sensor.frame_id == link)
      continue;
    transforms.emplace_back();
    transforms.back().header.frame_id = link;
    transforms.back().child_frame_id = sensor.frame_id;
    fillTransform(sensor.spec->pose, transforms.back().transform);
  }
  return transforms;
}

}  // namespace frictional_contact_sim
