#pragma once
/**
 * @file isolation.h
 * @brief Runs a piece of work in a child process, so that a crash, an exit() or an endless loop costs only that piece.
 */
#include <cstddef>
#include <functional>
#include <memory>

namespace comparison
{
enum class Ending
{
  FINISHED,
  TIME_LIMIT,
  CRASHED  ///< died of a signal or left the process
};

/** @brief Zeroed memory that parent and children share. */
class SharedMemory
{
public:
  explicit SharedMemory(size_t bytes);
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  template <typename Value>
  Value* as()
  {
    return static_cast<Value*>(data_);
  }

private:
  void* data_;
  size_t bytes_;
};

/** @brief Runs work in a child with its output silenced, and waits. */
Ending runIsolated(const std::function<void()>& work);

/** @brief In the child: ends it when it uses this much more CPU time [s]; 0 = no limit. */
void limitCpuTime(double seconds);

/** @brief CPU time of this thread [s]. */
double cpuTime();

/** @brief What a pair of cpuTime() calls costs [s]; measured once. */
double clockOverhead();

}  // namespace comparison
