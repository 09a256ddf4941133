#pragma once
/**
 * @file mutation.h
 * @brief Damage to the content of a file, as disks, editors and other programs do it; the same for the same dice.
 */
#include <string>

#include "support/dice.h"

namespace frictional_contact_sim
{
namespace test_support
{
/**
 * @brief One to four of: bits flipped, a chunk deleted or written twice, two chunks exchanged, the end cut off, and
 * in texts a number replaced (huge, negative, not finite, not a number), a word renamed, in binary files eight bytes
 * replaced by such numbers.
 */
std::string mutate(std::string content, bool is_binary, Dice& dice);

}  // namespace test_support
}  // namespace frictional_contact_sim
