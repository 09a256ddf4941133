#include "frictional_contact_sim/dynamics/surface_contacts.h"

#include <algorithm>
#include <limits>

#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
namespace
{
/** Of a segment a, b: the share of b at the point nearest to x. */
double shareOnSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& x)
{
  const Eigen::Vector3d along = b - a;
  const double square = along.squaredNorm();
  return square > 0.0 ? std::clamp(along.dot(x - a) / square, 0.0, 1.0) : 0.0;
}

struct FacetView
{
  Eigen::Matrix3d nodes = Eigen::Matrix3d::Zero();  ///< columns
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
};

FacetView viewOf(const Facet& facet, const MultibodyData& data)
{
  FacetView view;
  for (int k = 0; k < facet.count; ++k)
    view.nodes.col(k) = data.link_pose[facet.links[k]].translation();
  const Eigen::Matrix3d axes = data.base_pose.linear();
  const Eigen::Vector3d edge = view.nodes.col(1) - view.nodes.col(0);
  if (facet.count == 3)
    view.normal = edge.cross(view.nodes.col(2) - view.nodes.col(0)).normalized();
  else if (facet.count == 2)
    view.normal = edge.cross(axes.col(1)).normalized();
  else
    view.normal = axes * facet.axis;
  return view;
}

/** The nearest facet seen so far. */
struct Nearest
{
  double distance = std::numeric_limits<double>::infinity();
  double height = 0.0;  ///< above its plane
  int facet = -1;
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/** Of facets that share the nearest point the one that x stands out from most decides on which side x is. */
bool isNearer(double distance, double height, const Nearest& other, double tie)
{
  if (std::abs(distance - other.distance) <= tie)
    return std::abs(height) > std::abs(other.height);
  return distance < other.distance;
}

struct Extent
{
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  bool contains(const Eigen::Vector3d& x, double margin) const
  {
    return (x.array() >= low.array() - margin).all() && (x.array() <= high.array() + margin).all();
  }
};
}  // namespace

