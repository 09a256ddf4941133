#include "frictional_contact_sim/solver/convex/primal_dual_iteration.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
/// Shift of rows held at zero, relative to the largest 1/rho: their step is round-off.
constexpr double INFINITE_SHIFT = 1e20;
/// The regularisation grows by 100 when the factorization breaks down, at most this often.
constexpr int FACTOR_ATTEMPTS = 5;
}  // namespace

const OptionTable<PrimalDualOptions>& PrimalDualOptions::table()
{
  static const OptionTable<PrimalDualOptions> table(
      "interior_point", {
                            {"step_fraction", &PrimalDualOptions::step_fraction, inside(0.0, 1.0), "-",
                             "share of the way to the boundary taken"},
                            {"regularisation", &PrimalDualOptions::regularisation, notNegative(), "-",
                             "added to the diagonal, relative to 1/rho_i"},
                        });
  return table;
}

void PrimalDualOptions::validate() const
{
  table().validate(*this);
}

PrimalDualIteration::PrimalDualIteration(const PrimalDualOptions& options) : options_(options)
{
  options_.validate();
}

void PrimalDualIteration::addCone(int block, int head, int tail, int dimension, double scale, double constant)
{
  Cone cone;
  cone.block = block;
  cone.head = head;
  cone.tail = tail;
  cone.dimension = dimension;
  cone.scale = scale;
  cone.constant = constant;
  cones_.push_back(cone);
}

void PrimalDualIteration::makeCones(const ConvexProblem& problem)
{
  cones_.clear();
  fixed_.clear();
  for (int i = 0; i < problem.W->blocks(); ++i)
  {
    const SimpleSet& set = problem.sets[static_cast<size_t>(i)];
    const int first = problem.W->offset(i);
    const bool contact = set.type == SetType::CONE || set.type == SetType::CYLINDER;
    const bool point = !(set.parameter > 0.0);
    if (set.type == SetType::CONE && !point)
      addCone(i, first, first + 1, set.dimension, set.parameter, 0.0);
    else if (contact || set.type == SetType::HALF_LINE)
      addCone(i, first, first + 1, 1, 1.0, 0.0);
    if (set.type == SetType::CYLINDER && !point)
      addCone(i, -1, first + 1, set.dimension, 1.0, set.parameter);
    if (set.type == SetType::INTERVAL && !point)
      addCone(i, -1, first, 2, 1.0, set.parameter);
    if (contact && point)
      for (int row = first + 1; row < first + set.dimension; ++row)
        fixed_.push_back({i, row});
    if (set.type == SetType::INTERVAL && point)
      fixed_.push_back({i, first});
  }
}

Vector<3> PrimalDualIteration::toCone(const Cone& cone, const Eigen::VectorXd& rows) const
{
  Vector<3> x = Vector<3>::Zero();
  if (cone.head >= 0)
    x[0] = cone.scale * rows[cone.head];
  for (int k = 1; k < cone.dimension; ++k)
    x[k] = rows[cone.tail + k - 1];
  return x;
}

void PrimalDualIteration::fromCone(const Cone& cone, const Vector<3>& z, Eigen::VectorXd& rows) const
{
  if (cone.head >= 0)
    rows[cone.head] += cone.scale * z[0];
  for (int k = 1; k < cone.dimension; ++k)
    rows[cone.tail + k - 1] += z[k];
}

void PrimalDualIteration::startCone(const ConvexProblem& problem, Cone& cone, const Eigen::VectorXd& guess_u,
                                    double shift, double speed)
{
  const double rho = problem.step_lengths[cone.block];
  const bool cold = !(shift < speed);
  Vector<3> x = toCone(cone, r_);
  Vector<3> z = Vector<3>::Zero();
  if (cold)
  {
    // The same product x.z everywhere: the start is centred whatever the mass ratios.
    const double product = mean_step_length_ * speed * speed;
    x.setZero();
    x[0] = cone.head >= 0 ? cone.scale * std::sqrt(rho * mean_step_length_) * speed : cone.constant;
    z[0] = product / x[0];
  }
  else
  {
    z[0] = cone.head >= 0 ? guess_u[cone.head] / cone.scale : 0.0;
    for (int k = 1; k < cone.dimension; ++k)
      z[k] = guess_u[cone.tail + k - 1];
    if (cone.head >= 0)
      x[0] = std::max(x[0], x.tail<2>().norm()) + cone.scale * rho * shift;
    else
    {
      x[0] = cone.constant;
      const double limit = cone.constant / (1.0 + std::min(1.0, rho * shift / cone.constant));
      if (x.tail<2>().norm() > limit)
        x.tail<2>() *= limit / x.tail<2>().norm();
    }
    z[0] = std::max(z[0], z.tail<2>().norm()) + shift / cone.scale;
  }
  if (cone.head >= 0)
    r_[cone.head] = x[0] / cone.scale;
  for (int k = 1; k < cone.dimension; ++k)
    r_[cone.tail + k - 1] = x[k];
  scalePair(x, z, cone.dimension, cone.scaling);
}

void PrimalDualIteration::start(const ConvexProblem& problem, const Eigen::VectorXd& r, const Eigen::VectorXd& u,
                                double shift)
{
  factor_.setOperator(*problem.W);
  makeCones(problem);
  mean_step_length_ = std::exp(problem.step_lengths.array().log().mean());
  const double speed = std::max(problem.c.lpNorm<Eigen::Infinity>(), std::numeric_limits<double>::min());
  r_ = r;
  for (const FixedRow& fixed : fixed_)
    r_[fixed.row] = 0.0;
  for (Cone& cone : cones_)
    startCone(problem, cone, u, shift, speed);
  problem.W->apply(r_, u_);
  u_ += problem.c;
  updateDual();
}

