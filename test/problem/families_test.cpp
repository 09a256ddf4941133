#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <set>

#include "frictional_contact_sim/problem/random_family.h"
#include "frictional_contact_sim/problem/rigid_families.h"
#include "frictional_contact_sim/problem/rod_family.h"
#include "frictional_contact_sim/solver/registry.h"

using namespace frictional_contact_sim;

namespace
{
Solution solve(const IncrementalProblem& problem)
{
  const std::unique_ptr<Solver> solver = createSolver("portfolio");
  StoppingOptions stopping;
  stopping.tolerance = 1e-10;
  solver->setStopping(stopping);
  const SolverResult result = solver->solve(problem);
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message;
  return result.solution;
}

/** Bodies (of 6 velocities) that a contact's rows touch. */
std::set<int> bodiesOf(const IncrementalProblem& problem, int contact, int size)
{
  std::set<int> bodies;
  for (int row = 3 * contact; row < 3 * contact + 3; ++row)
    for (SparseRows::InnerIterator entry(problem.H, row); entry; ++entry)
      bodies.insert(static_cast<int>(entry.col()) / size);
  return bodies;
}

RigidFamilyOptions still()
{
  RigidFamilyOptions options;
  options.agitation = 0.0;
  return options;
}
}  // namespace

TEST(RandomFamilyTest, TheTablesAreThoseOfTheThesis)
{
  const std::vector<RandomFamilyEntry> small = smallRandomFamily();
  ASSERT_EQ(small.size(), 15u);
  for (size_t i = 0; i < small.size(); ++i)  // table 5.1 is regular
  {
    EXPECT_EQ(small[i].options.velocities, 42 + 6 * static_cast<int>(i));
    EXPECT_EQ(small[i].options.contacts, 5 + 3 * static_cast<int>(i));
    EXPECT_EQ(small[i].options.subsystem_velocities, 6);
  }
  const std::vector<RandomFamilyEntry> large = largeRandomFamily();
  ASSERT_EQ(large.size(), 15u);
  const std::vector<int> systems = {125, 167, 187, 200, 208, 50, 67, 75, 80, 83, 21, 28, 31, 33, 35};  // table 5.2
  std::set<std::string> names;
  for (size_t i = 0; i < large.size(); ++i)
  {
    const RandomFamilyOptions& options = large[i].options;
    EXPECT_EQ(options.velocities, systems[i] * options.subsystem_velocities);
    EXPECT_EQ(options.contacts, 100 * (1 + static_cast<int>(i % 5)));
    names.insert(large[i].name);
  }
  EXPECT_EQ(names.size(), 15u);
}

TEST(RandomFamilyTest, MassBlocksHaveTheChosenCondition)
{
  for (const double condition : {1.0, 1e3, 1e12})
  {
    RandomFamilyOptions options;
    options.condition = condition;
    const IncrementalProblem problem = randomFamilyProblem(options);
    const Eigen::MatrixXd M(problem.M);
    EXPECT_EQ(M, M.transpose());
    for (int first = 0; first < 42; first += 6)
    {
      const Eigen::VectorXd values = M.block<6, 6>(first, first).selfadjointView<Eigen::Lower>().eigenvalues();
      // Entries carry round-off relative to the largest eigenvalue, so the smallest is known to condition * 1e-15.
      EXPECT_NEAR(values[5] / values[0] / condition, 1.0, 1e-14 * condition + 1e-13);
    }
    EXPECT_EQ(M.block(0, 6, 6, 36).norm(), 0.0);
  }
}

