// Meshes as users have them (../shared/field): a smooth ball, a floor of two triangles, a tray of three objects, two
// shapes in one geometry; every step audited. Right values are those of the cases' READMEs.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/audited_simulator.h"
#include "support/random_mesh.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
namespace fs = std::filesystem;

class FieldMeshTest : public testing::Test
{
protected:
  static std::string field(const std::string& file) { return std::string(PROJECT_DIR) + "/../shared/field/" + file; }

  /// False, with a word, where the cases are not there.
  static bool has(const std::string& file)
  {
    const bool is_there = fs::exists(field(file));
    if (!is_there)
      std::printf("skipped: no %s\n", field(file).c_str());
    return is_there;
  }

  /// The simulator at the end of the case, each step converged.
  static std::unique_ptr<AuditedSimulator> run(const Scenario& scenario, double duration)
  {
    auto simulator = std::make_unique<AuditedSimulator>(scenario);
    while (simulator->time() < duration)
      simulator->step();
    return simulator;
  }
  static std::unique_ptr<AuditedSimulator> run(const std::string& file)
  {
    const Scenario scenario = loadScenarioFile(field(file));
    return run(scenario, scenario.duration);
  }

  static size_t warningsWith(const Simulator& simulator, const std::string& text)
  {
    const std::vector<std::string>& warnings = simulator.warnings();
    return static_cast<size_t>(std::count_if(warnings.begin(), warnings.end(),
                                             [&](const std::string& warning)
                                             { return warning.find(text) != std::string::npos; }));
  }
};

TEST_F(FieldMeshTest, SmoothBallsKeepTheirSize)
{
  for (const std::string file : {"dense_mesh/ball4200.yaml", "dense_mesh/ball5000.yaml"})
  {
    if (!has(file))
      return;
    SCOPED_TRACE(file);
    const auto simulator = run(file);
    EXPECT_NEAR(simulator->position(0)[2], 0.1, 1e-4);  // the lowest of its points, not the sphere, is on the ground
    EXPECT_EQ(warningsWith(*simulator, "mesh"), 0u);
  }
}

TEST_F(FieldMeshTest, CubeRestsOnAFloorOfTwoTriangles)
{
  if (!has("flat_mesh/floor.yaml"))
    return;
  const auto simulator = run("flat_mesh/floor.yaml");
  EXPECT_NEAR(simulator->position(1)[2], 0.05, 1e-9);
  EXPECT_LT(simulator->velocity(1).norm(), 1e-6);
}

TEST_F(FieldMeshTest, FlatStickerNeverMatters)
{
  if (!has("flat_mesh/tagged.yaml"))
    return;
  const auto simulator = run("flat_mesh/tagged.yaml");
  EXPECT_NEAR(simulator->position(0)[2], 0.05, 1e-9);
  EXPECT_LT(simulator->velocity(0).norm(), 1e-6);
}

TEST_F(FieldMeshTest, BallRestsBetweenTheWallsOfATrayOfThreeObjects)
{
  if (!has("concave_mesh/tray.yaml"))
    return;
  const auto simulator = run("concave_mesh/tray.yaml");
  EXPECT_NEAR(simulator->position(1)[2], 0.03, 1e-7);  // floor at 0.01 in single precision, radius 0.02
  EXPECT_EQ(warningsWith(*simulator, "mesh"), 0u) << "each of its objects is convex";
}

TEST_F(FieldMeshTest, ShapeThatIsNotUsedIsNamed)
{
  if (!has("two_shapes_in_geometry/two.yaml"))
    return;
  const auto simulator = run("two_shapes_in_geometry/two.yaml");
  EXPECT_NEAR(simulator->position(0)[2], 0.1, 1e-9);  // the box, which comes first
  EXPECT_EQ(warningsWith(*simulator, "a second shape <sphere> in <geometry> is not used (at link 'base_link')"), 1u);
}

