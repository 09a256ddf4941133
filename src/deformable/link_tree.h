#pragma once
/**
 * @file link_tree.h
 * @brief Links and shapes of a deformable body: a root on a fixed base, and a link with one shape for each of its
 * places, whose pose the body's mechanics set. finalize() is the caller's.
 */
#include <string>

#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
inline MultibodyModel rootTree(const std::string& name)
{
  MultibodyModel tree;
  tree.name = name;
  tree.links.push_back({name, {}});
  tree.joints.emplace_back();
  tree.frames.emplace_back(name, 0, Eigen::Isometry3d::Identity());
  return tree;
}

/** @param origin of the link in the root's frame at rest [m] @param turn of the shape in the link */
inline void addLink(const std::string& label, const Eigen::Vector3d& origin, const Geometry& geometry,
                    const Eigen::Matrix3d& turn, MultibodyModel& tree)
{
  Joint joint;
  joint.parent = 0;
  joint.placement.translation() = origin;
  tree.joints.push_back(joint);
  CollisionShape shape;
  shape.name = label;
  shape.link = static_cast<int>(tree.links.size());
  shape.geometry = geometry;
  shape.placement.linear() = turn;
  tree.shapes.push_back(shape);
  tree.links.push_back({label, {}});
}

}  // namespace frictional_contact_sim
