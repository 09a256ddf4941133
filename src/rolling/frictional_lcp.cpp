#include "frictional_contact_sim/rolling/frictional_lcp.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
/// Natural-map residual that counts as zero, in units of order one (F_TT^-1 may be 1e3 there).
constexpr double ROUND_OFF = 1e-10;
}  // namespace

const char* toString(NodeState state)
{
  switch (state)
  {
    case NodeState::SEPARATION:
      return "separation";
    case NodeState::STICK:
      return "stick";
    case NodeState::SLIP_RIGHT:
      return "slip_right";
    default:
      return "slip_left";
  }
}

FrictionalLcp::FrictionalLcp(const ContactFlexibility& flexibility, const Eigen::VectorXd& friction)
  : flexibility_(flexibility), friction_(friction)
{
  const Eigen::Index n = flexibility.size();
  if (n == 0)
    throw std::invalid_argument("found no contact nodes, expected at least one");
  if (friction_.size() == 1)
    friction_ = Eigen::VectorXd::Constant(n, friction[0]);
  if (friction_.size() != n || !friction_.allFinite() || friction_.minCoeff() < 0.0)
    throw std::invalid_argument("friction has " + std::to_string(friction.size()) +
                                " values, expected one or one for each contact node, all >= 0");
  const ContactFlexibility& F = flexibility_;
  inverse_TT_ = F.TT.partialPivLu().inverse();
  const Eigen::MatrixXd sticking = inverse_TT_ * F.TN;
  const Eigen::MatrixXd carried = F.NT * inverse_TT_;
  M_.resize(3 * n, 3 * n);
  M_.topLeftCorner(n, n) = F.NN - F.NT * sticking;
  M_.block(0, n, n, n) = carried;
  M_.block(0, 2 * n, n, n) = -carried;
  M_.block(n, 0, n, n) = -sticking;
  M_.block(2 * n, 0, n, n) = sticking;
  M_.block(n, 0, n, n).diagonal() += friction_;
  M_.block(2 * n, 0, n, n).diagonal() += friction_;
  M_.block(n, n, n, n) = inverse_TT_;
  M_.block(2 * n, 2 * n, n, n) = inverse_TT_;
  M_.block(n, 2 * n, n, n) = -inverse_TT_;
  M_.block(2 * n, n, n, n) = -inverse_TT_;

  // Displacements of order one belong to tractions of order 1/unit.
  unit_ = F.NN.cwiseAbs().rowwise().sum().maxCoeff();
  M_scaled_ = M_;
  M_scaled_.topLeftCorner(n, n) /= unit_;
  M_scaled_.bottomRightCorner(2 * n, 2 * n) *= unit_;
}

Eigen::VectorXd FrictionalLcp::vector(const Eigen::VectorXd& d_N, const Eigen::VectorXd& d_T) const
{
  const Eigen::Index n = flexibility_.size();
  if (d_N.size() != n || d_T.size() != n)
    throw std::invalid_argument("rigid displacements have " + std::to_string(d_N.size()) + " and " +
                                std::to_string(d_T.size()) + " entries, expected " + std::to_string(n));
  const Eigen::VectorXd held = inverse_TT_ * d_T;
  Eigen::VectorXd b(3 * n);
  b << d_N - flexibility_.NT * held, -held, held;
  return b;
}

FrictionalContact FrictionalLcp::solve(const Eigen::VectorXd& d_N, const Eigen::VectorXd& d_T,
                                       const std::function<bool()>& interrupted) const
{
  const Eigen::Index n = flexibility_.size();
  Eigen::VectorXd b = vector(d_N, d_T);
  const double largest = std::max(-d_N.minCoeff(), d_T.lpNorm<Eigen::Infinity>());
  const double depth = largest > 0.0 ? largest : 1.0;
  b.head(n) /= depth;
  b.tail(2 * n) *= unit_ / depth;
  LcpOptions options;
  options.interrupted = interrupted;
  const LcpResult lcp = solveLemke(M_scaled_, b, options);

  FrictionalContact contact;
  contact.status = lcp.status;
  contact.pivots = lcp.pivots;
  contact.residual = lcpResidual(M_scaled_, b, lcp.x);
  // Without friction gamma is zero throughout; the path may then end on a ray with the artificial variable at zero. A
  // vanishing natural map proves the answer whatever the path said.
  if (contact.residual <= ROUND_OFF)
    contact.status = LcpStatus::SOLVED;
  else if (contact.status == LcpStatus::SOLVED)
    contact.status = LcpStatus::NUMERICAL_FAILURE;
  contact.r_N = lcp.x.head(n) * (depth / unit_);
  contact.y_N = lcp.y.head(n) * depth;
  contact.y_T = (lcp.x.segment(n, n) - lcp.x.tail(n)) * depth;
  contact.r_T = inverse_TT_ * (contact.y_T - flexibility_.TN * contact.r_N - d_T);
  contact.u_N = flexibility_.NN * contact.r_N + flexibility_.NT * contact.r_T;
  contact.u_T = flexibility_.TN * contact.r_N + flexibility_.TT * contact.r_T;
  contact.P = contact.r_N.dot(flexibility_.width);
  contact.Q = contact.r_T.dot(flexibility_.width);
  contact.states.resize(static_cast<size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const bool touches = lcp.x[i] > lcp.y[i];
    const bool right = lcp.x[n + i] > lcp.y[n + i], left = lcp.x[2 * n + i] > lcp.y[2 * n + i];
    contact.states[static_cast<size_t>(i)] = !touches ? NodeState::SEPARATION
                                             : right  ? NodeState::SLIP_RIGHT
                                             : left   ? NodeState::SLIP_LEFT
                                                      : NodeState::STICK;
  }
  return contact;
}

