#include "frictional_contact_sim/rolling/rolling_motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
/// Tangential tractions below this share of the largest pressure are none: what settles without friction is round-off.
constexpr double FRICTIONLESS = 1e-6;

/// Spacing of equally spaced nodes. Chords of a small arc differ in x by its second order, which is allowed for.
double spacing(const Eigen::VectorXd& x)
{
  const Eigen::Index n = x.size();
  if (n < 3)
    throw std::invalid_argument("rolling: found " + std::to_string(n) + " contact nodes, expected at least 3");
  const double h = (x[n - 1] - x[0]) / static_cast<double>(n - 1);
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    if (!(std::abs(x[i + 1] - x[i] - h) < 0.02 * h))
      throw std::invalid_argument("rolling: nodes " + std::to_string(i) + " and " + std::to_string(i + 1) + " are " +
                                  std::to_string(x[i + 1] - x[i]) + " m apart, expected equal spacings of " +
                                  std::to_string(h) + " m");
  return h;
}

/// Values of the next node to the right; the rightmost node, out of contact, keeps its own.
Eigen::VectorXd fromTheRight(const Eigen::VectorXd& u)
{
  Eigen::VectorXd shifted(u.size());
  shifted << u.tail(u.size() - 1), u[u.size() - 1];
  return shifted;
}

void requireFreeLeadingNode(const FrictionalContact& contact)
{
  if (contact.status == LcpStatus::SOLVED && contact.states.back() != NodeState::SEPARATION)
    throw std::invalid_argument("rolling: the rightmost contact node touches, expected a wider potential contact zone");
}

/// One solution at the given approach, or with the approach adjusted to the load when that is positive.
/// A load that is not met is a NUMERICAL_FAILURE.
FrictionalContact solveStep(const FrictionalLcp& lcp, const Eigen::VectorXd& gap, const Eigen::VectorXd& d_T,
                            const RollingOptions& options, double& approach)
{
  if (!(options.load > 0.0))
    return lcp.solve(gap.array() - approach, d_T, options.interrupted);
  constexpr int MAX_CORRECTIONS = 30;
  constexpr double LOAD_TOLERANCE = 1e-10;
  FrictionalContact contact;
  for (int i = 0; i < MAX_CORRECTIONS; ++i)
  {
    contact = lcp.solve(gap.array() - approach, d_T, options.interrupted);
    const double missing = options.load - contact.P;
    const double slope = -lcp.loadDerivative(contact)(0, 0);
    if (contact.status != LcpStatus::SOLVED || std::abs(missing) <= LOAD_TOLERANCE * options.load)
      return contact;
    if (!(slope > 0.0))
      break;
    approach += missing / slope;
  }
  contact.status = LcpStatus::NUMERICAL_FAILURE;
  return contact;
}
}  // namespace

Eigen::VectorXd slipVelocity(const Eigen::VectorXd& x, const Eigen::VectorXd& u_T, double creepage, double direction)
{
  const Eigen::Index n = x.size();
  if (n < 2 || u_T.size() != n)
    throw std::invalid_argument("slip velocity: found " + std::to_string(n) + " nodes and " +
                                std::to_string(u_T.size()) + " displacements, expected at least 2 and as many");
  Eigen::VectorXd slip(n);
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    slip[i] = creepage + direction * (u_T[i + 1] - u_T[i]) / (x[i + 1] - x[i]);
  slip[n - 1] = slip[n - 2];
  return slip;
}

RollingResult roll(const FrictionalLcp& lcp, const Eigen::VectorXd& gap, double approach, const Eigen::VectorXd& u_T0,
                   double creepage, const RollingOptions& options)
{
  const double h = spacing(lcp.flexibility().x);
  RollingResult result;
  result.approach = approach;
  Eigen::VectorXd u_T = u_T0;
  Eigen::VectorXd last = Eigen::VectorXd::Zero(u_T.size());
  while (result.steps < options.max_steps && !(options.interrupted && options.interrupted()))
  {
    const Eigen::VectorXd d_T = creepage * h - fromTheRight(u_T).array();
    result.contact = solveStep(lcp, gap, d_T, options, result.approach);
    if (result.contact.status != LcpStatus::SOLVED)
      break;
    requireFreeLeadingNode(result.contact);
    u_T = result.contact.u_T;
    result.history.push_back(result.contact.Q);
    ++result.steps;
    const double limit = std::max((lcp.friction().array() * result.contact.r_N.array()).maxCoeff(),
                                  FRICTIONLESS * result.contact.r_N.maxCoeff());
    const double change = (result.contact.r_T - last).lpNorm<Eigen::Infinity>();
    last = result.contact.r_T;
    if (options.progress)
      options.progress(result.steps, limit > 0.0 ? change / limit : 0.0);
    // The first step compares with nothing.
    if (result.steps > 1 && change <= options.steady_tolerance * limit)
    {
      result.steady = true;
      break;
    }
  }
  result.slip = result.contact.y_T / h;
  return result;
}

RollingResult rollSteadily(const ContactFlexibility& flexibility, double friction, const Eigen::VectorXd& gap,
                           double approach, double creepage, const RollingOptions& options)
{
  const double h = spacing(flexibility.x);
  const Eigen::Index n = flexibility.size();
  ContactFlexibility moving = flexibility;
  moving.TN.topRows(n - 1) -= flexibility.TN.bottomRows(n - 1);
  moving.TT.topRows(n - 1) -= flexibility.TT.bottomRows(n - 1);
  const FrictionalLcp lcp(moving, Eigen::VectorXd::Constant(1, friction));
  RollingResult result;
  result.approach = approach;
  result.contact = solveStep(lcp, gap, Eigen::VectorXd::Constant(n, creepage * h), options, result.approach);
  requireFreeLeadingNode(result.contact);
  result.contact.u_T = flexibility.TN * result.contact.r_N + flexibility.TT * result.contact.r_T;
  result.slip = result.contact.y_T / h;
  result.steady = result.contact.status == LcpStatus::SOLVED;
  result.steps = 1;
  result.history.push_back(result.contact.Q);
  return result;
}

}  // namespace frictional_contact_sim
