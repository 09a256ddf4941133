/**
 * @file frictional_lcp_test.cpp
 * @brief The nonsymmetric LCP: its matrices, one node by hand, complementarity, symmetry, energy, loads, misuse.
 */
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "frictional_contact_sim/rolling/frictional_lcp.h"

using namespace frictional_contact_sim;

namespace
{
const PlaneStrainMaterial RUBBER{94500.0, 0.1};

ContactFlexibility coupledFlexibility(int n, double half_width = 0.06)
{
  Eigen::VectorXd x, w;
  makeUniformNodes(half_width, n, x, w);
  return halfPlaneFlexibility(MaterialPair{RUBBER, {}, true}, x, w, 2.0);
}

Eigen::VectorXd parabola(const ContactFlexibility& F)
{
  return F.x.array().square() / 2.0;
}

Eigen::VectorXd constant(double value, Eigen::Index n)
{
  return Eigen::VectorXd::Constant(n, value);
}

double elasticEnergy(const ContactFlexibility& F, const FrictionalContact& c)
{
  return 0.5 * (F.width.array() * (c.r_N.array() * c.u_N.array() + c.r_T.array() * c.u_T.array())).sum();
}
}  // namespace

TEST(FrictionalLcpTest, MatrixIsThatOfThePaperWithTheCorrectedShapes)
{
  const int n = 3;
  const ContactFlexibility F = coupledFlexibility(n);
  const Eigen::Vector3d mu(0.1, 0.2, 0.3);
  const FrictionalLcp lcp(F, mu);
  Eigen::MatrixXd T_T(n, 2 * n), T_N(n, 2 * n);
  T_T << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  T_N << Eigen::Matrix3d(mu.asDiagonal()), Eigen::Matrix3d(mu.asDiagonal());
  const Eigen::MatrixXd inverse = F.TT.inverse();
  Eigen::MatrixXd M(3 * n, 3 * n);
  M << F.NN - F.NT * inverse * F.TN, F.NT * inverse * T_T, -(T_T.transpose() * inverse * F.TN - T_N.transpose()),
      T_T.transpose() * inverse * T_T;
  // Round-off times the condition of F_TT.
  EXPECT_LT((lcp.matrix() - M).norm(), 1e-11 * M.norm());
  const Eigen::Vector3d d_N(-1e-3, -2e-3, 1e-3), d_T(1e-4, 0.0, -1e-4);
  Eigen::VectorXd b(3 * n);
  b << d_N - F.NT * inverse * d_T, -T_T.transpose() * inverse * d_T;
  EXPECT_LT((lcp.vector(d_N, d_T) - b).norm(), 1e-11 * b.norm());
}

TEST(FrictionalLcpTest, OneNodeSticksSlipsAndSeparates)
{
  // F = diag(f, f): r_N = d/f; the shift needed for slip is mu d.
  ContactFlexibility F;
  F.x = constant(0.0, 1);
  F.width = constant(2.0, 1);
  F.NN = F.TT = Eigen::MatrixXd::Constant(1, 1, 1e-3);
  F.NT = F.TN = Eigen::MatrixXd::Zero(1, 1);
  const FrictionalLcp lcp(F, constant(0.5, 1));
  const auto at = [&](double d_N, double d_T) { return lcp.solve(constant(d_N, 1), constant(d_T, 1)); };
  FrictionalContact c = at(-0.02, 0.004);
  EXPECT_EQ(c.states[0], NodeState::STICK);
  EXPECT_NEAR(c.r_N[0], 20.0, 1e-12);
  EXPECT_NEAR(c.r_T[0], -4.0, 1e-12);
  EXPECT_NEAR(c.P, 40.0, 1e-12);
  c = at(-0.02, 0.03);
  EXPECT_EQ(c.states[0], NodeState::SLIP_RIGHT);
  EXPECT_NEAR(c.r_T[0], -10.0, 1e-12);
  EXPECT_NEAR(c.y_T[0], 0.02, 1e-14);  // what friction cannot hold back: 0.03 - mu d
  c = at(-0.02, -0.03);
  EXPECT_EQ(c.states[0], NodeState::SLIP_LEFT);
  EXPECT_NEAR(c.r_T[0], 10.0, 1e-12);
  c = at(0.01, 0.03);
  EXPECT_EQ(c.states[0], NodeState::SEPARATION);
  EXPECT_EQ(c.r_N[0], 0.0);
  EXPECT_NEAR(c.r_T[0], 0.0, 1e-12);
  EXPECT_NEAR(c.y_T[0], 0.03, 1e-14);
}

