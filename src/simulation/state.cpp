#include "frictional_contact_sim/simulation/state.h"

#include <cstring>

#include "fnv1a.h"
#include "frictional_contact_sim/simulation/state_archive.h"

namespace frictional_contact_sim
{
namespace
{
void visit(StateArchive& archive, TrajectoryPoint& point)
{
  archive.number("trajectory.time", point.time);
  archive.number("trajectory.position", point.motion.position);
  archive.number("trajectory.velocity", point.motion.velocity);
  archive.number("trajectory.acceleration", point.motion.acceleration);
  archive.index("trajectory.order", point.order);
}

/** What few commands have. */
void visitExtras(StateArchive& archive, JointDrive& drive)
{
  archive.number("command.rate", drive.command.rate);
  archive.number("command.feedforward", drive.command.feedforward);
  for (TrajectoryPoint& point : archive.list("trajectory", drive.trajectory.points))
    visit(archive, point);
}

void visit(StateArchive& archive, JointDrive& drive)
{
  // One number for mode, schedule and extras: states without these are those of before there were any, to the bit.
  constexpr std::uint64_t MODES = 3;
  constexpr std::uint64_t KINDS = 2 * MODES;
  const bool extras = drive.command.rate != 0.0 || drive.command.feedforward != 0.0 || !drive.trajectory.points.empty();
  std::uint64_t mode =
      static_cast<std::uint64_t>(drive.command.mode) + (drive.is_scheduled ? MODES : 0) + (extras ? KINDS : 0);
  archive.integer("command.mode", mode);
  if (mode >= 2 * KINDS)
    throw StateError("command.mode is " + std::to_string(mode) + ", expected less than " + std::to_string(2 * KINDS));
  drive.command.mode = static_cast<JointCommand::Mode>(mode % MODES);
  drive.is_scheduled = mode % KINDS >= MODES;
  if (mode >= KINDS)
  {
    visitExtras(archive, drive);
  }
  else if (extras)  // a reader's state had them, what is read has not
  {
    drive.command.rate = drive.command.feedforward = 0.0;
    drive.trajectory.points.clear();
  }
  archive.number("command.target", drive.command.target);
  archive.number("command.kp", drive.command.kp);
  archive.number("command.kd", drive.command.kd);
  archive.number("command.max_effort", drive.command.max_effort);
  archive.number("effort_limit", drive.effort_limit);
  archive.number("effort", drive.effort);
}

void visit(StateArchive& archive, ExternalWrench& wrench)
{
  archive.text("wrench.link", wrench.link);
  archive.index("wrench.frame", wrench.frame);
  archive.vector("wrench.force", wrench.force);
  archive.vector("wrench.torque", wrench.torque);
  archive.vector("wrench.point", wrench.point);
  // One number for both: states without replaceable wrenches are those of before there were any, to the bit.
  std::uint64_t kind = (wrench.world_frame ? 1U : 0U) + (wrench.is_replaceable ? 2U : 0U);
  archive.integer("wrench.world_frame", kind);
  if (kind > 3)
    throw StateError("wrench.world_frame is " + std::to_string(kind) + ", expected at most 3");
  wrench.world_frame = kind % 2 == 1;
  wrench.is_replaceable = kind >= 2;
  archive.number("wrench.from", wrench.from);
  archive.number("wrench.until", wrench.until);
}

void visit(StateArchive& archive, BodyState& body)
{
  archive.vector("q", body.q);
  archive.vector("v", body.v);
  archive.vector("base_pose", body.base_pose.matrix());
  for (JointDrive& drive : archive.fixedList("drives", body.drives))
    visit(archive, drive);
  for (ExternalWrench& wrench : archive.list("wrenches", body.wrenches))
    visit(archive, wrench);
}

void visit(StateArchive& archive, ContactState& contact)
{
  constexpr std::uint64_t MODES = 4;
  archive.integer("contact.id.shapes", contact.id.shapes);
  archive.integer("contact.id.features", contact.id.features);
  archive.index("contact.shape_a", contact.shape_a);
  archive.index("contact.shape_b", contact.shape_b);
  archive.vector("contact.position", contact.position);
  archive.vector("contact.normal", contact.normal);
  archive.vector("contact.tangent_1", contact.tangent_1);
  archive.vector("contact.tangent_2", contact.tangent_2);
  archive.number("contact.gap", contact.gap);
  archive.number("contact.row_gap", contact.row_gap);
  archive.number("contact.friction", contact.friction);
  archive.number("contact.restitution", contact.restitution);
  archive.vector("contact.impulse", contact.impulse);
  archive.vector("contact.velocity", contact.velocity);
  archive.enumeration("contact.mode", contact.mode, MODES);
  archive.number("contact.residual", contact.residual);
  archive.number("contact.cone_margin", contact.cone_margin);
}

void visit(StateArchive& archive, WedgedPair& pair)
{
  archive.index("wedged.shape_a", pair.shape_a);
  archive.index("wedged.shape_b", pair.shape_b);
  archive.number("wedged.overlap", pair.overlap);
  archive.index("wedged.steps", pair.steps);
}

void visit(StateArchive& archive, Closure& weld)
{
  archive.index("weld.body_a", weld.body_a);
  archive.index("weld.frame_a", weld.frame_a);
  archive.index("weld.body_b", weld.body_b);
  archive.index("weld.frame_b", weld.frame_b);
  archive.vector("weld.pose", weld.pose.matrix());
  archive.vector("weld.impulse", weld.impulse);
}

/** What it joins is the world's. */
void visitLoop(StateArchive& archive, Closure& loop)
{
  archive.vector("loop.basis", loop.basis);
  archive.vector("loop.impulse", loop.impulse);
}

void visit(StateArchive& archive, EnergyLedger& energy)
{
  archive.number("energy.kinetic", energy.kinetic);
  archive.number("energy.potential", energy.potential);
  archive.number("energy.actuators", energy.actuators);
  archive.number("energy.friction", energy.friction);
  archive.number("energy.impact", energy.impact);
  archive.number("energy.joints", energy.joints);
  archive.number("energy.balance_error", energy.balance_error);
}

class Hash : public StateArchive
{
public:
  void number(const std::string&, double& value) override
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    hash_.add(bits);
  }
  void integer(const std::string&, std::uint64_t& value) override { hash_.add(value); }
  void text(const std::string&, std::string& value) override
  {
    for (const char letter : value)
      hash_.add(std::uint64_t{static_cast<unsigned char>(letter)});
  }
  bool skipsEmptyNewLists() const override { return true; }
  std::uint64_t value() const { return hash_.value(); }

private:
  Fnv1a hash_;
};

/** Every entry as text: its name and its bits. */
class Listing : public StateArchive
{
public:
  void number(const std::string& name, double& value) override
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    entries.emplace_back(name, std::to_string(bits));
  }
  void integer(const std::string& name, std::uint64_t& value) override
  {
    entries.emplace_back(name, std::to_string(value));
  }
  void text(const std::string& name, std::string& value) override { entries.emplace_back(name, value); }

