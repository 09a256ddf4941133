#include "frictional_contact_sim/dynamics/free_link.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "frictional_contact_sim/dynamics/body.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MOST_NEWTON_ITERATIONS = 50;  ///< 3 are usual; halved ones count
constexpr double ISOTROPIC = 1e-14;  ///< moments that differ by less, relative, are equal but for their reading
constexpr double HALVED = 1.0 / 1024.0;  ///< shortest Newton step

const RigidInertia& inertiaOf(const Body& body)
{
  return body.model.tree.links.front().inertia;
}

Eigen::Matrix3d orientation(const Eigen::VectorXd& q)
{
  return Eigen::Quaterniond(q.data() + 3).toRotationMatrix();
}

/** R^-1 x, for an R that is orthogonal only to round-off: there and back again must not drift. */
Eigen::Vector3d turnBack(const Eigen::Matrix3d& turn, const Eigen::Vector3d& x)
{
  const Eigen::Vector3d back = turn.transpose() * x;
  return back + turn.transpose() * (x - turn * back);
}

/**
 * From the world's axes to those that the angular velocity of the scheme is written in, and back: the body's, or the
 * world's where all axes are principal. `turn` is the body's orientation.
 */
Eigen::Vector3d toAxes(const Body& body, const Eigen::Matrix3d& turn, const Eigen::Vector3d& x)
{
  return body.model.isotropic ? x : turnBack(turn, x);
}

Eigen::Vector3d fromAxes(const Body& body, const Eigen::Matrix3d& turn, const Eigen::Vector3d& x)
{
  return body.model.isotropic ? x : Eigen::Vector3d(turn * x);
}

Eigen::Matrix3d cross(const Eigen::Vector3d& x)
{
  Eigen::Matrix3d matrix;
  matrix << 0.0, -x.z(), x.y(), x.z(), 0.0, -x.x(), -x.y(), x.x(), 0.0;
  return matrix;
}

/**
 * q_out = (p, R) moved: the centre by `shift`, the link turned by cay(`turn`), both in the axes of q (there
 * R cay(x) = cay(R x) R). The origin moves by shift - (cay(turn) - I) R c, which is exactly zero at rest.
 * @param arm R c
 */
void moveAboutCenter(const Eigen::Vector3d& arm, const Eigen::Vector3d& shift, const Eigen::Vector3d& turn,
                     const Eigen::VectorXd& q, Eigen::VectorXd& q_out)
{
  const Eigen::Vector3d lever = turn.cross(arm);
  const Eigen::Vector3d arm_shift = (lever + 0.5 * turn.cross(lever)) / (1.0 + 0.25 * turn.squaredNorm());
  Eigen::Quaterniond step;
  step.w() = 1.0;
  step.vec() = 0.5 * turn;
  const Eigen::Quaterniond turned = (step * Eigen::Quaterniond(q.data() + 3)).normalized();
  q_out.head<3>() = q.head<3>() + (shift - arm_shift);
  q_out.segment<4>(3) = turned.coeffs();
}

/** o_m of 2 J (o_m - o) = dt ((J o_m) x o_m + torque). Newton, with halved steps where a whole one does not gain. */
Eigen::Vector3d meanSpin(const Eigen::Matrix3d& inertia, const Eigen::Vector3d& spin, const Eigen::Vector3d& torque,
                         double dt)
{
  const auto residual = [&](const Eigen::Vector3d& mean) -> Eigen::Vector3d
  { return inertia * (mean - spin) - 0.5 * dt * ((inertia * mean).cross(mean) + torque); };
  Eigen::Vector3d mean = spin;
  Eigen::Vector3d error = residual(mean);
  double share = 1.0;
  Eigen::Vector3d newton = Eigen::Vector3d::Zero();
  for (int i = 0; i < MOST_NEWTON_ITERATIONS && !error.isZero(0.0); ++i)
  {
    if (share == 1.0)
    {
      const Eigen::Matrix3d slope = inertia - 0.5 * dt * (cross(inertia * mean) - cross(mean) * inertia);
      newton = slope.partialPivLu().solve(error);
    }
    const Eigen::Vector3d next = mean - share * newton;
    const Eigen::Vector3d next_error = residual(next);
    if (next_error.norm() < error.norm())
    {
      mean = next;
      error = next_error;
      share = 1.0;
    }
    else if ((share *= 0.5) < HALVED || newton.norm() <= 1e-15 * mean.norm())
      break;  // round-off
  }
  return mean;
}
}  // namespace

bool isFreeLink(const MultibodyModel& model)
{
  return model.links.size() == 1 && model.joints.front().type == JointType::FLOATING;
}

