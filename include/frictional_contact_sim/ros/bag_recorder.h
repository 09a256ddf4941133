#pragma once
/**
 * @file bag_recorder.h
 * @brief A recorder that never drops: `record_bag OUTPUT.bag TOPIC ...`.
 *
 * rosbag record keeps at most 100 messages a topic between its sockets and its writer, and drops the oldest when a run
 * as fast as possible meets a busy machine. This one has no such bound, announces itself to simulator_node, which then
 * waits for it at free run (ros/delivery.h), and empties its queue before it ends.
 */
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
class BagRecorder
{
public:
  /**
   * @param file written as FILE.active until close(); extension as given. One that cannot be opened is a failure()
   */
  BagRecorder(ros::NodeHandle& node, const std::string& file, const std::vector<std::string>& topics);

  std::uint64_t messages() const;
  /** @brief Empty, or one line: the file, what is wrong with it, and what was written. Nothing is written from then on.
   */
  const std::string& failure() const;
  /** @brief Writes the index and gives the file its name. @return false after a failure */
  bool close();

private:
  void write(const std::string& topic, const ros::MessageEvent<topic_tools::ShapeShifter const>& event);
  void fail(const std::string& what, int error);

  std::string file_;
  std::string active_file_;
  std::string failure_;
  std::unique_ptr<rosbag::Bag> bag_;
  ros::Publisher announcement_;
  std::vector<ros::Subscriber> subscribers_;
  std::uint64_t messages_ = 0;
};

/** @brief The whole program: records until interrupted. @return exit code: 0, or 2 for bad input and a full disk */
int runBagRecorder(int argc, char** argv);

}  // namespace frictional_contact_sim
