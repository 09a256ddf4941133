// Links joined and released in a run; see dynamics/closure_rows.h for the rows. Loops are told, too.
#include <algorithm>
#include <stdexcept>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/dynamics/closure_rows.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
/// How far a pose that is asked for may be from the present one: a weld takes what is there, it does not pull [m],
/// [rad].
constexpr double NEAR = 1e-3;

/** A link of a weld. */
struct Side
{
  int body = -1;
  int frame = -1;
};

std::string describe(const std::vector<Body>& bodies, const Side& side)
{
  if (side.body < 0)
    return "the world";
  const BodyModel& model = bodies[static_cast<size_t>(side.body)].model;
  return "link '" + model.tree.frames[static_cast<size_t>(side.frame)].name + "' of body '" + model.name + "'";
}

Side findSide(const std::vector<Body>& bodies, const LinkRef& ref)
{
  if (ref.body < 0)
    return {};
  if (ref.body >= static_cast<int>(bodies.size()))
    throw std::invalid_argument("there is no body " + std::to_string(ref.body) + ", expected less than " +
                                std::to_string(bodies.size()));
  const BodyModel& model = bodies[static_cast<size_t>(ref.body)].model;
  if (model.solid)
    throw std::invalid_argument("body '" + model.name +
                                "' is deformable, expected a rigid one: welds join rigid links");
  const Side side{ref.body, model.tree.findFrame(ref.link)};
  if (side.frame >= 0)
    return side;
  std::vector<std::string> names;
  for (const Frame& frame : model.tree.frames)
    names.push_back(frame.name);
  const std::string nearest = nearestName(ref.link, names);
  throw std::invalid_argument("body '" + model.name + "' has no link '" + ref.link + "'" +
                              (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

/** Links, and the world as number 0, in sets that do not move against each other. */
class RigidSets
{
public:
  explicit RigidSets(const std::vector<Body>& bodies) : bodies_(bodies)
  {
    int count = 1;
    for (const Body& body : bodies)
    {
      first_.push_back(count);
      count += static_cast<int>(body.model.tree.links.size());
    }
    sets_.reset(count);
    for (size_t b = 0; b < bodies.size(); ++b)
      for (size_t link = 0; link < bodies[b].model.tree.links.size(); ++link)
        if (bodies[b].model.isFixed(static_cast<int>(link)))
          sets_.unite(0, first_[b] + static_cast<int>(link));
  }
  int number(int body, int link)
  {
    return body < 0 ? sets_.root(0) : sets_.root(first_[static_cast<size_t>(body)] + link);
  }
  int number(const Side& side) { return number(side.body, linkOf(side)); }
  /** @return whether they were apart */
  bool join(const Side& a, const Side& b) { return sets_.unite(number(a), number(b)); }

private:
  int linkOf(const Side& side) const
  {
    return side.body < 0
               ? -1
               : bodies_[static_cast<size_t>(side.body)].model.tree.frames[static_cast<size_t>(side.frame)].link;
  }

  const std::vector<Body>& bodies_;
  std::vector<int> first_;  ///< bodies: number of the first link
  UnionFind sets_;
};

Side sideA(const Closure& weld)
{
  return {weld.body_a, weld.frame_a};
}

Side sideB(const Closure& weld)
{
  return {weld.body_b, weld.frame_b};
}

bool isSame(const Side& a, const Side& b)
{
  return a.body == b.body && a.frame == b.frame;
}

RigidSets rigidSets(const std::vector<Body>& bodies, const std::vector<Closure>& welds)
{
  RigidSets sets(bodies);
  for (const Closure& weld : welds)
    sets.join(sideA(weld), sideB(weld));
  return sets;
}

bool moves(const std::vector<Body>& bodies, const Side& side)
{
  if (side.body < 0)
    return false;
  const BodyModel& model = bodies[static_cast<size_t>(side.body)].model;
  return !model.chains[static_cast<size_t>(model.tree.frames[static_cast<size_t>(side.frame)].link)].empty();
}

Eigen::Isometry3d poseOf(const std::vector<Body>& bodies, const Side& side)
{
  if (side.body < 0)
    return Eigen::Isometry3d::Identity();
  const Body& body = bodies[static_cast<size_t>(side.body)];
  return framePose(body.model.tree, body.end, side.frame);
}

/** @throws std::invalid_argument where the two cannot be joined */
void checkSides(const std::vector<Body>& bodies, const std::vector<Closure>& welds, const Side& a, const Side& b)
{
  const std::string both = describe(bodies, a) + " and " + describe(bodies, b);
  for (const Closure& weld : welds)
    if ((isSame(sideA(weld), a) && isSame(sideB(weld), b)) || (isSame(sideA(weld), b) && isSame(sideB(weld), a)))
      throw std::invalid_argument(both + " are welded already");
  RigidSets sets = rigidSets(bodies, welds);
  if (sets.number(a) == sets.number(b))
    throw std::invalid_argument(both + " are one rigid thing already: nothing is left to weld");
  if (!moves(bodies, a) && !moves(bodies, b))
    throw std::invalid_argument("neither of " + both + " can move, expected one that can");
}
}  // namespace

void Simulator::Impl::joinWelded()
{
  std::vector<int> set_of_shape;
  if (!state.rows.welds.empty())
  {
    RigidSets sets = rigidSets(bodies, state.rows.welds);
    for (int handle = 0; handle < collision.shapeCount(); ++handle)
      set_of_shape.push_back(sets.number(collision.shape(handle).body, collision.shape(handle).link));
  }
  collision.setRigidSets(std::move(set_of_shape));
}

const StepOutcome& Simulator::attach(const LinkRef& link_a, const LinkRef& link_b,
                                     const std::optional<Eigen::Isometry3d>& a_in_b)
{
  if (link_a.body < 0 && link_b.body >= 0)
    return attach(link_b, link_a, a_in_b ? std::optional<Eigen::Isometry3d>(a_in_b->inverse()) : std::nullopt);
  const std::vector<Body>& bodies = impl_->bodies;
  const Side a = findSide(bodies, link_a);
  const Side b = findSide(bodies, link_b);
  checkSides(bodies, impl_->state.rows.welds, a, b);
  const Eigen::Isometry3d pose_a = poseOf(bodies, a);
  const Eigen::Isometry3d pose_b = poseOf(bodies, b);
  Closure weld;
  weld.body_a = a.body;
  weld.frame_a = a.frame;
  weld.body_b = b.body;
  weld.frame_b = b.frame;
  weld.pose = a_in_b.value_or(pose_b.inverse() * pose_a);
  const Vector6d error = closureError(weld.type, pose_a, pose_b * weld.pose, weld.basis);
  if (!(error.head<3>().norm() <= NEAR) || !(error.tail<3>().norm() <= NEAR))
    throw std::invalid_argument("pose: found one that is " + std::to_string(error.head<3>().norm()) + " m and " +
                                std::to_string(error.tail<3>().norm()) +
                                " rad from where the links are, expected at most 0.001 of each");
  impl_->weld(weld);
  return impl_->outcome;
}

/** The two have one motion from now on: an inelastic impact at this instant. */
void Simulator::Impl::weld(const Closure& weld)
{
  const SimulationState before = state;
  const StepSummary last_report = report;
  state.rows.welds.push_back(weld);
  joinWelded();
  outcome = StepOutcome{};
  solver.begin();
  impactSolve();
  if (outcome.taken)
  {
    rememberGood();
    return;
  }
  goBack(before);
  report = last_report;
  joinWelded();
}

const StepOutcome& Simulator::detach(const LinkRef& link_a, const LinkRef& link_b)
{
  const Side a = findSide(impl_->bodies, link_a);
  const Side b = findSide(impl_->bodies, link_b);
  std::vector<Closure>& welds = impl_->state.rows.welds;
  const auto found = std::find_if(welds.begin(), welds.end(),
                                  [&](const Closure& weld) {
                                    return (isSame(sideA(weld), a) && isSame(sideB(weld), b)) ||
                                           (isSame(sideA(weld), b) && isSame(sideB(weld), a));
                                  });
  if (found == welds.end())
    throw std::invalid_argument(describe(impl_->bodies, a) + " and " + describe(impl_->bodies, b) + " are not welded");
  welds.erase(found);
  impl_->joinWelded();
  impl_->outcome = StepOutcome{};
  return impl_->outcome;
}

const std::vector<Closure>& Simulator::welds() const
{
  return impl_->state.rows.welds;
}

Vector6d Simulator::weldWrench(int weld) const
{
  return welds().at(static_cast<size_t>(weld)).impulse / impl_->state.dt;
}

const std::vector<Closure>& Simulator::loops() const
{
  return impl_->state.rows.loops;
}

const std::string& Simulator::loopName(int loop) const
{
  return impl_->world->loop_names.at(static_cast<size_t>(loop));
}

Vector6d Simulator::loopWrench(int loop) const
{
  return loops().at(static_cast<size_t>(loop)).worldImpulse() / impl_->state.dt;
}

}  // namespace frictional_contact_sim
