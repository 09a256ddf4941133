#include "support/run_audit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "frictional_contact_sim/model/kinematics.h"
#include "support/penetration_check.h"

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
/** "name value" pairs in one line. */
template <typename... Parts>
std::string line(const Parts&... parts)
{
  std::ostringstream text;
  text.precision(4);
  (text << ... << parts);
  return text.str();
}

bool isFloating(const MultibodyModel& model)
{
  return model.joints.front().type == JointType::FLOATING;
}
}  // namespace

RunAudit::RunAudit(const Simulator& simulator, const AuditOptions& options)
  : simulator_(simulator), options_(options), penetration_(std::make_unique<PenetrationCheck>(simulator))
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator.model(body);
    if (model.nv > 0)
      weight_ += model.totalMass() * simulator.scenario().gravity.norm();
  }
  if (!simulator.outcome().converged())
    judge("failed", 2.0, "the impact at the start: " + simulator.outcome().message);
  restart();
}

RunAudit::~RunAudit() = default;

void RunAudit::restart()
{
  const EnergyLedger& energy = simulator_.report().energy;
  start_ = energy.kinetic + energy.potential;
  least_ = start_;
  exchanged_ = 0.0;
  ledger_ = energy;
  quiet_ = 0;
  bouncing_ = false;
  beforeStep();
}

Eigen::Vector3d RunAudit::centerVelocity(int body) const
{
  const MultibodyModel& model = simulator_.model(body);
  const MultibodyData& data = simulator_.data(body);
  const Eigen::Vector3d center = data.link_pose.front() * model.links.front().inertia.center;
  return pointVelocity(data, 0, center).head<3>();
}

void RunAudit::beforeStep()
{
  old_velocity_.resize(simulator_.bodyCount());
  old_center_velocity_.resize(simulator_.bodyCount());
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    old_velocity_[body] = simulator_.velocity(body);
    old_center_velocity_[body] = centerVelocity(body);
  }
  penetration_->noteSpeeds();
}

void RunAudit::addCheck(const std::string& kind, Check check)
{
  checks_.emplace_back(kind, std::move(check));
}

void RunAudit::judge(const std::string& kind, double excess, const std::string& text)
{
  if (excess <= 1.0)
    return;
  Fault& fault = faults_[kind];
  if (fault.count == 0)
    fault.first_step = simulator_.report().step;
  ++fault.count;
  if (fault.text.empty() || !(excess <= fault.worst))
  {
    fault.worst = excess;
    fault.text = text + line(" (step ", simulator_.report().step, ")");
  }
}

void RunAudit::afterStep()
{
  ++steps_;
  checkOutcome();
  checkFinite();
  if (options_.penetration_every > 0 && steps_ % options_.penetration_every == 1)
    checkPenetration();
  // What a failed step leaves behind is the business of its policy, not of the invariants of an answer.
  if (simulator_.outcome().converged())
  {
    speed_ = problemSpeed();
    for (const ContactState& contact : simulator_.contacts())
      checkContact(contact);
    checkMomentum();
    for (const auto& [kind, check] : checks_)
    {
      std::string text;
      const double excess = check(simulator_, text);
      judge(kind, excess, text);
    }
  }
  checkEnergy();
  checkRest();
  beforeStep();
}

/**
 * max |q| of the rows, q = H v_free + w, v_free = -M^-1 f, of one-sided rows only what closes: never less than the
 * scale of the residual of any island. Found here with Eigen's own sparse factor.
 */
double RunAudit::problemSpeed() const
{
  const IncrementalProblem& problem = simulator_.problem();
  double speed = simulator_.scenario().gravity.norm() * simulator_.report().dt;
  if (problem.rows() == 0 || problem.M.rows() != problem.velocities())
    return speed;
  const Eigen::SparseMatrix<double> mass = problem.M;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(mass);
  const Eigen::VectorXd free = factor.solve(Eigen::VectorXd(-problem.f));
  const Eigen::VectorXd q = problem.H * free + problem.w;
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const bool one_sided = law.isCoulomb() || law.type == LawType::UNILATERAL;
    speed = std::max(speed, one_sided ? -q[row] : std::abs(q[row]));
    for (int k = 1; k < law.dimension(); ++k)
      speed = std::max(speed, std::abs(q[row + k]));
    row += law.dimension();
  }
  return speed;
}

