#include "frictional_contact_sim/separation/nearest_point.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
/// Generators nearer than this, relative, are one.
constexpr double SAME = 1e-10;
/// A gap up to here, where round-off ends the method, is none: oracles are exact to about 1e-9.
constexpr double ROUND_OFF = 1e-8;
/// A distance below this, over the largest generator, is none.
constexpr double ORIGIN = 1e-14;

class Corral
{
public:
  const Eigen::VectorXd& point() const { return x_; }

  bool has(const Generator& candidate) const
  {
    return std::any_of(
        generators_.begin(), generators_.end(),
        [&](const Generator& own) {
          return own.is_ray == candidate.is_ray &&
                 (own.value - candidate.value).norm() <= SAME * candidate.value.norm();
        });
  }

  explicit Corral(const Eigen::VectorXd& first) : generators_{{first, false}}, weights_{1.0}, x_(first) {}

  /**
   * The generator joins, others leave until the affine minimiser of those left is inside.
   * @return false when the newcomer's weight would not rise, which only round-off can do
   */
  bool join(const Generator& generator)
  {
    generators_.push_back(generator);
    weights_.push_back(0.0);
    for (bool first = true;; first = false)
    {
      const Eigen::VectorXd target = affineWeights();
      if (first && !(target[target.size() - 1] > 0.0))
        return false;
      double step = 1.0;
      size_t leaves = weights_.size();
      for (size_t i = 0; i < weights_.size(); ++i)
      {
        const double aim = target[static_cast<Eigen::Index>(i)];
        if (aim > 0.0)
          continue;
        const double reach = weights_[i] / (weights_[i] - aim);
        if (reach < step)
        {
          step = reach;
          leaves = i;
        }
      }
      for (size_t i = 0; i < weights_.size(); ++i)
        weights_[i] += step * (target[static_cast<Eigen::Index>(i)] - weights_[i]);
      if (leaves == weights_.size())
        break;
      generators_.erase(generators_.begin() + static_cast<std::ptrdiff_t>(leaves));
      weights_.erase(weights_.begin() + static_cast<std::ptrdiff_t>(leaves));
    }
    x_.setZero();
    for (size_t i = 0; i < weights_.size(); ++i)
      x_ += weights_[i] * generators_[i].value;
    return true;
  }

  double largest() const
  {
    double size = 0.0;
    for (const Generator& generator : generators_)
      size = std::max(size, generator.value.norm());
    return size;
  }

  void report(NearestPoint& result) const
  {
    result.point = x_;
    result.generators.clear();
    std::vector<double> used;
    for (size_t i = 0; i < weights_.size(); ++i)
      if (weights_[i] > 0.0)
      {
        result.generators.push_back(generators_[i]);
        used.push_back(weights_[i]);
      }
    result.weights = Eigen::Map<const Eigen::VectorXd>(used.data(), static_cast<Eigen::Index>(used.size()));
  }

private:
  /** Weights of the nearest point of the affine hull: |p_0 + D c| least, D differences of points, and rays. */
  Eigen::VectorXd affineWeights() const
  {
    const auto base = static_cast<size_t>(
        std::find_if(generators_.begin(), generators_.end(), [](const Generator& g) { return !g.is_ray; }) -
        generators_.begin());
    const Eigen::VectorXd& p = generators_[base].value;
    Eigen::MatrixXd D(p.size(), static_cast<Eigen::Index>(generators_.size()) - 1);
    Eigen::Index column = 0;
    for (size_t i = 0; i < generators_.size(); ++i)
      if (i != base)
        D.col(column++) = generators_[i].is_ray ? generators_[i].value : Eigen::VectorXd(generators_[i].value - p);
    const Eigen::VectorXd c = D.cols() == 0 ? Eigen::VectorXd() : Eigen::VectorXd(D.colPivHouseholderQr().solve(-p));
    Eigen::VectorXd weights(static_cast<Eigen::Index>(generators_.size()));
    column = 0;
    double sum = 0.0;
    for (size_t i = 0; i < generators_.size(); ++i)
      if (i != base)
      {
        weights[static_cast<Eigen::Index>(i)] = c[column++];
        sum += generators_[i].is_ray ? 0.0 : weights[static_cast<Eigen::Index>(i)];
      }
    weights[static_cast<Eigen::Index>(base)] = 1.0 - sum;
    return weights;
  }

  std::vector<Generator> generators_;
  std::vector<double> weights_;
  Eigen::VectorXd x_;
};
}  // namespace

NearestPoint nearestPoint(const LinearOracle& oracle, const Eigen::VectorXd& first, const NearestPointOptions& options)
{
  if (!first.allFinite())
    throw std::invalid_argument("nearest point: the first point is not finite");
  NearestPoint result;
  Corral corral(first);
  result.norms = {first.norm()};
  result.status = NearestPointStatus::MAX_CALLS;
  while (result.calls < options.max_calls)
  {
    const Eigen::VectorXd& x = corral.point();
    const double norm = x.norm();
    if (!(norm > ORIGIN * corral.largest()))  // the origin is in C
    {
      result.gap = 0.0;
      result.status = NearestPointStatus::CONVERGED;
      break;
    }
    OracleAnswer answer = oracle(x);
    ++result.calls;
    if (answer.status != OracleStatus::FOUND)
    {
      result.status = NearestPointStatus::FAILED;
      break;
    }
    Generator& generator = answer.generator;
    if (generator.is_ray && std::abs(generator.value.norm() - 1.0) > SAME)
      generator.value.normalize();
    const double unit = norm * (generator.is_ray ? 1.0 : norm + std::max(generator.value.norm(), corral.largest()));
    result.gap = std::max(0.0, (generator.is_ray ? 0.0 : norm * norm) - x.dot(generator.value));
    Corral next = corral;
    if (result.gap <= options.tolerance * unit || corral.has(generator) || !next.join(generator) ||
        !(next.point().norm() < norm))
    {
      result.status = result.gap <= ROUND_OFF * unit ? NearestPointStatus::CONVERGED : NearestPointStatus::STALLED;
      break;
    }
    corral = std::move(next);
    result.norms.push_back(corral.point().norm());
  }
  corral.report(result);
  return result;
}

LinearOracle listOracle(const Eigen::MatrixXd& points, const Eigen::MatrixXd& rays)
{
  return [points, rays](const Eigen::VectorXd& direction) -> OracleAnswer
  {
    if (points.cols() == 0)
      return {OracleStatus::EMPTY, {}};
    // A ray along which the function falls, the steepest; without one the lowest point.
    Eigen::Index best = 0, steepest = -1;
    double slope = -1e-12 * direction.norm();
    for (Eigen::Index j = 0; j < rays.cols(); ++j)
    {
      const double length = rays.col(j).norm();
      const double cosine = length > 0.0 ? rays.col(j).dot(direction) / length : 0.0;
      if (cosine < slope)
      {
        slope = cosine;
        steepest = j;
      }
    }
    if (steepest >= 0)
      return {OracleStatus::FOUND, {rays.col(steepest), true}};
    (points.transpose() * direction).minCoeff(&best);
    return {OracleStatus::FOUND, {points.col(best), false}};
  };
}

}  // namespace frictional_contact_sim
