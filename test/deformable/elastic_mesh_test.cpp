// Meshes and matrices of linear elasticity against closed forms that share nothing with the assembly.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <tuple>

#include "frictional_contact_sim/deformable/elastic_mesh.h"
#include "frictional_contact_sim/model/model_error.h"
#include "support/market_file.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.141592653589793;

ElasticMaterial material(PlaneModel plane = PlaneModel::STRAIN)
{
  ElasticMaterial some;
  some.young_modulus = 2.5e6;
  some.poisson_ratio = 0.3;
  some.density = 1200.0;
  some.plane = plane;
  some.thickness = 0.2;
  return some;
}

/** A built-in box whose inner nodes and shape are disturbed: cells of many shapes. */
ElasticMesh disturbed(int dimension, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.015, 0.015);
  ElasticMesh mesh = dimension == 2 ? boxMesh({0.3, 0.2}, {4, 3}) : boxMesh({0.3, 0.2, 0.2}, {4, 3, 3});
  for (Eigen::Vector3d& node : mesh.nodes)
    for (const int axis : axesOf(dimension))
      node[axis] += shift(random);
  closeMesh(mesh);
  return mesh;
}

/** u = G x at every node, in the rows of the matrices. */
Eigen::VectorXd linearField(const ElasticMesh& mesh, const Eigen::Matrix3d& gradient)
{
  const std::vector<int>& axes = axesOf(mesh.dimension);
  Eigen::VectorXd u(mesh.nodes.size() * axes.size());
  Eigen::Index row = 0;
  for (const Eigen::Vector3d& node : mesh.nodes)
    for (const int axis : axes)
      u[row++] = gradient.row(axis).dot(node);
  return u;
}

/** Volume by the divergence theorem: sum over facets of n . x / d. */
double enclosedVolume(const ElasticMesh& mesh)
{
  double volume = 0.0;
  for (const std::array<int, 3>& facet : mesh.facets)
  {
    const Eigen::Vector3d& a = mesh.nodes[facet[0]];
    const Eigen::Vector3d edge = mesh.nodes[facet[1]] - a;
    if (mesh.dimension == 2)
      volume += edge.cross(Eigen::Vector3d::UnitY()).dot(a) / 2.0;
    else
      volume += edge.cross(mesh.nodes[facet[2]] - a).dot(a) / 6.0;
  }
  return volume;
}

/** Strain energy of a uniform gradient from the stress tensor, per volume; plane stress lets y go. */
double energyDensity(const Eigen::Matrix3d& gradient, const ElasticMaterial& m, bool is_plane_stress)
{
  Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  if (is_plane_stress)
    strain(1, 1) = -m.poisson_ratio / (1.0 - m.poisson_ratio) * (strain(0, 0) + strain(2, 2));
  const double factor = m.young_modulus / (1.0 + m.poisson_ratio);
  const Eigen::Matrix3d stress = factor * (strain + m.poisson_ratio / (1.0 - 2.0 * m.poisson_ratio) * strain.trace() *
                                                        Eigen::Matrix3d::Identity());
  return 0.5 * stress.cwiseProduct(strain).sum();
}

class PatchTest : public testing::TestWithParam<std::tuple<int, PlaneModel>>
{
};

