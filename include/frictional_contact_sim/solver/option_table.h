#pragma once
/**
 * @file option_table.h
 * @brief The options of a method as one table beside it, a line each: name, where it is kept, range, unit, meaning. The
 * default is that of the struct. From it come --list-solvers, the reading of option texts and the check of ranges.
 */
#include <functional>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "frictional_contact_sim/solver/solver_options.h"

namespace frictional_contact_sim
{
/** @brief The value of a text: the number, or the place of the word. @throws std::invalid_argument in one line */
double parseOption(const std::string& method, const SolverOption& option, const std::string& text);
/** @throws std::invalid_argument "METHOD.NAME is VALUE, expected ..." unless the value is in the range */
void checkOption(const std::string& method, const SolverOption& option, double value);
/** @brief The text that parseOption reads as the value. */
std::string optionText(const SolverOption& option, double value);
/** @throws std::invalid_argument naming the nearest option when there is none of this name */
size_t findOption(const std::string& method, const std::vector<SolverOption>& options, const std::string& name);

/** @brief A line of the table: every kind of value (number, integer, boolean, enumeration) as a number. */
template <typename Options>
struct OptionRow
{
  /** @brief A number or an integer. */
  template <typename Field>
  OptionRow(const char* name, Field Options::*field, const NumberRange& range, const char* unit, const char* meaning)
    : OptionRow(
          name, [field](Options& options) -> Field& { return options.*field; }, range, unit, meaning)
  {
  }
  /** @brief An enumeration. @param words of its constants, from 0 */
  template <typename Field>
  OptionRow(const char* name, Field Options::*field, const std::vector<std::string>& words, const char* meaning)
    : OptionRow(
          name, [field](Options& options) -> Field& { return options.*field; }, NumberRange(), "-", meaning)
  {
    option.words = words;
  }
  OptionRow(const char* name, bool Options::*field, const char* meaning)
    : OptionRow(name, field, {"false", "true"}, meaning)
  {
  }

  /** @brief A line of the table of a struct within the options. */
  template <typename Inner>
  OptionRow(Inner Options::*inner, const OptionRow<Inner>& row)
    : option(row.option)
    , get([inner, row](const Options& options) { return row.get(options.*inner); })
    , set([inner, row](Options& options, double value) { row.set(options.*inner, value); })
  {
  }

  SolverOption option;
  std::function<double(const Options&)> get;
  std::function<void(Options&, double)> set;

private:
  template <typename Access, typename Field = std::decay_t<std::invoke_result_t<Access, Options&>>>
  OptionRow(const char* name, Access access, const NumberRange& range, const char* unit, const char* meaning)
    : option{name, "", unit, meaning, {}, range, std::is_same_v<Field, int>}
    , get([access](const Options& options) { return static_cast<double>(access(const_cast<Options&>(options))); })
    , set([access](Options& options, double value) { access(options) = static_cast<Field>(value); })
  {
  }
};

template <typename Options>
class OptionTable
{
public:
  /** @param method for messages */
  OptionTable(const char* method, std::initializer_list<OptionRow<Options>> rows) : method_(method)
  {
    for (const OptionRow<Options>& row : rows)
      add(row);
  }
  /** @brief The same table with the lines of a struct within the options after its own. */
  template <typename Inner>
  OptionTable include(Inner Options::*inner, const OptionTable<Inner>& table) const
  {
    OptionTable both = *this;
    for (const OptionRow<Inner>& row : table.rows())
      both.add(OptionRow<Options>(inner, row));
    return both;
  }

  const std::vector<OptionRow<Options>>& rows() const { return rows_; }
  const std::vector<SolverOption>& options() const { return options_; }

  /** @throws std::invalid_argument naming the first option out of its range and its value */
  void validate(const Options& options) const
  {
    for (const OptionRow<Options>& row : rows_)
      checkOption(method_, row.option, row.get(options));
  }

  /** @param method for messages
   * @throws std::invalid_argument in one line: an unknown name, a value that cannot be read or is out of range */
  Options read(const std::string& method, const SolverOptions& texts) const
  {
    Options options;
    for (const auto& [name, text] : texts)
    {
      const OptionRow<Options>& row = rows_[findOption(method, options_, name)];
      row.set(options, parseOption(method, row.option, text));
    }
    return options;
  }

private:
  void add(OptionRow<Options> row)
  {
    row.option.default_value = optionText(row.option, row.get(Options()));
    options_.push_back(row.option);
    rows_.push_back(std::move(row));
  }

  std::string method_;
  std::vector<OptionRow<Options>> rows_;
  std::vector<SolverOption> options_;
};

}  // namespace frictional_contact_sim
