#pragma once
/**
 * @file measure.h
 * @brief Finds for every contestant the loosest tolerance at which the judge is content, then times all of them.
 *
 * Search, one child process a variant: tolerances are tightened by half decades until the judge's criterion holds. Of a
 * solver's variants (storages, linear solvers) the quickest stands for it.
 * Timing, one child process a problem and target: rounds in which every solver solves once from r = 0, in order. A
 * sample is the mean of as many solves as last 0.2 ms (a solve of 2 us is no sample), the result the median of the
 * samples. A solver leaves the rounds when it has used its share of time; the first solver and the quickest of
 * Siconos's, whose ratio is reported, get all samples as long as a solve lasts less than 50 ms.
 */
#include <functional>
#include <string>
#include <vector>

#include "comparison/contestant.h"
#include "comparison/judge.h"

namespace comparison
{
struct MeasureOptions
{
  std::vector<Target> targets;  ///< loose first
  double time_limit = 3.0;  ///< CPU time of a solve [s]
  double give_up_factor =
      0.0;  ///< a solve may last so many times the first solver's at the tightest target; 0: no rule
  bool every_variant = false;  ///< also where two variants of a solver ran out of time
  int samples = 21;
  double sampling_time = 1.0;  ///< CPU time a solver may use for its samples [s]; at least 3 are taken
};

struct Outcome
{
  std::string solver, variant;
  bool ours = false;
  std::string status = "not reached";  ///< solved, not reached, time limit, crashed
  double tolerance = 0.0;  ///< the solver's own
  Judgement judgement;
  double seconds = 0.0;  ///< median of samples
  int samples = 0;

  bool solved() const { return status == "solved"; }
};

/**
 * @param progress called with a line of text as work goes on
 * @return one row of outcomes a target, one outcome a solver, in the order of the entries
 */
std::vector<std::vector<Outcome>> measure(const frictional_contact_sim::DelassusProblem& problem,
                                          const std::vector<Entry>& entries, const MeasureOptions& options,
                                          const std::function<void(const std::string&)>& progress);

}  // namespace comparison