FacetPoint closestOnFacet(const Eigen::Matrix3d& nodes, int count, const Eigen::Vector3d& x)
{
  FacetPoint result{nodes.col(0), Eigen::Vector3d::UnitX()};
  if (count == 1)
    return result;
  if (count == 3)
  {
    const Eigen::Vector3d u = nodes.col(1) - nodes.col(0);
    const Eigen::Vector3d v = nodes.col(2) - nodes.col(0);
    const Eigen::Vector3d w = x - nodes.col(0);
    const Eigen::Vector3d normal = u.cross(v);
    const double square = normal.squaredNorm();
    const double share_v = square > 0.0 ? u.cross(w).dot(normal) / square : -1.0;
    const double share_u = square > 0.0 ? w.cross(v).dot(normal) / square : -1.0;
    if (share_u >= 0.0 && share_v >= 0.0 && share_u + share_v <= 1.0)
    {
      result.weights << 1.0 - share_u - share_v, share_u, share_v;
      result.point = nodes * result.weights;
      return result;
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < (count == 3 ? 3 : 1); ++k)
  {
    const int next = (k + 1) % 3;
    const double share = shareOnSegment(nodes.col(k), nodes.col(next), x);
    const Eigen::Vector3d point = (1.0 - share) * nodes.col(k) + share * nodes.col(next);
    const double distance = (x - point).squaredNorm();
    if (distance >= least)
      continue;
    least = distance;
    result.point = point;
    result.weights.setZero();
    result.weights[k] = 1.0 - share;
    result.weights[next] += share;
  }
  return result;
}

SurfaceContacts::SurfaceContacts(const std::vector<Body>& bodies, const CollisionWorld& world)
{
  for (size_t b = 0; b < bodies.size(); ++b)
    if (const DynamicBody* solid = bodies[b].model.solid.get())
      surfaces_.push_back({static_cast<int>(b), solid, std::vector<int>(bodies[b].model.tree.links.size(), -1)});
  if (surfaces_.empty())
    return;
  is_node_.assign(world.shapeCount(), 0);
  for (int handle = 0; handle < world.shapeCount(); ++handle)
    for (Surface& surface : surfaces_)
      if (world.shape(handle).body == surface.body)
      {
        const bool is_node = world.convexShape(handle).bounding_radius == 0.0;
        surface.handles[world.shape(handle).link] = is_node ? handle : -1;
        is_node_[handle] = is_node ? 1 : 0;
      }
  const auto hasNoNode = [](const Surface& surface)
  { return std::all_of(surface.handles.begin(), surface.handles.end(), [](int handle) { return handle < 0; }); };
  surfaces_.erase(std::remove_if(surfaces_.begin(), surfaces_.end(), hasNoNode), surfaces_.end());
}

void SurfaceContacts::find(const std::vector<ContactPoint>& points, const std::vector<double>& margins,
                           const DataOf& data, std::vector<ContactPoint>& all) const
{
  all.clear();
  for (const ContactPoint& point : points)
    if (!is_node_[point.shape_a] || !is_node_[point.shape_b])
      all.push_back(point);
  for (const Surface& nodes : surfaces_)
    for (const Surface& facets : surfaces_)
    {
      const double margin = std::max(margins[nodes.body], margins[facets.body]);
      const bool is_end = !facets.solid->facets().empty() && facets.solid->facets().front().count == 1;
      if (nodes.body != facets.body && margin >= 0.0 && (!is_end || nodes.body < facets.body))
        findPair(nodes, facets, margin, data, all);
    }
  std::sort(all.begin(), all.end(), [](const ContactPoint& a, const ContactPoint& b) { return a.id < b.id; });
}

void SurfaceContacts::findPair(const Surface& nodes, const Surface& facets, double margin, const DataOf& data,
                               std::vector<ContactPoint>& all) const
{
  const MultibodyData& of_nodes = data(nodes.body);
  const MultibodyData& of_facets = data(facets.body);
  const std::vector<Facet>& list = facets.solid->facets();
  Extent box;
  for (size_t link = 1; link < of_facets.link_pose.size(); ++link)
  {
    box.low = box.low.cwiseMin(of_facets.link_pose[link].translation());
    box.high = box.high.cwiseMax(of_facets.link_pose[link].translation());
  }
  const double depth = std::min(nodes.solid->nodeDistance(), facets.solid->nodeDistance());
  std::vector<FacetView> views;
  for (size_t link = 1; link < of_nodes.link_pose.size(); ++link)
  {
    const Eigen::Vector3d& x = of_nodes.link_pose[link].translation();
    // ends of bars move along their line alone: beside it nothing meets
    if (!box.contains(x, list.empty() || list.front().count > 1 ? margin : std::max(margin, depth)))
      continue;
    if (views.empty())
      for (const Facet& facet : list)
        views.push_back(viewOf(facet, of_facets));
    Nearest nearest;
    for (size_t k = 0; k < list.size(); ++k)
    {
      const FacetPoint closest = closestOnFacet(views[k].nodes, list[k].count, x);
      const double distance = (x - closest.point).norm();
      const double height = views[k].normal.dot(x - closest.point);
      if (isNearer(distance, height, nearest, 1e-9 * depth))
        nearest = {distance, height, static_cast<int>(k), closest.point, views[k].normal};
    }
    if (nearest.facet < 0)
      continue;
    double gap = nearest.height;
    if (list[nearest.facet].count > 1 && gap > 0.0 && gap < (1.0 - 1e-12) * nearest.distance)
    {
      gap = nearest.distance;  // beside the facet: the edge or corner is what x meets
      nearest.normal = (x - nearest.point) / nearest.distance;
    }
    if (gap > margin || gap < -depth)
      continue;
    const int a = nodes.handles[link];
    const int b = facets.handles[list[nearest.facet].links[0]];
    ContactPoint point;
    point.id = makeContactId(a, b, makeFeature(FeatureKind::VERTEX, 0), makeFeature(FeatureKind::FACE, nearest.facet));
    point.shape_a = a;
    point.shape_b = b;
    point.position = nearest.point + 0.5 * gap * nearest.normal;
    point.normal = nearest.normal;
    point.gap = gap;
    all.push_back(point);
  }
}

}  // namespace frictional_contact_sim
