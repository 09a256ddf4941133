// Mesh files with several objects: one convex part for each, whatever their materials; and what the hulls add.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "collision_test_support.h"
#include "support/random_mesh.h"

namespace frictional_contact_sim
{
namespace
{
namespace fs = std::filesystem;
using test_support::RandomMesh;

class MeshPartsTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("mesh_parts_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const
  {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }

  fs::path folder_;
};

const Eigen::Vector3d ONES = Eigen::Vector3d::Ones();

/// Box around a point as an object of an OBJ, vertices from `first` on; with a material for each of its last two sides.
std::string boxObject(const std::string& name, const Eigen::Vector3d& center, const Eigen::Vector3d& half, int first)
{
  std::string text = "o " + name + "\n";
  for (const Eigen::Vector3d& v : boxPolyhedron(half).vertices)
  {
    const Eigen::Vector3d point = center + v;
    text += "v " + std::to_string(point.x()) + " " + std::to_string(point.y()) + " " + std::to_string(point.z()) + "\n";
  }
  for (const char* face : {"0 4 6 2", "1 3 7 5", "0 1 5 4", "2 6 7 3", "usemtl red\n0 2 3 1", "usemtl blue\n4 5 7 6"})
  {
    std::string side = face;
    const size_t line = side.find('\n');
    text += line == std::string::npos ? "" : side.substr(0, line + 1);
    side = line == std::string::npos ? side : side.substr(line + 1);
    text += "f";
    for (const char corner : side)
      if (corner != ' ')
        text += " " + std::to_string(first + corner - '0');
    text += "\n";
  }
  return text;
}

TEST_F(MeshPartsTest, ObjectsOfAnObjArePartsAndMaterialsAreNot)
{
  const std::string path = write(
      "two.obj", boxObject("left", {-1, 0, 0}, {0.1, 0.2, 0.3}, 1) + boxObject("right", {1, 0, 0}, {0.3, 0.2, 0.1}, 9));
  std::string addition;
  const std::vector<Polyhedron> hulls = loadMeshHulls(path, ONES, addition);
  ASSERT_EQ(hulls.size(), 2u);
  EXPECT_NEAR((hulls[0].center - Eigen::Vector3d(-1, 0, 0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((hulls[1].half_extent - Eigen::Vector3d(0.3, 0.2, 0.1)).norm(), 0.0, 1e-6);
  for (const Polyhedron& hull : hulls)
    EXPECT_EQ(hull.faces.size(), 6u);
  EXPECT_EQ(addition, "");
}

TEST_F(MeshPartsTest, PartWithinAnotherOneIsLeftOut)
{
  const std::string path = write("nested.obj", boxObject("inner", {0, 0, 0}, {0.1, 0.1, 0.1}, 1) +
                                                   boxObject("outer", {0, 0, 0}, {0.2, 0.2, 0.2}, 9) +
                                                   boxObject("same", {0, 0, 0}, {0.2, 0.2, 0.2}, 17));
  std::string addition;
  const std::vector<Polyhedron> hulls = loadMeshHulls(path, ONES, addition);
  ASSERT_EQ(hulls.size(), 1u);
  EXPECT_NEAR(hulls[0].half_extent.x(), 0.2, 1e-6);
}

TEST_F(MeshPartsTest, PiecesOfOneSurfaceAreOnePart)
{
  std::string text = boxObject("box", {0, 0, 0}, {0.1, 0.2, 0.3}, 1);
  for (size_t place = text.find("\nf "); place != std::string::npos; place = text.find("\nf ", place + 1))
  {
    const std::string object = "\no side" + std::to_string(place);
    text.insert(place, object);
    place += object.size();
  }
  std::string addition;
  const std::vector<Polyhedron> hulls = loadMeshHulls(write("sides.obj", text), ONES, addition);
  ASSERT_EQ(hulls.size(), 1u);
  EXPECT_EQ(hulls[0].faces.size(), 6u);
  EXPECT_EQ(addition, "");
}

TEST_F(MeshPartsTest, PartsHaveHandlesThatShareTheirShapeAndNeverCollideWithEachOther)
{
  // two boxes that overlap, on a body above the ground and on another one
  const std::string path = write("l.obj", boxObject("foot", {0.1, 0, 0.05}, {0.2, 0.1, 0.05}, 1) +
                                              boxObject("leg", {0, 0, 0.3}, {0.05, 0.05, 0.3}, 9));
  CollisionWorld world;
  const int ground = world.addStatic(HalfSpace(), Eigen::Isometry3d::Identity(), "ground");
  const int a = world.addBody(freeBody({Sphere{0.01}, Mesh{path, ONES}}));
  world.addBody(freeBody({Mesh{path, ONES}}));
  ASSERT_EQ(world.shapeCount(), 6);
  EXPECT_EQ(world.shape(2).index, 1);
  EXPECT_EQ(world.shape(3).index, 1);
  EXPECT_EQ(world.shape(2).name, world.shape(3).name);
  EXPECT_EQ(world.shape(4).body, 1);
  world.setLinkPose(0, 0, at(0, 0, 0));
  world.setLinkPose(1, 0, at(5, 0, 0));
  EXPECT_TRUE(world.disableOverlaps().empty());
  for (const ContactPoint& contact : world.detect(1e-3))
  {
    EXPECT_EQ(contact.shape_b, ground);
    EXPECT_NE(contact.shape_a, contact.shape_b);
  }
  const std::vector<double> reach = world.meshReach(a);
  ASSERT_EQ(reach.size(), 2u);
  EXPECT_EQ(reach[0], 0.0);
  EXPECT_NEAR(reach[1], Eigen::Vector3d(0.05, 0.05, 0.6).norm(), 1e-6);
}

TEST_F(MeshPartsTest, RandomMeshesComeBackFromFilesPartByPart)
{
  for (std::uint32_t seed = 0; seed < 30; ++seed)
  {
    const RandomMesh mesh = test_support::makeRandomMesh(seed);
    SCOPED_TRACE(mesh.name);
    const std::string stl = (folder_ / "mesh.stl").string();
    test_support::writeStl(mesh, stl);
    std::string addition;
    const std::vector<Polyhedron> hulls = loadMeshHulls(stl, ONES, addition);
    ASSERT_EQ(hulls.size(), 1u);
    // coordinates up to 2 sizes, in single precision, and what welding and merging leave out
    EXPECT_NEAR(hulls[0].size, mesh.size, 3e-6 * mesh.size);
    if (mesh.is_convex)
    {
      EXPECT_EQ(addition, "");
    }
    else if (mesh.kind == test_support::MeshKind::TORUS)
    {
      EXPECT_NE(addition.find("not convex"), std::string::npos);
    }
  }
  std::vector<RandomMesh> meshes;
  test_support::Dice dice(5);
  for (int k = 0; k < 5; ++k)
  {
    meshes.push_back(test_support::makeRandomMesh(test_support::MeshKind::FILLETED_PLATE, 0.1, dice));
    for (Eigen::Vector3d& vertex : meshes.back().vertices)
      vertex.x() += k;
  }
  const std::string obj = (folder_ / "plates.obj").string();
  test_support::writeObj(meshes, obj);
  std::string addition;
  const std::vector<Polyhedron> hulls = loadMeshHulls(obj, ONES, addition);
  ASSERT_EQ(hulls.size(), meshes.size());
  for (size_t k = 0; k < hulls.size(); ++k)
    EXPECT_NEAR(hulls[k].size, meshes[k].size, 1e-5 * meshes[k].size);
  EXPECT_EQ(addition, "");
}

}  // namespace
}  // namespace frictional_contact_sim
