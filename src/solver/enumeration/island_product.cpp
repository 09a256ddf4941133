#include "island_product.h"

namespace frictional_contact_sim
{
namespace
{
/// A piece of one island as one of the whole, its other rows zero.
SolutionPiece spread(const SolutionPiece& piece, const IslandPart& part, size_t laws, Eigen::Index rows)
{
  SolutionPiece result = piece;
  result.modes.assign(laws, LawMode::UNDECIDED);
  for (size_t i = 0; i < part.laws.size(); ++i)
    result.modes[static_cast<size_t>(part.laws[i])] = piece.modes[i];
  const auto place = [&](Eigen::VectorXd& x)
  {
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(rows);
    for (size_t i = 0; i < part.rows.size(); ++i)
      whole[part.rows[i]] = x[static_cast<Eigen::Index>(i)];
    x = whole;
  };
  std::for_each(result.vertices.begin(), result.vertices.end(), place);
  std::for_each(result.rays.begin(), result.rays.end(), place);
  return result;
}

SolutionPiece product(const SolutionPiece& a, const SolutionPiece& b, int max_vertices)
{
  SolutionPiece result;
  result.modes = a.modes;
  for (size_t i = 0; i < b.modes.size(); ++i)
    if (b.modes[i] != LawMode::UNDECIDED)
      result.modes[i] = b.modes[i];
  result.dimension = a.dimension + b.dimension;
  result.bounded = a.bounded && b.bounded;
  result.unique_velocity = a.unique_velocity && b.unique_velocity;
  const bool listed = a.vertices.size() * b.vertices.size() <= static_cast<size_t>(max_vertices);
  result.vertices_complete = a.vertices_complete && b.vertices_complete && listed;
  if (listed)
    for (const Eigen::VectorXd& x : a.vertices)
      for (const Eigen::VectorXd& y : b.vertices)
        result.vertices.emplace_back(x + y);
  else
    result.vertices.emplace_back(middle(a) + middle(b));
  result.rays = a.rays;
  result.rays.insert(result.rays.end(), b.rays.begin(), b.rays.end());
  return result;
}
}  // namespace

std::vector<SolutionFamily> product(const std::vector<SolutionFamily>& before, const IslandPart& part, size_t laws,
                                    Eigen::Index rows, const EnumerateOptions& options)
{
  std::vector<SolutionFamily> result;
  const auto limit = static_cast<size_t>(options.max_families);
  for (const SolutionFamily& a : before)
    for (size_t k = 0; k < part.solutions.families.size() && result.size() < limit; ++k)
    {
      const IslandFamily& b = part.solutions.families[k];
      SolutionFamily family;
      family.dimension = a.dimension + b.dimension();
      family.unique_velocity = a.unique_velocity && part.unique_velocity[k];
      family.proved = a.proved && b.proved;
      family.bounded = a.bounded;
      for (const SolutionPiece& piece : b.pieces)
        family.bounded = family.bounded && piece.bounded;
      for (const SolutionPiece& x : a.pieces)
        for (const SolutionPiece& y : b.pieces)
          if (family.pieces.size() < limit)
            family.pieces.push_back(product(x, spread(y, part, laws, rows), options.max_vertices));
      result.push_back(std::move(family));
    }
  return result;
}

}  // namespace frictional_contact_sim
