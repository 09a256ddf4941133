#include "linkage.h"

#include "frictional_contact_sim/model/kinematics.h"
#include "scene.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
using test_support::text;

std::string rodLink(const std::string& name, double length, double mass)
{
  const std::string across = text(mass * length * length / 12.0 + 1e-6 * mass);
  return "<link name='" + name + "'><inertial><origin xyz='" + text(0.5 * length) + " 0 0'/><mass value='" +
         text(mass) + "'/><inertia ixx='" + text(1e-4 * mass) + "' ixy='0' ixz='0' iyy='" + across + "' iyz='0' izz='" +
         across + "'/></inertial></link>";
}

std::string hinge(const std::string& name, const std::string& parent, const std::string& child, double x)
{
  return "<joint name='" + name + "' type='continuous'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='" + text(x) + " 0 0'/><axis xyz='0 1 0'/></joint>";
}

std::string fourBarUrdf(const FourBar& bar, const std::string& loop)
{
  const double density = bar.mass / bar.crank;
  return "<robot name='four_bar'><link name='frame'/>" + rodLink("crank", bar.crank, bar.mass) +
         rodLink("coupler", bar.coupler, density * bar.coupler) + rodLink("rocker", bar.rocker, density * bar.rocker) +
         hinge("drive", "frame", "crank", 0.0) + hinge("knee", "crank", "coupler", bar.crank) +
         hinge("pivot", "frame", "rocker", bar.ground) + loop + "</robot>";
}

std::string loopElement(const FourBar& bar, const std::string& type)
{
  return "<loop_joint name='closure' type='" + type + "'><parent link='rocker'/><child link='coupler'/><origin xyz='" +
         text(bar.rocker) + " 0 0'/><child_origin xyz='" + text(bar.coupler) + " 0 0'/>" +
         (type == "axis" ? "<axis xyz='0 1 0'/>" : "") + "</loop_joint>";
}

Scenario fourBarScene(const FourBar& bar, const std::string& type, double crank_angle)
{
  Scenario scenario = groundScene(0.5);
  scenario.ground.reset();
  BodySpec& body = addBody(scenario, "linkage", fourBarUrdf(bar, loopElement(bar, type)), poseAt(0.0, 0.0, 1.0));
  body.base = BaseType::FIXED;
  body.joints["drive"].position = crank_angle;
  return scenario;
}

double openness(const Simulator& simulator, const Closure& loop)
{
  const auto place = [&](int body, int frame, const Eigen::Isometry3d& local)
  {
    return Eigen::Vector3d(body < 0
                               ? local.translation()
                               : framePose(simulator.model(body), simulator.data(body), frame) * local.translation());
  };
  return (place(loop.body_a, loop.frame_a, loop.anchor) - place(loop.body_b, loop.frame_b, loop.pose)).norm();
}

double energyOf(const Simulator& simulator)
{
  return simulator.report().energy.kinetic + simulator.report().energy.potential;
}

}  // namespace frictional_contact_sim
