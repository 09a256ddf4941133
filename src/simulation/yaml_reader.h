#pragma once
// Reads values out of a YAML document and turns every mistake into one line: file:line, key, found, expected.
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cmath>
#include <initializer_list>
#include <string>

namespace frictional_contact_sim
{
/** A node together with its file and its key path, such as bodies[0].pose.xyz. */
class YamlReader
{
public:
  YamlReader(YAML::Node node, std::string file, std::string key)
    : node_(std::move(node)), file_(std::move(file)), key_(std::move(key))
  {
  }

  const std::string& file() const { return file_; }
  const std::string& key() const { return key_; }
  const YAML::Node& node() const { return node_; }
  bool has(const std::string& name) const { return node_[name].IsDefined() && !node_[name].IsNull(); }
  YamlReader child(const std::string& name) const
  {
    return {node_[name], file_, key_.empty() ? name : key_ + "." + name};
  }
  YamlReader item(size_t index) const { return {node_[index], file_, key_ + "[" + std::to_string(index) + "]"}; }

  std::string place() const;  ///< FILE:LINE: key 'KEY'
  [[noreturn]] void fail(const std::string& reason) const;
  /** Fails when the node is not a map or has a key that is not listed. */
  void expectMap(std::initializer_list<const char*> keys) const;
  void expectMap() const;
  void expectSequence(const std::string& of_what) const;

  double number() const;  ///< finite
  double number(double lower, double upper, const std::string& expected) const;
  int integer(int lower) const;
  bool boolean() const;
  std::string text() const;
  Eigen::Vector3d vector3() const;  ///< three finite numbers

private:
  std::string found() const;

  YAML::Node node_;
  std::string file_;
  std::string key_;
};

}  // namespace frictional_contact_sim
