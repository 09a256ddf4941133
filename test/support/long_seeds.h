#pragma once
// Seeds of scripts/long_tests: none in an ordinary run.
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
namespace test_support
{
/** 1000, 1001, ..., a tenth of FCS_LONG_TESTS in number; empty where that is not set. */
inline std::vector<std::uint32_t> longSeeds()
{
  const char* number = std::getenv("FCS_LONG_TESTS");
  std::vector<std::uint32_t> seeds(number == nullptr ? 0 : std::stoul(number) / 10);
  std::iota(seeds.begin(), seeds.end(), 1000U);
  return seeds;
}
}  // namespace test_support
}  // namespace frictional_contact_sim
