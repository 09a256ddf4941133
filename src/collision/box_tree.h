#pragma once
/**
 * @file box_tree.h
 * @brief FCL's dynamic tree over axis-aligned boxes with handles (Bender et al.'s incremental tree as in Bullet).
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

namespace frictional_contact_sim
{
struct AxisBox
{
  Eigen::Vector3d lower;
  Eigen::Vector3d upper;
};

inline bool overlap(const AxisBox& a, const AxisBox& b)
{
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

/** @brief Handles 0 to n - 1, some of which are in the tree; boxes are all handles' boxes, looked up by handle. */
class BoxTree
{
public:
  /** @param members handles in the tree */
  BoxTree(const std::vector<int>& members, const std::vector<AxisBox>& boxes);
  ~BoxTree();

  /** @brief Some boxes have changed: their leaves are taken out and put in again. */
  void update(const std::vector<int>& changed, const std::vector<AxisBox>& boxes);
  /** @brief Most have: all are refitted in place, which is cheaper and lets the tree grow worse. */
  void refit(const std::vector<AxisBox>& boxes);
  /** @brief Appends the handles whose boxes overlap this one; with the boxes of this update or earlier, larger ones. */
  void find(const AxisBox& box, std::vector<int>& found);
  /** @brief Appends all pairs of overlapping boxes, first and second in turn. */
  void findAll(std::vector<int>& found) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace frictional_contact_sim
