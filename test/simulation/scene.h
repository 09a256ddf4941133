#pragma once
// Small scenes for the physics tests: primitives as URDF text, so that every test states its own numbers.
#include <Eigen/Geometry>
#include <string>

#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
/** A free body with one collision shape at its centre. */
std::string boxUrdf(const Eigen::Vector3d& size, double mass);
std::string sphereUrdf(double radius, double mass);
std::string cylinderUrdf(double radius, double length, double mass);  ///< axis z

/** Root pose at xyz, upright. */
Eigen::Isometry3d poseAt(double x, double y, double z);

/** Empty scenario with ground, one friction and restitution everywhere, solver tolerance 1e-13. */
Scenario groundScene(double friction, double restitution = 0.0);

/** The same without ground and gravity. */
Scenario emptySpace();

/** A slider of 2 kg along x on a fixed base: joint `rail`, limits +-reach [m] and +-speed [m/s], effort 1000 N. */
Scenario railScene(double reach, double speed);

/** Adds a free body and returns it for further settings. */
BodySpec& addBody(Scenario& scenario, const std::string& name, const std::string& urdf, const Eigen::Isometry3d& pose);

/** Gravity turned by `angle` about y, so that the level ground is an incline that descends along +x. */
void incline(Scenario& scenario, double angle);

constexpr double GRAVITY = 9.81;  ///< [m/s^2]

}  // namespace frictional_contact_sim
