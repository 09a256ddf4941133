#include "frictional_contact_sim/solver/solver_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/solver/option_table.h"

namespace frictional_contact_sim
{
namespace
{
/** The whole text as a number; NaN where it is none. */
double parseNumber(const std::string& text)
{
  const size_t sign = text.size() > 1 && text[0] == '+' ? 1 : 0;  // from_chars knows no plus
  double value = 0.0;
  const char* last = text.data() + text.size();
  const std::from_chars_result end = std::from_chars(text.data() + sign, last, value);
  if (end.ec == std::errc() && end.ptr == last)
    return value;
  return text == ".inf" ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> namesOf(const std::vector<SolverOption>& options)
{
  std::vector<std::string> names;
  for (const SolverOption& option : options)
    names.push_back(option.name);
  return names;
}
}  // namespace

std::string SolverOption::expected() const
{
  return words.empty() ? range.expected(is_integer ? "an integer" : "a number") : eitherOf(words);
}

double parseOption(const std::string& method, const SolverOption& option, const std::string& text)
{
  const auto refuse = [&](const std::string& hint)
  {
    throw std::invalid_argument("option " + option.name + " of " + method + ": found '" + inOneLine(text, 80) +
                                "', expected " + option.expected() + hint);
  };
  if (!option.words.empty())
  {
    const auto word = std::find(option.words.begin(), option.words.end(), text);
    const std::string nearest = nearestName(text, option.words);
    if (word == option.words.end())
      refuse(nearest.empty() ? "" : " (did you mean '" + nearest + "'?)");
    return static_cast<double>(word - option.words.begin());
  }
  const double value = parseNumber(text);
  const bool fits = !option.is_integer || (value == std::floor(value) && std::abs(value) < 2147483648.0);
  if (!fits || !option.range.holds(value))
    refuse("");
  return value;
}

void checkOption(const std::string& method, const SolverOption& option, double value)
{
  if (option.words.empty() && !option.range.holds(value))
    throw std::invalid_argument(method + "." + option.name + " is " + numberText(value) + ", expected " +
                                option.expected());
}

std::string optionText(const SolverOption& option, double value)
{
  return option.words.empty() ? numberText(value) : option.words.at(static_cast<size_t>(value));
}

size_t findOption(const std::string& method, const std::vector<SolverOption>& options, const std::string& name)
{
  const std::vector<std::string> names = namesOf(options);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw std::invalid_argument(method + " has no option '" + inOneLine(name, 80) + "', " + didYouMean(name, names) +
                                "expected one of: " + joinNames(names));
  return static_cast<size_t>(found - names.begin());
}

}  // namespace frictional_contact_sim
