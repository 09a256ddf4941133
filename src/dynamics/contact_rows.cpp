#include "frictional_contact_sim/dynamics/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/dynamics/creep_rows.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double STICKING_SPEED = 1e-9;  ///< slower than this is at rest [m/s]

ContactMode modeOf(const ContactRow& row, const Eigen::Vector3d& impulse, const Eigen::Vector3d& velocity,
                   double tolerance)
{
  // What the solver calls zero, in units of this contact: tolerance times its own velocity or impulse, at least 1e-9.
  const double speed = std::max(STICKING_SPEED, 10.0 * tolerance * velocity.norm());
  if (impulse[0] <= 0.0)
    return ContactMode::OPEN;
  if (row.closing)
    return ContactMode::IMPACT;
  // Relative to its cone: nearer to the boundary than this is on it, when the contact also moves.
  const double margin = row.friction * impulse[0] - impulse.tail<2>().norm();
  const bool inside = margin > 1e-6 * row.friction * impulse[0];
  return inside || velocity.tail<2>().norm() <= speed ? ContactMode::STICKING : ContactMode::SLIDING;
}

/** In the frame of the contact. */
Eigen::Vector3d impulseOf(const ContactRow& row, const Solution& solution)
{
  if (row.count == 3)
    return solution.r.segment<3>(row.row);
  return {solution.r[row.row], 0.0, 0.0};
}
}  // namespace

const char* toString(ContactMode mode)
{
  switch (mode)
  {
    case ContactMode::OPEN:
      return "OPEN";
    case ContactMode::STICKING:
      return "STICKING";
    case ContactMode::SLIDING:
      return "SLIDING";
    case ContactMode::IMPACT:
      return "IMPACT";
  }
  return "UNKNOWN";
}

void tangentFrame(const Eigen::Vector3d& normal, Eigen::Vector3d& tangent_1, Eigen::Vector3d& tangent_2)
{
  // World x projected on the tangent plane, so that on level ground the frame is (z, x, y); y where x is too close.
  const Eigen::Vector3d axis = std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  tangent_1 = (axis - normal.dot(axis) * normal).normalized();
  tangent_2 = normal.cross(tangent_1);
}

Eigen::Vector3d baseVelocity(const std::vector<Body>& bodies, const ShapeInfo& shape, const Eigen::Vector3d& position)
{
  if (shape.body < 0 || !bodies[shape.body].model.base_motion.active)
    return Eigen::Vector3d::Zero();
  const Body& body = bodies[shape.body];
  const Eigen::Vector3d arm = position - body.middle.link_pose.front().translation();
  return body.base.linear + body.base_turn * arm;
}

/** Of a link whose surface moves while it stays. */
Eigen::Vector3d surfaceVelocity(const std::vector<Body>& bodies, const ShapeInfo& shape,
                                const Eigen::Vector3d& position)
{
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  if (shape.body < 0 || bodies[shape.body].model.surfaces.empty())
    return velocity;
  const Body& body = bodies[shape.body];
  for (size_t i = 0; i < body.model.surfaces.size(); ++i)
    if (const SurfaceMotion& surface = body.model.surfaces[i]; surface.frame == shape.frame)
    {
      const Eigen::Isometry3d pose = framePose(body.model.tree, body.middle, surface.frame);
      const Eigen::Vector3d arm = pose.linear().transpose() * (position - pose.translation());
      velocity += pose.linear() * (surface.linear + body.surface_turns[i] * arm);
    }
  return velocity;
}

/** What prescribed motions alone give to a point; a surface moves within itself. */
Eigen::Vector3d prescribedVelocity(const std::vector<Body>& bodies, const ShapeInfo& shape_a, const ShapeInfo& shape_b,
                                   const ContactPoint& point)
{
  const Eigen::Vector3d base =
      baseVelocity(bodies, shape_a, point.position) - baseVelocity(bodies, shape_b, point.position);
  const Eigen::Vector3d surface =
      surfaceVelocity(bodies, shape_a, point.position) - surfaceVelocity(bodies, shape_b, point.position);
  return surface.isZero(0.0) ? base : Eigen::Vector3d(base + surface - point.normal.dot(surface) * point.normal);
}

