#pragma once
/**
 * @file link_forces.h
 * @brief Forces on single URDF links over the last step, and how they moved: computed when asked for, once a step.
 */
#include <cstdint>
#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
class LinkForces
{
public:
  explicit LinkForces(const Simulator& simulator);

  /** @brief Forgets what it knows: after each step, reset or other change of the state. */
  void restart();
  /** @brief Whether the state comes from a step: without one there is no acceleration, and no joint wrench. */
  bool hasStep() const;

  /** @brief Sum of all contact forces on a URDF link: (force; torque about its origin) in its axes [N], [N m]. */
  Vector6d contactWrench(int body, int frame);
  /** @brief What the joint of a URDF link transmits to it, of any type: (force; torque about the link's origin, which
   * is the joint's) in the link's axes [N], [N m]. Needs hasStep(). */
  Vector6d jointWrench(int body, int frame);
  /** @brief Acceleration of a point of a link less gravity, mean over the step: what an accelerometer there feels.
   *  @param placement of the sensor in the link's frame. @return in the sensor's axes [m/s^2]. Needs hasStep(). */
  Eigen::Vector3d specificForce(int body, int frame, const Eigen::Isometry3d& placement);

private:
  struct BodyForces
  {
    explicit BodyForces(const MultibodyModel& model) : motion(model) {}
    MultibodyData motion;
    std::vector<Vector6d> applied;
    std::vector<Vector6d> joint_wrenches;
    std::uint64_t motion_of = 0;  // state_ that it is of
    std::uint64_t wrenches_of = 0;
  };

  const MultibodyData& motion(int body);
  template <typename Add>
  void forEachContact(const MultibodyData& data, int body, const Add& add) const;
  void addClosureWrenches(const MultibodyData& data, int body, std::vector<Vector6d>& applied);

  const Simulator& simulator_;
  std::vector<BodyForces> bodies_;
  std::uint64_t state_ = 1;  // counts the states seen
};

}  // namespace frictional_contact_sim
