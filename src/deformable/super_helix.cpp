#include "frictional_contact_sim/deformable/super_helix.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/math/cross_matrix.h"
#include "link_tree.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.141592653589793;

/** exp(s [kappa]x) and its integral over s (Rodrigues); a series where the angle is small. */
void rotateAlong(const Eigen::Vector3d& kappa, double s, Eigen::Matrix3d& rotation, Eigen::Matrix3d& integral)
{
  const double rate = kappa.norm();
  const double angle = rate * s;
  const bool is_small = angle < 1e-4;
  const double half = std::sin(0.5 * angle);
  const double first = is_small ? s : std::sin(angle) / rate;
  const double second = is_small ? 0.5 * s * s : 2.0 * half * half / (rate * rate);
  const double third = is_small ? s * s * s / 6.0 : (angle - std::sin(angle)) / (rate * rate * rate);
  const Eigen::Matrix3d turn = crossMatrix(kappa);
  rotation = Eigen::Matrix3d::Identity() + first * turn + second * turn * turn;
  integral = s * Eigen::Matrix3d::Identity() + second * turn + third * turn * turn;
}

/** Three numbers for all pieces, or three a piece; none: zero. */
Eigen::VectorXd perPiece(const std::vector<double>& values, int pieces)
{
  Eigen::VectorXd all = Eigen::VectorXd::Zero(3 * pieces);
  for (int i = 0; i < 3 * pieces && !values.empty(); ++i)
    all[i] = values[values.size() == 3 ? i % 3 : i];
  return all;
}

/** v(p) = B dq - p x (A dq) of a section: A its angular velocity, B the velocity of what is at the root. */
struct SectionJacobian
{
  Eigen::Matrix3Xd angular;
  Eigen::Matrix3Xd linear;
};

/** Adds the generalised force of a force at point x of a section, and a moment. */
void addForce(const SectionJacobian& section, const Eigen::Vector3d& x, const Eigen::Vector3d& force,
              const Eigen::Vector3d& moment, Eigen::VectorXd& total)
{
  total += section.linear.transpose() * force + section.angular.transpose() * (x.cross(force) + moment);
}

struct RodWork : BodyWork
{
  RodShape shape;  ///< at the midpoint
  Eigen::VectorXd state_q;  ///< where state_shape is
  RodShape state_shape;
  std::vector<SectionJacobian> jacobians;
  Eigen::MatrixXd matrix;
  Eigen::LLT<Eigen::MatrixXd> factor;
};

RodWork& workOf(Body& body)
{
  return static_cast<RodWork&>(*body.work);
}
const RodWork& workOf(const Body& body)
{
  return static_cast<const RodWork&>(*body.work);
}
}  // namespace

/** Velocities of the sections and their rates at constant dq/dt, in the axes of the shape. */
struct SuperHelix::Motion
{
  std::vector<Eigen::Vector3d> angular, linear, angular_rate, linear_rate;
};

SuperHelix::SuperHelix(const RodSpec& spec)
  : spec_(spec)
  , step_(spec.length / (spec.pieces * spec.sections))
  , line_mass_(spec.density * PI * spec.radius * spec.radius * step_)
  , spin_inertia_(0.25 * line_mass_ * spec.radius * spec.radius)
  , natural_(perPiece(spec.natural, spec.pieces))
  , stiffness_(3 * spec.pieces)
{
  const double inertia = 0.25 * PI * std::pow(spec.radius, 4);
  const double piece = spec.length / spec.pieces;
  for (int i = 0; i < stiffness_.size(); ++i)
  {
    const double young = spec.young_modulus.size() == 1 ? spec.young_modulus[0] : spec.young_modulus.at(i / 3);
    const double shear = 0.5 * young / (1.0 + spec.poisson_ratio);
    stiffness_[i] = piece * inertia * (i % 3 == 0 ? 2.0 * shear : young);
  }
  std::vector<int> row;
  for (int i = 0; i < stiffness_.size(); ++i)
    row.push_back(i);
  columns_.assign(row.size(), row);
}