void RunAudit::checkOutcome()
{
  const StepOutcome& outcome = simulator_.outcome();
  const double tolerance = simulator_.scenario().stopping.tolerance;
  if (!outcome.converged())
    judge("failed", std::max(2.0, outcome.residual / tolerance),
          line(toString(outcome.status), ", residual ", outcome.residual, ", ", outcome.message));
  else
    judge("residual", outcome.residual / (1.01 * tolerance), line("residual ", outcome.residual));
}

void RunAudit::checkFinite()
{
  const EnergyLedger& energy = simulator_.report().energy;
  bool finite = std::isfinite(energy.kinetic + energy.potential + energy.actuators + energy.balance_error) &&
                std::isfinite(simulator_.report().residual);
  for (int body = 0; body < simulator_.bodyCount(); ++body)
    finite = finite && simulator_.position(body).allFinite() && simulator_.velocity(body).allFinite();
  for (const ContactState& contact : simulator_.contacts())
    finite = finite && contact.impulse.allFinite() && contact.velocity.allFinite() && std::isfinite(contact.gap);
  if (!finite)
    judge("finite", 2.0, "a position, velocity, contact or energy is not a finite number");
}

void RunAudit::checkPenetration()
{
  const Penetration found = penetration_->worst();
  judge("penetration", found.depth / found.tolerance,
        line(found.pair, " ", found.depth, " m deep, allowed ", found.tolerance, " m"));
}

bool RunAudit::isDriven() const
{
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    if (!simulator_.state().bodies[body].wrenches.empty() || simulator_.scenario().bodies[body].motion ||
        !simulator_.scenario().bodies[body].surface_velocity.empty())
      return true;
    for (const JointDrive& drive : simulator_.state().bodies[body].drives)
      if (drive.command.mode != JointCommand::Mode::EFFORT || drive.command.target != 0.0)
        return true;
  }
  return false;
}

void RunAudit::checkEnergy()
{
  const StepSummary& report = simulator_.report();
  const EnergyLedger& now = report.energy;
  const double energy = now.kinetic + now.potential;
  exchanged_ +=
      std::abs(now.actuators - ledger_.actuators) + std::abs(now.friction - ledger_.friction) +
      std::abs(now.impact - ledger_.impact) + std::abs(now.joints - ledger_.joints) +
      std::max(0.0, std::min(std::abs(now.kinetic - ledger_.kinetic), std::abs(now.potential - ledger_.potential)));
  ledger_ = now;
  // At least what moves now, and the weight over a millimetre, the height of a drop.
  const double scale = std::max({exchanged_, now.kinetic, 1e-3 * weight_, 1e-12});
  judge("balance", std::abs(now.balance_error) / (1e-2 * scale),
        line("energy balance error ", now.balance_error, " J of ", scale, " J exchanged"));
  for (const ContactState& contact : simulator_.contacts())
    bouncing_ = bouncing_ || (contact.restitution > 0.0 && contact.friction > 0.0 && !contact.impulse.isZero());
  if (isDriven() || bouncing_)
    least_ = energy;
  judge("rise", (energy - least_) / (1e-2 * scale),
        line("energy of undriven bodies rises by ", energy - least_, " J of ", scale, " J exchanged"));
  least_ = std::min(least_, energy);
}

void RunAudit::checkRest()
{
  double speed = 0.0;
  double loads = weight_ + options_.loads;
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    const Eigen::VectorXd& v = simulator_.velocity(body);
    speed = std::max(speed, v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0);
    speed = simulator_.scenario().bodies[body].motion ? std::numeric_limits<double>::infinity() : speed;
    for (const ExternalWrench& wrench : simulator_.state().bodies[body].wrenches)
      loads += wrench.force.norm();
    const std::vector<Joint>& joints = simulator_.model(body).joints;
    for (size_t j = 0; j < joints.size(); ++j)
      if (joints[j].type == JointType::PRISMATIC)
        loads += std::abs(simulator_.effort(body, static_cast<int>(j)));
  }
  quiet_ = speed < options_.rest_speed ? quiet_ + 1 : 0;
  if (quiet_ <= 1)
  {
    weighed_ = 0;
    support_.setZero();
  }
  if (quiet_ > 1)  // from the first velocity of rest on
    checkWeight();
  if (quiet_ <= options_.rest_steps)
    return;
  double force = 0.0;
  for (const ContactState& contact : simulator_.contacts())
    force = std::max(force, contact.impulse.norm() / simulator_.report().dt);
  // A force of nothing but tolerance: in zero gravity the loads are zero.
  judge("self-stress", force / (options_.weights * loads + 1e-6),
        line("a contact force of ", force, " N at rest, loads ", loads, " N"));
}

