#include "frictional_contact_sim/ros/bag_recorder.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
constexpr int BAD_INPUT = 2;
constexpr double PERIOD = 0.05;  // between two looks at the signal [s]
constexpr std::uint32_t UNBOUNDED = 0;  // queue size

std::atomic<bool> interrupted{false};

void onSignal(int)
{
  interrupted = true;
}

}  // namespace

BagRecorder::BagRecorder(ros::NodeHandle& node, const std::string& file, const std::vector<std::string>& topics)
  : file_(file), bag_(file + ".active", rosbag::bagmode::Write)
{
  for (const std::string& name : topics)
  {
    const std::string topic = node.resolveName(name);
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const ros::MessageEvent<topic_tools::ShapeShifter const>&>(
        topic, UNBOUNDED,
        [this, topic](const ros::MessageEvent<topic_tools::ShapeShifter const>& event) { write(topic, event); });
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    subscribers_.push_back(node.subscribe(options));
  }
}

void BagRecorder::write(const std::string& topic, const ros::MessageEvent<topic_tools::ShapeShifter const>& event)
{
  // Without a clock yet, simulated time is zero, which a bag does not take.
  const ros::Time time = std::max(event.getReceiptTime(), ros::TIME_MIN);
  bag_.write(topic, time, *event.getConstMessage(), event.getConnectionHeaderPtr());
  ++messages_;
}

std::uint64_t BagRecorder::messages() const
{
  return messages_;
}

void BagRecorder::close()
{
  subscribers_.clear();
  bag_.close();
  if (std::rename((file_ + ".active").c_str(), file_.c_str()) != 0)
    throw std::runtime_error("cannot rename " + file_ + ".active to " + file_ + ": " + std::strerror(errno));
}

int runBagRecorder(int argc, char** argv)
{
  ros::init(argc, argv, "record_bag", ros::init_options::NoSigintHandler | ros::init_options::AnonymousName);
  if (argc < 3)
  {
    std::fprintf(stderr, "usage: record_bag OUTPUT.bag TOPIC [TOPIC ...]\n");
    return BAD_INPUT;
  }
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  try
  {
    ros::NodeHandle node;
    BagRecorder recorder(node, argv[1], std::vector<std::string>(argv + 2, argv + argc));
    ros::CallbackQueue& queue = *ros::getGlobalCallbackQueue();
    while (!interrupted && ros::ok())
      queue.callAvailable(ros::WallDuration(PERIOD));
    queue.callAvailable();  // what has been received by now
    recorder.close();
    ROS_INFO_STREAM(argv[1] << ": " << recorder.messages() << " messages");
    return 0;
  }
  catch (const std::exception& error)
  {
    ROS_FATAL_STREAM(argv[1] << ": " << error.what());
  }
  return BAD_INPUT;
}

}  // namespace frictional_contact_sim
