#pragma once
/**
 * @file known_seeds.h
 * @brief Like known_faults.h, for the random scenes: seeds that are known to have a fault today, by kind. Those are
 * printed, all others fail the test. Kind "slow" is not run at all: a step of it takes minutes.
 */
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief Seeds of random_robots_test.cpp with a fault that is known. */
struct KnownSeeds
{
  const char* kind;
  const char* why;
  std::vector<std::uint32_t> seeds;
};

inline const std::vector<KnownSeeds>& knownSeeds()
{
  static const std::vector<KnownSeeds> table = {
      {"slow",
       "hundreds of rows on few velocities, steps of seconds (part 9: rows that cannot act)",
       {38, 75, 107, 144}},
      {"balance",
       "light links turn by more than 0.3 rad a step: the scheme's order 2, not traced seed by seed",
       {97, 106, 130, 158, 161, 178, 184, 187, 234, 250, 263, 271}},
      {"failed",
       "128, 163, 166, 171, 201, 249, 276, 310: jaws overlap a block by the 1e-13 m of the file's digits on both "
       "sides, "
       "which no recovery can undo; others: E of 1e-8 to 1e-7 on contacts of hundreds of rows, not traced",
       {4,   23,  39,  119, 128, 163, 165, 166, 171, 194, 201, 202, 226,
        234, 249, 250, 271, 275, 276, 278, 279, 301, 307, 310, 314}},
      {"momentum", "1.3e-10 of the largest term with 1e3 times the loads between two jaws", {276}},
      {"penetration", "end poses are not looked at (part 9)", {14,  206, 20,  36,  43,  63,  67,  103, 124,
                                                               151, 158, 178, 183, 190, 207, 218, 230, 258,
                                                               262, 263, 271, 277, 279, 284, 286, 298, 316}},
      {"rise", "the same as balance", {263, 271, 278}},
      {"self-stress", "the same jaws", {276}},
  };
  return table;
}

inline bool isKnownSeed(const std::string& kind, std::uint32_t seed)
{
  for (const KnownSeeds& known : knownSeeds())
    if (kind == known.kind && std::find(known.seeds.begin(), known.seeds.end(), seed) != known.seeds.end())
      return true;
  return false;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
