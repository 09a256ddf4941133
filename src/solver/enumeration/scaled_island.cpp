#include "scaled_island.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
/// Rank of the bilateral block, and what counts as zero in what its pseudo-inverse leaves.
constexpr double RANK = 1e-10;

using Indices = std::vector<Eigen::Index>;

Eigen::MatrixXd select(const Eigen::MatrixXd& matrix, const Indices& rows, const Indices& columns)
{
  Eigen::MatrixXd result(rows.size(), columns.size());
  for (size_t i = 0; i < rows.size(); ++i)
    for (size_t j = 0; j < columns.size(); ++j)
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = matrix(rows[i], columns[j]);
  return result;
}

Eigen::VectorXd select(const Eigen::VectorXd& vector, const Indices& rows)
{
  return select(Eigen::MatrixXd(vector), rows, {0});
}

/// s of every row: 1/sqrt of its law's largest eigenvalue, that of the others where nothing moves the law.
Eigen::VectorXd rowScales(const Eigen::MatrixXd& W, const std::vector<Law>& laws, const std::vector<int>& offsets)
{
  Eigen::VectorXd eigenvalues(laws.size());
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const int row = offsets[i], dimension = laws[i].dimension();
    const Eigen::MatrixXd block = W.block(row, row, dimension, dimension);
    eigenvalues[static_cast<Eigen::Index>(i)] =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (block + block.transpose()), Eigen::EigenvaluesOnly)
            .eigenvalues()
            .maxCoeff();
  }
  const double largest = laws.empty() ? 0.0 : eigenvalues.maxCoeff();
  Eigen::VectorXd scales(W.rows());
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const double value = eigenvalues[static_cast<Eigen::Index>(i)];
    const double used = value > 1e-14 * largest ? value : largest;
    scales.segment(offsets[i], laws[i].dimension()).setConstant(used > 0.0 ? 1.0 / std::sqrt(used) : 1.0);
  }
  return scales;
}

double largestDefect(const Eigen::VectorXd& q, const std::vector<Law>& laws, const std::vector<int>& offsets)
{
  double largest = 0.0;
  for (size_t i = 0; i < laws.size(); ++i)
    for (int k = 0; k < laws[i].dimension(); ++k)
    {
      const double value = q[offsets[i] + k];
      largest = std::max(largest, k == 0 && laws[i].isOneSided() ? -value : std::abs(value));
    }
  return largest > 0.0 ? largest : 1.0;
}

/// Rows of E and e that say something; a row without coefficients is either void or a contradiction.
/// @param reference size of the coefficients before they cancelled @param size of the right sides
void keepEquations(const Eigen::MatrixXd& left, const Eigen::VectorXd& right, double reference, double size,
                   ScaledIsland& island)
{
  Indices kept;
  for (Eigen::Index i = 0; i < left.rows(); ++i)
  {
    const double largest = left.cols() == 0 ? 0.0 : left.row(i).lpNorm<Eigen::Infinity>();
    if (largest > RANK * reference)
      kept.push_back(i);
    else if (std::abs(right[i]) > 1e-9 * size)
      island.consistent = false;
  }
  Indices all(static_cast<size_t>(left.cols()));
  for (size_t j = 0; j < all.size(); ++j)
    all[j] = static_cast<Eigen::Index>(j);
  island.E = select(left, kept, all);
  island.e = select(right, kept);
  for (Eigen::Index i = 0; i < island.e.size(); ++i)
  {
    const double largest = island.E.row(i).lpNorm<Eigen::Infinity>();
    island.E.row(i) /= largest;
    island.e[i] /= largest;
  }
}
}  // namespace

ScaledIsland scaleIsland(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws)
{
  ScaledIsland island;
  Indices bilateral, others;
  Eigen::Index row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const bool eliminated = laws[i].type == LawType::BILATERAL;
    if (!eliminated)
    {
      island.offsets.push_back(static_cast<int>(others.size()));
      island.indices.push_back(static_cast<int>(i));
      island.laws.push_back(laws[i]);
    }
    for (int k = 0; k < laws[i].dimension(); ++k)
      (eliminated ? bilateral : others).push_back(row++);
  }
  const auto count = static_cast<Eigen::Index>(others.size());
  Eigen::MatrixXd reduced = select(W, others, others);
  Eigen::VectorXd free = select(q, others);
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(q.size(), count);
  island.p.setZero(q.size());
  for (Eigen::Index i = 0; i < count; ++i)
    map(others[static_cast<size_t>(i)], i) = 1.0;
  Eigen::MatrixXd left(0, count);
  Eigen::VectorXd right(0);
  double reference = 0.0;
  if (!bilateral.empty())
  {
    const Eigen::MatrixXd block = select(W, bilateral, bilateral), coupling = select(W, bilateral, others),
                          back = select(W, others, bilateral);
    const Eigen::VectorXd q_b = select(q, bilateral);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
    factor.setThreshold(RANK);
    factor.compute(block);
    const Eigen::MatrixXd by_r = -factor.solve(coupling);
    const Eigen::VectorXd constant = -factor.solve(q_b);
    for (size_t i = 0; i < bilateral.size(); ++i)
    {
      map.row(bilateral[i]) = by_r.row(static_cast<Eigen::Index>(i));
      island.p[bilateral[i]] = constant[static_cast<Eigen::Index>(i)];
    }
    left = coupling + block * by_r;
    right = -(q_b + block * constant);
    reduced += back * by_r;
    free += back * constant;
  }
  const Eigen::VectorXd scales = rowScales(reduced, island.laws, island.offsets);
  if (left.size() > 0)
    reference = (select(W, bilateral, others) * scales.asDiagonal()).cwiseAbs().maxCoeff();
  const double sigma = largestDefect(scales.cwiseProduct(free), island.laws, island.offsets);
  island.W = scales.asDiagonal() * reduced * scales.asDiagonal();
  island.q = scales.cwiseProduct(free) / sigma;
  island.P = map * (sigma * scales).asDiagonal();
  for (size_t i = 0; i < island.laws.size(); ++i)
    if (island.laws[i].type == LawType::DRY_FRICTION)
      island.laws[i].coefficient /= sigma * scales[island.offsets[i]];
  keepEquations(left * (sigma * scales).asDiagonal(), right, reference * sigma, q.lpNorm<Eigen::Infinity>(), island);
  return island;
}

}  // namespace frictional_contact_sim
