#pragma once
// FNV-1a, 64 bits (Fowler, Noll, Vo 1991).
#include <cstdint>

namespace frictional_contact_sim
{
class Fnv1a
{
public:
  void add(unsigned char byte) { state_ = (state_ ^ byte) * 1099511628211ULL; }
  /** Its eight bytes, the lowest first. */
  void add(std::uint64_t bits)
  {
    for (int byte = 0; byte < 8; ++byte)
      add(static_cast<unsigned char>(bits >> (8 * byte)));
  }
  std::uint64_t value() const { return state_; }

private:
  std::uint64_t state_ = 14695981039346656037ULL;
};

}  // namespace frictional_contact_sim
