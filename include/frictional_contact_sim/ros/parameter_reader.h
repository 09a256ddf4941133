#pragma once
/**
 * @file parameter_reader.h
 * @brief Typed access to one XmlRpc struct that says in one line what is wrong, and knows which entries nobody asked
 * for.
 */
#include <xmlrpcpp/XmlRpcValue.h>

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace frictional_contact_sim
{
/** @brief A condition on numbers and how it is said: "a number > 0". */
struct NumberRule
{
  std::string expected;
  std::function<bool(double)> holds;
};
NumberRule anyNumber();
NumberRule positive();
NumberRule notNegative();
NumberRule between(double lower, double upper);

class ParameterReader
{
public:
  /** @param prefix of names in messages, "~" or "~materials/" */
  ParameterReader(const XmlRpc::XmlRpcValue& tree, std::string prefix);

  bool has(const std::string& name) const;
  std::vector<std::string> names() const;
  /** @brief Each leaves `value` alone when the parameter is not set. @throws ParameterError */
  void read(const std::string& name, double& value, const NumberRule& rule);
  void read(const std::string& name, int& value, int smallest);
  void read(const std::string& name, bool& value);
  void read(const std::string& name, std::string& value);
  /** @brief A list of numbers of the given length. */
  void read(const std::string& name, std::vector<double>& value, size_t size);
  void read(const std::string& name, std::vector<std::string>& value);
  /** @brief A list of pairs of names. */
  void read(const std::string& name, std::vector<std::pair<std::string, std::string>>& value);

  /** @brief Raw entry; marks it as known. Undefined value when absent. */
  XmlRpc::XmlRpcValue raw(const std::string& name);
  bool isStruct(const std::string& name) const;
  bool isList(const std::string& name) const;
  /** @brief Reader of a nested struct. @throws ParameterError when it is none */
  ParameterReader child(const std::string& name);
  /** @brief Names with prefix that no read or raw has asked for. */
  std::vector<std::string> unknown() const;
  [[noreturn]] void fail(const std::string& name, const std::string& expected) const;

private:
  XmlRpc::XmlRpcValue tree_;
  std::string prefix_;
  std::set<std::string> known_;
};

/** @brief "the string 'abc'", "the number 3", "a list of 2" ... */
std::string describe(const XmlRpc::XmlRpcValue& value);

}  // namespace frictional_contact_sim