ContactRows::ContactRows(const std::vector<Body>& bodies, const CollisionWorld& world, const PairTable& pairs,
                         std::vector<ContactState>& contacts, CreepRows* creep, ContactSet* set)
  : bodies_(bodies), world_(world), pairs_(pairs), contacts_(contacts), creep_(creep), set_(set)
{
}

void ContactRows::begin(const StepContext&)
{
  index_.clear();
  for (size_t i = 0; i < contacts_.size(); ++i)
    index_.emplace_back(contacts_[i].id, static_cast<int>(i));
  std::sort(index_.begin(), index_.end());
}

const ContactState* ContactRows::last(const ContactId& id) const
{
  const auto entry = std::lower_bound(index_.begin(), index_.end(), std::make_pair(id, 0));
  if (entry == index_.end() || entry->first != id)
    return nullptr;
  const ContactState& contact = contacts_[entry->second];
  return contact.mode == ContactMode::IMPACT ? nullptr : &contact;
}

void ContactRows::addRows(const StepContext& context, RowSink& sink)
{
  rows_.clear();
  if (creep_ != nullptr)
    creep_->clear();
  for (size_t i = 0; i < context.points->size(); ++i)
    add(context, static_cast<int>(i), sink);
}

/** Of both sides, in the columns of the problem. */
void ContactRows::collectColumns(const ContactPoint& point)
{
  const auto collect = [&](int handle, Feature feature, double sign, PointColumns& columns)
  {
    columns.clear();
    const ShapeInfo& shape = world_.shape(handle);
    if (shape.body < 0)
      return;
    const Body& body = bodies_[shape.body];
    addPointColumns(body, {shape.link, feature, point.position}, sign, columns);
    for (auto& column : columns)
      column.first += body.v_offset;
  };
  collect(point.shape_a, featureA(point.id), 1.0, columns_a_);
  collect(point.shape_b, featureB(point.id), -1.0, columns_b_);
}

/** False when no coordinate moves the contact along its normal: then no normal force is determined, nor is any needed.
 */
bool ContactRows::movesAlong(const Eigen::Vector3d& normal) const
{
  for (const auto* columns : {&columns_a_, &columns_b_})
    for (const auto& [column, motion] : *columns)
      if (std::abs(normal.dot(motion)) > 1e-12 * motion.norm())
        return true;
  return false;
}

/** Of the point whose columns were collected. */
Eigen::Vector3d ContactRows::relativeVelocity(const Eigen::VectorXd& v, const Eigen::Vector3d& relative_base) const
{
  Eigen::Vector3d velocity = relative_base;
  for (const auto* columns : {&columns_a_, &columns_b_})
    for (const auto& [column, motion] : *columns)
      velocity += v[column] * motion;
  return velocity;
}

