#include "frictional_contact_sim/ros/bag_recorder.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <limits>

#include "frictional_contact_sim/ros/delivery.h"
#include "frictional_contact_sim/ros/end_request.h"
#include "frictional_contact_sim/ros/program.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PERIOD = 0.05;  // between two looks at the signal [s]
constexpr std::uint32_t UNBOUNDED = 0;  // queue size

const char* const HELP =
    "usage: record_bag OUTPUT.bag TOPIC [TOPIC ...]\n"
    "\n"
    "Records topics into a bag until SIGINT or SIGTERM, without ever dropping a message: a simulator_node at free run\n"
    "waits for it (~hold_limit). It writes OUTPUT.bag.active and renames it at the end; an existing OUTPUT.bag is\n"
    "replaced then, with a warning at the start. A second signal ends it at once: rosbag reindex OUTPUT.bag.active.\n"
    "\n"
    "  -h, --help     print this and end\n"
    "  --version      print the version and end\n"
    "\n"
    "Exit code: 0 recorded, 2 bad input or the file cannot be written (what was written stays).\n";

/** @brief Of the last system call, as part of a line; empty when there was none. */
std::string systemError(int error)
{
  if (error == 0)
    return "";
  std::string text = std::strerror(error);
  text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

bool exists(const std::string& file)
{
  return access(file.c_str(), F_OK) == 0;
}

int record(ros::NodeHandle& node, const std::string& file, const std::vector<std::string>& topics)
{
  // A limit on the size of files is an error of the write, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);
  BagRecorder recorder(node, file, topics);
  endInOrder();
  ros::CallbackQueue& queue = *ros::getGlobalCallbackQueue();
  while (!endRequested() && ros::ok() && recorder.failure().empty())
    queue.callAvailable(ros::WallDuration(PERIOD));
  queue.callAvailable();  // what has been received by now
  if (!recorder.close())
  {
    ROS_FATAL_STREAM(recorder.failure());
    return BAD_INPUT;
  }
  ROS_INFO_STREAM(file << ": " << recorder.messages() << " messages");
  return SUCCESS;
}

}  // namespace

BagRecorder::BagRecorder(ros::NodeHandle& node, const std::string& file, const std::vector<std::string>& topics)
  : file_(file), active_file_(file + ".active")
{
  if (exists(file_))
    ROS_WARN_STREAM(file_ << " exists: it is replaced when this recording ends");
  if (exists(active_file_))
    ROS_WARN_STREAM(active_file_ << " exists, of a recording that did not end: it is overwritten");
  bag_ = std::make_unique<rosbag::Bag>();
  errno = 0;
  try
  {
    bag_->open(active_file_, rosbag::bagmode::Write);
  }
  catch (const rosbag::BagException& error)
  {
    fail(error.what(), errno);
    return;
  }
  announcement_ = node.advertise<std_msgs::String>(LOSSLESS_NODES_TOPIC, 1, true);
  std_msgs::String name;
  name.data = ros::this_node::getName();
  announcement_.publish(name);
  for (const std::string& topic_name : topics)
  {
    const std::string topic = node.resolveName(topic_name);
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const ros::MessageEvent<topic_tools::ShapeShifter const>&>(
        topic, UNBOUNDED,
        [this, topic](const ros::MessageEvent<topic_tools::ShapeShifter const>& event) { write(topic, event); });
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    subscribers_.push_back(node.subscribe(options));
  }
}

/** @brief A bag that could not be written throws in its destructor too: it is left as it is, for rosbag reindex. */
void BagRecorder::fail(const std::string& what, int error)
{
  const std::string cause = systemError(error);
  failure_ = active_file_ + ": " + (cause.empty() ? what : cause) + " after " + std::to_string(messages_) +
             " messages" + (messages_ > 0 ? "; rosbag reindex makes it readable" : "");
  static_cast<void>(bag_.release());
}

void BagRecorder::write(const std::string& topic, const ros::MessageEvent<topic_tools::ShapeShifter const>& event)
{
  if (!failure_.empty())
    return;
  // Without a clock yet, simulated time is zero, which a bag does not take.
  const ros::Time time = std::max(event.getReceiptTime(), ros::TIME_MIN);
  errno = 0;
  try
  {
    bag_->write(topic, time, *event.getConstMessage(), event.getConnectionHeaderPtr());
    ++messages_;
  }
  catch (const rosbag::BagException& error)
  {
    fail(error.what(), errno);
  }
}

std::uint64_t BagRecorder::messages() const
{
  return messages_;
}

const std::string& BagRecorder::failure() const
{
  return failure_;
}

bool BagRecorder::close()
{
  subscribers_.clear();
  if (!failure_.empty())
    return false;
  errno = 0;
  try
  {
    bag_->close();
  }
  catch (const rosbag::BagException& error)
  {
    fail(error.what(), errno);
    return false;
  }
  if (std::rename(active_file_.c_str(), file_.c_str()) == 0)
    return true;
  failure_ = "cannot rename " + active_file_ + " to " + file_ + ": " + systemError(errno);
  return false;
}

int runBagRecorder(int argc, char** argv)
{
  const size_t any = std::numeric_limits<size_t>::max();
  return runProgram({"record_bag", HELP, 2, any}, argc, argv, ros::init_options::AnonymousName,
                    [](ros::NodeHandle& node, const std::vector<std::string>& arguments) {
                      return record(node, arguments[0], {arguments.begin() + 1, arguments.end()});
                    });
}

}  // namespace frictional_contact_sim
