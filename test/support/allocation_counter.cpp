#include "support/allocation_counter.h"

#include <cerrno>
#include <cstddef>

namespace
{
thread_local long allocations = 0;
thread_local int counters = 0;
}  // namespace

namespace frictional_contact_sim
{
namespace test_support
{
AllocationCounter::AllocationCounter() : start_(allocations)
{
  ++counters;
}

AllocationCounter::~AllocationCounter()
{
  --counters;
}

long AllocationCounter::count() const
{
  return allocations - start_;
}
}  // namespace test_support
}  // namespace frictional_contact_sim

// glibc keeps its own entry points under these names; ours take the public ones. A sanitizer has taken them already.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace
{
void note()
{
  if (counters > 0)
    ++allocations;
}
}  // namespace

extern "C"
{
  void* __libc_malloc(size_t size);
  void* __libc_calloc(size_t count, size_t size);
  void* __libc_realloc(void* memory, size_t size);
  void* __libc_memalign(size_t alignment, size_t size);

  void* malloc(size_t size)
  {
    note();
    return __libc_malloc(size);
  }
  void* calloc(size_t count, size_t size)
  {
    note();
    return __libc_calloc(count, size);
  }
  void* realloc(void* memory, size_t size)
  {
    note();
    return __libc_realloc(memory, size);
  }
  void* aligned_alloc(size_t alignment, size_t size)
  {
    note();
    return __libc_memalign(alignment, size);
  }
  int posix_memalign(void** memory, size_t alignment, size_t size)
  {
    note();
    *memory = __libc_memalign(alignment, size);
    return *memory == nullptr ? ENOMEM : 0;
  }
}
#endif
