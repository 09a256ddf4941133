#pragma once
/**
 * @file solver_options.h
 * @brief Options of methods by name, for scenarios, parameters and arguments; and what each is, as data.
 */
#include <map>
#include <string>
#include <vector>

#include "frictional_contact_sim/config/number_range.h"

namespace frictional_contact_sim
{
/** @brief Values of options as texts, by name: {"inner": "admm", "relaxation": "0.5"}. What is left out has its
 * default.
 */
using SolverOptions = std::map<std::string, std::string>;

/** @brief One option of a method. */
struct SolverOption
{
  std::string name;
  std::string default_value;
  std::string unit;  ///< "-" for pure numbers and words
  std::string meaning;
  std::vector<std::string> words;  ///< what it takes; empty: numbers of the range
  NumberRange range;
  bool is_integer = false;

  /** @brief "a number > 0", "an integer >= 1", "true or false". */
  std::string expected() const;
};

}  // namespace frictional_contact_sim
