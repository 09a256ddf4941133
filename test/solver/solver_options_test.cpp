/**
 * @file solver_options_test.cpp
 * @brief Every option of every method, from the tables beside them: the default said is the default left out, to the
 * bit; what is out of range is refused in one line; another value reaches the method.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "frictional_contact_sim/problem/random_family.h"
#include "frictional_contact_sim/solver/registry.h"
#include "method_test_support.h"
#include "support/dice.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/// What a solve came to; equal means equal bits.
struct Outcome
{
  SolverStatus status;
  int iterations;
  double work;
  Eigen::VectorXd r;

  bool operator==(const Outcome& other) const
  {
    return status == other.status && iterations == other.iterations && work == other.work && r == other.r;
  }
};

/// Small ones of all laws, ones that need many iterations, and one whose start is not cold.
const std::vector<IncrementalProblem>& problems()
{
  static const std::vector<IncrementalProblem> all = []
  {
    std::vector<IncrementalProblem> list = {squareOnTwoContacts(),
                                            restingBox(10, {0.5, 0.3, 0.2}, 0.9, {1, -2, 0}, {0, 0, -9.81}, 1e-3)};
    for (std::uint32_t seed = 1; seed <= 4; ++seed)
    {
      RandomProblemOptions options;
      options.contacts = 4 + static_cast<int>(seed);
      options.planar_contacts = static_cast<int>(seed % 2);
      options.dry = static_cast<int>(seed % 3);
      list.push_back(randomProblem(options, seed));
    }
    for (std::uint32_t seed = 11; seed <= 16; ++seed)  // much friction: fixed points cycle, steps are shortened
    {
      RandomProblemOptions options;
      options.contacts = 10;
      options.bodies = 3;
      IncrementalProblem problem = randomProblem(options, seed);
      for (Law& law : problem.laws)
        law.coefficient *= 5.0;
      list.push_back(problem);
    }
    RandomFamilyOptions family;
    family.contacts = 14;
    list.push_back(randomFamilyProblem(family));
    return list;
  }();
  return all;
}

/// Without a solution: something squeezed between walls that approach each other, what the last resorts are for.
std::vector<DelassusProblem> hopeless()
{
  Eigen::MatrixXd W = Eigen::MatrixXd::Identity(6, 6);
  W(0, 3) = W(3, 0) = -1.0;
  Eigen::VectorXd q(6);
  q << -1, 0.2, 0, -1, 0.5, 0;
  const std::vector<Law> laws = {{LawType::COULOMB_3D, 0.5}, {LawType::COULOMB_3D, 0.5}};
  DelassusProblem squeezed = localProblem(W, q, laws);
  W(0, 3) = W(3, 0) = -0.999;  // nearly so
  return {squeezed, localProblem(W, q, laws)};
}

void addOutcomes(const SolverResult& cold, const SolverResult& warm, std::vector<Outcome>& all)
{
  for (const SolverResult* result : {&cold, &warm})
    all.push_back({result->status, result->iterations, result->work, result->solution.r});
}

/// An answer that is spoilt.
Solution guessFrom(const SolverResult& result)
{
  Solution guess = result.solution;
  for (Eigen::Index i = 0; i < guess.r.size(); ++i)
    guess.r[i] = 0.7 * guess.r[i] + (i % 3 == 0 ? 0.01 : -0.02);
  return guess;
}

std::vector<Outcome> outcomes(Solver& solver, int iterations = 150)
{
  StoppingOptions stopping = stopAfter(iterations, 1e-10);
  stopping.work_per_iteration = 20.0;
  solver.setStopping(stopping);
  std::vector<Outcome> all;
  for (const IncrementalProblem& problem : problems())
  {
    const SolverResult cold = solver.solve(problem);
    const Solution guess = guessFrom(cold);
    addOutcomes(cold, solver.solve(problem, &guess), all);
  }
  for (const DelassusProblem& problem : hopeless())
  {
    const SolverResult cold = solver.solve(problem);
    const Solution guess = guessFrom(cold);
    addOutcomes(cold, solver.solve(problem, &guess), all);
  }
  return all;
}

std::string complaint(const std::string& solver, const SolverOptions& options)
{
  try
  {
    createSolver(solver, options);
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "accepted";
}

void expectRefused(const std::string& solver, const SolverOption& option, const std::string& value)
{
  const std::string message = complaint(solver, {{option.name, value}});
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& part : {solver, option.name, option.expected()})
    EXPECT_NE(message.find(part), std::string::npos)
        << solver << '.' << option.name << " = " << value << ": " << message;
}

/// Texts that lie outside the range, at its ends or just beyond.
std::vector<std::string> outside(const SolverOption& option)
{
  std::vector<std::string> texts = {"", "nan", "word", "1e3x", "[1]", "--1", "1 2"};
  if (!option.words.empty())
    return {"", "0", option.words.front() + "x", "1"};
  const NumberRange& range = option.range;
  if (std::isfinite(range.lower))
    texts.push_back(numberText(range.lower_open ? range.lower : range.lower - 1.0));
  if (std::isfinite(range.upper))
    texts.push_back(numberText(range.upper_open ? range.upper : range.upper + 1.0));
  if (!range.infinite_too)
    texts.insert(texts.end(), {"inf", ".inf", "-inf"});
  if (option.is_integer)
    texts.insert(texts.end(), {"1.5", "2147483648", "1e30"});
  return texts;
}

/// Other values than the default, from gentle to rough.
std::vector<std::string> alternatives(const SolverOption& option)
{
  if (!option.words.empty())
    return option.words;
  const double value = std::stod(option.default_value);
  std::vector<double> numbers = {
      0.5 * value,  2.0 * value, value + 1.0, value - 1.0, 0.1 * value, 10 * value, 1e3 * value, option.range.lower,
      1e-3 * value, 1.0,         1e-8,        0.5,         2.0,         30.0,       0.99};
  if (std::isfinite(option.range.upper))
    numbers.insert(numbers.end(), {0.5 * (option.range.lower + option.range.upper), 0.999 * option.range.upper});
  std::vector<std::string> texts;
  for (const double number : numbers)
  {
    const double candidate = option.is_integer ? std::round(number) : number;
    if (candidate != value && option.range.holds(candidate))
      texts.push_back(numberText(candidate));
  }
  return texts;
}

/// Where an option matters only beside others: what those are set to.
std::vector<SolverOptions> companions(const std::string& solver)
{
  if (solver == "gauss_seidel")
    return {{}, {{"stall_window", "3"}}};
  if (solver == "ac_newton" || solver == "ds_newton" || solver == "fb_newton")
    return {{},
            {{"inner_iterations", "1"}, {"proximal_start", "1"}},
            {{"line_search_steps", "0"}, {"inner_iterations", "2"}}};
  if (solver == "portfolio")
    return {{},
            {{"newton_first_steps", "1"}, {"interior_steps", "10"}},
            {{"newton_first_steps", "1"}, {"interior_rows", "0"}},
            {{"newton_first_rows", "0"}},
            {{"newton_first_rows", "0"}, {"newton_try_steps", "1"}, {"haslinger_steps", "1"}, {"first_sweeps", "1"}},
            {{"newton_first_rows", "0"}, {"newton_try_rows", "0"}},
            {{"newton_first_rows", "0"}, {"newton_try_rows", "0"}, {"haslinger_steps", "1"}},
            {{"newton_first_rows", "0"},
             {"newton_try_rows", "0"},
             {"haslinger_steps", "1"},
             {"first_sweeps", "1"},
             {"newton_steps", "1"},
             {"later_sweeps", "1"}},
            {{"newton_first_rows", "0"},
             {"newton_try_rows", "0"},
             {"haslinger_steps", "1"},
             {"first_sweeps", "1"},
             {"newton_last_rows", "0"},
             {"swept_first_rows", "0"},
             {"later_sweeps", "1"}},
            {{"newton_first_rows", "0"},
             {"newton_try_rows", "0"},
             {"haslinger_steps", "1"},
             {"first_sweeps", "1"},
             {"newton_last_rows", "0"},
             {"swept_first_rows", "0"},
             {"swept_steps", "1"}}};
  return {{}};
}

/// What shapes the report of enumerate(), not the one answer of the method, or is met by none of the problems here.
const std::set<std::string> UNSEEN = {"max_vertices", "max_families", "min_angle", "enumerate_rows",
                                      // with cuts only, and then the answers are the same: enumeration_cuts_test
                                      "cuts_per_node", "cut_depth"};

bool reaches(const SolverEntry& entry, const SolverOption& option)
{
  for (const SolverOptions& beside : companions(entry.name))
  {
    const std::vector<Outcome> before = outcomes(*createSolver(entry.name, beside));
    for (const std::string& value : alternatives(option))
    {
      SolverOptions changed = beside;
      changed[option.name] = value;
      if (complaint(entry.name, changed) == "accepted" && !(outcomes(*createSolver(entry.name, changed)) == before))
        return true;
    }
  }
  return false;
}

class SolverOptionsTest : public testing::TestWithParam<std::string>
{
protected:
  const SolverEntry& entry_ = findSolver(GetParam());
};
}  // namespace

TEST_P(SolverOptionsTest, TheDefaultSaidIsTheDefaultLeftOut)
{
  const std::vector<Outcome> expected = outcomes(*entry_.create());
  SolverOptions all;
  for (const SolverOption& option : entry_.options())
    all[option.name] = option.default_value;
  EXPECT_TRUE(outcomes(*createSolver(entry_.name, all)) == expected);
  EXPECT_TRUE(outcomes(*createSolver(entry_.name)) == expected);
  for (const SolverOption& option : entry_.options())
  {
    EXPECT_EQ(complaint(entry_.name, {{option.name, option.default_value}}), "accepted");
    EXPECT_FALSE(option.meaning.empty()) << option.name;
    EXPECT_FALSE(option.unit.empty()) << option.name;
  }
}

TEST_P(SolverOptionsTest, WhatIsOutOfRangeIsRefusedInOneLine)
{
  for (const SolverOption& option : entry_.options())
    for (const std::string& value : outside(option))
      expectRefused(entry_.name, option, value);
}

TEST_P(SolverOptionsTest, AMisspeltOptionIsRefusedWithTheNearest)
{
  for (const SolverOption& option : entry_.options())
  {
    std::string wrong = option.name;
    std::swap(wrong[1], wrong[2]);
    const std::string message = complaint(entry_.name, {{wrong, option.default_value}});
    const std::string expected =
        std::string(entry_.name) + " has no option '" + wrong + "', did you mean '" + option.name + "'?";
    EXPECT_TRUE(wrong == option.name || message.find(expected) != std::string::npos) << message;
  }
}

TEST_P(SolverOptionsTest, AnotherValueReachesTheMethod)
{
  for (const SolverOption& option : entry_.options())
    EXPECT_TRUE(UNSEEN.count(option.name) > 0 || reaches(entry_, option)) << option.name;
}

TEST_P(SolverOptionsTest, RandomTextsAreTakenOrRefused)
{
  const std::string letters = "0123456789.eE+-infax _";
  Dice dice(5);
  for (const SolverOption& option : entry_.options())
    for (int k = 0; k < 100; ++k)
    {
      std::string text;
      for (int length = dice.integer(0, 8); length > 0; --length)
        text += letters[static_cast<size_t>(dice.integer(0, static_cast<int>(letters.size()) - 1))];
      const std::string message = complaint(entry_.name, {{option.name, text}});
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

INSTANTIATE_TEST_SUITE_P(Registry, SolverOptionsTest,
                         testing::ValuesIn(
                             []
                             {
                               std::vector<std::string> names;
                               for (const SolverEntry& entry : solverRegistry())
                                 names.emplace_back(entry.name);
                               return names;
                             }()),
                         [](const testing::TestParamInfo<std::string>& info) { return info.param; });

TEST(SolverOptionsListTest, EveryMethodIsListedWithItsOptions)
{
  const std::string list = describeSolvers();
  for (const SolverEntry& entry : solverRegistry())
  {
    const size_t method = list.find(std::string(entry.name) + " ");
    ASSERT_NE(method, std::string::npos) << entry.name;
    size_t place = method;
    for (const SolverOption& option : entry.options())
    {
      place = list.find("\n    " + option.name + " ", place);
      ASSERT_NE(place, std::string::npos) << entry.name << '.' << option.name;
      const std::string line = list.substr(place + 1, list.find('\n', place + 1) - place - 1);
      EXPECT_NE(line.find(" " + option.default_value + " "), std::string::npos) << line;
      EXPECT_NE(line.find(option.meaning), std::string::npos) << line;
    }
  }
  EXPECT_NE(complaint("admmm", {}).find("unknown solver 'admmm', did you mean 'admm'? expected one of: portfolio"),
            std::string::npos)
      << complaint("admmm", {});
}
