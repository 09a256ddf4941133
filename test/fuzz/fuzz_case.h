#pragma once
/**
 * @file fuzz_case.h
 * @brief A set of valid input files, one of them then damaged (mutation.h), and what the package does with them.
 */
#include <cstdint>
#include <map>
#include <string>

namespace frictional_contact_sim
{
namespace test_support
{
enum class FuzzInput
{
  URDF,
  SCENARIO,
  OBJ,
  STL,
  FCLIB,
  GMSH,
  MATRICES  ///< one of: mass, stiffness, table of nodes
};
const char* toString(FuzzInput input);

struct FuzzCase
{
  std::map<std::string, std::string> files;  ///< name -> content
  std::string main;  ///< the scenario or the FCLib file
};

/** @brief The damaged files of a seed; the same for the same seed. @param scratch folder for files on the way */
FuzzCase makeFuzzCase(FuzzInput input, std::uint32_t seed, const std::string& scratch);

/**
 * @brief Loads the files from `folder` and, where that succeeds, makes three steps (FCLib: one solve of 50 iterations).
 * @return what is wrong with the reaction, empty when nothing is: numbers that are not finite, an error that is more
 * than one line or names no file
 */
std::string judgeFuzzCase(FuzzInput input, const FuzzCase& files, const std::string& folder);

}  // namespace test_support
}  // namespace frictional_contact_sim
