#pragma once
/**
 * @file mode_check.h
 * @brief The enumeration's judge: every one of the 4^n combinations of modes in 2D (and those of 1D laws) looked at by
 * itself, without a tree, without the simplex method.
 *
 * A combination is a system B x = c, x >= 0 (impulses along the edges of cones and the slacks of what is left of u >=
 * 0), feasible when the least |B x - c| over x >= 0 is zero: Lawson, Hanson (1974), the NNLS algorithm.
 */
#include <Eigen/QR>
#include <vector>

#include "frictional_contact_sim/solver/enumeration/enumeration.h"

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief min |B x - c| over x >= 0. */
inline Eigen::VectorXd leastSquaresOfPositives(const Eigen::MatrixXd& B, const Eigen::VectorXd& c)
{
  const Eigen::Index size = B.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
  std::vector<bool> active(static_cast<size_t>(size), false);
  for (int round = 0; round < 10 * size + 10; ++round)
  {
    const Eigen::VectorXd gradient = B.transpose() * (c - B * x);
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < size; ++j)
      if (!active[static_cast<size_t>(j)] && gradient[j] > 1e-11 && (best < 0 || gradient[j] > gradient[best]))
        best = j;
    if (best < 0)
      break;
    active[static_cast<size_t>(best)] = true;
    while (true)
    {
      std::vector<Eigen::Index> used;
      for (Eigen::Index j = 0; j < size; ++j)
        if (active[static_cast<size_t>(j)])
          used.push_back(j);
      Eigen::MatrixXd part(B.rows(), static_cast<Eigen::Index>(used.size()));
      for (size_t k = 0; k < used.size(); ++k)
        part.col(static_cast<Eigen::Index>(k)) = B.col(used[k]);
      const Eigen::VectorXd target = part.colPivHouseholderQr().solve(c);
      double step = 1.0;
      for (size_t k = 0; k < used.size(); ++k)
        if (target[static_cast<Eigen::Index>(k)] <= 0.0)
          step = std::min(step, x[used[k]] / (x[used[k]] - target[static_cast<Eigen::Index>(k)] + 1e-300));
      for (size_t k = 0; k < used.size(); ++k)
        x[used[k]] += step * (target[static_cast<Eigen::Index>(k)] - x[used[k]]);
      if (step == 1.0)
        break;
      for (const Eigen::Index j : used)
        if (x[j] <= 1e-14)
        {
          x[j] = 0.0;
          active[static_cast<size_t>(j)] = false;
        }
    }
  }
  return x;
}

/** @brief One feasible combination: a solution in it, and whether it is the only one of this combination. */
struct CheckedMode
{
  Eigen::VectorXd r;
  bool single;
};

