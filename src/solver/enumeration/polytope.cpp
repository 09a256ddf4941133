#include "polytope.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <bitset>

namespace frictional_contact_sim
{
namespace
{
constexpr double ZERO = 1e-9;  ///< a ray of unit size lies on a half space of unit size
constexpr size_t MAX_HALF_SPACES = 512;

struct Ray
{
  Eigen::VectorXd direction;
  std::bitset<MAX_HALF_SPACES> on;  ///< half spaces treated so far on whose boundary it lies
};

class DoubleDescription
{
public:
  explicit DoubleDescription(const Eigen::MatrixXd& half_spaces, size_t max_rays)
    : rows_(half_spaces), max_rays_(max_rays)
  {
  }

  /** @return false when rays became too many */
  bool run()
  {
    const Eigen::Index size = rows_.cols();
    // A simplicial cone of independent half spaces to start with; its extreme rays are the columns of the inverse.
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(rows_.transpose());
    const auto& order = factor.colsPermutation().indices();
    Eigen::MatrixXd basis(size, size);
    for (Eigen::Index k = 0; k < size; ++k)
      basis.row(k) = rows_.row(order[k]);
    const Eigen::MatrixXd inverse = basis.fullPivLu().inverse();
    for (Eigen::Index k = 0; k < size; ++k)
    {
      Ray ray{inverse.col(k) / inverse.col(k).lpNorm<Eigen::Infinity>(), {}};
      for (Eigen::Index j = 0; j < size; ++j)
        ray.on[static_cast<size_t>(order[j])] = j != k;
      rays_.push_back(std::move(ray));
    }
    for (Eigen::Index k = size; k < rows_.rows(); ++k)
      if (!cut(static_cast<size_t>(order[k])))
        return false;
    return true;
  }

  const std::vector<Ray>& rays() const { return rays_; }

private:
  bool areAdjacent(const Ray& a, const Ray& b) const
  {
    const auto common = a.on & b.on;
    if (static_cast<Eigen::Index>(common.count()) < rows_.cols() - 2)
      return false;
    return std::none_of(rays_.begin(), rays_.end(),
                        [&](const Ray& other) { return &other != &a && &other != &b && (common & ~other.on).none(); });
  }

  bool cut(size_t index)
  {
    const Eigen::VectorXd normal = rows_.row(static_cast<Eigen::Index>(index));
    std::vector<double> heights;
    for (Ray& ray : rays_)
    {
      const double height = normal.dot(ray.direction);
      ray.on[index] = std::abs(height) <= ZERO;
      heights.push_back(ray.on[index] ? 0.0 : height);
    }
    std::vector<Ray> next;
    for (size_t a = 0; a < rays_.size(); ++a)
      if (heights[a] > 0.0)
        for (size_t b = 0; b < rays_.size(); ++b)
        {
          if (!(heights[b] < 0.0) || !areAdjacent(rays_[a], rays_[b]))
            continue;
          Ray ray{heights[a] * rays_[b].direction - heights[b] * rays_[a].direction, rays_[a].on & rays_[b].on};
          ray.direction /= ray.direction.lpNorm<Eigen::Infinity>();
          ray.on[index] = true;
          next.push_back(std::move(ray));
          if (next.size() > max_rays_)
            return false;
        }
    for (size_t a = 0; a < rays_.size(); ++a)
      if (heights[a] >= 0.0)
        next.push_back(std::move(rays_[a]));
    rays_ = std::move(next);
    return rays_.size() <= max_rays_;
  }

  const Eigen::MatrixXd& rows_;
  size_t max_rays_;
  std::vector<Ray> rays_;
};
}  // namespace

Polytope enumerateVertices(const Eigen::MatrixXd& C, const Eigen::VectorXd& d, size_t max_rays)
{
  Polytope polytope;
  const Eigen::Index size = C.cols();
  if (static_cast<size_t>(C.rows()) + 1 > MAX_HALF_SPACES)
  {
    polytope.complete = false;
    return polytope;
  }
  Eigen::MatrixXd half_spaces(C.rows() + 1, size + 1);
  half_spaces << C, -d, Eigen::RowVectorXd::Unit(size + 1, size);
  for (Eigen::Index i = 0; i < half_spaces.rows(); ++i)
  {
    const double length = half_spaces.row(i).norm();
    if (length > 0.0)
      half_spaces.row(i) /= length;
  }
  DoubleDescription description(half_spaces, max_rays);
  polytope.complete = description.run();
  if (!polytope.complete)
    return polytope;
  for (const Ray& ray : description.rays())
  {
    const double t = ray.direction[size];
    if (t > ZERO)
      polytope.vertices.push_back(ray.direction.head(size) / t);
    else
      polytope.rays.push_back(ray.direction.head(size).normalized());
  }
  return polytope;
}

int affineDimension(const std::vector<Eigen::VectorXd>& points, const std::vector<Eigen::VectorXd>& rays,
                    double tolerance)
{
  if (points.empty())
    return 0;
  const Eigen::VectorXd& origin = points.front();
  Eigen::MatrixXd spans(origin.size(), static_cast<Eigen::Index>(points.size() + rays.size()) - 1);
  double size = 1.0;
  Eigen::Index column = 0;
  for (size_t i = 1; i < points.size(); ++i)
    spans.col(column++) = points[i] - origin;
  for (const Eigen::VectorXd& point : points)
    size = std::max(size, point.lpNorm<Eigen::Infinity>());
  for (const Eigen::VectorXd& ray : rays)
    spans.col(column++) = size * ray;
  if (spans.cols() == 0)
    return 0;
  // Rows are few, columns may be many: pivoted Gram-Schmidt by column lengths.
  int dimension = 0;
  while (dimension < spans.rows())
  {
    Eigen::Index longest = 0;
    const double length = spans.colwise().norm().maxCoeff(&longest);
    if (length <= tolerance * size)
      break;
    const Eigen::VectorXd axis = spans.col(longest) / length;
    spans -= axis * (axis.transpose() * spans).eval();
    ++dimension;
  }
  return dimension;
}

}  // namespace frictional_contact_sim
