#pragma once
/**
 * @file dry_friction_rows.h
 * @brief Dry friction of joints: u = v_j, |r| <= dt c, u = 0 or r = -dt c sign(u): set-valued, it holds at rest.
 */
#include <vector>

#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
class DryFrictionRows : public RowSource
{
public:
  /** @param memory one impulse a joint; sized here */
  DryFrictionRows(const std::vector<Body>& bodies, RowMemory& memory);
  const char* name() const override { return "dry friction of joints"; }
  void addJointRows(const StepContext& context, int body, int joint, RowSink& sink) override;

private:
  const std::vector<Body>& bodies_;
  JointMemory memory_;
};

}  // namespace frictional_contact_sim
