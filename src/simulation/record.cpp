// After the solve: contacts, joint impulses, report.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/simulation/energy.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
/** Relative to its cone: nearer to the boundary than this is on it, when the contact also moves. */
constexpr double STICKING_SPEED = 1e-9;  ///< [m/s]

ContactMode modeOf(const ContactRow& row, const Eigen::Vector3d& impulse, const Eigen::Vector3d& velocity,
                   double tolerance)
{
  // What the solver calls zero, in units of this contact: tolerance times its own velocity or impulse, at least 1e-9.
  const double speed = std::max(STICKING_SPEED, 10.0 * tolerance * velocity.norm());
  if (impulse[0] <= 0.0)
    return ContactMode::OPEN;
  if (row.closing)
    return ContactMode::IMPACT;
  const double margin = row.friction * impulse[0] - impulse.tail<2>().norm();
  const bool inside = margin > 1e-6 * row.friction * impulse[0];
  return inside || velocity.tail<2>().norm() <= speed ? ContactMode::STICKING : ContactMode::SLIDING;
}
}  // namespace

void Simulator::Impl::finishStep(const std::vector<ContactPoint>& points)
{
  storeContacts(points);
  storeJointImpulses();
  storeReport();
}

void Simulator::Impl::storeContacts(const std::vector<ContactPoint>& points)
{
  contacts.clear();
  contact_index.clear();
  for (const ContactRow& row : assembly.contactRows())
  {
    const ContactPoint& point = points[row.point];
    const Eigen::Vector3d r = result.solution.r.segment<3>(row.row);
    Eigen::Vector3d u = result.solution.u.segment<3>(row.row);
    u[0] -= row.shift;
    if (row.creep.compliance > 0.0)
      u[1] -= row.creep.compliance * r[1] + row.creep.offset;
    ContactState state;
    state.id = point.id;
    state.shape_a = point.shape_a;
    state.shape_b = point.shape_b;
    state.position = point.position;
    state.normal = point.normal;
    state.tangent_1 = row.tangent_1;
    state.tangent_2 = row.tangent_2;
    state.gap = point.gap;
    state.friction = row.friction;
    state.restitution = row.restitution;
    state.impulse = r[0] * point.normal + r[1] * row.tangent_1 + r[2] * row.tangent_2;
    state.velocity = u[0] * point.normal + u[1] * row.tangent_1 + u[2] * row.tangent_2;
    state.cone_margin = row.friction * r[0] - r.tail<2>().norm();
    const auto law = static_cast<Eigen::Index>(contacts.size());  // contacts are the first laws, in this order
    if (isMotion(result.solution) && law < result.law_errors.size())
      state.residual = result.law_errors[law];
    state.mode = modeOf(row, r, u, scenario.stopping.tolerance);
    contact_index.emplace_back(state.id, static_cast<int>(contacts.size()));
    contacts.push_back(state);
  }
  std::sort(contact_index.begin(), contact_index.end());
}

void Simulator::Impl::storeJointImpulses()
{
  for (std::vector<std::array<double, 4>>& robot : joint_impulses)
    for (std::array<double, 4>& joint : robot)
      joint.fill(0.0);
  for (const JointRow& row : assembly.jointRows())
    joint_impulses[row.robot][row.joint][static_cast<int>(row.kind)] = result.solution.r[row.row];
  guess.lambda = result.solution.lambda;
}

void Simulator::Impl::storeReport()
{
  const IncrementalProblem& problem = assembly.problem();
  ++report.step;
  report.time = time;
  report.dt = settings.dt;
  report.contacts = static_cast<int>(contacts.size());
  report.velocities = assembly.velocities();
  report.bilaterals = problem.bilaterals();
  report.islands = countIslands();
  report.solver = result.solver;
  report.solvers_tried.clear();
  for (const std::string& name : result.tried)
  {
    if (!report.solvers_tried.empty())
      report.solvers_tried += ',';
    report.solvers_tried += name;
  }
  report.status = result.status;
  report.iterations = result.iterations;
  report.residual = result.residual;
  report.solve_time = result.seconds;
  report.bilateral_violation = 0.0;
  for (int k = 0; k < problem.bilaterals(); ++k)
    report.bilateral_violation = std::max(report.bilateral_violation, std::abs(problem.b[k]) * settings.dt);
  report.max_penetration = 0.0;
  for (const ContactState& contact : contacts)
    report.max_penetration = std::max(report.max_penetration, -contact.gap);
  bookEnergies(world.robots, settings.gravity, report.energy);
  EnergyLedger& energy = report.energy;
  energy.balance_error = energy.kinetic + energy.potential - energy_start - energy.actuators + energy.friction +
                         energy.impact + energy.joints;
  if (!step_failed)
    report.fclib_file.clear();
}

/** Connected components of robots through contacts with a nonempty row. */
int Simulator::Impl::countIslands()
{
  std::iota(island_of.begin(), island_of.end(), 0);
  const auto root = [this](int robot)
  {
    while (island_of[robot] != robot)
      robot = island_of[robot] = island_of[island_of[robot]];
    return robot;
  };
  for (const ContactState& contact : contacts)
  {
    const int a = world.collision.shape(contact.shape_a).robot;
    const int b = world.collision.shape(contact.shape_b).robot;
    if (a >= 0 && b >= 0 && world.robots[a].model.nv > 0 && world.robots[b].model.nv > 0)
      island_of[root(a)] = root(b);
  }
  int islands = 0;
  for (size_t r = 0; r < island_of.size(); ++r)
    islands += world.robots[r].model.nv > 0 && root(static_cast<int>(r)) == static_cast<int>(r);
  return islands;
}

void Simulator::Impl::dumpProblem()
{
  report.fclib_file = dump_folder + "/" + scenario.name + "_step_" + std::to_string(report.step + 1) + ".hdf5";
  try
  {
    FclibInfo info;
    info.title = scenario.name + " step " + std::to_string(report.step + 1);
    info.description =
        "w contains the shift of the normal law (gap/dt, restitution); bounded servos and dry joint "
        "friction are encoded as problem/fclib.h says";
    writeFclib(report.fclib_file, assembly.problem(), info);
  }
  catch (const std::exception& error)
  {
    report.fclib_file = std::string("not written: ") + error.what();
  }
}

}  // namespace frictional_contact_sim
