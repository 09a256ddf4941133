/**
 * @file enumeration_cuts_test.cpp
 * @brief Eight contacts in 2D, all 4^8 combinations of modes looked at by elimination; and the search with cuts, which
 * must find what the search without finds.
 */
#include <gtest/gtest.h>

#include <map>

#include "frictional_contact_sim/solver/enumeration/enumeration.h"
#include "mode_check.h"
#include "support/dice.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
/// Pivots below this, over the largest |W|, are zero. A wrong guess shows: an answer too many or too few.
constexpr double SINGULAR = 1e-9;

struct PlanarProblem
{
  MatrixXd W;
  VectorXd q, friction;

  int contacts() const { return static_cast<int>(friction.size()); }
  DelassusProblem delassus() const
  {
    std::vector<Law> laws;
    for (const double mu : friction)
      laws.push_back({LawType::COULOMB_2D, mu});
    return localProblem(W, q, laws);
  }
};

/// Generic numbers: a combination with as many equations as unknowns has one answer, one with dependent equations none.
PlanarProblem randomProblem(Dice& dice, int contacts, int rank)
{
  PlanarProblem problem = {MatrixXd(2 * contacts, rank), VectorXd(2 * contacts), VectorXd(contacts)};
  for (int i = 0; i < 2 * contacts; ++i)
    for (int j = 0; j < rank; ++j)
      problem.W(i, j) = dice.uniform(-1.0, 1.0);
  problem.W = (problem.W * problem.W.transpose()).eval();
  for (int i = 0; i < 2 * contacts; ++i)
    problem.q[i] = dice.uniform(-1.0, 1.0);
  for (int i = 0; i < contacts; ++i)
    problem.friction[i] = dice.uniform(0.2, 2.0);
  return problem;
}

/**
 * Every combination, depth first: the unknowns of a contact (two where it sticks, one where it slides, r_T = s mu r_N,
 * none where it is open) are added to a triangular factor that the combinations below share (Doolittle, no row
 * exchanges: equations and unknowns come in pairs).
 */
class EveryCombination
{
public:
  explicit EveryCombination(const PlanarProblem& problem)
    : problem_(problem), size_(problem.W.cwiseAbs().maxCoeff()), modes_(static_cast<size_t>(problem.contacts()), 0)
  {
    descend(0);
  }
  const std::vector<VectorXd>& solutions() const { return solutions_; }
  long combinations() const { return combinations_; }
  bool ambiguous() const { return ambiguous_; }

private:
  /// An unknown of contact c is r_c = value (1, s mu) with equation u_N, or (for stick) each component with its own.
  struct Unknown
  {
    int row;  ///< of its equation
    VectorXd column;  ///< W times its unit of impulse
    VectorXd unit;
  };

  void descend(int contact)
  {
    if (contact == problem_.contacts())
    {
      ++combinations_;
      check();
      return;
    }
    for (int mode = 0; mode < 4; ++mode)  // open, stick, right, left
    {
      modes_[static_cast<size_t>(contact)] = mode;
      const size_t before = unknowns_.size();
      bool regular = true;
      if (mode == 1)
        regular = add(contact, 0, 1.0, 0.0) && add(contact, 1, 0.0, 1.0);
      else if (mode > 1)
        regular = add(contact, 0, 1.0, (mode == 2 ? -1.0 : 1.0) * problem_.friction[contact]);
      if (regular)
        descend(contact + 1);
      else
        combinations_ += 1L << (2 * (problem_.contacts() - contact - 1));
      unknowns_.resize(before);
      lower_.resize(before);
      upper_.resize(before);
      right_.resize(before);
    }
  }

