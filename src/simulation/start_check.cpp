#include "start_check.h"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "frictional_contact_sim/collision/convex_shape.h"
#include "frictional_contact_sim/collision/mass_distribution.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double RESTING_SHARE = 1e-3;  ///< depth over radius of the smaller shape: not worth a word
constexpr double IMPLAUSIBLE = 100.0;  ///< ratio of moments

/** A place in the scene: body and frame, -1 for the ground. */
using Side = std::array<int, 2>;

Side sideOf(const ShapeInfo& shape)
{
  return {shape.body, shape.frame};
}

std::string describe(const WorldModel& world, const Side& side)
{
  if (side[0] < 0)
    return "the ground";
  const BodyModel& body = world.bodies[static_cast<size_t>(side[0])];
  return "body '" + body.name + "' (link '" + body.tree.frames[static_cast<size_t>(side[1])].name + "')";
}

/** Smaller bounding radius of the two [m]; the half space has none. */
double smallerRadius(const CollisionWorld& collision, const ContactPoint& point)
{
  const ConvexShape& a = collision.convexShape(point.shape_a);
  const ConvexShape& b = collision.convexShape(point.shape_b);
  if (b.kind == ShapeKind::HALF_SPACE)
    return a.bounding_radius;
  return std::min(a.bounding_radius, b.bounding_radius);
}

/** All shapes of a link, filled uniformly with one density; the centre in the link frame. */
MassDistribution fillLink(const WorldModel& world, int body, int link)
{
  MassDistribution whole;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  double second = 0.0;
  for (int handle = 0; handle < world.collision.shapeCount(); ++handle)
  {
    const ShapeInfo& info = world.collision.shape(handle);
    if (info.body != body || info.link != link)
      continue;
    const MassDistribution shape = fillUniformly(world.collision.convexShape(handle));
    const Eigen::Vector3d center =
        world.bodies[static_cast<size_t>(body)].tree.shapes[static_cast<size_t>(info.index)].placement * shape.center;
    whole.volume += shape.volume;
    first += shape.volume * center;
    second += shape.volume * (shape.gyration_squared + center.squaredNorm());
  }
  if (!(whole.volume > 0.0))
    return {};
  whole.center = first / whole.volume;
  whole.gyration_squared = second / whole.volume - whole.center.squaredNorm();
  return whole;
}
}  // namespace

std::vector<std::string> findOverlaps(const WorldModel& world, CollisionWorld collision, int body)
{
  std::map<std::pair<Side, Side>, double> depths;  // in the order of the scene
  for (const ContactPoint& point : collision.detect(0.0))
  {
    const Side a = sideOf(collision.shape(point.shape_a));
    const Side b = sideOf(collision.shape(point.shape_b));
    const bool concerns = body < 0 || a[0] == body || b[0] == body;
    if (!concerns || a[0] == b[0] || -point.gap <= RESTING_SHARE * smallerRadius(collision, point))
      continue;
    double& depth = depths[{a, b}];
    depth = std::max(depth, -point.gap);
  }
  std::vector<std::string> lines;
  for (const auto& [pair, depth] : depths)
  {
    std::ostringstream text;
    text << describe(world, pair.first) << " starts " << depth << " m deep in " << describe(world, pair.second);
    lines.push_back(text.str());
  }
  return lines;
}

std::vector<std::string> findImplausibleInertia(const WorldModel& world, int body)
{
  std::vector<std::string> warnings;
  const BodyModel& model = world.bodies[static_cast<size_t>(body)];
  for (size_t link = 0; link < model.tree.links.size(); ++link)
  {
    const RigidInertia& inertia = model.tree.links[link].inertia;
    const double sum = inertia.rotational.trace();
    const MassDistribution shapes = fillLink(world, body, static_cast<int>(link));
    if (!(inertia.mass > 0.0) || !(sum > 0.0) || !(shapes.gyration_squared > 0.0) ||
        velocitySize(model.tree.joints[link].type) == 0)
      continue;
    const double of_shapes = 2.0 * inertia.mass * shapes.gyration_squared;
    const double about_center = of_shapes + 2.0 * inertia.mass * (shapes.center - inertia.center).squaredNorm();
    if (IMPLAUSIBLE * sum >= of_shapes && sum <= IMPLAUSIBLE * about_center)
      continue;
    std::ostringstream text;
    text << "link '" << model.tree.links[link].name << "': moments of inertia add up to " << sum
         << " kg m^2, those of its mass " << inertia.mass << " kg in its collision shapes to " << of_shapes
         << ": units, scale or a digit?";
    warnings.push_back(text.str());
  }
  return warnings;
}

}  // namespace frictional_contact_sim
