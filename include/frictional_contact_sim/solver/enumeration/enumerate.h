#pragma once
/**
 * @file enumerate.h
 * @brief The enumeration as a method of the registry: ends with the first solution that it meets.
 *
 * A node is an iteration. Where the search comes to its end without a solution the message says that there is none,
 * which no iterative method can. Of a continuum the mean of the vertices of one of its polytopes is returned; the guess
 * plays no part. For all solutions: solver/enumeration/enumeration.h, the tool `enumerate`.
 */
#include "frictional_contact_sim/solver/enumeration/enumeration.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
class Enumerate : public Solver
{
public:
  explicit Enumerate(const EnumerateOptions& options = {});
  OperatorUse operatorUse() const override { return OperatorUse::DENSE; }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  EnumerateOptions options_;
};

}  // namespace frictional_contact_sim
