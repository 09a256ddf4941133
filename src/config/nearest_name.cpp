#include "frictional_contact_sim/config/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
/// Names are short; what is longer than this is no misspelt name.
constexpr size_t LONGEST_NAME = 100;

bool sameLetter(char a, char b)
{
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}
}  // namespace

int editDistance(const std::string& a, const std::string& b)
{
  // Rows of the table of distances between the beginnings of a and b: the last but one, the last, the present one.
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j)
    row[j] = static_cast<int>(j);
  for (size_t i = 1; i <= a.size(); ++i)
  {
    before.swap(last);
    last.swap(row);
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= b.size(); ++j)
    {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (sameLetter(a[i - 1], b[j - 1]) ? 0 : 1)});
      if (i > 1 && j > 1 && sameLetter(a[i - 1], b[j - 2]) && sameLetter(a[i - 2], b[j - 1]))
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string nearestName(const std::string& found, const std::vector<std::string>& valid)
{
  std::string nearest;
  int least = std::numeric_limits<int>::max();
  if (found.size() > LONGEST_NAME)
    return nearest;
  for (const std::string& name : valid)
  {
    const int distance = editDistance(found, name);
    const int letters = static_cast<int>(std::max(found.size(), name.size()));
    if (distance < least && 3 * distance <= letters)
    {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

std::string didYouMean(const std::string& found, const std::vector<std::string>& valid)
{
  const std::string nearest = nearestName(found, valid);
  return nearest.empty() ? "" : "did you mean '" + nearest + "'? ";
}

std::string joinNames(const std::vector<std::string>& names)
{
  std::string joined;
  for (const std::string& name : names)
    joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

std::string eitherOf(const std::vector<std::string>& names)
{
  std::string joined;
  for (size_t i = 0; i < names.size(); ++i)
    joined += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return joined;
}

std::string inOneLine(const std::string& text, size_t longest)
{
  std::string line = text.size() > longest ? text.substr(0, longest) + "..." : text;
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return std::iscntrl(static_cast<unsigned char>(letter)) != 0; }, ' ');
  return line;
}

}  // namespace frictional_contact_sim
