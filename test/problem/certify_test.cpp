/**
 * @file certify_test.cpp
 * @brief The facts of Cadoux (2009), 3.4, every proof of certify() checked once more in long double, and random
 * problems with rank-deficient kinematics, bilateral rows and one-dimensional laws.
 */
#include "frictional_contact_sim/problem/certificate/certify.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "frictional_contact_sim/problem/certificate/fixed_point_check.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
using Long = long double;
using LongVector = Eigen::Matrix<Long, Eigen::Dynamic, 1>;
using LongMatrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
using Random = std::mt19937;

double normal(Random& random)
{
  return std::normal_distribution<double>()(random);
}

Eigen::MatrixXd gauss(Eigen::Index rows, Eigen::Index columns, Random& random)
{
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&](auto, auto) { return normal(random); });
}

/** Largest violation of H v + w in L*, G v + b = 0, in units of round-off of what goes into each row. */
Long violation(const IncrementalProblem& problem, const Eigen::VectorXd& v)
{
  const LongVector speed = v.cast<Long>();
  const LongMatrix H = Eigen::MatrixXd(problem.H).cast<Long>();
  const LongMatrix G = Eigen::MatrixXd(problem.G).cast<Long>();
  const LongVector u = H * speed + problem.w.cast<Long>();
  const LongVector size = H.cwiseAbs() * speed.cwiseAbs() + problem.w.cwiseAbs().cast<Long>();
  Long worst = 0.0L;
  const auto judge = [&](Long missing, Long scale)
  {
    if (missing > 0.0L)
      worst = std::max(worst, missing / (DBL_EPSILON * scale + 1e-300L));
  };
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const Long mu = law.isCoulomb() ? law.coefficient : 0.0L;
    const int d = law.dimension();
    if (law.isOneSided())
      judge(mu * u.segment(row + 1, d - 1).norm() - u[row], size[row] + mu * size.segment(row + 1, d - 1).sum());
    else if (law.type == LawType::BILATERAL)
      judge(std::abs(u[row]), size[row]);
    row += d;
  }
  const LongVector closure = G * speed + problem.b.cast<Long>();
  const LongVector closure_size = G.cwiseAbs() * speed.cwiseAbs() + problem.b.cwiseAbs().cast<Long>();
  for (Eigen::Index k = 0; k < closure.size(); ++k)
    judge(std::abs(closure[k]), closure_size[k]);
  return worst;
}

/** Whether r_N >= 0 with H_N^T r_N + G^T lambda = 0 and a negative power says that every velocity penetrates. */
bool refutes(const IncrementalProblem& problem, const Certificate& certificate)
{
  LongVector balance = LongVector::Zero(problem.velocities());
  Long power = 0.0L;
  const LongMatrix H = Eigen::MatrixXd(problem.H).cast<Long>();
  const LongMatrix G = Eigen::MatrixXd(problem.G).cast<Long>();
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const Eigen::VectorXd r = certificate.multiplier.segment(row, law.dimension());
    if (law.type == LawType::DRY_FRICTION && r[0] != 0.0)
      return false;
    if (law.isOneSided() && (r[0] < 0.0 || !r.tail(law.dimension() - 1).isZero(0.0)))
      return false;
    balance += H.row(row).transpose() * static_cast<Long>(r[0]);
    power += static_cast<Long>(r[0]) * problem.w[row];
    row += law.dimension();
  }
  for (int k = 0; k < problem.bilaterals(); ++k)
  {
    balance += G.row(k).transpose() * static_cast<Long>(certificate.bilateral_multiplier[k]);
    power += static_cast<Long>(certificate.bilateral_multiplier[k]) * problem.b[k];
  }
  return power < 0.0L && balance.lpNorm<1>() * 1e6L <= -power;
}

void expectProof(const IncrementalProblem& problem, const Certificate& certificate)
{
  if (certificate.existence == Existence::CERTIFIED)
  {
    ASSERT_EQ(certificate.v.size(), problem.velocities());
    // Twice: bilateral rows are met to round-off, which the margin of the certificate has paid for.
    EXPECT_LE(violation(problem, certificate.v), 2.0L * ROUND_OFF_UNITS) << certificate.message;
  }
  if (certificate.existence == Existence::REFUTED)
  {
    EXPECT_TRUE(refutes(problem, certificate)) << certificate.message;
    EXPECT_FALSE(certificate.blocking.empty() && certificate.blocking_bilaterals.empty());
  }
}