Eigen::VectorXd SuperHelix::startPosition() const
{
  return spec_.start.empty() ? Eigen::VectorXd(Eigen::VectorXd::Zero(velocities()))
                             : Eigen::VectorXd(perPiece(spec_.start, spec_.pieces) - natural_);
}

RodShape SuperHelix::shapeAt(const VectorIn& q) const
{
  RodShape shape;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rotation;
  Eigen::Matrix3d integral;
  for (int k = 0; k < spec_.pieces; ++k)
  {
    const Eigen::Vector3d kappa = natural_.segment<3>(3 * k) + q.segment<3>(3 * k);
    for (int j = 0; j < spec_.sections; ++j)
    {
      rotateAlong(kappa, (j + 0.5) * step_, rotation, integral);
      shape.frames.push_back(frame * rotation);
      shape.points.push_back(start + frame * integral.col(0));
    }
    rotateAlong(kappa, spec_.sections * step_, rotation, integral);
    start += frame * integral.col(0);
    frame = frame * rotation;
  }
  return shape;
}

SuperHelix::Motion SuperHelix::motionOf(const RodShape& shape, const VectorIn& v) const
{
  Motion motion;
  // Sums over whole sections before this one; a section adds half of itself to its own.
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  // v(p) = linear + angular x p
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear_rate = Eigen::Vector3d::Zero();  // a(p) = linear_rate + angular_rate x p + angular x v(p)
  for (size_t j = 0; j < shape.points.size(); ++j)
  {
    const Eigen::Vector3d& x = shape.points[j];
    const Eigen::Vector3d turn = step_ * (shape.frames[j] * v.segment<3>(3 * (static_cast<int>(j) / spec_.sections)));
    for (int half = 0; half < 2; ++half)
    {
      if (half == 1)
      {
        motion.angular.push_back(angular);
        motion.linear.push_back(linear + angular.cross(x));
        motion.angular_rate.push_back(angular_rate);
        motion.linear_rate.push_back(linear_rate + angular_rate.cross(x) + angular.cross(motion.linear.back()));
      }
      const Eigen::Vector3d speed = linear + angular.cross(x);
      const Eigen::Vector3d turn_rate = angular.cross(0.5 * turn);
      angular_rate += turn_rate;
      linear_rate -= turn_rate.cross(x) + (0.5 * turn).cross(speed);
      angular += 0.5 * turn;
      linear -= (0.5 * turn).cross(x);
    }
  }
  return motion;
}

std::unique_ptr<BodyWork> SuperHelix::makeWork() const
{
  auto work = std::make_unique<RodWork>();
  work->matrix.setIdentity(velocities(), velocities());
  return work;
}

void SuperHelix::setPoses(const VectorIn& q, MultibodyData& data) const
{
  const RodShape shape = shapeAt(q);
  data.reference = data.base_pose.translation();
  data.link_pose.front() = data.base_pose;
  const Eigen::Matrix3d axes = data.base_pose.linear();
  for (size_t j = 0; j < shape.points.size(); ++j)
  {
    data.link_pose[j + 1].linear() = axes * shape.frames[j];
    data.link_pose[j + 1].translation() = data.reference + axes * shape.points[j];
  }
}

void SuperHelix::setVelocities(const VectorIn& v, MultibodyData& data) const
{
  RodShape shape;  // about the reference, world axes
  for (size_t link = 1; link < data.link_pose.size(); ++link)
  {
    shape.frames.push_back(data.link_pose[link].linear());
    shape.points.push_back(data.link_pose[link].translation() - data.reference);
  }
  const Motion motion = motionOf(shape, v);
  data.link_velocity.front().setZero();
  for (size_t j = 0; j < shape.points.size(); ++j)
  {
    data.link_velocity[j + 1].head<3>() = motion.linear[j] - motion.angular[j].cross(shape.points[j]);
    data.link_velocity[j + 1].tail<3>() = motion.angular[j];
  }
}

