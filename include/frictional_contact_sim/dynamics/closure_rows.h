#pragma once
/**
 * @file closure_rows.h
 * @brief Closures: bilateral rows for the relative motion of an anchor of link a in link b. Three for its point in
 * world axes, and as many about axes as the type has: none of POINT, two across the axis of AXIS, three of WELD.
 *
 *     G v + b = 0,   G v + base = (v_a(p) - v_b(p); w_a - w_b),   b = base + (e(q_m) - kept)/dt + correction
 *
 * e = (position; rotation vector) of the anchor where link a has it, less where link b has it, [m], [rad]; p between
 * the two places, so that both links get opposite impulses at one point. What is missing from outside (a state that was
 * written) is closed at 0.1 m/s and 1 rad/s at most: `kept` is what is left of it; in a run it is zero.
 *
 * q_n, the next midpoint, is q_m (+) dt v to first order. So each answer is looked at there with the true geometry, and
 * the step is solved again with correction += (e(q_n) - kept)/dt until that is below 1e-11; a round gains a factor of
 * about dt times the angular velocity. Midpoints on the weld exactly, velocities along the chord between them: SHAKE,
 * whose impulses do no work over a turn and whose error does not grow.
 *
 * Source: Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977); Hairer, Lubich, Wanner, Geometric Numerical
 * Integration (2006), VII.1.4.
 */
#include <memory>
#include <utility>
#include <vector>

#include "frictional_contact_sim/dynamics/closure.h"
#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
/**
 * @brief e of the head: position in world axes; rotation vector along the columns of `basis`, those of the type. Zero
 * below the round-off of the poses. @param a anchor as link a has it. @param wanted as link b has it
 */
Vector6d closureError(LoopType type, const Eigen::Isometry3d& a, const Eigen::Isometry3d& wanted,
                      const Eigen::Matrix3d& basis);
/** @brief Directions of the rows about axes: columns, world axes. @param wanted as in closureError */
Eigen::Matrix3d closureBasis(LoopType type, const Eigen::Isometry3d& wanted);

class ClosureRows : public RowSource
{
public:
  /** @param name of the kind. @param closures may grow and shrink between two steps, and outlives this */
  ClosureRows(const char* name, std::vector<Body>& bodies, std::vector<Closure>& closures);
  ~ClosureRows() override;

  const char* name() const override { return name_; }
  void begin(const StepContext& context) override;
  void addRows(const StepContext& context, RowSink& sink) override;
  Again lookAhead(const StepContext& context, const Solution& solution) override;
  void markActing(std::vector<char>& bodies) const override;
  void accept(const StepContext& context, const StepAnswer& answer) override;
  double violation() const override { return violation_; }

private:
  struct Ahead;
  /** One closure in this step. */
  struct Error
  {
    Vector6d error = Vector6d::Zero();  ///< at the midpoint
    Vector6d kept = Vector6d::Zero();  ///< of it, at the next midpoint
    Vector6d correction = Vector6d::Zero();  ///< of b
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
    bool is_known = false;
  };

  Eigen::Isometry3d poseOf(int body, int frame, bool is_ahead) const;
  Eigen::Isometry3d anchorOf(const Closure& closure, bool is_ahead) const;
  Eigen::Isometry3d wantedOf(const Closure& closure, bool is_ahead) const;
  void close(const StepContext& context, const Closure& closure, Error& error) const;
  void collectColumns(const Closure& closure, const Eigen::Vector3d& point);
  Vector6d baseMotion(int body, const Eigen::Vector3d& point) const;
  double reachOf(const Closure& closure) const;
  void moveAhead(const StepContext& context, const Solution& solution);

  const char* name_;
  std::vector<Body>& bodies_;
  std::vector<Closure>& closures_;
  std::vector<Error> errors_;  ///< closures
  std::vector<std::unique_ptr<Ahead>> ahead_;  ///< bodies; of those that are joined
  std::vector<std::pair<int, Vector6d>> columns_;  ///< ascending: coordinate and the relative motion it gives
  int rounds_ = 0;  ///< of this step
  double violation_ = 0.0;
};

}  // namespace frictional_contact_sim
