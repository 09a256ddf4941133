#pragma once
/**
 * @file run_audit.h
 * @brief The invariants of a run (docs/residuals.md) as one object that looks at a simulator
 * after every step and says at the end, in lines to read, what was wrong.
 *
 * | kind        | every step                                                                                     |
 * | ----------- | ---------------------------------------------------------------------------------------------- |
 * | failed      | CONVERGED                                                                                      |
 * | residual    | E <= tolerance                                                                                 |
 * | finite      | positions, velocities, contacts, energies                                                      |
 * | reported    | max_penetration within 1e-6 m, h^2 (g + R omega^2) in motion                                   |
 * | penetration | the same by penetration_check.h, every `penetration_every` steps and at the end                |
 * | balance     | balance error <= 1e-2 of the energy exchanged so far                                           |
 * | rise        | kinetic + potential of undriven bodies above their least so far <= 1e-2 of the energy exchanged |
 * | self-stress | at rest no contact force beyond 3 weights (and the other loads, see `loads`)                   |
 * | weight      | at rest the mean of all contact forces from outside on floating bodies is -m g                 |
 * | momentum    | each floating body: (M v + f) of its three base coordinates = sum of published impulses; a single
 * link besides: m (c_k+1' - c_k') = dt m g + impulses + external | | gap         | u_N + gap/dt >= 0, and 0 where r_N >
 * 0 (contacts whose normal law is the gap's)                | | friction    | r_T . u_T <= 0 | | cone        | r_N >=
 * 0, |r_T| <= mu r_N                                                                      |
 *
 * "Undriven": no command but effort 0, no wrench, no moving base; with restitution and friction together energy may
 * rise (Kane), so then only "balance" is asked. The single link's momentum is exact when its velocities are those of
 * its centre of mass; otherwise the scheme is of order 2 and a bound of that order is asked.
 */
#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
namespace test_support
{
struct AuditOptions
{
  int penetration_every = 20;  ///< steps; 0: never
  double rest_speed = 1e-4;  ///< a body slower than this [m/s], [rad/s] for `rest_steps` is at rest
  int rest_steps = 50;
  double weights = 3.0;  ///< largest contact force at rest over the loads
  double loads = 0.0;  ///< loads at rest beside weights, wrenches and efforts of prismatic joints [N]
};

class PenetrationCheck;

/** @brief All occurrences of one kind. */
struct Fault
{
  int count = 0;
  std::uint64_t first_step = 0;
  double worst = 0.0;  ///< in units of what is allowed
  std::string text;  ///< of the worst
};

class RunAudit
{
public:
  explicit RunAudit(const Simulator& simulator, const AuditOptions& options = {});
  ~RunAudit();

  /** @brief After a state was set, a reset, or another time step: what is compared with the step before starts anew. */
  void restart();
  /** @brief Before a step, only where velocities were written by hand since the last one. */
  void beforeStep();
  void afterStep();
  /**
   * @brief One more invariant, asked after every converged step: `excess` is what is found over what is allowed (more
   * than 1 is a fault), `text` says what it is.
   */
  using Check = std::function<double(const Simulator& simulator, std::string& text)>;
  void addCheck(const std::string& kind, Check check);
  /** @brief By kind, the last look at penetrations included. */
  const std::map<std::string, Fault>& finish();
  /** @brief One line a kind: "penetration: 3 times, first at step 120, worst: ...". Empty: everything held. */
  std::vector<std::string> faults();

private:
  void checkOutcome();
  void checkFinite();
  void checkPenetration();
  void checkEnergy();
  void checkRest();
  void checkWeight();
  void checkMomentum();
  void checkSingleLink(int body, const Eigen::Vector3d& impulse, double scale);
  double problemSpeed() const;
  void checkContact(const ContactState& contact);
  bool isDriven() const;
  double lightest(const ContactState& contact) const;
  Eigen::Vector3d centerVelocity(int body) const;
  /** @brief Books a fault of `excess` (allowed: 1); a number that is not finite is one. */
  void judge(const std::string& kind, double excess, const std::string& text);

  const Simulator& simulator_;
  AuditOptions options_;
  std::unique_ptr<PenetrationCheck> penetration_;
  std::map<std::string, Fault> faults_;
  std::uint64_t steps_ = 0;
  std::vector<Eigen::VectorXd> old_velocity_;  ///< bodies
  std::vector<Eigen::Vector3d> old_center_velocity_;  ///< bodies
  bool bouncing_ = false;  ///< a contact with restitution and friction acted
  double start_ = 0.0;  ///< kinetic + potential at the start [J]
  double least_ = 0.0;  ///< least kinetic + potential since the bodies are undriven [J]
  double exchanged_ = 0.0;  ///< largest energy that has changed its form so far [J]
  EnergyLedger ledger_;  ///< of the step before
  double weight_ = 0.0;  ///< of all bodies that move [N]
  double speed_ = 0.0;  ///< what E is relative to, at most: largest speed that the step's free motion asks of a row
  int quiet_ = 0;  ///< steps at rest so far
  int weighed_ = 0;  ///< of them with nothing but contacts to hold the bodies
  Eigen::Vector3d support_ = Eigen::Vector3d::Zero();  ///< sum of contact impulses from outside in them [N s]
  std::vector<std::pair<std::string, Check>> checks_;
};

}  // namespace test_support
}  // namespace frictional_contact_sim
