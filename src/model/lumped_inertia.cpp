#include "lumped_inertia.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/model_error.h"
#include "urdf_schema.h"

namespace frictional_contact_sim
{
namespace
{
/// Least articulated over composite inertia of a coordinate that counts as positive; round-off of their difference is
/// some 1e-15, and chains with true ratios below 1e-8 are not known.
constexpr double LEAST_PIVOT_RATIO = 1e-10;

/** Principal moments [kg m^2], ascending. */
Eigen::Vector3d principalMoments(const RigidInertia& inertia)
{
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia.rotational, Eigen::EigenvaluesOnly).eigenvalues();
}

std::string describe(const Link& link)
{
  const Eigen::Vector3d moments = principalMoments(link.inertia);
  std::ostringstream text;
  text << "link '" << link.name << "' (with the links fixed to it) has mass " << link.inertia.mass
       << " kg and principal moments " << moments[0] << ", " << moments[1] << ", " << moments[2] << " kg m^2";
  return text.str();
}

bool isJudged(const MultibodyModel& model, size_t link)
{
  return velocitySize(model.joints[link].type) > 0;
}

/** @return coordinate whose inertia vanishes at q, -1 = the mass matrix is positive definite */
int singularCoordinate(const MultibodyModel& model, const Eigen::VectorXd& q)
{
  MultibodyData data(model);
  forwardKinematics(model, q, data);
  computeMassMatrix(model, data);
  factorizeMassMatrix(model, Eigen::VectorXd(), data);
  for (int k = model.nv - 1; k >= 0; --k)  // the order of the factorization: what comes later may not be computed
  {
    const double root = data.mass_factor(k, k);
    if (!(root > 0.0) || root * root <= LEAST_PIVOT_RATIO * data.mass_matrix(k, k))
      return k;
  }
  return -1;
}

/** A position without special angles. */
Eigen::VectorXd genericPosition(const MultibodyModel& model)
{
  Eigen::VectorXd q = zeroPosition(model);
  for (const Joint& joint : model.joints)
  {
    if (joint.type != JointType::FLOATING)
      for (int k = joint.q_index; k < joint.q_index + positionSize(joint.type); ++k)
        q[k] = 0.7 + 0.3 * std::sin(1.7 * k);
  }
  return q;
}

std::string join(const std::vector<std::string>& names)
{
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}
}  // namespace

RigidInertia transform(const RigidInertia& inertia, const Eigen::Isometry3d& placement)
{
  const Eigen::Matrix3d axes = placement.linear();
  return {inertia.mass, placement * inertia.center, axes * inertia.rotational * axes.transpose()};
}

RigidInertia combine(const std::vector<RigidInertia>& parts)
{
  RigidInertia whole;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const RigidInertia& part : parts)
  {
    whole.mass += part.mass;
    moment += part.mass * part.center;
  }
  if (whole.mass > 0.0)
    whole.center = moment / whole.mass;
  for (const RigidInertia& part : parts)
  {
    const Eigen::Vector3d arm = part.center - whole.center;
    whole.rotational += part.rotational;
    whole.rotational += part.mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  return whole;
}

std::vector<std::string> checkInertia(const MultibodyModel& model, const std::string& source)
{
  std::vector<std::string> weak;
  std::vector<std::string> impossible;
  for (size_t i = 0; i < model.links.size(); ++i)
  {
    if (!isJudged(model, i))
      continue;
    const Link& link = model.links[i];
    if (!link.inertia.rotational.allFinite() || !link.inertia.center.allFinite() || !std::isfinite(link.inertia.mass))
      failAt(source, 0, "link '" + link.name + "' (with the links fixed to it): mass or inertia overflows");
    const Eigen::Vector3d moments = principalMoments(link.inertia);
    const double round_off = 1e-12 * moments.cwiseAbs().maxCoeff();
    if (moments[0] < -round_off)
      failAt(source, 0, describe(link) + ": expected a positive definite inertia matrix");
    if (link.inertia.mass <= 0.0 || moments[0] <= round_off)
      weak.push_back(link.name);
    else if (moments[0] + moments[1] < (1.0 - 1e-6) * moments[2])
      impossible.push_back(link.name);
  }
  std::vector<std::string> warnings;
  if (!impossible.empty())
  {
    warnings.push_back(
        "the inertia of no real mass distribution (two principal moments add up to less than the third): " +
        join(impossible));
  }
  if (weak.empty())
    return warnings;
  const int coordinate = singularCoordinate(model, genericPosition(model));
  if (coordinate >= 0)
  {
    const int link = model.dof_link[coordinate];
    const Joint& joint = model.joints[link];
    failAt(source, 0,
           describe(model.links[link]) + ", and nothing it carries makes up for it: a " +
               (joint.name.empty() ? "floating base" : "moving link (joint '" + joint.name + "')") +
               " needs an <inertial>, or a fixed base or joint");
  }
  warnings.push_back("without mass or with a singular inertia matrix, held up by what it carries: " + join(weak));
  if (singularCoordinate(model, zeroPosition(model)) >= 0)
    warnings.push_back("the mass matrix is singular at the zero position, because of " + join(weak));
  return warnings;
}

}  // namespace frictional_contact_sim
