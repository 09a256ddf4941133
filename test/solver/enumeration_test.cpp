/**
 * @file enumeration_test.cpp
 * @brief The complete search: closed forms of the thesis, and random problems against the look at every combination.
 */
#include <gtest/gtest.h>

#include <map>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/existence.h"
#include "frictional_contact_sim/solver/portfolio.h"
#include "frictional_contact_sim/solver/registry.h"
#include "mode_check.h"
#include "support/dice.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
constexpr double DEGREE = M_PI / 180.0;
/// Systems solved directly: round-off times a condition below 1e6.
constexpr double EXACT = 1e-9;

/// The laws themselves, planar ones of numbers about 1, to an absolute bound: where nothing moves at all (q = 0) E is
/// relative to nothing.
bool holdsAbsolutely(const DelassusProblem& problem, const VectorXd& r)
{
  const VectorXd u = problem.W.toDense() * r + problem.q;
  const double bound = 1e-12 * std::max(1.0, r.lpNorm<Eigen::Infinity>());
  const auto opposes = [bound](double force, double velocity, double most)
  {
    return std::abs(force) <= most + bound && (std::abs(velocity) <= bound || force * velocity <= 0.0) &&
           (std::abs(velocity) <= bound || std::abs(std::abs(force) - most) <= bound);
  };
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const bool is_contact = law.type == LawType::COULOMB_2D || law.type == LawType::UNILATERAL;
    if (is_contact && !(r[row] >= -bound && u[row] >= -bound && std::min(r[row], u[row]) <= bound))
      return false;
    if (law.type == LawType::COULOMB_2D && !opposes(r[row + 1], u[row + 1], law.coefficient * r[row]))
      return false;
    if (law.type == LawType::DRY_FRICTION && !opposes(r[row], u[row], law.coefficient))
      return false;
    if (!is_contact && law.type != LawType::DRY_FRICTION)
      return false;
    row += law.dimension();
  }
  return true;
}

void expectSolution(const DelassusProblem& problem, const VectorXd& r, double tolerance)
{
  const double verdict = validateAnswer(problem, r).worst();
  EXPECT_TRUE(verdict < tolerance || holdsAbsolutely(problem, r)) << verdict << " of r = " << r.transpose();
}

/// Every vertex that is listed is a solution; the families' velocities are what they are said to be.
void expectSolutions(const DelassusProblem& problem, const EnumerationReport& report, double tolerance = 1e-8)
{
  for (const SolutionFamily& family : report.families)
  {
    expectSolution(problem, family.representative.r, tolerance);
    for (const SolutionPiece& piece : family.pieces)
    {
      EXPECT_EQ(piece.modes.size(), problem.laws.size());
      for (const VectorXd& vertex : piece.vertices)
        expectSolution(problem, vertex, tolerance);
      for (const VectorXd& ray : piece.rays)  // any distance along it
        expectSolution(problem, piece.vertices.front() + 3.0 * ray, tolerance);
    }
  }
}

void expectSolutions(const IncrementalProblem& problem, const EnumerationReport& report)
{
  for (const SolutionFamily& family : report.families)
    EXPECT_LT(
        validateAnswer(problem, family.representative.v, family.representative.r, family.representative.lambda).worst(),
        1e-8);
}