  /** A row of L, a column of U, and the eliminated right-hand side. @return false when the pivot is zero */
  bool add(int contact, int equation, double normal, double tangential)
  {
    Unknown next = {2 * contact + equation, {}, VectorXd::Zero(problem_.q.size())};
    next.unit[2 * contact] = normal;
    next.unit[2 * contact + 1] = tangential;
    next.column = problem_.W * next.unit;
    const size_t k = unknowns_.size();
    std::vector<double> lower(k), upper(k + 1);
    for (size_t j = 0; j < k; ++j)
    {
      lower[j] = unknowns_[j].column[next.row];
      upper[j] = next.column[unknowns_[j].row];
      for (size_t i = 0; i < j; ++i)
      {
        lower[j] -= lower[i] * upper_[j][i];
        upper[j] -= lower_[j][i] * upper[i];
      }
      lower[j] /= upper_[j][j];
    }
    upper[k] = next.column[next.row];
    double right = -problem_.q[next.row];
    for (size_t i = 0; i < k; ++i)
    {
      upper[k] -= lower[i] * upper[i];
      right -= lower[i] * right_[i];
    }
    if (std::abs(upper[k]) <= SINGULAR * size_)
      return false;
    unknowns_.push_back(std::move(next));
    lower_.push_back(std::move(lower));
    upper_.push_back(std::move(upper));
    right_.push_back(right);
    return true;
  }

  void check()
  {
    VectorXd r = VectorXd::Zero(problem_.q.size()), u = problem_.q;
    std::vector<double> x(unknowns_.size());
    for (size_t k = unknowns_.size(); k-- > 0;)
    {
      double value = right_[k];
      for (size_t j = k + 1; j < unknowns_.size(); ++j)
        value -= upper_[j][k] * x[j];
      x[k] = value / upper_[k][k];
      r += x[k] * unknowns_[k].unit;
      u += x[k] * unknowns_[k].column;
    }
    for (int i = 0; i < problem_.contacts(); ++i)
    {
      const int mode = modes_[static_cast<size_t>(i)];
      if ((mode == 0 && u[2 * i] < 0.0) || (mode > 0 && r[2 * i] < 0.0) ||
          (mode == 1 && std::abs(r[2 * i + 1]) > problem_.friction[i] * r[2 * i]) ||
          (mode == 2 && u[2 * i + 1] < 0.0) || (mode == 3 && u[2 * i + 1] > 0.0))
        return;
    }
    // The eliminated equations themselves: pivots without exchanges may have lost digits.
    for (const Unknown& unknown : unknowns_)
      ambiguous_ = ambiguous_ || std::abs(u[unknown.row]) > 1e-7 * (1.0 + r.norm());
    solutions_.push_back(r);
  }

  const PlanarProblem& problem_;
  double size_;
  std::vector<int> modes_;
  std::vector<Unknown> unknowns_;
  std::vector<std::vector<double>> lower_, upper_;
  std::vector<double> right_;
  std::vector<VectorXd> solutions_;
  long combinations_ = 0;
  bool ambiguous_ = false;
};

void expectTheSame(const EnumerationReport& report, const std::vector<VectorXd>& solutions)
{
  EXPECT_TRUE(report.complete) << report.message;
  EXPECT_EQ(report.continua, 0);
  EXPECT_EQ(report.solutions, static_cast<int>(solutions.size()));
  for (const VectorXd& r : solutions)
  {
    double nearest = std::numeric_limits<double>::infinity();
    for (const SolutionFamily& family : report.families)
      nearest = std::min(nearest, (family.representative.r - r).norm() / (1.0 + r.norm()));
    EXPECT_LT(nearest, 1e-6) << r.transpose();
  }
}

EnumerateOptions withCuts(EnumerationCuts cuts, int depth, int rounds)
{
  EnumerateOptions options;
  options.cuts = cuts;
  options.cut_depth = depth;
  options.cuts_per_node = rounds;
  return options;
}
}  // namespace

TEST(EnumerationTest, EightContactsHaveWhatAll65536CombinationsSay)
{
  Dice dice(21);
  std::map<size_t, int> counts;
  for (int draw = 0; draw < 40; ++draw)
  {
    SCOPED_TRACE(draw);
    const PlanarProblem problem = randomProblem(dice, 8, draw % 4 == 0 ? 16 : dice.integer(4, 15));
    const EveryCombination every(problem);
    EXPECT_EQ(every.combinations(), 65536);
    ASSERT_FALSE(every.ambiguous());
    expectTheSame(enumerate(problem.delassus()), every.solutions());
    ++counts[std::min<size_t>(every.solutions().size(), 2)];
  }
  for (size_t count = 0; count < 3; ++count)  // none, one, several
    EXPECT_GT(counts[count], 0) << count;
}

