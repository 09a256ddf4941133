#pragma once
/**
 * @file surface_contacts.h
 * @brief Contacts of deformable bodies with each other: surface nodes of one against facets of the other, one a node.
 *
 * The nodes of a deformable body are points to the collision world, which knows how they meet planes and rigid shapes.
 * Here a node x of one deformable body meets the facet of another that is nearest to it:
 *
 *     gap = n . (x - c)       c the closest point of the facet, n its outward normal (c to x where x is beside it)
 *
 * Of two bodies both are asked, so that no node of either goes through. Facets that are single points (ends of bars)
 * are asked once, for the nodes of the earlier body. A facet contact is b; its feature there is FACE and the facet.
 */
#include <functional>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/dynamics/body.h"

namespace frictional_contact_sim
{
class SurfaceContacts
{
public:
  using DataOf = std::function<const MultibodyData&(int body)>;

  SurfaceContacts() = default;
  SurfaceContacts(const std::vector<Body>& bodies, const CollisionWorld& world);

  bool empty() const { return surfaces_.empty(); }  ///< no body is deformable
  /**
   * @param points of the collision world; those between two deformable bodies are left out
   * @param margins of the bodies [m], a pair has the larger, none below 0
   * @param all `points` and the facet contacts, ordered by id
   */
  void find(const std::vector<ContactPoint>& points, const std::vector<double>& margins, const DataOf& data,
            std::vector<ContactPoint>& all) const;

private:
  struct Surface
  {
    int body;
    const DynamicBody* solid;
    std::vector<int> handles;  ///< links: shape of the node, -1 of the root
  };
  void findPair(const Surface& nodes, const Surface& facets, double margin, const DataOf& data,
                std::vector<ContactPoint>& all) const;

  std::vector<Surface> surfaces_;
  std::vector<char> is_node_;  ///< shapes
};

/** @brief Closest point of a facet, and the weights of its nodes there (their sum is 1). */
struct FacetPoint
{
  Eigen::Vector3d point;
  Eigen::Vector3d weights;
};
/** @param nodes columns: `count` positions */
FacetPoint closestOnFacet(const Eigen::Matrix3d& nodes, int count, const Eigen::Vector3d& x);

}  // namespace frictional_contact_sim