/// The report against the look at every combination of modes.
void expectWhatEveryModeSays(const DelassusProblem& problem, const std::string& where)
{
  SCOPED_TRACE(where);
  const EnumerationReport report = enumerate(problem);
  EXPECT_TRUE(report.complete) << report.message;
  expectSolutions(problem, report);
  const std::vector<CheckedMode> modes = feasibleModes(problem.W.toDense(), problem.q, problem.laws);
  std::vector<VectorXd> isolated;
  std::vector<int> met(report.families.size(), 0);
  for (const CheckedMode& mode : modes)
  {
    size_t family = 0;
    while (family < report.families.size() && !isIn(report.families[family], mode.r, 1e-6))
      ++family;
    ASSERT_LT(family, report.families.size()) << "not enumerated: r = " << mode.r.transpose();
    ++met[family];
    if (report.families[family].dimension == 0 &&
        std::none_of(isolated.begin(), isolated.end(),
                     [&](const VectorXd& r) { return (r - mode.r).norm() < 1e-6 * std::max(1.0, r.norm()); }))
      isolated.push_back(mode.r);
  }
  EXPECT_EQ(static_cast<int>(isolated.size()), report.solutions);
  for (size_t k = 0; k < met.size(); ++k)
    EXPECT_GT(met[k], 0) << "invented: r = " << report.families[k].representative.r.transpose();
  EXPECT_EQ(static_cast<int>(report.families.size()), report.solutions + report.continua);
  double difference = 0.0, speed = problem.q.lpNorm<Eigen::Infinity>();
  for (const CheckedMode& mode : modes)
  {
    const VectorXd u = problem.W.toDense() * mode.r;
    speed = std::max(speed, u.lpNorm<Eigen::Infinity>());
    difference = std::max(difference, (u - problem.W.toDense() * modes.front().r).lpNorm<Eigen::Infinity>());
  }
  if (difference > 1e-4 * speed && difference > 1e-12)
  {
    EXPECT_EQ(report.uniqueness, Uniqueness::MULTIPLE);
  }
  else if (!report.families.empty() && report.continua == 0)
  {
    EXPECT_EQ(report.uniqueness, Uniqueness::UNIQUE_V);
  }
}

/// Random W = Z Z', rank of Z as asked for; small whole numbers half of the time, for ties on borders of modes.
DelassusProblem randomPlanar(Dice& dice, int contacts, int limits, int dry, int rank)
{
  std::vector<Law> laws;
  for (int i = 0; i < contacts; ++i)
    laws.push_back({LawType::COULOMB_2D, dice.chance(0.15) ? 0.0 : dice.chance(0.5) ? 1.0 : dice.uniform(0.1, 3.0)});
  for (int i = 0; i < limits; ++i)
    laws.push_back({LawType::UNILATERAL, 0.0});
  for (int i = 0; i < dry; ++i)
    laws.push_back({LawType::DRY_FRICTION, dice.uniform(0.1, 1.0)});
  const int rows = rowCount(laws);
  const bool whole = dice.chance(0.4);
  const auto number = [&] { return whole ? dice.integer(-2, 2) : dice.uniform(-1.0, 1.0); };
  MatrixXd Z(rows, rank);
  VectorXd q(rows);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rank; ++j)
      Z(i, j) = number();
  for (int i = 0; i < rows; ++i)
    q[i] = number();
  if (dice.chance(0.5))  // in the range of Z: nothing outside moves
  {
    VectorXd v(rank);
    for (int j = 0; j < rank; ++j)
      v[j] = number();
    q = Z * v;
  }
  return localProblem(Z * Z.transpose(), q, laws);
}
}  // namespace

TEST(EnumerationTest, PainlevesRodFollowsLemmas12And13)
{
  int regions[3] = {0, 0, 0};
  for (const double mu : {0.1, 0.5, 0.95, 1.3, 2.0, 4.0})
    for (double degrees = 4.0; degrees < 90.0; degrees += 6.0)
      for (const double support : {-2.0, -0.3, 0.3, 2.0})
      {
        const double angle = degrees * DEGREE;
        const bool steep = std::tan(angle) > mu;
        SCOPED_TRACE(std::to_string(degrees) + " degrees, mu " + std::to_string(mu) + ", u0 " +
                     std::to_string(support));
        const EnumerationReport up = enumerate(painleveRod(angle, mu, 1.0, support));
        const EnumerationReport down = enumerate(painleveRod(angle, mu, -1.0, support));
        EXPECT_TRUE(up.complete && down.complete);
        EXPECT_EQ(up.solutions, support > 0.0 && !steep ? 2 : 1);
        EXPECT_EQ(down.solutions, support < 0.0 || steep ? 1 : 0);
        EXPECT_EQ(up.continua + down.continua, 0);
        EXPECT_EQ(up.uniqueness, up.solutions == 2 ? Uniqueness::MULTIPLE : Uniqueness::UNIQUE_V);
        EXPECT_EQ(up.diagnosis, up.solutions == 2 ? "PAINLEVE_INDETERMINATE" : "NONE");
        EXPECT_EQ(down.diagnosis, down.solutions == 0 ? "PAINLEVE_INCONSISTENT" : "NONE");
        EXPECT_EQ(down.jamming.size(), steep ? 0U : 1U);
        ++regions[up.solutions];
        ++regions[down.solutions];
      }
  for (const int count : regions)
    EXPECT_GT(count, 20);
}

