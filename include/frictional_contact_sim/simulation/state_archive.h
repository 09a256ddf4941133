#pragma once
/**
 * @file state_archive.h
 * @brief What visitState shows the state to: three primitives, and on them everything a state is made of.
 *
 * An archive reads the state (hash, writer) or writes it (reader). Lists whose length belongs to the model are `fixed`:
 * a reader refuses another length.
 */
#include <Eigen/Core>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
/** @brief A state that does not fit; the message names the entry, what was found and what was expected. */
class StateError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

class StateArchive
{
public:
  virtual ~StateArchive() = default;
  virtual void number(const std::string& name, double& value) = 0;
  virtual void integer(const std::string& name, std::uint64_t& value) = 0;
  virtual void text(const std::string& name, std::string& value) = 0;

  /** @brief Lists that states have not always had leave no trace where they are empty: hashes stay what they were. */
  virtual bool skipsEmptyNewLists() const { return false; }

  void index(const std::string& name, int& value)
  {
    auto bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    integer(name, bits);
    value = static_cast<int>(static_cast<std::int64_t>(bits));
  }
  void flag(const std::string& name, bool& value)
  {
    std::uint64_t bit = value ? 1 : 0;
    integer(name, bit);
    value = bit != 0;
  }
  /** @param constants how many the enumeration has, from 0 */
  template <class Enumeration>
  void enumeration(const std::string& name, Enumeration& value, std::uint64_t constants)
  {
    auto constant = static_cast<std::uint64_t>(value);
    integer(name, constant);
    if (constant >= constants)
      throw StateError(name + " is " + std::to_string(constant) + ", expected less than " + std::to_string(constants));
    value = static_cast<Enumeration>(constant);
  }
  template <class Derived>
  void vector(const std::string& name, Eigen::DenseBase<Derived>& value)
  {
    for (Eigen::Index i = 0; i < value.size(); ++i)
      number(name, value.derived().coeffRef(i));
  }
  template <class T>
  std::vector<T>& list(const std::string& name, std::vector<T>& items)
  {
    std::uint64_t count = items.size();
    integer(name + " (number of)", count);
    if (count > MOST_ITEMS)
      throw StateError("number of " + name + " is " + std::to_string(count) + ", expected at most " +
                       std::to_string(MOST_ITEMS));
    items.resize(static_cast<size_t>(count));
    return items;
  }
  template <class T>
  std::vector<T>& fixedList(const std::string& name, std::vector<T>& items)
  {
    std::uint64_t count = items.size();
    integer(name + " (number of)", count);
    if (count != items.size())
      throw StateError("number of " + name + " is " + std::to_string(count) + ", expected " +
                       std::to_string(items.size()));
    return items;
  }

private:
  static constexpr std::uint64_t MOST_ITEMS = 1000000;
};

}  // namespace frictional_contact_sim
