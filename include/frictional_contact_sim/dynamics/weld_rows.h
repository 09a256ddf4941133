#pragma once
/**
 * @file weld_rows.h
 * @brief Welds: six bilateral rows each, the relative motion of link a in link b at the origin of link a, world axes.
 *
 *     G v + b = 0,   G v + base = (v_a(p) - v_b(p); w_a - w_b),   b = base + (e(q_m) - kept)/dt + correction
 *
 * e = (position; rotation vector) of link a where it is, less where the weld has it, [m], [rad]; p between the two
 * places, so that both links get opposite impulses at one point. What is missing from outside (a state that was
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

#include "frictional_contact_sim/dynamics/row_source.h"
#include "frictional_contact_sim/dynamics/weld.h"

namespace frictional_contact_sim
{
/** @brief e of the head, (position; rotation vector), world axes; zero below the round-off of the poses. */
Vector6d closureError(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const Eigen::Isometry3d& a_in_b);

class WeldRows : public RowSource
{
public:
  /** @param welds may grow and shrink between two steps, and outlives this */
  WeldRows(std::vector<Body>& bodies, std::vector<Weld>& welds);
  ~WeldRows() override;

  const char* name() const override { return "welds"; }
  void begin(const StepContext& context) override;
  void addRows(const StepContext& context, RowSink& sink) override;
  Again lookAhead(const StepContext& context, const Solution& solution) override;
  void markActing(std::vector<char>& bodies) const override;
  void accept(const StepContext& context, const StepAnswer& answer) override;
  double violation() const override { return violation_; }

private:
  struct Ahead;
  /** One weld in this step. */
  struct Closure
  {
    Vector6d error = Vector6d::Zero();  ///< at the midpoint
    Vector6d kept = Vector6d::Zero();  ///< of it, at the next midpoint
    Vector6d correction = Vector6d::Zero();  ///< of b
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    bool is_known = false;
  };

  Eigen::Isometry3d poseOf(int body, int frame, bool is_ahead) const;
  Vector6d errorOf(const Weld& weld, bool is_ahead) const;
  void close(const StepContext& context, const Weld& weld, Closure& closure) const;
  void collectColumns(const Weld& weld, const Eigen::Vector3d& point);
  Vector6d baseMotion(int body, const Eigen::Vector3d& point) const;
  double reachOf(const Weld& weld) const;
  void moveAhead(const StepContext& context, const Solution& solution);

  std::vector<Body>& bodies_;
  std::vector<Weld>& welds_;
  std::vector<Closure> closures_;  ///< welds
  std::vector<std::unique_ptr<Ahead>> ahead_;  ///< bodies; of those that are welded
  std::vector<std::pair<int, Vector6d>> columns_;  ///< ascending: coordinate and the relative motion it gives
  int rounds_ = 0;  ///< of this step
  double violation_ = 0.0;
};

}  // namespace frictional_contact_sim
