#pragma once
// The solves of a step: the scenario's method, the energy check on its answer, other methods before it is given up.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/failure.h"
#include "frictional_contact_sim/solver/least_norm.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
/** Finite, and slower than anything that moves. */
bool isMotion(const Solution& solution);

/** Of the size of the problem; v is not a number, so that nobody takes it for an answer. */
void setNoAnswer(const IncrementalProblem& problem, SolverStatus status, const std::string& message,
                 SolverResult& result);

class StepSolver
{
public:
  StepSolver(std::unique_ptr<Solver> method, const StoppingOptions& stopping, const FailureOptions& options);
  void setMethod(std::unique_ptr<Solver> method);
  /** @throws std::invalid_argument naming the field; nothing has changed then */
  void setStopping(const StoppingOptions& stopping);
  void setStop(const std::atomic<bool>* stop);
  void setOptions(const FailureOptions& options);

  /** Once a step or impact: the clock of the time limit runs from here on, and other methods may be tried again. */
  void begin();
  /**
   * Nothing is thrown. CONVERGED with residual and energy within their bounds, or the best iterate of all methods tried
   * and why it is none.
   * @param is_last_resort other methods are tried where the first has no answer
   * @param is_doubtful there may be no answer: a tenth of the iterations
   */
  void solve(const IncrementalProblem& problem, const Solution& guess, bool is_last_resort, bool is_doubtful,
             SolverResult& result);
  /** Of a CONVERGED answer to the problem solved last: the impulses that its loads ask for (solver/least_norm.h). */
  void takeLeastNorm(const IncrementalProblem& problem, SolverResult& result);

private:
  void run(Solver& method, const IncrementalProblem& problem, const Solution* guess, SolverResult& result);
  bool mayTryOthers(const SolverResult& result) const;
  void tryOthers(const IncrementalProblem& problem, SolverResult& result);
  bool betterThan(const IncrementalProblem& problem, const SolverResult& a, const SolverResult& b) const;

  std::unique_ptr<Solver> method_;
  Solver* answered_ = nullptr;  ///< the method that ran last
  Solver* helper_ = nullptr;  ///< the one of the others that has answered in this step
  int iterations_ = 0;  ///< of all solves of this step
  double seconds_ = 0.0;
  std::vector<std::string> tried_;
  LeastNorm least_norm_;
  Eigen::VectorXd thresholds_;
  std::vector<std::unique_ptr<Solver>> others_;  ///< made when first needed, in the order of the list
  StoppingOptions stopping_;
  FailureOptions options_;
  SolverResult attempt_;
  std::chrono::steady_clock::time_point start_;
  bool others_tried_ = false;  ///< in this step
};
}  // namespace frictional_contact_sim
