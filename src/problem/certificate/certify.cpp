#include "frictional_contact_sim/problem/certificate/certify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "frictional_contact_sim/problem/certificate/kinematic_islands.h"

namespace frictional_contact_sim
{
namespace
{
template <typename Problem>
IslandCertificate judgeIsland(const Problem& problem, const CertifyOptions& options)
{
  IslandCertificate result;
  ExistenceOptions existence = options.existence;
  existence.velocity_bound = 0.0;
  existence.maximise = false;
  result.existence = checkExistence(problem, existence);
  result.margin = result.existence.margin;
  result.upper_bound = result.existence.upper_bound;
  result.bound = result.existence.velocity_bound;
  if (result.existence.v.size() > 0 && result.existence.margin >= 0.0)
    result.bound = std::max(result.bound, 2.0 * result.existence.v.template lpNorm<Eigen::Infinity>());
  if (options.conditioning)
    result.conditioning = conditioning(problem, options.max_rows);
  if (options.klarbring_pang)
    result.klarbring_pang = klarbringPang(problem);
  return result;
}

template <typename Problem>
void maximiseMargin(const Problem& problem, const CertifyOptions& options, double bound, IslandCertificate& result)
{
  ExistenceOptions existence = options.existence;
  existence.velocity_bound = result.bound = bound;
  existence.maximise = true;
  const ExistenceReport best = checkExistence(problem, existence);
  result.margin = best.margin;
  result.upper_bound = best.upper_bound;
  // A maximum that is found is a certificate as well; what limits it is named where nothing is refuted.
  const bool proves = result.existence.verdict == Existence::UNDECIDED && best.verdict != Existence::UNDECIDED;
  if (proves || (best.verdict == Existence::CERTIFIED && best.exact && !result.existence.exact))
    result.existence = best;
  else if (result.existence.verdict != Existence::REFUTED)
  {
    result.existence.blocking = best.blocking;
    result.existence.blocking_bilaterals = best.blocking_bilaterals;
  }
}

/** The island's numbers of laws and bilateral rows as those of the whole problem. */
void renumber(const std::vector<int>& names, std::vector<int>& indices)
{
  for (int& index : indices)
    index = names[static_cast<size_t>(index)];
}

/** BILATERAL laws first, then rows of G, as ExistenceReport::bilateral_multiplier has them. */
void addMultipliers(const std::vector<Law>& laws, const IslandCertificate& island, Certificate& result)
{
  const ExistenceReport& report = island.existence;
  std::vector<int> first;
  int row = 0;
  for (const Law& law : laws)
  {
    first.push_back(row);
    row += law.dimension();
  }
  Eigen::Index own = 0;
  Eigen::Index bilateral = 0;
  for (const int index : island.laws)
  {
    const Law& law = laws[static_cast<size_t>(index)];
    const int target = first[static_cast<size_t>(index)];
    if (law.type == LawType::BILATERAL)
      result.multiplier[target] = report.bilateral_multiplier[bilateral++];
    else
      result.multiplier.segment(target, law.dimension()) = report.multiplier.segment(own, law.dimension());
    own += law.dimension();
  }
  for (const int k : island.bilaterals)
    result.bilateral_multiplier[k] = report.bilateral_multiplier[bilateral++];
}

void addConditioning(const Conditioning& island, Certificate& result)
{
  result.rows += island.rows;
  if (!island.computed() || result.rank < 0)
  {
    result.rank = -1;
    result.condition = 0.0;
    return;
  }
  result.rank += island.rank;
  result.condition = std::max(result.condition, island.condition);
}

std::string describe(const Certificate& certificate, const IslandCertificate* worst)
{
  if (worst == nullptr)
    return "no contact and no other row: nothing restricts the velocities";
  if (certificate.existence == Existence::CERTIFIED)
  {
    for (const IslandCertificate& island : certificate.islands)
      if (!island.existence.exact)
        return "a solution exists: " + island.existence.message;
    return "a solution exists: a velocity keeps every contact in its dual cone";
  }
  return worst->existence.message;
}

template <typename Problem>
Certificate certifyAll(const Problem& problem, const CertifyOptions& options, int columns, int rows, int bilaterals)
{
  const auto start = std::chrono::steady_clock::now();
  validate(problem);
  options.validate();
  Certificate result;
  result.unconditional = options.klarbring_pang;
  result.v.setZero(columns);
  result.margin = std::numeric_limits<double>::infinity();
  int worst = -1;
  auto parts = kinematicIslands(problem);
  std::vector<IslandCertificate> judged;
  double bound = options.bound;  // one R for all islands, so that their margins compare
  for (const auto& part : parts)
  {
    judged.push_back(judgeIsland(part.problem, options));
    if (options.bound == 0.0)
      bound = std::max(bound, judged.back().bound);
  }
  for (size_t i = 0; i < parts.size(); ++i)
  {
    auto& part = parts[i];
    IslandCertificate& island = judged[i];
    if (options.margin && !part.problem.laws.empty())
      maximiseMargin(part.problem, options, bound, island);
    island.laws = std::move(part.laws);
    island.bilaterals = std::move(part.bilaterals);
    island.velocities = std::move(part.velocities);
    renumber(island.laws, island.existence.blocking);
    renumber(island.bilaterals, island.existence.blocking_bilaterals);
    for (size_t j = 0; j < island.velocities.size(); ++j)
      result.v[island.velocities[j]] = island.existence.v[static_cast<Eigen::Index>(j)];
    addConditioning(island.conditioning, result);
    result.exact = result.exact && island.existence.exact;
    result.unconditional = result.unconditional && island.klarbring_pang.unconditional;
    const auto graver = [](Existence a, Existence b)
    {
      const auto rank = [](Existence e) { return e == Existence::REFUTED ? 2 : e == Existence::UNDECIDED ? 1 : 0; };
      return rank(a) > rank(b);
    };
    const bool same = island.existence.verdict == result.existence;
    if (worst < 0 || graver(island.existence.verdict, result.existence) || (same && island.margin < result.margin))
      worst = static_cast<int>(result.islands.size());
    if (graver(island.existence.verdict, result.existence))
      result.existence = island.existence.verdict;
    if (island.margin < result.margin)
    {
      result.margin = island.margin;
      result.bound = island.bound;
      result.limiting = island.existence.blocking;
    }
    result.islands.push_back(std::move(island));
  }
  const IslandCertificate* decisive = worst >= 0 ? &result.islands[static_cast<size_t>(worst)] : nullptr;
  if (!options.conditioning)
    result.rank = -1;
  if (result.existence != Existence::CERTIFIED)
    result.v.resize(0);
  if (result.existence == Existence::REFUTED)
  {
    result.blocking = decisive->existence.blocking;
    result.blocking_bilaterals = decisive->existence.blocking_bilaterals;
    result.multiplier.setZero(rows);
    result.bilateral_multiplier.setZero(bilaterals);
    addMultipliers(problem.laws, *decisive, result);
  }
  if (!std::isfinite(result.margin))
    result.margin = 0.0;
  result.message = describe(result, decisive);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}
}  // namespace

void CertifyOptions::validate() const
{
  if (!(std::isfinite(bound) && bound >= 0.0))
    throw std::invalid_argument("certify: bound is " + std::to_string(bound) + ", expected >= 0");
  if (max_rows < 0)
    throw std::invalid_argument("certify: max_rows is " + std::to_string(max_rows) + ", expected >= 0");
  existence.validate();
}

Certificate certify(const IncrementalProblem& problem, const CertifyOptions& options)
{
  return certifyAll(problem, options, problem.velocities(), problem.rows(), problem.bilaterals());
}

Certificate certify(const DelassusProblem& problem, const CertifyOptions& options)
{
  return certifyAll(problem, options, problem.W.rows(), problem.W.rows(), 0);
}

}  // namespace frictional_contact_sim
