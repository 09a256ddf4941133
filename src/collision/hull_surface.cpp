// Points that are one, and libqhull: the triangles of a convex hull.
#include <libqhull_r/libqhull_r.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>

#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
// Times the size. A mesh far from its origin has the rounding of its coordinates: so many times 2^-23 of the largest.
constexpr double WELD_TOLERANCE = 2.5e-7;
constexpr double COPLANAR_TOLERANCE = 5e-7;
constexpr double WELD_ROUNDINGS = 2.0;
constexpr double COPLANAR_ROUNDINGS = 4.0;
constexpr double SINGLE_PRECISION = 1.0 / (1 << 23);
constexpr double JOGGLE = 5e-9;  // times the size

using Cell = std::array<std::int64_t, 3>;

std::uint64_t hashOf(const Cell& cell)
{
  std::uint64_t hash = 0;
  for (const std::int64_t index : cell)
  {
    hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 29;
  }
  return hash;
}

/// Open hash table from a cell to the last point kept there; `before` chains the points of a cell.
class CellTable
{
public:
  explicit CellTable(size_t points)
  {
    size_t size = 64;
    while (size < 2 * points)
      size *= 2;
    last_.assign(size, -1);
    cells_.resize(size);
  }
  int last(const Cell& cell) const { return last_[slot(cell)]; }
  int before(int point) const { return before_[point]; }
  /// Points are numbered 0, 1, ... in the order they are added.
  void add(const Cell& cell)
  {
    const size_t at = slot(cell);
    before_.push_back(last_[at]);
    last_[at] = static_cast<int>(before_.size()) - 1;
    cells_[at] = cell;
  }

private:
  size_t slot(const Cell& cell) const
  {
    size_t at = hashOf(cell) & (last_.size() - 1);
    while (last_[at] >= 0 && cells_[at] != cell)
      at = (at + 1) & (last_.size() - 1);
    return at;
  }

  std::vector<int> last_;
  std::vector<Cell> cells_;
  std::vector<int> before_;
};

struct QhullDeleter
{
  void operator()(qhT* qh) const
  {
    int current = 0;
    int total = 0;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &current, &total);
    delete qh;
  }
};