TEST(EnumerationTest, PainlevesSecondSolutionAndTheViolatedCriterion)
{
  // Section 3.4.4: (1.40) with tan(theta) < mu violates the criterion and has two solutions.
  const double angle = 30.0 * DEGREE, mu = 2.0;
  const IncrementalProblem rod = painleveRod(angle, mu, 1.0, 1.0);
  EXPECT_TRUE(checkExistence(rod).criterion_violated);
  const EnumerationReport report = enumerate(rod);
  ASSERT_EQ(report.families.size(), 2U);
  const double normal = std::tan(angle) / (mu - std::tan(angle));
  for (const SolutionFamily& family : report.families)
  {
    const bool takes_off = family.pieces.front().modes.front() == LawMode::OPEN;
    EXPECT_NEAR(family.representative.v[0], takes_off ? std::sin(angle) : 0.0, EXACT);
    EXPECT_LT((family.representative.r - (takes_off ? 0.0 : normal) * Eigen::Vector2d(1.0, -mu)).norm(), EXACT);
  }
}

TEST(EnumerationTest, ARodOnAStillSupportHasAContinuumOfImpulses)
{
  // sin r_N + cos r_T = sin within the cone: a segment where tan > mu, else a half line. Gravity upwards, tan < mu: a
  // half line of sticking impulses and the take-off, which the lemmas overlook.
  for (const double degrees : {20.0, 40.0, 70.0})
    for (const double mu : {0.5, 1.5})
    {
      const double angle = degrees * DEGREE;
      const bool steep = std::tan(angle) > mu;
      const EnumerationReport down = enumerate(painleveRod(angle, mu, -1.0, 0.0));
      EXPECT_TRUE(down.complete);
      EXPECT_EQ(down.solutions, 0);
      ASSERT_EQ(down.continua, 1);
      EXPECT_EQ(down.families.front().dimension, 1);
      EXPECT_EQ(down.families.front().bounded, steep);
      EXPECT_EQ(down.uniqueness, Uniqueness::UNIQUE_V);
      EXPECT_NEAR(down.families.front().representative.v[0], 0.0, EXACT);
      const EnumerationReport up = enumerate(painleveRod(angle, mu, 1.0, 0.0));
      EXPECT_EQ(up.solutions, 1);
      EXPECT_EQ(up.continua, steep ? 0 : 1);
      EXPECT_EQ(up.uniqueness, steep ? Uniqueness::UNIQUE_V : Uniqueness::MULTIPLE);
    }
}

TEST(EnumerationTest, TheSubsetSumMachineHasAsManySolutionsAsSubsets)
{
  Dice dice(3);
  for (const int k : {1, 2, 3, 4, 5, 6, 7, 8})
  {
    std::vector<double> values;
    for (int i = 0; i < k; ++i)
      values.push_back(dice.integer(1, 9));
    std::map<int, int> subsets;
    for (int subset = 0; subset < 1 << k; ++subset)
    {
      double sum = 0.0;
      for (int i = 0; i < k; ++i)
        sum += (subset >> i) % 2 == 1 ? values[static_cast<size_t>(i)] : 0.0;
      ++subsets[static_cast<int>(sum)];
    }
    const int most = subsets.rbegin()->first;
    for (const int total : {dice.integer(1, most), dice.integer(1, most), most, most + 1})
    {
      const IncrementalProblem machine = subsetSumMachine(values, total);
      const EnumerationReport report = enumerate(machine);
      SCOPED_TRACE("k = " + std::to_string(k) + ", sum " + std::to_string(total));
      EXPECT_TRUE(report.complete);
      EXPECT_EQ(report.solutions, subsets.count(total) > 0 ? subsets[total] : 0);
      EXPECT_EQ(report.continua, 0);
      expectSolutions(machine, report);
    }
  }
}

