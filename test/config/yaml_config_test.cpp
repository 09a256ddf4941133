// YAML documents that are none, or are meant to hurt.
#include "frictional_contact_sim/config/yaml_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;
using testing::HasSubstr;

std::string complaint(const std::string& text)
{
  try
  {
    parseYaml(text, "a.yaml");
  }
  catch (const ConfigError& error)
  {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(message.rfind("a.yaml", 0), 0u) << message;
    return message;
  }
  return "accepted";
}
}  // namespace

TEST(YamlConfigTest, WhatIsNoYamlIsOneLine)
{
  EXPECT_THAT(complaint("a: [\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(complaint("a: 1\n  b: 2\n"), HasSubstr("a.yaml:2: not valid YAML"));
  EXPECT_EQ(complaint("a: 1\nb: 2\na: 3\n"), "a.yaml:3: key 'a': found twice, first in line 1, expected once");
  EXPECT_EQ(complaint("[a, b]: 1\n"), "a.yaml:1: a key is no word, expected KEY: VALUE");
  EXPECT_EQ(complaint(""), "accepted");
}

TEST(YamlConfigTest, AliasesDoNotGrowWithoutBound)
{
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int k = 1; k < 12; ++k)
  {
    const std::string last = "*a" + std::to_string(k - 1), name = "a" + std::to_string(k);
    bomb += name + ": &" + name + " [";
    for (int i = 0; i < 10; ++i)
      bomb += last + (i < 9 ? ", " : "]\n");
  }
  EXPECT_THAT(complaint(bomb), HasSubstr("more than 500000 values"));
  EXPECT_THAT(complaint("a: &a [*a]\n"), testing::AnyOf(HasSubstr("100 deep"), HasSubstr("not valid YAML")));
  EXPECT_THAT(complaint(std::string(5000, '[')), testing::AnyOf(HasSubstr("deep"), HasSubstr("not valid YAML")));
  EXPECT_EQ(complaint("a: &a {b: 1}\nc: *a\n"), "accepted");
}

TEST(YamlConfigTest, RandomBytesAreReadOrRefused)
{
  const std::string letters = "abc:-[]{},&*!|>'\"%@`#?\n\t \\0~.\xff\x01";
  Dice dice(4);
  for (int k = 0; k < 3000; ++k)
  {
    std::string text;
    for (int length = dice.integer(0, 60); length > 0; --length)
      text += letters[static_cast<size_t>(dice.integer(0, static_cast<int>(letters.size()) - 1))];
    complaint(text);
  }
}

TEST(YamlConfigTest, FilesAreNamed)
{
  const auto load = [](const std::string& path) -> std::string
  {
    try
    {
      loadYaml(path, "a scenario file");
    }
    catch (const ConfigError& error)
    {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(load("/nowhere/a.yaml"), "/nowhere/a.yaml: cannot be read, expected a scenario file (YAML)");
  EXPECT_EQ(load("/tmp"), "/tmp: is a folder, expected a scenario file (YAML)");
  const std::string path = testing::TempDir() + "yaml_config_test.yaml";
  std::ofstream(path) << "a: 1\n";
  EXPECT_EQ(load(path), "accepted");
  EXPECT_EQ(loadYaml(path, "x").stem(), "yaml_config_test");
}

}  // namespace frictional_contact_sim
