#include "frictional_contact_sim/ros/node_help.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/parameters.h"

namespace frictional_contact_sim
{
namespace
{
std::set<std::string> helped()
{
  std::set<std::string> names;
  for (const ParameterHelp& help : parameterHelp())
    names.insert(help.name);
  return names;
}

std::string content(const std::string& file)
{
  std::ifstream stream(std::string(PROJECT_DIR) + "/" + file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(NodeHelpTest, EveryParameterOfItIsReadAndNoOtherOneIs)
{
  const std::vector<std::string> names = parameterNames();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), helped());
}

TEST(NodeHelpTest, TheInterfacesPageHasEveryOneOfThem)
{
  const std::string page = content("docs/interfaces.md");
  for (const std::string& name : helped())
    EXPECT_NE(page.find("~" + name), std::string::npos) << name;
}

TEST(NodeHelpTest, EachHasALineThatFitsAndSaysWhatItIs)
{
  const std::string text = nodeHelp();
  for (const ParameterHelp& help : parameterHelp())
  {
    EXPECT_THAT(text, testing::HasSubstr("  ~" + help.name)) << help.name;
    EXPECT_GT(help.meaning.size(), 10U) << help.name;
  }
}

}  // namespace
}  // namespace frictional_contact_sim
