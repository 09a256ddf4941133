#pragma once
/**
 * @file contestant.h
 * @brief One way to solve a local problem u = W r + q, ours or Siconos's, behind one face for the stop watch.
 *
 * A contestant copies the problem into its own native form when it is made. prepare() sets its tolerance and is not
 * timed; solve() starts from r = 0 and is timed.
 */
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"

namespace comparison
{
class Contestant
{
public:
  virtual ~Contestant() = default;
  /**
   * @brief For the next `solves` calls of solve().
   * @param tolerance in each side's own norm
   * @param time_limit [s]; Siconos has none, its process is ended from outside
   */
  virtual void prepare(double tolerance, int solves, double time_limit) = 0;
  /** @brief Solves from r = 0. @return whether the solver itself says that it converged */
  virtual bool solve() = 0;
  /** @brief Impulses of the last solve(). */
  virtual const Eigen::VectorXd& impulses() const = 0;
};

/** @brief A contestant before it is made. Making it may crash (Siconos), so only a child process does it. */
struct Entry
{
  std::string solver;  ///< name in the tables
  std::string variant;  ///< storage and options; the quickest variant of a solver stands for it
  bool ours = false;
  std::function<std::unique_ptr<Contestant>()> make;
};

/** @brief A method of our registry. @throws std::invalid_argument on an unknown name */
Entry ourEntry(const frictional_contact_sim::DelassusProblem& problem, const std::string& solver);

/**
 * @brief Our methods without what the thesis does not have: what our departures from it are worth.
 *   thesis AC      no proximal term: plain semismooth Newton with line search
 *   thesis DS      the step length stays 1/lambda_max(W_ii)
 *   thesis H-pf    inner projected gradient in the plain metric, at most 250 iterations (its table 5.6)
 *   thesis NA-pf   the same, starting from s = 0
 */
std::vector<Entry> thesisEntries(const frictional_contact_sim::DelassusProblem& problem);

/**
 * @brief All variants of Siconos's solvers for a problem of 2D or 3D Coulomb contacts; none for other laws.
 * @param names keep only these; empty = all
 */
std::vector<Entry> siconosEntries(const frictional_contact_sim::DelassusProblem& problem,
                                  const std::vector<std::string>& names);

}  // namespace comparison
