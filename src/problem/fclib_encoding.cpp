#include "fclib_encoding.h"

#include <algorithm>

namespace frictional_contact_sim
{
namespace
{
using Triplets = std::vector<Eigen::Triplet<double>>;

/** Where every row of the original goes. */
struct RowMap
{
  int dimension = 3;
  int rows = 0;  ///< contact rows after encoding
  int bilaterals = 0;  ///< BILATERAL laws found
  int extra = 0;  ///< DRY_FRICTION laws found: extra velocities, or rows with their own diagonal
  std::vector<int> contact_row;  ///< original row -> encoded contact row, -1 when bilateral
  std::vector<int> bilateral;  ///< original row -> number among the bilateral laws, -1 otherwise
  std::vector<int> extra_row;  ///< normal rows of the dry friction laws
  std::vector<double> threshold;
  std::vector<double> friction;
};

RowMap mapRows(const std::vector<Law>& laws)
{
  RowMap map;
  const bool any_3d = std::any_of(
      laws.begin(), laws.end(), [](const Law& law) { return law.type == LawType::COULOMB_3D; });
  const bool any_2d =
      std::any_of(laws.begin(), laws.end(), [](const Law& law) { return law.type == LawType::COULOMB_2D; });
  map.dimension = any_2d && !any_3d ? 2 : 3;
  for (const Law& law : laws)
  {
    if (law.type == LawType::BILATERAL)
    {
      map.contact_row.push_back(-1);
      map.bilateral.push_back(map.bilaterals++);
      continue;
    }
    if (law.type == LawType::DRY_FRICTION)
    {
      map.contact_row.push_back(map.rows + 1);
      map.extra_row.push_back(map.rows);
      map.threshold.push_back(law.coefficient);
      ++map.extra;
      map.friction.push_back(1.0);
    }
    else
    {
      for (int k = 0; k < law.dimension(); ++k)
        map.contact_row.push_back(map.rows + k);
      map.friction.push_back(law.isCoulomb() ? law.coefficient : 0.0);
    }
    map.bilateral.resize(map.contact_row.size(), -1);
    map.rows += map.dimension;
  }
  return map;
}

/** Scales of the encoded contacts and of the bilateral laws, none where the original has none. */
void encodeScales(const std::vector<Law>& laws, const std::vector<LawScale>& scales, std::vector<LawScale>& contacts,
                  std::vector<LawScale>& bilaterals)
{
  for (size_t i = 0; i < scales.size(); ++i)
  {
    (laws[i].type == LawType::BILATERAL ? bilaterals : contacts).push_back(scales[i]);
    // The normal row of an encoded threshold is a velocity of its own: nothing else may be measured with it.
    if (laws[i].type == LawType::DRY_FRICTION)
      contacts.back().unit = VelocityUnit::SLACK;
  }
}

SparseRows build(int rows, int columns, const Triplets& triplets)
{
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  matrix.makeCompressed();
  return matrix;
}

/** u and r of the encoded contacts, and the impulses of bilateral laws appended to lambda. */
void encodeRows(const RowMap& map, const Solution& solution, EncodedSolution& encoded)
{
  encoded.u.setZero(map.rows);
  encoded.r.setZero(map.rows);
  const Eigen::Index before = encoded.lambda.size();
  encoded.lambda.conservativeResize(before + map.bilaterals);
  for (size_t row = 0; row < map.contact_row.size(); ++row)
  {
    const auto index = static_cast<Eigen::Index>(row);
    if (map.contact_row[row] < 0)
    {
      encoded.lambda[before + map.bilateral[row]] = solution.r[index];
      continue;
    }
    encoded.r[map.contact_row[row]] = solution.r[index];
    encoded.u[map.contact_row[row]] = solution.u[index];
  }
  for (size_t k = 0; k < map.extra_row.size(); ++k)
    encoded.r[map.extra_row[k]] = map.threshold[k];
}
}  // namespace

EncodedGlobal encodeGlobal(const IncrementalProblem& problem, const Solution* solution)
{
  const RowMap map = mapRows(problem.laws);
  const int velocities = problem.velocities();
  const int bilaterals = problem.bilaterals();
  EncodedGlobal encoded;
  encoded.dimension = map.dimension;
  encoded.friction = map.friction;
  Triplets M, H, G;
  for (int row = 0; row < velocities; ++row)
    for (SparseRows::InnerIterator entry(problem.M, row); entry; ++entry)
      M.emplace_back(row, static_cast<int>(entry.col()), entry.value());
  // The extra velocities weigh as much as an average one, so that the condition of M stays what it is.
  const double mass = velocities > 0 ? problem.M.diagonal().mean() : 1.0;
  IncrementalProblem& result = encoded.problem;
  result.f.setZero(velocities + map.extra);
  result.f.head(velocities) = problem.f;
  for (int k = 0; k < map.extra; ++k)
  {
    M.emplace_back(velocities + k, velocities + k, mass);
    H.emplace_back(map.extra_row[static_cast<size_t>(k)], velocities + k, 1.0);
    result.f[velocities + k] = map.threshold[static_cast<size_t>(k)];
  }
  result.w.setZero(map.rows);
  result.b.setZero(bilaterals + map.bilaterals);
  result.b.head(bilaterals) = problem.b;
  for (int row = 0; row < bilaterals; ++row)
    for (SparseRows::InnerIterator entry(problem.G, row); entry; ++entry)
      G.emplace_back(row, static_cast<int>(entry.col()), entry.value());
  for (int row = 0; row < problem.rows(); ++row)
  {
    const auto index = static_cast<size_t>(row);
    const bool contact = map.contact_row[index] >= 0;
    const int target = contact ? map.contact_row[index] : bilaterals + map.bilateral[index];
    (contact ? result.w : result.b)[target] = problem.w[row];
    for (SparseRows::InnerIterator entry(problem.H, row); entry; ++entry)
      (contact ? H : G).emplace_back(target, static_cast<int>(entry.col()), entry.value());
  }
  result.bilateral_scales = problem.bilateral_scales;
  if (result.bilateral_scales.empty() && !problem.scales.empty())
    result.bilateral_scales.resize(static_cast<size_t>(bilaterals));
  encodeScales(problem.laws, problem.scales, result.scales, result.bilateral_scales);
  result.M = build(velocities + map.extra, velocities + map.extra, M);
  result.H = build(map.rows, velocities + map.extra, H);
  result.G = build(bilaterals + map.bilaterals, velocities + map.extra, G);
  if (solution != nullptr)
  {
    encoded.solution.v.setZero(velocities + map.extra);
    encoded.solution.v.head(velocities) = solution->v;
    encoded.solution.lambda = solution->lambda;
    encodeRows(map, *solution, encoded.solution);
  }
  return encoded;
}

EncodedLocal encodeLocal(const DelassusProblem& problem, const Solution* solution)
{
  const RowMap map = mapRows(problem.laws);
  EncodedLocal encoded;
  encoded.dimension = map.dimension;
  encoded.friction = map.friction;
  encoded.q.setZero(map.rows);
  encoded.s.setZero(map.bilaterals);
  Triplets W, V, R;
  const SparseRows source = problem.W.toSparse();
  for (int row = 0; row < problem.W.rows(); ++row)
  {
    const auto index = static_cast<size_t>(row);
    const bool contact = map.contact_row[index] >= 0;
    const int target = contact ? map.contact_row[index] : map.bilateral[index];
    (contact ? encoded.q : encoded.s)[target] = problem.q[row];
    for (SparseRows::InnerIterator entry(source, row); entry; ++entry)
    {
      const auto column = static_cast<size_t>(entry.col());
      if (contact && map.contact_row[column] >= 0)
        W.emplace_back(target, map.contact_row[column], entry.value());
      else if (contact)
        V.emplace_back(target, map.bilateral[column], entry.value());
      else if (map.contact_row[column] < 0)
        R.emplace_back(target, map.bilateral[column], entry.value());
    }
  }
  const double weight = problem.W.rows() > 0 ? source.diagonal().mean() : 1.0;
  for (size_t k = 0; k < map.extra_row.size(); ++k)
  {
    W.emplace_back(map.extra_row[k], map.extra_row[k], weight);
    encoded.q[map.extra_row[k]] = -weight * map.threshold[k];
  }
  std::vector<LawScale> bilateral;
  encodeScales(problem.laws, problem.scales, encoded.scales, bilateral);
  if (!bilateral.empty())
    encoded.scales.clear();  // s has no place for them
  encoded.W = build(map.rows, map.rows, W);
  encoded.V = build(map.rows, map.bilaterals, V);
  encoded.R = build(map.bilaterals, map.bilaterals, R);
  if (solution != nullptr)
    encodeRows(map, *solution, encoded.solution);
  return encoded;
}

}  // namespace frictional_contact_sim