void ContactRows::add(const StepContext& context, int index, RowSink& sink)
{
  const ContactPoint& point = (*context.points)[index];
  const ShapeInfo& shape_a = world_.shape(point.shape_a);
  const ShapeInfo& shape_b = world_.shape(point.shape_b);
  collectColumns(point);
  if (columns_a_.empty() && columns_b_.empty())
    return;

  ContactRow contact;
  contact.point = index;
  contact.row = sink.rows();
  contact.law = sink.laws();
  tangentFrame(point.normal, contact.tangent_1, contact.tangent_2);
  const Eigen::Vector3d relative_base = prescribedVelocity(bodies_, shape_a, shape_b, point);
  const Eigen::Vector3d* axes[3] = {&point.normal, &contact.tangent_1, &contact.tangent_2};
  const Eigen::Vector3d velocity = relativeVelocity(*context.v_old, relative_base);

  const Material& material = pairs_(point.shape_a, point.shape_b);
  const double old_normal = point.normal.dot(velocity);
  const Restitution restitution =
      context.inelastic ? Restitution{} : Restitution{material.restitution, material.tangential_restitution};
  const NormalLaw law = context.normalLaw(point);
  NormalShift shift;
  if (point.is_linearised && law.recovery_speed > 0.0)
    shift.shift = law.gapToMend(point.row_gap) / context.dt;
  else if (point.is_linearised)  // asks for no separation either
    shift.shift = std::max(point.row_gap, 0.0) / context.dt;
  else if (context.impact)
    shift = impactShift(point.gap, old_normal, restitution, context.dt);
  else
    shift = normalShift(law, point.gap, old_normal, restitution, context.dt);
  // An answer that needs it has another velocity than the one that made an impact's row inactive.
  const bool is_needed = context.impact && set_ != nullptr && set_->isNeeded(point.id);
  if (!(shift.active || is_needed) || !movesAlong(point.normal))
    return;
  contact.friction = material.friction;
  contact.restitution = restitution.normal;
  contact.shift = shift.shift;
  contact.closing = shift.closing;
  contact.tangential_shift =
      shift.tangential * Eigen::Vector2d(contact.tangent_1.dot(velocity), contact.tangent_2.dot(velocity));
  contact.count = contact.friction > 0.0 ? 3 : 1;
  if (contact.closing && restitution.bounces())
    sink.noteBounce();
  if (contact.closing)
    sink.noteClosing();
  else if (contact.count == 3 && material.creep != nullptr && !context.impact)
    creep_->bend(context, *material.creep, velocity, last(point.id), contact);

  for (int d = 0; d < contact.count; ++d)
  {
    // Both lists ascend; merge them, adding where a self-contact has a coordinate on both sides.
    size_t i = 0;
    size_t j = 0;
    while (i < columns_a_.size() || j < columns_b_.size())
    {
      const int column_a = i < columns_a_.size() ? columns_a_[i].first : std::numeric_limits<int>::max();
      const int column_b = j < columns_b_.size() ? columns_b_[j].first : std::numeric_limits<int>::max();
      double value = 0.0;
      if (column_a <= column_b)
        value += axes[d]->dot(columns_a_[i++].second);
      if (column_b <= column_a)
        value += axes[d]->dot(columns_b_[j++].second);
      sink.push(std::min(column_a, column_b), value);
    }
    if (d == 1 && contact.creep.compliance > 0.0)
      sink.push(sink.addAuxiliary(1.0 / contact.creep.compliance), 1.0);  // u_d + k r_d: a velocity of mass 1/k
    const double base = axes[d]->dot(relative_base);
    sink.endRow(base + (d == 0 ? shift.shift : contact.tangential_shift[d - 1] + (d == 1 ? contact.creep.offset : 0.0)),
                {d == 0 ? WorkAccount::IMPACT : WorkAccount::FRICTION, base, nullptr});
  }
  if (contact.count == 3)
    sink.endLaw({LawType::COULOMB_3D, material.friction});
  else
    sink.endLaw({LawType::UNILATERAL, 0.0});
  rows_.push_back(contact);
}

void ContactRows::guess(const StepContext& context, bool from_answer, Solution& guess) const
{
  for (const ContactRow& row : rows_)
  {
    const ContactPoint& point = (*context.points)[row.point];
    const Eigen::Vector3d* impulse = nullptr;
    if (!from_answer)
    {
      const ContactState* last_contact = last(point.id);
      impulse = last_contact == nullptr || row.closing ? nullptr : &last_contact->impulse;
    }
    else
    {
      const auto entry = std::lower_bound(answer_.begin(), answer_.end(), point.id,
                                          [](const auto& a, const ContactId& id) { return a.first < id; });
      impulse = entry != answer_.end() && entry->first == point.id ? &entry->second : nullptr;
    }
    if (impulse == nullptr)
      continue;
    guess.r[row.row] = point.normal.dot(*impulse);
    if (row.count == 1)
      continue;
    guess.r[row.row + 1] = row.tangent_1.dot(*impulse);
    guess.r[row.row + 2] = row.tangent_2.dot(*impulse);
  }
}

