#pragma once
/**
 * @file contact_rows.h
 * @brief Contacts: three rows (normal, tangent 1, tangent 2) each, Coulomb's law with the shift of the normal law; the
 * normal row alone where there is no friction.
 *
 *     u = H v + w,   H the relative point velocity of the two links,   w = moving bases + shift (contact_law.h)
 */
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "frictional_contact_sim/dynamics/contact_set.h"
#include "frictional_contact_sim/dynamics/contact_state.h"
#include "frictional_contact_sim/dynamics/creep_law.h"
#include "frictional_contact_sim/dynamics/pair_table.h"
#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
/** @brief The rows of one contact. */
struct ContactRow
{
  int point = 0;  ///< index in the list of detected contact points
  int row = 0;  ///< first row
  int count = 3;  ///< of rows; 1 without friction
  int law = 0;
  Eigen::Vector3d tangent_1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d tangent_2 = Eigen::Vector3d::UnitY();
  double friction = 0.0;
  double restitution = 0.0;
  double shift = 0.0;  ///< of the normal law [m/s]; w holds base velocity + shift
  Eigen::Vector2d tangential_shift = Eigen::Vector2d::Zero();  ///< of an impact with tangential restitution [m/s]
  bool closing = false;
  CreepTangent creep;  ///< along tangent_1, the rolling direction then; u of the solution holds k r + c as well
};

class CreepRows;

class ContactRows : public RowSource
{
public:
  /**
   * @param contacts of the last step; this one's after accept()
   * @param creep bends contacts of a pair with the creep law; nullptr where no pair has it
   * @param set chooses the points and looks at answers; nullptr: the points of the context as they are
   */
  ContactRows(const std::vector<Body>& bodies, const CollisionWorld& world, const PairTable& pairs,
              std::vector<ContactState>& contacts, CreepRows* creep, ContactSet* set = nullptr);

  const char* name() const override { return "contacts"; }
  void clear() override { rows_.clear(); }
  void begin(const StepContext& context) override;
  void addRows(const StepContext& context, RowSink& sink) override;
  void guess(const StepContext& context, bool from_answer, Solution& guess) const override;
  Again again(const StepContext& context, const Solution& solution, bool converged) override;
  Again lookAhead(const StepContext& context, const Solution& solution) override;
  void markActing(std::vector<char>& bodies) const override;
  const ContactPoint* contactOf(const StepContext& context, int law) const override;
  void accept(const StepContext& context, const StepAnswer& answer) override;

private:
  void add(const StepContext& context, int index, RowSink& sink);
  void collectColumns(const ContactPoint& point);
  Eigen::Vector3d relativeVelocity(const Eigen::VectorXd& v, const Eigen::Vector3d& relative_base) const;
  bool movesAlong(const Eigen::Vector3d& normal) const;
  Eigen::Vector3d velocityOf(const ContactRow& row, const ContactPoint& point, const Solution& solution);
  /** Last contact of the same id, or nullptr where there was none or it was an impact. */
  const ContactState* last(const ContactId& id) const;

  const std::vector<Body>& bodies_;
  const CollisionWorld& world_;
  const PairTable& pairs_;
  std::vector<ContactState>& contacts_;
  CreepRows* creep_;
  ContactSet* set_;
  std::vector<std::pair<ContactId, Eigen::Vector3d>> answer_;  ///< impulses of this step's last answer, sorted; or none
  std::vector<double> normal_impulses_;  ///< one a point; NaN without a row
  std::vector<std::pair<ContactId, int>> index_;  ///< id to position in contacts_, sorted
  std::vector<ContactRow> rows_;
  PointColumns columns_a_;
  PointColumns columns_b_;
};

/** @brief Velocity that a moving base gives to a point of a shape [m/s]. */
Eigen::Vector3d baseVelocity(const std::vector<Body>& bodies, const ShapeInfo& shape, const Eigen::Vector3d& position);

/** @brief Two unit vectors that complete `normal` to a right-handed frame; smooth in the normal almost everywhere. */
void tangentFrame(const Eigen::Vector3d& normal, Eigen::Vector3d& tangent_1, Eigen::Vector3d& tangent_2);

}  // namespace frictional_contact_sim