void SuperHelix::addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns) const
{
  if (point.link == 0)
    return;
  const Eigen::Matrix3d axes = body.middle.base_pose.linear();
  const Eigen::Vector3d p = axes.transpose() * (point.position - body.middle.reference);
  const SectionJacobian& jacobian = workOf(body).jacobians[point.link - 1];
  const int count = 3 * ((point.link - 1) / spec_.sections + 1);
  for (int i = 0; i < count; ++i)
  {
    const Eigen::Vector3d motion = jacobian.linear.col(i) + Eigen::Vector3d(jacobian.angular.col(i)).cross(p);
    columns.emplace_back(i, sign * (axes * motion));
  }
}

double SuperHelix::pointSpeed(const Body& body, const VectorIn& v) const
{
  double square = 0.0;
  for (const Eigen::Vector3d& linear : motionOf(workOf(body).shape, v).linear)
    square = std::max(square, linear.squaredNorm());
  return std::sqrt(square);
}

void SuperHelix::prepare(Body& body, double dt) const
{
  RodWork& work = workOf(body);
  work.shape = shapeAt(body.q_middle);
  work.jacobians.resize(work.shape.points.size());
  Eigen::Matrix3Xd angular = Eigen::Matrix3Xd::Zero(3, velocities());
  Eigen::Matrix3Xd linear = angular;
  work.matrix.setZero(velocities(), velocities());
  for (size_t j = 0; j < work.shape.points.size(); ++j)
  {
    const Eigen::Vector3d& x = work.shape.points[j];
    const Eigen::Matrix3d& frame = work.shape.frames[j];
    const int first = 3 * (static_cast<int>(j) / spec_.sections);
    const Eigen::Matrix3d turn = 0.5 * step_ * frame;
    for (int half = 0; half < 2; ++half)
    {
      angular.middleCols<3>(first) += turn;
      linear.middleCols<3>(first) += crossMatrix(x) * turn;
      if (half == 0)
        work.jacobians[j] = {angular, linear};
    }
    const SectionJacobian& jacobian = work.jacobians[j];
    const Eigen::Matrix3Xd at_point = jacobian.linear - crossMatrix(x) * jacobian.angular;
    const Eigen::RowVectorXd spin = frame.col(0).transpose() * jacobian.angular;
    work.matrix += line_mass_ * at_point.transpose() * at_point;
    work.matrix += spin_inertia_ * (jacobian.angular.transpose() * jacobian.angular + spin.transpose() * spin);
  }
  if (dt == 0.0)
    return;
  if (body.model.regime != Regime::DYNAMIC)
    work.matrix = (dt * dt * stiffness_).asDiagonal();
  else
    work.matrix.diagonal() += dt * (0.25 * dt + 0.5 * spec_.damping) * stiffness_;
}

bool SuperHelix::factorize(Body& body) const
{
  RodWork& work = workOf(body);
  work.factor.compute(work.matrix);
  return work.factor.info() == Eigen::Success;
}

void SuperHelix::solve(const Body& body, Eigen::VectorXd& v) const
{
  workOf(body).factor.solveInPlace(v);
}

void SuperHelix::multiply(const Body& body, const Eigen::VectorXd& v, VectorOut product) const
{
  product = workOf(body).matrix * v;
}

void SuperHelix::copyMass(const Body& body, double*& value) const
{
  const Eigen::MatrixXd& matrix = workOf(body).matrix;  // symmetric: columns are rows
  value = std::copy(matrix.data(), matrix.data() + matrix.size(), value);
}

void SuperHelix::computeBias(const Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity,
                             Eigen::VectorXd& bias) const
{
  const RodWork& work = workOf(body);
  bias = stiffness_.cwiseProduct(body.q_middle + spec_.damping * body.v_start);
  const Motion motion = motionOf(work.shape, v);
  const Eigen::Vector3d pull = body.middle.base_pose.linear().transpose() * gravity;
  for (size_t j = 0; j < work.shape.points.size(); ++j)
  {
    const Eigen::Vector3d& tangent = work.shape.frames[j].col(0);
    const Eigen::Vector3d force = line_mass_ * (motion.linear_rate[j] - pull);
    const Eigen::Vector3d& omega = motion.angular[j];
    const Eigen::Vector3d& rate = motion.angular_rate[j];
    const Eigen::Vector3d spin = omega + tangent.dot(omega) * tangent;
    const Eigen::Vector3d moment = spin_inertia_ * (rate + tangent.dot(rate) * tangent + omega.cross(spin));
    addForce(work.jacobians[j], work.shape.points[j], force, moment, bias);
  }
}

