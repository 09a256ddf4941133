#include "frictional_contact_sim/solver/enumeration/enumeration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/existence.h"
#include "frictional_contact_sim/problem/islands.h"
#include "frictional_contact_sim/problem/residual.h"
#include "island_product.h"

namespace frictional_contact_sim
{
namespace
{
/// Velocities and impulses that differ by less, relative to the largest, are the same.
constexpr double SAME = 1e-6;
/// G v + b above this share of its terms: redundant bilateral rows that contradict each other.
constexpr double CONTRADICTION = 1e-8;

std::vector<IslandPart> split(const DelassusProblem& problem)
{
  Islands islands;
  const int count = std::max(islands.find(problem.W), problem.laws.empty() ? 0 : 1);
  std::vector<IslandPart> parts(static_cast<size_t>(count));
  for (int k = 0; k < count; ++k)
  {
    IslandPart& part = parts[static_cast<size_t>(k)];
    if (count > 1)
      islands.laws(k, part.laws);
    else
    {
      part.laws.resize(problem.laws.size());
      std::iota(part.laws.begin(), part.laws.end(), 0);
    }
    for (const int law : part.laws)
      for (int i = 0; i < problem.laws[static_cast<size_t>(law)].dimension(); ++i)
        part.rows.push_back(problem.W.offset(law) + i);
  }
  return parts;
}

/// The same vector up to SAME, relative to `size`.
bool isSame(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double size)
{
  return a.size() == 0 || (a - b).lpNorm<Eigen::Infinity>() <= SAME * size;
}

/// Velocities that are one, within families and among them, and laws whose impulses are.
void compare(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws, IslandPart& part,
             std::vector<int>& unique_impulses)
{
  const Eigen::VectorXd* first = nullptr;
  Eigen::VectorXd u_first;
  double speed = q.size() == 0 ? 0.0 : q.lpNorm<Eigen::Infinity>(), size = 0.0;
  for (const IslandFamily& family : part.solutions.families)
    for (const SolutionPiece& piece : family.pieces)
      for (const Eigen::VectorXd& r : piece.vertices)
      {
        first = first == nullptr ? &r : first;
        size = std::max(size, r.size() == 0 ? 0.0 : r.lpNorm<Eigen::Infinity>());
        speed = std::max(speed, r.size() == 0 ? 0.0 : (W * r + q).lpNorm<Eigen::Infinity>());
      }
  if (first == nullptr)
    return;
  speed = std::max(speed, std::numeric_limits<double>::min());
  size = std::max(size, std::numeric_limits<double>::min());
  u_first = W * *first + q;
  std::vector<bool> same_impulse(laws.size(), true);
  const auto look = [&](const Eigen::VectorXd& r, const Eigen::VectorXd& reference)
  {
    int row = 0;
    for (size_t i = 0; i < laws.size(); row += laws[i++].dimension())
      same_impulse[i] = same_impulse[i] &&
                        isSame(r.segment(row, laws[i].dimension()), reference.segment(row, laws[i].dimension()), size);
  };
  for (const IslandFamily& family : part.solutions.families)
  {
    const Eigen::VectorXd u_family = W * family.pieces.front().vertices.front() + q;
    bool unique = true;
    for (const SolutionPiece& piece : family.pieces)
    {
      for (const Eigen::VectorXd& r : piece.vertices)
      {
        unique = unique && isSame(W * r + q, u_family, speed);
        look(r, *first);
      }
      for (const Eigen::VectorXd& ray : piece.rays)
      {
        const double length = ray.lpNorm<Eigen::Infinity>();
        unique = unique && isSame(W * ray, Eigen::VectorXd::Zero(q.size()), W.cwiseAbs().maxCoeff() * length);
        look(size / length * ray, Eigen::VectorXd::Zero(ray.size()));
      }
      unique = unique && piece.unique_velocity;
      for (size_t i = 0; i < laws.size() && !piece.vertices_complete; ++i)  // one point of a set that is not listed
        same_impulse[i] = same_impulse[i] && piece.modes[i] == LawMode::OPEN;
    }
    part.unique_velocity.push_back(unique);
    part.one_velocity = part.one_velocity && unique && isSame(u_family, u_first, speed);
  }
  for (size_t i = 0; i < laws.size(); ++i)
    if (same_impulse[i])
      unique_impulses.push_back(part.laws[i]);
}

std::vector<int> jammingContacts(const DelassusProblem& problem)
{
  std::vector<int> laws;
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const Law& law = problem.laws[i];
    const auto block = static_cast<int>(i);
    const auto jams = [&](double normal, double coupling) { return normal < law.coefficient * coupling; };
    if ((law.type == LawType::COULOMB_2D &&
         jams(problem.W.diagonalBlock<2>(block)(0, 0), std::abs(problem.W.diagonalBlock<2>(block)(0, 1)))) ||
        (law.type == LawType::COULOMB_3D &&
         jams(problem.W.diagonalBlock<3>(block)(0, 0), problem.W.diagonalBlock<3>(block).row(0).tail<2>().norm())))
      laws.push_back(block);
  }
  return laws;
}

int clamped(double count)
{
  return static_cast<int>(std::min(count, static_cast<double>(std::numeric_limits<int>::max())));
}

std::string plural(double count, const std::string& noun)
{
  return std::to_string(clamped(count)) + " " + noun + (count == 1.0 ? "" : "s");
}

void setVerdicts(const std::vector<IslandPart>& parts, EnumerationReport& report)
{
  double isolated = 1.0, all = 1.0;
  bool none = false;
  report.complete = true;
  report.unique_velocity = true;
  for (const IslandPart& part : parts)
  {
    const IslandSolutions& solutions = part.solutions;
    isolated *= static_cast<double>(std::count_if(solutions.families.begin(), solutions.families.end(),
                                                  [](const IslandFamily& family) { return family.isolated(); }));
    all *= static_cast<double>(solutions.families.size());
    none = none || (solutions.complete && solutions.families.empty());
    report.complete = report.complete && solutions.complete;
    report.unique_velocity = report.unique_velocity && part.one_velocity;
    report.nodes += solutions.nodes;
    report.leaves += solutions.leaves;
    report.cuts += solutions.cuts;
    report.unresolved += solutions.unresolved;
  }
  report.complete = report.complete || none;  // one island without solutions is enough
  report.solutions = clamped(isolated);
  report.continua = clamped(all - isolated);
  report.unique_velocity = report.unique_velocity && all > 0.0;
  if (all > 0.0 && report.unique_velocity && report.complete)
    report.uniqueness = Uniqueness::UNIQUE_V;
  else if (all > 0.0 && !report.unique_velocity)
    report.uniqueness = Uniqueness::MULTIPLE;
}

/// Whether something other than friction forbids every solution: penetration that no velocity avoids.
template <typename Problem>
bool mustPenetrate(const Problem& problem)
{
  return checkExistence(problem).verdict == Existence::REFUTED;
}

template <typename Problem>
void diagnose(const Problem& problem, bool consistent, EnumerationReport& report)
{
  const bool none = report.complete && report.solutions + report.continua == 0;
  if (!consistent)
    report.diagnosis = "BILATERALS_CONTRADICT";
  else if (none)
    report.diagnosis = mustPenetrate(problem) ? "PENETRATION" : "PAINLEVE_INCONSISTENT";
  else if (report.uniqueness == Uniqueness::MULTIPLE)
    report.diagnosis = report.jamming.empty() ? "INDETERMINATE" : "PAINLEVE_INDETERMINATE";
  else
    report.diagnosis = "NONE";
  if (!report.message.empty())
    return;
  if (report.diagnosis == "BILATERALS_CONTRADICT")
    report.message = "no solution: bilateral rows contradict each other";
  else if (report.diagnosis == "PENETRATION")
    report.message = "no solution: no velocity avoids penetration";
  else if (report.diagnosis == "PAINLEVE_INCONSISTENT")
    report.message = "no solution although the bodies can part: Painleve's paradox, an impact without collision";
  else
  {
    report.message = plural(report.solutions, "isolated solution") + ", " +
                     (report.continua == 1 ? "1 continuum" : std::to_string(report.continua) + " continua");
    if (report.diagnosis == "PAINLEVE_INDETERMINATE")
      report.message += ", different velocities: Painleve's paradox, indeterminate";
    if (!report.complete)
      report.message += ", and perhaps more: " +
                        (report.unresolved > 0 ? plural(static_cast<double>(report.unresolved), "unresolved node")
                                               : std::string("the search was cut short"));
  }
}

/// Everything but the diagnosis. @return bilateral rows are consistent
bool search(const DelassusProblem& problem, const EnumerateOptions& options, const std::function<bool()>& interrupted,
            EnumerationReport& report)
{
  const Eigen::MatrixXd W = problem.W.toDense();
  std::vector<IslandPart> parts = split(problem);
  std::vector<SolutionFamily> families(1);
  SolutionPiece& empty = families.front().pieces.emplace_back();
  empty.modes.assign(problem.laws.size(), LawMode::UNDECIDED);
  empty.vertices.emplace_back(Eigen::VectorXd::Zero(problem.q.size()));
  bool consistent = true;
  for (IslandPart& part : parts)
  {
    const auto size = static_cast<Eigen::Index>(part.rows.size());
    if (size > options.max_rows)
    {
      report.message =
          "an island has " + std::to_string(size) + " rows, max_rows is " + std::to_string(options.max_rows);
      continue;
    }
    Eigen::MatrixXd block(size, size);
    Eigen::VectorXd q(size);
    std::vector<Law> laws;
    for (Eigen::Index i = 0; i < size; ++i)
    {
      q[i] = problem.q[part.rows[static_cast<size_t>(i)]];
      for (Eigen::Index j = 0; j < size; ++j)
        block(i, j) = W(part.rows[static_cast<size_t>(i)], part.rows[static_cast<size_t>(j)]);
    }
    for (const int law : part.laws)
      laws.push_back(problem.laws[static_cast<size_t>(law)]);
    part.solutions = enumerateIsland(block, q, laws, options, false, interrupted);
    consistent = consistent && part.solutions.consistent;
    compare(block, q, laws, part, report.unique_impulses);
    families = product(families, part, problem.laws.size(), problem.q.size(), options);
  }
  setVerdicts(parts, report);
  if (report.solutions + report.continua > 0)
    report.families = std::move(families);
  else
    report.unique_impulses.clear();
  std::stable_sort(report.families.begin(), report.families.end(),
                   [](const SolutionFamily& a, const SolutionFamily& b)
                   { return (a.dimension == 0) > (b.dimension == 0); });
  std::sort(report.unique_impulses.begin(), report.unique_impulses.end());
  for (SolutionFamily& family : report.families)
  {
    family.representative.r = middle(family.pieces.front());
    family.representative.u = W * family.representative.r + problem.q;
  }
  report.jamming = jammingContacts(problem);
  return consistent;
}

class Clock
{
public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::function<bool()> deadline(const Clock& clock, double limit, const std::function<bool()>& interrupted)
{
  return [&clock, limit, interrupted]
  { return (interrupted && interrupted()) || (limit > 0.0 && clock.seconds() > limit); };
}

/// Redundant rows G v + b = 0 that no v satisfies.
bool contradict(const IncrementalProblem& problem, DelassusReduction& reduction)
{
  if (problem.bilaterals() == 0)
    return false;
  Solution solution;
  solution.r.setZero(problem.rows());
  reduction.recover(problem, solution);
  const Eigen::VectorXd defect = problem.G * solution.v + problem.b;
  double size = maxAbs(problem.b);
  for (int i = 0; i < problem.G.outerSize(); ++i)
    for (SparseRows::InnerIterator entry(problem.G, i); entry; ++entry)
      size = std::max(size, std::abs(entry.value() * solution.v[entry.col()]));
  return maxAbs(defect) > CONTRADICTION * size;
}
}  // namespace

const char* toString(LawMode mode)
{
  switch (mode)
  {
    case LawMode::UNDECIDED:
      return "UNDECIDED";
    case LawMode::OPEN:
      return "OPEN";
    case LawMode::STICK:
      return "STICK";
    case LawMode::RIGHT:
      return "RIGHT";
    case LawMode::LEFT:
      return "LEFT";
    case LawMode::SLIDE:
      return "SLIDE";
  }
  return "UNKNOWN";
}

const OptionTable<EnumerateOptions>& EnumerateOptions::table()
{
  static const OptionTable<EnumerateOptions> table(
      "enumerate",
      {
          {"max_nodes", &EnumerateOptions::max_nodes, atLeast(1), "nodes", "of an island's search tree"},
          {"time_limit", &EnumerateOptions::time_limit, atLeast(0.0), "s", "wall clock, 0 = none"},
          {"max_rows", &EnumerateOptions::max_rows, atLeast(1), "rows", "of an island; above, nothing is tried"},
          {"max_vertices", &EnumerateOptions::max_vertices, atLeast(2), "vertices",
           "kept of a polytope; with more only its dimension is reported"},
          {"max_families", &EnumerateOptions::max_families, atLeast(1), "families",
           "listed of the product of islands; the counts are right in any case"},
          {"impulse_bound", &EnumerateOptions::impulse_bound, between(1.0, 1e12), "-",
           "of the proofs, relative to the problem's scale of impulses"},
          {"min_angle", &EnumerateOptions::min_angle, between(1e-9, 1.0), "rad",
           "half width of the smallest wedge of slip directions in 3D"},
          {"cuts", &EnumerateOptions::cuts, std::vector<std::string>{"none", "most_violated", "deepest", "facets"},
           "of violated complementarities: docs/facet_cuts.md"},
          {"cuts_per_node", &EnumerateOptions::cuts_per_node, atLeast(1), "rounds", "each with a linear program"},
          {"cut_depth", &EnumerateOptions::cut_depth, atLeast(0), "laws",
           "cuts at nodes with at most so many decided; they hold below too"},
      });
  return table;
}

void EnumerateOptions::validate() const
{
  table().validate(*this);
}

EnumerationReport enumerate(const DelassusProblem& problem, const EnumerateOptions& options,
                            const std::function<bool()>& interrupted)
{
  const Clock clock;
  options.validate();
  validate(problem);
  EnumerationReport report;
  const bool consistent = search(problem, options, deadline(clock, options.time_limit, interrupted), report);
  diagnose(problem, consistent, report);
  report.seconds = clock.seconds();
  return report;
}

EnumerationReport enumerate(const IncrementalProblem& problem, const EnumerateOptions& options,
                            const std::function<bool()>& interrupted)
{
  const Clock clock;
  options.validate();
  validate(problem);
  EnumerationReport report;
  DelassusReduction reduction;
  reduction.compute(problem);
  const bool consistent = !contradict(problem, reduction);
  if (consistent)
    search(reduction.problem(), options, deadline(clock, options.time_limit, interrupted), report);
  else
    report.complete = true;
  for (SolutionFamily& family : report.families)
    reduction.recover(problem, family.representative);
  diagnose(problem, consistent, report);
  report.seconds = clock.seconds();
  return report;
}

}  // namespace frictional_contact_sim