/** Other rows or tangents may follow: they start from these impulses. */
Again ContactRows::again(const StepContext& context, const Solution& solution, bool)
{
  answer_.clear();
  for (const ContactRow& row : rows_)
  {
    const ContactPoint& point = (*context.points)[row.point];
    const Eigen::Vector3d r = impulseOf(row, solution);
    answer_.emplace_back(point.id, r[0] * point.normal + r[1] * row.tangent_1 + r[2] * row.tangent_2);
  }
  return Again::NO;
}

Again ContactRows::lookAhead(const StepContext& context, const Solution& solution)
{
  if (set_ == nullptr)
    return Again::NO;
  normal_impulses_.assign(context.points->size(), std::numeric_limits<double>::quiet_NaN());
  for (const ContactRow& row : rows_)
    normal_impulses_[row.point] = solution.r[row.row];
  switch (set_->lookAgain(context, solution.v, normal_impulses_))
  {
    case ContactSet::Look::CONTENT:
      return Again::NO;
    case ContactSet::Look::CHANGED:
      if (creep_ != nullptr)
        creep_->restart();
      return Again::FROM_ANSWER;
    case ContactSet::Look::GIVEN_UP:
      break;
  }
  return Again::NEVER;
}

const ContactPoint* ContactRows::contactOf(const StepContext& context, int law) const
{
  for (const ContactRow& row : rows_)
    if (row.law == law)
      return &(*context.points)[row.point];
  return nullptr;
}

void ContactRows::markActing(std::vector<char>& bodies) const
{
  for (const ContactState& contact : contacts_)
    if (contact.mode != ContactMode::IMPACT && !contact.impulse.isZero(0.0))
      for (const int handle : {contact.shape_a, contact.shape_b})
        if (const int body = world_.shape(handle).body; body >= 0)
          bodies[body] = 1;
}

/** In the frame of the contact, with its shift; where there is no friction the tangents have no rows. */
Eigen::Vector3d ContactRows::velocityOf(const ContactRow& row, const ContactPoint& point, const Solution& solution)
{
  if (row.count == 3)
    return solution.u.segment<3>(row.row);
  const ShapeInfo& shape_a = world_.shape(point.shape_a);
  const ShapeInfo& shape_b = world_.shape(point.shape_b);
  collectColumns(point);
  const Eigen::Vector3d velocity = relativeVelocity(solution.v, prescribedVelocity(bodies_, shape_a, shape_b, point));
  return {solution.u[row.row], row.tangent_1.dot(velocity), row.tangent_2.dot(velocity)};
}

void ContactRows::accept(const StepContext& context, const StepAnswer& answer)
{
  contacts_.clear();
  for (const ContactRow& row : rows_)
  {
    const ContactPoint& point = (*context.points)[row.point];
    const Eigen::Vector3d r = impulseOf(row, answer.solution);
    Eigen::Vector3d u = velocityOf(row, point, answer.solution);
    u[0] -= row.shift;
    if (row.count == 3)
      u.tail<2>() -= row.tangential_shift;
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
    state.row_gap = context.dt * row.shift;
    state.friction = row.friction;
    state.restitution = row.restitution;
    state.impulse = r[0] * point.normal + r[1] * row.tangent_1 + r[2] * row.tangent_2;
    state.velocity = u[0] * point.normal + u[1] * row.tangent_1 + u[2] * row.tangent_2;
    state.cone_margin = row.friction * r[0] - r.tail<2>().norm();
    state.residual = row.law < answer.law_errors.size() ? answer.law_errors[row.law] : 0.0;
    state.mode = modeOf(row, r, u, context.tolerance);
    contacts_.push_back(state);
  }
}

}  // namespace frictional_contact_sim
