#include "frictional_contact_sim/collision/convex_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "polyhedron_search.h"

namespace frictional_contact_sim
{
namespace
{
void requirePositive(double value, const char* name)
{
  if (!(value > 0.0) || !std::isfinite(value))
  {
    throw std::invalid_argument(std::string("collision shape: ") + name + " is " + std::to_string(value) +
                                ", must be positive and finite");
  }
}

struct ShapeMaker
{
  ConvexShape operator()(const Sphere& sphere) const
  {
    if (sphere.radius != 0.0)  // a point: robots are published with such contact points
      requirePositive(sphere.radius, "sphere radius");
    ConvexShape shape;
    shape.kind = ShapeKind::SPHERE;
    shape.radius = sphere.radius;
    shape.core = pointPolyhedron();
    shape.half_extent.setConstant(sphere.radius);
    shape.bounding_radius = sphere.radius;
    return shape;
  }

  ConvexShape operator()(const Capsule& capsule) const
  {
    if (capsule.half_length == 0.0)
      return (*this)(Sphere{capsule.radius});
    requirePositive(capsule.radius, "capsule radius");
    requirePositive(capsule.half_length, "capsule half length");
    ConvexShape shape;
    shape.kind = ShapeKind::CAPSULE;
    shape.radius = capsule.radius;
    shape.half_length = capsule.half_length;
    shape.core = segmentPolyhedron(capsule.half_length);
    shape.half_extent << capsule.radius, capsule.radius, capsule.radius + capsule.half_length;
    shape.bounding_radius = capsule.radius + capsule.half_length;
    return shape;
  }

  ConvexShape operator()(const Cylinder& cylinder) const
  {
    requirePositive(cylinder.radius, "cylinder radius");
    requirePositive(cylinder.half_length, "cylinder half length");
    ConvexShape shape;
    shape.kind = ShapeKind::CYLINDER;
    shape.radius = cylinder.radius;
    shape.half_length = cylinder.half_length;
    shape.core = segmentPolyhedron(cylinder.half_length);
    shape.half_extent << cylinder.radius, cylinder.radius, cylinder.half_length;
    shape.bounding_radius = std::hypot(cylinder.radius, cylinder.half_length);
    return shape;
  }

  ConvexShape operator()(const Box& box) const
  {
    for (int i = 0; i < 3; ++i)
      requirePositive(box.half_size[i], "box half size");
    return fromPolyhedron(boxPolyhedron(box.half_size), ShapeKind::BOX);
  }

  ConvexShape operator()(const Mesh& mesh) const
  {
    return fromPolyhedron(loadMeshHull(mesh.path, mesh.scale), ShapeKind::HULL);
  }

  ConvexShape operator()(const HalfSpace&) const
  {
    ConvexShape shape;
    shape.kind = ShapeKind::HALF_SPACE;
    shape.half_extent.setConstant(std::numeric_limits<double>::infinity());
    shape.bounding_radius = std::numeric_limits<double>::infinity();
    return shape;
  }

  static ConvexShape fromPolyhedron(Polyhedron polyhedron, ShapeKind kind)
  {
    ConvexShape shape;
    shape.kind = kind;
    shape.center = polyhedron.center;
    shape.half_extent = polyhedron.half_extent;
    shape.bounding_radius = polyhedron.size;
    shape.core = std::move(polyhedron);
    return shape;
  }
};
}  // namespace

ConvexShape makeShape(const Geometry& geometry)
{
  return std::visit(ShapeMaker(), geometry);
}

ConvexShape makeShape(Polyhedron polyhedron)
{
  return ShapeMaker::fromPolyhedron(std::move(polyhedron), ShapeKind::HULL);
}

double lowestAlong(const ConvexShape& shape, const Eigen::Vector3d& n)
{
  if (shape.kind == ShapeKind::HALF_SPACE)
    return n.z() < 0.0 && n.x() == 0.0 && n.y() == 0.0 ? 0.0 : -std::numeric_limits<double>::infinity();
  if (shape.kind == ShapeKind::CYLINDER)
    return -shape.radius * std::hypot(n.x(), n.y()) - shape.half_length * std::abs(n.z());
  return n.dot(shape.core.vertices[farthestVertex(shape.core, -n)]) - shape.radius;
}

}  // namespace frictional_contact_sim