/// Meshes written here, in a folder of the process.
class WrittenMeshTest : public FieldMeshTest
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("mesh_field_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  /// One link with the geometry given, mass 1 kg, as large as a ball of 0.1 m.
  Scenario scenarioOf(const std::string& geometry, double height) const
  {
    write("body.urdf",
          "<robot name=\"body\"><link name=\"part\"><inertial><mass value=\"1\"/><inertia ixx=\"0.004\" "
          "ixy=\"0\" ixz=\"0\" iyy=\"0.004\" iyz=\"0\" izz=\"0.004\"/></inertial><collision><geometry>" +
              geometry + "</geometry></collision></link></robot>");
    Scenario scenario;
    scenario.ground.emplace();
    scenario.bodies.emplace_back();
    scenario.bodies.back().name = "body";
    scenario.bodies.back().urdf_path = (folder_ / "body.urdf").string();
    scenario.bodies.back().base = BaseType::FLOATING;
    scenario.bodies.back().pose = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, height));
    return scenario;
  }

  fs::path folder_;
};

/// Square of half size 0.1 in the plane z = 0.
const char* const SQUARE = "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n";

TEST_F(WrittenMeshTest, FlatPolygonFallsFlatOnTheGround)
{
  write("square.obj", SQUARE);
  const auto simulator = run(scenarioOf("<mesh filename=\"square.obj\"/>", 0.01), 0.3);
  EXPECT_NEAR(simulator->position(0)[2], 0.0, 1e-9);
  EXPECT_EQ(simulator->contacts().size(), 4u);
}

TEST_F(WrittenMeshTest, FlatPolygonRestsOnABox)
{
  write("square.obj", SQUARE);
  Scenario scenario = scenarioOf("<mesh filename=\"square.obj\"/>", 0.21);
  write("box.urdf",
        "<robot name=\"box\"><link name=\"box\"><collision><geometry><box size=\"0.5 0.5 "
        "0.2\"/></geometry></collision></link></robot>");
  scenario.ground.reset();
  scenario.bodies.emplace_back();
  scenario.bodies.back().name = "box";
  scenario.bodies.back().urdf_path = (folder_ / "box.urdf").string();
  scenario.bodies.back().base = BaseType::FIXED;
  scenario.bodies.back().pose = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.1));
  const auto simulator = run(scenario, 0.3);
  EXPECT_NEAR(simulator->position(0)[2], 0.2, 1e-9);
  EXPECT_LT(simulator->velocity(0).norm(), 1e-6);
}

TEST_F(WrittenMeshTest, BodyOnPointsOfNoRadiusRestsOnThem)
{
  std::string collisions;
  for (const char* at : {"0.1 0.1", "0.1 -0.1", "-0.1 0.1", "-0.1 -0.1"})
    collisions += std::string(collisions.empty() ? "" : "<collision>") + "<origin xyz=\"" + at +
                  " -0.2\"/><geometry><sphere radius=\"0\"/></geometry></collision>";
  write("points.urdf",
        "<robot name=\"p\"><link name=\"p\"><inertial><mass value=\"1\"/><inertia ixx=\"0.004\" ixy=\"0\" ixz=\"0\" "
        "iyy=\"0.004\" iyz=\"0\" izz=\"0.004\"/></inertial><collision>" +
            collisions + "</link></robot>");
  Scenario scenario = scenarioOf("<box size=\"1 1 1\"/>", 0.21);
  scenario.bodies.back().urdf_path = (folder_ / "points.urdf").string();
  const auto on_ground = run(scenario, 0.2);
  EXPECT_NEAR(on_ground->position(0)[2], 0.2, 1e-9);
  EXPECT_EQ(on_ground->contacts().size(), 4u);
}

TEST_F(WrittenMeshTest, MeshThatIsNotConvexIsNamedWithWhatItsHullAdds)
{
  test_support::Dice dice(3);
  test_support::writeStl(test_support::makeRandomMesh(test_support::MeshKind::TORUS, 0.1, dice),
                         (folder_ / "ring.stl").string());
  const Simulator simulator(scenarioOf("<mesh filename=\"ring.stl\"/>", 0.2));
  ASSERT_EQ(warningsWith(simulator, "link 'part': collision mesh " + (folder_ / "ring.stl").string()), 1u);
  EXPECT_EQ(warningsWith(simulator, "used instead, adds"), 1u);
}

TEST_F(WrittenMeshTest, MeshThatIsNoShapeIsNamedWithUrdfLinkAndFile)
{
  write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  try
  {
    const Simulator simulator(scenarioOf("<mesh filename=\"line.obj\"/>", 0.2));
    FAIL() << "loaded";
  }
  catch (const std::exception& error)
  {
    const std::string message = error.what();
    for (const char* name : {"body.urdf", "link 'part'", "line.obj", "on one line"})
      EXPECT_NE(message.find(name), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace frictional_contact_sim
