/**
 * @file rolling_case_test.cpp
 * @brief Cases from YAML: what is read, what is refused and how it is said, whole runs, the files.
 */
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/rolling_case.h"

using namespace frictional_contact_sim;
using testing::HasSubstr;

namespace
{
const std::string HEAD = "upper: {young_modulus: 94500, poisson_ratio: 0.1}\nfriction: 0.3\n";

/// The one line said about a text, or "accepted".
std::string complaint(const std::string& text)
{
  try
  {
    parseRollingCase(text, "case.yaml");
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "accepted";
}

RollingCase example(const std::string& name)
{
  return loadRollingCase(std::string(PROJECT_DIR) + "/config/rolling/" + name + ".yaml");
}

std::string contents(const std::string& path)
{
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}
}  // namespace

TEST(RollingCaseTest, ReadsWhatItIsGiven)
{
  const RollingCase study = parseRollingCase(
      "name: a\nupper: {young_modulus: 10, poisson_ratio: 0.2}\nlower: {young_modulus: [5, rigid], poisson_ratio: "
      "0.4}\n"
      "friction: [0.1, 0.3]\nflexibility: half_plane\nnodes: 7\nload: {normal: 3, tangential_share: -0.5}\n"
      "rolling: {motion: steady, creepage: 0.01}\ncreep_curve: {points: 5}\n",
      "folder/case.yaml");
  EXPECT_EQ(study.name, "a");
  EXPECT_EQ(study.upper.poisson_ratio, 0.2);
  ASSERT_EQ(study.lower_moduli.size(), 2u);
  EXPECT_EQ(study.lower_moduli[1], RollingCase::RIGID);
  EXPECT_EQ(study.lower_poisson_ratio, 0.4);
  EXPECT_EQ(study.friction, (std::vector<double>{0.1, 0.3}));
  EXPECT_EQ(study.source, FlexibilitySource::HALF_PLANE);
  EXPECT_EQ(study.motion, Motion::STEADY);
  EXPECT_EQ(*study.load, 3.0);
  EXPECT_EQ(study.load_shares, std::vector<double>{-0.5});
  EXPECT_EQ(study.curve_points, 5);
}

TEST(RollingCaseTest, EveryMistakeIsOneLineWithFileKeyFoundAndExpected)
{
  const std::string load = "load: {normal: 1}\n";
  EXPECT_EQ(complaint("upper: {young_modulus: -3, poisson_ratio: 0.1}\nfriction: 0.3\n" + load),
            "case.yaml:1: key 'upper.young_modulus': found '-3', expected a number > 0");
  EXPECT_EQ(complaint("upper: {young_modulus: 3, poisson_ratio: 0.5}\nfriction: 0.3\n" + load),
            "case.yaml:1: key 'upper.poisson_ratio': found '0.5', expected a number in (-1, 0.5)");
  EXPECT_EQ(complaint(HEAD + load + "nodes: 0\n"),
            "case.yaml:4: key 'nodes': found '0', expected an integer in [1, 2000]");
  EXPECT_THAT(complaint(HEAD), HasSubstr("expected one of them"));
  EXPECT_THAT(complaint(HEAD + load + "frcition: 1\n"),
              HasSubstr("key 'frcition': unknown key, did you mean 'friction'? expected one of"));
  EXPECT_THAT(complaint("upper: [1]\n"), HasSubstr("expected a map"));
  EXPECT_THAT(complaint("upper: {young_modulus: 3, poisson_ratio: 0.1}\nfriction: [0.1, -1]\n" + load),
              HasSubstr("key 'friction[1]': found '-1', expected a number >= 0"));
  EXPECT_THAT(complaint(HEAD + "load: {normal: .nan}\n"), HasSubstr("key 'load.normal'"));
  EXPECT_THAT(complaint(HEAD + "displacement: {normal: 1}\ncreep_curve: {points: 5}\n"), HasSubstr("expected load"));
  EXPECT_THAT(complaint("a: [\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(complaint(""), HasSubstr("expected a map"));
  EXPECT_THAT(complaint(HEAD + load + "flexibility: [a]\n"), HasSubstr("boundary_elements or half_plane"));
  EXPECT_THROW(loadRollingCase("/nowhere/case.yaml"), std::invalid_argument);
}

TEST(RollingCaseTest, KeysWithoutAMeaningAreNotPassedOver)
{
  const std::string load = HEAD + "load: {normal: 1}\n";
  const std::string contour = "contour: {points: [[0, 0], [1, 0], [1, 1], [0, 1]], contact: [0, 0], held: [2, 2]}\n";
  EXPECT_THAT(complaint(load + contour + "nodes: 20\n"), HasSubstr("key 'nodes': found beside contour"));
  EXPECT_THAT(complaint(load + contour + "half_width: 0.1\n"), HasSubstr("key 'half_width': found beside contour"));
  EXPECT_THAT(complaint(load + contour + "mesh: {growth: 2}\n"), HasSubstr("key 'mesh': found beside contour"));
  EXPECT_THAT(complaint(load + contour + "flexibility: half_plane\n"), HasSubstr("key 'contour': found beside"));
  EXPECT_THAT(complaint(load + "mesh: {growth: 2}\nflexibility: half_plane\n"), HasSubstr("key 'mesh': found beside"));
}

TEST(RollingCaseTest, TheZoneIsNotWiderThanTheCylinder)
{
  EXPECT_EQ(complaint(HEAD + "load: {normal: 1}\nradius: 0.5\nhalf_width: 0.6\n"),
            "case.yaml:5: key 'half_width': found '0.6', expected a number up to the radius of 0.5 m");
  EXPECT_EQ(complaint(HEAD + "load: {normal: 1}\nradius: 0.5\nhalf_width: 0.6\nflexibility: half_plane\n"), "accepted");
  // Not given: sqrt(2 R d_N) = 1.22 R.
  const RollingCase study = parseRollingCase(HEAD + "displacement: {normal: 0.75}\nnodes: 5\n", "case.yaml");
  EXPECT_THROW(runRollingCase(study), std::invalid_argument);
}

TEST(RollingCaseTest, BadContoursAreNamed)
{
  const auto contour = [](const std::string& points, const std::string& contact)
  { return complaint(HEAD + "load: {normal: 1}\ncontour: {points: " + points + contact + ", held: [2, 2]}\n"); };
  EXPECT_EQ(contour("[[0, 0], [1, 0], [1, 1], [0, 1]]", ", contact: [0, 0]"), "accepted");
  EXPECT_THAT(contour("[[0, 0], [1, 1], [0, 1], [1, 0]]", ", contact: [0, 0]"), HasSubstr("crosses element"));
  EXPECT_THAT(contour("[[0, 0], [0, 1], [1, 1], [1, 0]]", ", contact: [0, 0]"), HasSubstr("clockwise"));
  EXPECT_THAT(contour("[[0, 0], [1, 0], [1, 1], [0, 1]]", ""), HasSubstr("there are no contact nodes"));
  EXPECT_THAT(contour("[[0, 0], [1, 0]]", ", contact: [0, 0]"), HasSubstr("at least three points"));
}

TEST(RollingCaseTest, PapersCaseShowsItsTrends)
{
  // Figures 3 to 6 in meaning: separation at the rims; stick inside, not centred, slip around; tangential tractions
  // grow and slip falls with friction.
  const std::vector<RollingRun> runs = runRollingCase(example("paper_small"));
  ASSERT_EQ(runs.size(), 2u);
  std::vector<double> slip;
  for (const RollingRun& run : runs)
  {
    ASSERT_TRUE(run.converged);
    EXPECT_LT(run.contact.residual, 1e-12);
    const auto& states = run.contact.states;
    EXPECT_EQ(states.front(), NodeState::SEPARATION);
    EXPECT_EQ(states.back(), NodeState::SEPARATION);
    double moment = 0.0, weight = 0.0, largest = 0.0;
    for (size_t i = 0; i < states.size(); ++i)
    {
      const auto k = static_cast<Eigen::Index>(i);
      if (states[i] == NodeState::STICK)
      {
        moment += run.flexibility.x[k] * run.flexibility.width[k];
        weight += run.flexibility.width[k];
      }
      if (run.contact.r_N[k] > 0.0)
        largest = std::max(largest, std::abs(run.contact.y_T[k]));
    }
    ASSERT_GT(weight, 0.0);
    EXPECT_GT(std::abs(moment / weight), 0.5 * run.flexibility.width[0]);
    slip.push_back(largest);
  }
  EXPECT_GT(runs[1].stickWidth(), runs[0].stickWidth());
  EXPECT_GT(runs[1].contact.r_T.lpNorm<Eigen::Infinity>(), runs[0].contact.r_T.lpNorm<Eigen::Infinity>());
  EXPECT_LT(slip[1], slip[0]);
}

TEST(RollingCaseTest, MaterialSweepGoesFromCarterToTheRigidPlate)
{
  RollingCase study = example("materials");
  study.friction = {0.3};
  study.nodes = 60;
  study.curve_points = 7;
  const std::vector<RollingRun> runs = runRollingCase(study);
  double last_width = 1.0, last_beta = -1.0, last_free = 1.0;
  for (const RollingRun& run : runs)
  {
    ASSERT_TRUE(run.converged);
    EXPECT_LT(run.contactWidth(), last_width);  // stiffer pairs touch on less
    EXPECT_GT(run.materials.dundursBeta(), last_beta);
    ASSERT_TRUE(run.curve);
    EXPECT_LT(run.curve->free_creepage, last_free);  // 0 for equal materials, then ever more
    last_width = run.contactWidth();
    last_beta = run.materials.dundursBeta();
    last_free = run.curve->free_creepage;
  }
  EXPECT_EQ(runs.front().curve->free_creepage, 0.0);
  EXPECT_NEAR(runs.back().materials.dundursBeta(), 0.444, 5e-4);
}

TEST(CreepCurveTest, IsCartersForEqualMaterials)
{
  RollingCase study = example("carter");
  study.motion = Motion::STEADY;
  study.nodes = 125;
  const RollingRun run = runRollingCase(study).front();
  ASSERT_TRUE(run.curve);
  const CreepCurve& curve = *run.curve;
  ASSERT_EQ(curve.creepage.size(), 21u);
  EXPECT_EQ(curve.creepage.front(), 0.0);
  EXPECT_EQ(curve.traction.front(), 0.0);
  EXPECT_EQ(curve.traction.back(), 1.0);
  EXPECT_LT(curve.other_direction, 1e-9);
  const HertzLine hertz = hertzLine(*study.load, study.radius, run.materials.reducedModulus());
  for (size_t i = 0; i < curve.creepage.size(); ++i)
  {
    if (i > 0)
    {
      EXPECT_GT(curve.creepage[i], curve.creepage[i - 1]);
      EXPECT_GE(curve.traction[i], curve.traction[i - 1]);
    }
    EXPECT_NEAR(curve.traction[i], carterLoadShare(hertz, study.radius, run.friction, curve.creepage[i]), 0.02) << i;
  }
}

TEST(RollingFilesTest, TablesAndCurveAreWritten)
{
  RollingCase study = example("carter");
  study.nodes = 30;
  study.max_steps = 5;
  study.curve_points = 5;
  const std::vector<RollingRun> runs = runRollingCase(study);
  EXPECT_FALSE(runs.front().converged);  // five steps are too few, and it is said
  char folder[] = "/tmp/rolling_filesXXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::vector<std::string> paths = writeRollingFiles(study, runs, folder);
  ASSERT_EQ(paths.size(), 4u);
  const std::string nodes = contents(paths[0]);
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), '\n'), 31);
  EXPECT_THAT(nodes, HasSubstr("run,friction,lower_modulus,x,"));
  EXPECT_THAT(contents(paths[1]), HasSubstr("\n0,0.3,94500,0,30,"));
  const std::string curve = contents(paths[2]);
  for (const char* part : {"creep_curve:\n  friction: 0.3\n", "  reference_load: 100 ", "  young_modulus: 94500\n",
                           "  poisson_ratio: 0.1\n", "  radius: 1\n", "  creepage: [0, ", "  traction: [0, ", ", 1]\n"})
    EXPECT_THAT(curve, HasSubstr(part));
  EXPECT_THAT(contents(paths[3]), HasSubstr("step,Q\n1,-"));
  EXPECT_THROW(writeRollingFiles(study, runs, std::string(folder) + "/missing"), std::invalid_argument);
  std::filesystem::remove_all(folder);
}

