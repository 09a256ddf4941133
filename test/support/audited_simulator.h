#pragma once
/**
 * @file audited_simulator.h
 * @brief A Simulator for tests that has every step audited (run_audit.h) and fails the test that made it when an
 * invariant does not hold. `waive(kind)` is for tests whose subject is the breach itself (a failing solver, say).
 */
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <set>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"
#include "support/known_faults.h"
#include "support/run_audit.h"

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief "Suite.Name" of the running test. */
inline std::string testName()
{
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  return info == nullptr ? "" : std::string(info->test_suite_name()) + "." + info->name();
}

/** @brief Fails the running test for every fault but the known ones, which are printed. */
inline void expectNoFaults(RunAudit& audit, const std::set<std::string>& waived = {})
{
  for (const auto& [kind, fault] : audit.finish())
  {
    if (waived.count(kind) > 0)
      continue;
    const std::string text = kind + ": " + std::to_string(fault.count) + " times, first at step " +
                             std::to_string(fault.first_step) + ", worst: " + fault.text;
    if (const char* why = knownFault(testName(), kind))
      std::cout << "[  known   ] " << testName() << ": " << text << " (" << why << ")\n";
    else
      ADD_FAILURE() << "audit: " << text;
  }
}

class AuditedSimulator : public Simulator
{
public:
  template <typename World>
  explicit AuditedSimulator(const World& world, const AuditOptions& options = {})
    : Simulator(world), audit_(std::make_unique<RunAudit>(*this, options))
  {
  }
  AuditedSimulator(const AuditedSimulator&) = delete;
  AuditedSimulator& operator=(const AuditedSimulator&) = delete;
  ~AuditedSimulator() { expectNoFaults(*audit_, waived_); }

  const StepOutcome& step()
  {
    audit_->beforeStep();
    Simulator::step();
    audit_->afterStep();
    return outcome();
  }
  const StepOutcome& reset() { return restarted(Simulator::reset()); }
  const StepOutcome& setState(const SimulationState& state) { return restarted(Simulator::setState(state)); }
  const StepOutcome& stateChanged() { return restarted(Simulator::stateChanged()); }
  void waive(const std::string& kind) { waived_.insert(kind); }

private:
  const StepOutcome& restarted(const StepOutcome& outcome)
  {
    audit_->restart();
    return outcome;
  }

  std::unique_ptr<RunAudit> audit_;
  std::set<std::string> waived_;
};

}  // namespace test_support
}  // namespace frictional_contact_sim
