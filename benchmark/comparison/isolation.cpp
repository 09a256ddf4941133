#include "comparison/isolation.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <limits>
#include <stdexcept>

namespace comparison
{
namespace
{
constexpr int DONE = 77;  ///< exit code of a child that came to its end; exit() inside a library gives another
}  // namespace

SharedMemory::SharedMemory(size_t bytes)
  : data_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)), bytes_(bytes)
{
  if (data_ == MAP_FAILED)
    throw std::runtime_error("no shared memory");
}

SharedMemory::~SharedMemory()
{
  munmap(data_, bytes_);
}

Ending runIsolated(const std::function<void()>& work)
{
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0)
    throw std::runtime_error("cannot start a child process");
  if (child == 0)
  {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    try
    {
      work();
    }
    catch (const std::exception&)
    {
      _exit(1);
    }
    _exit(DONE);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR)
  {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == DONE)
    return Ending::FINISHED;
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? Ending::TIME_LIMIT : Ending::CRASHED;
}

void limitCpuTime(double seconds)
{
  itimerval timer = {};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds)));
  setitimer(ITIMER_PROF, &timer, nullptr);
}

double cpuTime()
{
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double clockOverhead()
{
  static const double overhead = []
  {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 2000; ++k)
    {
      const double start = cpuTime();
      least = std::min(least, cpuTime() - start);
    }
    return least;
  }();
  return overhead;
}

}  // namespace comparison
