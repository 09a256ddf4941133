#include "comparison/results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace comparison
{
namespace
{
std::string duration(double seconds)
{
  char text[32];
  const char* unit = seconds < 1e-3 ? "us" : seconds < 1.0 ? "ms" : "s";
  std::snprintf(text, sizeof(text), "%.3g %s",
                seconds < 1e-3  ? 1e6 * seconds
                : seconds < 1.0 ? 1e3 * seconds
                                : seconds,
                unit);
  return text;
}
}  // namespace

CsvTable::CsvTable(const std::string& path) : file_(path)
{
  if (!file_)
    throw std::runtime_error(path + ": cannot be written");
  file_ << "problem,kind,dimension,contacts,rows,bilaterals,rank,solver,variant,ours,target,tolerance,status,residual,"
           "thesis,"
           "seconds,samples\n";
}

void CsvTable::add(const ProblemFacts& facts, const Target& target, const Outcome& outcome)
{
  file_ << facts.name << ',' << facts.kind << ',' << facts.dimension << ',' << facts.contacts << ',' << facts.rows
        << ',' << facts.bilaterals << ',' << facts.rank << ',' << outcome.solver << ",\"" << outcome.variant << "\","
        << (outcome.ours ? 1 : 0) << ',' << target.label() << ',' << outcome.tolerance << ',' << outcome.status << ','
        << outcome.judgement.residual << ',' << outcome.judgement.thesis << ',' << outcome.seconds << ','
        << outcome.samples << std::endl;
}

RatioTable::RatioTable(const Target& target, const std::string& reference)
  : target_(target.label()), reference_(reference)
{
}

void RatioTable::add(const ProblemFacts& facts, const std::vector<Outcome>& outcomes)
{
  const Outcome *ours = nullptr, *best = nullptr;
  for (const Outcome& outcome : outcomes)
  {
    if (!outcome.solved())
      continue;
    if (outcome.ours && outcome.solver == reference_)
      ours = &outcome;
    if (!outcome.ours && (best == nullptr || outcome.seconds < best->seconds))
      best = &outcome;
  }
  char line[256];
  char ratio[32] = "-";
  if (ours != nullptr && best != nullptr)
  {
    ratios_.push_back(best->seconds / ours->seconds);
    std::snprintf(ratio, sizeof(ratio), "%.2f", ratios_.back());
  }
  only_ours_ += ours != nullptr && best == nullptr;
  only_theirs_ += ours == nullptr && best != nullptr;
  const std::string theirs = best != nullptr ? best->solver + " (" + best->variant + ")" : "none";
  std::snprintf(line, sizeof(line), "%-42s %8d %10s %10s %8s  %s", facts.name.c_str(), facts.contacts,
                ours != nullptr ? duration(ours->seconds).c_str() : "unsolved",
                best != nullptr ? duration(best->seconds).c_str() : "-", ratio, theirs.c_str());
  lines_.push_back(line);
}

void RatioTable::print() const
{
  std::printf("\ntarget %s: CPU time of a cold solve, %s and the best Siconos solver\n%-42s %8s %10s %10s %8s  %s\n",
              target_.c_str(), reference_.c_str(), "problem", "contacts", "ours", "siconos", "ratio", "which");
  for (const std::string& line : lines_)
    std::printf("%s\n", line.c_str());
  double logarithms = 0.0;
  for (const double ratio : ratios_)
    logarithms += std::log(ratio);
  if (!ratios_.empty())
    std::printf("geometric mean %.2f, least %.2f, over %zu problems both solve\n",
                std::exp(logarithms / static_cast<double>(ratios_.size())),
                *std::min_element(ratios_.begin(), ratios_.end()), ratios_.size());
  std::printf("solved by %s only: %d, by Siconos only: %d\n", reference_.c_str(), only_ours_, only_theirs_);
}

}  // namespace comparison
