#include "frictional_contact_sim/dynamics/row_sources.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "frictional_contact_sim/dynamics/closure_rows.h"
#include "frictional_contact_sim/dynamics/contact_rows.h"
#include "frictional_contact_sim/dynamics/creep_rows.h"
#include "frictional_contact_sim/dynamics/dry_friction_rows.h"
#include "frictional_contact_sim/dynamics/joint_springs.h"
#include "frictional_contact_sim/dynamics/limit_rows.h"
#include "frictional_contact_sim/dynamics/mimic_rows.h"
#include "frictional_contact_sim/dynamics/servo_rows.h"

namespace frictional_contact_sim
{
namespace
{
constexpr size_t MOST_MEMORIES = 32;  ///< sources hold references to theirs, so the list never grows beyond this
}  // namespace

JointMemory::JointMemory(const char* name, int impulses_a_joint, const std::vector<Body>& bodies, RowMemory& memory)
  : memory_(memory), width_(impulses_a_joint)
{
  int joints = 0;
  for (const Body& body : bodies)
  {
    first_.push_back(joints);
    joints += static_cast<int>(body.model.tree.joints.size());
  }
  memory_.name = name;
  memory_.impulses.assign(static_cast<size_t>(joints * width_), 0.0);
}

std::vector<std::unique_ptr<RowSource>> makeRowSources(std::vector<Body>& bodies, const CollisionWorld& world,
                                                       const PairTable& pairs, RowState& state, ContactSet* contacts)
{
  std::unique_ptr<CreepRows> creep;
  if (pairs.hasCreep())
    creep = std::make_unique<CreepRows>(bodies, world);
  state.memory.clear();
  state.memory.reserve(MOST_MEMORIES);
  const auto memory = [&state]() -> RowMemory&
  {
    if (state.memory.size() == MOST_MEMORIES)
      throw std::logic_error("row_sources.cpp: MOST_MEMORIES kinds of rows keep impulses already");
    return state.memory.emplace_back();
  };
  std::vector<std::unique_ptr<RowSource>> sources;
  sources.push_back(std::make_unique<ContactRows>(bodies, world, pairs, state.contacts, creep.get(), contacts));
  sources.push_back(std::make_unique<LimitRows>(bodies, memory()));
  sources.push_back(std::make_unique<DryFrictionRows>(bodies, memory()));
  sources.push_back(std::make_unique<ServoRows>(bodies, memory()));
  if (std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return !body.model.springs.empty(); }))
    sources.push_back(std::make_unique<JointSprings>(bodies));
  sources.push_back(std::make_unique<MimicRows>(bodies, memory()));
  sources.push_back(std::make_unique<ClosureRows>("loops", bodies, state.loops));
  sources.push_back(std::make_unique<ClosureRows>("welds", bodies, state.welds));
  // Last: tangents are looked at once everything else of the step is settled.
  if (creep)
    sources.push_back(std::move(creep));
  return sources;
}

}  // namespace frictional_contact_sim