/** @brief All feasible combinations of a problem with laws COULOMB_2D, UNILATERAL and DRY_FRICTION. */
inline std::vector<CheckedMode> feasibleModes(const Eigen::MatrixXd& W, const Eigen::VectorXd& q,
                                              const std::vector<Law>& laws)
{
  // Per law and mode: edges of the set of impulses, its shift, and per row of u its sign: 0 zero, +-1, 2 anything.
  struct Mode
  {
    std::vector<Eigen::Vector2d> edges;
    Eigen::Vector2d shift;
    int signs[2];
  };
  std::vector<std::vector<Mode>> modes;
  for (const Law& law : laws)
  {
    const double mu = law.coefficient;
    const Eigen::Vector2d zero(0, 0);
    if (law.type == LawType::COULOMB_2D && mu > 0.0)
      modes.push_back({{{}, zero, {1, 2}},
                       {{{1, mu}, {1, -mu}}, zero, {0, 0}},
                       {{{1, -mu}}, zero, {0, 1}},
                       {{{1, mu}}, zero, {0, -1}}});
    else if (law.type == LawType::COULOMB_2D)
      modes.push_back({{{}, zero, {1, 2}}, {{{1, 0}}, zero, {0, 2}}});
    else if (law.type == LawType::UNILATERAL)
      modes.push_back({{{}, zero, {1, 2}}, {{{1, 0}}, zero, {0, 2}}});
    else  // the bar |r| <= c as its lower end and an edge; its upper end is looked at afterwards
      modes.push_back({{{{1, 0}}, {-mu, 0}, {0, 2}}, {{}, {-mu, 0}, {1, 2}}, {{}, {mu, 0}, {-1, 2}}});
  }
  std::vector<CheckedMode> found;
  std::vector<size_t> choice(laws.size(), 0);
  while (true)
  {
    std::vector<Eigen::VectorXd> columns;
    std::vector<Eigen::Index> rows;
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(q.size());
    std::vector<std::pair<Eigen::Index, int>> slacks;
    std::vector<std::pair<size_t, double>> bars;  // edge, largest value
    Eigen::Index row = 0;
    for (size_t i = 0; i < laws.size(); row += laws[i++].dimension())
    {
      const Mode& mode = modes[i][choice[i]];
      const int dimension = laws[i].dimension();
      if (laws[i].type == LawType::DRY_FRICTION && !mode.edges.empty())
        bars.emplace_back(columns.size(), 2.0 * laws[i].coefficient);
      for (const Eigen::Vector2d& edge : mode.edges)
      {
        columns.emplace_back(Eigen::VectorXd::Zero(q.size()));
        columns.back().segment(row, dimension) = edge.head(dimension);
      }
      shift.segment(row, dimension) = mode.shift.head(dimension);
      for (int k = 0; k < dimension; ++k)
        if (mode.signs[k] != 2)
        {
          if (mode.signs[k] != 0)
            slacks.emplace_back(static_cast<Eigen::Index>(rows.size()), mode.signs[k]);
          rows.push_back(row + k);
        }
    }
    const auto edges = static_cast<Eigen::Index>(columns.size()), equations = static_cast<Eigen::Index>(rows.size());
    const auto slack = static_cast<Eigen::Index>(slacks.size()), bar = static_cast<Eigen::Index>(bars.size());
    Eigen::MatrixXd R(q.size(), edges);
    for (Eigen::Index j = 0; j < edges; ++j)
      R.col(j) = columns[static_cast<size_t>(j)];
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(equations + bar, edges + slack + bar);
    Eigen::VectorXd c(equations + bar);
    const Eigen::MatrixXd WR = W * R;
    const Eigen::VectorXd constant = W * shift + q;
    for (Eigen::Index i = 0; i < equations; ++i)
    {
      B.row(i).head(edges) = WR.row(rows[static_cast<size_t>(i)]);
      c[i] = -constant[rows[static_cast<size_t>(i)]];
    }
    for (Eigen::Index k = 0; k < slack; ++k)
      B(slacks[static_cast<size_t>(k)].first, edges + k) = -slacks[static_cast<size_t>(k)].second;
    for (Eigen::Index k = 0; k < bar; ++k)
    {
      B(equations + k, static_cast<Eigen::Index>(bars[static_cast<size_t>(k)].first)) = 1.0;
      B(equations + k, edges + slack + k) = 1.0;
      c[equations + k] = bars[static_cast<size_t>(k)].second;
    }
    const Eigen::VectorXd x = leastSquaresOfPositives(B, c);
    if (B.rows() == 0 || (B * x - c).norm() <= 1e-9 * std::max(1.0, x.size() == 0 ? 0.0 : x.lpNorm<Eigen::Infinity>()))
    {
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
      factor.setThreshold(1e-9);
      factor.compute(B);
      found.push_back({R * x.head(edges) + shift, edges == 0 || factor.rank() == B.cols()});
    }
    size_t k = 0;
    while (k < choice.size() && ++choice[k] == modes[k].size())
      choice[k++] = 0;
    if (k == choice.size())
      return found;
  }
}

/** @brief Whether r is in a family: in the hull of a piece's vertices and rays. */
inline bool isIn(const SolutionFamily& family, const Eigen::VectorXd& r, double tolerance)
{
  const double size = std::max(1.0, r.lpNorm<Eigen::Infinity>());
  for (const SolutionPiece& piece : family.pieces)
  {
    const auto vertices = static_cast<Eigen::Index>(piece.vertices.size());
    const auto rays = static_cast<Eigen::Index>(piece.rays.size());
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(r.size() + 1, vertices + rays);
    for (Eigen::Index j = 0; j < vertices; ++j)
      B.col(j) << piece.vertices[static_cast<size_t>(j)] / size, 1.0;
    for (Eigen::Index j = 0; j < rays; ++j)
      B.col(vertices + j).head(r.size()) = piece.rays[static_cast<size_t>(j)].normalized();
    Eigen::VectorXd c(r.size() + 1);
    c << r / size, 1.0;
    if ((B * leastSquaresOfPositives(B, c) - c).norm() <= tolerance)
      return true;
  }
  return false;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