TEST(EnumerationTest, TheSquareRestsOnASegmentOfImpulses)
{
  // Figure 1.13: r = (1/2, s, 1/2, -s), |s| <= 1/2.
  const EnumerationReport report = enumerate(squareOnTwoContacts());
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.solutions, 0);
  ASSERT_EQ(report.continua, 1);
  const SolutionFamily& family = report.families.front();
  EXPECT_EQ(family.dimension, 1);
  EXPECT_TRUE(family.bounded && family.unique_velocity);
  EXPECT_EQ(report.uniqueness, Uniqueness::UNIQUE_V);
  EXPECT_TRUE(report.unique_impulses.empty());
  EXPECT_LT(family.representative.v.norm(), EXACT);
  ASSERT_EQ(family.pieces.size(), 1U);
  ASSERT_EQ(family.pieces.front().vertices.size(), 2U);
  for (const VectorXd& vertex : family.pieces.front().vertices)
  {
    EXPECT_NEAR(std::abs(vertex[1]), 0.5, EXACT);
    EXPECT_LT((vertex - Eigen::Vector4d(0.5, vertex[1], 0.5, -vertex[1])).norm(), EXACT);
  }
}

TEST(EnumerationTest, Example321HasOneSolutionNotTheFalseFixedPoint)
{
  const EnumerationReport report = enumerate(example321());
  EXPECT_TRUE(report.complete);
  ASSERT_EQ(report.solutions, 1);
  EXPECT_EQ(report.continua, 0);
  EXPECT_LT((report.families.front().representative.v - Eigen::Vector2d(0, -1)).norm(), EXACT);
  EXPECT_LT(report.families.front().representative.r.norm(), EXACT);
}

TEST(EnumerationTest, ASqueezedDiscMustPenetrate)
{
  const EnumerationReport report = enumerate(squeezedDisc(0.1, 0.5));
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.solutions + report.continua, 0);
  EXPECT_EQ(report.diagnosis, "PENETRATION");
  EXPECT_EQ(report.uniqueness, Uniqueness::UNKNOWN);
}

TEST(EnumerationTest, RandomProblemsHaveWhatEveryCombinationOfModesSays)
{
  // Thousands of draws, ranks from 1 to full; more contacts take 4^n looks each and are fewer.
  Dice dice(11);
  for (int draw = 0; draw < 3000 && !HasFatalFailure(); ++draw)
  {
    const int contacts = draw < 1500 ? dice.integer(1, 2) : draw < 2900 ? 3 : 4;
    const int limits = dice.chance(0.2) ? 1 : 0, dry = dice.chance(0.2) ? 1 : 0;
    const int rows = 2 * contacts + limits + dry;
    const int rank = dice.chance(0.6) ? dice.integer(1, rows) : rows;
    expectWhatEveryModeSays(randomPlanar(dice, contacts, limits, dry, rank), "draw " + std::to_string(draw));
  }
}

TEST(EnumerationTest, ManyContactsOnFewBodies)
{
  Dice dice(12);
  for (int draw = 0; draw < 6 && !HasFatalFailure(); ++draw)
    expectWhatEveryModeSays(randomPlanar(dice, 6, 0, 0, dice.integer(2, 6)), "draw " + std::to_string(draw));
}

