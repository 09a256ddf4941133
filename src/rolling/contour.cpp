#include "frictional_contact_sim/rolling/contour.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
  return a.x() * b.y() - a.y() * b.x();
}

/// Proper crossing or touching of two segments that share no end.
bool meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d)
{
  const double side_c = cross(b - a, c - a), side_d = cross(b - a, d - a);
  const double side_a = cross(d - c, a - c), side_b = cross(d - c, b - c);
  return side_c * side_d <= 0.0 && side_a * side_b <= 0.0 && (side_c != side_d || side_a != side_b);
}

void require(bool holds, const char* field, double value, const char* expected)
{
  if (!holds)
    throw std::invalid_argument(std::string(field) + " is " + std::to_string(value) + ", expected " + expected);
}

/// Angles from the lowest point, going right from `angle` to PI - held, steps growing from `step` to the largest.
std::vector<double> gradedAngles(const CylinderMesh& mesh, double step)
{
  const double last = PI - mesh.held_angle;
  std::vector<double> steps;
  double sum = 0.0;
  while (sum < last - mesh.half_angle)
  {
    step = std::min(step * mesh.growth, mesh.max_angle);
    steps.push_back(step);
    sum += step;
  }
  // The steps are shrunk together, so that the last one ends where the held arc begins.
  std::vector<double> angles;
  double angle = mesh.half_angle;
  for (double part : steps)
    angles.push_back(angle += part * (last - mesh.half_angle) / sum);
  return angles;
}
}  // namespace

std::vector<Eigen::Index> Contour::select(ElementKind kind) const
{
  std::vector<Eigen::Index> found;
  for (size_t i = 0; i < kinds.size(); ++i)
    if (kinds[i] == kind)
      found.push_back(static_cast<Eigen::Index>(i));
  return found;
}

double Contour::area() const
{
  double sum = 0.0;
  for (Eigen::Index i = 0; i < size(); ++i)
    sum += cross(begin.col(i), end.col(i));
  return 0.5 * sum;
}

void Contour::validate() const
{
  const Eigen::Index n = size();
  if (n < 3 || end.cols() != n || static_cast<Eigen::Index>(kinds.size()) != n)
    throw std::invalid_argument("contour has " + std::to_string(n) +
                                " elements, expected at least 3 and a kind for each");
  if (!begin.allFinite() || !end.allFinite())
    throw std::invalid_argument("contour has a point that is not finite");
  for (Eigen::Index i = 0; i < n; ++i)
  {
    if (!(length(i) > 0.0))
      throw std::invalid_argument("contour element " + std::to_string(i) + " has no length");
    bool continued = false;
    for (Eigen::Index j = 0; j < n; ++j)
      continued = continued || begin.col(j) == end.col(i);
    if (!continued)
      throw std::invalid_argument("contour is open after element " + std::to_string(i));
    for (Eigen::Index j = 0; j < i; ++j)
      if (begin.col(i) != end.col(j) && begin.col(j) != end.col(i) &&
          meet(begin.col(i), end.col(i), begin.col(j), end.col(j)))
        throw std::invalid_argument("contour element " + std::to_string(i) + " crosses element " + std::to_string(j));
  }
  if (!(area() > 0.0))
    throw std::invalid_argument("contour runs clockwise (area " + std::to_string(area()) +
                                " m^2), expected the body on its left");
}

void CylinderMesh::validate() const
{
  require(radius > 0.0 && std::isfinite(radius), "radius", radius, "> 0");
  require(half_angle > 0.0 && half_angle <= 0.5 * PI + 1e-12, "half_angle", half_angle, "in (0, pi/2]");
  require(contact_elements >= 1, "contact_elements", contact_elements, ">= 1 (there are no contact nodes)");
  require(growth >= 1.0 && growth <= 10.0, "growth", growth, "in [1, 10]");
  require(max_angle > 0.0 && max_angle <= 0.5, "max_angle", max_angle, "in (0, 0.5]");
  require(held_angle > 0.0 && held_angle < 0.5 * PI, "held_angle", held_angle, "in (0, pi/2)");
}

Contour makeCylinderContour(const CylinderMesh& mesh)
{
  mesh.validate();
  const double step = 2.0 * mesh.half_angle / mesh.contact_elements;
  std::vector<double> angles;
  std::vector<ElementKind> kinds;
  for (int i = 0; i < mesh.contact_elements; ++i)
  {
    angles.push_back(-mesh.half_angle + step * i);
    kinds.push_back(ElementKind::CONTACT);
  }
  const std::vector<double> graded = gradedAngles(mesh, std::min(step, mesh.max_angle));
  angles.push_back(mesh.half_angle);
  kinds.push_back(ElementKind::FREE);
  for (size_t i = 0; i + 1 < graded.size(); ++i)
  {
    angles.push_back(graded[i]);
    kinds.push_back(ElementKind::FREE);
  }
  const int held = std::max(4, static_cast<int>(std::ceil(2.0 * mesh.held_angle / mesh.max_angle)));
  for (int i = 0; i < held; ++i)
  {
    angles.push_back(PI - mesh.held_angle + 2.0 * mesh.held_angle * i / held);
    kinds.push_back(ElementKind::HELD);
  }
  for (size_t i = graded.size(); i-- > 0;)
  {
    angles.push_back(2.0 * PI - graded[i]);
    kinds.push_back(ElementKind::FREE);
  }
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(angles.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    const double angle = angles[static_cast<size_t>(i)];
    // 1 - cos without cancellation: gaps near the lowest point are small.
    points.col(i) << mesh.radius * std::sin(angle), 2.0 * mesh.radius * std::pow(std::sin(0.5 * angle), 2);
  }
  Contour contour = makePolygon(points);
  contour.kinds = kinds;
  return contour;
}

Contour makePolygon(const Eigen::Matrix2Xd& points)
{
  Contour contour;
  contour.begin = points;
  contour.end.resize(2, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    contour.end.col(i) = points.col((i + 1) % points.cols());
  contour.kinds.assign(static_cast<size_t>(points.cols()), ElementKind::FREE);
  return contour;
}

Contour join(const Contour& first, const Contour& second)
{
  Contour both;
  both.begin.resize(2, first.size() + second.size());
  both.end.resize(2, first.size() + second.size());
  both.begin << first.begin, second.begin;
  both.end << first.end, second.end;
  both.kinds = first.kinds;
  both.kinds.insert(both.kinds.end(), second.kinds.begin(), second.kinds.end());
  return both;
}

}  // namespace frictional_contact_sim