/** The mean force over the rest is M (v_end - v_start)/T off the weight: the bound gets tighter as T grows. */
void RunAudit::checkWeight()
{
  double mass = 0.0;
  bool held = false;
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator_.model(body);
    if ((model.nv > 0 && !isFloating(model)) || !simulator_.state().bodies[body].wrenches.empty())
      held = true;  // by other things than contacts
    mass += model.nv > 0 ? model.totalMass() : 0.0;
  }
  for (const std::vector<Closure>* closures : {&simulator_.welds(), &simulator_.loops()})
    for (const Closure& closure : *closures)
      held = held || closure.body_b < 0 || simulator_.model(closure.body_b).nv == 0;
  if (held)
  {
    weighed_ = 0;
    support_.setZero();
    return;
  }
  const auto moves = [&](int shape)
  { return simulator_.shape(shape).body >= 0 && simulator_.model(simulator_.shape(shape).body).nv > 0; };
  for (const ContactState& contact : simulator_.contacts())
    support_ +=
        (moves(contact.shape_a) ? 1.0 : 0.0) * contact.impulse - (moves(contact.shape_b) ? 1.0 : 0.0) * contact.impulse;
  if (++weighed_ < options_.rest_steps)
    return;
  const double time = weighed_ * simulator_.report().dt;
  const Eigen::Vector3d error = support_ / time + mass * simulator_.scenario().gravity;
  // Ten: the centre of mass may be faster than the coordinates.
  judge("weight", error.norm() / (10.0 * options_.rest_speed * mass / time + 1e-6 * weight_ + 1e-300),
        line("the mean contact force is ", error.norm(), " N off the weight, ", weight_, " N, over ", time, " s"));
}

void RunAudit::checkMomentum()
{
  const IncrementalProblem& problem = simulator_.problem();
  const Solution& solution = simulator_.solution();
  if (solution.v.size() != problem.velocities())
    return;
  int first = 0;
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator_.model(body);
    if (isFloating(model) && model.nv >= 6)
    {
      Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
      double scale = model.totalMass() * speed_;
      for (const ContactState& contact : simulator_.contacts())
      {
        const double sign = (simulator_.shape(contact.shape_a).body == body ? 1.0 : 0.0) -
                            (simulator_.shape(contact.shape_b).body == body ? 1.0 : 0.0);
        impulse += sign * contact.impulse;
        scale += contact.impulse.norm();
      }
      for (const std::vector<Closure>* closures : {&simulator_.welds(), &simulator_.loops()})
        for (const Closure& closure : *closures)
        {
          const double sign = (closure.body_a == body ? 1.0 : 0.0) - (closure.body_b == body ? 1.0 : 0.0);
          impulse += sign * closure.impulse.head<3>();
          scale += closure.impulse.head<3>().norm();
        }
      Eigen::Vector3d change = Eigen::Vector3d::Zero();
      for (int row = 0; row < 3; ++row)
      {
        change[row] = problem.f[first + row];
        for (SparseRows::InnerIterator entry(problem.M, first + row); entry; ++entry)
        {
          change[row] += entry.value() * solution.v[entry.col()];
          scale += std::abs(entry.value() * solution.v[entry.col()]);
        }
      }
      // Round-off of a few dozen terms.
      judge("momentum", (change - impulse).norm() / (1e-12 * scale + 1e-300),
            line(simulator_.bodyName(body), ": M v + f and the sum of impulses differ by ", (change - impulse).norm(),
                 " N s of ", scale, " N s"));
      if (model.nv == 6)
        checkSingleLink(body, impulse, scale);
    }
    first += model.nv;
  }
}

