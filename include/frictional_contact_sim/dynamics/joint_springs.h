#pragma once
/**
 * @file joint_springs.h
 * @brief Springs at joints (BodyModel::springs), implicit: no row of their own.
 *
 * The mean of both ends acts, F = k (rest - (q_k + q_k+1)/2) with q_k+1 = q_k + dt (v_k + v_k+1)/2: its work over a
 * step is what 1/2 k (q - rest)^2 loses, exactly, at any stiffness and step. Hairer, Lubich, Wanner (2006), II.1 (the
 * implicit midpoint rule).
 */
#include <vector>

#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
class JointSprings : public RowSource
{
public:
  explicit JointSprings(std::vector<Body>& bodies) : bodies_(bodies) {}

  const char* name() const override { return "springs"; }
  void addMomentum(const StepContext& context, int body, VectorOut momentum) override;

private:
  std::vector<Body>& bodies_;
};

}  // namespace frictional_contact_sim
