#pragma once
/**
 * @file scenario_keys.h
 * @brief The keys of a scenario as tables, which scenario files and the parameters of the node share: a key that is
 * added here works in both.
 */
#include "frictional_contact_sim/config/config_node.h"
#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
/** @brief How it is computed: time_step, gravity, solver, failure, contact_law, certify_every, broad_phase. */
ConfigKeys numericKeys(Scenario& scenario);
/** @brief What bodies meet: materials, ground. */
ConfigKeys surroundingKeys(Scenario& scenario);
/** @brief A body but for its name, its URDF and the materials of its links. */
ConfigKeys bodyKeys(BodySpec& body);

// Single values of them that have a key of their own elsewhere.
ConfigKey solverOptionsKey(const std::string& name, Scenario& scenario);
ConfigKey toleranceKey(StoppingOptions& stopping);
ConfigKey maxIterationsKey(StoppingOptions& stopping);
ConfigKey failurePolicyKey(const std::string& name, FailureOptions& failure);
ConfigKey frictionKey(const std::string& name, double& friction);
ConfigKey restitutionKey(const std::string& name, double& restitution);
ConfigKey poseKey(const std::string& name, BodySpec& body);
ConfigKey linkMaterialsKey(const std::string& name, BodySpec& body);

/** @brief {xyz, rpy} or [x, y, z, roll, pitch, yaw]; URDF's convention: about fixed axes. @throws ConfigError */
Eigen::Isometry3d readPose(const ConfigNode& node);

/** @brief Path of the file that a value names, relative to the document's folder. @throws ConfigError */
std::string resolveFile(const ConfigNode& node);

/**
 * @brief The scenario's method takes the scenario's options.
 * @param place of the options, for messages. @throws ConfigError in one line
 */
void checkSolver(const ConfigNode& place, const Scenario& scenario);

/** @brief The body's materials are in the table: by name, as a side of a pair, or `default`.
 *  @param body where its keys are. @param links key of linkMaterialsKey. @throws ConfigError with the nearest name */
void checkMaterials(const ConfigNode& body, const std::string& links, const BodySpec& spec,
                    const MaterialTable& materials);

}  // namespace frictional_contact_sim