void RunAudit::checkSingleLink(int body, const Eigen::Vector3d& impulse, double scale)
{
  const MultibodyModel& model = simulator_.model(body);
  const double mass = model.totalMass();
  const double dt = simulator_.report().dt;
  Eigen::Vector3d external = mass * dt * simulator_.scenario().gravity;
  const double middle = simulator_.state().scenario_clock.time(dt) - 0.5 * dt;
  for (const ExternalWrench& wrench : simulator_.state().bodies[body].wrenches)
  {
    if (!wrench.world_frame)
      return;
    if (wrench.from <= middle && middle < wrench.until)
      external += dt * wrench.force;
  }
  const Eigen::Vector3d change = mass * (centerVelocity(body) - old_center_velocity_[body]) - external;
  const double error = (change - impulse).norm();
  // Velocities of the centre are differences of those of the origin and of omega x c.
  const double arm = model.links.front().inertia.center.norm();
  const Eigen::VectorXd& v = simulator_.velocity(body);
  const double speeds = std::max(v.head<3>().norm(), old_velocity_[body].head<3>().norm()) +
                        arm * std::max(v.segment<3>(3).norm(), old_velocity_[body].segment<3>(3).norm());
  judge("momentum", error / (1e-12 * (scale + mass * speeds) + 1e-300),
        line(simulator_.bodyName(body), ": the momentum of a single link changes by ", error, " N s more than its ",
             "impulses, of ", scale + mass * speeds, " N s"));
}

/** Least mass of the two bodies of a contact that move [kg]: the effective mass of a row is not larger. */
double RunAudit::lightest(const ContactState& contact) const
{
  double mass = std::numeric_limits<double>::infinity();
  for (const int shape : {contact.shape_a, contact.shape_b})
  {
    const int body = simulator_.shape(shape).body;
    if (body >= 0 && simulator_.model(body).nv > 0)
      mass = std::min(mass, simulator_.model(body).totalMass());
  }
  return mass;
}

void RunAudit::checkContact(const ContactState& contact)
{
  const double dt = simulator_.report().dt;
  const double normal = contact.normal.dot(contact.impulse);
  const Eigen::Vector3d tangential = contact.impulse - normal * contact.normal;
  const double speed = contact.normal.dot(contact.velocity);
  const Eigen::Vector3d slip = contact.velocity - speed * contact.normal;
  const double force = std::max(contact.impulse.norm(), 1e-12 * weight_ * dt + 1e-300);
  const double mass = lightest(contact);
  // E of tolerance is a velocity error of tolerance times the speeds of the problem; ten for the norms of the parts.
  // What is below the round-off of the bodies' speeds counts as zero (64 eps), which is in velocities published too.
  double fastest = 0.0;
  for (const LawScale& scale : simulator_.problem().scales)
    fastest = std::max(fastest, scale.speed);
  const double tolerance = 10.0 * simulator_.scenario().stopping.tolerance * std::max(speed_, 1e-12) + 1e-14 +
                           128.0 * std::numeric_limits<double>::epsilon() * fastest;
  const std::string who =
      line(simulator_.shape(contact.shape_a).link_name, " - ", simulator_.shape(contact.shape_b).link_name, ": ");
  judge("cone", -normal / (1e-9 * force + mass * tolerance), who + line("r_N is ", normal, " N s"));
  judge("cone",
        (tangential.norm() - contact.friction * normal) / (1e-9 * force + (1.0 + contact.friction) * mass * tolerance),
        who + line("|r_T| = ", tangential.norm(), " N s beyond mu r_N = ", contact.friction * normal, " N s"));
  const double power = tangential.dot(slip);
  judge("friction", power / ((force + mass * tolerance) * tolerance + mass * tolerance * slip.norm()),
        who + line("friction puts in ", power, " J, |r| = ", force, " N s"));
  const bool is_gap_law = contact.mode != ContactMode::IMPACT && contact.gap >= 0.0 &&
                          simulator_.scenario().contact_law == ContactLawForm::GAP;
  if (!is_gap_law)
    return;
  const double shifted = speed + contact.row_gap / dt;
  judge("gap", -shifted / tolerance, who + line("u_N + gap/dt = ", shifted, " m/s"));
  judge("gap", std::min(shifted, normal / mass) / tolerance,
        who + line("r_N = ", normal, " N s though u_N + gap/dt = ", shifted, " m/s"));
}

const std::map<std::string, Fault>& RunAudit::finish()
{
  if (options_.penetration_every > 0 && steps_ > 0)
    checkPenetration();
  return faults_;
}

std::vector<std::string> RunAudit::faults()
{
  std::vector<std::string> lines;
  for (const auto& [kind, fault] : finish())
    lines.push_back(line(kind, ": ", fault.count, fault.count == 1 ? " time" : " times", ", first at step ",
                         fault.first_step, ", worst: ", fault.text));
  return lines;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
