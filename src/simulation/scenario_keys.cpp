#include "frictional_contact_sim/simulation/scenario_keys.h"

#include "frictional_contact_sim/solver/registry.h"
#include "material_keys.h"

namespace frictional_contact_sim
{
namespace
{
std::string solverName(const ConfigNode& node)
{
  const std::string name = node.text();
  try
  {
    return findSolver(name).name;
  }
  catch (const std::invalid_argument& error)
  {
    node.fail(error.what());
  }
}

/** Each by itself, so that its own line is named; how they go together is checkSolver's. */
std::string readSolverOption(const ConfigNode& node, const std::string& solver, const std::string& option)
{
  const std::string value = node.literal();
  try
  {
    checkSolverOption(solver, option, value);
  }
  catch (const std::invalid_argument& error)
  {
    node.fail(error.what());
  }
  return value;
}

/** Options that a scenario has for one method mean nothing to another. */
void setSolver(const std::string& name, Scenario& scenario)
{
  if (name != scenario.solver)
    scenario.solver_options.clear();
  scenario.solver = name;
}

/** solver: NAME, or a map. */
void readSolver(const ConfigNode& node, Scenario& scenario)
{
  if (!node.isMap())
  {
    setSolver(solverName(node), scenario);
    return;
  }
  node.readMap({key("name", [&](const ConfigNode& name) { setSolver(solverName(name), scenario); }),
                toleranceKey(scenario.stopping), maxIterationsKey(scenario.stopping),
                solverOptionsKey("options", scenario)});
  checkSolver(node.at("options"), scenario);
}

/** ground: {height, friction}; true or nothing for the plane z = 0, false for none. */
void readGround(const ConfigNode& node, std::optional<GroundSpec>& ground)
{
  ground.reset();
  if (node.isBoolean() && !node.boolean())
    return;
  ground.emplace();
  if (!node.isThere() || node.isBoolean())
    return;
  if (!node.isMap())
    node.failExpecting("true, false or {height: z, friction: mu}");
  double friction = -1.0;
  node.readMap({frictionKey("friction", friction), key("height", ground->height)});
  if (friction >= 0.0)
    ground->friction = friction;
}

void readFailure(const ConfigNode& node, FailureOptions& failure)
{
  node.readMap({failurePolicyKey("policy", failure), key("fallback", failure.fallback),
                key("time_limit", failure.time_limit, notNegative())});
}
}  // namespace

void checkSolver(const ConfigNode& place, const Scenario& scenario)
{
  try
  {
    createSolver(scenario.solver, scenario.solver_options);
  }
  catch (const std::invalid_argument& error)
  {
    place.fail(error.what());
  }
}

ConfigKey solverOptionsKey(const std::string& name, Scenario& scenario)
{
  return key(
      name,
      [&scenario](const ConfigNode& node)
      {
        for (const auto& [option, value] : node.entries())
          scenario.solver_options[option] = readSolverOption(value, scenario.solver, option);
      });
}

ConfigKey toleranceKey(StoppingOptions& stopping)
{
  return key("tolerance", stopping.tolerance, positive());
}

ConfigKey maxIterationsKey(StoppingOptions& stopping)
{
  return key("max_iterations", stopping.max_iterations, 0);
}

ConfigKey failurePolicyKey(const std::string& name, FailureOptions& failure)
{
  Choices<FailurePolicy> policies;
  for (const FailurePolicy policy :
       {FailurePolicy::STOP, FailurePolicy::PAUSE, FailurePolicy::HOLD, FailurePolicy::ACCEPT})
    policies.emplace_back(toString(policy), policy);
  return key(name, failure.policy, policies);
}

ConfigKeys numericKeys(Scenario& scenario)
{
  return {key("time_step", scenario.time_step, timeStepRange()),
          key("gravity", scenario.gravity),
          key(
              "solver", [&scenario](const ConfigNode& node) { readSolver(node, scenario); }),
          key(
              "failure", [&scenario](const ConfigNode& node) { readFailure(node, scenario.failure); }),
          key("contact_law", scenario.contact_law,
              Choices<ContactLawForm>{{"gap", ContactLawForm::GAP}, {"velocity", ContactLawForm::VELOCITY}}),
          key("certify_every", scenario.certify_every, 0),
          key("certify_bound", scenario.certify_bound, notNegative()),
          key("broad_phase", scenario.broad_phase,
              Choices<BroadPhaseKind>{
                  {"auto", BroadPhaseKind::AUTO}, {"fcl", BroadPhaseKind::FCL}, {"list", BroadPhaseKind::LIST}})};
}

ConfigKeys surroundingKeys(Scenario& scenario)
{
  return {key(
              "materials", [&scenario](const ConfigNode& node) { readMaterials(node, scenario.materials); }),
          evenEmpty(key(
              "ground", [&scenario](const ConfigNode& node) { readGround(node, scenario.ground); }))};
}

}  // namespace frictional_contact_sim
