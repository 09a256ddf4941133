#pragma once
/**
 * @file limit_rows.h
 * @brief Joint limits: one unilateral row a side that the step could reach, u = +-v_j + shift, with the normal law of
 * contacts. Rows are for what the free motion could close; a limit that an answer goes beyond gets one then.
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
  void begin(const StepContext& context) override;
  void addJointRows(const StepContext& context, int body, int joint, RowSink& sink) override;
  Again lookAhead(const StepContext& context, const Solution& solution) override;

private:
  /// A side of a joint with a finite limit.
  struct Side
  {
    int body;
    int joint;
    int side;  ///< 0 lower, 1 upper
    bool has_row = false;
    bool needed = false;  ///< an answer has gone beyond it
  };

  double gap(const StepContext& context, const Side& side) const;

  const std::vector<Body>& bodies_;
  JointMemory memory_;
  std::vector<Side> sides_;
  std::vector<std::vector<int>> first_;  ///< bodies, joints: position of its first side in sides_, -1 without limits
};

}  // namespace frictional_contact_sim