TEST(RandomFamilyTest, ContactsJoinTwoSystemsAndScalarsFollowTheirLaws)
{
  RandomFamilyOptions options;
  options.velocities = 600;
  options.contacts = 2000;
  options.external_velocity = 3.0;
  const IncrementalProblem problem = randomFamilyProblem(options);
  double sum = 0.0;
  for (int i = 0; i < options.contacts; ++i)
  {
    EXPECT_EQ(bodiesOf(problem, i, 6).size(), 2u);
    const double friction = problem.laws[static_cast<size_t>(i)].coefficient;
    EXPECT_TRUE(friction >= 0.2 && friction <= 0.8);
    sum += friction;
  }
  // Means and mean squares within 5 standard errors: 0.173/sqrt(2000); sqrt(2/6000); sqrt(2/72000).
  EXPECT_NEAR(sum / options.contacts, 0.5, 0.02);
  EXPECT_NEAR(problem.w.squaredNorm() / 6000.0 / 9.0, 1.0, 0.1);
  EXPECT_NEAR(problem.H.squaredNorm() / 72000.0, 1.0, 0.03);
}

TEST(RandomFamilyTest, ADrawIsTheSameOnEveryMachine)
{
  const IncrementalProblem problem = randomFamilyProblem({});
  // Written down when the tables' seeds were fixed; the draws carry 32 binary places, products round-off.
  EXPECT_EQ(problem.f[0], -0.35554949543438852);
  EXPECT_NEAR(problem.M.coeff(0, 0), 1.1835491188588545, 1e-14);
  EXPECT_NEAR(problem.w[14], -1.9609554834337166, 1e-14);
  EXPECT_EQ(problem.laws[4].coefficient, 0.35144604767921689);
  const IncrementalProblem again = randomFamilyProblem({});
  EXPECT_EQ(Eigen::MatrixXd(again.H), Eigen::MatrixXd(problem.H));
  RandomFamilyOptions other;
  other.seed = 2;
  EXPECT_NE(randomFamilyProblem(other).f, problem.f);
}

TEST(RandomFamilyTest, BadOptionsAreNamed)
{
  RandomFamilyOptions options;
  options.velocities = 43;
  EXPECT_THROW(randomFamilyProblem(options), std::invalid_argument);
  options = {};
  options.condition = 0.5;
  EXPECT_THROW(randomFamilyProblem(options), std::invalid_argument);
  options = {};
  options.friction_min = 0.9;
  EXPECT_THROW(randomFamilyProblem(options), std::invalid_argument);
  options = {};
  options.contacts = 0;  // valid: nothing touches
  EXPECT_EQ(randomFamilyProblem(options).rows(), 0);
}

TEST(RigidFamilyTest, APackingHasExactlyTheContactsAskedForAndIsSparse)
{
  for (const int contacts : {1, 10, 100, 1000, 50000})
  {
    const IncrementalProblem problem = granularProblem(contacts, 0, {});
    EXPECT_EQ(problem.rows(), 3 * contacts);
    EXPECT_LE(problem.H.nonZeros(), 3 * contacts * 12);
    EXPECT_NO_THROW(validate(problem));
  }
  EXPECT_EQ(granularProblem(100, 1, {}).velocities(), 600);  // a chain: one ball a contact
}

TEST(RigidFamilyTest, TheFloorCarriesTheStack)
{
  const int levels = 5;
  RigidFamilyOptions options = still();
  options.mass_ratio = 16.0;
  const Solution solution = solve(boxStackProblem(levels, 2, options));
  const double weight = (1 + 2 + 4 + 8 + 16) * 9.81 * options.time_step;
  double floor = 0.0;
  for (int i = 0; i < 4; ++i)
    floor += solution.r[3 * i];
  EXPECT_NEAR(floor, weight, 1e-8 * weight);  // solver tolerance 1e-10, mass ratio and five levels
  EXPECT_LT(solution.v.lpNorm<Eigen::Infinity>(), 1e-8);
}

TEST(RigidFamilyTest, AStackIsRankDeficientAsSaid)
{
  const IncrementalProblem problem = boxStackProblem(3, 4, {});
  EXPECT_EQ(problem.rows(), 3 * 16 * 3);
  // 6 a cube: rows over rank = p^2/2 = 8.
  EXPECT_EQ(Eigen::MatrixXd(problem.H).colPivHouseholderQr().rank(), 18);
}

