// The one reader: every rule in both notations, with the exact line.
#include "frictional_contact_sim/config/config_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "frictional_contact_sim/config/yaml_config.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;
using testing::ElementsAre;

std::string complaint(const std::function<void()>& read)
{
  try
  {
    read();
  }
  catch (const ConfigError& error)
  {
    return error.what();
  }
  return "accepted";
}

ConfigNode yaml(const std::string& text)
{
  return parseYaml(text, "a.yaml");
}

/// The same document as parameters.
ConfigNode parameters(const std::string& shown, std::vector<std::string>* warnings = nullptr)
{
  auto document = std::make_shared<ConfigDocument>();
  document->notation = ConfigNotation::PARAMETERS;
  document->warnings = warnings;
  ConfigValue value;
  value.kind = ConfigValue::Kind::SCALAR;
  value.shown = shown;
  ConfigValue inner;
  inner.kind = ConfigValue::Kind::MAP;
  inner.entries.push_back({"friction", 0, value});
  document->root.kind = ConfigValue::Kind::MAP;
  document->root.entries.push_back({"ground", 0, inner});
  return ConfigNode(document);
}
}  // namespace

TEST(ConfigNodeTest, AValueIsReadAsWhatItIs)
{
  const ConfigNode root = yaml("a: 2\nb: [1, 2.5, -3]\nc: yes\nd: {e: word}\nf: ~\n");
  EXPECT_EQ(root.at("a").number(), 2.0);
  EXPECT_EQ(root.at("a").integer(0), 2);
  EXPECT_EQ(root.at("a").text(), "2");
  EXPECT_EQ((root.at("b").vector<3>()), Eigen::Vector3d(1.0, 2.5, -3.0));
  EXPECT_TRUE(root.at("c").boolean());
  EXPECT_EQ(root.at("d").at("e").text(), "word");
  EXPECT_FALSE(root.has("f"));
  EXPECT_FALSE(root.has("g"));
  EXPECT_EQ((root.at("d").at("e").choice(Choices<int>{{"other", 1}, {"word", 2}})), 2);
}

TEST(ConfigNodeTest, EveryMistakeIsOneLineOfPlaceFoundAndExpected)
{
  const ConfigNode root = yaml("a: word\nb:\n  c: [1, 2]\n  d: -1\n  e: .nan\nf: ''\n");
  EXPECT_EQ(complaint([&] { root.at("a").number(); }), "a.yaml:1: key 'a': found 'word', expected a finite number");
  EXPECT_EQ(complaint([&] { root.at("b").number(); }), "a.yaml:3: key 'b': found a map, expected a finite number");
  EXPECT_EQ(complaint([&] { root.at("b").at("c").vector<3>(); }),
            "a.yaml:3: key 'b.c': found a list of 2, expected a list of 3 numbers");
  EXPECT_EQ(complaint([&] { root.at("b").at("d").number(positive()); }),
            "a.yaml:4: key 'b.d': found '-1', expected a number > 0");
  EXPECT_EQ(complaint([&] { root.at("b").at("d").integer(0, 7); }),
            "a.yaml:4: key 'b.d': found '-1', expected an integer in [0, 7]");
  EXPECT_EQ(complaint([&] { root.at("b").at("e").number(); }),
            "a.yaml:5: key 'b.e': found '.nan', expected a finite number");
  EXPECT_EQ(complaint([&] { root.at("a").boolean(); }), "a.yaml:1: key 'a': found 'word', expected true or false");
  EXPECT_EQ(complaint([&] { root.at("f").text(); }), "a.yaml:6: key 'f': found '', expected a text");
  EXPECT_EQ(complaint([&] { root.at("a").items("words"); }),
            "a.yaml:1: key 'a': found 'word', expected a list of words");
  EXPECT_EQ(complaint([&] { root.at("b").at("c").pairOfTexts(); }), "accepted");
  EXPECT_EQ(complaint([&] { root.at("b").at("nothing").number(); }),
            "a.yaml:3: key 'b.nothing': found nothing, expected a finite number");
  EXPECT_EQ(complaint(
                [&] {
                  root.at("a").choice(Choices<int>{{"sword", 0}, {"shield", 1}});
                }),
            "a.yaml:1: key 'a': found 'word', expected sword or shield (did you mean 'sword'?)");
  EXPECT_EQ(complaint([&] { root.at("b").at("c").items("numbers")[1].number(above(2.0)); }),
            "a.yaml:3: key 'b.c[1]': found '2', expected a number > 2");
}