TEST(EnumerationTest, UnitsAndOrderChangeNothing)
{
  Dice dice(13);
  for (int draw = 0; draw < 60; ++draw)
  {
    const DelassusProblem problem = randomPlanar(dice, 3, 1, 0, dice.integer(2, 7));
    const EnumerationReport expected = enumerate(problem);
    const double mass = dice.logUniform(1e-6, 1e6), speed = dice.logUniform(1e-6, 1e6);
    const EnumerationReport scaled =
        enumerate(localProblem(problem.W.toDense() / mass, speed * problem.q, problem.laws));
    EXPECT_EQ(scaled.solutions, expected.solutions) << draw;
    EXPECT_EQ(scaled.continua, expected.continua) << draw;
    EXPECT_EQ(scaled.uniqueness, expected.uniqueness) << draw;
    // The limit first, then the contacts: another tree.
    Eigen::PermutationMatrix<Eigen::Dynamic> order(7);
    order.indices() << 1, 2, 3, 4, 5, 6, 0;
    std::vector<Law> laws = problem.laws;
    std::rotate(laws.rbegin(), laws.rbegin() + 1, laws.rend());
    const MatrixXd W = order * problem.W.toDense() * order.transpose();
    const EnumerationReport turned = enumerate(localProblem(W, order * problem.q, laws));
    EXPECT_EQ(turned.solutions, expected.solutions) << draw;
    EXPECT_EQ(turned.continua, expected.continua) << draw;
  }
}

TEST(EnumerationTest, IslandsMultiply)
{
  // Two rods with two solutions each and a square with a continuum.
  const DelassusProblem rod = reduce(painleveRod(0.5, 2.0, 1.0, 1.0)), square = reduce(squareOnTwoContacts());
  MatrixXd W = MatrixXd::Zero(8, 8);
  W.block<2, 2>(0, 0) = W.block<2, 2>(2, 2) = rod.W.toDense();
  VectorXd q(8);
  q << rod.q, rod.q, square.q;
  std::vector<Law> laws = {rod.laws[0], rod.laws[0], square.laws[0], square.laws[1]};
  const DelassusProblem rods = localProblem(W.topLeftCorner<4, 4>(), q.head<4>(), {laws[0], laws[1]});
  EXPECT_EQ(enumerate(rods).solutions, 4);
  W.bottomRightCorner<4, 4>() = square.W.toDense();
  const DelassusProblem all = localProblem(W, q, laws);
  const EnumerationReport report = enumerate(all);
  EXPECT_EQ(report.solutions, 0);
  EXPECT_EQ(report.continua, 4);
  EXPECT_EQ(report.uniqueness, Uniqueness::MULTIPLE);
  EXPECT_LT(report.nodes, 60);
  expectSolutions(all, report);
  // One island without a solution is enough.
  q.head<2>() = reduce(painleveRod(0.5, 2.0, -1.0, 1.0)).q;
  const EnumerationReport none = enumerate(localProblem(W, q, laws));
  EXPECT_TRUE(none.complete);
  EXPECT_EQ(none.solutions + none.continua, 0);
}

TEST(EnumerationTest, BilateralRowsAreEliminatedAndContradictionsFound)
{
  // The rod between guides: a second velocity that bilateral rows, one of them twice, hold at 0 or move at 1.
  for (const double motion : {0.0, 1.0})
    for (const double angle : {0.4, 1.4})
    {
      IncrementalProblem rod = painleveRod(angle, 2.0, 1.0, 1.0);
      MatrixXd H(2, 2), G(2, 2);
      H << rod.H.toDense(), Eigen::Vector2d(0.0, 0.3);
      G << 0, 1, 0, 1;
      rod.M = sparse(MatrixXd::Identity(2, 2));
      rod.H = sparse(H);
      rod.f.conservativeResize(2);
      rod.f[1] = 0.2;
      rod.G = sparse(G);
      rod.b = Eigen::Vector2d(-motion, -motion);
      const EnumerationReport report = enumerate(rod);
      EXPECT_TRUE(report.complete);
      EXPECT_EQ(report.solutions, std::tan(angle) < 2.0 ? 2 : 1);
      expectSolutions(rod, report);
      DelassusReduction reduction;
      // The same as rows of a local problem.
      IncrementalProblem rows = rod;
      MatrixXd all(4, 2);
      all << H, G;
      rows.H = sparse(all);
      rows.w.conservativeResize(4);
      rows.w.tail<2>() = rod.b;
      rows.laws.insert(rows.laws.end(), 2, Law{LawType::BILATERAL, 0.0});
      rows.G.resize(0, 2);
      rows.b.resize(0);
      const DelassusProblem local = reduce(rows);
      const EnumerationReport same = enumerate(local);
      EXPECT_TRUE(same.complete);
      EXPECT_EQ(same.solutions, report.solutions);
      expectSolutions(local, same);
      rod.b[1] += 1.0;
      const EnumerationReport none = enumerate(rod);
      EXPECT_TRUE(none.complete);
      EXPECT_EQ(none.solutions + none.continua, 0);
      EXPECT_EQ(none.diagnosis, "BILATERALS_CONTRADICT");
    }
}

