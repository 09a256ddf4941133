// Files of other programs that are no elastic body's: refused with one line, whatever the mesh.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/model/model_error.h"
#include "support/message_of.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::messageOf;

ElasticMaterial material()
{
  ElasticMaterial some;
  some.young_modulus = 2.5e6;
  some.poisson_ratio = 0.3;
  some.density = 1200.0;
  return some;
}

ElasticMesh mesh(int dimension)
{
  if (dimension == 1)
    return barMesh(0.5, 6);
  return dimension == 2 ? boxMesh({0.3, 0.2}, {4, 3}) : boxMesh({0.3, 0.2, 0.2}, {3, 2, 2});
}

std::string refusalOf(const ElasticParts& parts, const std::vector<int>& supports = {})
{
  return messageOf([&] { ElasticSolid("body", parts, supports, 0.0); });
}

class MatricesTest : public testing::TestWithParam<int>
{
protected:
  ElasticParts parts_ = assembleElastic(mesh(GetParam()), material());
};

TEST_P(MatricesTest, ThoseOfABodyAreTaken)
{
  EXPECT_EQ(refusalOf(parts_), "no error");
  EXPECT_EQ(refusalOf(parts_, nodesNamed(parts_, "left")), "no error");
  EXPECT_EQ(refusalOf(parts_, {0}), "no error") << "it may swing about a node";
  for (const double scale : {1e-6, 1e6})
  {
    ElasticParts other = parts_;
    other.mass *= scale;
    EXPECT_EQ(refusalOf(other), "no error");
    other.stiffness *= scale * scale;
    EXPECT_EQ(refusalOf(other), "no error");
  }
}

TEST_P(MatricesTest, ConstraintsInThemAreRefused)
{
  // As programs apply them: rows and columns to zero, one (or a large number) on the diagonal.
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  for (int run = 0; run < 10; ++run)
  {
    const auto row = static_cast<Eigen::Index>(random() % static_cast<unsigned>(parts_.stiffness.rows()));
    ElasticParts constrained = parts_;
    const auto constrain = [row](SparseRows& matrix, double diagonal)
    {
      matrix.prune([row](Eigen::Index i, Eigen::Index k, double) { return i != row && k != row; });
      matrix.coeffRef(row, row) = diagonal;
    };
    constrain(constrained.stiffness, run % 2 == 0 ? 1.0 : 1e9);
    EXPECT_NE(refusalOf(constrained).find("resists a translation"), std::string::npos) << refusalOf(constrained);
    constrained.stiffness = parts_.stiffness;
    constrain(constrained.mass, 1.0);
    if (GetParam() > 1)
    {
      EXPECT_NE(refusalOf(constrained).find("expected one mass"), std::string::npos) << refusalOf(constrained);
    }
    ElasticParts sprung = parts_;
    sprung.stiffness.coeffRef(row, row) *= 1.0 + 1e-6;
    EXPECT_NE(refusalOf(sprung).find("resists a translation"), std::string::npos) << refusalOf(sprung);
  }
}

TEST_P(MatricesTest, ThoseThatDriveADeformationApartAreRefused)
{
  ElasticParts negative = parts_;
  negative.stiffness *= -1.0;
  EXPECT_NE(refusalOf(negative).find("negative eigenvalue"), std::string::npos) << refusalOf(negative);
  EXPECT_NE(refusalOf(negative, nodesNamed(parts_, "left")).find("negative eigenvalue"), std::string::npos);
  // One spring of the wrong sign between two nodes, which translations do not feel.
  std::mt19937 random(7);
  for (int run = 0; run < 10; ++run)
  {
    ElasticParts bad = parts_;
    const int d = GetParam();
    const int count = static_cast<int>(parts_.nodes.size());
    const int a = d * static_cast<int>(random() % static_cast<unsigned>(count - 1));
    const int b = a + d;
    const double spring = 4.0 * (parts_.stiffness.coeff(a, a) + parts_.stiffness.coeff(b, b));
    bad.stiffness.coeffRef(a, a) -= spring;
    bad.stiffness.coeffRef(b, b) -= spring;
    bad.stiffness.coeffRef(a, b) += spring;
    bad.stiffness.coeffRef(b, a) += spring;
    EXPECT_NE(refusalOf(bad).find("negative eigenvalue"), std::string::npos) << refusalOf(bad);
  }
  ElasticParts light = parts_;
  light.mass.coeffRef(0, 0) *= -1.0;
  EXPECT_NE(refusalOf(light).find("mass matrix"), std::string::npos) << refusalOf(light);
}

