#include "elastic_overlap.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "frictional_contact_sim/collision/convex_shape.h"
#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/dynamics/surface_contacts.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double RESTING_SHARE = 1e-3;  ///< depth over the distance of nodes: not worth a word
constexpr double BESIDE = 1e-3;  ///< a plane body meets what is so far beside its plane [m]

/** World, of the shapes of each body: of an elastic one its surface nodes. */
std::vector<std::vector<Eigen::Vector3d>> shapeCentres(const WorldModel& world, const std::vector<BodyState>& states)
{
  std::vector<MultibodyData> poses;
  for (size_t b = 0; b < world.bodies.size(); ++b)
  {
    BodyState state = states[b];
    Body placed(world.bodies[b], state);
    updateEnd(placed);
    poses.push_back(placed.end);
  }
  std::vector<std::vector<Eigen::Vector3d>> centres(world.bodies.size());
  for (int handle = 0; handle < world.collision.shapeCount(); ++handle)
    if (const ShapeInfo& info = world.collision.shape(handle); info.body >= 0)
    {
      const auto body = static_cast<size_t>(info.body);
      const CollisionShape& shape = world.bodies[body].tree.shapes[static_cast<size_t>(info.index)];
      centres[body].push_back(poses[body].link_pose[static_cast<size_t>(info.link)] *
                              (shape.placement * world.collision.convexShape(handle).center));
    }
  return centres;
}

/** An elastic body where it is, in its own axes. */
class PlacedCells
{
public:
  PlacedCells(const ElasticSolid& solid, const BodyState& state)
    : parts_(solid.parts()), to_body_(state.base_pose.inverse()), nodes_(solid.displacements(state.q))
  {
    for (size_t i = 0; i < nodes_.size(); ++i)
      nodes_[i] += parts_.nodes[i];
    beside_ = parts_.dimension == 1 ? std::max(BESIDE, solid.nodeDistance()) : BESIDE;
    for (const std::array<int, 4>& cell : parts_.cells)
      boxes_.push_back(boxOf(cell));
    for (const Eigen::AlignedBox3d& box : boxes_)
      all_.extend(box);
  }

  /** Distance to the surface, 0 outside. @param x world [m] */
  double depthOf(Eigen::Vector3d x) const
  {
    x = to_body_ * x;
    if (parts_.cells.empty() || !all_.contains(x))
      return 0.0;
    size_t cell = 0;
    while (cell < boxes_.size() && !(boxes_[cell].contains(x) && isIn(parts_.cells[cell], x)))
      ++cell;
    if (cell == boxes_.size())
      return 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (const std::array<int, 3>& facet : parts_.facets)
    {
      Eigen::Matrix3d corners = Eigen::Matrix3d::Zero();
      for (int k = 0; k < parts_.dimension; ++k)
        corners.col(k) = nodes_[static_cast<size_t>(facet[static_cast<size_t>(k)])];
      Eigen::Vector3d away = x - closestOnFacet(corners, parts_.dimension, x).point;
      for (int axis = 0; axis < 3; ++axis)
        away[axis] = isMeshAxis(axis) ? away[axis] : 0.0;
      least = std::min(least, away.norm());
    }
    return least;
  }

private:
  bool isMeshAxis(int axis) const
  {
    const std::vector<int>& axes = axesOf(parts_.dimension);
    return std::find(axes.begin(), axes.end(), axis) != axes.end();
  }

  Eigen::AlignedBox3d boxOf(const std::array<int, 4>& cell) const
  {
    Eigen::AlignedBox3d box;
    for (int a = 0; a <= parts_.dimension; ++a)
      box.extend(nodes_[static_cast<size_t>(cell[static_cast<size_t>(a)])]);
    for (int axis = 0; axis < 3; ++axis)
      if (!isMeshAxis(axis))
      {
        box.min()[axis] -= beside_;
        box.max()[axis] += beside_;
      }
    return box;
  }

  /** By barycentric coordinates, along the axes of the mesh. */
  bool isIn(const std::array<int, 4>& cell, const Eigen::Vector3d& x) const
  {
    const std::vector<int>& axes = axesOf(parts_.dimension);
    const Eigen::Vector3d& corner = nodes_[static_cast<size_t>(cell[0])];
    Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();
    for (int i = 0; i < parts_.dimension; ++i)
    {
      const int axis = axes[static_cast<size_t>(i)];
      arm[i] = x[axis] - corner[axis];
      for (int a = 0; a < parts_.dimension; ++a)
        edges(i, a) = nodes_[static_cast<size_t>(cell[static_cast<size_t>(a) + 1])][axis] - corner[axis];
    }
    const Eigen::Vector3d weights = edges.inverse() * arm;
    return weights.minCoeff() >= 0.0 && weights.sum() <= 1.0;
  }

  const ElasticParts& parts_;
  Eigen::Isometry3d to_body_;
  std::vector<Eigen::Vector3d> nodes_;
  double beside_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  Eigen::AlignedBox3d all_;
};
}  // namespace

std::vector<ElasticOverlap> findElasticOverlaps(const WorldModel& world, const std::vector<BodyState>& states, int body)
{
  std::vector<ElasticOverlap> overlaps;
  std::vector<std::vector<Eigen::Vector3d>> centres;
  const int count = static_cast<int>(world.bodies.size());
  for (int outer = 0; outer < count; ++outer)
  {
    const BodyModel& around = world.bodies[static_cast<size_t>(outer)];
    const auto* solid = dynamic_cast<const ElasticSolid*>(around.solid.get());
    if (solid == nullptr)
      continue;
    if (centres.empty())
      centres = shapeCentres(world, states);
    const PlacedCells cells(*solid, states[static_cast<size_t>(outer)]);
    for (int inner = 0; inner < count; ++inner)
    {
      if (inner == outer || (body >= 0 && inner != body && outer != body))
        continue;
      const BodyModel& inside = world.bodies[static_cast<size_t>(inner)];
      double depth = 0.0;
      for (const Eigen::Vector3d& centre : centres[static_cast<size_t>(inner)])
        depth = std::max(depth, cells.depthOf(centre));
      double most = solid->nodeDistance();
      if (inside.solid)
        most = std::min(most, inside.solid->nodeDistance());
      if (depth > RESTING_SHARE * most)
        overlaps.push_back(
            {"body '" + inside.name + "' starts " + numberText(depth) + " m deep in elastic body '" + around.name + "'",
             depth <= most});
    }
  }
  return overlaps;
}

}  // namespace frictional_contact_sim
