#include "support/thesis_problems.h"

#include <cmath>

#include "support/hand_problems.h"

namespace frictional_contact_sim
{
namespace test_support
{
using Eigen::MatrixXd;
using Eigen::VectorXd;

IncrementalProblem denseProblem(const MatrixXd& M, const VectorXd& f, const MatrixXd& H, const VectorXd& w,
                                const std::vector<Law>& laws)
{
  IncrementalProblem problem;
  problem.M = sparse(M);
  problem.f = f;
  problem.H = sparse(H);
  problem.w = w;
  problem.laws = laws;
  problem.G.resize(0, f.size());
  problem.b.resize(0);
  return problem;
}

IncrementalProblem kinematics(const MatrixXd& H, const VectorXd& w, const std::vector<Law>& laws)
{
  return denseProblem(MatrixXd::Identity(H.cols(), H.cols()), VectorXd::Zero(H.cols()), H, w, laws);
}

IncrementalProblem painleveRod(double angle, double friction, double gravity, double support_velocity)
{
  const double sine = std::sin(angle), cosine = std::cos(angle);
  return denseProblem(MatrixXd::Identity(1, 1), VectorXd::Constant(1, -gravity * sine), Eigen::Vector2d(sine, cosine),
                      Eigen::Vector2d(0.0, support_velocity), {{LawType::COULOMB_2D, friction}});
}

IncrementalProblem example321()
{
  MatrixXd H(3, 2);
  H << 1, 0, 1, 0, 0, 1;
  return denseProblem(MatrixXd::Identity(2, 2), Eigen::Vector2d(0, 1), H, VectorXd::Zero(3),
                      {{LawType::COULOMB_3D, 1.0}});
}

IncrementalProblem springAndStop(double weight, double stiffness, double height)
{
  return denseProblem(MatrixXd::Constant(1, 1, stiffness), VectorXd::Constant(1, -weight),
                      MatrixXd::Constant(1, 1, -1.0), VectorXd::Constant(1, height), {{LawType::UNILATERAL, 0.0}});
}

IncrementalProblem subsetSumMachine(const std::vector<double>& values, double total)
{
  const auto k = static_cast<Eigen::Index>(values.size());
  const Eigen::Index left = k, right = k + 1, base = k + 2;
  MatrixXd H = MatrixXd::Zero(2 * (k + 2), k + 3);
  VectorXd f = VectorXd::Zero(k + 3), w = VectorXd::Zero(2 * (k + 2));
  for (Eigen::Index i = 0; i < k; ++i)
  {
    H(2 * i, i) = H(2 * i + 1, i) = 1.0;
    H(2 * i + 1, base) = -1.0;
    w[2 * i + 1] = 1.0;
    f[i] = -values[static_cast<size_t>(i)];
  }
  f[base] = 2.0 * total;
  for (const Eigen::Index bar : {left, right})
  {
    H(2 * bar, bar) = H(2 * bar + 1, bar) = 1.0;
    H(2 * bar, base) = bar == left ? 1.0 : -1.0;
    w[2 * bar + 1] = 1.0;
  }
  return denseProblem(MatrixXd::Identity(k + 3, k + 3), f, H, w,
                      std::vector<Law>(static_cast<size_t>(k + 2), Law{LawType::COULOMB_2D, 2.0}));
}

VectorXd subsetSumImpulses(const std::vector<double>& values, const std::vector<bool>& chosen)
{
  VectorXd r = VectorXd::Zero(2 * static_cast<Eigen::Index>(values.size()) + 4);
  for (size_t i = 0; i < values.size(); ++i)
    if (chosen[i])
      r.segment<2>(2 * static_cast<Eigen::Index>(i)) = values[i] * Eigen::Vector2d(1, -2);
  return r;
}

IncrementalProblem squeezedDisc(double speed, double friction)
{
  // Velocities (x, y, spin), radius 1: the lower contact moves with (y, x + spin), the upper with (-y, -x + spin).
  MatrixXd H(4, 3);
  H << 0, 1, 0, 1, 0, 1, 0, -1, 0, -1, 0, 1;
  return denseProblem(Eigen::Vector3d(1, 1, 0.5).asDiagonal(), Eigen::Vector3d(0.2, 0, 0), H,
                      Eigen::Vector4d(0, 0, -speed, 0), std::vector<Law>(2, Law{LawType::COULOMB_2D, friction}));
}

}  // namespace test_support
}  // namespace frictional_contact_sim
