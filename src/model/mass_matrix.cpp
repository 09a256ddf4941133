#include <cmath>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "spatial.h"

namespace frictional_contact_sim
{
namespace
{
/** Visits a coordinate and its ancestors run by run: within a run the next index needs no look-up. */
class AncestorRuns
{
public:
  explicit AncestorRuns(const MultibodyModel& model) : parent_(model.dof_parent.data()), run_(model.dof_run.data()) {}

  template <typename Visitor>
  void forEach(int coordinate, const Visitor& visit) const
  {
    for (int end = coordinate; end >= 0;)
    {
      const int begin = run_[end];
      for (int i = end; i >= begin; --i)
        visit(i);
      end = parent_[begin];
    }
  }

private:
  const int* parent_;
  const int* run_;
};
}  // namespace

namespace
{
/** Block of the six coordinates of a root that floats in axes of the world: the products with unit vectors are exact.
 */
void setFloatingRoot(const MultibodyModel& model, MultibodyData& data)
{
  const WorldInertia& inertia = data.composite_inertia.front();
  Eigen::MatrixXd& M = data.mass_matrix;
  const Eigen::Vector3d& moment = inertia.moment;
  M.topLeftCorner<3, 3>() = inertia.mass * Eigen::Matrix3d::Identity();
  M.block<3, 3>(0, 3) << 0.0, moment.z(), -moment.y(), -moment.z(), 0.0, moment.x(), moment.y(), -moment.x(), 0.0;
  M.block<3, 3>(3, 0) = M.block<3, 3>(0, 3).transpose();
  // One triangle, as everywhere: the two of the inertia differ in their last digit.
  M.block<3, 3>(3, 3).triangularView<Eigen::Upper>() = inertia.rotational;
  M.block<3, 3>(3, 3).triangularView<Eigen::StrictlyLower>() = M.block<3, 3>(3, 3).transpose();
  for (int j = 0; j < 6; ++j)
    M(j, j) += model.armature[j];
}
}  // namespace

void computeMassMatrix(const MultibodyModel& model, MultibodyData& data)
{
  const AncestorRuns chain(model);
  const int links = static_cast<int>(model.links.size());
  for (int i = 0; i < links; ++i)
    data.composite_inertia[i] = data.link_inertia[i];
  for (int i = links - 1; i >= 0; --i)
  {
    const Joint& joint = model.joints[i];
    if (joint.type == JointType::FLOATING && i == 0 && data.base_pose.linear() == Eigen::Matrix3d::Identity())
    {
      setFloatingRoot(model, data);
      break;
    }
    const WorldInertia& inertia = data.composite_inertia[i];
    for (int j = joint.v_index + velocitySize(joint.type) - 1; j >= joint.v_index; --j)
    {
      const Vector6d momentum = multiply(inertia, data.motion_subspace.col(j));
      chain.forEach(j,
                    [&](int k)
                    {
                      const double entry = data.motion_subspace.col(k).dot(momentum);
                      data.mass_matrix(k, j) = entry;
                      data.mass_matrix(j, k) = entry;
                    });
      data.mass_matrix(j, j) += model.armature[j];
    }
    if (joint.parent >= 0)
    {
      WorldInertia& parent = data.composite_inertia[joint.parent];
      parent.mass += inertia.mass;
      parent.moment += inertia.moment;
      parent.rotational += inertia.rotational;
    }
  }
}

bool factorizeMassMatrix(const MultibodyModel& model, const VectorIn& extra, MultibodyData& data)
{
  const AncestorRuns chain(model);
  const Eigen::Index stride = model.nv;
  double* const factor = data.mass_factor.data();
  double* const row = data.factor_row.data();
  for (int k = 0; k < model.nv; ++k)
  {
    chain.forEach(k, [&](int i) { factor[k + i * stride] = data.mass_matrix(i, k); });
    factor[k + k * stride] += extra.size() > 0 ? extra[k] : 0.0;
  }
  // From the leaves to the root: row k is finished first and only its ancestors are updated (no fill-in).
  for (int k = model.nv - 1; k >= 0; --k)
  {
    const double pivot = factor[k + k * stride];
    if (!(pivot > 0.0))
      return false;
    const double root = std::sqrt(pivot);
    const double inverse = 1.0 / root;
    factor[k + k * stride] = root;
    data.factor_inverse[k] = inverse;
    const int parent = model.dof_parent[k];
    chain.forEach(
        parent,
        [&](int i)
        {
          row[i] = factor[k + i * stride] * inverse;
          factor[k + i * stride] = row[i];
        });
    chain.forEach(parent,
                  [&](int i)
                  {
                    const double entry = row[i];
                    chain.forEach(i, [&](int j) { factor[i + j * stride] -= entry * row[j]; });
                  });
  }
  return true;
}

void solveMassMatrix(const MultibodyModel& model, const MultibodyData& data, VectorOut x)
{
  const AncestorRuns chain(model);
  const Eigen::Index stride = model.nv;
  const double* const factor = data.mass_factor.data();
  for (int i = model.nv - 1; i >= 0; --i)
  {
    const double value = x[i] * data.factor_inverse[i];
    x[i] = value;
    chain.forEach(model.dof_parent[i], [&](int j) { x[j] -= factor[i + j * stride] * value; });
  }
  for (int i = 0; i < model.nv; ++i)
  {
    double value = x[i];
    chain.forEach(model.dof_parent[i], [&](int j) { value -= factor[i + j * stride] * x[j]; });
    x[i] = value * data.factor_inverse[i];
  }
}

}  // namespace frictional_contact_sim