TEST(RollingCaseTest, LoadsThatComeAndGoAreFollowedAndWritten)
{
  const RollingCase study = example("hysteresis");
  ASSERT_GT(study.load_shares.size(), 3u);
  const std::vector<RollingRun> runs = runRollingCase(study);
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_TRUE(runs[0].converged);
  ASSERT_EQ(runs[0].steps.size(), study.load_shares.size());
  for (size_t k = 0; k < study.load_shares.size(); ++k)
    EXPECT_NEAR(runs[0].history[k], study.load_shares[k] * 0.3 * *study.load, 1e-7 * *study.load);
  const std::string folder = testing::TempDir() + "hysteresis";
  std::filesystem::create_directories(folder);
  const std::vector<std::string> paths = writeRollingFiles(study, runs, folder);
  ASSERT_EQ(paths.size(), 3u);
  EXPECT_THAT(contents(paths[2]), HasSubstr("step,Q,shift,dissipated\n1,"));
  EXPECT_THAT(complaint(HEAD + "load: {normal: 1, tangential_share: [0.5, 1.5]}\n"), HasSubstr("tangential_share[1]"));
  EXPECT_THAT(complaint(HEAD + "load: {normal: 1, tangential_share: [0.5, 0]}\nrolling: {motion: steady}\n"),
              HasSubstr("load.tangential_share"));
}

