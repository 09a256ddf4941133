#include "frictional_contact_sim/solver/scaled_contacts.h"

#include <cmath>

#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
/// Below this share of the block's largest eigenvalue a diagonal entry counts as zero.
constexpr double ZERO_DIAGONAL = 1e-14;

template <int D>
void contactLengths(const DelassusOperator& W, int i, double rho, double& normal, double& tangential)
{
  const SquareMatrix<D> block = W.diagonalBlock<D>(i);
  const double tangent = largestEigenvalue(SquareMatrix<D - 1>(block.template bottomRightCorner<D - 1, D - 1>()));
  normal = block(0, 0) * rho > ZERO_DIAGONAL ? 1.0 / block(0, 0) : rho;
  tangential = tangent * rho > ZERO_DIAGONAL ? 1.0 / tangent : rho;
}
}  // namespace

void directionLengths(const DelassusOperator& W, int law, double rho, double& normal, double& tangential)
{
  if (W.dimension(law) == 3)
    contactLengths<3>(W, law, rho, normal, tangential);
  else if (W.dimension(law) == 2)
    contactLengths<2>(W, law, rho, normal, tangential);
  else
    normal = tangential = rho;
}

void ScaledContacts::set(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths, Metric metric)
{
  problem_ = &problem;
  laws_ = problem.laws;
  root_.resize(problem.q.size());
  work_.resize(problem.q.size());
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    Law& law = laws_[static_cast<size_t>(i)];
    double normal = step_lengths[i], tangential = step_lengths[i];
    if (metric == Metric::DIRECTION)
      directionLengths(problem.W, i, step_lengths[i], normal, tangential);
    root_.segment(offset(i), law.dimension()).setConstant(std::sqrt(tangential));
    root_[offset(i)] = std::sqrt(normal);
    if (law.isCoulomb())
      law.coefficient *= std::sqrt(normal / tangential);
    else if (law.type == LawType::DRY_FRICTION)
      law.coefficient /= std::sqrt(normal);
  }
  free_ = problem.q.cwiseProduct(root_);
}

void ScaledContacts::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y)
{
  work_ = x.cwiseProduct(root_);
  problem_->W.apply(work_, y);
  y.array() *= root_.array();
}

void ScaledContacts::applyTransposed(const Eigen::VectorXd& x, Eigen::VectorXd& y)
{
  work_ = x.cwiseProduct(root_);
  problem_->W.applyTransposed(work_, y);
  y.array() *= root_.array();
}

void ScaledContacts::velocity(const Eigen::VectorXd& z, Eigen::VectorXd& c)
{
  apply(z, c);
  c += free_;
}

}  // namespace frictional_contact_sim