TEST(FrictionalLcpTest, AnswersFulfilSignoriniAndCoulombNodeByNode)
{
  for (double mu : {0.0, 0.1, 0.3, 0.8})
    for (double shift : {0.0, 1e-4, -5e-4, 3e-3})
    {
      const ContactFlexibility F = coupledFlexibility(50);
      const FrictionalContact c =
          FrictionalLcp(F, constant(mu, 1)).solve(parabola(F).array() - 1e-3, constant(shift, 50));
      ASSERT_EQ(c.status, LcpStatus::SOLVED);
      EXPECT_LT(c.residual, 1e-12) << mu << " " << shift;  // units of order one, condition of F_TT about 1e2
      const double p = c.r_N.maxCoeff();
      for (Eigen::Index i = 0; i < 50; ++i)
      {
        EXPECT_GE(c.r_N[i], -1e-12 * p);
        EXPECT_GE(c.y_N[i], -1e-12);
        EXPECT_LE(std::min(c.r_N[i] / p, c.y_N[i] / 1e-3), 1e-10);
        EXPECT_LE(std::abs(c.r_T[i]), mu * c.r_N[i] + 1e-10 * p);
        if (c.states[static_cast<size_t>(i)] == NodeState::STICK)
        {
          EXPECT_NEAR(c.y_T[i], 0.0, 1e-13);
        }
        else if (c.r_N[i] > 0.0)
        {
          EXPECT_NEAR(c.r_T[i], -std::copysign(mu * c.r_N[i], c.y_T[i]), 1e-10 * p);
        }
        // Compatibility (34): both sides in metres.
        EXPECT_NEAR(c.y_N[i], c.u_N[i] + F.x[i] * F.x[i] / 2.0 - 1e-3, 1e-13);
        EXPECT_NEAR(c.y_T[i], c.u_T[i] + shift, 1e-13);
      }
    }
}

TEST(FrictionalLcpTest, PureNormalApproachIsSymmetric)
{
  // Q = 0: pressure even, tangential traction odd, stick in the middle, slip towards the middle on both sides.
  const int n = 61;
  const ContactFlexibility F = coupledFlexibility(n);
  const FrictionalContact c = FrictionalLcp(F, constant(0.1, 1)).solve(parabola(F).array() - 1e-3, constant(0.0, n));
  ASSERT_EQ(c.status, LcpStatus::SOLVED);
  const double p = c.r_N.maxCoeff();
  EXPECT_LT((c.r_N - c.r_N.reverse()).lpNorm<Eigen::Infinity>(), 1e-10 * p);
  EXPECT_LT((c.r_T + c.r_T.reverse()).lpNorm<Eigen::Infinity>(), 1e-10 * p);
  EXPECT_NEAR(c.Q, 0.0, 1e-10 * c.P);
  EXPECT_EQ(c.states[n / 2], NodeState::STICK);
  EXPECT_GT(c.r_T.lpNorm<Eigen::Infinity>(), 0.01 * p);  // coupling does cause friction
}

TEST(FrictionalLcpTest, WithoutFrictionTheTangentialShiftHasNoSay)
{
  const ContactFlexibility F = coupledFlexibility(40);
  const FrictionalLcp lcp(F, constant(0.0, 1));
  const FrictionalContact straight = lcp.solve(parabola(F).array() - 1e-3, constant(0.0, 40));
  const FrictionalContact shifted = lcp.solve(parabola(F).array() - 1e-3, constant(2e-3, 40));
  const double p = straight.r_N.maxCoeff();
  EXPECT_LT((straight.r_N - shifted.r_N).lpNorm<Eigen::Infinity>(), 1e-11 * p);
  EXPECT_LT(shifted.r_T.lpNorm<Eigen::Infinity>(), 1e-11 * p);
}

TEST(FrictionalLcpTest, FrictionlessEnergyGrowsByLoadTimesApproach)
{
  // dU/d(approach) = P: central difference, error (eps/d)^2 of a piecewise quadratic function with few corners.
  const ContactFlexibility F = coupledFlexibility(60);
  const FrictionalLcp lcp(F, constant(0.0, 1));
  const auto at = [&](double d) { return lcp.solve(parabola(F).array() - d, constant(0.0, 60)); };
  const double d = 1e-3, eps = 1e-6;
  const double slope = (elasticEnergy(F, at(d + eps)) - elasticEnergy(F, at(d - eps))) / (2.0 * eps);
  EXPECT_NEAR(slope, at(d).P, 1e-5 * at(d).P);
}

