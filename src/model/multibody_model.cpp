#include "frictional_contact_sim/model/multibody_model.h"

#include <cmath>
#include <stdexcept>

namespace frictional_contact_sim
{
int positionSize(JointType type)
{
  switch (type)
  {
    case JointType::REVOLUTE:
    case JointType::CONTINUOUS:
    case JointType::PRISMATIC:
      return 1;
    case JointType::PLANAR:
      return 3;
    case JointType::FLOATING:
      return 7;
    case JointType::FIXED:
      return 0;
  }
  return 0;
}

int velocitySize(JointType type)
{
  return type == JointType::FLOATING ? 6 : positionSize(type);
}

Eigen::Matrix<double, 3, 2> planarAxes(const Eigen::Vector3d& normal)
{
  // The least rotation taking z to n = (a, b, c) is known in closed form: x -> (1 - a^2/(1+c), -ab/(1+c), -a).
  Eigen::Matrix<double, 3, 2> axes;
  const double one_plus_c = 1.0 + normal.z();
  if (one_plus_c < 1e-12)  // n = -z: the rotation is not unique
  {
    axes << 1.0, 0.0, 0.0, -1.0, 0.0, 0.0;
    return axes;
  }
  const double a = normal.x();
  const double b = normal.y();
  const double ab = a * b / one_plus_c;
  axes << 1.0 - a * a / one_plus_c, -ab, -ab, 1.0 - b * b / one_plus_c, -a, -b;
  return axes;
}

int MultibodyModel::findJoint(const std::string& joint_name) const
{
  for (size_t i = 0; i < joints.size(); ++i)
    if (!joint_name.empty() && joints[i].name == joint_name)
      return static_cast<int>(i);
  return -1;
}

int MultibodyModel::findFrame(const std::string& link_name) const
{
  for (size_t i = 0; i < frames.size(); ++i)
    if (frames[i].name == link_name)
      return static_cast<int>(i);
  return -1;
}

double MultibodyModel::totalMass() const
{
  double mass = 0.0;
  for (const Link& link : links)
    mass += link.inertia.mass;
  return mass;
}

namespace
{
void checkJoint(const MultibodyModel& model, int index)
{
  const Joint& joint = model.joints[index];
  const std::string label = "model '" + model.name + "', joint " + std::to_string(index) + " '" + joint.name + "': ";
  if (joint.parent >= index || joint.parent < -1)
    throw std::invalid_argument(label + "parent link " + std::to_string(joint.parent) + " must come before its child");
  const bool has_axis = joint.type != JointType::FLOATING && joint.type != JointType::FIXED;
  if (has_axis && !(std::abs(joint.axis.norm() - 1.0) < 1e-9))
    throw std::invalid_argument(label + "axis has length " + std::to_string(joint.axis.norm()) + ", expected 1");
}
}  // namespace

void finalize(MultibodyModel& model)
{
  if (model.joints.size() != model.links.size())
  {
    throw std::invalid_argument("model '" + model.name + "': " + std::to_string(model.joints.size()) + " joints for " +
                                std::to_string(model.links.size()) + " links, expected one each");
  }
  model.nq = 0;
  model.nv = 0;
  model.dof_parent.clear();
  model.dof_run.clear();
  model.dof_link.clear();
  model.link_dof.assign(model.links.size(), -1);
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i)
  {
    checkJoint(model, i);
    Joint& joint = model.joints[i];
    joint.q_index = model.nq;
    joint.v_index = model.nv;
    int previous = joint.parent < 0 ? -1 : model.link_dof[joint.parent];
    for (int k = 0; k < velocitySize(joint.type); ++k)
    {
      model.dof_parent.push_back(previous);
      model.dof_run.push_back(previous >= 0 && previous == model.nv - 1 ? model.dof_run[previous] : model.nv);
      model.dof_link.push_back(i);
      previous = model.nv++;
    }
    model.link_dof[i] = previous;
    model.nq += positionSize(joint.type);
  }
  model.armature = Eigen::VectorXd::Zero(model.nv);
}

}  // namespace frictional_contact_sim
