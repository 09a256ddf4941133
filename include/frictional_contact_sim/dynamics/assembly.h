#pragma once
/**
 * @file assembly.h
 * @brief State + contact points + dt to the incremental problem of one step (Moreau's midpoint scheme).
 *
 *     M = M(q_m) + dt^2/4 K + dt D                              servo stiffness K at the midpoint, damping D at the end
 *     f = -M(q_m) v_k + dt (bias(q_m, v_m) - applied) - c       c: servo offsets, see actuation.h
 *     u = H v + w,   G v + b = 0                                the rows of all row sources (row_source.h)
 *
 * v_m is the mean velocity (v_k + v_k+1)/2 of this very step; v_k is Body::v_start (an image for free links, whose bias
 * is another too: free_link.h). The first guess of it, body by body:
 *
 *     v_k                         where a row acted in the last step
 *     (v_k + v_free)/2            elsewhere, v_free = M^-1 (M v_k + c + dt (applied - bias((v_k + v_free)/2))): exact
 * where no row will act
 *
 * After a solve, where the bias at (v_k + v)/2 changes v by more than tolerance times Body::speed_change, measured as
 * the largest speed of a point in M^-1 dt (change of bias), it is put into f and the step is solved again from its
 * answer: f alone has changed (Again::FORCES), the rows stand. A round gains a factor of about dt times the angular
 * velocity; at most 5 a step, counted anew when rows change. Second order, at rest exactly zero, and no force of an
 * earlier step enters: an over-determined set of contacts may carry any self-stress, and the next set is another one
 * (from those forces a published biped got a predicted velocity of 1e6 m/s). Source: Cadoux (2009), (2.28)-(2.31).
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/dynamics/energy_ledger.h"
#include "frictional_contact_sim/dynamics/row_source.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
class StepAssembly
{
public:
  /** @brief Sizes everything; the bodies may not change in number afterwards, and outlive this. */
  StepAssembly(std::vector<Body>& bodies, std::vector<std::unique_ptr<RowSource>> sources, RowState& state);

  /** @brief Once a step (or impact), before anything else. Bodies' middle data are at q_m. Sets context.v_old. */
  void begin(StepContext& context);
  /**
   * @brief What f is without rows: momentum, bias at the first guess of the mean velocity, what acts without a row; so
   * Body::v_free and speeds. In an impact M v - M v_k = H^T r.
   * @return index of a body whose mass matrix is not positive definite, else -1
   */
  int assembleForces(const StepContext& context);
  /** @brief Before rows are assembled anew from an answer: the bias at its mean velocity. */
  void followAnswer(const StepContext& context, const Solution& solution);
  /** @brief Rows H, w, G, b, laws of one step or impact. */
  void assembleRows(const StepContext& context);
  /** @brief v at the start, impulses of the last step; of `answer` (of this step, before rows changed) where given. */
  void makeGuess(const StepContext& context, Solution& guess, const Solution* answer = nullptr) const;
  /** @brief M, f and the scales, after assembleForces and assembleRows. */
  void assembleProblem(const StepContext& context);
  /** @brief A problem without rows and forces, in place of one that could not be assembled. */
  void clear();

  /**
   * @brief Whether rows, or else the bias, want the step solved again. After FORCES the problem's f is new.
   * @param converged the solve's verdict
   */
  Again again(const StepContext& context, const Solution& solution, bool converged);
  /** @brief Free links without an impulse in `solution`, finite, get their free motion without the solve's round-off.
   */
  void settleFreeLinks(Solution& solution);
  /** @brief Bodies, by index: whether an impulse of `solution` acts on it. */
  const std::vector<char>& acting(const Solution& solution);
  /** @brief Name of the rows that said anything but NO last. */
  const char* unsatisfied() const { return unsatisfied_; }
  /** @brief Sets the bodies' v_middle to the mean of old and new velocity. */
  void setMeanVelocity(const Solution& solution);
  /** @brief Books the work of every impulse of a solved step; needs setMeanVelocity, the state still the old one. */
  void book(const StepContext& context, const Solution& solution, EnergyLedger& ledger) const;
  /** @brief Hands the answer of the step to all rows. */
  void accept(const StepContext& context, const StepAnswer& answer);

  const IncrementalProblem& problem() const { return problem_; }
  /** @brief Whose each law of problem() is, and each bilateral row. */
  const std::vector<RowOrigin>& origins() const { return sink_.origins(); }
  const std::vector<RowOrigin>& bilateralOrigins() const { return sink_.bilateralOrigins(); }
  /** @brief The point of a contact's law, valid for the step; nullptr for other rows. */
  const ContactPoint* contactOf(const StepContext& context, int law) const;
  /** @brief w of problem() as if all gaps were closed: one-sided rows without the velocity that their gap allows. */
  Eigen::VectorXd closedOffsets() const;
  /** @brief Velocities of the bodies, without auxiliary ones. */
  int velocities() const { return velocities_; }
  /** @brief True when a contact or limit closes: an impact has something to solve. */
  bool closing() const { return sink_.closing(); }
  /** @brief Whether a row asks for restitution. */
  bool bouncing() const { return sink_.bouncing(); }
  /** @brief Largest position error of bilateral rows at the midpoint [m] or [rad]. */
  double bilateralViolation() const;

