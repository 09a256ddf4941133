#pragma once
/**
 * @file allocation_count.h
 * @brief Counts the calls of operator new in this test executable.
 */
#include <cstddef>

namespace frictional_contact_sim
{
size_t allocationCount();
}  // namespace frictional_contact_sim