bool isIsotropic(const MultibodyModel& model)
{
  const Eigen::Matrix3d& inertia = model.links.front().inertia.rotational;
  const double moment = inertia.trace() / 3.0;
  return (inertia - moment * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= ISOTROPIC * moment;
}

void moveFreeLinkToMidpoint(const Body& body, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double dt,
                            Eigen::VectorXd& q_middle)
{
  const Eigen::Vector3d angular = v.tail<3>();
  const Eigen::Vector3d arm = orientation(q) * inertiaOf(body).center;
  const Eigen::Vector3d center_velocity = v.head<3>() + angular.cross(arm);
  moveAboutCenter(arm, 0.5 * dt * center_velocity, 0.5 * dt * angular, q, q_middle);
}

void mapFreeLinkStart(Body& body)
{
  const BodyState& state = body.state;
  const Eigen::Vector3d angular = state.v.tail<3>();
  const Eigen::Vector3d& center = inertiaOf(body).center;
  const Eigen::Matrix3d turn = orientation(state.q);
  const Eigen::Matrix3d turn_m = orientation(body.q_middle);
  const Eigen::Vector3d center_velocity = state.v.head<3>() + angular.cross(turn * center);
  const Eigen::Vector3d image = fromAxes(body, turn_m, toAxes(body, turn, angular));
  body.v_start.head<3>() = center_velocity - image.cross(turn_m * center);
  body.v_start.tail<3>() = image;
}

void moveFreely(Body& body, const Eigen::Vector3d& gravity, double dt)
{
  const RigidInertia& inertia = inertiaOf(body);
  const Eigen::Matrix3d turn_m = orientation(body.q_middle);
  const Eigen::Vector3d arm = turn_m * inertia.center;
  const Eigen::Vector3d image = body.v_start.tail<3>();
  const Eigen::Vector3d force = body.external.head<3>();
  const Eigen::Vector3d torque = body.external.tail<3>() - arm.cross(force);
  const Eigen::Vector3d spin = toAxes(body, turn_m, image);
  const Eigen::Vector3d mean = meanSpin(inertia.rotational, spin, toAxes(body, turn_m, torque), dt);
  const Eigen::Vector3d center_velocity =
      body.v_start.head<3>() + image.cross(arm) +
      dt * (body.middle.base_pose.linear().transpose() * gravity + force / inertia.mass);
  const Eigen::Vector3d free_image = fromAxes(body, turn_m, 2.0 * mean - spin);
  body.v_free.head<3>() = center_velocity - free_image.cross(arm);
  body.v_free.tail<3>() = free_image;
}

void computeFreeLinkBias(const Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity,
                         Eigen::VectorXd& bias)
{
  const RigidInertia& inertia = inertiaOf(body);
  const Eigen::Matrix3d turn_m = orientation(body.q_middle);
  const Eigen::Vector3d image = v.tail<3>();
  const Eigen::Vector3d momentum = body.model.isotropic
                                       ? Eigen::Vector3d(inertia.rotational * image)
                                       : Eigen::Vector3d(turn_m * (inertia.rotational * (turn_m.transpose() * image)));
  const Eigen::Vector3d weight = inertia.mass * (body.middle.base_pose.linear().transpose() * gravity);
  const Eigen::Vector3d arm = turn_m * inertia.center;
  bias.head<3>() = -weight;
  bias.tail<3>() = -momentum.cross(image) - arm.cross(weight);
}

void moveFreeLinkToEnd(const Body& body, const Eigen::Ref<const Eigen::VectorXd>& v, double dt, Eigen::VectorXd& q_end,
                       Eigen::VectorXd& v_end)
{
  const Eigen::Vector3d& center = inertiaOf(body).center;
  const Eigen::Matrix3d turn = orientation(body.state.q);
  const Eigen::Matrix3d turn_m = orientation(body.q_middle);
  const Eigen::Vector3d arm_m = turn_m * center;
  const Eigen::Vector3d image = v.tail<3>();
  const Eigen::Vector3d mean_linear = 0.5 * (body.v_start.head<3>() + v.head<3>());
  const Eigen::Vector3d mean_image = 0.5 * (body.v_start.tail<3>() + image);
  const Eigen::Vector3d center_velocity = v.head<3>() + image.cross(arm_m);
  const Eigen::Vector3d mean_velocity = mean_linear + mean_image.cross(arm_m);
  const Eigen::Vector3d mean = fromAxes(body, turn, toAxes(body, turn_m, mean_image));
  const Eigen::Vector3d spin = toAxes(body, turn_m, image);
  moveAboutCenter(turn * center, dt * mean_velocity, dt * mean, body.state.q, q_end);
  const Eigen::Matrix3d turn_end = orientation(q_end);
  const Eigen::Vector3d angular = fromAxes(body, turn_end, spin);
  v_end.head<3>() = center_velocity - angular.cross(turn_end * center);
  v_end.tail<3>() = angular;
}

}  // namespace frictional_contact_sim
