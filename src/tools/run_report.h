#pragma once
/**
 * @file run_report.h
 * @brief What run_scenario says of a run: a JSON object for machines (docs/interfaces.md), some lines for a person.
 */
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/root_motion.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "progress_bar.h"

namespace frictional_contact_sim
{
namespace tools
{
/** @brief What is worst over all steps of a run. */
struct RunSummary
{
  long steps = 0;
  long failed_steps = 0;
  double seconds = 0.0;  ///< wall clock of the steps [s]
  double worst_residual = 0.0;
  double max_penetration = 0.0;  ///< [m]
  double max_bilateral_violation = 0.0;
  double loading_seconds = 0.0;
  std::uint64_t hash = 0;  ///< of the state at the end
  bool ended = false;  ///< by a failed step, under the policies stop and pause
  double simulated(const Simulator& simulator) const
  {
    return static_cast<double>(steps) * simulator.scenario().time_step;
  }
};

inline std::vector<double> numbers(const Eigen::VectorXd& vector)
{
  return {vector.data(), vector.data() + vector.size()};
}

/** @brief Of each body: sum of the contact forces on it in the last step, world axes [N]. */
inline std::vector<Eigen::Vector3d> contactForces(const Simulator& simulator)
{
  std::vector<Eigen::Vector3d> forces(simulator.bodyCount(), Eigen::Vector3d::Zero());
  for (const ContactState& contact : simulator.contacts())
  {
    const Eigen::Vector3d force = contact.impulse / simulator.report().dt;
    const int a = simulator.shape(contact.shape_a).body;
    const int b = simulator.shape(contact.shape_b).body;
    if (a >= 0)
      forces[a] += force;
    if (b >= 0)
      forces[b] -= force;
  }
  return forces;
}

inline nlohmann::json describeBody(const Simulator& simulator, int body)
{
  const Eigen::Isometry3d pose = rootPose(simulator, body);
  const Eigen::Quaterniond orientation(pose.linear());
  const Vector6d velocity = rootVelocity(simulator, body);
  nlohmann::json joints = nlohmann::json::object();
  const MultibodyModel& model = simulator.model(body);
  for (size_t j = 0; j < model.joints.size(); ++j)
  {
    const Joint& joint = model.joints[j];
    if (velocitySize(joint.type) == 1)
      joints[joint.name] = {{"position", simulator.position(body)[joint.q_index]},
                            {"velocity", simulator.velocity(body)[joint.v_index]},
                            {"effort", simulator.effort(body, static_cast<int>(j))}};
  }
  return {{"position", numbers(pose.translation())},
          {"orientation", {orientation.x(), orientation.y(), orientation.z(), orientation.w()}},
          {"linear_velocity", numbers(velocity.head<3>())},
          {"angular_velocity", numbers(velocity.tail<3>())},
          {"joints", joints}};
}

/** @param identical whether all repeats gave the same bits */
inline nlohmann::json describe(const Simulator& simulator, const RunSummary& summary, bool identical)
{
  const EnergyLedger& energy = simulator.report().energy;
  const std::vector<Eigen::Vector3d> forces = contactForces(simulator);
  nlohmann::json bodies = nlohmann::json::object();
  nlohmann::json contact_force = nlohmann::json::object();
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    bodies[simulator.bodyName(body)] = describeBody(simulator, body);
    contact_force[simulator.bodyName(body)] = numbers(forces[body]);
  }
  return {{"scenario", simulator.scenario().name},
          {"steps", summary.steps},
          {"simulated", summary.simulated(simulator)},
          {"seconds", summary.seconds},
          {"steps_per_second", summary.seconds > 0.0 ? static_cast<double>(summary.steps) / summary.seconds : 0.0},
          {"loading_seconds", summary.loading_seconds},
          {"worst_residual", summary.worst_residual},
          {"failed_steps", summary.failed_steps},
          {"max_penetration", summary.max_penetration},
          {"max_bilateral_violation", summary.max_bilateral_violation},
          {"energy",
           {{"kinetic", energy.kinetic},
            {"potential", energy.potential},
            {"actuators", energy.actuators},
            {"friction", energy.friction},
            {"impact", energy.impact},
            {"joints", energy.joints},
            {"balance_error", energy.balance_error}}},
          {"state_hash", summary.hash},
          {"repeats_identical", identical},
          {"bodies", bodies},
          {"contact_force", contact_force}};
}

/// As printf; lines of a summary are short.
template <typename... Values>
std::string formatted(const char* format, Values... values)
{
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/** @brief For printing with so many decimals: what rounds to zero has no sign. */
inline Eigen::Vector3d rounded(const Eigen::Vector3d& vector, int decimals)
{
  const double unit = std::pow(10.0, -decimals);
  return (vector.array().abs() < 0.5 * unit).select(0.0, vector);
}

/** @brief A body's line: where its root link stands, how fast it is, what its contacts press with. */
inline std::string summarizeBody(const Simulator& simulator, int body, const Eigen::Vector3d& force)
{
  const Eigen::Isometry3d pose = rootPose(simulator, body);
  const Eigen::Matrix3d R = pose.linear();
  constexpr double DEGREES = 180.0 / M_PI;
  const Eigen::Vector3d angles(std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
                               std::atan2(R(1, 0), R(0, 0)));
  const Eigen::Vector3d rpy = rounded(DEGREES * angles, 2);
  const Eigen::Vector3d at = rounded(pose.translation(), 4);
  const Eigen::Vector3d total = rounded(force, 3);
  return formatted("  %-16s %9.4f %9.4f %9.4f   %7.2f %7.2f %7.2f   %9.2e   %9.3f %9.3f %9.3f\n",
                   simulator.bodyName(body).c_str(), at.x(), at.y(), at.z(), rpy.x(), rpy.y(), rpy.z(),
                   rootVelocity(simulator, body).head<3>().norm(), total.x(), total.y(), total.z());
}

/** @brief A few lines for a person: what stands where, and whether the run can be trusted. */
inline std::string summarize(const Simulator& simulator, const RunSummary& summary, bool identical)
{
  constexpr int LISTED = 12;  // bodies
  const double simulated = summary.simulated(simulator);
  std::string text =
      simulator.scenario().name + ": " + std::to_string(summary.steps) + " steps of " +
      formatted("%g s, %.6g s simulated in %.3g s", simulator.scenario().time_step, simulated, summary.seconds);
  if (summary.seconds > 0.0)
    text += formatted(", %.3g times as fast as real time", simulated / summary.seconds);
  text += summary.ended ? "; ended by a failed step\n" : "\n";
  text += formatted("\n  %-16s %29s   %23s   %9s   %29s\n", "body at the end", "x, y, z [m]", "roll, pitch, yaw [deg]",
                    "[m/s]", "sum of contact forces [N]");
  const std::vector<Eigen::Vector3d> forces = contactForces(simulator);
  int fastest = 0;
  double speed = -1.0;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    if (body < LISTED)
      text += summarizeBody(simulator, body, forces[body]);
    const double own = rootVelocity(simulator, body).head<3>().norm();
    if (own > speed)
      fastest = body;
    speed = std::max(speed, own);
  }
  if (simulator.bodyCount() > LISTED)
    text += "  and " + std::to_string(simulator.bodyCount() - LISTED) + " more; the fastest of all is " +
            simulator.bodyName(fastest) + formatted(" at %.2e m/s (--json has all)\n", speed);
  const EnergyLedger& energy = simulator.report().energy;
  text += formatted("\n  failed steps         %ld\n", summary.failed_steps);
  text += formatted("  worst residual       %.2e, tolerance %.0e\n", summary.worst_residual,
                    simulator.scenario().stopping.tolerance);
  text += formatted("  deepest penetration  %.2e m\n", summary.max_penetration);
  if (summary.max_bilateral_violation > 0.0)
    text += formatted("  worst closure error  %.2e\n", summary.max_bilateral_violation);
  text += formatted("  contacts             %d at the end\n", simulator.report().contacts);
  text += formatted(
      "  energy [J]           kinetic %.4g, potential %.6g, actuators %.4g, friction %.4g, impact %.4g, "
      "joints %.4g; balance error %.1e\n",
      energy.kinetic, energy.potential, energy.actuators, energy.friction, energy.impact, energy.joints,
      energy.balance_error);
  if (!identical)
    text += "  the repeats differ\n";
  return text;
}

}  // namespace tools
}  // namespace frictional_contact_sim
