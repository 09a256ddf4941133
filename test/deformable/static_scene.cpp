#include "static_scene.h"

#include <gtest/gtest.h>

#include <sstream>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
std::string number(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string urdf(const std::string& name, double mass, const std::string& geometry)
{
  return "<robot name='" + name + "'><link name='" + name + "'><inertial><mass value='" + number(mass) +
         "'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial><collision><geometry>" +
         geometry + "</geometry></collision></link></robot>";
}

std::string box(double x, double y, double z)
{
  return "<box size='" + number(x) + ' ' + number(y) + ' ' + number(z) + "'/>";
}

BodySpec bodySpec(const std::string& name, double mass, const std::string& geometry, const Eigen::Isometry3d& pose,
                  BaseType base)
{
  BodySpec body;
  body.name = name;
  body.urdf_xml = urdf(name, mass, geometry);
  body.pose = pose;
  body.base = base;
  return body;
}

Eigen::Isometry3d place(double x, double z, double angle_y)
{
  Eigen::Isometry3d pose(Eigen::AngleAxisd(angle_y, Eigen::Vector3d::UnitY()));
  pose.translation() = Eigen::Vector3d(x, 0.0, z);
  return pose;
}

Scenario statics(double friction)
{
  Scenario scenario;
  scenario.regime = Regime::STATIC;
  scenario.materials.fallback.friction = friction;
  return scenario;
}

bool stands(const Scenario& scenario)
{
  Simulator simulator(scenario);
  const StepOutcome& outcome = simulator.step();
  if (!outcome.converged())
    EXPECT_NE(outcome.message.find("no equilibrium exists"), std::string::npos) << outcome.message;
  else
    for (int body = 0; body < simulator.bodyCount(); ++body)
      EXPECT_TRUE(simulator.velocity(body).isZero(0.0));
  return outcome.converged();
}

double threshold(double below, double above, double width, const std::function<bool(double)>& stands_at)
{
  EXPECT_FALSE(stands_at(below));
  EXPECT_TRUE(stands_at(above));
  while (above - below > width)
  {
    const double middle = 0.5 * (below + above);
    (stands_at(middle) ? above : below) = middle;
  }
  return 0.5 * (below + above);
}

}  // namespace frictional_contact_sim