private:
  bool assembleForces(const StepContext& context, int body);
  void predict(const StepContext& context, Body& body);
  void findLastActing(const StepContext& context);
  void findActing(const Solution& solution);
  double missBias(const StepContext& context, const Solution& solution);
  void moveBias(const StepContext& context);
  void accelerate(Body& body, int& last_round);
  Again biasAgain(const StepContext& context, const Solution& solution);
  double biasMiss(const StepContext& context, const Solution& solution, Body& body);
  double freeMiss(const StepContext& context, const Solution& solution, Body& body);
  void setMassPattern();
  void assembleMass(bool with_implicit);
  LawScale scaleOf(const SparseRows& rows, int row, const RowUnit& unit, double base_speed) const;
  void shareSpeedChanges();
  void setScales();
  void bookRow(const RowBuilder& rows, int row, double impulse, const RowRecord& record, EnergyLedger& ledger) const;

  std::vector<Body>& bodies_;
  std::vector<std::unique_ptr<RowSource>> sources_;
  RowState& state_;
  const char* unsatisfied_ = "";
  int velocities_ = 0;
  Eigen::VectorXd v_old_;  ///< velocities_: at the start of the step
  Eigen::VectorXd v_mean_;  ///< of the bodies, 0 for auxiliary columns
  Eigen::VectorXd momentum_;  ///< without bias, body by body
  Eigen::VectorXd force_;  ///< velocities_: f
  std::vector<int> body_of_;  ///< velocities_: body of a column
  std::vector<int> joint_body_;  ///< body of every joint, as RowMemory counts them
  std::vector<char> acting_;  ///< bodies: an impulse of the last step (or an answer) acts on it
  int joint_rows_ = 0;  ///< first row of a joint; contacts come before
  int last_joint_rows_ = 0;  ///< the same of the problem that was solved last
  bool mass_is_set_ = false;  ///< problem_.M is that of the last assembleForces()
  int bias_rounds_ = 0;  ///< since rows changed last
  std::vector<double> misses_;  ///< bodies: see missBias
  Eigen::VectorXd settled_;  ///< velocities_: the answer that missBias was asked for last
  std::vector<char> is_settled_;  ///< bodies: it missed nothing there; 1 without, 2 with an impulse
  Eigen::VectorXd last_bias_;  ///< velocities_: at the answer of the round before
  Eigen::VectorXd last_miss_;  ///< the same less what that round was solved with
  std::vector<int> last_bias_round_;  ///< bodies: the round of these
  RowSink sink_;
  RowBuilder rows_m_;
  std::vector<std::vector<int>> mass_columns_;  ///< tree pattern of M, row by row
  IncrementalProblem problem_;
};

}  // namespace frictional_contact_sim
