#pragma once
/**
 * @file broad_phase.h
 * @brief Pairs of shapes that are near each other.
 *
 * Every shape has a fat box: its box widened by its margin and some room to move. Pairs of overlapping fat boxes are
 * kept, sorted; a step tests these alone, with the true boxes. Only a shape that has left its fat box gets a new one
 * and is looked for again, by FCL's trees or one by one (Verlet's neighbour list, 1967, with a tree behind it). So what
 * is found depends on the present boxes and margins alone, whatever was kept, and whoever looked. Memory is linear in
 * shapes and kept pairs.
 */
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "box_tree.h"
#include "frictional_contact_sim/collision/broad_phase_kind.h"

namespace frictional_contact_sim
{
/** @brief World bounding volumes of one shape. */
struct Bounds
{
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();  ///< of the axis-aligned box
  double radius = 0.0;  ///< of the sphere; infinite for a half space
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< half space: outward normal, center on its plane
  double margin = 0.0;  ///< how far away others are near; a pair has the larger of its two, none is near below 0 [m]
  double widening() const { return margin > 0.0 ? margin : 0.0; }
};

/** @brief Handles of a pair; a and b in the order of ContactPoint. */
struct ShapePair
{
  int a;
  int b;
};

/** @brief Which shapes may collide at all. */
class PairRule
{
public:
  virtual ~PairRule() = default;
  virtual bool mayCollide(int i, int k) const = 0;
  /** @brief On no body: such a shape is b. */
  virtual bool isStatic(int i) const = 0;
  /** @brief Never moves against the world, as a rule: two of these do not collide. */
  virtual bool isImmobile(int i) const = 0;
};

class BroadPhase
{
public:
  BroadPhase() = default;
  /** @brief Takes the kind alone: what is kept is found again. */
  BroadPhase(const BroadPhase& other) : kind_(other.kind_) {}
  BroadPhase& operator=(const BroadPhase&) = delete;

  void setKind(BroadPhaseKind kind)
  {
    kind_ = kind;
    clear();
  }
  /** @brief Forgets what is kept: the shapes or the rule are others. */
  void clear();

  /**
   * @brief Allowed pairs whose boxes are within the pair's margin, in the order of (a, b). Valid until the next call;
   * no allocation as long as there are no more pairs than before.
   */
  const std::vector<ShapePair>& candidates(const std::vector<Bounds>& bounds, const PairRule& rule);

private:
  void prepare(const std::vector<Bounds>& bounds, const PairRule& rule);
  void findLeft(const std::vector<Bounds>& bounds);
  void fatten(int handle, const Bounds& bounds);
  void renew(const std::vector<Bounds>& bounds, const PairRule& rule);
  void sortAdded();
  void searchList(const PairRule& rule);
  void searchTrees(const PairRule& rule);
  void searchPlanes(const std::vector<Bounds>& bounds, const PairRule& rule);
  void consider(int handle, int other, const PairRule& rule);
  void keep(int i, int k, const PairRule& rule);

  /// A half space as of the last search.
  struct Plane
  {
    int handle;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double margin = -1.0;  ///< at least the one it had
  };

  BroadPhaseKind kind_ = BroadPhaseKind::AUTO;
  bool is_ready_ = false;
  bool is_searched_ = false;
  std::vector<int> bounded_;  ///< handles, those that move first
  size_t moving_ = 0;  ///< of them
  std::vector<Plane> planes_;
  std::vector<AxisBox> boxes_;  ///< fat, by handle
  std::unique_ptr<BoxTree> moving_tree_;  ///< none with a list
  std::unique_ptr<BoxTree> resting_tree_;
  int refits_ = 0;  ///< of the moving tree since its leaves were put in anew

  std::vector<int> left_;  ///< shapes whose fat box is to be renewed
  std::vector<char> has_left_;  ///< by handle
  std::vector<int> found_;
  std::vector<ShapePair> kept_;  ///< with overlapping fat boxes, sorted
  std::vector<ShapePair> added_;
  std::vector<ShapePair> merged_;
  std::vector<int> begin_;  ///< of the pairs of every a
  std::vector<ShapePair> candidates_;
};

}  // namespace frictional_contact_sim
