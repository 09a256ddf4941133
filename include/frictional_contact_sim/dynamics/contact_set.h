#pragma once
/**
 * @file contact_set.h
 * @brief Which contact points a step has rows for: chosen from its free motion, then mended by looking at its answers.
 *
 * The law is gap >= 0 for every point of a body, not for chosen ones. A step starts with the points that its free
 * motion could close. Every answer is then looked at with the true geometry at both poses it leads to,
 *
 *     q_k+1 = q_k (+) dt (v_k + v_k+1)/2      and the next midpoint      q_n = q_k+1 (+) dt/2 v_k+1
 *
 * (a gap row speaks of the next midpoint: gap_m + dt u_N is the gap there to second order). What is missing or has bent
 * away gets a row, and the step is solved again from its answer:
 *
 *  - a point known at q_m whose gap_m + dt u_N is negative and that has no row gets the usual one;
 *  - a point that overlaps at one of the poses gets a row linearised there (anew, where it has one already): with its
 *    normal and place carried back to q_m by the link that owns them, and u* the answer's velocity along that normal,
 *
 *        gap(v) = gap* + s dt (u_N(v) - u*) >= allowed,      s = 1 at q_n, 1/2 at q_k+1
 *
 *    allowed is 0, or how deep the pair was at q_m already;
 *  - a *ghost* is a row without which the step, solved again, still keeps every gap at both poses (a wheel that rolls
 *    over the seam of two coplanar boxes meets one): it carries nothing. Looked for once among points that carry an
 *    impulse, had a gap at q_m, carried none in the last step and do not touch at q_n, where the way past looks open.
 * One that is then violated comes back, linearised (with restitution: as it was), and stays.
 *
 * What may go through is 1e-9 of the size of the smaller shape, a hundred times more in each of two rounds after the
 * second (crossing edges converge by a factor of 4 a round, no more); after
 * 10 rounds a trace of 1e-4 of the size is left to the next step, after 30 more than that is a failed step. See
 * docs/residuals.md, "Nothing goes through".
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/dynamics/contact_state.h"
#include "frictional_contact_sim/dynamics/pair_table.h"
#include "frictional_contact_sim/dynamics/surface_contacts.h"

namespace frictional_contact_sim
{
struct StepContext;

class ContactSet
{
public:
  /** @param last contacts of the last step. All four outlive this. */
  ContactSet(std::vector<Body>& bodies, CollisionWorld& world, const PairTable& pairs,
             const std::vector<ContactState>& last);

  /**
   * @brief The points of a step (impact) that its free motion could close; bodies stand at q_m with v_start, v_free and
   * speed known. Poses of the world are set. Ordered by id; the list changes with lookAgain only.
   */
  const std::vector<ContactPoint>& find(const StepContext& context);

  enum class Look
  {
    CONTENT,
    CHANGED,  ///< the points are others: solve again
    GIVEN_UP  ///< after the most rounds still more than a trace goes through
  };
  /**
   * @param v velocities of all bodies, an answer
   * @param impulses normal impulse of each point of the list; NaN where it has no row (nothing moves along its normal)
   */
  Look lookAgain(const StepContext& context, const Eigen::VectorXd& v, const std::vector<double>& impulses);

  /**
   * @brief The points before the last change: where the solve with the new ones has failed and only a trace (1e-4 of
   * the size) went through without them. Answers are not looked at again in this step.
   */
  void goBack();
  /** @brief What goes through after the most rounds of this step is left: overlaps are not pushed out in it. */
  void beLenient();
  bool canGoBack() const;
  /** @brief Whether an answer of this step went through the point without its row. */
  bool isNeeded(const ContactId& id) const;

  const std::vector<ContactPoint>& points() const { return points_; }
  /** @brief How often the points of this step were changed. */
  int rounds() const { return rounds_; }