struct RandomKinematics
{
  int velocities = 6, planar = 2, spatial = 2, limits = 1, dry = 1, bilaterals = 1;
  int rank = 0;  ///< of the contact rows at most, 0: whatever comes
  bool rigid = false;  ///< w = H v_0, b = G v_0
};

IncrementalProblem randomKinematics(const RandomKinematics& what, Random& random,
                                    Eigen::VectorXd* surroundings = nullptr)
{
  std::vector<Law> laws;
  std::uniform_real_distribution<double> friction(0.0, 1.2);
  for (int i = 0; i < what.planar; ++i)
    laws.push_back({LawType::COULOMB_2D, friction(random)});
  for (int i = 0; i < what.spatial; ++i)
    laws.push_back({LawType::COULOMB_3D, friction(random)});
  for (int i = 0; i < what.limits; ++i)
    laws.push_back({LawType::UNILATERAL, 0.0});
  for (int i = 0; i < what.dry; ++i)
    laws.push_back({LawType::DRY_FRICTION, friction(random)});
  std::shuffle(laws.begin(), laws.end(), random);
  const int rows = rowCount(laws);
  Eigen::MatrixXd H = what.rank > 0
                          ? (gauss(rows, what.rank, random) * gauss(what.rank, what.velocities, random)).eval()
                          : gauss(rows, what.velocities, random);
  IncrementalProblem problem = kinematics(H, gauss(rows, 1, random), laws);
  problem.G = sparse(gauss(what.bilaterals, what.velocities, random));
  problem.b = 0.1 * gauss(what.bilaterals, 1, random);
  const Eigen::VectorXd motion = gauss(what.velocities, 1, random);
  if (what.rigid)
  {
    problem.w = problem.H * motion;
    problem.b = problem.G * motion;
  }
  if (surroundings != nullptr)
    *surroundings = motion;
  return problem;
}
}  // namespace

TEST(CertifyTest, SurroundingsThatMoveAsOneRigidBodyAreCertifiedByTheSameMotion)
{
  Random random(11);
  int followed = 0;
  for (int draw = 0; draw < 40; ++draw)
  {
    RandomKinematics what;
    what.rigid = true;
    what.planar = 1 + draw % 4;
    what.spatial = draw % 5;
    Eigen::VectorXd motion;
    const IncrementalProblem problem = randomKinematics(what, random, &motion);
    CertifyOptions options;
    options.margin = false;
    const Certificate certificate = certify(problem, options);
    ASSERT_EQ(certificate.existence, Existence::CERTIFIED) << "draw " << draw << ": " << certificate.message;
    expectProof(problem, certificate);
    const Eigen::VectorXd sizes = problem.H.cwiseAbs() * motion.cwiseAbs();
    if (certificate.exact)
      continue;  // another velocity has room
    ++followed;
    EXPECT_LE((problem.H * (certificate.v + motion)).lpNorm<Eigen::Infinity>(), 1e-12 * sizes.maxCoeff());
    if (draw % 5 > 1)  // more rows than velocities: the motion itself
    {
      EXPECT_LE((certificate.v + motion).lpNorm<Eigen::Infinity>(), 1e-11 * motion.norm());
    }
  }
  EXPECT_GT(followed, 10);
}

TEST(CertifyTest, FullRowRankIsCertifiedForEveryFrictionAndEveryMotionOutside)
{
  Random random(12);
  for (const double mu : {0.0, 0.3, 1.0, 10.0, 1000.0})
    for (const int dimension : {2, 3})
    {
      const int contacts = 3;
      const std::vector<Law> laws(contacts, {dimension == 2 ? LawType::COULOMB_2D : LawType::COULOMB_3D, mu});
      const Eigen::MatrixXd H = gauss(contacts * dimension, contacts * dimension + 2, random);
      CertifyOptions options;
      options.klarbring_pang = true;
      const IncrementalProblem problem = kinematics(H, 5.0 * gauss(H.rows(), 1, random), laws);
      const Certificate certificate = certify(problem, options);
      EXPECT_EQ(certificate.existence, Existence::CERTIFIED) << dimension << "D, mu " << mu;
      EXPECT_TRUE(certificate.exact);
      EXPECT_TRUE(certificate.unconditional);  // (3.33) implies (3.34)
      EXPECT_EQ(certificate.rank, H.rows());
      EXPECT_GT(certificate.margin, 0.0);
      expectProof(problem, certificate);
      expectProof(problem, certify(reduce(problem)).existence == Existence::CERTIFIED ? certificate : Certificate());
      EXPECT_EQ(certify(reduce(problem)).existence, Existence::CERTIFIED);
    }
}

