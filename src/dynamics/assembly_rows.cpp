// Rows of the incremental problem: contacts, joint limits, dry friction, bounded servos, mimic joints.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
void tangentFrame(const Eigen::Vector3d& normal, Eigen::Vector3d& tangent_1, Eigen::Vector3d& tangent_2)
{
  // World x projected on the tangent plane, so that on level ground the frame is (z, x, y); y where x is too close.
  const Eigen::Vector3d axis = std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  tangent_1 = (axis - normal.dot(axis) * normal).normalized();
  tangent_2 = normal.cross(tangent_1);
}

PairTable::PairTable(const MaterialTable& materials, const std::vector<SurfaceSide>& sides)
{
  std::map<std::pair<std::string, double>, int> classes;
  std::vector<SurfaceSide> members;
  for (const SurfaceSide& side : sides)
  {
    const auto [entry, inserted] = classes.emplace(std::make_pair(side.material, side.friction), classes.size());
    if (inserted)
      members.push_back(side);
    class_of_.push_back(entry->second);
  }
  classes_ = static_cast<int>(members.size());
  for (const SurfaceSide& a : members)
    for (const SurfaceSide& b : members)
      table_.push_back(pairMaterial(materials, a, b));
}

bool PairTable::hasCreep() const
{
  return std::any_of(table_.begin(), table_.end(), [](const Material& material) { return material.creep != nullptr; });
}

StepAssembly::StepAssembly(std::vector<Robot>& robots, const CollisionWorld& world, PairTable pairs)
  : robots_(robots), world_(world), pairs_(std::move(pairs))
{
  for (Robot& robot : robots_)
  {
    robot.v_offset = velocities_;
    velocities_ += robot.model.nv;
  }
  // Entry (i, j) of M is structurally nonzero when one coordinate is the other's ancestor (Featherstone 2008, 6.3).
  mass_columns_.resize(velocities_);
  for (const Robot& robot : robots_)
    for (int i = 0; i < robot.model.nv; ++i)
      for (int j = i; j >= 0; j = robot.model.dof_parent[j])
      {
        mass_columns_[robot.v_offset + i].push_back(robot.v_offset + j);
        if (i != j)
          mass_columns_[robot.v_offset + j].push_back(robot.v_offset + i);
      }
  v_old_.resize(velocities_);
  creep_ = pairs_.hasCreep();
  rolling_shapes_.resize(world.shapeCount());
  std::vector<size_t> next_shape(robots_.size(), 0);  // handles follow the order of a robot's shapes
  for (int handle = 0; handle < world.shapeCount(); ++handle)
    if (const int robot = world.shape(handle).robot; robot >= 0)
      rolling_shapes_[handle] = RollingShape(robots_[robot].model.shapes[next_shape[robot]++]);
  for (std::vector<int>& columns : mass_columns_)
    std::sort(columns.begin(), columns.end());
}

void StepAssembly::beginRows()
{
  rows_h_.clear();
  rows_g_.clear();
  w_.clear();
  b_.clear();
  auxiliary_mass_.clear();
  contact_rows_.clear();
  creep_contacts_.clear();
  rolling_rows_.clear();
  joint_rows_.clear();
  mimic_rows_.clear();
  problem_.laws.clear();
  for (const Robot& robot : robots_)
    v_old_.segment(robot.v_offset, robot.model.nv) = robot.v;
}

void StepAssembly::assembleRows(const std::vector<ContactPoint>& points, const StepSettings& settings)
{
  beginRows();
  for (size_t i = 0; i < points.size(); ++i)
    addContact(points[i], static_cast<int>(i), &settings);
  for (size_t r = 0; r < robots_.size(); ++r)
  {
    const Robot& robot = robots_[r];
    for (size_t j = 0; j < robot.model.joints.size(); ++j)
    {
      const Joint& joint = robot.model.joints[j];
      if (velocitySize(joint.type) != 1)
        continue;
      const int index = static_cast<int>(j);
      const int robot_index = static_cast<int>(r);
      addLimits(robot_index, index, &settings);
      if (joint.dry_friction > 0.0)
        addJointRow(JointRow::Kind::DRY_FRICTION, robot_index, index, 1.0, 0.0, 0.0,
                    {LawType::DRY_FRICTION, settings.dt * joint.dry_friction});
      if (robot.actuators[j].bounded)
      {
        const Actuator& actuator = robot.actuators[j];
        addJointRow(JointRow::Kind::BOUNDED_SERVO, robot_index, index, 1.0,
                    -actuator.impulse.offset / actuator.impulse.stiffness, 0.0,
                    {LawType::DRY_FRICTION, settings.dt * actuator.effort_limit});
      }
      if (joint.mimic.joint >= 0)
        addMimic(robot_index, index, settings.dt);
    }
  }
  finishRows();
}

