#include "frictional_contact_sim/dynamics/row_sources.h"

#include <utility>

#include "frictional_contact_sim/dynamics/contact_rows.h"
#include "frictional_contact_sim/dynamics/creep_rows.h"
#include "frictional_contact_sim/dynamics/dry_friction_rows.h"
#include "frictional_contact_sim/dynamics/limit_rows.h"
#include "frictional_contact_sim/dynamics/mimic_rows.h"
#include "frictional_contact_sim/dynamics/servo_rows.h"

namespace frictional_contact_sim
{
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
                                                       const PairTable& pairs, RowState& state)
{
  std::unique_ptr<CreepRows> creep;
  if (pairs.hasCreep())
    creep = std::make_unique<CreepRows>(bodies, world);
  state.memory.resize(4);
  std::vector<std::unique_ptr<RowSource>> sources;
  sources.push_back(std::make_unique<ContactRows>(bodies, world, pairs, state.contacts, creep.get()));
  sources.push_back(std::make_unique<LimitRows>(bodies, state.memory[0]));
  sources.push_back(std::make_unique<DryFrictionRows>(bodies, state.memory[1]));
  sources.push_back(std::make_unique<ServoRows>(bodies, state.memory[2]));
  sources.push_back(std::make_unique<MimicRows>(bodies, state.memory[3]));
  // Last: tangents are looked at once everything else of the step is settled.
  if (creep)
    sources.push_back(std::move(creep));
  return sources;
}

}  // namespace frictional_contact_sim
