#include "frictional_contact_sim/separation/facet_decomposition.h"

#include <algorithm>
#include <memory>

namespace frictional_contact_sim
{
namespace
{
/// (7.27) is active from this share of N on.
constexpr double ACTIVE = 1.0 - 1e-9;

struct Record
{
  Eigen::VectorXd value;
  bool on_bound;
  std::vector<Eigen::VectorXd> multipliers;
};

/// The oracle with what it knew of each point that it returned.
class RecordingOracle
{
public:
  RecordingOracle(PolarOracle& oracle, size_t terms, double bound) : oracle_(oracle), terms_(terms), bound_(bound) {}

  OracleAnswer operator()(const Eigen::VectorXd& direction)
  {
    OracleAnswer answer = oracle_(direction);
    ++calls_;
    if (answer.status != OracleStatus::FOUND)
      return answer;
    double scale = 1.0;
    if (answer.generator.is_ray)
    {
      scale = 1.0 / answer.generator.value.norm();
      answer.generator.value *= scale;
    }
    Record record = {answer.generator.value, bound_ > 0.0 && oracle_.multiplierSum() >= ACTIVE * bound_, {}};
    for (size_t k = 0; k < terms_; ++k)
      record.multipliers.emplace_back(scale * oracle_.multipliers(k));
    records_.push_back(std::move(record));
    return answer;
  }
  /** Of a point that was returned; none: of the start. */
  const Record* find(const Eigen::VectorXd& value) const
  {
    const auto found =
        std::find_if(records_.begin(), records_.end(), [&](const Record& r) { return r.value == value; });
    return found == records_.end() ? nullptr : &*found;
  }
  int calls() const { return calls_; }

private:
  PolarOracle& oracle_;
  size_t terms_;
  double bound_;
  int calls_ = 0;
  std::vector<Record> records_;
};

/// (7.27) from the intersection cut; 0 where there is none, or only one term.
double normalisationBound(const Disjunction& disjunction, double factor)
{
  if (!(factor > 0.0) || disjunction.terms.size() < 2)
    return 0.0;
  const IntersectionCut cut = intersectionCut(disjunction);
  return cut.found ? factor * cut.bound : 0.0;
}

/// A point of Q: the mean of one of each term, where that is nearest along d.
Eigen::VectorXd pointWithin(const Disjunction& disjunction, const Eigen::VectorXd& direction)
{
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(disjunction.dimension());
  double count = 0.0;
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
  {
    const Support top = SupportProgram(disjunction.term(k)).maximise(direction);
    if (top.status != LinearProgramStatus::OPTIMAL)
      continue;
    sum += top.point;
    ++count;
  }
  return sum / std::max(count, 1.0);
}

FacetDecomposition failed(const std::string& message)
{
  FacetDecomposition result;
  result.message = message;
  return result;
}
}  // namespace

FacetDecomposition decomposeDeepestCut(const Disjunction& disjunction, const DecompositionOptions& options)
{
  const double bound = normalisationBound(disjunction, options.bound_factor);
  PolarOracle oracle(disjunction, bound);
  RecordingOracle recording(oracle, disjunction.terms.size(), bound);
  const ViolatedCut violated =
      mostViolatedCut(disjunction, bound > 0.0 ? Normalisation::MULTIPLIERS : Normalisation::LIFT_AND_PROJECT, bound);
  if (!violated.found)
    return failed("no cut separates the origin");
  Eigen::VectorXd direction = violated.direction;
  if (options.start == DecompositionStart::PROJECTION)
  {
    const NearestPoint projection = projectOrigin(disjunction, options.nearest);
    if (projection.status != NearestPointStatus::CONVERGED)
      return failed("the projection on the disjunction did not converge");
    direction = -projection.point / projection.point.squaredNorm();
    oracle.restrictToFace(direction);
  }
  OracleAnswer first = recording(direction);
  if (first.status == OracleStatus::FOUND && first.generator.is_ray)  // d.(-x) >= 1 on Q^- for every x of Q
    first = recording(-pointWithin(disjunction, violated.direction));
  if (first.status != OracleStatus::FOUND)
    return failed("the oracle has no point to start from");
  const NearestPoint nearest = nearestPoint(
      std::ref(recording), first.generator.is_ray ? violated.direction : first.generator.value, options.nearest);
  FacetDecomposition result;
  result.status = nearest.status;
  result.deepest = nearest.point;
  result.depth = 1.0 / nearest.point.norm();
  result.calls = recording.calls();
  result.bound = bound;
  result.gap = nearest.gap;
  result.norms = nearest.norms;
  for (size_t i = 0; i < nearest.generators.size(); ++i)
  {
    FacetCut cut;
    cut.direction = nearest.generators[i].value;
    cut.weight = nearest.weights[static_cast<Eigen::Index>(i)];
    cut.is_ray = nearest.generators[i].is_ray;
    cut.depth = cut.is_ray ? 0.0 : 1.0 / cut.direction.norm();
    const Record* record = recording.find(cut.direction);
    cut.on_bound = record != nullptr && record->on_bound;
    cut.multipliers = record != nullptr ? record->multipliers : violated.multipliers;
    result.cuts.push_back(std::move(cut));
  }
  return result;
}

NearestPoint projectOrigin(const Disjunction& disjunction, const NearestPointOptions& options)
{
  validate(disjunction);
  std::vector<std::unique_ptr<SupportProgram>> programs;
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
    programs.push_back(std::make_unique<SupportProgram>(disjunction.term(k)));
  const auto lowest = [&](const Eigen::VectorXd& direction) -> OracleAnswer
  {
    OracleAnswer best = {OracleStatus::EMPTY, {}};
    double value = 0.0;
    for (const std::unique_ptr<SupportProgram>& program : programs)
    {
      const Support support = program->maximise(-direction / direction.norm());
      if (support.status == LinearProgramStatus::INFEASIBLE)
        continue;
      if (support.point.size() == 0)
        return {OracleStatus::FAILED, {}};
      if (best.status == OracleStatus::FOUND && !(support.value > value))
        continue;
      value = support.value;
      best = {OracleStatus::FOUND, {support.point, support.status == LinearProgramStatus::UNBOUNDED}};
    }
    return best;
  };
  Support first;
  first.status = LinearProgramStatus::INFEASIBLE;
  for (size_t k = 0; k < programs.size() && first.status != LinearProgramStatus::OPTIMAL; ++k)
    first = programs[k]->maximise(Eigen::VectorXd::Zero(disjunction.dimension()));
  return first.status == LinearProgramStatus::OPTIMAL ? nearestPoint(lowest, first.point, options) : NearestPoint();
}

}  // namespace frictional_contact_sim
