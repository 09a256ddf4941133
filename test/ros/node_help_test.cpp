#include "frictional_contact_sim/ros/node_help.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <set>

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
  // What the node reads: it calls any other parameter unknown.
  for (const std::string& name : helped())
  {
    XmlRpc::XmlRpcValue tree;
    tree[name] = XmlRpc::XmlRpcValue(7);
    std::string said;
    try
    {
      for (const std::string& warning : readParameters(tree, "<robot name=\"r\"/>").warnings)
        said += warning;
    }
    catch (const std::exception& error)
    {
      said = error.what();
    }
    EXPECT_THAT(said, testing::Not(testing::HasSubstr("unknown parameter"))) << name;
  }
  const std::string source = content("src/ros/parameters.cpp");
  const std::regex read("reader\\.(?:read|raw|child|isStruct)\\(\"([a-z_]+)\"");
  std::set<std::string> names;
  for (std::sregex_iterator match(source.begin(), source.end(), read); match != std::sregex_iterator(); ++match)
    names.insert((*match)[1]);
  names.erase("friction");  // of a material, whose reader has the same name
  names.erase("restitution");
  EXPECT_EQ(names, helped());
}

TEST(NodeHelpTest, TheReadmeHasEveryOneOfThem)
{
  const std::string readme = content("README.md");
  for (const std::string& name : helped())
    EXPECT_THAT(readme, testing::HasSubstr("~" + name)) << name;
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