TEST(EnumerationCutsTest, FindWhatTheSearchWithoutThemFinds)
{
  Dice dice(22);
  long cuts = 0, fewer = 0;
  for (int draw = 0; draw < 30; ++draw)
  {
    SCOPED_TRACE(draw);
    const PlanarProblem problem = randomProblem(dice, 5, draw % 3 == 0 ? 10 : dice.integer(3, 9));
    const EveryCombination every(problem);
    ASSERT_FALSE(every.ambiguous());
    const EnumerationReport without = enumerate(problem.delassus());
    EXPECT_EQ(without.cuts, 0);
    for (const EnumerationCuts kind :
         {EnumerationCuts::MOST_VIOLATED, EnumerationCuts::DEEPEST, EnumerationCuts::FACETS})
    {
      const EnumerationReport report = enumerate(problem.delassus(), withCuts(kind, 2, 3));
      expectTheSame(report, every.solutions());
      cuts += report.cuts;
      fewer += report.nodes < without.nodes ? 1 : 0;
    }
  }
  EXPECT_GT(cuts, 50);
  EXPECT_GT(fewer, 10);
}

TEST(EnumerationCutsTest, KeepContinuaJointLimitsAndDryFriction)
{
  // The judge of enumeration_test: every combination by itself, continua as hulls of their vertices.
  Dice dice(23);
  for (int draw = 0; draw < 60; ++draw)
  {
    SCOPED_TRACE(draw);
    const std::vector<Law> laws = {{LawType::COULOMB_2D, dice.uniform(0.1, 2.0)},
                                   {LawType::COULOMB_2D, 1.0},
                                   {LawType::UNILATERAL, 0.0},
                                   {LawType::DRY_FRICTION, dice.uniform(0.1, 1.0)}};
    const int rank = dice.integer(2, 6);
    MatrixXd Z(6, rank);
    VectorXd v(rank);
    for (int j = 0; j < rank; ++j)
    {
      v[j] = dice.integer(-2, 2);
      for (int i = 0; i < 6; ++i)
        Z(i, j) = dice.integer(-2, 2);
    }
    const DelassusProblem problem = localProblem(Z * Z.transpose(), Z * v, laws);
    const EnumerationReport report = enumerate(problem, withCuts(EnumerationCuts::FACETS, 4, 2));
    EXPECT_TRUE(report.complete);
    for (const CheckedMode& mode : feasibleModes(problem.W.toDense(), problem.q, laws))
      EXPECT_TRUE(std::any_of(report.families.begin(), report.families.end(),
                              [&](const SolutionFamily& family) { return isIn(family, mode.r, 1e-6); }))
          << mode.r.transpose();
    const EnumerationReport without = enumerate(problem);
    EXPECT_EQ(report.solutions, without.solutions);
    EXPECT_EQ(report.continua, without.continua);
    EXPECT_EQ(report.uniqueness, without.uniqueness);
  }
}

TEST(EnumerationCutsTest, CountTheSubsetsStill)
{
  const std::vector<double> values = {3, 5, 7, 2, 9, 4};
  for (const int total : {12, 16, 31})
  {
    int subsets = 0;
    for (int subset = 0; subset < 64; ++subset)
    {
      double sum = 0.0;
      for (int i = 0; i < 6; ++i)
        sum += (subset >> i) % 2 == 1 ? values[static_cast<size_t>(i)] : 0.0;
      subsets += sum == total ? 1 : 0;
    }
    const EnumerationReport report =
        enumerate(subsetSumMachine(values, total), withCuts(EnumerationCuts::MOST_VIOLATED, 20, 3));
    EXPECT_TRUE(report.complete);
    EXPECT_EQ(report.solutions, subsets);
    EXPECT_EQ(report.continua, 0);
    EXPECT_GT(report.cuts, 0);
  }
}

TEST(EnumerationCutsTest, InSpaceTheyLeaveOneSolutionOne)
{
  const EnumerationReport without = enumerate(example321());
  const EnumerationReport report = enumerate(example321(), withCuts(EnumerationCuts::DEEPEST, 3, 3));
  EXPECT_EQ(report.solutions, without.solutions);
  EXPECT_EQ(report.continua, without.continua);
  EXPECT_EQ(report.complete, without.complete);
}