/// All facets are simplicial: three vertices, in an order that `toporient` gives a sense, and three neighbours.
HullSurface surfaceOf(qhT* qh)
{
  std::vector<int> number(qh->facet_id, -1);
  int count = 0;
  for (facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next)
    number[facet->id] = count++;
  HullSurface surface;
  surface.joggle = qh->JOGGLEmax;
  surface.triangles.reserve(count);
  for (facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next)
  {
    HullTriangle triangle;
    for (int k = 0; k < 3; ++k)
    {
      triangle.corner[k] = qh_pointid(qh, SETelemt_(facet->vertices, k, vertexT)->point);
      triangle.neighbour[k] = number[SETelemt_(facet->neighbors, k, facetT)->id];
    }
    if (facet->toporient)
    {
      std::swap(triangle.corner[1], triangle.corner[2]);
      std::swap(triangle.neighbour[1], triangle.neighbour[2]);
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

/// Order along a space-filling curve (Morton 1966): qhull is a quarter faster when near points are near in memory.
std::vector<int> nearbyOrder(const std::vector<Eigen::Vector3d>& points, double size)
{
  constexpr int BITS = 10;
  std::vector<std::pair<std::uint32_t, int>> keys;
  for (size_t p = 0; p < points.size(); ++p)
  {
    std::uint32_t key = 0;
    for (int i = 0; i < 3; ++i)
    {
      const auto cell = static_cast<std::uint32_t>(0.5 * (points[p][i] / size + 1.0) * ((1 << BITS) - 1));
      for (int bit = 0; bit < BITS; ++bit)
        key |= (cell >> bit & 1U) << (3 * bit + i);
    }
    keys.emplace_back(key, static_cast<int>(p));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> order;
  for (const auto& [key, point] : keys)
    order.push_back(point);
  return order;
}

double signedVolume(const std::vector<Eigen::Vector3d>& points, const HullSurface& surface)
{
  double volume = 0.0;
  for (const HullTriangle& triangle : surface.triangles)
    volume += points[triangle.corner[0]].dot(points[triangle.corner[1]].cross(points[triangle.corner[2]])) / 6.0;
  return volume;
}
}  // namespace

Precision precisionOf(const std::vector<Eigen::Vector3d>& points)
{
  Eigen::Vector3d low = points.front();
  Eigen::Vector3d high = low;
  bool is_finite = true;
  for (const Eigen::Vector3d& point : points)
  {
    is_finite = is_finite && point.allFinite();
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  Precision precision;
  precision.center = 0.5 * (low + high);
  precision.size = is_finite ? 0.5 * (high - low).norm() : std::numeric_limits<double>::infinity();
  const double rounding = SINGLE_PRECISION * low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  precision.weld = std::max(WELD_TOLERANCE * precision.size, WELD_ROUNDINGS * rounding);
  precision.coplanar = std::max(COPLANAR_TOLERANCE * precision.size, COPLANAR_ROUNDINGS * rounding);
  return precision;
}

std::vector<Eigen::Vector3d> weld(const std::vector<Eigen::Vector3d>& points, double tolerance,
                                  std::vector<int>* numbers)
{
  // Cells of twice the tolerance: what is near a point is in its cell or in the nearer neighbour along each axis.
  const double width = 2.0 * tolerance;
  CellTable table(points.size());
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& point : points)
  {
    Cell cell;
    Cell step;
    for (int i = 0; i < 3; ++i)
    {
      const double place = point[i] / width;
      cell[i] = static_cast<std::int64_t>(std::floor(place));
      step[i] = place - std::floor(place) < 0.5 ? -1 : 1;
    }
    int same = -1;
    for (int k = 0; k < 8 && same < 0; ++k)
    {
      const Cell near = {cell[0] + (k & 1) * step[0], cell[1] + (k >> 1 & 1) * step[1], cell[2] + (k >> 2) * step[2]};
      for (int other = table.last(near); other >= 0 && same < 0; other = table.before(other))
        same = (kept[other] - point).norm() <= tolerance ? other : -1;
    }
    if (same < 0)
    {
      same = static_cast<int>(kept.size());
      table.add(cell);
      kept.push_back(point);
    }
    if (numbers != nullptr)
      numbers->push_back(same);
  }
  return kept;
}

HullSurface hullSurface(const std::vector<Eigen::Vector3d>& points)
{
  std::unique_ptr<qhT, QhullDeleter> owner(new qhT);
  const std::unique_ptr<FILE, int (*)(FILE*)> sink(std::fopen("/dev/null", "w"), &std::fclose);
  qhT* const qh = owner.get();
  // QJ: points are moved at random (always the same way) until the hull has triangles alone, no merged and no flat one;
  // ten times as far after each failure, so the first try is with what regular meshes need.
  double size = 0.0;
  for (const Eigen::Vector3d& point : points)
    size = std::max(size, point.cwiseAbs().maxCoeff());
  const std::vector<int> order = nearbyOrder(points, size);
  std::vector<Eigen::Vector3d> input;
  for (const int point : order)
    input.push_back(points[point]);
  char options[64];
  std::snprintf(options, sizeof options, "qhull QJ%.3g Pp", JOGGLE * size);
  qh_zero(qh, sink.get());
  qh_init_A(qh, nullptr, sink.get(), sink.get(), 0, nullptr);
  const int failed = setjmp(qh->errexit);  // as qh_new_qhull does it, without its check of the output
  if (failed == 0)
  {
    qh->NOerrexit = False;
    qh_initflags(qh, options);
    qh_init_B(qh, input.data()->data(), static_cast<int>(input.size()), 3, False);
    qh_qhull(qh);
  }
  qh->NOerrexit = True;
  if (failed != 0)
    throw std::invalid_argument("qhull finds no hull of its " + std::to_string(points.size()) + " points");
  HullSurface surface = surfaceOf(qh);
  for (HullTriangle& triangle : surface.triangles)
    for (int& corner : triangle.corner)
      corner = order[corner];
  if (signedVolume(points, surface) < 0.0)
  {
    for (HullTriangle& triangle : surface.triangles)
    {
      std::swap(triangle.corner[1], triangle.corner[2]);
      std::swap(triangle.neighbour[1], triangle.neighbour[2]);
    }
  }
  return surface;
}

}  // namespace frictional_contact_sim