TEST(ConfigNodeTest, ParametersAreNamedAsRosNamesThem)
{
  const ConfigNode root = parameters("the string 'ice'");
  EXPECT_EQ(complaint([&] { root.at("ground").at("friction").number(notNegative()); }),
            "~ground/friction: found the string 'ice', expected a number >= 0");
  EXPECT_EQ(complaint([&] { root.at("height").number(); }), "~height: found nothing, expected a finite number");
}

TEST(ConfigNodeTest, AMapIsReadByItsTable)
{
  double friction = 0.8, height = 1.0;
  int count = 0;
  bool flag = false, empty_seen = false;
  std::string name;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  const ConfigKeys keys = {key("friction", friction, notNegative()),
                           key("height", height),
                           key("count", count, 1),
                           key("flag", flag),
                           required(key("name", name)),
                           key("gravity", gravity),
                           evenEmpty(key("empty", [&](const ConfigNode& node) { empty_seen = !node.isThere(); }))};
  yaml("friction: 0.5\ncount: 3\nflag: true\nname: x\ngravity: [0, 0, 1]\nempty:\n").readMap(keys);
  EXPECT_EQ(friction, 0.5);
  EXPECT_EQ(height, 1.0);
  EXPECT_EQ(count, 3);
  EXPECT_TRUE(flag);
  EXPECT_TRUE(empty_seen);
  EXPECT_EQ(name, "x");
  EXPECT_EQ(gravity.z(), 1.0);
  EXPECT_EQ(complaint([&] { yaml("count: 3\n").readMap(keys); }),
            "a.yaml:1: key 'name': found nothing, expected a text");
  EXPECT_EQ(complaint([&] { yaml("name: x\nfrcition: 1\n").readMap(keys); }),
            "a.yaml:2: key 'frcition': unknown key, did you mean 'friction'? expected one of: friction, height, count, "
            "flag, name, gravity, empty");
  EXPECT_EQ(complaint([&] { yaml("[]").readMap(keys); }), "a.yaml:1: the document: found a list of 0, expected a map");
}

TEST(ConfigNodeTest, UnknownParametersAreWarningsUnlessTheyMustNotBe)
{
  std::vector<std::string> warnings;
  double friction = 0.0;
  const ConfigNode root = parameters("the number 1", &warnings);
  root.readMap({key("grond", friction)});
  EXPECT_THAT(warnings, ElementsAre("~ground: unknown parameter, did you mean 'grond'? ignored"));
  EXPECT_EQ(complaint([&] { root.readMap({key("grond", friction)}, UnknownKeys::REFUSED); }),
            "~ground: unknown key, did you mean 'grond'? expected one of: grond");
}

TEST(NumberRangeTest, EndsAreInOrOutAsTheTextSays)
{
  Dice dice(3);
  for (int k = 0; k < 200; ++k)
  {
    NumberRange range;
    range.lower = dice.uniform(-10.0, 10.0);
    range.upper = range.lower + dice.uniform(0.1, 10.0);
    range.lower_open = dice.chance(0.5);
    range.upper_open = dice.chance(0.5);
    EXPECT_EQ(range.holds(range.lower), !range.lower_open);
    EXPECT_EQ(range.holds(range.upper), !range.upper_open);
    EXPECT_TRUE(range.holds(0.5 * (range.lower + range.upper)));
    EXPECT_FALSE(range.holds(std::nextafter(range.lower, -100.0)));
    EXPECT_FALSE(range.holds(std::nextafter(range.upper, 100.0)));
    EXPECT_EQ(range.expected().back(), range.upper_open ? ')' : ']');
    // the shortest text gives the same bits back
    EXPECT_EQ(std::stod(numberText(range.lower)), range.lower);
  }
  EXPECT_FALSE(anyNumber().holds(std::nan("")));
  EXPECT_FALSE(positive().holds(HUGE_VAL));
  EXPECT_TRUE(aboveOrInfinite(0.0).holds(HUGE_VAL));
  EXPECT_FALSE(aboveOrInfinite(0.0).holds(-HUGE_VAL));
  EXPECT_EQ(between(1, 8).expected("an integer"), "an integer in [1, 8]");
  EXPECT_EQ(notNegative().expected(), "a number >= 0");
}

}  // namespace frictional_contact_sim