TEST_P(PatchTest, UniformStrainIsExactOnAnyMesh)
{
  const auto [dimension, plane] = GetParam();
  for (unsigned seed = 1; seed <= 5; ++seed)
  {
    const ElasticMesh mesh = disturbed(dimension, seed);
    const ElasticMaterial m = material(plane);
    const ElasticParts parts = assembleElastic(mesh, m);
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss;
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (const int i : axesOf(dimension))
      for (const int j : axesOf(dimension))
        gradient(i, j) = gauss(random);
    const Eigen::VectorXd u = linearField(mesh, gradient);
    const double volume = (dimension == 2 ? m.thickness : 1.0) * enclosedVolume(mesh);
    const bool is_stress = dimension == 2 && plane == PlaneModel::STRESS;
    const double energy = energyDensity(gradient, m, is_stress) * volume;
    EXPECT_NEAR(0.5 * u.dot(parts.stiffness * u), energy, 1e-11 * energy);
    // No force on nodes inside.
    const Eigen::VectorXd force = parts.stiffness * u;
    double inner = 0.0;
    for (size_t node = 0; node < mesh.nodes.size(); ++node)
      if (!std::binary_search(parts.surface.begin(), parts.surface.end(), static_cast<int>(node)))
        inner = std::max(inner, force.segment(static_cast<Eigen::Index>(node) * dimension, dimension).norm());
    EXPECT_LT(inner, 1e-10 * force.norm());
    // Infinitesimal rigid motions cost nothing; the mass is the volume's.
    Eigen::Matrix3d turn = gradient - gradient.transpose();
    const Eigen::VectorXd rigid = linearField(mesh, turn);
    EXPECT_LT((parts.stiffness * rigid).norm(), 1e-10 * parts.stiffness.norm() * rigid.norm());
    Eigen::VectorXd translation = Eigen::VectorXd::Zero(u.size());
    for (Eigen::Index row = 0; row < u.size(); row += dimension)
      translation[row] = 1.0;
    EXPECT_NEAR(translation.dot(parts.mass * translation), m.density * volume, 1e-11 * m.density * volume);
  }
}

INSTANTIATE_TEST_SUITE_P(Solids, PatchTest,
                         testing::Values(std::make_tuple(2, PlaneModel::STRAIN), std::make_tuple(2, PlaneModel::STRESS),
                                         std::make_tuple(3, PlaneModel::STRAIN)));

/** Eigenfrequencies [rad/s], ascending. */
Eigen::VectorXd frequencies(const ElasticParts& parts)
{
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(parts.stiffness),
                                                                         Eigen::MatrixXd(parts.mass));
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

TEST(BarTest, EigenfrequenciesOfAFreeBarAreOfOrderTwo)
{
  // omega_n = n pi c/L; linear elements: relative error (n pi/(2 cells))^2/6 to leading order, from above.
  ElasticMaterial m = material();
  const double length = 0.7;
  const double c = std::sqrt(m.young_modulus / m.density);
  for (int n = 1; n <= 3; ++n)
  {
    double error[2];
    for (int k = 0; k < 2; ++k)
      error[k] = frequencies(assembleElastic(barMesh(length, 20 << k), m))[n] / (n * PI * c / length) - 1.0;
    EXPECT_GT(error[1], 0.0);
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.05);
  }
}

TEST(PlateTest, ShearedStripVibratesInThicknessShear)
{
  // A strip of one cell in x, both its sides bound to move alike in x (shear of an infinite layer), ends z free:
  // omega = pi c_s/H, c_s = sqrt(mu/rho). Projection on equal columns makes it one-dimensional.
  const ElasticMaterial m = material();
  const int cells = 16;
  const double height = 0.2;
  const ElasticMesh mesh = boxMesh({height / cells, height}, {1, cells});
  const ElasticParts parts = assembleElastic(mesh, m);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(parts.mass.rows(), cells + 1);
  for (int k = 0; k <= cells; ++k)
    for (int i = 0; i < 2; ++i)
      basis(2 * (2 * k + i), k) = 1.0;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(basis.transpose() * parts.stiffness * basis,
                                                                         basis.transpose() * parts.mass * basis);
  const double mu = 0.5 * m.young_modulus / (1.0 + m.poisson_ratio);
  const double exact = PI * std::sqrt(mu / m.density) / height;
  const double error = std::sqrt(solver.eigenvalues()[1]) / exact - 1.0;
  EXPECT_GT(error, 0.0);
  EXPECT_LT(error, 0.5 * std::pow(PI / cells, 2));  // order two in the mesh
}

