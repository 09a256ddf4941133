#include "scene.h"

#include <cmath>
#include <sstream>

namespace frictional_contact_sim
{
namespace
{
std::string bodyUrdf(const std::string& geometry, double mass, const Eigen::Vector3d& inertia)
{
  std::ostringstream text;
  text.precision(17);
  text << "<robot name='body'><link name='body'><inertial><mass value='" << mass << "'/><inertia ixx='" << inertia.x()
       << "' ixy='0' ixz='0' iyy='" << inertia.y() << "' iyz='0' izz='" << inertia.z()
       << "'/></inertial><collision><geometry>" << geometry << "</geometry></collision></link></robot>";
  return text.str();
}

std::string number(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}
}  // namespace

std::string boxUrdf(const Eigen::Vector3d& size, double mass)
{
  const Eigen::Vector3d square = size.cwiseAbs2();
  const Eigen::Vector3d inertia =
      mass / 12.0 * Eigen::Vector3d(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
  return bodyUrdf("<box size='" + number(size.x()) + " " + number(size.y()) + " " + number(size.z()) + "'/>", mass,
                  inertia);
}

std::string sphereUrdf(double radius, double mass)
{
  return bodyUrdf("<sphere radius='" + number(radius) + "'/>", mass,
                  Eigen::Vector3d::Constant(0.4 * mass * radius * radius));
}

std::string cylinderUrdf(double radius, double length, double mass)
{
  const double axial = 0.5 * mass * radius * radius;
  const double transverse = mass * (3.0 * radius * radius + length * length) / 12.0;
  return bodyUrdf("<cylinder radius='" + number(radius) + "' length='" + number(length) + "'/>", mass,
                  {transverse, transverse, axial});
}

Eigen::Isometry3d poseAt(double x, double y, double z)
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

Scenario groundScene(double friction, double restitution)
{
  Scenario scenario;
  scenario.ground = GroundSpec{};
  scenario.materials.fallback = {friction, restitution};
  scenario.stopping.tolerance = 1e-13;
  return scenario;
}

BodySpec& addBody(Scenario& scenario, const std::string& name, const std::string& urdf, const Eigen::Isometry3d& pose)
{
  BodySpec body;
  body.name = name;
  body.urdf_xml = urdf;
  body.base = BaseType::FLOATING;
  body.pose = pose;
  scenario.bodies.push_back(body);
  return scenario.bodies.back();
}

void incline(Scenario& scenario, double angle)
{
  scenario.gravity = GRAVITY * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
}

Scenario emptySpace()
{
  Scenario scenario = groundScene(0.5);
  scenario.ground.reset();
  scenario.gravity.setZero();
  return scenario;
}

Scenario railScene(double reach, double speed)
{
  std::ostringstream urdf;
  urdf << "<robot name='slider'><link name='world'/><link name='carriage'><inertial><mass value='2'/>"
          "<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>"
          "<joint name='rail' type='prismatic'><parent link='world'/><child link='carriage'/><axis xyz='1 0 0'/>"
       << "<limit lower='" << -reach << "' upper='" << reach << "' effort='1000' velocity='" << speed
       << "'/></joint></robot>";
  Scenario scene;
  BodySpec body;
  body.name = "slider";
  body.urdf_xml = urdf.str();
  scene.bodies.push_back(body);
  scene.stopping.tolerance = 1e-13;
  return scene;
}

}  // namespace frictional_contact_sim
