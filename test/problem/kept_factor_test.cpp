// What a factor and a reduction keep from call to call has the bits of one that starts anew.
#include <gtest/gtest.h>

#include <random>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "support/hand_problems.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::randomProblem;
using test_support::RandomProblemOptions;

/** Several positive definite blocks with random patterns. */
class Blocks
{
public:
  explicit Blocks(unsigned seed) : random_(seed)
  {
    for (int block = 0; block < 5; ++block)
    {
      const int size = 1 + static_cast<int>(random_() % 12);
      for (int i = 0; i < size; ++i)
        for (int k = 0; k <= i; ++k)
          if (k == i || k == i - 1 || random_() % 4 == 0)
            entries_.push_back({block, first_ + i, first_ + k, 0.0});
      first_ += size;
      change(block);
    }
  }
  int count() const { return 5; }
  void change(int block)
  {
    std::normal_distribution<double> gauss;
    for (Entry& entry : entries_)
      if (entry.block == block)
        entry.value = entry.row == entry.column ? 30.0 + gauss(random_) : gauss(random_);
  }
  SparseRows matrix() const
  {
    std::vector<Eigen::Triplet<double>> triplets;
    for (const Entry& entry : entries_)
    {
      triplets.emplace_back(entry.row, entry.column, entry.value);
      if (entry.row != entry.column)
        triplets.emplace_back(entry.column, entry.row, entry.value);
    }
    SparseRows result(first_, first_);
    result.setFromTriplets(triplets.begin(), triplets.end());
    return result;
  }
  std::mt19937& random() { return random_; }

private:
  struct Entry
  {
    int block, row, column;
    double value;
  };
  std::mt19937 random_;
  std::vector<Entry> entries_;
  int first_ = 0;
};

Eigen::VectorXd solved(const MassFactor& factor, Eigen::Index size)
{
  Eigen::VectorXd half;
  Eigen::VectorXd x;
  factor.halfSolve(Eigen::VectorXd::Ones(size), half);
  factor.transposedHalfSolve(half, x);
  return x;
}

TEST(KeptFactorTest, AfterAnyChangesItHasTheBitsOfANewOne)
{
  for (unsigned seed = 0; seed < 20; ++seed)
  {
    Blocks blocks(seed);
    MassFactor kept;
    for (int call = 0; call < 12; ++call)
    {
      if (call > 0)
        for (int block = 0; block < blocks.count(); ++block)
          if (blocks.random()() % 3 == 0)
            blocks.change(block);
      const SparseRows M = blocks.matrix();
      EXPECT_EQ(kept.compute(M), call == 0);
      MassFactor fresh;
      fresh.compute(M);
      EXPECT_EQ(kept.values(), fresh.values());
      EXPECT_EQ(kept.rowIndices(), fresh.rowIndices());
      EXPECT_EQ(kept.inverseRootPivots(), fresh.inverseRootPivots());
      EXPECT_LT((Eigen::MatrixXd(M) * solved(kept, M.rows()) - Eigen::VectorXd::Ones(M.rows())).norm(), 1e-12);
      kept.compute(M);
      for (int k = 0; k < kept.size(); ++k)
        EXPECT_FALSE(kept.hasChanged(k));
      if (call == 6)  // one that it cannot factor is forgotten
      {
        SparseRows bad = M;
        bad.coeffRef(0, 0) = -1.0;
        EXPECT_THROW(kept.compute(bad), std::invalid_argument);
        kept.compute(M);
      }
    }
  }
}

TEST(KeptReductionTest, AfterAnyChangesItHasTheBitsOfANewOne)
{
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const OperatorKind kind : {OperatorKind::AUTOMATIC, OperatorKind::DENSE, OperatorKind::MATRIX_FREE})
      for (const int bilaterals : {0, 4})
      {
        RandomProblemOptions options;
        options.bilaterals = bilaterals;
        IncrementalProblem problem = randomProblem(options, seed);
        std::mt19937 random(seed);
        std::normal_distribution<double> gauss;
        DelassusReduction kept;
        for (int call = 0; call < 8; ++call)
        {
          for (double& component : problem.f)
            component = gauss(random);
          if (call % 3 == 1)  // another row of a contact
            problem.H.valuePtr()[random() % static_cast<unsigned>(problem.H.nonZeros())] += 0.1;
          if (call % 3 == 2)  // another mass
            problem.M.coeffRef(static_cast<int>(seed), static_cast<int>(seed)) *= 1.1;
          kept.compute(problem, kind);
          DelassusReduction fresh;
          fresh.compute(problem, kind);
          EXPECT_EQ(kept.problem().q, fresh.problem().q);
          EXPECT_EQ(kept.stepLengths(), fresh.stepLengths());
          for (int law = 0; law < static_cast<int>(problem.laws.size()); ++law)
          {
            ASSERT_EQ(kept.halfRowEnd(law) - kept.halfRowBegin(law), fresh.halfRowEnd(law) - fresh.halfRowBegin(law));
            const auto values =
                (kept.halfRowEnd(law) - kept.halfRowBegin(law)) * problem.laws[static_cast<size_t>(law)].dimension();
            EXPECT_TRUE(
                std::equal(kept.halfRowValues(law), kept.halfRowValues(law) + values, fresh.halfRowValues(law)));
          }
          if (kind != OperatorKind::MATRIX_FREE)
          {
            EXPECT_EQ(kept.problem().W.toDense(), fresh.problem().W.toDense());
          }
        }
      }
}

}  // namespace
}  // namespace frictional_contact_sim
