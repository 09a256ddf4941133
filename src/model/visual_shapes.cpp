#include "frictional_contact_sim/model/visual_shapes.h"

#include <tinyxml2.h>

#include <map>
#include <sstream>

#include "frictional_contact_sim/math/roll_pitch_yaw.h"

namespace frictional_contact_sim
{
namespace
{
using Element = tinyxml2::XMLElement;

/** N finite numbers of an attribute, else nothing. */
template <int N>
std::optional<Eigen::Matrix<double, N, 1>> numbers(const Element* element, const char* attribute)
{
  const char* text = element == nullptr ? nullptr : element->Attribute(attribute);
  if (text == nullptr)
    return std::nullopt;
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  Eigen::Matrix<double, N, 1> values;
  for (int i = 0; i < N; ++i)
    if (!(words >> values[i]))
      return std::nullopt;
  return values.allFinite() ? std::optional(values) : std::nullopt;
}

double number(const Element* element, const char* attribute)
{
  const auto value = numbers<1>(element, attribute);
  return value ? (*value)[0] : 0.0;
}

Eigen::Isometry3d origin(const Element* visual)
{
  const Element* element = visual->FirstChildElement("origin");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (const auto xyz = numbers<3>(element, "xyz"))
    pose.translation() = *xyz;
  if (const auto rpy = numbers<3>(element, "rpy"))
    pose.linear() = fromRollPitchYaw(*rpy).toRotationMatrix();
  return pose;
}

std::optional<Geometry> geometry(const Element* visual, const std::string& folder)
{
  const Element* holder = visual->FirstChildElement("geometry");
  const Element* shape = holder == nullptr ? nullptr : holder->FirstChildElement();
  if (shape == nullptr)
    return std::nullopt;
  const std::string name = shape->Name();
  const double radius = number(shape, "radius");
  const double length = number(shape, "length");
  if (name == "sphere" && radius > 0.0)
    return Sphere{radius};
  if (name == "cylinder" && radius > 0.0 && length > 0.0)
    return Cylinder{radius, 0.5 * length};
  if (name == "capsule" && radius > 0.0 && length >= 0.0)
    return Capsule{radius, 0.5 * length};
  if (name == "box")
  {
    const auto size = numbers<3>(shape, "size");
    return size && size->minCoeff() > 0.0 ? std::optional<Geometry>(Box{0.5 * *size}) : std::nullopt;
  }
  const char* file = shape->Attribute("filename");
  if (name != "mesh" || file == nullptr || *file == '\0')
    return std::nullopt;
  const std::string uri = file;
  const bool relative = uri.find("://") == std::string::npos && uri.front() != '/';
  const auto scale = numbers<3>(shape, "scale");
  return Mesh{relative ? folder + "/" + uri : uri, scale ? *scale : Eigen::Vector3d(1.0, 1.0, 1.0)};
}

std::optional<Eigen::Vector4d> color(const Element* material)
{
  return material == nullptr ? std::nullopt : numbers<4>(material->FirstChildElement("color"), "rgba");
}
}  // namespace

std::vector<VisualShape> readVisualShapes(const std::string& xml, const std::string& folder)
{
  std::vector<VisualShape> shapes;
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.c_str()) != tinyxml2::XML_SUCCESS)
    return shapes;
  const Element* robot = document.FirstChildElement("robot");
  if (robot == nullptr)
    return shapes;
  std::map<std::string, Eigen::Vector4d> colors;  // by material
  for (const Element* one = robot->FirstChildElement("material"); one; one = one->NextSiblingElement("material"))
    if (const char* name = one->Attribute("name"))
      if (const auto rgba = color(one))
        colors[name] = *rgba;
  for (const Element* link = robot->FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
    for (const Element* one = link->FirstChildElement("visual"); one; one = one->NextSiblingElement("visual"))
    {
      const char* link_name = link->Attribute("name");
      const std::optional<Geometry> drawn = geometry(one, folder);
      if (link_name == nullptr || !drawn)
        continue;
      const Element* material = one->FirstChildElement("material");
      const char* material_name = material == nullptr ? nullptr : material->Attribute("name");
      VisualShape shape{link_name, *drawn, origin(one), color(material)};
      if (!shape.color && material_name != nullptr && colors.count(material_name) > 0)
        shape.color = colors[material_name];
      shapes.push_back(shape);
    }
  return shapes;
}

}  // namespace frictional_contact_sim
