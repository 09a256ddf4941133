#include <cmath>
#include <stdexcept>
#include <string>

#include "frictional_contact_sim/math/dense_kernels.h"
#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
namespace
{
void expectShape(const char* name, const SparseRows& matrix, int rows, int columns)
{
  // A matrix without rows may have been left at its default of 0 x 0.
  const bool fits = matrix.rows() == rows && (matrix.cols() == columns || rows == 0);
  if (!fits)
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(matrix.rows()) + " x " +
                                std::to_string(matrix.cols()) + ", expected " + std::to_string(rows) + " x " +
                                std::to_string(columns));
  if (!matrix.isCompressed())
    throw std::invalid_argument(std::string(name) + " is not compressed, expected compressed rows (makeCompressed())");
}

void expectSize(const char* name, const Eigen::VectorXd& vector, int size)
{
  if (vector.size() != size)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(vector.size()) + " entries, expected " +
                                std::to_string(size));
}

void expectFinite(const char* name, const double* values, Eigen::Index count)
{
  if (allFinite(values, count))
    return;
  for (Eigen::Index k = 0; k < count; ++k)
    if (!std::isfinite(values[k]))
      throw std::invalid_argument(std::string(name) + " entry " + std::to_string(k) + " is " +
                                  std::to_string(values[k]) + ", expected a finite number");
}

void expectLaws(const std::vector<Law>& laws)
{
  for (size_t i = 0; i < laws.size(); ++i)
    if (!std::isfinite(laws[i].coefficient) || laws[i].coefficient < 0.0)
      throw std::invalid_argument("laws[" + std::to_string(i) + "].coefficient is " +
                                  std::to_string(laws[i].coefficient) + ", expected a finite number >= 0");
}

void expectScales(const char* name, const std::vector<LawScale>& scales, size_t count)
{
  if (scales.empty())
    return;
  if (scales.size() != count)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(scales.size()) +
                                " entries, expected 0 or " + std::to_string(count));
  for (size_t i = 0; i < count; ++i)
  {
    const LawScale& scale = scales[i];
    const bool valid = scale.reach > 0.0 && scale.speed_change >= 0.0 && scale.speed >= 0.0 &&
                       std::isfinite(scale.reach) && std::isfinite(scale.speed_change) && std::isfinite(scale.speed);
    if (!valid)
      throw std::invalid_argument(std::string(name) + "[" + std::to_string(i) + "] is reach " +
                                  std::to_string(scale.reach) + ", speed_change " + std::to_string(scale.speed_change) +
                                  ", speed " + std::to_string(scale.speed) +
                                  ", expected finite numbers, reach > 0, the others >= 0");
  }
}
}  // namespace

void validate(const IncrementalProblem& problem)
{
  const int velocities = problem.velocities();
  expectLaws(problem.laws);
  const int rows = rowCount(problem.laws);
  expectShape("M", problem.M, velocities, velocities);
  expectShape("H", problem.H, rows, velocities);
  expectShape("G", problem.G, problem.bilaterals(), velocities);
  expectSize("w", problem.w, rows);
  expectScales("scales", problem.scales, problem.laws.size());
  expectScales("bilateral_scales", problem.bilateral_scales, static_cast<size_t>(problem.bilaterals()));
  expectFinite("M", problem.M.valuePtr(), problem.M.nonZeros());
  expectFinite("H", problem.H.valuePtr(), problem.H.nonZeros());
  expectFinite("G", problem.G.valuePtr(), problem.G.nonZeros());
  expectFinite("f", problem.f.data(), problem.f.size());
  expectFinite("w", problem.w.data(), problem.w.size());
  expectFinite("b", problem.b.data(), problem.b.size());
}

void validate(const DelassusProblem& problem)
{
  expectLaws(problem.laws);
  const int rows = rowCount(problem.laws);
  const DelassusOperator& W = problem.W;
  if (W.blocks() != static_cast<int>(problem.laws.size()) || W.rows() != rows)
    throw std::invalid_argument("W has " + std::to_string(W.rows()) + " rows in " + std::to_string(W.blocks()) +
                                " blocks, expected " + std::to_string(rows) + " in " +
                                std::to_string(problem.laws.size()) + " for the given laws");
  expectSize("q", problem.q, rows);
  expectScales("scales", problem.scales, problem.laws.size());
  expectFinite("q", problem.q.data(), rows);
  expectFinite("W", W.valueData(), W.valueCount());
}

}  // namespace frictional_contact_sim