TEST_P(MatricesTest, RotationIsTheRigidOneWithAndWithoutCells)
{
  std::mt19937 random(3);
  std::normal_distribution<double> gauss(0.0, 0.01);
  ElasticParts bare = parts_;
  bare.cells.clear();
  const ElasticSolid with("with", parts_, {}, 0.0);
  const ElasticSolid without("without", bare, {}, 0.0);
  for (int run = 0; run < 5; ++run)
  {
    Eigen::Vector3d turn(gauss(random), gauss(random), gauss(random));
    if (GetParam() == 2)
      turn.x() = turn.z() = 0.0;
    const Eigen::VectorXd q = with.rigidVelocity(Eigen::Vector3d(gauss(random), 0.0, gauss(random)), turn);
    const double expected = GetParam() == 1 ? 0.0 : turn.norm();
    EXPECT_NEAR(with.rotation(q), expected, 1e-13);
    EXPECT_NEAR(without.rotation(q), expected, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, MatricesTest, testing::Values(1, 2, 3));

TEST(CloseMeshTest, CellsThatStandTwiceOrInOneAnotherAreNamed)
{
  for (const int dimension : {2, 3})
    for (unsigned seed = 0; seed < 10; ++seed)
    {
      std::mt19937 random(seed);
      ElasticMesh twice = mesh(dimension);
      const size_t cell = random() % twice.cells.size();
      std::array<int, 4> copy = twice.cells[cell];
      std::shuffle(copy.begin(), copy.begin() + dimension + 1, random);
      twice.cells.insert(twice.cells.begin() + static_cast<std::ptrdiff_t>(random() % twice.cells.size()), copy);
      const std::string message = messageOf([&] { closeMesh(twice); });
      EXPECT_NE(message.find("lie on one side of a facet"), std::string::npos) << message;
    }
  ElasticMesh lone;  // all of its facets are seen twice
  lone.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  lone.cells = {{0, 1, 2, 3}, {1, 0, 2, 3}};
  EXPECT_NE(messageOf([&] { closeMesh(lone); }).find("cells 1 and 2"), std::string::npos);
  lone.nodes.emplace_back(0.2, 0.2, 0.9);  // a second cell on the same side of facet 0 1 2
  lone.cells[1] = {0, 1, 2, 4};
  EXPECT_NE(messageOf([&] { closeMesh(lone); }).find("cells 1 and 2"), std::string::npos);
}

class MarketTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = std::filesystem::temp_directory_path() / ("market_files_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    table_ = write("nodes.csv", "x, y, z\n0, 0, 0\n1, 0, 0\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const
  {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /** The mass matrix of two nodes along x. */
  std::string mass(const std::string& entries, const std::string& kind = "symmetric") const
  {
    return write("M.mtx", "%%MatrixMarket matrix coordinate real " + kind + "\n% two nodes\n" + entries);
  }
  std::string refusal(const std::string& entries, const std::string& kind = "symmetric") const
  {
    const std::string path = mass(entries, kind);
    return messageOf([&] { readMatrices(path, path, table_); });
  }
  std::filesystem::path folder_;
  std::string table_;
};

TEST_F(MarketTest, FortranNumbersAreRead)
{
  for (const char* const number : {"2.1D+1", "2.1d1", "2.1E+01", "+21", "21", ".21e2", "2.1D1\r"})
  {
    const std::string path = mass("2 2 3\n1 1 " + std::string(number) + "\n2 1 -1D-1\n2 2 1D0\n");
    const ElasticParts parts = readMatrices(path, path, table_);
    EXPECT_EQ(parts.mass.coeff(0, 0), 21.0) << number;
    EXPECT_EQ(parts.mass.coeff(0, 1), -0.1);
    EXPECT_EQ(parts.mass.coeff(1, 0), -0.1);
  }
}

TEST_F(MarketTest, WhatIsNoNumberOrStandsTwiceIsNamedWithItsLine)
{
  for (const char* const value :
       {"2.1F+1", "2.1x", "0x10", "2,1", "1e999", "nan", "inf", "1.0 0.5", "", "2.1+11", "+-1"})
  {
    const std::string message = refusal("2 2 3\n1 1 1\n2 2 " + std::string(value) + "\n2 1 0\n");
    EXPECT_NE(message.find("M.mtx:5: found '2 2 " + std::string(value)), std::string::npos) << message;
    EXPECT_NE(message.find("expected row, column, finite value"), std::string::npos) << message;
  }
  EXPECT_NE(refusal("2 2 4\n1 1 1\n2 1 .1\n1 2 .1\n2 2 1\n").find("M.mtx:6: found '1 2 .1', expected row >= column"),
            std::string::npos);
  EXPECT_NE(refusal("2 2 4\n1 1 1\n2 1 .1\n2 1 .1\n2 2 1\n").find("twice"), std::string::npos);
  EXPECT_NE(refusal("2 2 3\n1 1 1\n2 2 1\n2 2 1\n", "general").find("twice"), std::string::npos);
  EXPECT_EQ(refusal("2 2 4\n1 1 1\n2 1 .1\n1 2 .1\n2 2 1\n", "general"), "no error");
  EXPECT_NE(refusal("2 2\n").find("M.mtx:3: found '2 2', expected rows, columns, entries"), std::string::npos);
  EXPECT_NE(refusal("7 7 0\n").find("1, 2 or 3 rows for each of 2 nodes"), std::string::npos);
  EXPECT_NE(refusal("").find("M.mtx"), std::string::npos);
  EXPECT_NE(refusal("2 2 3\n1 1 1\n").find("found 1 entries, expected 3"), std::string::npos);
}

TEST_F(MarketTest, NumbersOfTheNodeTableAreWholeWords)
{
  const std::string path = mass("2 2 2\n1 1 1\n2 2 1\n");
  for (const char* const cell : {"1 2", "1.5x", "", "1;5"})
  {
    const std::string table = write("bad.csv", "x,y,z\n0,0,0\n" + std::string(cell) + ",0,0\n");
    const std::string message = messageOf([&] { readMatrices(path, path, table); });
    EXPECT_NE(message.find("bad.csv:3"), std::string::npos) << message;
    EXPECT_NE(message.find("a number in column x"), std::string::npos) << message;
  }
}

TEST_F(MarketTest, NumbersOfGmshAreWholeWords)
{
  const auto square = [](const std::string& z)
  {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 " + z +
           "\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n" + "1 2 0 1 2 3\n$EndElements\n";
  };
  EXPECT_EQ(readGmsh(write("good.msh", square("0"))).nodes.size(), 3u);
  for (const char* const z : {"0D0", "0x", "0,"})
  {
    const std::string path = write("bad.msh", square(z));
    const std::string message = messageOf([&] { readGmsh(path); });
    EXPECT_NE(message.find("bad.msh:6"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace frictional_contact_sim
