#pragma once
/**
 * @file row_source.h
 * @brief What every kind of row offers to the assembly of a step: contacts, joint limits, dry friction, servos, mimic
 * joints, welds and the creep law are one class each, in one file pair; a new kind is a new class and a line in
 * row_sources.cpp.
 *
 * A source adds its rows to a RowSink, which keeps them in the order they come: contacts, then joint by joint. What a
 * row is worth to the ledger and where its impulse is kept goes with the row (RowRecord), so most sources have nothing
 * else to say.
 */
#include <Eigen/Core>
#include <cassert>
#include <string>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/dynamics/closure.h"
#include "frictional_contact_sim/dynamics/contact_law.h"
#include "frictional_contact_sim/dynamics/contact_state.h"
#include "frictional_contact_sim/dynamics/row_sink.h"
#include "frictional_contact_sim/dynamics/wedged_pairs.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
/** @brief What a step is solved for. */
struct StepContext
{
  double dt = 0.001;  ///< [s] > 0
  double middle = 0.0;  ///< of the step, on the scenario's clock [s]
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};
  NormalLaw normal_law;
  double tolerance = 1e-8;  ///< of the solver, on E
  Regime regime = Regime::DYNAMIC;
  bool impact = false;  ///< an impact at one instant: rows at gap <= CONTACT_GAP, no forces
  bool inelastic = false;  ///< no restitution: with it this step (impact) had no answer
  bool balance = false;  ///< nothing moves, forces balance (solver/equilibrium.h): rows at gap <= CONTACT_GAP
  const std::vector<ContactPoint>* points = nullptr;  ///< detected at the midpoint (impact: at q), valid for the step
  const Eigen::VectorXd* v_old = nullptr;  ///< velocities of all bodies at the start of the step
  WedgedPairs wedged;  ///< of the state, and what this step adds
  WedgedPairs wedged_ahead;  ///< the same of linearised rows, whose gap is that of this step's end; of this step alone

  /** @brief The law of one point. */
  NormalLaw normalLaw(const ContactPoint& point) const
  {
    NormalLaw law = normal_law;
    law.left_overlap = overlapLeft(point.is_linearised ? wedged_ahead : wedged, point.shape_a, point.shape_b);
    return law;
  }
};

/** @brief The answer of a step as its rows read it. */
struct StepAnswer
{
  const Solution& solution;  ///< finite
  const Eigen::VectorXd& law_errors;  ///< |e_i| of each law, natural map [m/s]; empty: not known
};

/** @brief Impulses that a source keeps from one step for the next. */
struct RowMemory
{
  std::string name;  ///< of the source
  std::vector<double> impulses;  ///< [N s] or [N m s]
};

/** @brief What rows keep from one step for the next: part of the simulation's state. May be assigned, never moved. */
struct RowState
{
  std::vector<ContactState> contacts;  ///< of the last step, ordered by shapes and feature
  std::vector<RowMemory> memory;  ///< one a source that keeps impulses
  std::vector<Closure> loops;  ///< of the scenario and its URDFs, in their order
  std::vector<Closure> welds;  ///< links that were joined in the run
};

/** @brief RowMemory of a source with so many impulses a joint. */
class JointMemory
{
public:
  /** @brief Names `memory` and sizes it, all zero. It lives as long as this; it may be assigned, never moved. */
  JointMemory(const char* name, int impulses_a_joint, const std::vector<Body>& bodies, RowMemory& memory);
  double* at(int body, int joint, int which = 0)
  {
    assert(which < width_);
    return memory_.impulses.data() + static_cast<size_t>((first_[body] + joint) * width_ + which);
  }

private:
  RowMemory& memory_;
  int width_;
  std::vector<int> first_;  ///< bodies: joints of those before
};

/** @brief Unit and reach of a row that is the velocity of a joint with one coordinate. */
inline RowUnit jointUnit(const Body& body, int joint)
{
  const Joint& moved = body.model.tree.joints[joint];
  return {moved.type == JointType::PRISMATIC ? VelocityUnit::LENGTH : VelocityUnit::ANGLE,
          body.model.reach[moved.v_index]};
}

/** @brief Whether the step has to be solved again. */
enum class Again
{
  NO,
  FROM_GUESS,  ///< rows and forces have changed: from the warm start
  FROM_ANSWER,  ///< rows have moved, or there are more of them; forces stand: from the last answer
  FORCES,  ///< f alone is another, and in the problem already: from the last answer
  NEVER  ///< the rows' own law could not be met: the step has failed
};

class RowSource
{
public:
  virtual ~RowSource() = default;

  /** @brief For messages. */
  virtual const char* name() const = 0;
  /** @brief The problem could not be assembled: no rows until the next step. */
  virtual void clear() {}
  /** @brief Once a step, before anything else; bodies stand at the midpoint. */
  virtual void begin(const StepContext&) {}
  /** @brief Rows that belong to no single joint. */
  virtual void addRows(const StepContext&, RowSink&) {}
  /** @brief Rows of one joint with one coordinate. */
  virtual void addJointRows(const StepContext&, int /*body*/, int /*joint*/, RowSink&) {}
  /** @brief What acts without a row: impulses into `momentum` (nv), what is implicit into Body::implicit. */
  virtual void addMomentum(const StepContext&, int /*body*/, VectorOut /*momentum*/) {}
  /**
   * @brief Impulses where RowRecord::memory does not hold them.
   * @param from_answer of the answer that `again` saw last, else of the last step
   */
  virtual void guess(const StepContext&, bool /*from_answer*/, Solution&) const {}
  /** @brief Asked in turn after a solve, until one says other than NO. @param converged the solve's verdict */
  virtual Again again(const StepContext&, const Solution&, bool /*converged*/) { return Again::NO; }
  /**
   * @brief Asked in turn once all of the above and the bias are content with an answer: whether it meets what there was
   * no row for, or a row that has bent away from what it stands for.
   */
  virtual Again lookAhead(const StepContext&, const Solution&) { return Again::NO; }
  /** @brief Marks the bodies (by index) that an impulse of the last step acts on, beyond what RowMemory says. */
  virtual void markActing(std::vector<char>&) const {}
  /** @brief The step is done: take from the answer what is reported or kept. */
  virtual void accept(const StepContext&, const StepAnswer&) {}
  /** @brief Work of what addMomentum added for one body. Body::v_middle is the mean of old and new velocity. */
  virtual void book(const StepContext&, int /*body*/, const Solution&, EnergyLedger&) const {}
  /** @brief The contact point that a law of the problem stands for, valid for the step; nullptr: none of this source.
   */
  virtual const ContactPoint* contactOf(const StepContext&, int /*law*/) const { return nullptr; }
  /** @brief Largest position error of its bilateral rows [m] or [rad]. */
  virtual double violation() const { return 0.0; }
};

}  // namespace frictional_contact_sim