TEST(EnumerationTest, LimitsAreHonest)
{
  EnumerateOptions options;
  options.max_nodes = 20;
  const EnumerationReport cut = enumerate(subsetSumMachine({3, 5, 7, 9, 11}, 4), options);
  EXPECT_FALSE(cut.complete);
  EXPECT_EQ(cut.nodes, 20);
  EXPECT_EQ(cut.uniqueness, Uniqueness::UNKNOWN);
  const EnumerationReport stopped = enumerate(subsetSumMachine({3, 5}, 4), {}, [] { return true; });
  EXPECT_FALSE(stopped.complete);
  options.max_rows = 5;
  EXPECT_FALSE(enumerate(subsetSumMachine({3, 5, 7}, 8), options).complete);
  options.max_nodes = 0;
  EXPECT_THROW(enumerate(squareOnTwoContacts(), options), std::invalid_argument);
}

TEST(EnumerationTest, NoRowsNoImpulses)
{
  IncrementalProblem free = squareOnTwoContacts();
  free.H.resize(0, 3);
  free.w.resize(0);
  free.laws.clear();
  const EnumerationReport report = enumerate(free);
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.solutions, 1);
  EXPECT_EQ(report.uniqueness, Uniqueness::UNIQUE_V);
}

TEST(EnumerationInSpaceTest, OneContactHasOneSolutionWhereTheBlockIsDefinite)
{
  Dice dice(21);
  int slides = 0;
  for (int draw = 0; draw < 60; ++draw)
  {
    Eigen::Matrix3d A;
    for (int i = 0; i < 9; ++i)
      A(i / 3, i % 3) = dice.uniform(-1.0, 1.0);
    const Eigen::Matrix3d W = A * A.transpose() + Eigen::Matrix3d::Identity();  // little coupling: no jamming
    const Eigen::Vector3d q(dice.uniform(-1.0, 0.3), dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0));
    const DelassusProblem problem = localProblem(W, q, {{LawType::COULOMB_3D, 0.3}});
    const EnumerationReport report = enumerate(problem);
    EXPECT_TRUE(report.complete) << draw;
    EXPECT_EQ(report.solutions, 1) << draw;
    expectSolutions(problem, report, 1e-7);
    const SolverResult answer = createSolver("ac_newton")->solve(problem);
    ASSERT_EQ(answer.status, SolverStatus::CONVERGED);
    EXPECT_LT((answer.solution.r - report.families.front().representative.r).norm(), 1e-6) << draw;
    slides += report.families.front().pieces.front().modes.front() == LawMode::SLIDE ? 1 : 0;
  }
  EXPECT_GT(slides, 20);
}