TEST(CertifyTest, ADeformableBodyWithOneContactANodeIsCertifiedForEveryFriction)
{
  // Nodes of a chain with three coordinates each (3.4.7): contact rows are the nodes' own.
  const int nodes = 5;
  Random random(13);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3 * nodes, 3 * (nodes + 1));
  for (int i = 0; i < nodes; ++i)
    H.block<3, 3>(3 * i, 3 * i) = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
  for (const double mu : {0.1, 1.0, 50.0})
  {
    const Certificate certificate =
        certify(kinematics(H, 3.0 * gauss(3 * nodes, 1, random), std::vector<Law>(nodes, {LawType::COULOMB_3D, mu})));
    EXPECT_EQ(certificate.existence, Existence::CERTIFIED) << "mu " << mu;
    EXPECT_EQ(certificate.islands.size(), static_cast<size_t>(nodes));
  }
}

TEST(CertifyTest, ASqueezedDiscIsRefutedAndBothContactsAreNamed)
{
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(9, 6);  // contact 0 is another body's
  H.block<3, 3>(0, 3).setIdentity();
  H.block<6, 3>(3, 0) << 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Eigen::VectorXd w = Eigen::VectorXd::Zero(9);
  w[6] = -1.0;
  for (const double mu : {0.0, 0.5, 10.0})
  {
    const IncrementalProblem problem = kinematics(H, w, std::vector<Law>(3, {LawType::COULOMB_3D, mu}));
    const Certificate certificate = certify(problem);
    EXPECT_EQ(certificate.existence, Existence::REFUTED);
    EXPECT_EQ(certificate.blocking, (std::vector<int>{1, 2}));
    EXPECT_NEAR(certificate.margin, -0.5, 1e-8);  // half of the closing speed on either side
    EXPECT_EQ(certificate.islands.size(), 2u);
    EXPECT_EQ(certificate.islands[0].existence.verdict, Existence::CERTIFIED);
    expectProof(problem, certificate);
  }
}

TEST(CertifyTest, ContradictingBilateralRowsAreRefutedAndNamed)
{
  IncrementalProblem problem =
      kinematics(Eigen::MatrixXd::Identity(3, 3), Eigen::Vector3d::Zero(), {{LawType::COULOMB_3D, 0.5}});
  Eigen::MatrixXd G(3, 3);
  G << 0, 0, 1, 1, 1, 0, 2, 2, 0;
  problem.G = sparse(G);
  problem.b = Eigen::Vector3d(0.3, 0.1, 0.2);
  EXPECT_NE(certify(problem).existence, Existence::REFUTED);
  problem.b[2] = -0.2;
  const Certificate certificate = certify(problem);
  EXPECT_EQ(certificate.existence, Existence::REFUTED);
  EXPECT_EQ(certificate.blocking_bilaterals, (std::vector<int>{1, 2}));
  EXPECT_TRUE(certificate.blocking.empty());
  expectProof(problem, certificate);
}

TEST(CertifyTest, PainlevesRodViolatesTheCriterionAndStillHasTwoSolutions)
{
  for (const double theta : {0.3, 0.7, 1.0})
  {
    const double mu = 1.3 * std::tan(theta);
    const IncrementalProblem up = painleveRod(theta, mu, 1.0, 1.0);  // (1.40)
    const Certificate certificate = certify(up);
    EXPECT_EQ(certificate.existence, Existence::UNDECIDED);
    EXPECT_TRUE(certificate.islands[0].existence.criterion_violated);
    EXPECT_NEAR(certificate.margin, -std::tan(theta), 1e-8);  // (3.4.3)
    // Lemma 1.2: take-off, and sliding with r_y = tan/(mu - tan); both are solutions by checkFixedPoint.
    for (const double v : {std::sin(theta), 0.0})
      EXPECT_TRUE(checkFixedPoint(up, Eigen::VectorXd::Constant(1, v)).is_solution) << v;
    EXPECT_FALSE(checkFixedPoint(up, Eigen::VectorXd::Constant(1, 0.5 * std::sin(theta))).is_fixed_point);
    // Gravity down, the same kinematics, no solution (lemma 1.3): neither candidate is one.
    const IncrementalProblem down = painleveRod(theta, mu, -1.0, 1.0);
    for (const double v : {-std::sin(theta), 0.0})
      EXPECT_FALSE(checkFixedPoint(down, Eigen::VectorXd::Constant(1, v)).is_solution) << v;
  }
}

