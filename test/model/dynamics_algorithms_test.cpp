#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "model/random_tree.h"

namespace frictional_contact_sim
{
namespace
{
const Eigen::Vector3d NO_GRAVITY = Eigen::Vector3d::Zero();
const Eigen::Vector3d GRAVITY(0.3, -0.2, -9.81);

Eigen::Vector3d centerOf(const MultibodyModel& model, const MultibodyData& data, int body)
{
  return data.link_pose[body] * model.links[body].inertia.center;
}

/** Momentum (linear; angular about the centre of mass) of a body from its Jacobian at the centre. */
Vector6d bodyMomentum(const MultibodyModel& model, const MultibodyData& data, int body, const Eigen::VectorXd& v,
                      Matrix6Xd& jacobian)
{
  pointJacobian(model, data, body, centerOf(model, data, body), jacobian);
  Vector6d momentum = jacobian * v;
  const Eigen::Matrix3d axes = data.link_pose[body].linear();
  momentum.head<3>() *= model.links[body].inertia.mass;
  momentum.tail<3>() = axes * model.links[body].inertia.rotational * axes.transpose() * momentum.tail<3>();
  return momentum;
}

struct Case
{
  int bodies;
  JointType base;
  double branching;
};

class RandomTreeDynamicsTest : public testing::TestWithParam<Case>
{
protected:
  RandomTreeDynamicsTest()
    : random_(19)
    , model_(random_.model(GetParam().bodies, GetParam().base, GetParam().branching))
    , data_(model_)
    , q_(random_.position(model_))
    , v_(2.0 * random_.vector(model_.nv))
  {
    forwardKinematics(model_, q_, data_);
  }

  Eigen::VectorXd acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& v)
  {
    forwardKinematics(model_, q, data_);
    computeMassMatrix(model_, data_);
    EXPECT_TRUE(factorizeMassMatrix(model_, Eigen::VectorXd(), data_));
    Eigen::VectorXd a(model_.nv);
    computeBiasForces(model_, v, GRAVITY, data_, a);
    solveMassMatrix(model_, data_, a);
    return -a;
  }

  /** Largest entry of a lower triangle that couples coordinates neither of which is on the way of the other. */
  double unrelatedPart(const Eigen::MatrixXd& lower) const
  {
    Eigen::MatrixXd rest = lower;
    for (int i = 0; i < model_.nv; ++i)
    {
      for (int j = i; j >= 0; j = model_.dof_parent[j])
      {
        rest(i, j) = 0.0;
      }
    }
    return rest.size() == 0 ? 0.0 : rest.cwiseAbs().maxCoeff();
  }

  double energy(const Eigen::VectorXd& q, const Eigen::VectorXd& v)
  {
    forwardKinematics(model_, q, data_);
    forwardVelocities(model_, v, data_);
    return kineticEnergy(model_, data_, v) + potentialEnergy(model_, data_, GRAVITY);
  }

  /** Change of energy by explicit midpoint steps: order 2, as q (+) dt v is exact for constant v. */
  double energyDrift(int steps, double duration)
  {
    Eigen::VectorXd q = q_;
    Eigen::VectorXd v = v_;
    Eigen::VectorXd middle(model_.nq);
    const double dt = duration / steps;
    for (int k = 0; k < steps; ++k)
    {
      const Eigen::VectorXd v_middle = v + 0.5 * dt * acceleration(q, v);
      integrate(model_, q, v_middle, 0.5 * dt, middle);
      v += dt * acceleration(middle, v_middle);
      integrate(model_, q, v_middle, dt, q);
    }
    return energy(q, v) - energy(q_, v_);
  }

  RandomTree random_;
  MultibodyModel model_;
  MultibodyData data_;
  Eigen::VectorXd q_;
  Eigen::VectorXd v_;
};
}  // namespace

