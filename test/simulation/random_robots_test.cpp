// Random robots (support/random_scene.h): invariants of every step, equal bits, islands that do not see one another.
// FCS_LONG_TESTS=N takes the seeds 0 .. N - 1 instead of the suite's (scripts/long_tests).
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/known_seeds.h"
#include "support/random_scene.h"
#include "support/run_audit.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::RandomScene;
using test_support::RunAudit;
namespace fs = std::filesystem;

constexpr std::uint32_t SUITE_SEEDS = 320;
constexpr std::uint32_t MESH_SHARE = 16;  ///< so many scenes for one with meshes
constexpr int MOST_FAILED_STEPS = 3;  ///< then the run has shown what it can

std::uint32_t seedCount()
{
  const char* number = std::getenv("FCS_LONG_TESTS");
  return number == nullptr ? SUITE_SEEDS : static_cast<std::uint32_t>(std::stoul(number));
}

/** Seeds with a fault, by kind, and the text of the first. */
struct Findings
{
  std::map<std::string, std::vector<std::uint32_t>> seeds;
  std::map<std::string, std::string> first;

  void add(const std::string& kind, std::uint32_t seed, const std::string& text)
  {
    seeds[kind].push_back(seed);
    first.emplace(kind, text);
  }
  /** Known seeds are printed, others fail. */
  void expectNone() const
  {
    for (const auto& [kind, found] : seeds)
    {
      std::string unknown;
      std::string known;
      for (const std::uint32_t seed : found)
        (test_support::isKnownSeed(kind, seed) ? known : unknown) += " " + std::to_string(seed);
      if (!known.empty())
        std::cout << "[  known   ] " << kind << ": seeds" << known << '\n';
      if (!unknown.empty())
        ADD_FAILURE() << kind << ": seeds" << unknown << "; the first, known or not: " << first.at(kind);
    }
  }
};

/** Odd seeds judge, even ones are for tuning: apart in the report. */
class RandomRobotTest : public testing::TestWithParam<int>
{
protected:
  RandomRobotTest() : folder_(fs::temp_directory_path() / ("random_robots_" + std::to_string(getpid())))
  {
    fs::create_directories(folder_);
  }
  ~RandomRobotTest() override { fs::remove_all(folder_); }

  Scenario load(const RandomScene& scene, const std::string& scenario) const
  {
    return loadScenarioFile(writeScene(scene, folder_.string(), scenario, scene.name()));
  }
  template <typename Look>
  void forSeeds(std::uint32_t every, const Look& look) const
  {
    std::vector<std::uint32_t> seeds;
    for (std::uint32_t seed = GetParam(); seed < seedCount(); seed += 2)
      seeds.push_back(seed);
    for (std::uint32_t seed = GetParam(); seed < seedCount() / MESH_SHARE; seed += 2)
      seeds.push_back(test_support::MESH_SEEDS + seed);
    for (const std::uint32_t seed : seeds)
      if (test_support::isKnownSeed("slow", seed))
        std::cout << "[  known   ] slow: seed " << seed << " is not run\n";
      else if (seed / 2 % every == 0)
        look(test_support::randomScene(seed));
  }

  fs::path folder_;
};

int steps(const Scenario& scenario)
{
  return static_cast<int>(scenario.duration / scenario.time_step + 0.5);
}

TEST_P(RandomRobotTest, KeepsEveryInvariant)
{
  Findings findings;
  forSeeds(1,
           [&](const RandomScene& scene)
           {
             const Scenario scenario = load(scene, scene.scenario);
             Simulator simulator(scenario);
             RunAudit audit(simulator);
             int failed = 0;
             for (int i = 0; i < steps(scenario) && failed < MOST_FAILED_STEPS; ++i)
             {
               failed += !simulator.step().converged();
               audit.afterStep();
             }
             for (const auto& [kind, fault] : audit.finish())
               findings.add(kind, scene.seed,
                            scene.name() + ": " + fault.text + ", " + std::to_string(fault.count) + " times");
           });
  findings.expectNone();
}

/** Twice the same, and from the state in the middle. */
TEST_P(RandomRobotTest, HasTheSameBitsAgainAndFromASavedState)
{
  Findings findings;
  forSeeds(5,
           [&](const RandomScene& scene)
           {
             const Scenario scenario = load(scene, scene.scenario);
             const auto world = loadWorldModel(scenario);
             const int half = std::min(50, steps(scenario) / 2);
             Simulator first(world);
             Simulator again(world);
             for (int i = 0; i < half; ++i)
             {
               first.step();
               again.step();
             }
             const SimulationState middle = first.state();
             Simulator loaded(world);
             loaded.setState(middle);
             for (int i = 0; i < half; ++i)
               for (Simulator* simulator : {&first, &again, &loaded})
                 simulator->step();
             if (first.stateHash() != again.stateHash())
               findings.add("bits", scene.seed, firstDifference(first.state(), again.state()));
             if (first.stateHash() != loaded.stateHash())
               findings.add("bits of a saved state", scene.seed, firstDifference(first.state(), loaded.state()));
           });
  findings.expectNone();
}

/** A robot alone, and with a spinning box that falls 100 m away. */
TEST_P(RandomRobotTest, DoesNotSeeWhatHappensFarAway)
{
  Findings findings;
  forSeeds(5,
           [&](const RandomScene& scene)
           {
             const std::string far =
                 "{\"name\": \"far\", \"urdf\": \"" + std::string(PROJECT_DIR) +
                 "/urdf/cube.urdf\", \"base\": \"floating\", \"pose\": {\"xyz\": [100, 50, 1]}, \"velocity\": "
                 "{\"linear\": [3, 0, 0], \"angular\": [1, 20, 3]}}";
             Simulator alone(load(scene, scene.with(1)));
             Simulator together(load(scene, scene.with(1, far)));
             for (int i = 0; i < 60; ++i)
             {
               alone.step();
               together.step();
               if (alone.position(0) == together.position(0) && alone.velocity(0) == together.velocity(0))
                 continue;
               findings.add("islands", scene.seed, scene.name() + ": other bits from step " + std::to_string(i + 1));
               break;
             }
           });
  findings.expectNone();
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomRobotTest, testing::Values(0, 1),
                         [](const testing::TestParamInfo<int>& info)
                         { return std::string(info.param == 0 ? "EvenForTuning" : "OddForJudging"); });
}  // namespace
}  // namespace frictional_contact_sim
