// What the portfolio starts from without a guess: laws solved apart from each other.
#include <algorithm>

#include "frictional_contact_sim/solver/one_contact.h"
#include "frictional_contact_sim/solver/portfolio.h"

namespace frictional_contact_sim
{
namespace
{
/** Whether the impulse that would stop q_T, alone, exceeds the friction bound of the one that would stop q_N, alone. */
template <int D>
bool wouldSlide(const SquareMatrix<D>& W, const Vector<D>& q, double mu)
{
  const double tangential = (W.trace() - W(0, 0)) / (D - 1);
  return q[0] < 0.0 && q.template tail<D - 1>().norm() * W(0, 0) > mu * -q[0] * tangential;
}

bool anyWouldSlide(const DelassusProblem& problem)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    const int row = problem.W.offset(i);
    if (law.type == LawType::COULOMB_3D &&
        wouldSlide<3>(problem.W.diagonalBlock<3>(i), problem.q.segment<3>(row), law.coefficient))
      return true;
    if (law.type == LawType::COULOMB_2D &&
        wouldSlide<2>(problem.W.diagonalBlock<2>(i), problem.q.segment<2>(row), law.coefficient))
      return true;
  }
  return false;
}

/** r_N = -q_N / W_NN where that is positive, nothing else. */
void solveNormalsApart(const DelassusProblem& problem, Eigen::VectorXd& r)
{
  r.setZero();
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int row = problem.W.offset(i);
    if (!problem.laws[static_cast<size_t>(i)].isCoulomb() || !(problem.q[row] < 0.0))
      continue;
    const double W =
        problem.W.dimension(i) == 3 ? problem.W.diagonalBlock<3>(i)(0, 0) : problem.W.diagonalBlock<2>(i)(0, 0);
    r[row] = W > 0.0 ? -problem.q[row] / W : 0.0;
  }
}
}  // namespace

/** Every law solved as if it were alone: exact where laws are not coupled. */
void Portfolio::solveApart(const DelassusProblem& problem, Eigen::VectorXd& r)
{
  r.resize(problem.W.rows());
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    const int row = problem.W.offset(i);
    if (law.type == LawType::COULOMB_3D)
      r.segment<3>(row) = solveCoulomb(problem.W.diagonalBlock<3>(i), problem.q.segment<3>(row), law.coefficient);
    else if (law.type == LawType::COULOMB_2D)
      r.segment<2>(row) = solveCoulomb(problem.W.diagonalBlock<2>(i), problem.q.segment<2>(row), law.coefficient);
    else
      r[row] = solveOneDimensional(law, problem.W.diagonalBlock<1>(i)(0, 0), problem.q[row], 0.0);
  }
}

bool Portfolio::start(int attempt, const DelassusProblem& problem, Eigen::VectorXd& r, Eigen::VectorXd& u)
{
  if (attempt == 0)
  {
    solveApart(problem, r);
    problem.W.apply(r, u);
    u += problem.q;
    return true;
  }
  if (attempt > 1)
    return false;
  const bool slides = anyWouldSlide(problem);
  if (!slides)
  {
    solveNormalsApart(problem, r);
    problem.W.apply(r, u);
    u += problem.q;
  }
  // r' W r from u = W r + q.
  const double load = problem.q.dot(r);
  const double power = r.dot(u) - load;
  const double t = power > 0.0 ? std::clamp(-load / power, 0.0, 1.0) : 0.0;
  if (slides && t == 1.0)
    return false;  // the start of attempt 0 once more
  r *= t;
  u = t * (u - problem.q) + problem.q;
  return true;
}

}  // namespace frictional_contact_sim