TEST(FrictionalLcpTest, StickingEnergyEqualsTheWorkOfTheRigidMotion)
{
  // Held by friction everywhere (mu = 10), U = 1/2 sum w r.(y - d): with y = 0 in contact, half the rigid work.
  const int n = 40;
  const ContactFlexibility F = coupledFlexibility(n);
  const Eigen::VectorXd d_N = parabola(F).array() - 1e-3;
  const FrictionalContact c = FrictionalLcp(F, constant(10.0, 1)).solve(d_N, constant(2e-4, n));
  const double work = -0.5 * (F.width.array() * (c.r_N.array() * d_N.array() + c.r_T.array() * 2e-4)).sum();
  for (NodeState state : c.states)
    EXPECT_TRUE(state == NodeState::SEPARATION || state == NodeState::STICK);
  EXPECT_NEAR(elasticEnergy(F, c), work, 1e-12 * work);
  EXPECT_GT(work, 0.0);
}

TEST(FrictionalLcpTest, LoadDerivativeIsThatOfTheAnswer)
{
  const int n = 50;
  const ContactFlexibility F = coupledFlexibility(n);
  const FrictionalLcp lcp(F, constant(0.3, 1));
  const auto at = [&](double approach, double shift)
  { return lcp.solve(parabola(F).array() - approach, constant(shift, n)); };
  const double eps = 1e-9;  // small against the distance to the next change of state
  const Eigen::Matrix2d D = lcp.loadDerivative(at(1e-3, 1e-4));
  const FrictionalContact a = at(1e-3 - eps, 1e-4), b = at(1e-3 + eps, 1e-4);  // d_N grows as the approach falls
  const FrictionalContact c = at(1e-3, 1e-4 + eps), d = at(1e-3, 1e-4 - eps);
  Eigen::Matrix2d numeric;
  numeric << (a.P - b.P), (c.P - d.P), (a.Q - b.Q), (c.Q - d.Q);
  // Piecewise linear: cancellation only, 1e-15 P/(P eps/d) = 1e-9 of D.
  EXPECT_LT((D - numeric / (2.0 * eps)).norm(), 1e-6 * D.norm());
}

TEST(FrictionalLcpTest, LoadsAreMetWithAndWithoutCoupling)
{
  for (bool rigid : {true, false})
    for (double share : {-0.9, -0.5, 0.0, 0.3, 0.95})
    {
      Eigen::VectorXd x, w;
      makeUniformNodes(0.07, 60, x, w);
      const ContactFlexibility F = halfPlaneFlexibility(MaterialPair{RUBBER, RUBBER, rigid}, x, w, 2.0);
      LoadTarget target;
      target.P = 100.0;
      target.Q = share * 0.3 * target.P;
      const LoadedContact answer =
          solveForLoads(FrictionalLcp(F, constant(0.3, 1)), parabola(F), constant(0.0, 60), target, 1e-3, 0.0);
      EXPECT_TRUE(answer.converged) << rigid << share;
      EXPECT_NEAR(answer.contact.P, 100.0, 1e-8);
      EXPECT_NEAR(answer.contact.Q, target.Q, 1e-8);
      EXPECT_LE(answer.iterations, 15) << rigid << " " << share;
    }
}

TEST(FrictionalLcpTest, MisuseIsNamed)
{
  const ContactFlexibility F = coupledFlexibility(4);
  EXPECT_THROW(FrictionalLcp(ContactFlexibility{}, constant(0.3, 1)), std::invalid_argument);
  EXPECT_THROW(FrictionalLcp(F, constant(-0.3, 1)), std::invalid_argument);
  EXPECT_THROW(FrictionalLcp(F, constant(0.3, 3)), std::invalid_argument);
  const FrictionalLcp lcp(F, constant(0.3, 1));
  EXPECT_THROW(lcp.solve(constant(0.0, 3), constant(0.0, 4)), std::invalid_argument);
  LoadTarget target;
  EXPECT_THROW(solveForLoads(lcp, constant(0.0, 4), constant(0.0, 4), target, 1e-3, 0.0), std::invalid_argument);
  target.P = 1.0;
  target.Q = 0.3;
  EXPECT_THROW(solveForLoads(lcp, constant(0.0, 4), constant(0.0, 4), target, 1e-3, 0.0), std::invalid_argument);
}
