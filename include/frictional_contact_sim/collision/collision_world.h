#pragma once
/**
 * @file collision_world.h
 * @brief Contact points between the shapes of several bodies and the ground.
 *
 * FCL gives the broad phase when there are many shapes; contact points, gaps and normals are computed in closed form
 * from the supporting features (face, edge, vertex, primitive) to round-off (narrow_phase.h). At most 8 points a pair.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/collision/broad_phase_kind.h"
#include "frictional_contact_sim/collision/contact_id.h"
#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
/**
 * @brief One contact point between shape_a and shape_b; the normal points from b to a.
 *
 * A static shape is always b; of two shapes of bodies, a has the lower handle.
 */
struct ContactPoint
{
  ContactId id;  ///< same pair of features: same id, as long as it persists
  int shape_a = 0;  ///< 0, 1, ... in the order of addBody / addStatic
  int shape_b = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world, midway between the two surface points [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< world, unit, from b to a
  double gap = 0.0;  ///< along the normal, negative = penetration [m]
  /// Found elsewhere and carried to this pose: the gap that a row of it keeps is row_gap, see dynamics/contact_set.h.
  bool is_linearised = false;
  double row_gap = 0.0;  ///< [m]
};

/** @brief What a shape handle stands for. */
struct ShapeInfo
{
  int body = -1;  ///< index from addBody; -1 for static shapes
  int link = -1;  ///< link in the body's model; -1 for static shapes
  int frame = -1;  ///< URDF link in the body's model
  int index = -1;  ///< in the body's model.shapes, all parts of a mesh have the same; -1 for static shapes
  std::string link_name;  ///< URDF link name ("ground" for the plane)
  std::string name;  ///< collision name
};

struct ConvexShape;

/**
 * @brief Copies share what poses do not change (shapes with their hulls, tables, allowed pairs) and have poses and
 * workspace of their own, so each may be used in a thread of its own once it is loaded. A copy that is loaded further
 * gets shapes of its own.
 */
class CollisionWorld
{
public:
  CollisionWorld();
  ~CollisionWorld();
  CollisionWorld(const CollisionWorld& other);
  CollisionWorld& operator=(const CollisionWorld& other);
  CollisionWorld(CollisionWorld&&) noexcept;
  CollisionWorld& operator=(CollisionWorld&&) noexcept;

  /**
   * @brief Adds all shapes of a body; loads its meshes, each file once: a convex hull for each of its parts, with a
   * handle of its own and the ShapeInfo of the mesh. Pairs on one link, and on bodies joined by one joint, never
   * collide; nor do shapes of a fixed base with static shapes.
   * @param warnings takes a line for each mesh that its hulls add to, naming link and file
   * @return index of the body
   * @throws ModelError for a mesh that cannot be read: link, file and reason
   */
  int addBody(const MultibodyModel& model, std::vector<std::string>* warnings = nullptr);
  /** @brief Adds a shape fixed in the world, the ground plane for example. @return shape handle */
  int addStatic(const Geometry& geometry, const Eigen::Isometry3d& pose, const std::string& name);

  /** @brief Static shapes get the last handles, as in a world where they were added last. */
  void putStaticLast();
  /** @brief Bodies behind it and their shapes move up; a number may mean another one then. */
  void removeBody(int body);

  /** @brief Two links of a body never collide. @throws std::invalid_argument naming an unknown link */
  void disablePair(int body, const std::string& link_1, const std::string& link_2);

  /** @brief Two links, each {body, link of its model}, never collide: a joint beside the trees joins them. */
  void disableJoined(std::array<int, 2> one, std::array<int, 2> other);

  /** @brief No two links of a body collide. */
  void disableSelfCollision(int body);

  /**
   * @brief Disables the pairs of links *within one body* that overlap now (initial pose; gap < -1e-9 m, so links that
   * only touch still collide), and those of a body on a fixed base with static shapes: what is mounted in the ground
   * can never leave it. Needs setPoses.
   * @param body that is looked at; -1: all
   * @return "link_1 - link_2" of each pair disabled
   */
  std::vector<std::string> disableOverlaps(int body = -1);

  /** @brief Link poses of a body, from its data. */
  void setPoses(int body, const MultibodyData& data);
  /** @brief The same for one link. */
  void setLinkPose(int body, int link, const Eigen::Isometry3d& pose);

  /**
   * @brief Shapes that do not move against each other do not collide: of each shape the number of its set, none in any
   * where the list is empty. Belongs to this world alone, as poses do.
   */
  void setRigidSets(std::vector<int> set_of_shape);

  /** @brief Who looks for near pairs; the points are the same. Copies have it too. */
  void setBroadPhase(BroadPhaseKind kind);

  /**
   * @brief Contact points with gap <= margin, ordered by (shape_a, shape_b, feature): deterministic. No allocation
   * after warm-up; the list is valid until the next call.
   */
  const std::vector<ContactPoint>& detect(double margin);
  /**
   * @brief The same with a margin a body; a pair has the larger of its two, so that no third body changes its points,
   * and is not looked at where that is negative.
   */
  const std::vector<ContactPoint>& detect(const std::vector<double>& body_margins);

  /** @brief Of each of the body's model.shapes that is a mesh its farthest point from the link's origin [m], else 0. */
  std::vector<double> meshReach(int body) const;
  /** @brief Lowest z over all points of all shapes of a body at the poses set [m]; +infinity without shapes. */
  double lowestPoint(int body) const;

  int shapeCount() const;
  const ShapeInfo& shape(int handle) const;
  const ConvexShape& convexShape(int handle) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace frictional_contact_sim
