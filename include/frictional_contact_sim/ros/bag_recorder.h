#pragma once
/**
 * @file bag_recorder.h
 * @brief A recorder that never drops: `record_bag OUTPUT.bag TOPIC ...`.
 *
 * rosbag record keeps at most 100 messages a topic between its sockets and its writer, and drops the oldest when a run
 * as fast as possible meets a busy machine. This one has no such bound, and empties its queue before it ends.
 */
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>

#include <cstdint>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
class BagRecorder
{
public:
  /**
   * @param file written as FILE.active until close(); extension as given
   * @throws rosbag::BagException when it cannot be written
   */
  BagRecorder(ros::NodeHandle& node, const std::string& file, const std::vector<std::string>& topics);

  std::uint64_t messages() const;
  /** @brief Writes the index and gives the file its name. @throws std::runtime_error when that fails */
  void close();

private:
  void write(const std::string& topic, const ros::MessageEvent<topic_tools::ShapeShifter const>& event);

  std::string file_;
  rosbag::Bag bag_;
  std::vector<ros::Subscriber> subscribers_;
  std::uint64_t messages_ = 0;
};

/** @brief The whole program: records until interrupted. @return exit code: 0, or 2 for bad input */
int runBagRecorder(int argc, char** argv);

}  // namespace frictional_contact_sim
