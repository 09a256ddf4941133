#include "frictional_contact_sim/model/loop_joint.h"

namespace frictional_contact_sim
{
const char* toString(LoopType type)
{
  switch (type)
  {
    case LoopType::POINT:
      return "point";
    case LoopType::AXIS:
      return "axis";
    case LoopType::WELD:
      return "weld";
  }
  return "";
}

Eigen::Matrix3d orientationAlong(const Eigen::Vector3d& axis)
{
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

}  // namespace frictional_contact_sim