void StepAssembly::collectColumns(const ShapeInfo& shape, const Eigen::Vector3d& position, double sign,
                                  std::vector<std::pair<int, Eigen::Vector3d>>& columns) const
{
  columns.clear();
  if (shape.robot < 0)
    return;
  const Robot& robot = robots_[shape.robot];
  const MultibodyData& data = robot.middle;
  const Eigen::Vector3d arm = position - data.reference;
  for (const int j : robot.chains[shape.body])
  {
    const auto motion = data.motion_subspace.col(j);
    const Eigen::Vector3d angular = motion.tail<3>();
    columns.emplace_back(robot.v_offset + j, sign * (motion.head<3>() + angular.cross(arm)));
  }
}

Eigen::Vector3d StepAssembly::baseVelocity(const ShapeInfo& shape, const Eigen::Vector3d& position) const
{
  if (shape.robot < 0 || !robots_[shape.robot].base_motion.active)
    return Eigen::Vector3d::Zero();
  const Robot& robot = robots_[shape.robot];
  const Eigen::Vector3d arm = position - robot.middle.body_pose.front().translation();
  return robot.base_motion.linear + robot.base_motion.angular.cross(arm);
}

/** False when no coordinate moves the contact along its normal: then no normal force is determined, nor is any needed.
 */
bool StepAssembly::movesAlong(const Eigen::Vector3d& normal) const
{
  for (const auto* columns : {&columns_a_, &columns_b_})
    for (const auto& [column, motion] : *columns)
      if (std::abs(normal.dot(motion)) > 1e-12 * motion.norm())
        return true;
  return false;
}

void StepAssembly::addContact(const ContactPoint& point, int index, const StepSettings* settings)
{
  const ShapeInfo& shape_a = world_.shape(point.shape_a);
  const ShapeInfo& shape_b = world_.shape(point.shape_b);
  collectColumns(shape_a, point.position, 1.0, columns_a_);
  collectColumns(shape_b, point.position, -1.0, columns_b_);
  if (columns_a_.empty() && columns_b_.empty())
    return;

  ContactRow contact;
  contact.point = index;
  contact.row = rows_h_.rows();
  tangentFrame(point.normal, contact.tangent_1, contact.tangent_2);
  const Eigen::Vector3d relative_base = baseVelocity(shape_a, point.position) - baseVelocity(shape_b, point.position);
  const Eigen::Vector3d* axes[3] = {&point.normal, &contact.tangent_1, &contact.tangent_2};
  Eigen::Vector3d velocity = relative_base;
  for (const auto& [column, motion] : columns_a_)
    velocity += v_old_[column] * motion;
  for (const auto& [column, motion] : columns_b_)
    velocity += v_old_[column] * motion;

  const Material& material = pairs_(point.shape_a, point.shape_b);
  const double old_normal = point.normal.dot(velocity);
  const NormalShift shift =
      settings != nullptr ? normalShift(settings->normal_law, point.gap, old_normal, material.restitution, settings->dt)
                          : impactShift(point.gap, old_normal, material.restitution);
  if (!shift.active || !movesAlong(point.normal))
    return;
  contact.friction = material.friction;
  contact.restitution = material.restitution;
  contact.shift = shift.shift;
  contact.closing = shift.closing;
  if (material.creep != nullptr && settings != nullptr && !contact.closing)
    addCreep(point, *material.creep, velocity, contact);

  for (int d = 0; d < 3; ++d)
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
      rows_h_.push(std::min(column_a, column_b), value);
    }
    if (d == 1 && contact.creep.compliance > 0.0)
    {
      // u_d + k r_d: an auxiliary velocity of mass 1/k
      rows_h_.push(velocities_ + static_cast<int>(auxiliary_mass_.size()), 1.0);
      auxiliary_mass_.push_back(1.0 / contact.creep.compliance);
    }
    rows_h_.endRow();
    contact.base_velocity[d] = axes[d]->dot(relative_base);
    w_.push_back(contact.base_velocity[d] + (d == 0 ? shift.shift : d == 1 ? contact.creep.offset : 0.0));
  }
  problem_.laws.push_back({LawType::COULOMB_3D, material.friction});
  contact_rows_.push_back(contact);
}

