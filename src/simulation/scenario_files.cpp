#include "frictional_contact_sim/simulation/scenario_files.h"

#include <algorithm>
#include <filesystem>

#include "frictional_contact_sim/config/config_error.h"
#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/model/model_error.h"
#include "frictional_contact_sim/model/urdf_loader.h"

namespace frictional_contact_sim
{
namespace
{
namespace fs = std::filesystem;

/** config/scenarios: beside the installed programs (PREFIX/lib/PACKAGE, PREFIX/share/PACKAGE), else of the ROS package.
 */
fs::path scenarioFolder()
{
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path() / "../../share/frictional_contact_sim/config/scenarios";
  if (!program.empty() && fs::is_directory(installed, ignored))
    return installed.lexically_normal();
  try
  {
    return fs::path(resolvePath("package://frictional_contact_sim/package.xml", "")).parent_path() / "config/scenarios";
  }
  catch (const ModelError&)
  {
    return {};
  }
}
}  // namespace

std::vector<std::string> packageScenarios()
{
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(scenarioFolder(), ignored))
    if (entry.path().extension() == ".yaml")
      names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string findScenario(const std::string& name)
{
  std::error_code ignored;
  const bool is_folder = fs::is_directory(name, ignored);
  if (!is_folder && fs::exists(name, ignored))
    return name;
  const std::string found = is_folder ? ": is a folder" : ": is no file";
  if (name.find('/') != std::string::npos || fs::path(name).extension() == ".yaml")
    throw ConfigError(inOneLine(name + found + ", expected a scenario file (YAML)"));
  const std::vector<std::string> names = packageScenarios();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw ConfigError(inOneLine(name + found + " and no scenario of the package, " + didYouMean(name, names) +
                                "expected a scenario file (YAML) or one of: " + joinNames(names)));
  return (scenarioFolder() / (name + ".yaml")).string();
}

}  // namespace frictional_contact_sim
