#include "frictional_contact_sim/simulation/run_settings.h"

namespace frictional_contact_sim
{
namespace
{
template <class T, class Visit>
void visitOptional(StateArchive& archive, const std::string& name, std::optional<T>& value, Visit visit)
{
  bool is_set = value.has_value();
  archive.flag(name + " (set)", is_set);
  if (!is_set)
    value.reset();
  else if (!value)
    value.emplace();
  if (value)
    visit(*value);
}

void visitNumber(StateArchive& archive, const std::string& name, std::optional<double>& value)
{
  visitOptional(
      archive, name, value, [&](double& number) { archive.number(name, number); });
}

void visitGroup(StateArchive& archive, SurfaceGroup& group)
{
  archive.text("friction: material", group.material);
  archive.text("friction: body", group.body);
  archive.text("friction: link", group.link);
}
}  // namespace

void visitSettings(StateArchive& archive, RunSettings& settings)
{
  visitNumber(archive, "time_step", settings.time_step);
  visitOptional(
      archive, "gravity", settings.gravity, [&](Eigen::Vector3d& gravity) { archive.vector("gravity", gravity); });
  visitOptional(archive, "solver", settings.solver, [&](std::string& name) { archive.text("solver", name); });
  visitNumber(archive, "tolerance", settings.tolerance);
  visitOptional(archive, "max_iterations", settings.max_iterations,
                [&](int& iterations) { archive.index("max_iterations", iterations); });
  visitNumber(archive, "default_friction", settings.default_friction);
  for (PairRule& rule : archive.list("friction", settings.friction))
  {
    visitGroup(archive, rule.a);
    visitGroup(archive, rule.b);
    archive.number("friction", rule.friction);
    visitNumber(archive, "restitution", rule.restitution);
  }
}

}  // namespace frictional_contact_sim
