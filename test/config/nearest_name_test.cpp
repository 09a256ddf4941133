// Misspelt names: the distance by its definition, and one mistake of any kind in a long name is always seen through.
#include "frictional_contact_sim/config/nearest_name.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;

std::string randomWord(Dice& dice, int shortest, int longest, char last = 'z')
{
  std::string word;
  for (int length = dice.integer(shortest, longest); length > 0; --length)
    word += static_cast<char>(dice.integer('a', last));
  return word;
}

/// The recursion of the definition, without a table.
int distanceByDefinition(const std::string& a, const std::string& b)
{
  if (a.empty() || b.empty())
    return static_cast<int>(a.size() + b.size());
  const std::string shorter_a = a.substr(0, a.size() - 1), shorter_b = b.substr(0, b.size() - 1);
  int least = std::min({distanceByDefinition(shorter_a, b) + 1, distanceByDefinition(a, shorter_b) + 1,
                        distanceByDefinition(shorter_a, shorter_b) + (a.back() == b.back() ? 0 : 1)});
  if (a.size() > 1 && b.size() > 1 && a.back() == b[b.size() - 2] && b.back() == a[a.size() - 2])
    least = std::min(least, distanceByDefinition(a.substr(0, a.size() - 2), b.substr(0, b.size() - 2)) + 1);
  return least;
}

/// One letter dropped, doubled, replaced, or two neighbours swapped.
std::string mistake(const std::string& name, Dice& dice)
{
  std::string wrong = name;
  const auto place = static_cast<size_t>(dice.integer(0, static_cast<int>(name.size()) - 2));
  switch (dice.integer(0, 3))
  {
    case 0:
      return wrong.erase(place, 1);
    case 1:
      return wrong.insert(place, 1, 'q');
    case 2:
      wrong[place] = '_';
      return wrong;
    default:
      std::swap(wrong[place], wrong[place + 1]);
      return wrong;
  }
}
}  // namespace

TEST(EditDistanceTest, IsThatOfTheDefinition)
{
  Dice dice(1);
  for (int k = 0; k < 300; ++k)
  {
    const std::string a = randomWord(dice, 0, 5, 'c'), b = randomWord(dice, 0, 5, 'c');
    EXPECT_EQ(editDistance(a, b), distanceByDefinition(a, b)) << a << ' ' << b;
    EXPECT_EQ(editDistance(a, b), editDistance(b, a));
  }
}

TEST(NearestNameTest, OneMistakeIsSeenThroughAndAnotherWordIsNot)
{
  const std::vector<std::string> names = {"time_step", "gravity", "solver", "materials", "ground", "bodies", "failure"};
  Dice dice(2);
  for (int k = 0; k < 500; ++k)
  {
    const std::string& name = names[static_cast<size_t>(dice.integer(0, static_cast<int>(names.size()) - 1))];
    const std::string wrong = mistake(name, dice);
    EXPECT_EQ(nearestName(wrong, names), name) << wrong;
  }
  EXPECT_EQ(nearestName("GRAVITY", names), "gravity");
  EXPECT_EQ(nearestName("banana", names), "");
  EXPECT_EQ(nearestName("", names), "");
  EXPECT_EQ(nearestName(std::string(100000, 'a'), names), "");
  EXPECT_EQ(didYouMean("gravty", names), "did you mean 'gravity'? ");
}

TEST(NearestNameTest, ListsAndLines)
{
  EXPECT_EQ(joinNames({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(eitherOf({"a", "b", "c"}), "a, b or c");
  EXPECT_EQ(eitherOf({"a"}), "a");
  EXPECT_EQ(inOneLine("a\nb\tc\r"), "a b c ");
  EXPECT_EQ(inOneLine("abcdef", 3), "abc...");
}

}  // namespace frictional_contact_sim