TEST(RigidFamilyTest, TheContactFrameSeesOnlyRelativeMotion)
{
  const IncrementalProblem problem = granularProblem(60, 0, {});
  // A rigid translation of everything moves no pair of balls; the floor is seen moving.
  Eigen::VectorXd v = Eigen::VectorXd::Zero(problem.velocities());
  for (int body = 0; body < v.size(); body += 6)
    v.segment<3>(body) = Eigen::Vector3d(0.3, -0.2, 0.5);
  const Eigen::VectorXd u = problem.H * v;
  for (int i = 0; i < 60; ++i)
  {
    const bool floor = bodiesOf(problem, i, 6).size() == 1;
    EXPECT_NEAR(u.segment<3>(3 * i).norm(), floor ? v.head<3>().norm() : 0.0, 1e-15);
  }
}

TEST(RodFamilyTest, TheTablesAreThoseOfTheThesis)
{
  for (const auto& table : {smallRodFamily(), largeRodFamily()})
  {
    ASSERT_EQ(table.size(), 15u);
    for (const RodFamilyEntry& entry : table)
    {
      const IncrementalProblem problem = rodFamilyProblem(entry.options);
      EXPECT_EQ(entry.name.rfind(
                    "hair-" + std::to_string(problem.velocities()) + "-" + std::to_string(problem.rows() / 3), 0),
                0u)
          << entry.name;
      EXPECT_EQ(problem.w.norm(), 0.0);  // one support: always solvable
      EXPECT_NO_THROW(validate(problem));
    }
  }
}

TEST(RodFamilyTest, AFarContactMovesAllPiecesAndANearOneOnlyTheFirst)
{
  RodFamilyOptions options;
  options.contacts = 10;
  const IncrementalProblem problem = rodFamilyProblem(options);
  for (int contact = 0; contact < options.contacts; ++contact)
    for (int rod = 0; rod < options.rods; ++rod)
    {
      // The columns of a rod that are not zero are those of its first pieces, without a gap.
      const Eigen::MatrixXd block = Eigen::MatrixXd(problem.H).block(3 * contact, 18 * rod, 3, 18);
      bool ended = false;
      for (int piece = 0; piece < 6; ++piece)
      {
        const bool moves = block.middleCols<3>(3 * piece).norm() > 0.0;
        EXPECT_FALSE(ended && moves);
        ended = ended || !moves;
      }
      EXPECT_GT(block.leftCols<3>().norm(), 0.0);
    }
}

TEST(RodFamilyTest, StraightRodsSwingAsCantileversWithTheClosedFormInertia)
{
  RodFamilyOptions options;
  options.curl = 0.0;
  options.pieces = 1;
  options.contacts = 0;
  const Eigen::MatrixXd M = Eigen::MatrixXd(rodFamilyProblem(options).M).topLeftCorner(3, 3);
  const double pi = 3.14159265358979323846;
  const double length = 0.2, radius = 1e-3, density = 1300.0, step = 1e-3, young = 1e7;
  const double area = pi * radius * radius, inertia = pi * std::pow(radius, 4) / 4.0;
  // Constant curvature: deflection s^2/2, slope s; twist turns sections about the axis, polar moment 2 I.
  const double bending = density * (area * std::pow(length, 5) / 20.0 + inertia * std::pow(length, 3) / 3.0) +
                         step * step * young * inertia * length;
  const double twisting =
      density * 2.0 * inertia * std::pow(length, 3) / 3.0 + step * step * young / 3.0 * 2.0 * inertia * length;
  // The midpoint rule with 16 points is wrong by less than (1/16)^2 relative to s^4: below 1 %.
  EXPECT_NEAR(M(1, 1), bending, 0.01 * bending);
  EXPECT_NEAR(M(2, 2), bending, 0.01 * bending);
  EXPECT_NEAR(M(0, 0), twisting, 0.01 * twisting);
  EXPECT_NEAR(M(0, 1), 0.0, 1e-15);
}

TEST(RodFamilyTest, MoreContactsThanTheRodsHaveIsRefused)
{
  RodFamilyOptions options;
  options.contacts = 1000;
  EXPECT_THROW(rodFamilyProblem(options), std::invalid_argument);
}
