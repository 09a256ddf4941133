// Scenario files with mistakes made at random: loaded, or exactly one line that names the file.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;

struct Example
{
  std::string path, text;
};

std::vector<Example> examples()
{
  std::vector<Example> found;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(PROJECT_DIR) + "/config/scenarios"))
  {
    if (entry.file_size() > 20000)
      continue;  // head_of_hair: the lines of hair, a hundred times
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    found.push_back({entry.path().string(), text.str()});
  }
  std::sort(found.begin(), found.end(), [](const Example& a, const Example& b) { return a.path < b.path; });
  return found;
}

/// "" when the scenario is loaded, else its one line.
std::string load(const std::string& text, const std::string& path)
{
  try
  {
    const Scenario scenario = loadScenario(text, path);
    EXPECT_GE(scenario.time_step, 1e-9);
    EXPECT_LE(scenario.time_step, 1e3);
    EXPECT_TRUE(scenario.gravity.allFinite());
    EXPECT_GE(scenario.materials.fallback.friction, 0.0);
    return "";
  }
  catch (const ScenarioError& error)
  {
    return error.what();
  }
}

/// Nothing else is thrown, and the line names the file, or another one of the package that the file names.
void expectLoadedOrOneLine(const std::string& text, const std::string& path)
{
  std::string message;
  ASSERT_NO_THROW(message = load(text, path)) << text;
  if (message.empty())
    return;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  const std::string folder = std::filesystem::path(path).parent_path().parent_path().string();
  EXPECT_TRUE(message.rfind(path, 0) == 0 || message.rfind(folder, 0) == 0) << message << "\n" << text;
}

std::vector<std::string> keysOf(const YAML::Node& map)
{
  std::vector<std::string> keys;
  for (const auto& entry : map)
    keys.push_back(entry.first.Scalar());
  return keys;
}

YAML::Node randomValue(Dice& dice)
{
  static const std::vector<std::string> values = {"~",
                                                  "''",
                                                  "-1",
                                                  "0",
                                                  "1.0e+300",
                                                  ".nan",
                                                  ".inf",
                                                  "-.inf",
                                                  "true",
                                                  "word",
                                                  "[]",
                                                  "{}",
                                                  "[1]",
                                                  "[1, 2, 3]",
                                                  "[[a, b]]",
                                                  "{name: 3}",
                                                  "1e-320",
                                                  "99999999999999999999",
                                                  "[a, b]",
                                                  "{a: {}}",
                                                  "2",
                                                  "gap",
                                                  "admm",
                                                  "[1, 2, x]",
                                                  "{friction: 1}",
                                                  "'two\n\n  lines'"};
  return YAML::Load(values[static_cast<size_t>(dice.integer(0, static_cast<int>(values.size()) - 1))]);
}

/// A map or list somewhere in the document.
YAML::Node randomPlace(const YAML::Node& root, Dice& dice)
{
  YAML::Node place = root;
  while (place.size() > 0 && dice.chance(0.7))
  {
    std::vector<YAML::Node> below;
    for (const auto& entry : place)
    {
      const YAML::Node child = place.IsMap() ? entry.second : static_cast<const YAML::Node&>(entry);
      if (child.IsMap() || child.IsSequence())
        below.push_back(child);
    }
    if (below.empty())
      break;
    place.reset(below[static_cast<size_t>(dice.integer(0, static_cast<int>(below.size()) - 1))]);
  }
  return place;
}

/// Deletes, inserts or replaces one value of a map or list.
void mutate(YAML::Node root, Dice& dice)
{
  static const std::vector<std::string> names = {"friction", "name",    "position", "urdf",   "times",    "materials",
                                                 "solver",   "between", "options",  "bodies", "nonsense", "<<"};
  YAML::Node place = randomPlace(root, dice);
  if (place.IsSequence())
  {
    const int size = static_cast<int>(place.size());
    if (size == 0 || dice.chance(0.4))
      place.push_back(randomValue(dice));
    else if (dice.chance(0.5))
      place.remove(dice.integer(0, size - 1));
    else
      place[dice.integer(0, size - 1)] = randomValue(dice);
    return;
  }
  const std::vector<std::string> keys = keysOf(place);
  const std::string key =
      keys.empty() ? "empty" : keys[static_cast<size_t>(dice.integer(0, static_cast<int>(keys.size()) - 1))];
  if (dice.chance(0.3))
    place[names[static_cast<size_t>(dice.integer(0, static_cast<int>(names.size()) - 1))]] = randomValue(dice);
  else if (dice.chance(0.4))
    place.remove(key);
  else
    place[key] = randomValue(dice);
}

