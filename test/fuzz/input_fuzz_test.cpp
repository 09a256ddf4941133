// Damaged input files of every kind: no crash, no hang, and either three steps without NaN or one line naming a file.
// FCS_FUZZ_INPUTS=N takes N seeds of each kind from FCS_FUZZ_FIRST on (scripts/fuzz_inputs), FCS_FUZZ_KEEP=FOLDER keeps
// the files of those that fail.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "fuzz_case.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::FuzzCase;
using test_support::FuzzInput;
namespace fs = std::filesystem;

#ifdef __SANITIZE_ADDRESS__
constexpr bool SANITIZED = true;
#else
constexpr bool SANITIZED = false;
#endif
constexpr unsigned MOST_SECONDS = SANITIZED ? 120 : 30;  ///< of an input: then it hangs
constexpr rlim_t MOST_MEMORY = rlim_t{4} << 30;  ///< [bytes] a small file must not take more (sanitizers map more)
constexpr std::uint32_t SUITE_SEEDS = 60;

std::uint32_t number(const char* variable, std::uint32_t fallback)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? fallback : static_cast<std::uint32_t>(std::stoul(text));
}

/** What a child process says about a case; a signal that ended it is a fault too. */
std::string judgeInChild(FuzzInput input, const FuzzCase& files, const std::string& folder)
{
  int channel[2];
  if (pipe(channel) != 0)
    return "no pipe";
  const pid_t child = fork();
  if (child == 0)
  {
    close(channel[0]);
    alarm(MOST_SECONDS);
    if (!SANITIZED)
    {
      const rlimit memory{MOST_MEMORY, MOST_MEMORY};
      setrlimit(RLIMIT_AS, &memory);
    }
    const std::string fault = test_support::judgeFuzzCase(input, files, folder);
    const ssize_t written = write(channel[1], fault.data(), std::min<size_t>(fault.size(), 4000));
    _exit(written < 0 ? 3 : 0);
  }
  close(channel[1]);
  std::string fault;
  char buffer[4096];
  for (ssize_t count = read(channel[0], buffer, sizeof buffer); count > 0;
       count = read(channel[0], buffer, sizeof buffer))
    fault.append(buffer, static_cast<size_t>(count));
  close(channel[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status))
    return WTERMSIG(status) == SIGALRM ? "hangs" : std::string("ends by ") + strsignal(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? fault : "ends with code " + std::to_string(WEXITSTATUS(status)) + " " + fault;
}

void keep(const FuzzCase& files, const std::string& name)
{
  const char* root = std::getenv("FCS_FUZZ_KEEP");
  if (root == nullptr)
    return;
  fs::create_directories(fs::path(root) / name);
  for (const auto& [file, content] : files.files)
    std::ofstream(fs::path(root) / name / file, std::ios::binary) << content;
}

/** Seeds that have found something beyond the suite's: an axis of 1e308, a triangle of M without a diagonal entry. */
std::vector<std::uint32_t> foundSeeds(FuzzInput input)
{
  switch (input)
  {
    case FuzzInput::URDF:
      return {87, 725};
    case FuzzInput::FCLIB:
      return {782, 983};
    default:
      return {};
  }
}

class InputFuzzTest : public testing::TestWithParam<FuzzInput>
{
};

TEST_P(InputFuzzTest, DamagedFilesAreTakenOrNamedInOneLine)
{
  const fs::path folder =
      fs::temp_directory_path() / ("fuzz_" + std::string(toString(GetParam())) + "_" + std::to_string(getpid()));
  fs::create_directories(folder / "valid");
  const std::uint32_t first = number("FCS_FUZZ_FIRST", 0);
  const std::uint32_t count = number("FCS_FUZZ_INPUTS", SUITE_SEEDS);
  std::vector<std::uint32_t> seeds = foundSeeds(GetParam());
  for (std::uint32_t seed = first; seed < first + count; ++seed)
    seeds.push_back(seed);
  int faults = 0;
  for (const std::uint32_t seed : seeds)
  {
    const FuzzCase files = test_support::makeFuzzCase(GetParam(), seed, (folder / "valid").string());
    const std::string fault = judgeInChild(GetParam(), files, folder.string());
    if (fault.empty())
      continue;
    ++faults;
    ADD_FAILURE() << toString(GetParam()) << " seed " << seed << ": " << fault;
    keep(files, std::string(toString(GetParam())) + "_" + std::to_string(seed));
  }
  std::cout << "[  fuzz    ] " << seeds.size() << " damaged inputs of kind " << toString(GetParam()) << ", " << faults
            << " faults\n";
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Kinds, InputFuzzTest,
                         testing::Values(FuzzInput::URDF, FuzzInput::SCENARIO, FuzzInput::OBJ, FuzzInput::STL,
                                         FuzzInput::FCLIB, FuzzInput::GMSH, FuzzInput::MATRICES),
                         [](const auto& info) { return std::string(toString(info.param)); });

/** HDF5 files hold times of writing. */
TEST(FuzzCaseTest, SameSeedSameFiles)
{
  const std::string folder = (fs::temp_directory_path() / ("fuzz_same_" + std::to_string(getpid()))).string();
  fs::create_directories(folder);
  for (const FuzzInput input :
       {FuzzInput::URDF, FuzzInput::SCENARIO, FuzzInput::OBJ, FuzzInput::STL, FuzzInput::GMSH, FuzzInput::MATRICES})
    for (std::uint32_t seed = 0; seed < 5; ++seed)
      EXPECT_EQ(test_support::makeFuzzCase(input, seed, folder).files,
                test_support::makeFuzzCase(input, seed, folder).files);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace frictional_contact_sim