TEST(FacetTest, BoundariesAreClosedAndLookOutwards)
{
  for (const int dimension : {2, 3})
    for (unsigned seed = 1; seed <= 3; ++seed)
    {
      const ElasticMesh mesh = disturbed(dimension, seed);
      double volume = 0.0;
      for (const std::array<int, 4>& cell : mesh.cells)
      {
        const Eigen::Vector3d a = mesh.nodes[cell[1]] - mesh.nodes[cell[0]];
        const Eigen::Vector3d b = mesh.nodes[cell[2]] - mesh.nodes[cell[0]];
        volume += dimension == 2 ? 0.5 * std::abs(a.x() * b.z() - a.z() * b.x())
                                 : std::abs(a.cross(b).dot(mesh.nodes[cell[3]] - mesh.nodes[cell[0]])) / 6.0;
      }
      EXPECT_NEAR(enclosedVolume(mesh), volume, 1e-13 * volume);
    }
}

class FileTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = std::filesystem::temp_directory_path() / ("elastic_files_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const
  {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  static std::string messageOf(const std::string& path)
  {
    try
    {
      readGmsh(path);
    }
    catch (const ModelError& error)
    {
      return error.what();
    }
    return "no error";
  }
  std::filesystem::path folder_;
};

const char* const SQUARE_22 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "clamp"
2 8 "body"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
9 5 5 0
$EndNodes
$Elements
4
1 15 2 0 1 1
2 1 2 7 1 1 2
3 2 2 8 1 1 2 3
4 2 2 8 1 1 3 4
$EndElements
)";

const char* const SQUARE_41 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "clamp"
2 8 "body"
$EndPhysicalNames
$Entities
0 1 1 0
3 0 0 0 1 0 0 1 7 0
5 0 0 0 1 1 0 1 8 1 3
$EndEntities
$Nodes
2 5 1 9
1 3 0 2
1
2
0 0 0
1 0 0
2 5 0 3
3
4
9
1 1 0
0 1 0
5 5 0
$EndNodes
$Elements
2 3 2 4
1 3 1 1
2 1 2
2 5 2 2
3 1 2 3
4 1 3 4
$EndElements
)";

TEST_F(FileTest, BothGmshFormatsGiveTheSameMesh)
{
  for (const char* text : {SQUARE_22, SQUARE_41})
  {
    const ElasticMesh mesh = readGmsh(write("square.msh", text));
    EXPECT_EQ(mesh.dimension, 2);
    ASSERT_EQ(mesh.nodes.size(), 4u) << "a node that no cell uses is left out";
    EXPECT_EQ(mesh.nodes[2], Eigen::Vector3d(1.0, 0.0, 1.0)) << "y of a plane mesh is the body's z";
    EXPECT_EQ(mesh.cells.size(), 2u);
    EXPECT_EQ(mesh.facets.size(), 4u);
    ASSERT_EQ(mesh.groups.count("clamp"), 1u);
    EXPECT_EQ(mesh.groups.at("clamp"), (std::vector<int>{0, 1}));
    EXPECT_NEAR(enclosedVolume(mesh), 1.0, 1e-15);
  }
}

TEST_F(FileTest, AGmsh22CellOfTwoPhysicalGroupsIsOneCellOfBoth)
{
  std::string text = SQUARE_22;
  const auto put = [&text](const std::string& what, const std::string& by)
  { text.replace(text.find(what), what.size(), by); };
  put("$PhysicalNames\n2\n", "$PhysicalNames\n3\n2 9 \"half\"\n");
  put("$Elements\n4\n", "$Elements\n5\n");
  put("4 2 2 8 1 1 3 4\n", "4 2 2 8 1 1 3 4\n5 2 2 9 1 1 3 4\n");
  const ElasticMesh mesh = readGmsh(write("square.msh", text));
  EXPECT_EQ(mesh.cells.size(), 2u);
  EXPECT_EQ(mesh.groups.at("half"), (std::vector<int>{0, 2, 3}));
  put("5 2 2 9", "5 2 2 8");
  EXPECT_NE(messageOf(write("square.msh", text)), "no error") << "twice in one group";
}

