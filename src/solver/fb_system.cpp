#include "frictional_contact_sim/solver/fb_system.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include "frictional_contact_sim/math/complementarity_functions.h"

namespace frictional_contact_sim
{
namespace
{
/// From this share of its entries on J' J is factored dense.
constexpr double DENSE_NORMAL = 0.1;
/// But not above so many rows: three such matrices are kept.
constexpr int DENSE_NORMAL_ROWS = 4000;

template <int D>
double store(const ContactFunction<D>& f, bool jacobians, double* value, double* by_c, double* by_z)
{
  for (int a = 0; a < D; ++a)
    value[a] = f.value[a];
  for (int a = 0; jacobians && a < D; ++a)
    for (int b = 0; b < D; ++b)
    {
      by_c[D * a + b] = f.by_u(a, b);
      by_z[D * a + b] = f.by_r(a, b);
    }
  return f.value.squaredNorm();
}

ContactFunction<1> scalarFunction(const Law& law, double c, double z, double alpha)
{
  if (law.type == LawType::UNILATERAL)
    return unilateralFischerBurmeister(c, z, alpha);
  if (law.type == LawType::DRY_FRICTION)
    return dryFrictionFischerBurmeister(c, z, law.coefficient, alpha);
  ContactFunction<1> bilateral;
  bilateral.value[0] = c;
  bilateral.by_u(0, 0) = 1.0;
  bilateral.by_r(0, 0) = 0.0;
  return bilateral;
}
}  // namespace

void FbSystem::set(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths)
{
  problem_ = &problem;
  contacts_.set(problem, step_lengths, ScaledContacts::Metric::DIRECTION);
  phi_.resize(problem.q.size());
  work_.resize(problem.q.size());
  by_c_.resize(9 * problem.laws.size());
  by_z_.resize(9 * problem.laws.size());
}

double FbSystem::evaluate(const Eigen::VectorXd& c, const Eigen::VectorXd& z, double alpha, bool jacobians)
{
  double sum = 0.0;
  for (size_t i = 0; i < contacts_.laws().size(); ++i)
  {
    const Law& law = contacts_.laws()[i];
    const int row = contacts_.offset(static_cast<int>(i));
    if (law.type == LawType::COULOMB_3D)
      sum +=
          store<3>(coulombFischerBurmeister<3>(c.segment<3>(row), z.segment<3>(row), law.coefficient, alpha, jacobians),
                   jacobians, &phi_[row], &by_c_[9 * i], &by_z_[9 * i]);
    else if (law.type == LawType::COULOMB_2D)
      sum +=
          store<2>(coulombFischerBurmeister<2>(c.segment<2>(row), z.segment<2>(row), law.coefficient, alpha, jacobians),
                   jacobians, &phi_[row], &by_c_[9 * i], &by_z_[9 * i]);
    else
      sum += store<1>(scalarFunction(law, c[row], z[row], alpha), jacobians, &phi_[row], &by_c_[9 * i], &by_z_[9 * i]);
  }
  return 0.5 * sum;
}

void FbSystem::gradient(Eigen::VectorXd& g)
{
  for (size_t i = 0; i < contacts_.laws().size(); ++i)
  {
    const int d = contacts_.laws()[i].dimension();
    const int row = contacts_.offset(static_cast<int>(i));
    for (int b = 0; b < d; ++b)
    {
      work_[row + b] = 0.0;
      for (int a = 0; a < d; ++a)
        work_[row + b] += by_c_[9 * i + static_cast<size_t>(d * a + b)] * phi_[row + a];
    }
  }
  contacts_.applyTransposed(work_, g);
  for (size_t i = 0; i < contacts_.laws().size(); ++i)
  {
    const int d = contacts_.laws()[i].dimension();
    const int row = contacts_.offset(static_cast<int>(i));
    for (int b = 0; b < d; ++b)
      for (int a = 0; a < d; ++a)
        g[row + b] += by_z_[9 * i + static_cast<size_t>(d * a + b)] * phi_[row + a];
  }
}

struct FbSteps::Sparse
{
  using Matrix = Eigen::SparseMatrix<double>;
  std::vector<Eigen::Triplet<double>> triplets;
  Matrix jacobian, normal, identity;
  Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> lu;
  Eigen::SimplicialLLT<Matrix> llt;
};

FbSteps::FbSteps() : sparse_(std::make_unique<Sparse>())
{
}

FbSteps::~FbSteps() = default;

void FbSteps::assemble(const FbSystem& system)
{
  const int rows = system.rows();
  const int blocks = system.problem().W.blocks();
  dense_ = system.problem().W.isDense();
  normal_ready_ = false;
  if (dense_)
  {
    jacobian_.setZero(rows, rows);
    for (int i = 0; i < blocks; ++i)
      system.visitJacobian(i, [&](int row, int column, double value) { jacobian_(row, column) += value; });
    return;
  }
  sparse_->triplets.clear();
  for (int i = 0; i < blocks; ++i)
    system.visitJacobian(
        i, [&](int row, int column, double value) { sparse_->triplets.emplace_back(row, column, value); });
  sparse_->jacobian.resize(rows, rows);
  sparse_->jacobian.setFromTriplets(sparse_->triplets.begin(), sparse_->triplets.end());
}

bool FbSteps::newton(const FbSystem& system, Eigen::VectorXd& d)
{
  product_ = -system.value();
  if (dense_)
  {
    lu_.compute(jacobian_);
    d = lu_.solve(product_);
  }
  else
  {
    sparse_->lu.compute(sparse_->jacobian);
    if (sparse_->lu.info() != Eigen::Success)
      return false;
    d = sparse_->lu.solve(product_);
  }
  return d.allFinite();
}

void FbSteps::makeNormal(const FbSystem& system)
{
  const int rows = system.rows();
  normal_ready_ = true;
  dense_normal_ = dense_;
  if (dense_)
  {
    normal_.setZero(rows, rows);
    normal_.selfadjointView<Eigen::Lower>().rankUpdate(jacobian_.transpose());
    gradient_.noalias() = jacobian_.transpose() * system.value();
    return;
  }
  sparse_->normal = Sparse::Matrix(sparse_->jacobian.transpose()) * sparse_->jacobian;
  gradient_ = sparse_->jacobian.transpose() * system.value();
  // J' J has the pattern of W^2, its factor more.
  dense_normal_ =
      rows <= DENSE_NORMAL_ROWS && static_cast<double>(sparse_->normal.nonZeros()) > DENSE_NORMAL * rows * rows;
  if (dense_normal_)
    normal_ = sparse_->normal;
}

bool FbSteps::leastSquares(const FbSystem& system, double lambda, Eigen::VectorXd& d, double& predicted)
{
  if (!normal_ready_)
    makeNormal(system);
  if (dense_normal_)
  {
    shifted_ = normal_;
    shifted_.diagonal().array() += lambda;
    llt_.compute(shifted_);
    if (llt_.info() != Eigen::Success)
      return false;
    d = llt_.solve(gradient_);
  }
  else
  {
    const int rows = system.rows();
    sparse_->identity.resize(rows, rows);
    sparse_->identity.setIdentity();
    sparse_->llt.compute(sparse_->normal + lambda * sparse_->identity);
    if (sparse_->llt.info() != Eigen::Success)
      return false;
    d = sparse_->llt.solve(gradient_);
  }
  d = -d;
  if (dense_)
    product_.noalias() = jacobian_ * d;
  else
    product_ = sparse_->jacobian * d;
  predicted = -(system.value().dot(product_) + 0.5 * product_.squaredNorm());
  return d.allFinite();
}

}  // namespace frictional_contact_sim
