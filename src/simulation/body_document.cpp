#include "frictional_contact_sim/simulation/body_document.h"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace frictional_contact_sim
{
BodyDocument bodyDocument(const BodySpec& spec)
{
  if (spec.urdf_path.empty())
    return {spec.urdf_xml, ""};
  std::error_code ignored;
  const std::filesystem::path folder = (std::filesystem::current_path(ignored) / spec.urdf_path).parent_path();
  if (!spec.urdf_xml.empty())
    return {spec.urdf_xml, folder.lexically_normal().string()};
  std::ifstream file(spec.urdf_path);
  std::ostringstream text;
  text << file.rdbuf();
  return {text.str(), folder.lexically_normal().string()};
}

}  // namespace frictional_contact_sim