TEST_F(FileTest, BrokenGmshFilesAreNamedWithTheirLine)
{
  const std::string good = SQUARE_22;
  const auto changed = [&](const std::string& from, const std::string& to)
  {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return write("bad.msh", text);
  };
  struct Bad
  {
    const char* from;
    const char* to;
    const char* says;
  };
  for (const Bad& bad : {Bad{"2.2 0 8", "2.2 1 8", "bad.msh:2: found format 2.2"},
                         Bad{"2.2 0 8", "3.0 0 8", "expected 2.2 or 4.1"}, Bad{"1 1 3 4", "1 1 3 77", "found node 77"},
                         Bad{"3 1 1 0", "3 nan 1 0", "expected x"}, Bad{"4 2 2 8", "4 3 2 8", "element of type 3"},
                         Bad{"$EndNodes", "", "bad.msh"}, Bad{"3 1 1 0", "3 1 1 0.5", "not in a plane"},
                         Bad{"3 1 1 0", "3 2 0 0", "has no volume"}, Bad{"\n5\n", "\n-5\n", "found -5 nodes"}})
    EXPECT_NE(messageOf(changed(bad.from, bad.to)).find(bad.says), std::string::npos)
        << bad.to << ": " << messageOf(changed(bad.from, bad.to));
  EXPECT_NE(messageOf("/no/such.msh").find("/no/such.msh: cannot be read"), std::string::npos);
  EXPECT_NE(messageOf(write("empty.msh", "")).find("no $MeshFormat"), std::string::npos);
}

TEST_F(FileTest, ExportedMatricesComeBack)
{
  const ElasticMesh mesh = disturbed(3, 4);
  const ElasticParts parts = assembleElastic(mesh, material());
  std::ostringstream nodes;
  nodes.precision(17);
  nodes << "x,y,z,surface,fixed\n";
  for (size_t i = 0; i < mesh.nodes.size(); ++i)
    nodes << mesh.nodes[i].x() << ',' << mesh.nodes[i].y() << ',' << mesh.nodes[i].z() << ','
          << std::binary_search(parts.surface.begin(), parts.surface.end(), static_cast<int>(i)) << ',' << (i == 3)
          << '\n';
  const std::string table = write("nodes.csv", nodes.str());
  for (const bool symmetric : {true, false})
  {
    const ElasticParts read = readMatrices(write("M.mtx", test_support::marketFile(parts.mass, symmetric)),
                                           write("K.mtx", test_support::marketFile(parts.stiffness, symmetric)), table);
    EXPECT_EQ(read.dimension, 3);
    EXPECT_EQ(read.surface, parts.surface);
    EXPECT_EQ(read.groups.at("fixed"), std::vector<int>{3});
    EXPECT_LT((read.mass - parts.mass).norm(), 1e-15 * parts.mass.norm());
    EXPECT_LT((read.stiffness - parts.stiffness).norm(), 1e-15 * parts.stiffness.norm());
  }
  const std::string good = test_support::marketFile(parts.mass, true);
  EXPECT_THROW(
      readMatrices(write("bad.mtx", "%%MatrixMarket matrix array real general\n1 1\n1\n"), write("K.mtx", good), table),
      ModelError);
  std::string cut = good.substr(0, good.size() / 2);
  cut = cut.substr(0, cut.rfind('\n') + 1);
  EXPECT_THROW(readMatrices(write("cut.mtx", cut), write("K.mtx", good), table), ModelError);
  EXPECT_THROW(readMatrices(write("M.mtx", good), write("K.mtx", good), write("short.csv", "x,y,z\n0,0,0\n1,0\n")),
               ModelError);
}

}  // namespace
}  // namespace frictional_contact_sim
