// Mesh files and their convex hulls.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "collision_test_support.h"
#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
namespace fs = std::filesystem;

class MeshFileTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("collision_mesh_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const
  {
    const fs::path path = folder_ / name;
    std::ofstream(path) << text;
    return path.string();
  }

  /// Message of the ModelError that loading gives; empty when it gives none.
  static std::string errorOf(const std::string& path)
  {
    try
    {
      loadMeshHull(path, Eigen::Vector3d::Ones());
    }
    catch (const ModelError& error)
    {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

/// Box of half sizes as triangles, with a point inside each face and one in the middle of the body.
std::string boxObj(const Eigen::Vector3d& half)
{
  std::string text;
  for (const Eigen::Vector3d& v : boxPolyhedron(half).vertices)
  {
    text += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  }
  text += "v 0 0 " + std::to_string(half.z()) + "\nv 0 0 0\n";
  text += "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 9\nf 6 8 9\nf 8 7 9\nf 7 5 9\nf 1 2 10\n";
  return text;
}

std::string boxStl(const Eigen::Vector3d& half)
{
  const Polyhedron box = boxPolyhedron(half);
  std::string text = "solid box\n";
  for (const Polyhedron::Face& face : box.faces)
  {
    for (int k = 1; k + 1 < face.size; ++k)
    {
      text += "facet normal 0 0 0\nouter loop\n";
      for (int j : {0, k, k + 1})
      {
        const Eigen::Vector3d& v = box.vertices[box.face_vertices[face.first + j]];
        text += "vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
      }
      text += "endloop\nendfacet\n";
    }
  }
  return text + "endsolid box\n";
}

void expectBox(const Polyhedron& hull, const Eigen::Vector3d& half)
{
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.edges.size(), 12u);
  ASSERT_EQ(hull.faces.size(), 6u);
  for (const Polyhedron::Face& face : hull.faces)
  {
    EXPECT_EQ(face.size, 4);
    EXPECT_NEAR(face.offset, face.normal.cwiseAbs().dot(half), 1e-7);  // single precision in the file reader
  }
}

TEST_F(MeshFileTest, ObjBecomesAHullWithWholeFaces)
{
  const Eigen::Vector3d half(0.1, 0.2, 0.3);
  expectBox(loadMeshHull(write("box.obj", boxObj(half)), Eigen::Vector3d::Ones()), half);
}

TEST_F(MeshFileTest, StlIsScaledAxisByAxis)
{
  const Eigen::Vector3d half(0.1, 0.2, 0.3);
  const Eigen::Vector3d scale(1.0, -2.0, 0.5);
  expectBox(loadMeshHull(write("box.stl", boxStl(half)), scale), half.cwiseProduct(scale).cwiseAbs());
}

TEST_F(MeshFileTest, ColladaUnitAndNodesCountAndUpAxisDoesNot)
{
  const std::string dae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
 <library_geometries><geometry id="g"><mesh>
  <source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array>
   <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
   <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s"><node id="n"><translate>0 0 1000</translate>
  <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>)";
  const Polyhedron hull = loadMeshHull(write("tetrahedron.dae", dae), Eigen::Vector3d::Ones());
  ASSERT_EQ(hull.vertices.size(), 4u);
  EXPECT_NEAR((hull.center - Eigen::Vector3d(0.05, 0.1, 1.15)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((hull.half_extent - Eigen::Vector3d(0.05, 0.1, 0.15)).norm(), 0.0, 1e-6);
}

TEST_F(MeshFileTest, BadFilesAreNamedWithTheReason)
{
  const std::string missing = (folder_ / "missing.stl").string();
  EXPECT_NE(errorOf(missing).find(missing), std::string::npos);
  const std::string corrupt = write("corrupt.stl", "this is not a mesh");
  EXPECT_NE(errorOf(corrupt).find(corrupt), std::string::npos);
  const std::string unknown = write("shape.xyzw", "hello");
  EXPECT_NE(errorOf(unknown).find(unknown), std::string::npos);
  const std::string line = write("line.obj", "v 0 0 0\nv 1 0 0\nv 0.5 0 0\nv 2 0 0\nf 1 2 3\nf 2 4 3\n");
  EXPECT_NE(errorOf(line).find("on one line"), std::string::npos) << errorOf(line);
  const std::string point = write("point.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n");
  EXPECT_NE(errorOf(point).find("one point"), std::string::npos) << errorOf(point);
  const std::string infinite = write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
  EXPECT_FALSE(errorOf(infinite).empty());
}

TEST(ConvexHullTest, HoldsAllPointsAndIsClosed)
{
  std::mt19937 random(5);
  for (int k = 0; k < 20; ++k)
  {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 100; ++i)
    {
      points.push_back(randomVector(random) + Eigen::Vector3d(5.0, -3.0, 1.0));
    }
    const Polyhedron hull = convexHull(points);
    // Euler: V - E + F = 2
    EXPECT_EQ(static_cast<int>(hull.vertices.size() + hull.faces.size()) - static_cast<int>(hull.edges.size()), 2);
    for (const Polyhedron::Face& face : hull.faces)
    {
      for (const Eigen::Vector3d& point : points)
      {
        EXPECT_LT(face.normal.dot(point) - face.offset, 4e-6);  // tolerance of the merging of faces: 2e-6 of the size
      }
    }
  }
}

TEST(PublishedMeshTest, AllConvexHullsOfTheRobotsAreClosed)
{
  const fs::path robots = fs::path(PROJECT_DIR) / "../shared/robots";
  if (!fs::exists(robots))
  {
    std::printf("skipped: no %s\n", robots.c_str());
    return;
  }
  int count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(robots))
  {
    if (entry.path().extension() == ".stl" || entry.path().extension() == ".dae")
    {
      const Polyhedron hull = loadMeshHull(entry.path().string(), Eigen::Vector3d::Ones());
      EXPECT_EQ(static_cast<int>(hull.vertices.size() + hull.faces.size()) - static_cast<int>(hull.edges.size()), 2)
          << entry.path();
      ++count;
    }
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace frictional_contact_sim
