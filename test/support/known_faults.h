#pragma once
/**
 * @file known_faults.h
 * @brief Every fault that a test's run is known to have today, in one place: printed, not failed. A row goes when the
 * part that is named has landed; nothing else may silence an invariant.
 */
#include <string>
#include <vector>

namespace frictional_contact_sim
{
namespace test_support
{
struct KnownFault
{
  const char* test;  ///< end of GoogleTest's "Suite.Name"
  const char* kind;  ///< run_audit.h
  const char* why;
};

inline const std::vector<KnownFault>& knownFaults()
{
  static const std::vector<KnownFault> table = {
      {"WhileItFalls/boxes12", "failed", "no method reaches 1e-8 of g dt in its budget (E is some 1e-7)"},
      {"WhileItFalls/pyramid5", "failed", "the bias does not settle in five rounds while boxes of the pyramid slide"},
  };
  return table;
}

/** @brief Why a fault is known, or null. */
inline const char* knownFault(const std::string& test, const std::string& kind)
{
  for (const KnownFault& fault : knownFaults())
  {
    const std::string end = fault.test;
    if (test.size() >= end.size() && test.compare(test.size() - end.size(), end.size(), end) == 0 && kind == fault.kind)
      return fault.why;
  }
  return nullptr;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
