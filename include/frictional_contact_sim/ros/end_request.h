#pragma once
/**
 * @file end_request.h
 * @brief SIGINT and SIGTERM: the first asks for an end, with a master or without one, the second ends the process.
 */
#include <atomic>

namespace frictional_contact_sim
{
/** @brief After ros::init with NoSigintHandler, before the first NodeHandle. Until endInOrder() a signal shuts ROS
 * down, so that nothing waits on.
 */
void endOnSignals();
/** @brief From now on a signal, or rosnode kill, only sets the flag: the caller looks at it, sends what has to be sent,
 * and returns. */
void endInOrder();
/** @brief Set by the first signal; lives as long as the process. */
const std::atomic<bool>& endRequested();
/** @brief Returns when the master answers, with one line if it does not at once. @return false: an end was asked for */
bool waitForMaster();

}  // namespace frictional_contact_sim