TEST(EnumerationInSpaceTest, SeveralContactsAreProvedAndAgreeWithTheOtherMethods)
{
  int proved = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed)
  {
    RandomProblemOptions options;
    options.bodies = 2;
    options.contacts = 2;
    options.unilateral = static_cast<int>(seed % 2);
    options.dry = static_cast<int>(seed % 3 == 0);
    const IncrementalProblem problem = randomProblem(options, seed);
    const EnumerationReport report = enumerate(problem);
    proved += report.complete ? 1 : 0;
    EXPECT_TRUE(report.complete || report.unresolved > 0) << seed << ": " << report.message;
    expectSolutions(problem, report);
    const SolverResult answer = createSolver("portfolio")->solve(problem);
    ASSERT_EQ(answer.status, SolverStatus::CONVERGED);
    EXPECT_TRUE(std::any_of(report.families.begin(), report.families.end(),
                            [&](const SolutionFamily& family)
                            { return (family.representative.v - answer.solution.v).norm() < 1e-5; }))
        << seed;
  }
  EXPECT_GE(proved, 10);  // the others leave wedges of min_angle that neither proof closes
}

TEST(EnumerationInSpaceTest, ThePlanarRodInSpace)
{
  // The second tangent moves nothing but a mass of its own: the counts of the plane, and the same proofs.
  for (const double gravity : {1.0, -1.0})
    for (const double degrees : {20.0, 50.0, 80.0})
      for (const double mu : {0.6, 2.0})
      {
        const IncrementalProblem planar = painleveRod(degrees * DEGREE, mu, gravity, 1.0);
        MatrixXd H = MatrixXd::Zero(3, 2);
        H.block<2, 1>(0, 0) = planar.H.toDense();
        H(2, 1) = 1.0;
        const IncrementalProblem rod =
            denseProblem(MatrixXd::Identity(2, 2), Eigen::Vector2d(planar.f[0], 0.0), H,
                         Eigen::Vector3d(planar.w[0], planar.w[1], 0.0), {{LawType::COULOMB_3D, mu}});
        const EnumerationReport report = enumerate(rod);
        EXPECT_TRUE(report.complete);
        EXPECT_EQ(report.solutions, enumerate(planar).solutions) << gravity << ' ' << degrees << ' ' << mu;
        EXPECT_EQ(report.continua, 0);
        expectSolutions(rod, report);
      }
}

TEST(EnumerationInSpaceTest, ARestingBoxIsOneConvexSet)
{
  const EnumerationReport report = enumerate(restingBox(10, {0.5, 0.3, 0.2}, 0.5, {0, 0, 0}, {0, 0, -9.81}, 1e-3));
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.solutions, 0);
  ASSERT_EQ(report.continua, 1);
  EXPECT_EQ(report.families.front().dimension, 6);  // 12 impulses, rank 6
  EXPECT_TRUE(report.families.front().bounded);
  EXPECT_EQ(report.uniqueness, Uniqueness::UNIQUE_V);
  EXPECT_LT(report.families.front().representative.v.norm(), EXACT);
}

TEST(EnumerateSolverTest, SaysThatThereIsNoSolution)
{
  const std::unique_ptr<Solver> solver = createSolver("enumerate");
  for (const IncrementalProblem& problem : {painleveRod(0.5, 2.0, -1.0, 1.0), subsetSumMachine({3, 5, 7}, 4)})
  {
    const SolverResult result = solver->solve(problem);
    EXPECT_EQ(result.status, SolverStatus::STAGNATED);
    EXPECT_NE(result.message.find("no solution exists"), std::string::npos) << result.message;
  }
  EXPECT_EQ(solver->solve(subsetSumMachine({3, 5, 7}, 12)).status, SolverStatus::CONVERGED);
}

TEST(EnumerateSolverTest, ThePortfolioEndsInIt)
{
  // Nothing else solves the subset-sum machine from a cold start.
  const SolverResult result = createSolver("portfolio")->solve(subsetSumMachine({3, 5, 7}, 12));
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message;
  EXPECT_EQ(result.solver, "enumerate");
  const SolverResult none = createSolver("portfolio")->solve(painleveRod(0.5, 2.0, -1.0, 1.0));
  EXPECT_NE(none.status, SolverStatus::CONVERGED);
  EXPECT_NE(none.message.find("no solution exists"), std::string::npos) << none.message;
}
