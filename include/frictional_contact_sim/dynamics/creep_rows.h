#pragma once
/**
 * @file creep_rows.h
 * @brief Contacts of a pair with the creep law (creep_law.h): their tangents, and the Newton iteration on them.
 *
 * Adds no rows of its own: ContactRows hands each such contact over to be bent onto the tangent of its curve.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/dynamics/contact_rows.h"
#include "frictional_contact_sim/dynamics/creep_law.h"
#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
class CreepRows : public RowSource
{
public:
  CreepRows(const std::vector<Body>& bodies, const CollisionWorld& world);

  const char* name() const override { return "creep law"; }
  void begin(const StepContext& context) override;
  Again again(const StepContext& context, const Solution& solution, bool converged) override;

  /** @brief The contacts are others: iterations are counted anew. */
  void restart() { iterations_ = 0; }
  /** @brief Forgets the contacts of the assembly before. */
  void clear() override;
  /**
   * @brief Turns a rolling contact's first tangent into the rolling direction and sets its tangent of the curve; leaves
   * one that does not roll as it is.
   * @param velocity of a relative to b at the start of the step, world [m/s]
   * @param last the contact in the last step, or nullptr; the law is Coulomb's where no normal impulse is expected
   */
  void bend(const StepContext& context, const CreepTable& curve, const Eigen::Vector3d& velocity,
            const ContactState* last, ContactRow& contact);

private:
  /** One contact on its tangent; its row of rolling_rows_ has the same index. */
  struct Bent
  {
    ContactId id;
    int row;  ///< first row
    double friction;
    CreepTangent tangent;
    const CreepTable* curve;
    double base_speed;  ///< share of moving bases in the rolling speed [m/s]
  };

  Eigen::Vector3d addRollingSide(const ContactPoint& point, const ShapeInfo& shape, double weight,
                                 const Eigen::Matrix3d& spin);

  CreepPoint& pointOf(const ContactId& id);

  const std::vector<Body>& bodies_;
  const CollisionWorld& world_;
  std::vector<RollingShape> shapes_;  ///< one a shape handle
  int iterations_ = 0;  ///< in this step
  std::vector<std::pair<ContactId, CreepPoint>> points_;  ///< by id, kept over the iterations of a step
  std::vector<Bent> bent_;
  RowBuilder rolling_rows_;  ///< rolling speed along the rolling direction, by generalized velocity
  PointColumns columns_;
};

}  // namespace frictional_contact_sim
