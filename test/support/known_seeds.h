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
      {"slow", "a step without an end of its iterations (part 8, verdict)", {4, 14, 23, 38, 75, 107, 144, 194, 206}},
      {"balance",
       "order 2 with the bias at v_k: fast light links (part 8, bias)",
       {8,   46,  48,  89,  97,  98,  103, 106, 120, 121, 122, 130, 131, 135, 161,
        166, 178, 184, 187, 195, 202, 204, 207, 234, 250, 252, 275, 278, 298}},
      {"cone", "the same (part 8, scale of E)", {94, 166, 237}},
      {"failed",
       "scale of E, round-off q and fallback (part 8, scale and verdict)",
       {6,   7,   9,   18,  26,  28,  31,  39,  45,  52,  55,  60,  77,  78,  84,  85,  100, 119, 128,
        133, 150, 158, 162, 165, 175, 181, 183, 188, 190, 191, 196, 197, 198, 204, 227, 231, 238, 239,
        245, 253, 262, 263, 271, 272, 277, 278, 279, 284, 285, 286, 292, 301, 307, 310, 314, 316, 318}},
      {"friction", "the same (part 8, scale of E)", {61, 66, 94, 123, 164, 166, 171, 212, 228, 237, 311}},
      {"gap",
       "E is relative to |r|/rho (part 8, scale of E)",
       {5,   15,  20,  30,  34,  44,  50,  61,  63,  66,  68,  69,  72,  76,  86,  94,  103, 123,
        142, 164, 166, 171, 180, 196, 212, 228, 230, 237, 239, 246, 254, 261, 276, 283, 311}},
      {"islands",
       "the margin of contacts comes from the fastest body of all, |q| of E too (part 8 and 9)",
       {10, 30, 60, 61, 120, 130, 140, 141, 150, 161, 190, 191, 211, 220, 241, 271, 301}},
      {"momentum",
       "single links with their origin off the centre of mass are of order 2 (part 8, free links)",
       {3,   19,  22,  33,  36,  42,  49,  55,  64,  67,  70,  82,  88,  91,  99,  110, 111, 123, 124,
        127, 132, 139, 141, 146, 147, 164, 166, 170, 177, 179, 202, 208, 212, 219, 223, 226, 228, 230,
        236, 240, 246, 254, 255, 256, 260, 261, 274, 283, 287, 294, 299, 300, 302, 312, 314, 315, 319}},
      {"penetration",
       "end poses are not looked at (part 9)",
       {20, 36, 43, 63, 70, 98, 103, 146, 151, 178, 187, 207, 218, 226, 250, 258}},
      {"rise", "the same (part 8, bias)", {8, 166, 278}},
      {"self-stress", "forces are not of least norm (part 8)", {166, 276}},
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
