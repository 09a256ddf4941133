#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "model/random_tree.h"

// Eigen allocates with malloc, not with operator new, so malloc itself is counted (glibc; sanitizers bring their own).
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace
{
std::atomic<long> allocations{0};
}

extern "C" void* __libc_malloc(size_t size);

extern "C" void* malloc(size_t size)
{
  ++allocations;
  return __libc_malloc(size);
}

namespace frictional_contact_sim
{
TEST(AllocationTest, NoAlgorithmOfTheModelAllocates)
{
  RandomTree random(31);
  const MultibodyModel model = random.model(20, JointType::FLOATING, 0.5);
  MultibodyData data(model);
  Eigen::VectorXd q = random.position(model);
  const Eigen::VectorXd v = random.vector(model.nv);
  const Eigen::VectorXd extra = Eigen::VectorXd::Ones(model.nv);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(model.nv);
  Matrix6Xd jacobian(6, model.nv);
  const Eigen::Vector3d point = Eigen::Vector3d::Ones();
  double sum = 0.0;

  const long before = allocations;
  forwardKinematics(model, q, data);
  forwardVelocities(model, v, data);
  computeMassMatrix(model, data);
  const bool regular = factorizeMassMatrix(model, extra, data);
  computeBiasForces(model, v, point, data, tau);
  addWrench(model, data, 7, point, point, point, tau);
  addPointJacobianRow(model, data, 7, point, point, 1.0, tau);
  solveMassMatrix(model, data, tau);
  pointJacobian(model, data, 19, point, jacobian);
  integrate(model, q, v, 1e-3, q);
  sum += pointVelocity(data, 3, point).sum() + framePose(model, data, 2).translation().sum();
  sum += centerOfMass(model, data).sum() + kineticEnergy(model, data, v) + potentialEnergy(model, data, point);
  const long after = allocations;

  EXPECT_EQ(after - before, 0);
  EXPECT_TRUE(regular);
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_GT(before, 0) << "the counter is not in place";
}
}  // namespace frictional_contact_sim
#endif
