#pragma once
/**
 * @file servo_rows.h
 * @brief Commands of joints: implicit servos in M and f, and those at their effort limit as rows.
 *
 * Below its limit a servo gives dt tau = c - K v_j (actuation.h): K to the diagonal of M, c to the momentum. At its
 * limit it is a row: an auxiliary velocity s with mass K and u = v_j - s - c/K give the impulse r = c - K v_j while
 * |r| < limit dt, and +-limit dt beyond: the law of dry friction, exactly. A servo that worked near its limit in the
 * last step is a row from the start; one found beyond it becomes a row and the step is solved again. Rows are only ever
 * added within a step, so this ends.
 *
 * At the joint's velocity limit w a drive pushes no more: its effort in the direction of motion falls to zero there,
 * nothing brakes beyond it. A drive found to push a joint faster than w is solved again with the law of dry friction
 * about that velocity: with e the impulse it would have at w, dt tau = e/2 + r, |r| <= |e|/2 against v_j - w; all of e
 * below w, none beyond it, what is needed to keep w at it.
 *
 * Gravity compensation (BodyModel::gravity_compensation) adds to tau_ff of every servo (not of an effort) what holds
 * the links beyond its joint against gravity, at the midpoint; for a joint that others mimic their share too. Of a
 * fixed base that is all of gravity; of a floating one what the limbs weigh, not what stands on them.
 */
#include <vector>

#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
class ServoRows : public RowSource
{
public:
  /** @param memory one impulse a joint; sized here */
  ServoRows(std::vector<Body>& bodies, RowMemory& memory);

  const char* name() const override { return "servos"; }
  void clear() override;
  void begin(const StepContext& context) override;
  void addJointRows(const StepContext& context, int body, int joint, RowSink& sink) override;
  void addMomentum(const StepContext& context, int body, VectorOut momentum) override;
  Again again(const StepContext& context, const Solution& solution, bool converged) override;
  void accept(const StepContext& context, const StepAnswer& answer) override;
  void book(const StepContext& context, int body, const Solution& solution, EnergyLedger& ledger) const override;

private:
  /** @brief A joint that mimics the servo's, through others perhaps: v_follower = multiplier v_servo. */
  struct Follower
  {
    int servo;  ///< index in servos_
    int v_index;
    double multiplier;
  };
  struct Servo
  {
    int body;
    int joint;
    int v_index;  ///< in the body's v
    ServoImpulse impulse;  ///< of this step
    bool bounded = false;  ///< solved as a row in this step
    double most =
        0.0;  ///< impulse at the velocity limit that is solved for in this step, its sign that of v_j; 0 = none
    int row = -1;  ///< then
  };
  static std::vector<Follower> findFollowers(const MultibodyModel& tree, const std::vector<int>& servo_of);
  static void countAsForce(const StepContext& context, Body& body, const Servo& servo);
  void addGravity(const StepContext& context, int body);
  static double effort(const Servo& servo, double velocity, double dt);
  double velocityLimit(const Servo& servo) const;
  bool limitSpeed(const Servo& servo, const Body& body, double velocity, double dt, double& most) const;

  std::vector<Body>& bodies_;
  JointMemory memory_;
  std::vector<Servo> servos_;  ///< one a joint that takes commands, body by body
  std::vector<std::vector<int>> servo_of_;  ///< body, joint: index in servos_, -1 = none
  std::vector<int> first_;  ///< bodies + 1: first servo of each
  std::vector<std::vector<Follower>> followers_;  ///< bodies
  Eigen::VectorXd gravity_;  ///< scratch: generalized force that holds a body, as long as the largest needs
};

}  // namespace frictional_contact_sim
