/**
 * @file record_bag.cpp
 * @brief record_bag OUTPUT.bag TOPIC [TOPIC ...]: records topics without ever dropping a message, until interrupted.
 */
#include "frictional_contact_sim/ros/bag_recorder.h"

int main(int argc, char** argv)
{
  return frictional_contact_sim::runBagRecorder(argc, argv);
}