TEST(RollingCaseTest, RepeatedRunsGiveTheSameBits)
{
  const std::vector<RollingRun> first = runRollingCase(example("paper")), second = runRollingCase(example("paper"));
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i)
  {
    EXPECT_EQ(first[i].contact.r_N, second[i].contact.r_N);
    EXPECT_EQ(first[i].contact.r_T, second[i].contact.r_T);
  }
}

TEST(RollingCaseTest, WithoutTouchingThereAreNoForces)
{
  // Twenty nodes lie beside the lowest point, at gaps above 1e-7 m: an approach of 1e-9 m presses none of them.
  const std::vector<RollingRun> runs = runRollingCase(parseRollingCase(
      HEAD + "nodes: 20\nhalf_width: 0.02\nflexibility: half_plane\ndisplacement: {normal: 1.0e-9}\n", "case.yaml"));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_TRUE(runs[0].converged);
  EXPECT_EQ(runs[0].contact.P, 0.0);
  EXPECT_LT(runs[0].contact.residual, 1e-12);
}

TEST(RollingCaseTest, FrictionlessRollingIsSteadyAtOnce)
{
  const std::vector<RollingRun> runs = runRollingCase(parseRollingCase(
      "upper: {young_modulus: 94500, poisson_ratio: 0.1}\nfriction: 0.0\nnodes: 40\n"
      "flexibility: half_plane\nload: {normal: 100.0}\nrolling: {motion: transient, creepage: 0.001}\n",
      "case.yaml"));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_TRUE(runs[0].converged);
  EXPECT_EQ(runs[0].history.size(), 2u);
  EXPECT_NEAR(runs[0].contact.P, 100.0, 1e-7);
}

TEST(RollingCaseTest, AnInterruptedRunCanBeWrittenWhereverItStopped)
{
  const RollingCase study = parseRollingCase(
      HEAD +
          "nodes: 30\nflexibility: half_plane\nload: {normal: 100.0}\nrolling: {motion: transient, creepage: 0.002}\n",
      "case.yaml");
  const std::string folder = testing::TempDir() + "interrupted";
  std::filesystem::create_directories(folder);
  for (const int calls : {0, 1, 2, 5, 20, 60})
  {
    int asked = 0;
    RunHooks hooks;
    hooks.interrupted = [&] { return asked++ >= calls; };
    const std::vector<RollingRun> runs = runRollingCase(study, hooks);
    for (const RollingRun& run : runs)
      EXPECT_FALSE(run.converged) << calls;
    writeRollingFiles(study, runs, folder);
  }
}