  std::vector<std::pair<std::string, std::string>> entries;
};

/** For archives that only read. */
void show(StateArchive& archive, const SimulationState& state)
{
  visitState(archive, const_cast<SimulationState&>(state));
}
}  // namespace

void visitState(StateArchive& archive, SimulationState& state)
{
  archive.integer("step", state.step);
  archive.number("dt", state.dt);
  archive.number("clock.start", state.clock.start);
  archive.integer("clock.steps", state.clock.steps);
  archive.number("scenario_clock.start", state.scenario_clock.start);
  archive.integer("scenario_clock.steps", state.scenario_clock.steps);
  for (BodyState& body : archive.fixedList("bodies", state.bodies))
    visit(archive, body);
  for (ContactState& contact : archive.list("contacts", state.rows.contacts))
    visit(archive, contact);
  for (RowMemory& memory : archive.fixedList("row memories", state.rows.memory))
    for (double& impulse : archive.fixedList("impulses of " + memory.name, memory.impulses))
      archive.number(memory.name, impulse);
  visit(archive, state.energy);
  archive.number("energy_start", state.energy_start);
  if (!state.wedged.empty() || !archive.skipsEmptyNewLists())
    for (WedgedPair& pair : archive.list("wedged pairs", state.wedged))
      visit(archive, pair);
  if (!state.rows.loops.empty() || !archive.skipsEmptyNewLists())
    for (Closure& loop : archive.fixedList("loops", state.rows.loops))
      visitLoop(archive, loop);
  if (!state.rows.welds.empty() || !archive.skipsEmptyNewLists())
    for (Closure& weld : archive.list("welds", state.rows.welds))
      visit(archive, weld);
}

std::uint64_t hashOf(const SimulationState& state)
{
  Hash hash;
  show(hash, state);
  return hash.value();
}

std::string firstDifference(const SimulationState& a, const SimulationState& b)
{
  Listing list_a;
  Listing list_b;
  show(list_a, a);
  show(list_b, b);
  for (size_t i = 0; i < list_a.entries.size() && i < list_b.entries.size(); ++i)
    if (list_a.entries[i] != list_b.entries[i])
      return list_a.entries[i].first + " (entry " + std::to_string(i) + ")";
  return list_a.entries.size() == list_b.entries.size() ? "" : "the number of entries";
}

}  // namespace frictional_contact_sim
