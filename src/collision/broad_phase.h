#pragma once
/**
 * @file broad_phase.h
 * @brief Candidate pairs of bounding boxes: a list of all allowed pairs for few shapes, FCL's dynamic tree for many.
 */
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace frictional_contact_sim
{
/** @brief World bounding volumes of one shape. */
struct Bounds
{
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();  ///< of the axis-aligned box
  double radius = 0.0;  ///< of the sphere; infinite for a half space
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< half space: outward normal, center on its plane
};

/** @brief Handles of a pair; a and b in the order of ContactPoint. */
struct ShapePair
{
  int a;
  int b;
};

/** @brief The allowed pairs among n shapes, in the order of (a, b); tells which of them are near each other. */
class BroadPhase
{
public:
  BroadPhase();
  ~BroadPhase();
  /** @brief Shares the allowed pairs and makes a tree of its own: what is found does not depend on earlier calls. */
  BroadPhase(const BroadPhase& other);
  BroadPhase& operator=(const BroadPhase&) = delete;

  /** @param pairs allowed pairs sorted by (a, b) @param bounds all shapes */
  void reset(std::vector<ShapePair> pairs, const std::vector<Bounds>& bounds);

  /** @brief Allowed pairs whose boxes are within margin, in the order of (a, b). Valid until the next call. */
  const std::vector<ShapePair>& candidates(const std::vector<Bounds>& bounds, double margin);

private:
  struct Allowed;
  struct Tree;

  void prepare();

  std::shared_ptr<const Allowed> allowed_;
  std::vector<ShapePair> candidates_;
  std::unique_ptr<Tree> tree_;  ///< many shapes only
};

}  // namespace frictional_contact_sim
