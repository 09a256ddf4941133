/**
 * @file integer_program_test.cpp
 * @brief Cuts of integer programs: valid at every whole point (brute force), duality, MPS files.
 */
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "frictional_contact_sim/separation/cut_study.h"
#include "separation_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
constexpr double VALID = 1e-6;  ///< of right-hand sides, rows of length about one, points of some tens

/// Every whole point with 0 <= x_j <= most that fulfils the program's rows.
template <typename Visit>
int visitWholePoints(const IntegerProgram& program, int most, const Visit& visit)
{
  VectorXd x = VectorXd::Zero(program.size());
  int count = 0;
  while (true)
  {
    const bool even = program.equations.rows() == 0 ||
                      (program.equations.A * x - program.equations.b).lpNorm<Eigen::Infinity>() < 1e-9;
    if (even && (program.inequalities.A * x - program.inequalities.b).maxCoeff() <= 1e-9)
    {
      visit(x);
      ++count;
    }
    int j = 0;
    while (j < x.size() && ++x[j] > most)
      x[j++] = 0.0;
    if (j == x.size())
      return count;
  }
}

void expectValid(const IntegerProgram& program, const CutStudy& study, int most)
{
  std::vector<StudiedCut> cuts = study.facets;
  cuts.push_back(study.most_violated);
  cuts.push_back(study.deepest);
  const int points = visitWholePoints(program, most,
                                      [&](const VectorXd& x)
                                      {
                                        for (const StudiedCut& cut : cuts)
                                          ASSERT_LE(cut.row.dot(x), cut.right_hand_side + VALID * cut.row.norm());
                                      });
  EXPECT_GT(points, 0);
  for (const StudiedCut& cut : cuts)
    if (!cut.is_ray)
    {
      EXPECT_GT(cut.row.dot(study.vertex) - cut.right_hand_side, 1e-9);  // and cuts the vertex off
    }
}
}  // namespace

TEST(IntegerProgramTest, CutsHoldAtEveryWholePoint)
{
  int studied = 0, facets = 0;
  for (std::uint64_t seed = 0; seed < 25; ++seed)
    for (const double factor : {0.0, 1.0})
    {
      SCOPED_TRACE(seed);
      const IntegerProgram program = randomIntegerProgram(4, 3, seed);
      StudyOptions options;
      options.decomposition.bound_factor = factor;
      options.check_facets = true;
      const CutStudy study = studyCuts(program, options);
      if (study.status == StudyStatus::WHOLE)
        continue;
      ASSERT_EQ(study.status, StudyStatus::STUDIED) << study.message;
      ++studied;
      expectValid(program, study, 12);
      EXPECT_GE(study.with_facets, study.with_deepest - VALID * std::abs(study.relaxed));
      EXPECT_GE(study.with_deepest, study.relaxed - VALID * std::abs(study.relaxed));
      EXPECT_GE(study.deepest.depth, study.most_violated.depth * (1.0 - 1e-8));
      for (const StudiedCut& cut : study.facets)
        if (!cut.is_ray && !cut.on_bound)
        {
          EXPECT_EQ(cut.face_dimension, study.dimension - 1);
          ++facets;
        }
      if (factor == 0.0)
      {
        EXPECT_LT(study.duality_error, 1e-10);
      }
    }
  EXPECT_GT(studied, 30);
  EXPECT_GT(facets, 20);
}

TEST(IntegerProgramTest, EquationsAreTheSpaceThatCutsLiveIn)
{
  Dice dice(9);
  int studied = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed)
  {
    SCOPED_TRACE(seed);
    IntegerProgram program = randomIntegerProgram(4, 2, seed);
    program.equations = {MatrixXd(1, 4), VectorXd::Constant(1, dice.integer(4, 9))};
    for (int j = 0; j < 4; ++j)
      program.equations.A(0, j) = dice.integer(1, 3);
    const CutStudy study = studyCuts(program);
    if (study.status != StudyStatus::STUDIED)
      continue;
    ++studied;
    EXPECT_LT(std::abs(program.equations.A.row(0).dot(study.deepest.row)), 1e-9 * study.deepest.row.norm());
    std::vector<StudiedCut> cuts = study.facets;
    cuts.push_back(study.most_violated);
    visitWholePoints(program, 9,
                     [&](const VectorXd& x)
                     {
                       for (const StudiedCut& cut : cuts)
                         ASSERT_LE(cut.row.dot(x), cut.right_hand_side + VALID * cut.row.norm());
                     });
  }
  EXPECT_GT(studied, 10);
}

TEST(IntegerProgramTest, DenseOnesAsInTable71)
{
  // The sizes of the thesis begin here; the table itself is made by scripts/facet_cuts_table.
  for (std::uint64_t seed = 0; seed < 3; ++seed)
  {
    StudyOptions options;
    options.decomposition.bound_factor = 0.0;
    const CutStudy study = studyCuts(randomIntegerProgram(20, 20, seed), options);
    ASSERT_EQ(study.status, StudyStatus::STUDIED) << study.message;
    EXPECT_LT(study.duality_error, 1e-10);
    double weight = 0.0;
    for (const StudiedCut& cut : study.facets)
      weight += cut.is_ray ? 0.0 : cut.weight;
    EXPECT_NEAR(weight, 1.0, 1e-9);
    EXPECT_GE(study.calls, static_cast<int>(study.facets.size()));
    EXPECT_GE(study.with_facets, study.with_deepest - VALID * std::abs(study.relaxed));
  }
}

TEST(IntegerProgramTest, SaysWhenThereIsNothingToCut)
{
  IntegerProgram program = randomIntegerProgram(2, 1, 1);
  program.inequalities.A.resize(4, 2);
  program.inequalities.A << 1, 0, 0, 1, -1, 0, 0, -1;
  program.inequalities.b = Eigen::Vector4d(3, 2, 0, 0);
  EXPECT_EQ(studyCuts(program).status, StudyStatus::WHOLE);
  program.inequalities.b = Eigen::Vector4d(0.6, 2, -0.4, 0);  // x_0 between 0.4 and 0.6
  EXPECT_EQ(studyCuts(program).status, StudyStatus::INFEASIBLE);
  program.inequalities.b = Eigen::Vector4d(0, 2, -1, 0);
  EXPECT_EQ(studyCuts(program).status, StudyStatus::INFEASIBLE);
  program.inequalities = {-MatrixXd::Identity(2, 2), VectorXd::Zero(2)};
  EXPECT_EQ(studyCuts(program).status, StudyStatus::UNBOUNDED);
}

TEST(MpsTest, WrittenAndReadAgainIsTheSameProgram)
{
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mps_test_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "program.mps").string();
  const IntegerProgram program = randomIntegerProgram(7, 5, 3);
  writeMps(program, path);
  const IntegerProgram read = readMps(path);
  EXPECT_EQ(read.size(), 7);
  EXPECT_EQ((read.cost - program.cost).norm(), 0.0);
  EXPECT_EQ(read.whole, program.whole);
  ASSERT_EQ(read.inequalities.rows(), program.inequalities.rows());
  const CutStudy ours = studyCuts(program), theirs = studyCuts(read);
  EXPECT_NEAR(ours.relaxed, theirs.relaxed, 1e-6);
  EXPECT_NEAR(ours.with_facets, theirs.with_facets, 1e-6 * std::abs(ours.relaxed));
  std::ofstream(folder / "bad.mps") << "this is no program\n";
  for (const std::string& name : {(folder / "bad.mps").string(), (folder / "none.mps").string(), folder.string()})
    EXPECT_THROW(readMps(name), std::invalid_argument) << name;
  std::filesystem::remove_all(folder);
}
