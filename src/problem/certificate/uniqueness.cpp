#include "frictional_contact_sim/problem/certificate/uniqueness.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "frictional_contact_sim/problem/certificate/kinematic_islands.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = std::numeric_limits<double>::infinity();
/// Of the product of a matrix's row norms: a smaller determinant has no sign; and of W's largest eigenvalue.
constexpr double ROUND_OFF = 1e-11;

bool hasFriction(const Law& law)
{
  return law.isCoulomb() && law.coefficient > 0.0;
}

/** An island without its BILATERAL laws and without the tangents of frictionless contacts, scaled law by law. */
struct Reduced
{
  Eigen::MatrixXd W;
  std::vector<Law> laws;
  std::vector<Eigen::Index> first;  ///< row of each law
};

Reduced reduceIsland(const DelassusProblem& problem)
{
  const Eigen::MatrixXd W = problem.W.toDense();
  std::vector<Eigen::Index> kept, bilateral;
  Reduced result;
  Eigen::Index row = 0;
  for (const Law& law : problem.laws)
  {
    if (law.type == LawType::BILATERAL)
      bilateral.push_back(row);
    else
    {
      result.laws.push_back(hasFriction(law) || law.type == LawType::DRY_FRICTION ? law
                                                                                  : Law{LawType::UNILATERAL, 0.0});
      result.first.push_back(static_cast<Eigen::Index>(kept.size()));
      for (int k = 0; k < result.laws.back().dimension(); ++k)
        kept.push_back(row + k);
    }
    row += law.dimension();
  }
  const auto block = [&](const std::vector<Eigen::Index>& rows, const std::vector<Eigen::Index>& columns)
  {
    Eigen::MatrixXd part(rows.size(), columns.size());
    for (size_t i = 0; i < rows.size(); ++i)
      for (size_t j = 0; j < columns.size(); ++j)
        part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = W(rows[i], columns[j]);
    return part;
  };
  result.W = block(kept, kept);
  if (!bilateral.empty())
  {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
    factor.setThreshold(1e-10);
    factor.compute(block(bilateral, bilateral));
    result.W -= block(kept, bilateral) * factor.solve(block(bilateral, kept));
  }
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(result.W.rows());
  for (size_t i = 0; i < result.laws.size(); ++i)
  {
    const int d = result.laws[i].dimension();
    const double trace = result.W.diagonal().segment(result.first[i], d).sum();
    if (trace > 0.0)
      scale.segment(result.first[i], d).setConstant(std::sqrt(d / trace));
  }
  result.W = scale.asDiagonal() * result.W * scale.asDiagonal();
  return result;
}

