#pragma once
/**
 * @file limit_rows.h
 * @brief Joint limits: one unilateral row a side that is near, u = +-v_j + shift, with the normal law of contacts.
 */
#include <vector>

#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
class LimitRows : public RowSource
{
public:
  /** @param memory two impulses (lower, upper) a joint; sized here */
  LimitRows(const std::vector<Body>& bodies, RowMemory& memory);
  const char* name() const override { return "joint limits"; }
  void addJointRows(const StepContext& context, int body, int joint, RowSink& sink) override;

private:
  const std::vector<Body>& bodies_;
  JointMemory memory_;
};

}  // namespace frictional_contact_sim