void PrimalDualIteration::updateDual()
{
  dual_.setZero(r_.size());
  for (const Cone& cone : cones_)
    fromCone(cone, cone.scaling.z(), dual_);
}

double PrimalDualIteration::complementarity() const
{
  double sum = 0.0;
  for (const Cone& cone : cones_)
    sum += cone.scaling.lambda.squaredNorm();
  return cones_.empty() ? 0.0 : sum / static_cast<double>(cones_.size());
}

void PrimalDualIteration::spectralShift(const ConvexProblem& problem)
{
  bases_.assign(static_cast<size_t>(problem.W->blocks()), SquareMatrix<3>::Identity());
  shift_.setZero(problem.W->rows());
  constexpr double HALF_ROOT = 0.70710678118654752440;
  for (const Cone& cone : cones_)
  {
    const LorentzSpectrum spectrum = inverseSquareSpectrum(cone.scaling);
    SquareMatrix<3>& basis = bases_[static_cast<size_t>(cone.block)];
    const int first = problem.W->offset(cone.block);
    const double x = spectrum.direction[0];
    const double y = spectrum.direction[1];
    if (cone.dimension == 1)
    {
      shift_[cone.head] = spectrum.perpendicular;
    }
    else if (cone.head >= 0)
    {
      // Columns A^-1 v+, A^-1 v-, A^-1 v0, with A = diag(mu, 1, 1).
      const double head = HALF_ROOT / cone.scale;
      basis << head, head, 0.0, HALF_ROOT * x, -HALF_ROOT * x, -y, HALF_ROOT * y, -HALF_ROOT * y, x;
      shift_[first] = spectrum.plus;
      shift_[first + 1] = spectrum.minus;
      if (cone.dimension == 3)
        shift_[first + 2] = spectrum.perpendicular;
    }
    else
    {
      // A constant head: the tangential block of N^-2 is (I + 2 w_T w_T^T)/beta^2.
      const int local = cone.tail - first;
      shift_[cone.tail] = spectrum.perpendicular * (1.0 + 2.0 * spectrum.tangential * spectrum.tangential);
      if (cone.dimension == 3)
      {
        basis.block<2, 2>(local, local) << x, -y, y, x;
        shift_[cone.tail + 1] = spectrum.perpendicular;
      }
    }
  }
}

bool PrimalDualIteration::factor(const ConvexProblem& problem)
{
  spectralShift(problem);
  const double largest = problem.step_lengths.cwiseInverse().maxCoeff();
  for (const FixedRow& fixed : fixed_)
    shift_[fixed.row] = INFINITE_SHIFT * largest;
  double regularisation = options_.regularisation;
  for (int attempt = 0; attempt < FACTOR_ATTEMPTS; ++attempt)
  {
    for (int i = 0; i < problem.W->blocks(); ++i)
      for (int k = 0; k < problem.W->dimension(i); ++k)
        shift_[problem.W->offset(i) + k] +=
            regularisation / problem.step_lengths[i] * bases_[static_cast<size_t>(i)].col(k).squaredNorm();
    if (factor_.factor(bases_, shift_))
      return true;
    regularisation = std::max(100.0 * regularisation, 1e-14);
  }
  return false;
}

void PrimalDualIteration::direction()
{
  // rhs = -(W r + c - A^T z) + A^T N^-T target, with target = lambda \ d.
  rhs_ = dual_ - u_;
  for (const Cone& cone : cones_)
    fromCone(cone, cone.scaling.inverse.transpose() * cone.target, rhs_);
  for (const FixedRow& fixed : fixed_)
    rhs_[fixed.row] = 0.0;
  factor_.solve(rhs_, dr_);
  for (const FixedRow& fixed : fixed_)
    dr_[fixed.row] = 0.0;
  for (Cone& cone : cones_)
  {
    cone.affine_x = cone.scaling.inverse * toCone(cone, dr_);
    cone.affine_z = cone.target - cone.affine_x;
  }
}

double PrimalDualIteration::longestStep() const
{
  double step = std::numeric_limits<double>::infinity();
  for (const Cone& cone : cones_)
    step = std::min(
        {step, lorentzStep(cone.scaling.lambda, cone.affine_x), lorentzStep(cone.scaling.lambda, cone.affine_z)});
  return step;
}

double PrimalDualIteration::step(const ConvexProblem& problem, double centring)
{
  problem.W->apply(r_, u_);
  u_ += problem.c;
  if (!factor(problem))
    return 0.0;
  for (Cone& cone : cones_)
    cone.target = -cone.scaling.lambda;
  direction();
  const double affine = std::min(1.0, longestStep());
  const double target = std::max(centring, std::pow(1.0 - affine, 3) * complementarity());
  for (Cone& cone : cones_)
  {
    Vector<3> right = -jordanProduct(cone.scaling.lambda, cone.scaling.lambda);
    right -= jordanProduct(cone.affine_x, cone.affine_z);
    right[0] += target;
    cone.target = jordanDivide(cone.scaling.lambda, right);
  }
  direction();
  const double length = std::min(1.0, options_.step_fraction * longestStep());
  if (!std::isfinite(length) || !dr_.allFinite())
    return 0.0;
  for (Cone& cone : cones_)
  {
    const Vector<3> x = cone.scaling.lambda + length * cone.affine_x;
    const Vector<3> z = cone.scaling.lambda + length * cone.affine_z;
    if (!advance(cone.scaling, x, z, cone.dimension))
      return 0.0;
  }
  r_ += length * dr_;
  problem.W->apply(r_, u_);
  u_ += problem.c;
  updateDual();
  return length;
}

}  // namespace frictional_contact_sim
