#include "frictional_contact_sim/math/blas_threads.h"

#include <dlfcn.h>

#include <mutex>

namespace frictional_contact_sim
{
void useOneBlasThread()
{
  static std::once_flag once;
  std::call_once(once,
                 []
                 {
                   const auto setThreads =
                       reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
                   if (setThreads != nullptr)
                     setThreads(1);
                 });
}

}  // namespace frictional_contact_sim
