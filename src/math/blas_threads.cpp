#include "frictional_contact_sim/math/blas_threads.h"

#include <dlfcn.h>

namespace frictional_contact_sim
{
namespace
{
struct OpenBlas
{
  int (*threads)() = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  void (*setThreads)(int) = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
};

const OpenBlas& openBlas()
{
  static const OpenBlas functions;
  return functions;
}
}  // namespace

OneBlasThread::OneBlasThread()
{
  const OpenBlas& blas = openBlas();
  if (blas.threads == nullptr || blas.setThreads == nullptr || blas.threads() <= 1)
    return;
  before_ = blas.threads();
  blas.setThreads(1);
}

OneBlasThread::~OneBlasThread()
{
  if (before_ > 0)
    openBlas().setThreads(before_);
}

}  // namespace frictional_contact_sim
