#pragma once
/**
 * @file mimic_rows.h
 * @brief Mimic joints: phi = q_j - multiplier q_followed - offset, one bilateral row G v + phi(q_m)/dt = 0 each.
 */
#include <vector>

#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
class MimicRows : public RowSource
{
public:
  /** @param memory one impulse a joint; sized here */
  MimicRows(const std::vector<Body>& bodies, RowMemory& memory);
  const char* name() const override { return "mimic joints"; }
  void addRows(const StepContext& context, RowSink& sink) override;
  void addJointRows(const StepContext& context, int body, int joint, RowSink& sink) override;
  double violation() const override { return violation_; }

private:
  const std::vector<Body>& bodies_;
  JointMemory memory_;
  double violation_ = 0.0;
};

}  // namespace frictional_contact_sim