void SuperHelix::applyWrenches(Body& body, double now) const
{
  const RodWork& work = workOf(body);
  const Eigen::Matrix3d from_world = body.middle.base_pose.linear().transpose();
  if (body.model.regime == Regime::DYNAMIC)
  {
    const Eigen::Vector3d force = -line_mass_ * (from_world * body.base_rate.linear);
    for (size_t j = 0; j < work.shape.points.size(); ++j)
      addForce(work.jacobians[j], work.shape.points[j], force, Eigen::Vector3d::Zero(), body.external);
  }
  for (const ExternalWrench& wrench : body.state.wrenches)
  {
    if (now < wrench.from || now >= wrench.until)
      continue;
    const double last = static_cast<double>(work.shape.points.size()) - 1.0;
    const double section = std::clamp(std::floor(wrench.point.x() / step_), 0.0, last);
    const auto j = static_cast<size_t>(section);
    const Eigen::Vector3d arm(wrench.point.x() - (section + 0.5) * step_, wrench.point.y(), wrench.point.z());
    const Eigen::Matrix3d axes = wrench.world_frame ? from_world : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    addForce(work.jacobians[j], work.shape.points[j] + work.shape.frames[j] * arm, axes * wrench.force,
             axes * wrench.torque, body.external);
  }
}

std::string SuperHelix::staticsRefusal() const
{
  return "is a rod, whose equilibrium is more than one linear step away, expected none";
}

/** The shape at the state, of which both energies ask. */
const RodShape& SuperHelix::shapeOfState(const Body& body) const
{
  auto& work = static_cast<RodWork&>(*body.work);
  if (work.state_q.size() == 0 || work.state_q != body.state.q)
  {
    work.state_q = body.state.q;
    work.state_shape = shapeAt(body.state.q);
  }
  return work.state_shape;
}

double SuperHelix::kineticEnergy(const Body& body) const
{
  const RodShape& shape = shapeOfState(body);
  const Motion motion = motionOf(shape, body.state.v);
  double energy = 0.0;
  for (size_t j = 0; j < shape.points.size(); ++j)
  {
    const double spin = shape.frames[j].col(0).dot(motion.angular[j]);
    energy += 0.5 * line_mass_ * motion.linear[j].squaredNorm() +
              0.5 * spin_inertia_ * (motion.angular[j].squaredNorm() + spin * spin);
  }
  return energy;
}

double SuperHelix::potentialEnergy(const Body& body, const Eigen::Vector3d& gravity) const
{
  const Eigen::VectorXd& q = body.state.q;
  double energy = 0.5 * q.dot(stiffness_.cwiseProduct(q));
  const Eigen::Vector3d pull = body.end.base_pose.linear().transpose() * gravity;
  for (const Eigen::Vector3d& point : shapeOfState(body).points)
    energy -= line_mass_ * pull.dot(point);
  return energy;
}

double SuperHelix::dampingPower(const VectorIn& v) const
{
  return spec_.damping * v.dot(stiffness_.cwiseProduct(v));
}

MultibodyModel sectionTree(const std::string& name, const RodSpec& spec)
{
  MultibodyModel tree = rootTree(name);
  const Capsule capsule{spec.radius, 0.5 * spec.length / (spec.pieces * spec.sections)};
  const Eigen::Matrix3d along_x = Eigen::AngleAxisd(0.5 * PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (int k = 0; k < spec.pieces * spec.sections; ++k)
    addLink("section_" + std::to_string(k), Eigen::Vector3d::Zero(), capsule, along_x, tree);
  finalize(tree);
  return tree;
}

}  // namespace frictional_contact_sim
