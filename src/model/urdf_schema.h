#pragma once
/**
 * @file urdf_schema.h
 * @brief Which elements and attributes of a URDF this package reads, and what its numbers must be. Private to model/.
 *
 * urdfdom drops what it does not know, takes some bad numbers without a word and names no line for others. So the
 * document is checked here first, with tinyxml2, and urdfdom is given what is left: known elements, finite numbers.
 */
#include <string>
#include <vector>

namespace tinyxml2
{
class XMLElement;
}

namespace frictional_contact_sim
{
/** @brief Counts what is left out by kind, so that each kind is named once, with its number and first place. */
class OmissionTally
{
public:
  /** @brief "<what> is not used". */
  void add(const std::string& what, const std::string& where);
  /** @brief Something else worth a warning. */
  void addNote(const std::string& what, const std::string& where);
  /** @brief One line per kind, in order of appearance. */
  std::vector<std::string> lines() const;

private:
  struct Entry
  {
    std::string what;
    std::string first;
    int count;
  };
  std::vector<Entry> entries_;
};

/** @brief "link 'foot'" or "joint 'knee'": the named element around (or at) this one; "<robot>" at the top. */
std::string describeOwner(const tinyxml2::XMLElement& element);

/** @brief A finite double and nothing else. @return false otherwise */
bool parseNumber(const std::string& text, double& value);

/** @brief Greatest absolute value of the numbers in a list separated by blanks; 0 for none. */
double largestMagnitude(const std::string& numbers);

/**
 * @brief Checks the children of <robot> and removes what is not read (unknown elements go to the tally, visuals and
 * materials silently: nothing here draws).
 * @throws ModelError naming the line, the owner, the attribute and its value
 */
void applySchema(tinyxml2::XMLElement& robot, const std::string& source, OmissionTally& omissions);

}  // namespace frictional_contact_sim