TEST(CertifyTest, Example321IsAFixedPointWithoutAnImpulse)
{
  const IncrementalProblem problem = example321();
  EXPECT_EQ(certify(problem).existence, Existence::CERTIFIED);
  const FixedPointReport trap = checkFixedPoint(problem, Eigen::Vector2d::Zero());
  EXPECT_TRUE(trap.is_fixed_point) << trap.descent;
  EXPECT_FALSE(trap.qualified) << trap.qualification;
  EXPECT_FALSE(trap.is_solution) << trap.least_impulse;
  EXPECT_EQ(trap.unqualified, (std::vector<int>{0}));
  const FixedPointReport answer = checkFixedPoint(problem, Eigen::Vector2d(0.0, -1.0));
  EXPECT_TRUE(answer.is_solution) << answer.verdict();
  EXPECT_TRUE(answer.qualified);  // s = 1 > 0
}

TEST(CertifyTest, AnswersOfTheSolversAreFixedPointsWithTheirImpulse)
{
  int sticking = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed)
  {
    RandomProblemOptions options;
    options.planar_contacts = static_cast<int>(seed % 3);
    options.unilateral = options.dry = static_cast<int>(seed % 2);
    options.bilaterals = static_cast<int>(seed % 4);
    options.moving_externals = seed % 2 == 0;
    const IncrementalProblem problem = randomProblem(options, seed);
    const SolverResult result = createSolver("portfolio")->solve(problem);
    ASSERT_EQ(result.status, SolverStatus::CONVERGED);
    const FixedPointReport report = checkFixedPoint(problem, result.solution.v);
    EXPECT_TRUE(report.is_solution) << "seed " << seed << ": " << report.verdict() << ", descent " << report.descent
                                    << ", penetration " << report.penetration;
    double normals = 0.0;
    int row = 0;
    for (const Law& law : problem.laws)
    {
      normals += law.isOneSided() ? result.solution.r[row] : 0.0;
      sticking += law.isCoulomb() && result.solution.r[row] > 1e-6 &&
                  result.solution.u.segment(row, law.dimension()).norm() < 1e-9;
      row += law.dimension();
    }
    EXPECT_LE(report.least_impulse, normals * (1.0 + 1e-5) + 1e-6) << "seed " << seed;
    // Not so once the velocity is another one.
    Eigen::VectorXd other = result.solution.v;
    other[0] += 0.01 * (1.0 + other.norm());
    EXPECT_FALSE(checkFixedPoint(problem, other).is_fixed_point) << "seed " << seed;
  }
  EXPECT_GT(sticking, 0);
}

TEST(CertifyTest, EveryVerdictOnRandomProblemsSurvivesAnIndependentCheck)
{
  Random random(14);
  int certified = 0, refuted = 0, violated = 0, boundary = 0;
  for (int draw = 0; draw < 400; ++draw)
  {
    RandomKinematics what;
    what.velocities = 3 + draw % 5;
    what.planar = draw % 3;
    what.spatial = (draw / 3) % 4;
    what.limits = draw % 4;
    what.dry = draw % 2;
    what.bilaterals = draw % 3;
    what.rank = draw % 2 == 0 ? 0 : 2 + draw % 3;
    what.rigid = draw % 7 == 0;
    const IncrementalProblem problem = randomKinematics(what, random);
    CertifyOptions options;
    options.klarbring_pang = draw % 2 == 1;
    const Certificate certificate = certify(problem, options);
    SCOPED_TRACE(testing::Message() << "draw " << draw);
    expectProof(problem, certificate);
    certified += certificate.existence == Existence::CERTIFIED;
    refuted += certificate.existence == Existence::REFUTED;
    boundary += certificate.existence == Existence::CERTIFIED && !certificate.exact;
    if (what.rigid)
    {
      EXPECT_EQ(certificate.existence, Existence::CERTIFIED);
    }
    for (const IslandCertificate& island : certificate.islands)
    {
      violated += island.existence.criterion_violated;
      EXPECT_LE(island.margin, island.upper_bound + 1e-7 * (1.0 + std::abs(island.upper_bound)));
      if (!options.klarbring_pang)
        continue;
      const KlarbringPangReport& condition = island.klarbring_pang;
      EXPECT_LE(condition.lower, condition.upper + 1e-7 * (1.0 + std::abs(condition.upper)));
      // Theorem 3.1 and the criterion are the same question, asked from both sides.
      if (condition.unconditional || condition.lower > 1e-9)
      {
        EXPECT_EQ(island.existence.verdict, Existence::CERTIFIED);
      }
      if (condition.upper < -1e-6)
      {
        EXPECT_NE(island.existence.verdict, Existence::CERTIFIED);
        EXPECT_TRUE(island.existence.criterion_violated);
      }
      if (std::isfinite(condition.upper))
      {
        EXPECT_NEAR(condition.lower, condition.upper, 1e-4 * (1.0 + std::abs(condition.upper)));
      }
    }
  }
  EXPECT_GT(certified, 100);
  EXPECT_GT(refuted, 20);
  EXPECT_GT(violated, 40);
  EXPECT_GT(boundary, 10);
}

