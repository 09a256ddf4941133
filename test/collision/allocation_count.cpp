#include "allocation_count.h"

#include <cstdlib>
#include <new>

// In a file of its own: where both are inlined, the compiler warns of malloc's memory given to delete.
namespace
{
size_t count = 0;
}

void* operator new(size_t size)
{
  ++count;
  void* memory = std::malloc(size);
  if (!memory)
  {
    throw std::bad_alloc();
  }
  return memory;
}

void operator delete(void* memory) noexcept
{
  std::free(memory);
}

void operator delete(void* memory, size_t) noexcept
{
  std::free(memory);
}

namespace frictional_contact_sim
{
size_t allocationCount()
{
  return count;
}
}  // namespace frictional_contact_sim
