#pragma once
/**
 * @file shape_model.h
 * @brief What of a collision world poses do not change: shapes, what they stand for, which pairs may collide.
 */
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "broad_phase.h"
#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
struct Instance
{
  ConvexShape shape;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< in the link, or in the world for static shapes
  bool is_immobile = false;  ///< static, or on a fixed base
};

struct CollidingBody
{
  std::vector<int> parent;  ///< of every link
  std::vector<int> shapes;  ///< handles
  std::vector<std::string> frame_names;
  bool is_mounted = false;  ///< on a fixed base, no floating joint
  bool collides_with_itself = true;
  std::vector<std::array<int, 2>> disabled;  ///< frames, the lower first; sorted
  std::vector<std::array<int, 2>> disabled_static;  ///< frame, handle of a static shape; sorted
};

/// What poses do not change: written while a world is loaded, then shared by its copies.
struct ShapeModel : PairRule
{
  std::vector<Instance> instances;
  std::vector<ShapeInfo> infos;
  std::vector<CollidingBody> bodies;
  std::vector<std::array<int, 4>> joined;  ///< body, link, body, link of loops; the lower first; sorted
  size_t most_vertices = 0;

  bool mayCollide(int i, int k) const override;
  bool isStatic(int i) const override { return infos[i].body < 0; }
  bool isImmobile(int i) const override { return instances[i].is_immobile; }

  /** @brief The shapes of these old handles, which become 0, 1, ...; the others are gone. */
  void arrange(const std::vector<int>& old_handles);
  /** @brief Bodies behind it move up; its shapes are to be gone already. */
  void eraseBody(int body);
};

}  // namespace frictional_contact_sim
