#include "lumped_inertia.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

#include "frictional_contact_sim/model/model_error.h"
#include "urdf_schema.h"

namespace frictional_contact_sim
{
namespace
{
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
      failAt(source, 0, describe(link) + ": expected principal moments >= 0");
    if (moments[0] + moments[1] < (1.0 - 1e-6) * moments[2])
      impossible.push_back(link.name);
  }
  std::vector<std::string> warnings;
  if (!impossible.empty())
  {
    warnings.push_back(
        "the inertia of no real mass distribution (two principal moments add up to less than the third): " +
        join(impossible));
  }
  return warnings;
}

}  // namespace frictional_contact_sim
