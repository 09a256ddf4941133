// Bodies that come and go in a run: another world, and everything that the others have goes over into it.
#include <algorithm>
#include <map>
#include <stdexcept>

#include "elastic_overlap.h"
#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/dynamics/contact_law.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "simulator_impl.h"
#include "start_check.h"

namespace frictional_contact_sim
{
namespace
{
/** New numbers of old things, -1 for what is gone. */
using Renumbering = std::vector<int>;

Renumbering renumberShapes(const CollisionWorld& from, const CollisionWorld& to, const Renumbering& new_body)
{
  // The shapes of one body, and the static ones, stand in one order in both worlds.
  const auto list = [](const CollisionWorld& world)
  {
    std::map<int, std::vector<int>> shapes;
    for (int handle = 0; handle < world.shapeCount(); ++handle)
      shapes[world.shape(handle).body].push_back(handle);
    return shapes;
  };
  Renumbering new_shape(static_cast<size_t>(from.shapeCount()), -1);
  std::map<int, std::vector<int>> now = list(to);
  for (const auto& [body, shapes] : list(from))
  {
    const int other = body < 0 ? body : new_body[static_cast<size_t>(body)];
    if (body >= 0 && other < 0)
      continue;
    for (size_t i = 0; i < shapes.size(); ++i)
      new_shape[static_cast<size_t>(shapes[i])] = now[other][i];
  }
  return new_shape;
}

/** Impulses of joints, which stand body by body. */
void carryMemory(const RowMemory& from, const std::vector<BodyState>& old_bodies, const Renumbering& new_body,
                 const std::vector<BodyState>& new_bodies, RowMemory& to)
{
  const auto joints = [](const std::vector<BodyState>& bodies, size_t count)
  {
    size_t sum = 0;
    for (size_t b = 0; b < count; ++b)
      sum += bodies[b].drives.size();
    return sum;
  };
  const size_t all = joints(old_bodies, old_bodies.size());
  const size_t width = all == 0 ? 0 : from.impulses.size() / all;
  for (size_t b = 0; b < old_bodies.size(); ++b)
  {
    if (new_body[b] < 0)
      continue;
    const auto first = from.impulses.begin() + static_cast<std::ptrdiff_t>(width * joints(old_bodies, b));
    const size_t place = width * joints(new_bodies, static_cast<size_t>(new_body[b]));
    std::copy(first, first + static_cast<std::ptrdiff_t>(width * old_bodies[b].drives.size()),
              to.impulses.begin() + static_cast<std::ptrdiff_t>(place));
  }
}

std::vector<ContactState> carriedContacts(const std::vector<ContactState>& from, const Renumbering& new_shape)
{
  std::vector<ContactState> contacts;
  for (ContactState contact : from)
  {
    contact.shape_a = new_shape[static_cast<size_t>(contact.shape_a)];
    contact.shape_b = new_shape[static_cast<size_t>(contact.shape_b)];
    if (contact.shape_a < 0 || contact.shape_b < 0)
      continue;
    contact.id = makeContactId(contact.shape_a, contact.shape_b, featureA(contact.id), featureB(contact.id));
    contacts.push_back(contact);
  }
  return contacts;
}

WedgedPairs carriedWedges(const WedgedPairs& from, const Renumbering& new_shape)
{
  WedgedPairs wedged;
  for (WedgedPair pair : from)
  {
    pair.shape_a = new_shape[static_cast<size_t>(pair.shape_a)];
    pair.shape_b = new_shape[static_cast<size_t>(pair.shape_b)];
    if (pair.shape_a >= 0 && pair.shape_b >= 0)
      leaveOverlap(pair, wedged);
  }
  return wedged;
}

std::vector<Closure> carriedWelds(const std::vector<Closure>& from, const Renumbering& new_body)
{
  std::vector<Closure> welds;
  for (Closure weld : from)
  {
    weld.body_a = new_body[static_cast<size_t>(weld.body_a)];
    const bool is_gone = weld.body_a < 0 || (weld.body_b >= 0 && new_body[static_cast<size_t>(weld.body_b)] < 0);
    weld.body_b = weld.body_b < 0 ? -1 : new_body[static_cast<size_t>(weld.body_b)];
    if (!is_gone)
      welds.push_back(weld);
  }
  return welds;
}

/** Impulses of the loops that are still there; new ones come last. */
void carryLoops(const std::vector<Closure>& from, const Renumbering& new_body, std::vector<Closure>& to)
{
  size_t next = 0;
  for (const Closure& loop : from)
  {
    const bool is_gone = new_body[static_cast<size_t>(loop.body_a)] < 0 ||
                         (loop.body_b >= 0 && new_body[static_cast<size_t>(loop.body_b)] < 0);
    if (is_gone)
      continue;
    to[next].basis = loop.basis;
    to[next++].impulse = loop.impulse;
  }
}

/** `from` in another world; `to` is that world's own start and has the bodies that are new. */
SimulationState carriedState(const SimulationState& from, SimulationState to, const Renumbering& new_body,
                             const Renumbering& new_shape)
{
  to.step = from.step;
  to.dt = from.dt;
  to.clock = from.clock;
  to.scenario_clock = from.scenario_clock;
  to.energy = from.energy;
  to.energy_start = from.energy_start;
  to.wedged = carriedWedges(from.wedged, new_shape);
  to.rows.contacts = carriedContacts(from.rows.contacts, new_shape);
  to.rows.welds = carriedWelds(from.rows.welds, new_body);
  carryLoops(from.rows.loops, new_body, to.rows.loops);
  for (size_t i = 0; i < to.rows.memory.size(); ++i)
    for (const RowMemory& memory : from.rows.memory)  // a kind of row may have come with a body: by name
      if (memory.name == to.rows.memory[i].name)
        carryMemory(memory, from.bodies, new_body, to.bodies, to.rows.memory[i]);
  for (size_t b = 0; b < from.bodies.size(); ++b)
    if (new_body[b] >= 0)
      to.bodies[static_cast<size_t>(new_body[b])] = from.bodies[b];
  return to;
}

/** Kinetic and potential alone. */
EnergyLedger energyOf(const BodyModel& model, BodyState state, const Eigen::Vector3d& gravity)
{
  EnergyLedger energy;
  if (model.nv == 0)
    return energy;
  Body body(model, state);
  updateEnd(body);
  energy.kinetic = kineticEnergy(body);
  energy.potential = potentialEnergy(body, gravity);
  return energy;
}

Renumbering sameNumbers(size_t bodies)
{
  Renumbering same(bodies);
  for (size_t b = 0; b < bodies; ++b)
    same[b] = static_cast<int>(b);
  return same;
}
}  // namespace

/** Everything of another simulation whose bodies have these numbers here. */
void Simulator::Impl::takeOver(const Impl& old, const std::vector<int>& new_body)
{
  const Renumbering new_shape = renumberShapes(old.collision, collision, new_body);
  // Assigned, not moved: bodies and rows know where the state is.
  const SimulationState present = carriedState(old.state, state, new_body, new_shape);
  start = carriedState(old.start, state, new_body, new_shape);
  state = present;
  start_outcome = old.start_outcome;
  outcome = StepOutcome{};
  changed = old.changed;
  dump_folder = old.dump_folder;
  dump_name = old.dump_name;
  dumps_left = old.dumps_left;
  joinWelded();
  updateEnds();
  rememberGood();
  restartReport();  // the last step's problem and answer stay with the old one
}

/** What a body brings into the world or takes out of it is no work. @param sign 1: brings */
void Simulator::Impl::bookArrival(int body, double sign, const Impl& of)
{
  const auto index = static_cast<size_t>(body);
  const BodyModel& model = of.bodies[index].model;
  for (SimulationState* booked : {&state, &start})
  {
    const SimulationState& source = booked == &state ? of.state : of.start;
    const EnergyLedger energy = energyOf(model, source.bodies[index], context.gravity);
    booked->energy.kinetic += sign * energy.kinetic;
    booked->energy.potential += sign * energy.potential;
    booked->energy_start += sign * (energy.kinetic + energy.potential);
  }
  bookEnergies();
}

/** @throws std::invalid_argument where the body is inside another one. @return whether it touches one */
bool Simulator::Impl::checkPlace(int body)
{
  for (size_t b = 0; b < bodies.size(); ++b)
    collision.setPoses(static_cast<int>(b), bodies[b].end);
  const std::vector<std::string> overlaps = findOverlaps(*world, collision, body);
  if (!overlaps.empty())
    throw std::invalid_argument(overlaps.front() + ", expected a free place");
  const std::vector<ElasticOverlap> inside = findElasticOverlaps(*world, state.bodies, body);
  if (!inside.empty())
    throw std::invalid_argument(inside.front().line + ", expected a free place");
  const std::vector<ContactPoint>& points = collision.detect(CONTACT_GAP);
  return std::any_of(
      points.begin(), points.end(),
      [&](const ContactPoint& point)
      { return collision.shape(point.shape_a).body == body || collision.shape(point.shape_b).body == body; });
}

const StepOutcome& Simulator::spawn(const BodySpec& spec)
{
  if (spec.name.empty())
    throw std::invalid_argument("name: found none, expected that of the new body");
  if (findBody(spec.name) >= 0)
    throw std::invalid_argument("name: found '" + spec.name + "', expected one that no body has yet");
  const std::shared_ptr<const WorldModel> world = withBody(*impl_->world, impl_->scenario, spec);
  auto next = std::make_unique<Impl>(world, impl_->solver_owner);
  const int body = bodyCount();
  next->takeOver(*impl_, sameNumbers(impl_->bodies.size()));
  next->bookArrival(body, 1.0, *next);
  if (next->checkPlace(body))
  {
    next->solver.begin();
    next->impactSolve();
  }
  if (next->outcome.taken)
  {
    next->rememberGood();
    impl_ = std::move(next);
  }
  else
    impl_->outcome = next->outcome;
  return impl_->outcome;
}

void Simulator::remove(const std::string& name)
{
  const int body = findBody(name);
  if (body < 0)
  {
    std::vector<std::string> names;
    for (int b = 0; b < bodyCount(); ++b)
      names.push_back(bodyName(b));
    throw std::invalid_argument("name: found '" + name + "', " + didYouMean(name, names) + "expected " +
                                (names.empty() ? "nothing: there are no bodies" : "one of " + joinNames(names)));
  }
  const std::shared_ptr<const WorldModel> world = withoutBody(*impl_->world, impl_->scenario, body);
  Renumbering new_body = sameNumbers(impl_->bodies.size());
  for (size_t b = 0; b < new_body.size(); ++b)
    new_body[b] = static_cast<int>(b) == body ? -1 : new_body[b] - (static_cast<int>(b) > body ? 1 : 0);
  auto next = std::make_unique<Impl>(world, impl_->solver_owner);
  next->takeOver(*impl_, new_body);
  next->bookArrival(body, -1.0, *impl_);
  impl_ = std::move(next);
}

int Simulator::findBody(const std::string& name) const
{
  for (int body = 0; body < bodyCount(); ++body)
    if (bodyName(body) == name)
      return body;
  return -1;
}

}  // namespace frictional_contact_sim
