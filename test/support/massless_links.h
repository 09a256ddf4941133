#pragma once
/**
 * @file massless_links.h
 * @brief Takes the inertia from random links of a robot of random_robot.h: leaves, middles, runs of several, the root.
 */
#include <regex>
#include <set>
#include <string>

#include "support/dice.h"

namespace frictional_contact_sim
{
namespace test_support
{
struct MasslessLinks
{
  std::string xml;
  std::set<std::string> links;  ///< whose inertia was taken, wholly or about their centre
};

/** @brief Each link alone with a chance of 0.3, or a run of up to five; no <inertial>, zeros, or a point mass. */
inline MasslessLinks takeInertia(const std::string& xml, Dice& dice)
{
  static const std::regex LINK("<link name='(l[0-9]+)'>(<inertial>.*?</inertial>)");
  const bool in_runs = dice.chance(0.4);
  int left = 0;  // of a run
  MasslessLinks result;
  size_t end = 0;
  for (std::sregex_iterator link(xml.begin(), xml.end(), LINK); link != std::sregex_iterator(); ++link)
  {
    result.xml += xml.substr(end, static_cast<size_t>(link->position()) - end);
    end = static_cast<size_t>(link->position() + link->length());
    if (in_runs && left == 0 && dice.chance(0.2))
      left = dice.integer(2, 5);
    const bool taken = in_runs ? left > 0 : dice.chance(0.3);
    left -= in_runs && left > 0 ? 1 : 0;
    const std::string zeros = "<inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial>";
    std::string inertial = (*link)[2];
    if (taken)
    {
      const int kind = dice.integer(0, 2);
      if (kind == 0)
        inertial.clear();
      else if (kind == 1)
        inertial = "<inertial><mass value='0'/>" + zeros;
      else
        inertial = inertial.substr(0, inertial.find("<inertia ")) + zeros;
      result.links.insert((*link)[1]);
    }
    result.xml += "<link name='" + std::string((*link)[1]) + "'>" + inertial;
  }
  result.xml += xml.substr(end);
  return result;
}

inline std::string withoutCollisions(const std::string& xml)
{
  return std::regex_replace(xml, std::regex("<collision>.*?</collision>"), "");
}

}  // namespace test_support
}  // namespace frictional_contact_sim
