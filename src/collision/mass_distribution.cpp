#include "frictional_contact_sim/collision/mass_distribution.h"

#include <Eigen/Geometry>

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;

MassDistribution fillSphere(double radius)
{
  return {4.0 / 3.0 * PI * radius * radius * radius, Eigen::Vector3d::Zero(), 0.6 * radius * radius};
}

MassDistribution fillCylinder(double radius, double half_length)
{
  return {2.0 * PI * radius * radius * half_length, Eigen::Vector3d::Zero(),
          0.5 * radius * radius + half_length * half_length / 3.0};
}

/** A cylinder and two half spheres, whose mean distance from their flat side is 3/8 of the radius. */
MassDistribution fillCapsule(double radius, double half_length)
{
  const MassDistribution ends = fillSphere(radius);
  MassDistribution whole = fillCylinder(radius, half_length);
  const double of_ends = ends.gyration_squared + half_length * half_length + 0.75 * radius * half_length;
  const double volume = whole.volume + ends.volume;
  if (volume > 0.0)
    whole.gyration_squared = (whole.volume * whole.gyration_squared + ends.volume * of_ends) / volume;
  whole.volume = volume;
  return whole;
}

/** Tetrahedra from a point inside to the triangles of the faces. */
MassDistribution fillPolyhedron(const Polyhedron& polyhedron)
{
  MassDistribution whole;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  double second = 0.0;
  for (const Polyhedron::Face& face : polyhedron.faces)
  {
    const auto corner = [&](int k) -> Eigen::Vector3d
    { return polyhedron.vertices[polyhedron.face_vertices[face.first + k]] - polyhedron.interior; };
    for (int k = 2; k < face.size; ++k)
    {
      const Eigen::Vector3d a = corner(0);
      const Eigen::Vector3d b = corner(k - 1);
      const Eigen::Vector3d c = corner(k);
      const double volume = a.dot(b.cross(c)) / 6.0;
      whole.volume += volume;
      first += 0.25 * volume * (a + b + c);
      second += 0.05 * volume * (a.squaredNorm() + b.squaredNorm() + c.squaredNorm() + (a + b + c).squaredNorm());
    }
  }
  if (!(whole.volume > 0.0) || polyhedron.is_flat)
    return {};
  const Eigen::Vector3d center = first / whole.volume;
  whole.center = polyhedron.interior + center;
  whole.gyration_squared = second / whole.volume - center.squaredNorm();
  return whole;
}
}  // namespace

MassDistribution fillUniformly(const ConvexShape& shape)
{
  switch (shape.kind)
  {
    case ShapeKind::SPHERE:
      return fillSphere(shape.radius);
    case ShapeKind::CAPSULE:
      return fillCapsule(shape.radius, shape.half_length);
    case ShapeKind::CYLINDER:
      return fillCylinder(shape.radius, shape.half_length);
    case ShapeKind::BOX:
    case ShapeKind::HULL:
      return fillPolyhedron(shape.core);
    case ShapeKind::HALF_SPACE:
      break;
  }
  return {};
}

}  // namespace frictional_contact_sim