Eigen::Matrix2d FrictionalLcp::loadDerivative(const FrictionalContact& contact) const
{
  const ContactFlexibility& F = flexibility_;
  std::vector<Eigen::Index> touching, sticking;
  for (Eigen::Index i = 0; i < F.size(); ++i)
  {
    const NodeState state = contact.states[static_cast<size_t>(i)];
    if (state != NodeState::SEPARATION)
      touching.push_back(i);
    if (state == NodeState::STICK)
      sticking.push_back(i);
  }
  const auto c = static_cast<Eigen::Index>(touching.size()), s = static_cast<Eigen::Index>(sticking.size());
  if (c == 0)
    return Eigen::Matrix2d::Zero();
  const auto share = [&](Eigen::Index i) {  // r_T/r_N of a slipping node
    const NodeState state = contact.states[static_cast<size_t>(i)];
    return state == NodeState::SLIP_RIGHT ? -friction_[i] : state == NodeState::SLIP_LEFT ? friction_[i] : 0.0;
  };
  Eigen::MatrixXd A(c + s, c + s);
  for (Eigen::Index k = 0; k < c + s; ++k)
  {
    const Eigen::Index j = k < c ? touching[static_cast<size_t>(k)] : sticking[static_cast<size_t>(k - c)];
    for (Eigen::Index m = 0; m < c + s; ++m)
    {
      const Eigen::Index i = m < c ? touching[static_cast<size_t>(m)] : sticking[static_cast<size_t>(m - c)];
      const double by_N = m < c ? F.NN(i, j) : F.TN(i, j), by_T = m < c ? F.NT(i, j) : F.TT(i, j);
      A(m, k) = k < c ? by_N + share(j) * by_T : by_T;
    }
  }
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(c + s, 2);
  right.col(0).head(c).setConstant(-1.0);
  right.col(1).tail(s).setConstant(-1.0);
  const Eigen::MatrixXd traction = A.partialPivLu().solve(right);
  Eigen::Matrix2d derivative = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < c + s; ++k)
  {
    const Eigen::Index j = k < c ? touching[static_cast<size_t>(k)] : sticking[static_cast<size_t>(k - c)];
    if (k < c)
      derivative.row(0) += F.width[j] * traction.row(k);
    derivative.row(1) += (k < c ? share(j) : 1.0) * F.width[j] * traction.row(k);
  }
  return derivative;
}

LoadedContact solveForLoads(const FrictionalLcp& lcp, const Eigen::VectorXd& gap, const Eigen::VectorXd& d_T0,
                            const LoadTarget& target, double approach_guess, double shift_guess,
                            const std::function<bool()>& interrupted)
{
  if (!(target.P > 0.0))
    throw std::invalid_argument("load P is " + std::to_string(target.P) + ", expected > 0");
  if (!(std::abs(target.Q) < lcp.friction().maxCoeff() * target.P) && target.Q != 0.0)
    throw std::invalid_argument("load Q is " + std::to_string(target.Q) + ", expected less than friction times P = " +
                                std::to_string(lcp.friction().maxCoeff() * target.P) + " in size");
  const auto evaluate = [&](double approach, double shift)
  { return lcp.solve(gap.array() - approach, d_T0.array() + shift, interrupted); };
  const auto error = [&](const FrictionalContact& contact)
  { return Eigen::Vector2d(contact.P - target.P, contact.Q - target.Q); };
  LoadedContact answer;
  answer.approach = approach_guess;
  answer.shift = shift_guess;
  answer.contact = evaluate(answer.approach, answer.shift);
  for (; answer.iterations < target.max_iterations; ++answer.iterations)
  {
    const Eigen::Vector2d missing = error(answer.contact);
    if (answer.contact.status == LcpStatus::SOLVED && missing.lpNorm<Eigen::Infinity>() <= target.tolerance * target.P)
    {
      answer.converged = true;
      break;
    }
    if (answer.contact.status != LcpStatus::SOLVED)
      break;
    Eigen::Matrix2d derivative = lcp.loadDerivative(answer.contact);
    derivative.col(0) *= -1.0;  // d_N = gap - approach
    // Without stick the shift has no say: only the approach is corrected.
    const bool frictional = derivative.col(1).norm() > 1e-12 * derivative.col(0).norm();
    Eigen::Vector2d step = Eigen::Vector2d::Zero();
    if (derivative(0, 0) == 0.0)
      step[0] = gap.minCoeff() - answer.approach + 1e-3 * (gap.maxCoeff() - gap.minCoeff());  // no contact yet
    else if (frictional)
      step = derivative.partialPivLu().solve(-missing);
    else
      step[0] = -missing[0] / derivative(0, 0);
    FrictionalContact trial;
    bool accepted = false;
    for (double factor = 1.0; factor > 1e-4; factor *= 0.5)
    {
      trial = evaluate(answer.approach + factor * step[0], answer.shift + factor * step[1]);
      // Once everything slips the shift has no say any more and there is no way back: such steps are too long.
      const bool keeps_stick =
          !frictional || std::count(trial.states.begin(), trial.states.end(), NodeState::STICK) > 0;
      if (trial.status == LcpStatus::SOLVED && keeps_stick &&
          (derivative(0, 0) == 0.0 || error(trial).norm() < missing.norm()))
      {
        answer.approach += factor * step[0];
        answer.shift += factor * step[1];
        accepted = true;
        break;
      }
    }
    if (!accepted)
      break;
    answer.contact = trial;
  }
  return answer;
}

}  // namespace frictional_contact_sim
