#include "frictional_contact_sim/solver/sparse_lu.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>
#include <utility>
#include <vector>

namespace frictional_contact_sim
{
namespace
{
/** Tridiagonal with a second diagonal `far` rows away, unsymmetric, diagonally dominant. */
SparseLu::Matrix banded(int size, int far)
{
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i)
  {
    entries.emplace_back(i, i, 4.0 + i % 3);
    for (const int distance : {1, far})
      if (i + distance < size)
      {
        entries.emplace_back(i, i + distance, -1.0);
        entries.emplace_back(i + distance, i, 0.5);
      }
  }
  SparseLu::Matrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

double error(SparseLu& lu, const SparseLu::Matrix& matrix)
{
  lu.matrix() = matrix;
  if (!lu.factor())
    return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(matrix.cols(), -1.0, 2.0);
  Eigen::VectorXd x = matrix * expected;
  lu.solve(x);
  return (x - expected).lpNorm<Eigen::Infinity>();
}
}  // namespace

TEST(SparseLuTest, SolvesWhateverWasFactoredBefore)
{
  SparseLu lu;
  // Few rows and many, another pattern of the same size and count, the same pattern once more, back to few.
  for (const auto& [size, far] : std::vector<std::pair<int, int>>{
           {300, 17}, {5000, 17}, {300, 23}, {300, 23}, {2500, 40}, {2500, 90}, {2500, 90}, {6000, 61}, {300, 17}})
    EXPECT_LT(error(lu, banded(size, far)), 1e-12) << size << " rows, second diagonal at " << far;
}

// UMFPACK with BLAS above 1800 rows, ordered by METIS above 5000, which both have state of the whole process.
TEST(SparseLuTest, TwoThreadsGiveTheBitsOfOneAfterTheOther)
{
  const auto solutions = [](int turn, std::vector<Eigen::VectorXd>& all)
  {
    for (int k = 0; k < 6; ++k)
    {
      SparseLu lu;
      lu.matrix() = banded(k % 2 == 0 ? 6000 : 2500, 61 + 10 * turn + k);
      ASSERT_TRUE(lu.factor());
      Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(lu.matrix().cols(), -1.0, 2.0);
      lu.solve(x);
      all.push_back(x);
    }
  };
  std::vector<Eigen::VectorXd> alone[2], together[2];
  for (const int turn : {0, 1})
    solutions(turn, alone[turn]);
  std::thread first(solutions, 0, std::ref(together[0])), second(solutions, 1, std::ref(together[1]));
  first.join();
  second.join();
  for (const int turn : {0, 1})
    EXPECT_EQ(alone[turn], together[turn]);
}

TEST(SparseLuTest, SaysThatAMatrixIsSingular)
{
  for (const int size : {300, 2500})
  {
    SparseLu lu;
    SparseLu::Matrix singular = banded(size, 17);
    for (SparseLu::Matrix::InnerIterator entry(singular, 100); entry; ++entry)
      entry.valueRef() = 0.0;
    lu.matrix() = singular;
    EXPECT_FALSE(lu.factor()) << size << " rows";
    EXPECT_LT(error(lu, banded(size, 17)), 1e-12) << "a regular one after it, " << size << " rows";
  }
}

}  // namespace frictional_contact_sim
