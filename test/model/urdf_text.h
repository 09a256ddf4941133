#pragma once
/**
 * @file urdf_text.h
 * @brief Small URDF documents for tests.
 */
#include <array>
#include <sstream>
#include <string>

namespace frictional_contact_sim
{
inline std::string robot(const std::string& content)
{
  return "<robot name=\"test\">\n" + content + "</robot>\n";
}

inline std::string link(const std::string& name, const std::string& content)
{
  return "<link name=\"" + name + "\">" + content + "</link>\n";
}

/** @param moments "ixx iyy izz" [kg m^2] @param center [m] */
inline std::string inertial(double mass, const std::string& moments, const std::array<double, 3>& center = {0, 0, 0})
{
  std::istringstream words(moments);
  std::string ixx;
  std::string iyy;
  std::string izz;
  words >> ixx >> iyy >> izz;
  std::ostringstream text;
  text.precision(17);
  text << "<inertial><origin xyz=\"" << center[0] << " " << center[1] << " " << center[2] << "\"/><mass value=\""
       << mass << "\"/><inertia ixx=\"" << ixx << "\" ixy=\"0\" ixz=\"0\" iyy=\"" << iyy << "\" iyz=\"0\" izz=\"" << izz
       << "\"/></inertial>";
  return text.str();
}

inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& content = "")
{
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + content + "</joint>\n";
}

}  // namespace frictional_contact_sim
