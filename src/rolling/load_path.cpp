#include "frictional_contact_sim/rolling/load_path.h"

namespace frictional_contact_sim
{
std::vector<LoadStep> followLoads(const FrictionalLcp& lcp, const Eigen::VectorXd& gap,
                                  const std::vector<LoadTarget>& targets, double approach_guess,
                                  const std::function<bool()>& interrupted)
{
  std::vector<LoadStep> steps;
  Eigen::VectorXd u_T = Eigen::VectorXd::Zero(gap.size());
  double approach = approach_guess;
  double shift = 0.0;
  for (const LoadTarget& target : targets)
  {
    LoadStep step;
    step.answer = solveForLoads(lcp, gap, -u_T, target, approach, 0.0, interrupted);
    const FrictionalContact& contact = step.answer.contact;
    approach = step.answer.approach;
    shift += step.answer.shift;
    step.answer.shift = shift;
    step.dissipated = -(lcp.flexibility().width.array() * contact.r_T.array() * contact.y_T.array()).sum();
    u_T = contact.u_T;
    steps.push_back(step);
    if (!step.answer.converged)
      break;
  }
  return steps;
}

}  // namespace frictional_contact_sim
