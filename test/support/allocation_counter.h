#pragma once
/**
 * @file allocation_counter.h
 * @brief Counts heap allocations of the process, operator new and Eigen's malloc alike: malloc itself is replaced in
 * the test executables that link test/support.
 */
namespace frictional_contact_sim
{
namespace test_support
{
/** @brief Counts from its construction on; this thread only. */
class AllocationCounter
{
public:
  AllocationCounter();
  ~AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;

  /** @brief Calls of malloc, calloc, realloc and the aligned forms since construction. */
  long count() const;

private:
  long start_;
};

}  // namespace test_support
}  // namespace frictional_contact_sim
