// Warnings about a scene before its first step: moments of inertia that are not those of the shape.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "frictional_contact_sim/simulation/world_model.h"
#include "scene.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;
using test_support::text;

std::vector<std::string> inertiaWarnings(const std::string& urdf)
{
  Scenario scene;
  addBody(scene, "body", urdf, poseAt(0.0, 0.0, 0.0)).base = BaseType::FLOATING;
  std::vector<std::string> found;
  const std::shared_ptr<const WorldModel> world = loadWorldModel(scene);
  for (const std::string& warning : world->warnings)
    if (warning.find("moments of inertia") != std::string::npos)
      found.push_back(warning);
  return found;
}

std::string linkOf(double mass, const Eigen::Vector3d& moments, const std::string& geometry,
                   const Eigen::Vector3d& at = Eigen::Vector3d::Zero())
{
  return "<robot name='r'><link name='part'><inertial><mass value='" + text(mass) + "'/><inertia ixx='" +
         text(moments.x()) + "' iyy='" + text(moments.y()) + "' izz='" + text(moments.z()) +
         "' ixy='0' ixz='0' iyz='0'/></inertial><collision><origin xyz='" + text(at) + "'/><geometry>" + geometry +
         "</geometry></collision></link></robot>";
}

TEST(StartCheckTest, MomentsAHundredTimesOffTheShapeAreNamed)
{
  for (std::uint32_t seed = 0; seed < 60; ++seed)
  {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const double mass = dice.logUniform(1e-3, 1e3);
    const Eigen::Vector3d size(dice.logUniform(0.01, 1.0), dice.logUniform(0.01, 1.0), dice.logUniform(0.01, 1.0));
    const Eigen::Vector3d square = size.cwiseAbs2();
    const Eigen::Vector3d right =
        mass / 12.0 * Eigen::Vector3d(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
    const double factor = dice.logUniform(1e-4, 1e4);
    const std::string urdf = linkOf(mass, factor * right, "<box size='" + text(size) + "'/>");
    if (std::abs(std::abs(std::log(factor)) - std::log(100.0)) < 0.01)
      continue;  // on the limit
    const bool is_plausible = factor > 0.01 && factor < 100.0;
    EXPECT_THAT(inertiaWarnings(urdf), testing::SizeIs(is_plausible ? 0 : 1));
  }
}

TEST(StartCheckTest, ALegWhoseOnlyShapeIsItsFootIsPlausible)
{
  // 0.2 m from the centre of mass to the foot of radius 0.01 m: the foot's own moments are 300 times smaller.
  EXPECT_THAT(inertiaWarnings(linkOf(0.5, {0.01, 0.01, 0.001}, "<sphere radius='0.01'/>", {0.0, 0.0, -0.2})),
              testing::IsEmpty());
  EXPECT_THAT(inertiaWarnings(linkOf(0.5, {10.0, 10.0, 1.0}, "<sphere radius='0.01'/>", {0.0, 0.0, -0.2})),
              testing::SizeIs(1));
}

TEST(StartCheckTest, BallOfTheFieldWithMomentsOfAMarbleIsNamed)
{
  // gz-sim#3211: 1 kg, radius 0.1 m, 7e-7 instead of 4e-3 kg m^2.
  EXPECT_THAT(inertiaWarnings(linkOf(1.0, Eigen::Vector3d::Constant(7e-7), "<sphere radius='0.1'/>")),
              testing::ElementsAre(testing::HasSubstr("0.012")));
}

}  // namespace
}  // namespace frictional_contact_sim
