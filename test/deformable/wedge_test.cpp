// A wedge under a load: how rough the floor has to be, from both friction angles, and how steep it may be.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <vector>

#include "static_scene.h"

namespace frictional_contact_sim
{
namespace
{
/** A prism along y over a polygon in the x-z plane, as a mesh. */
std::string prism(const std::string& name, const std::vector<std::array<double, 2>>& polygon)
{
  const std::string file = testing::TempDir() + name + ".obj";
  std::ofstream out(file);
  out.precision(17);
  for (const double y : {-0.125, 0.125})
    for (const std::array<double, 2>& corner : polygon)
      out << "v " << corner[0] << ' ' << y << ' ' << corner[1] << '\n';
  const auto n = static_cast<int>(polygon.size());
  for (int k = 1; k + 1 < n; ++k)
    out << "f 1 " << k + 1 << ' ' << k + 2 << "\nf " << n + 1 << ' ' << n + k + 2 << ' ' << n + k + 1 << '\n';
  for (int k = 0; k < n; ++k)
  {
    const int next = (k + 1) % n;
    out << "f " << k + 1 << ' ' << n + k + 1 << ' ' << n + next + 1 << "\nf " << k + 1 << ' ' << n + next + 1 << ' '
        << next + 1 << '\n';
  }
  return "<mesh filename='file://" + file + "'/>";
}

/**
 * A wedge of slope tan(alpha) = rise on a rough floor; on it a block that a smooth wall holds from sliding down. At the
 * limit the block's weight W meets the slope at its friction angle phi_1, the floor is at phi_2: W tan(alpha - phi_1) =
 * (W + w) tan(phi_2),        w the wedge's weight Numbers are binary fractions: meshes are read in single precision,
 * and faces have to touch.
 */
Scenario wedge(double rise, double on_slope, double on_floor, double block_mass, double wedge_mass)
{
  Scenario scenario = statics(on_slope);
  scenario.ground = GroundSpec{};
  // The wedge reaches from x = -1, height 1/8, to x = 1; the block over [-1/4, 1/4], its top level.
  const auto height = [&](double x) { return 0.125 + (x + 1.0) * rise; };
  const double top = height(0.25) + 0.25;
  BodySpec lower =
      bodySpec("wedge", wedge_mass, prism("wedge", {{-1.0, 0.0}, {1.0, 0.0}, {1.0, height(1.0)}, {-1.0, 0.125}}),
               place(0.0, 0.0));
  lower.material = "wedge";
  scenario.bodies.push_back(lower);
  scenario.bodies.push_back(bodySpec(
      "block", block_mass, prism("block", {{-0.25, height(-0.25)}, {0.25, height(0.25)}, {0.25, top}, {-0.25, top}}),
      place(0.0, 0.0)));
  BodySpec wall = bodySpec("wall", 1.0, box(0.2, 1.0, 8.0), place(-0.35, height(-0.25) + 4.0625), BaseType::FIXED);
  wall.material = "smooth";
  scenario.bodies.push_back(wall);
  Material floor;
  floor.friction = on_floor;
  Material smooth;
  smooth.friction = 0.0;
  scenario.materials.pairs[{"ground", "wedge"}] = floor;
  scenario.materials.pairs[{"default", "smooth"}] = smooth;
  scenario.materials.pairs[{"smooth", "wedge"}] = smooth;
  return scenario;
}

TEST(WedgeTest, FloorHasToBeAsRoughAsBothFrictionAnglesSay)
{
  for (const double rise : {0.25, 0.5})
    for (const double on_slope : {0.0, 0.1, 0.2})
      for (const double wedge_mass : {0.01, 2.0})
      {
        const double exact = std::tan(std::atan(rise) - std::atan(on_slope)) * 5.0 / (5.0 + wedge_mass);
        const auto scene = [&](double on_floor) { return stands(wedge(rise, on_slope, on_floor, 5.0, wedge_mass)); };
        EXPECT_NEAR(threshold(0.5 * exact, 2.0 * exact, 2e-6, scene), exact, 1e-5)
            << rise << ' ' << on_slope << ' ' << wedge_mass;
      }
}

TEST(WedgeTest, LocksItselfWhereTheFrictionAngleIsHalfTheSlope)
{
  for (const double rise : {0.25, 0.5})
  {
    const auto scene = [&](double friction) { return stands(wedge(rise, friction, friction, 5.0, 1e-4)); };
    EXPECT_NEAR(threshold(0.0, 1.0, 2e-6, scene), std::tan(0.5 * std::atan(rise)), 2e-5) << rise;
  }
}

}  // namespace
}  // namespace frictional_contact_sim
