#pragma once
/**
 * @file number_range.h
 * @brief The condition on a number: an interval as data, so that a message can say it and a test can try its ends.
 */
#include <limits>
#include <string>

namespace frictional_contact_sim
{
struct NumberRange
{
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false;  ///< the bound itself is outside
  bool upper_open = false;
  bool infinite_too = false;  ///< infinity is a value, where the bounds leave it in

  /** @brief Never true of NaN. */
  bool holds(double number) const;
  /** @brief "a number > 0", "an integer in [1, 8]", "a finite number". @param kind "a number" or "an integer" */
  std::string expected(const std::string& kind = "a number") const;
};

NumberRange anyNumber();
NumberRange positive();
NumberRange notNegative();
NumberRange above(double lower);
NumberRange aboveOrInfinite(double lower);
NumberRange atLeast(double lower);
NumberRange between(double lower, double upper);  ///< both bounds inside
NumberRange inside(double lower, double upper);  ///< both bounds outside

/** @brief The shortest text that is read as the same number. */
std::string numberText(double number);

/** @brief Limits that scenarios, parameters and arguments share. */
NumberRange timeStepRange();  ///< [s]

}  // namespace frictional_contact_sim
