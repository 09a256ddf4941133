#include "frictional_contact_sim/config/number_range.h"

#include <charconv>
#include <cmath>

namespace frictional_contact_sim
{
bool NumberRange::holds(double number) const
{
  if (!std::isfinite(number) && !(infinite_too && std::isinf(number)))
    return false;
  return (lower_open ? number > lower : number >= lower) && (upper_open ? number < upper : number <= upper);
}

std::string NumberRange::expected(const std::string& kind) const
{
  const bool bounded_below = std::isfinite(lower);
  if (std::isfinite(upper))
    return kind + " in " + (lower_open ? "(" : "[") + numberText(lower) + ", " + numberText(upper) +
           (upper_open ? ")" : "]");
  if (bounded_below)
    return kind + (lower_open ? " > " : " >= ") + numberText(lower) + (infinite_too ? ", infinity too" : "");
  return kind == "a number" ? "a finite number" : kind;
}

NumberRange anyNumber()
{
  return {};
}

NumberRange positive()
{
  return above(0.0);
}

NumberRange notNegative()
{
  return atLeast(0.0);
}

NumberRange above(double lower)
{
  NumberRange range;
  range.lower = lower;
  range.lower_open = true;
  return range;
}

NumberRange aboveOrInfinite(double lower)
{
  NumberRange range = above(lower);
  range.infinite_too = true;
  return range;
}

NumberRange atLeast(double lower)
{
  NumberRange range;
  range.lower = lower;
  return range;
}

NumberRange between(double lower, double upper)
{
  NumberRange range;
  range.lower = lower;
  range.upper = upper;
  return range;
}

NumberRange inside(double lower, double upper)
{
  NumberRange range = between(lower, upper);
  range.lower_open = true;
  range.upper_open = true;
  return range;
}

std::string numberText(double number)
{
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, number);
  return {text, end.ptr};
}

NumberRange timeStepRange()
{
  return between(1e-9, 1e3);
}

}  // namespace frictional_contact_sim