TEST_P(RandomTreeDynamicsTest, MassMatrixIsTheSumOverBodiesAndPositiveDefinite)
{
  computeMassMatrix(model_, data_);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(model_.nv, model_.nv);
  Matrix6Xd jacobian(6, model_.nv);
  for (int body = 0; body < GetParam().bodies; ++body)
  {
    const RigidInertia& inertia = model_.links[body].inertia;
    pointJacobian(model_, data_, body, centerOf(model_, data_, body), jacobian);
    const Eigen::Matrix3d axes = data_.link_pose[body].linear();
    expected += inertia.mass * jacobian.topRows<3>().transpose() * jacobian.topRows<3>();
    expected +=
        jacobian.bottomRows<3>().transpose() * axes * inertia.rotational * axes.transpose() * jacobian.bottomRows<3>();
  }
  // Round-off: sums of up to 20 bodies about a reference up to ten metres away.
  EXPECT_LE((data_.mass_matrix - expected).norm(), 1e-13 * expected.norm());
  EXPECT_EQ((data_.mass_matrix - data_.mass_matrix.transpose()).norm(), 0.0);
  EXPECT_EQ(unrelatedPart(data_.mass_matrix.triangularView<Eigen::Lower>()), 0.0);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(data_.mass_matrix).info(), Eigen::Success);
}

TEST_P(RandomTreeDynamicsTest, FactorHasTheSparsityOfTheTreeAndSolves)
{
  computeMassMatrix(model_, data_);
  const Eigen::VectorXd extra = random_.vector(model_.nv).cwiseAbs();
  for (const bool stiff : {false, true})
  {
    ASSERT_TRUE(factorizeMassMatrix(model_, stiff ? extra : Eigen::VectorXd(), data_));
    Eigen::MatrixXd matrix = data_.mass_matrix;
    if (stiff)
    {
      matrix.diagonal() += extra;
    }
    const Eigen::MatrixXd lower = data_.mass_factor.triangularView<Eigen::Lower>();
    EXPECT_LE((lower.transpose() * lower - matrix).norm(), 1e-14 * model_.nv * matrix.norm());
    EXPECT_EQ(unrelatedPart(lower), 0.0) << "fill-in";
    const Eigen::VectorXd rhs = random_.vector(model_.nv);
    Eigen::VectorXd x = rhs;
    solveMassMatrix(model_, data_, x);
    EXPECT_LE((matrix * x - rhs).norm(), 1e-13 * (matrix.norm() * x.norm() + rhs.norm()));
  }
}

TEST_P(RandomTreeDynamicsTest, FactorRefusesAnIndefiniteMatrix)
{
  computeMassMatrix(model_, data_);
  if (model_.nv == 0)
  {
    return;
  }
  Eigen::VectorXd extra = Eigen::VectorXd::Zero(model_.nv);
  extra[model_.nv / 2] = -2.0 * data_.mass_matrix(model_.nv / 2, model_.nv / 2);
  EXPECT_FALSE(factorizeMassMatrix(model_, extra, data_));
}

TEST_P(RandomTreeDynamicsTest, BiasIsTheRateOfMomentumAtConstantVelocityCoordinates)
{
  // d'Alembert: bias = sum J^T d/dt (momentum) along q(t) = q (+) t v, with momenta from Jacobians alone. Central
  // differences of second order, improved once by Richardson: error h^4 = 1e-12 times fifth derivatives (up to 1e3 for
  // the chains), round-off 1e-14 / h = 1e-11, both relative to the size of the bias.
  const double h = 1e-3;
  Matrix6Xd jacobian(6, model_.nv);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(model_.nv);
  for (int body = 0; body < GetParam().bodies; ++body)
  {
    const auto momentum = [&](double t)
    {
      Eigen::VectorXd q(model_.nq);
      integrate(model_, q_, v_, t, q);
      forwardKinematics(model_, q, data_);
      return bodyMomentum(model_, data_, body, v_, jacobian);
    };
    const Vector6d coarse = (momentum(h) - momentum(-h)) / (2.0 * h);
    const Vector6d fine = (momentum(0.5 * h) - momentum(-0.5 * h)) / h;
    const Vector6d rate = (4.0 * fine - coarse) / 3.0;
    momentum(0.0);
    expected += jacobian.transpose() * rate;
  }
  forwardKinematics(model_, q_, data_);
  Eigen::VectorXd bias(model_.nv);
  computeBiasForces(model_, v_, NO_GRAVITY, data_, bias);
  EXPECT_LT((bias - expected).norm(), 1e-8 * (1.0 + expected.norm()));
}

