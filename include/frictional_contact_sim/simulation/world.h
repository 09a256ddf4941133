#pragma once
/**
 * @file world.h
 * @brief A scenario's robots and shapes, loaded and in their initial state.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/dynamics/robot.h"
#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
struct World
{
  std::vector<Robot> robots;  ///< `end` holds poses, velocities and mass matrix at the initial state
  CollisionWorld collision;
  PairTable pairs;
  std::vector<std::string> warnings;
};

/** @throws ModelError, std::invalid_argument with one line that names the body and what is wrong */
World loadWorld(const Scenario& scenario);

/** @brief Checks a command and fills its gains. @throws std::invalid_argument naming the joint and the number */
Actuator makeActuator(const Robot& robot, int joint, const JointCommand& command);

/** @brief Poses, velocities and mass matrix of `robot.end` at (q, v). */
void updateEnd(Robot& robot);

}  // namespace frictional_contact_sim