double largestEigenvalue(const Eigen::MatrixXd& matrix)
{
  return matrix.size() == 0
             ? 0.0
             : Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/** Infinite where W is singular. */
double contractionConstant(const Reduced& island)
{
  if (island.W.size() == 0)
    return 0.0;
  const Eigen::MatrixXd symmetric = 0.5 * (island.W + island.W.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(symmetric, Eigen::EigenvaluesOnly);
  const double largest = spectrum.eigenvalues().maxCoeff();
  if (!(spectrum.eigenvalues().minCoeff() > ROUND_OFF * largest) ||
      (island.W - symmetric).cwiseAbs().maxCoeff() > ROUND_OFF * largest)
    return INFINITE;
  std::vector<Eigen::Index> tangents;
  std::vector<size_t> contacts;
  for (size_t i = 0; i < island.laws.size(); ++i)
    if (hasFriction(island.laws[i]))
    {
      contacts.push_back(i);
      for (int k = 1; k < island.laws[i].dimension(); ++k)
        tangents.push_back(island.first[i] + k);
    }
  Eigen::MatrixXd slip(tangents.size(), tangents.size());
  for (size_t i = 0; i < tangents.size(); ++i)
    for (size_t j = 0; j < tangents.size(); ++j)
      slip(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = symmetric(tangents[i], tangents[j]);
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(symmetric.rows(), static_cast<Eigen::Index>(contacts.size()));
  for (size_t k = 0; k < contacts.size(); ++k)
    E(island.first[contacts[k]], static_cast<Eigen::Index>(k)) = island.laws[contacts[k]].coefficient;
  const Eigen::MatrixXd answer = E.transpose() * symmetric.ldlt().solve(E);
  return std::sqrt(largestEigenvalue(slip) * largestEigenvalue(0.5 * (answer + answer.transpose())));
}

enum class Orientation
{
  COHERENT,
  INCOHERENT,
  UNDECIDED
};

/** All minors of the header, piece by piece. */
Orientation orientation(const Reduced& island, int max_pieces)
{
  double pieces = 1.0;
  for (const Law& law : island.laws)
  {
    if (law.type == LawType::COULOMB_3D)
      return Orientation::UNDECIDED;
    pieces *= law.type == LawType::COULOMB_2D ? 4.0 : 2.0;
  }
  if (pieces > max_pieces)
    return Orientation::UNDECIDED;
  Orientation result = Orientation::COHERENT;
  Eigen::MatrixXd rows(island.W.rows(), island.W.cols()), minor(island.W.rows(), island.W.cols());
  for (int choice = 0; choice < static_cast<int>(pieces); ++choice)
  {
    int rest = choice;
    Eigen::Index size = 0;
    std::vector<Eigen::Index> chosen;
    for (size_t i = 0; i < island.laws.size(); ++i)
    {
      const Law& law = island.laws[i];
      const int count = law.type == LawType::COULOMB_2D ? 4 : 2;
      const int piece = rest % count;
      rest /= count;
      const Eigen::Index row = island.first[i];
      if (piece == 0)
        continue;
      // 1: sticks, or the one-dimensional law acts; 2, 3: slides
      rows.col(size++) = island.W.col(row);
      chosen.push_back(row);
      if (piece > 1)
        rows.col(size - 1) += (piece == 2 ? law.coefficient : -law.coefficient) * island.W.col(row + 1);
      else if (law.type == LawType::COULOMB_2D)
      {
        rows.col(size++) = island.W.col(row + 1);
        chosen.push_back(row + 1);
      }
    }
    for (Eigen::Index k = 0; k < size; ++k)
      minor.row(k).head(size) = rows.row(chosen[static_cast<size_t>(k)]).head(size);
    if (size == 0)
      continue;
    const auto part = minor.topLeftCorner(size, size);
    const double determinant = part.determinant();
    const double scale = part.rowwise().norm().prod();
    if (determinant < -ROUND_OFF * scale)
      return Orientation::INCOHERENT;
    if (!(determinant > ROUND_OFF * scale))
      result = Orientation::UNDECIDED;
  }
  return result;
}
}  // namespace

const char* toString(Uniqueness uniqueness)
{
  switch (uniqueness)
  {
    case Uniqueness::UNIQUE_V:
      return "UNIQUE_V";
    case Uniqueness::MULTIPLE:
      return "MULTIPLE";
    case Uniqueness::UNKNOWN:
      break;
  }
  return "UNKNOWN";
}

UniquenessReport checkUniqueness(const DelassusProblem& problem, const UniquenessOptions& options)
{
  validate(problem);
  UniquenessReport report;
  bool unique = true, minors = false;
  for (const auto& part : kinematicIslands(problem))
  {
    const std::vector<Law>& laws = part.problem.laws;
    if (std::none_of(laws.begin(), laws.end(), hasFriction))
      continue;
    if (part.problem.W.rows() > options.max_rows)
    {
      unique = false;
      continue;
    }
    const Reduced island = reduceIsland(part.problem);
    const double constant = contractionConstant(island);
    report.contraction = std::max(report.contraction, constant);
    if (constant < 1.0 - ROUND_OFF)
      continue;
    const Orientation found = orientation(island, options.max_pieces);
    report.some_load_has_several = report.some_load_has_several || found == Orientation::INCOHERENT;
    minors = minors || found == Orientation::COHERENT;
    unique = unique && found == Orientation::COHERENT;
  }
  report.verdict = unique ? Uniqueness::UNIQUE_V : Uniqueness::UNKNOWN;
  if (!unique)
    report.message = report.some_load_has_several
                         ? "for some loads there are none or several solutions; not for this one"
                           " alone is it known"
                         : "no proof that two solutions have the same velocities";
  else if (minors)
    report.message = "one solution for every load: all minors of the contacts' modes are positive";
  else if (report.contraction > 0.0)
    report.message = "one solution at most: the map of slip speeds is a contraction";
  else
    report.message = "no friction: the velocities minimise a strictly convex energy";
  return report;
}

UniquenessReport checkUniqueness(const IncrementalProblem& problem, const UniquenessOptions& options)
{
  validate(problem);
  return checkUniqueness(reduce(problem), options);
}

}  // namespace frictional_contact_sim
