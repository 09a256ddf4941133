#include "mutation.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
const std::vector<std::string> NUMBERS = {"1e308",       "-1e308", "1e30", "-1",    "0",
                                          "-0.0",        "nan",    "inf",  "-inf",  "1e-320",
                                          "1e999",       "1e9",    "-1e9", "1e-12", "99999999999999999999",
                                          "-2147483649", "1,5",    "0x10", "",      "1e",
                                          "abc"};

size_t place(const std::string& content, Dice& dice)
{
  return static_cast<size_t>(dice.integer(0, static_cast<int>(content.size()) - 1));
}

/** Mostly short, now and then a good part of the file. */
size_t chunk(const std::string& content, Dice& dice)
{
  const double longest = dice.chance(0.8) ? 40.0 : static_cast<double>(content.size());
  return static_cast<size_t>(dice.logUniform(1.0, longest + 1.0));
}

void flipBits(std::string& content, Dice& dice)
{
  for (int k = dice.integer(1, 8); k > 0; --k)
    content[place(content, dice)] ^= static_cast<char>(1 << dice.integer(0, 7));
}

void deleteChunk(std::string& content, Dice& dice)
{
  content.erase(place(content, dice), chunk(content, dice));
}

void repeatChunk(std::string& content, Dice& dice)
{
  const std::string copy = content.substr(place(content, dice), chunk(content, dice));
  content.insert(place(content, dice), copy);
}

void exchangeChunks(std::string& content, Dice& dice)
{
  size_t first = place(content, dice);
  size_t second = place(content, dice);
  if (first > second)
    std::swap(first, second);
  const size_t size = std::min({chunk(content, dice), second - first, content.size() - second});
  std::swap_ranges(content.begin() + static_cast<long>(first), content.begin() + static_cast<long>(first + size),
                   content.begin() + static_cast<long>(second));
}

void cutEnd(std::string& content, Dice& dice)
{
  content.resize(place(content, dice));
}

/** Replaces one run of characters that `belongs`, the first at or after a random place. */
void replaceRun(std::string& content, Dice& dice, const std::function<bool(char)>& belongs,
                const std::function<std::string(const std::string&)>& replacement)
{
  const auto from = content.begin() + static_cast<long>(place(content, dice));
  const auto begin = std::find_if(from, content.end(), belongs);
  const auto end = std::find_if_not(begin, content.end(), belongs);
  if (begin != end)
    content.replace(begin, end, replacement(std::string(begin, end)));
}

void replaceNumber(std::string& content, Dice& dice)
{
  const auto belongs = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-'; };
  replaceRun(content, dice, belongs,
             [&](const std::string&)
             { return NUMBERS[static_cast<size_t>(dice.integer(0, static_cast<int>(NUMBERS.size()) - 1))]; });
}

void renameWord(std::string& content, Dice& dice)
{
  const auto belongs = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  std::string other;  // a word of the same file, as a copy that went wrong
  std::string scratch = content;
  replaceRun(scratch, dice, belongs,
             [&](const std::string& word)
             {
               other = word;
               return word;
             });
  replaceRun(content, dice, belongs,
             [&](const std::string& word)
             { return dice.chance(0.5) ? other : word + static_cast<char>(dice.integer(33, 126)); });
}

template <typename Number>
void overwrite(std::string& content, Dice& dice, Number number)
{
  if (content.size() < sizeof number)
    return;
  const size_t aligned = dice.chance(0.5) ? 7u : 0u;
  const size_t at = std::min(place(content, dice) & ~aligned, content.size() - sizeof number);
  std::memcpy(&content[at], &number, sizeof number);
}

void overwriteNumber(std::string& content, Dice& dice)
{
  const double numbers[] = {std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(),
                            -1e308,
                            1e308,
                            0.0,
                            -1.0,
                            1e30};
  const int integers[] = {-1, 0, 1, 2, 1000, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  if (dice.chance(0.5))
    overwrite(content, dice, numbers[dice.integer(0, 6)]);
  else
    overwrite(content, dice, integers[dice.integer(0, 6)]);
}
}  // namespace

std::string mutate(std::string content, bool is_binary, Dice& dice)
{
  using Mutation = void (*)(std::string&, Dice&);
  const std::vector<Mutation> text = {flipBits,      deleteChunk,   repeatChunk,   exchangeChunks, cutEnd,
                                      replaceNumber, replaceNumber, replaceNumber, renameWord,     renameWord};
  const std::vector<Mutation> binary = {flipBits, flipBits,        deleteChunk,     repeatChunk,    exchangeChunks,
                                        cutEnd,   overwriteNumber, overwriteNumber, overwriteNumber};
  const std::vector<Mutation>& kinds = is_binary ? binary : text;
  for (int k = dice.integer(1, 4); k > 0 && !content.empty(); --k)
    kinds[static_cast<size_t>(dice.integer(0, static_cast<int>(kinds.size()) - 1))](content, dice);
  return content;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
