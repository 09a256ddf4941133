#include <cmath>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "spatial.h"

namespace frictional_contact_sim
{
void computeMassMatrix(const MultibodyModel& model, MultibodyData& data)
{
  const int bodies = static_cast<int>(model.bodies.size());
  for (int i = 0; i < bodies; ++i)
  {
    data.composite_inertia[i] = data.body_inertia[i];
  }
  for (int i = bodies - 1; i >= 0; --i)
  {
    const Joint& joint = model.joints[i];
    const WorldInertia& inertia = data.composite_inertia[i];
    for (int j = joint.v_index + velocitySize(joint.type) - 1; j >= joint.v_index; --j)
    {
      const Vector6d momentum = multiply(inertia, data.motion_subspace.col(j));
      for (int k = j; k >= 0; k = model.dof_parent[k])
      {
        const double entry = data.motion_subspace.col(k).dot(momentum);
        data.mass_matrix(k, j) = entry;
        data.mass_matrix(j, k) = entry;
      }
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
  const int* parent = model.dof_parent.data();
  Eigen::MatrixXd& factor = data.mass_factor;
  for (int k = 0; k < model.nv; ++k)
  {
    for (int i = k; i >= 0; i = parent[i])
    {
      factor(k, i) = data.mass_matrix(k, i);
    }
    factor(k, k) += extra.size() > 0 ? extra[k] : 0.0;
  }
  // From the leaves to the root: row k is finished first and only its ancestors are updated (no fill-in).
  for (int k = model.nv - 1; k >= 0; --k)
  {
    const double pivot = factor(k, k);
    if (!(pivot > 0.0))
    {
      return false;
    }
    const double root = std::sqrt(pivot);
    const double inverse = 1.0 / root;
    factor(k, k) = root;
    for (int i = parent[k]; i >= 0; i = parent[i])
    {
      factor(k, i) *= inverse;
    }
    for (int i = parent[k]; i >= 0; i = parent[i])
    {
      const double entry = factor(k, i);
      for (int j = i; j >= 0; j = parent[j])
      {
        factor(i, j) -= entry * factor(k, j);
      }
    }
  }
  return true;
}

void solveMassMatrix(const MultibodyModel& model, const MultibodyData& data, VectorOut x)
{
  const int* parent = model.dof_parent.data();
  const Eigen::MatrixXd& factor = data.mass_factor;
  for (int i = model.nv - 1; i >= 0; --i)
  {
    const double value = x[i] / factor(i, i);
    x[i] = value;
    for (int j = parent[i]; j >= 0; j = parent[j])
    {
      x[j] -= factor(i, j) * value;
    }
  }
  for (int i = 0; i < model.nv; ++i)
  {
    double value = x[i];
    for (int j = parent[i]; j >= 0; j = parent[j])
    {
      value -= factor(i, j) * x[j];
    }
    x[i] = value / factor(i, i);
  }
}

}  // namespace frictional_contact_sim
