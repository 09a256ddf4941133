#pragma once
/**
 * @file failure.h
 * @brief What becomes of a step that has no answer: key `failure` of a scenario, ~on_failure, ~fallback and
 * ~step_time_limit of the node.
 */
#include <string>

namespace frictional_contact_sim
{
/**
 * @brief What a failed step (or impact at the start, or after a state was set) leaves behind. The outcome says in every
 * case that it failed. A step that a signal ended (STOPPED_BY_USER) is not taken, whatever the policy.
 */
enum class FailurePolicy
{
  STOP,  ///< the step is not taken: state and time are those before it, to the bit; the caller ends the run
  PAUSE,  ///< the same; the caller pauses, the next step() tries again
  HOLD,  ///< q stays, v = 0, time and prescribed bases go on; the kinetic energy taken is booked as dissipated by
         ///< impact
  ACCEPT  ///< the best finite iterate is taken where its energy check holds, else as HOLD
};

/** @brief stop, pause, hold, accept. */
const char* toString(FailurePolicy policy);
/** @throws std::invalid_argument naming what was found and what was expected */
FailurePolicy parseFailurePolicy(const std::string& name);

struct FailureOptions
{
  FailurePolicy policy = FailurePolicy::STOP;
  bool fallback = true;  ///< other methods are tried before a step is given up
  double time_limit = 0.0;  ///< wall clock of a whole step, rounds and fallbacks together [s], 0 = none
};

}  // namespace frictional_contact_sim
