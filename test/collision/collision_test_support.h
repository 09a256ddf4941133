#pragma once
/**
 * @file collision_test_support.h
 * @brief Random poses, models made by hand, and shorthands of the collision tests.
 */
#include <Eigen/Geometry>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/collision/narrow_phase.h"

namespace frictional_contact_sim
{
inline double uniform(std::mt19937& random, double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Eigen::Vector3d randomVector(std::mt19937& random)
{
  return {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)};
}

inline Eigen::Matrix3d randomRotation(std::mt19937& random)
{
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

inline Eigen::Isometry3d pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
{
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = rotation;
  result.translation() = translation;
  return result;
}

inline Eigen::Isometry3d at(double x, double y, double z)
{
  return pose(Eigen::Matrix3d::Identity(), {x, y, z});
}

inline Eigen::Isometry3d randomPose(std::mt19937& random, double reach)
{
  const Eigen::Matrix3d rotation = randomRotation(random);
  return pose(rotation, reach * randomVector(random));
}

/// Contact points of a pair, in b's frame.
inline std::vector<PairContact> contactsOf(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b,
                                           double margin)
{
  const auto manifold = std::make_unique<Manifold>();
  collide(a, b, a_in_b, margin, *manifold);
  return {manifold->points.begin(), manifold->points.begin() + manifold->count};
}

inline double smallestGap(const std::vector<PairContact>& points)
{
  double smallest = std::numeric_limits<double>::infinity();
  for (const PairContact& point : points)
  {
    smallest = std::min(smallest, point.gap);
  }
  return smallest;
}

/// A free body with one link and the given shapes on it.
inline MultibodyModel freeBody(const std::vector<Geometry>& shapes, const std::string& link = "body")
{
  MultibodyModel model;
  model.name = link;
  model.links.push_back({link, {}});
  Joint joint;
  joint.type = JointType::FLOATING;
  model.joints.push_back(joint);
  model.frames.push_back({link, 0, Eigen::Isometry3d::Identity()});
  for (const Geometry& geometry : shapes)
  {
    CollisionShape shape;
    shape.name = link + "_collision";
    shape.geometry = geometry;
    model.shapes.push_back(shape);
  }
  return model;
}

/// Adds a link on a revolute joint (axis z through `origin`) with one shape at its origin.
inline void addLink(MultibodyModel& model, const std::string& name, int parent, const Geometry& geometry)
{
  const int body = static_cast<int>(model.links.size());
  model.links.push_back({name, {}});
  Joint joint;
  joint.name = name + "_joint";
  joint.type = JointType::REVOLUTE;
  joint.parent = parent;
  model.joints.push_back(joint);
  model.frames.push_back({name, body, Eigen::Isometry3d::Identity()});
  CollisionShape shape;
  shape.name = name + "_collision";
  shape.frame = static_cast<int>(model.frames.size()) - 1;
  shape.link = body;
  shape.geometry = geometry;
  model.shapes.push_back(shape);
}

}  // namespace frictional_contact_sim
