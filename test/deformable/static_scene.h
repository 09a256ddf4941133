#pragma once
// Scenes of rigid bodies for the tests of statics: shapes as URDF text, whether a scene stands, and where it begins to.
#include <Eigen/Geometry>
#include <functional>
#include <string>

#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
/** All digits. */
std::string number(double value);

/** A body of one link. @param geometry element of URDF */
std::string urdf(const std::string& name, double mass, const std::string& geometry);
std::string box(double x, double y, double z);
BodySpec bodySpec(const std::string& name, double mass, const std::string& geometry, const Eigen::Isometry3d& pose,
                  BaseType base = BaseType::FLOATING);
/** In the x-z plane, turned about y [rad]. */
Eigen::Isometry3d place(double x, double z, double angle_y = 0.0);

/** `static: true` with one friction coefficient everywhere, no body. */
Scenario statics(double friction);

/** Whether the scene stands; where not, that it is proven. */
bool stands(const Scenario& scenario);

/** Where `stands_at` turns from false below to true above. */
double threshold(double below, double above, double width, const std::function<bool(double)>& stands_at);

}  // namespace frictional_contact_sim