TEST_P(RandomTreeDynamicsTest, BiasAtRestIsTheGradientOfThePotential)
{
  Eigen::VectorXd bias(model_.nv);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(model_.nv);
  computeBiasForces(model_, rest, GRAVITY, data_, bias);
  // Central differences, h = 1e-4: h^2 times third derivatives 1e-8 x 1e2, relative to forces of order 1e3.
  const double h = 1e-4;
  for (int k = 0; k < model_.nv; ++k)
  {
    const auto potential = [&](double t)
    {
      Eigen::VectorXd q(model_.nq);
      integrate(model_, q_, Eigen::VectorXd::Unit(model_.nv, k), t, q);
      forwardKinematics(model_, q, data_);
      return potentialEnergy(model_, data_, GRAVITY);
    };
    EXPECT_NEAR(bias[k], (potential(h) - potential(-h)) / (2.0 * h), 1e-7 * (10.0 + bias.norm()));
  }
}

TEST_P(RandomTreeDynamicsTest, KineticEnergyOfBodiesIsTheQuadraticFormOfTheMassMatrix)
{
  computeMassMatrix(model_, data_);
  forwardVelocities(model_, v_, data_);
  const double expected = 0.5 * v_.dot(data_.mass_matrix * v_);
  EXPECT_NEAR(kineticEnergy(model_, data_, v_), expected, 1e-13 * (1.0 + expected));
}

TEST_P(RandomTreeDynamicsTest, FreeMotionConservesEnergyToTheOrderOfTheScheme)
{
  // Explicit midpoint rule: energy error of order 2, so halving the step divides it by 4 (3 to 5.5 before the limit).
  if (model_.nv == 0)
  {
    return;
  }
  const double coarse = energyDrift(400, 0.1);
  const double fine = energyDrift(800, 0.1);
  const double finest = energyDrift(1600, 0.1);
  const double scale = std::abs(energy(q_, v_)) + 1.0;
  EXPECT_LT(std::abs(finest), 1e-4 * scale);
  if (std::abs(finest) > 1e-11 * scale)  // else round-off decides, as for a single body
  {
    EXPECT_NEAR((coarse - fine) / (fine - finest), 4.0, 1.5);
  }
}

TEST_P(RandomTreeDynamicsTest, WrenchDoesTheWorkOfForceAndTorqueAtItsPoint)
{
  forwardVelocities(model_, v_, data_);
  for (int body = 0; body < GetParam().bodies; ++body)
  {
    const Eigen::Vector3d point = random_.vector();
    const Eigen::Vector3d force = random_.vector();
    const Eigen::Vector3d torque = random_.vector();
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(model_.nv);
    addWrench(model_, data_, body, point, force, torque, tau);
    const Vector6d velocity = pointVelocity(data_, body, point);
    const double power = force.dot(velocity.head<3>()) + torque.dot(velocity.tail<3>());
    EXPECT_NEAR(tau.dot(v_), power, 1e-12 * (1.0 + tau.norm() * v_.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, RandomTreeDynamicsTest,
                         testing::Values(Case{1, JointType::FLOATING, 0.0}, Case{1, JointType::FIXED, 0.0},
                                         Case{2, JointType::FIXED, 0.0}, Case{6, JointType::FLOATING, 0.0},
                                         Case{12, JointType::FLOATING, 1.0}, Case{10, JointType::FIXED, 0.5},
                                         Case{20, JointType::FIXED, 1.0}));

TEST(FarFromTheOriginTest, MassMatrixAndBiasDoNotLoseDigits)
{
  // Everything refers to the root origin, so a robot 1e6 m away has the same M and bias to the round-off of positions,
  // 1e6 x 1e-16 = 1e-10 relative to metres.
  RandomTree random(23);
  const MultibodyModel model = random.model(8, JointType::FLOATING, 0.5);
  Eigen::VectorXd q = random.position(model);
  const Eigen::VectorXd v = random.vector(model.nv);
  MultibodyData near(model);
  MultibodyData far(model);
  Eigen::VectorXd near_bias(model.nv);
  Eigen::VectorXd far_bias(model.nv);
  forwardKinematics(model, q, near);
  computeMassMatrix(model, near);
  computeBiasForces(model, v, GRAVITY, near, near_bias);
  q.head<3>() += Eigen::Vector3d(1e6, -2e6, 1e6);
  forwardKinematics(model, q, far);
  computeMassMatrix(model, far);
  computeBiasForces(model, v, GRAVITY, far, far_bias);
  EXPECT_LT((near.mass_matrix - far.mass_matrix).norm(), 1e-8 * near.mass_matrix.norm());
  EXPECT_LT((near_bias - far_bias).norm(), 1e-8 * near_bias.norm());
}

}  // namespace frictional_contact_sim