TEST(CertifyTest, TheMarginIsTheBestOfADenseSampleOfVelocities)
{
  Random random(15);
  for (int draw = 0; draw < 12; ++draw)
  {
    RandomKinematics what;
    what.velocities = 2;
    what.planar = draw % 2;
    what.spatial = 1;
    what.limits = draw % 2;
    what.dry = what.bilaterals = 0;
    const IncrementalProblem problem = randomKinematics(what, random);
    CertifyOptions options;
    options.bound = 1.5;
    const Certificate certificate = certify(problem, options);
    const Eigen::MatrixXd H = problem.H;
    double best = -1e300;
    const int count = 101;
    for (int i = 0; i < count * count; ++i)
    {
      const Eigen::Vector2d v(-1.5 + 3.0 * (i % count) / (count - 1), -1.5 + 3.0 * (i / count) / (count - 1));
      const Eigen::VectorXd u = H * v + problem.w;
      double margin = 1e300;
      int row = 0;
      for (const Law& law : problem.laws)
      {
        margin = std::min(margin, u[row] - law.coefficient * u.segment(row + 1, law.dimension() - 1).norm());
        row += law.dimension();
      }
      best = std::max(best, margin);
    }
    // The grid is 0.03 wide and |grad| at most |H|(1 + mu): what it may miss.
    EXPECT_GE(certificate.margin, best - 2e-3 * (1.0 + std::abs(best))) << "draw " << draw;
    EXPECT_LE(certificate.margin, best + 0.03 * 2.2 * H.cwiseAbs().rowwise().sum().maxCoeff()) << "draw " << draw;
  }
}

TEST(ConditioningTest, RankAndConditionAreThoseOfASingularValueDecomposition)
{
  Random random(16);
  for (const int rank : {0, 3, 5})
  {
    RandomKinematics what;
    what.velocities = 9;
    what.rank = rank;
    what.bilaterals = 0;
    IncrementalProblem problem = randomKinematics(what, random);
    const Eigen::MatrixXd A = gauss(9, 9, random);
    const Eigen::MatrixXd M = A * A.transpose() + Eigen::MatrixXd::Identity(9, 9);
    problem.M = sparse(M);
    const Eigen::MatrixXd H = problem.H;
    const Eigen::MatrixXd W = H * M.inverse() * H.transpose();
    const Eigen::VectorXd values = W.selfadjointView<Eigen::Lower>().eigenvalues();
    const Conditioning found = conditioning(problem);
    const int expected = rank > 0 ? rank : std::min<int>(problem.rows(), 9);
    EXPECT_EQ(found.rank, expected);
    EXPECT_NEAR(found.condition, values.maxCoeff() / values[values.size() - expected], 1e-6 * found.condition);
    EXPECT_EQ(conditioning(reduce(problem)).rank, expected);
  }
  EXPECT_EQ(conditioning(restingBox(2.0, {0.1, 0.2, 0.3}, 0.7, Eigen::Vector3d::Zero(), {0, 0, -9.81}, 1e-3)).rank, 6);
}

TEST(CertifyTest, AMatrixThatIsNoDelassusMatrixIsNotCertified)
{
  Eigen::Matrix3d W;
  W << 1, 0, 0, 0, 1, 0.5, 0, -0.5, 1;
  const DelassusProblem skew = localProblem(W, Eigen::Vector3d(-1, 0, 0), {{LawType::COULOMB_3D, 0.5}});
  EXPECT_EQ(certify(skew).existence, Existence::UNDECIDED);
  const DelassusProblem indefinite =
      localProblem(Eigen::Vector3d(1, -1, 1).asDiagonal(), Eigen::Vector3d(-1, 0, 0), {{LawType::COULOMB_3D, 0.5}});
  EXPECT_EQ(certify(indefinite).existence, Existence::UNDECIDED);
  const DelassusProblem blocked =
      localProblem(Eigen::Vector3d(0, 1, 1).asDiagonal(), Eigen::Vector3d(-1, 0, 0), {{LawType::COULOMB_3D, 0.5}});
  EXPECT_EQ(certify(blocked).existence, Existence::REFUTED);
}
