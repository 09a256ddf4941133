#include "frictional_contact_sim/simulation/failure.h"

#include <stdexcept>

namespace frictional_contact_sim
{
const char* toString(FailurePolicy policy)
{
  switch (policy)
  {
    case FailurePolicy::STOP:
      return "stop";
    case FailurePolicy::PAUSE:
      return "pause";
    case FailurePolicy::HOLD:
      return "hold";
    case FailurePolicy::ACCEPT:
      return "accept";
  }
  return "unknown";
}

FailurePolicy parseFailurePolicy(const std::string& name)
{
  for (const FailurePolicy policy :
       {FailurePolicy::STOP, FailurePolicy::PAUSE, FailurePolicy::HOLD, FailurePolicy::ACCEPT})
    if (name == toString(policy))
      return policy;
  throw std::invalid_argument("found '" + name + "', expected stop, pause, hold or accept");
}

}  // namespace frictional_contact_sim