void StepAssembly::addLimits(int robot_index, int joint_index, const StepSettings* settings)
{
  const Robot& robot = robots_[robot_index];
  const Joint& joint = robot.model.joints[joint_index];
  const double position = (settings != nullptr ? robot.q_middle : robot.q)[joint.q_index];
  const double velocity = robot.v[joint.v_index];
  const double gaps[2] = {position - joint.limit.lower, joint.limit.upper - position};
  // Limits enter as contacts do, within a look-ahead: here a hundredth of a radian (metre) beyond two steps' travel.
  const double margin = settings != nullptr ? 0.01 + 2.0 * settings->dt * std::abs(velocity) : CONTACT_GAP;
  for (int side = 0; side < 2; ++side)
  {
    if (!(gaps[side] <= margin))
      continue;
    const double sign = side == 0 ? 1.0 : -1.0;
    const NormalShift shift = settings != nullptr
                                  ? normalShift(settings->normal_law, gaps[side], sign * velocity, 0.0, settings->dt)
                                  : impactShift(gaps[side], sign * velocity, 0.0);
    if (shift.active)
      addJointRow(side == 0 ? JointRow::Kind::LOWER_LIMIT : JointRow::Kind::UPPER_LIMIT, robot_index, joint_index, sign,
                  shift.shift, shift.shift, {LawType::UNILATERAL, 0.0});
  }
}

void StepAssembly::addJointRow(JointRow::Kind kind, int robot, int joint, double sign, double w, double shift, Law law)
{
  joint_rows_.push_back({kind, robot, joint, rows_h_.rows(), shift});
  rows_h_.push(robots_[robot].v_offset + robots_[robot].velocityIndex(joint), sign);
  if (kind == JointRow::Kind::BOUNDED_SERVO)
  {
    rows_h_.push(velocities_ + static_cast<int>(auxiliary_mass_.size()), -1.0);
    auxiliary_mass_.push_back(robots_[robot].actuators[joint].impulse.stiffness);
  }
  rows_h_.endRow();
  w_.push_back(w);
  problem_.laws.push_back(law);
}

void StepAssembly::addMimic(int robot_index, int joint_index, double dt)
{
  const Robot& robot = robots_[robot_index];
  const Joint& joint = robot.model.joints[joint_index];
  const Joint& followed = robot.model.joints[joint.mimic.joint];
  const std::pair<int, double> entries[2] = {{robot.v_offset + joint.v_index, 1.0},
                                             {robot.v_offset + followed.v_index, -joint.mimic.multiplier}};
  const int first = entries[0].first < entries[1].first ? 0 : 1;
  rows_g_.push(entries[first].first, entries[first].second);
  rows_g_.push(entries[1 - first].first, entries[1 - first].second);
  rows_g_.endRow();
  const double error =
      robot.q_middle[joint.q_index] - joint.mimic.multiplier * robot.q_middle[followed.q_index] - joint.mimic.offset;
  b_.push_back(error / dt);
  mimic_rows_.push_back({robot_index, joint_index});
}

void StepAssembly::finishRows()
{
  auxiliaries_ = static_cast<int>(auxiliary_mass_.size());
  const int columns = velocities_ + auxiliaries_;
  rows_h_.copyTo(columns, problem_.H);
  rows_g_.copyTo(columns, problem_.G);
  problem_.w = Eigen::Map<const Eigen::VectorXd>(w_.data(), static_cast<Eigen::Index>(w_.size()));
  problem_.b = Eigen::Map<const Eigen::VectorXd>(b_.data(), static_cast<Eigen::Index>(b_.size()));
}

}  // namespace frictional_contact_sim