private:
  enum class Use : char
  {
    IDLE,  ///< no row
    ROW,
    LINEARISED,  ///< a row that stays
    DROPPED,  ///< was taken for a ghost: only its true gap brings it back
    HOPELESS  ///< no motion changes its gap
  };
  struct Candidate
  {
    ContactPoint point;
    Use use = Use::IDLE;
    double impulse = 0.0;  ///< of the answer
    bool is_kept = false;  ///< was taken for a ghost and is none
    /// Along the normal in the answer that asked for the row [m/s]; infinite where it was there at first.
    double speed_without = std::numeric_limits<double>::infinity();
    int round = 0;  ///< that linearised it last
  };
  /// A body where an answer takes it.
  struct Ahead
  {
    explicit Ahead(const Body& body);
    Eigen::VectorXd v;  ///< the answer
    bool is_known = false;  ///< v is that of an answer to this step, and speeds_ its speed
    bool has_moved = false;  ///< q_end, v_end, q are those of v
    Eigen::VectorXd q_end;
    Eigen::VectorXd v_end;
    Eigen::VectorXd q;  ///< next midpoint; of an impact the first
    MultibodyData data;
  };

  struct Overlap
  {
    ContactPoint point;
    double missing;  ///< gap minus what is allowed [m] < 0
  };

  enum class Motion
  {
    START,  ///< v_start
    FREE,  ///< v_free
    ANSWER
  };
  static constexpr double OVERLAP = 1e-9;  ///< times the size: what may go through
  static constexpr int STRICT_ROUNDS = 2;  ///< with every round after these more may: crossing edges converge slowly
  static constexpr double STILL = 1e-12;  ///< what moves less than this in a step closes no gap [m]

  static double baseSpeed(const Body& body);
  const Eigen::VectorXd& velocities(Motion motion, int body) const;
  double normalSpeed(const ContactPoint& point, Motion motion) const;
  bool mayClose(const StepContext& context, const ContactPoint& point) const;
  bool carriedBefore(const ContactId& id) const;
  double tolerance() const;
  double sizeOf(const ContactPoint& point) const;
  const std::vector<ContactPoint>& detect(const std::vector<double>& margins, bool is_ahead);
  void detectAtMiddle(const StepContext& context);
  Candidate& insert(const Candidate& candidate);
  void sortCandidates();
  Candidate* known(const ContactId& id);
  void takePoints();
  bool setAnswer(const StepContext& context, const Eigen::VectorXd& v);
  bool addClosing(const StepContext& context);
  void moveAhead(const StepContext& context);
  void setPosesAhead(const StepContext& context, bool at_end);
  double allowedGap(int shape_a, int shape_b) const;
  void findOverlaps();
  bool mend(const StepContext& context, double share);
  ContactPoint linearised(const StepContext& context, const ContactPoint& found, double missing, double share) const;
  bool dropGhosts(const StepContext& context);

  std::vector<Body>& bodies_;
  CollisionWorld& world_;
  const PairTable& pairs_;
  const std::vector<ContactState>& last_;
  SurfaceContacts surfaces_;  ///< of deformable bodies
  std::vector<ContactPoint> detected_;  ///< with those, where there are any
  mutable PointColumns columns_;  ///< scratch
  std::vector<ContactId> carried_;  ///< points with an impulse in the last step, sorted
  std::vector<Candidate> candidates_;  ///< ordered by id
  std::vector<Overlap> overlaps_;  ///< at the pose searched last
  std::vector<std::uint64_t> touching_pairs_;  ///< ContactId::shapes without a gap there, sorted
  std::vector<ContactPoint> points_;
  std::vector<ContactPoint> last_points_;  ///< before the last round
  std::vector<double> margins_;  ///< that q_m was searched with [m]
  std::vector<double> speeds_;  ///< bodies: largest speed of a point, of the free motion or the answer [m/s]
  std::vector<double> margins_ahead_;
  std::vector<Ahead> ahead_;
  int rounds_ = 0;
  bool ghosts_tried_ = false;
  bool is_lenient_ = false;
  bool is_last_ = false;  ///< answers are no longer looked at
  double worst_ = 0.0;  ///< of the last look: deepest that is not allowed, in units of its size
};

}  // namespace frictional_contact_sim
