#include "comparison/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "comparison/isolation.h"

namespace comparison
{
namespace
{
using frictional_contact_sim::DelassusProblem;

constexpr double TIGHTEST = 1e-15;  ///< no tolerance below this is tried
constexpr double LADDER_STEP = 0.31622776601683794;  ///< half a decade
constexpr double SAMPLE_TIME = 2e-4;  ///< [s]
constexpr int MIN_SAMPLES = 3;
constexpr int MAX_BATCH = 200;
constexpr int RETRIES = 3;
constexpr double LEAST_LIMIT = 0.1;  ///< what the give-up factor leaves at least [s]
constexpr double KILL_FACTOR = 1.2;  ///< a process is ended when its solver has used more than its limit by this
constexpr double KILL_MARGIN = 0.02;  ///< [s]
constexpr double QUICK = 0.02;  ///< [s]
constexpr int GIVE_UP = 2;  ///< so many variants of a solver out of time: the others are not tried, unless asked for
/// The compared ones, the first solver and Siconos's quickest, get all samples while a solve is shorter than this [s]:
/// twice what is promised, and twice the quickest, since the search times a solver only a few times.
constexpr double COMPARED_SOLVE = 0.1;
constexpr double NEARLY_QUICKEST = 2.0;

/** What the child of a search leaves behind, one a target. */
struct Finding
{
  bool tried, solved;
  double tolerance, residual, thesis, seconds;
};

/** Mean CPU time of so many solves. @param claimed whether the last one said that it converged */
double timeSolves(Contestant& contestant, double tolerance, int solves, double time_limit, bool& claimed)
{
  contestant.prepare(tolerance, solves, time_limit);
  limitCpuTime(solves * (KILL_FACTOR * time_limit + KILL_MARGIN));
  const double start = cpuTime();
  for (int k = 0; k < solves; ++k)
    claimed = contestant.solve();
  const double seconds = cpuTime() - start - clockOverhead();
  limitCpuTime(0.0);
  return std::max(1e-9, seconds / solves);
}

int batchSize(double seconds)
{
  return std::clamp(static_cast<int>(SAMPLE_TIME / seconds), 1, MAX_BATCH);
}

/** Where the ladder of tolerances starts: above the target for Siconos, whose norms differ from the judge's. */
double firstTolerance(const Target& target, bool ours)
{
  if (target.criterion == Criterion::THESIS)
    return 0.1;
  return ours ? target.value : 100.0 * target.value;
}

void search(const DelassusProblem& problem, const Entry& entry, const MeasureOptions& options, double time_limit,
            Finding* findings)
{
  const std::unique_ptr<Contestant> contestant = entry.make();
  double tolerance = 1.0;
  for (size_t t = 0; t < options.targets.size(); ++t)
  {
    const Target& target = options.targets[t];
    Finding& finding = findings[t];
    const bool other_criterion = t > 0 && target.criterion != options.targets[t - 1].criterion;
    if (other_criterion)
      tolerance = 1.0;
    // What misses the loose target misses the tight one of the same criterion.
    else if (t > 0 && !findings[t - 1].solved)
    {
      finding = findings[t - 1];
      continue;
    }
    bool claimed = true;
    for (tolerance = std::min(tolerance, firstTolerance(target, entry.ours)); claimed && tolerance > TIGHTEST;
         tolerance *= LADDER_STEP)
    {
      finding.tried = true;
      finding.tolerance = tolerance;
      finding.seconds = timeSolves(*contestant, tolerance, 1, time_limit, claimed);
      const Judgement judgement = judge(problem, contestant->impulses());
      finding.residual = judgement.residual;
      finding.thesis = judgement.thesis;
      finding.solved = judgement.meets(target);
      if (finding.solved)
        break;
    }
    // The first solve also pays for what is kept between solves: choose between variants without it.
    const int repeats = batchSize(finding.seconds);
    for (int k = 0; finding.solved && k < RETRIES && finding.seconds < QUICK; ++k)
      finding.seconds =
          std::min(finding.seconds, timeSolves(*contestant, finding.tolerance, repeats, time_limit, claimed));
  }
}

/** Searches one variant and merges what it found into the solver's outcomes. @return out of time */
bool searchVariant(const DelassusProblem& problem, const Entry& entry, const MeasureOptions& options, double limit,
                   std::vector<Outcome*>& outcomes)
{
  const size_t targets = options.targets.size();
  SharedMemory memory(targets * sizeof(Finding));
  auto* findings = memory.as<Finding>();
  if (outcomes.back()->solved())
    limit = std::min(limit, 2.0 * outcomes.back()->seconds + 0.02);
  const Ending ending = runIsolated([&] { search(problem, entry, options, limit, findings); });
  for (size_t t = 0; t < targets; ++t)
  {
    const Finding& finding = findings[t];
    Outcome& outcome = *outcomes[t];
    if (finding.solved && (!outcome.solved() || finding.seconds < outcome.seconds))
    {
      outcome.status = "solved";
      outcome.variant = entry.variant;
      outcome.tolerance = finding.tolerance;
      outcome.judgement = {finding.residual, finding.thesis};
      outcome.seconds = finding.seconds;
      outcome.samples = 1;
    }
    else if (!outcome.solved() && outcome.variant.empty())
    {
      outcome.variant = entry.variant;
      outcome.status = ending == Ending::TIME_LIMIT ? "time limit"
                       : ending == Ending::CRASHED  ? "crashed"
                                                    : "not reached";
      // Our methods keep the time limit themselves and return what they have.
      if (entry.ours && finding.tried && finding.seconds >= 0.9 * limit)
        outcome.status = "time limit";
      outcome.tolerance = finding.tolerance;
      outcome.judgement = {finding.residual, finding.thesis};
      outcome.seconds = finding.seconds;
    }
  }
  return ending == Ending::TIME_LIMIT;
}

const Entry& entryOf(const std::vector<Entry>& entries, const Outcome& outcome)
{
  return *std::find_if(entries.begin(), entries.end(),
                       [&](const Entry& entry)
                       { return entry.solver == outcome.solver && entry.variant == outcome.variant; });
}

struct Runner
{
  std::unique_ptr<Contestant> contestant;
  double tolerance = 0.0;
  int batch = 1;
  double* times = nullptr;
  int* count = nullptr;
  double share = 0.0;  ///< of time for its samples [s]
  double used = 0.0;
};

void sampleRounds(std::vector<Runner>& runners, const MeasureOptions& options)
{
  for (int round = 0; round < options.samples; ++round)
    for (Runner& runner : runners)
    {
      if (runner.used > runner.share && *runner.count >= MIN_SAMPLES)
        continue;
      bool claimed = false;
      const double mean =
          timeSolves(*runner.contestant, runner.tolerance, runner.batch, 10.0 * options.time_limit, claimed);
      runner.used += mean * runner.batch;
      runner.times[(*runner.count)++] = mean;
    }
}

/** Whether an outcome, or one as quick as the search can tell, stands in the table of ratios. */
bool compared(const std::vector<Outcome>& outcomes, size_t k)
{
  double quickest = std::numeric_limits<double>::infinity();
  for (const Outcome& outcome : outcomes)
    if (!outcome.ours && outcome.solved())
      quickest = std::min(quickest, outcome.seconds);
  return k == 0 || (!outcomes[k].ours && outcomes[k].seconds <= NEARLY_QUICKEST * quickest);
}

double median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/** Times all solvers that met one target, in turn in one child process. */
void timeTarget(const std::vector<Entry>& entries, const MeasureOptions& options, std::vector<Outcome>& outcomes)
{
  const auto stride = static_cast<size_t>(options.samples);
  SharedMemory time_memory(outcomes.size() * stride * sizeof(double)), count_memory(outcomes.size() * sizeof(int));
  auto* times = time_memory.as<double>();
  auto* counts = count_memory.as<int>();
  runIsolated(
      [&]
      {
        std::vector<Runner> runners;
        for (size_t k = 0; k < outcomes.size(); ++k)
          if (outcomes[k].solved())
          {
            Runner runner;
            runner.contestant = entryOf(entries, outcomes[k]).make();
            runner.tolerance = outcomes[k].tolerance;
            runner.batch = batchSize(outcomes[k].seconds);
            runner.times = times + k * stride;
            runner.count = counts + k;
            runner.share = options.sampling_time;
            if (compared(outcomes, k) && outcomes[k].seconds < COMPARED_SOLVE)
              runner.share = std::numeric_limits<double>::infinity();
            runners.push_back(std::move(runner));
          }
        sampleRounds(runners, options);
      });
  for (size_t k = 0; k < outcomes.size(); ++k)
    if (counts[k] > 0)
    {
      outcomes[k].samples = counts[k];
      outcomes[k].seconds = median({times + k * stride, times + k * stride + counts[k]});
    }
}
}  // namespace

std::vector<std::vector<Outcome>> measure(const DelassusProblem& problem, const std::vector<Entry>& entries,
                                          const MeasureOptions& options,
                                          const std::function<void(const std::string&)>& progress)
{
  std::vector<std::string> solvers;
  for (const Entry& entry : entries)
    if (std::find(solvers.begin(), solvers.end(), entry.solver) == solvers.end())
      solvers.push_back(entry.solver);
  std::vector<std::vector<Outcome>> table(options.targets.size(), std::vector<Outcome>(solvers.size()));
  double limit = options.time_limit;
  for (size_t s = 0; s < solvers.size(); ++s)
  {
    std::vector<Outcome*> outcomes;
    for (auto& row : table)
      outcomes.push_back(&row[s]);
    int out_of_time = 0;
    for (const Entry& entry : entries)
    {
      const bool hopeless = !options.every_variant && out_of_time >= GIVE_UP && !outcomes.back()->solved();
      if (entry.solver != solvers[s] || hopeless)
        continue;
      progress(entry.solver);
      for (Outcome* outcome : outcomes)
      {
        outcome->solver = entry.solver;
        outcome->ours = entry.ours;
      }
      out_of_time += searchVariant(problem, entry, options, limit, outcomes);
    }
    if (s == 0 && options.give_up_factor > 0.0 && outcomes.back()->solved())
      limit = std::clamp(options.give_up_factor * outcomes.back()->seconds, std::min(LEAST_LIMIT, limit), limit);
  }
  for (size_t t = 0; t < table.size(); ++t)
  {
    progress("timing at " + options.targets[t].label());
    timeTarget(entries, options, table[t]);
  }
  return table;
}

}  // namespace comparison