/// Where the key stands, not in a comment and not as the end of another word; npos: nowhere.
size_t findKey(const std::string& text, const std::string& key)
{
  for (size_t place = text.find(key + ":"); place != std::string::npos; place = text.find(key + ":", place + 1))
  {
    const size_t line = place == 0 ? 0 : text.rfind('\n', place - 1) + 1;
    const bool starts_word = place == line || std::string(" {").find(text[place - 1]) != std::string::npos;
    if (starts_word && text.substr(line, place - line).find('#') == std::string::npos)
      return place;
  }
  return std::string::npos;
}

std::string emitted(const YAML::Node& root)
{
  std::ostringstream text;
  text << root;
  return text.str();
}
}  // namespace

TEST(ScenarioMutationTest, ValuesAreDeletedInsertedAndChanged)
{
  int refused = 0, loaded = 0;
  for (const Example& example : examples())
  {
    ASSERT_EQ(load(example.text, example.path), "") << example.path;
    ASSERT_EQ(load(emitted(YAML::Load(example.text)), example.path), "") << example.path;
    Dice dice(11);
    for (int k = 0; k < 400; ++k)
    {
      const YAML::Node root = YAML::Load(example.text);
      for (int times = dice.integer(1, 3); times > 0; --times)
        mutate(root, dice);
      const std::string text = emitted(root);
      expectLoadedOrOneLine(text, example.path);
      ++(load(text, example.path).empty() ? loaded : refused);
    }
  }
  EXPECT_GT(refused, 200);
  EXPECT_GT(loaded, 50);
}

TEST(ScenarioMutationTest, LinesAndLettersAreChanged)
{
  for (const Example& example : examples())
  {
    Dice dice(12);
    for (int k = 0; k < 400; ++k)
    {
      std::string text = example.text;
      for (int times = dice.integer(1, 4); times > 0; --times)
      {
        const auto place = static_cast<size_t>(dice.integer(0, static_cast<int>(text.size()) - 1));
        const size_t line = text.rfind('\n', place) + 1;
        switch (dice.integer(0, 4))
        {
          case 0:
            text.erase(place, 1);
            break;
          case 1:
            text[place] = static_cast<char>(dice.integer(1, 255));
            break;
          case 2:
            text.insert(place, std::string(1, ":-[]{}#&*\n \t"[dice.integer(0, 11)]));
            break;
          case 3:  // a line twice: keys twice
            text.insert(line, text.substr(line, text.find('\n', line) - line + 1));
            break;
          default:
            text.erase(line, text.find('\n', line) - line + 1);
        }
        if (text.empty())
          text = "\n";
      }
      expectLoadedOrOneLine(text, example.path);
    }
  }
}

TEST(ScenarioMutationTest, AKeyWithTwoLettersSwappedIsSeenThrough)
{
  const std::vector<std::string> keys = {"duration", "solver", "tolerance", "materials", "friction", "ground",
                                         "bodies",   "name",   "urdf",      "pose",      "commands", "restitution"};
  int seen = 0;
  for (const Example& example : examples())
    for (const std::string& key : keys)
    {
      const size_t place = findKey(example.text, key);
      if (place == std::string::npos)
        continue;
      std::string text = example.text;
      std::swap(text[place + 1], text[place + 2]);
      const std::string message = load(text, example.path);
      EXPECT_NE(message.find("did you mean '" + key + "'?"), std::string::npos)
          << example.path << " " << key << ": " << message;
      ++seen;
    }
  EXPECT_GT(seen, 20);
}

}  // namespace frictional_contact_sim
