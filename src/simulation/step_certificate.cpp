// Verdicts on the problem of the last step: Simulator::certify and ~certify_every.
#include "frictional_contact_sim/simulation/step_certificate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
/// The bound of the margin is at least this, and at least so many times the fastest that w asks for.
constexpr double LEAST_BOUND = 1.0;
constexpr double BOUND_FACTOR = 10.0;

/** What the surroundings ask for: approach and slip of the rows at v = 0, closure of bilateral rows. */
double demandedSpeed(const IncrementalProblem& problem)
{
  double speed = problem.bilaterals() > 0 ? problem.b.lpNorm<Eigen::Infinity>() : 0.0;
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const int d = law.dimension();
    if (law.isOneSided())
      speed = std::max(speed, -problem.w[row]);
    else if (law.type == LawType::BILATERAL)
      speed = std::max(speed, std::abs(problem.w[row]));
    if (d > 1)
      speed = std::max(speed, problem.w.segment(row + 1, d - 1).norm());
    row += d;
  }
  return speed;
}

std::string inOneUnit(double seconds)
{
  char text[40];
  std::snprintf(text, sizeof(text), "%.3g ms", 1e3 * seconds);
  return text;
}
}  // namespace

std::string joinNames(const std::vector<NamedRow>& rows)
{
  std::vector<std::string> names;
  std::string text;
  for (const NamedRow& row : rows)
    if (std::find(names.begin(), names.end(), row.name) == names.end())
    {
      names.push_back(row.name);
      text += (text.empty() ? "" : ", ") + row.name;
    }
  return text;
}

void MarginTrend::add(double time, double margin)
{
  if (count_ > 0 && time <= times_[(count_ - 1) % LENGTH])
    count_ = 0;
  if (!std::isfinite(margin))
    return;
  times_[count_ % LENGTH] = time;
  margins_[count_ % LENGTH] = margin;
  ++count_;
}

double MarginTrend::rate() const
{
  const int size = std::min(count_, LENGTH);
  if (size < 5)
    return 0.0;
  std::vector<double> slopes;
  for (int k = count_ - size + 1; k < count_; ++k)
    slopes.push_back((margins_[k % LENGTH] - margins_[(k - 1) % LENGTH]) /
                     (times_[k % LENGTH] - times_[(k - 1) % LENGTH]));
  std::nth_element(slopes.begin(), slopes.begin() + slopes.size() / 2, slopes.end());
  return slopes[slopes.size() / 2];
}

std::string Simulator::Impl::sideName(int shape) const
{
  const ShapeInfo& info = collision.shape(shape);
  return info.body < 0 ? info.link_name : bodies[static_cast<size_t>(info.body)].model.name + "/" + info.link_name;
}

/** A law by its contact, or by the joint and the kind of its row. */
NamedRow Simulator::Impl::nameRow(const RowOrigin& origin, const ContactPoint* point) const
{
  NamedRow row;
  if (point != nullptr)
  {
    row.is_contact = true;
    row.id = point->id.number();
    row.position = point->position;
    row.normal = point->normal;
    row.name = sideName(point->shape_a) + " - " + sideName(point->shape_b);
    return row;
  }
  row.name = origin.source;
  if (origin.body >= 0)
  {
    const Body& body = bodies[static_cast<size_t>(origin.body)];
    row.name += " of " + body.model.name + "/" + body.model.tree.joints[static_cast<size_t>(origin.joint)].name;
  }
  return row;
}

std::vector<NamedRow> Simulator::Impl::nameRows(const std::vector<int>& laws, const std::vector<int>& bilaterals) const
{
  std::vector<NamedRow> rows;
  for (const int law : laws)
    rows.push_back(nameRow(assembly.origins()[static_cast<size_t>(law)], assembly.contactOf(context, law)));
  for (const int row : bilaterals)
    rows.push_back(nameRow(assembly.bilateralOrigins()[static_cast<size_t>(row)], nullptr));
  return rows;
}

void Simulator::Impl::certify(CertifyOptions options, StepCertificate& result) const
{
  const auto start = std::chrono::steady_clock::now();
  const IncrementalProblem& problem = assembly.problem();
  if (options.bound == 0.0)
    options.bound = std::max(LEAST_BOUND, BOUND_FACTOR * demandedSpeed(problem));
  const Certificate certificate = frictional_contact_sim::certify(problem, options);
  result.checked = true;
  result.step = report.step;
  result.time = report.time;
  result.existence = certificate.existence;
  result.exact = certificate.exact;
  result.margin = certificate.margin;
  result.bound = options.bound;
  result.rows = certificate.rows;
  result.rank = certificate.rank;
  result.condition = certificate.condition;
  result.blocking = nameRows(certificate.blocking, certificate.blocking_bilaterals);
  result.limiting = nameRows(certificate.limiting, {});
  result.islands.clear();
  for (const IslandCertificate& island : certificate.islands)
    result.islands.push_back(
        {static_cast<int>(std::count_if(island.laws.begin(), island.laws.end(),
                                        [&](int law) { return assembly.contactOf(context, law) != nullptr; })),
         island.existence.verdict, island.margin, island.conditioning.rows, island.conditioning.rank,
         island.conditioning.condition});
  result.message = certificate.message;
  result.warning.clear();
  result.seconds_left = std::numeric_limits<double>::infinity();
  if (certificate.existence == Existence::REFUTED)
  {
    result.seconds_left = 0.0;
    result.message += ": " + joinNames(result.blocking);
    result.warning = "no solution: " + result.message;
  }
  else
    foresee(options, result);
  result.uniqueness = checkUniqueness(problem).verdict;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/** What happens once the gaps are closed. */
void Simulator::Impl::foresee(CertifyOptions options, StepCertificate& result) const
{
  IncrementalProblem closed = assembly.problem();
  closed.w = assembly.closedOffsets();
  if (closed.w == assembly.problem().w)
    return;
  options.conditioning = options.klarbring_pang = false;
  const Certificate certificate = frictional_contact_sim::certify(closed, options);
  if (certificate.existence != Existence::REFUTED)
    return;
  result.blocking = nameRows(certificate.blocking, certificate.blocking_bilaterals);
  result.seconds_left = std::max(0.0, context.dt * result.margin / -certificate.margin);
  result.warning = "in " + inOneUnit(result.seconds_left) +
                   " no velocity will keep these from penetrating: " + joinNames(result.blocking);
}

void Simulator::Impl::certifyStep()
{
  StepCertificate& result = report.certificate;
  result.checked = false;
  const bool due = scenario.certify_every > 0 && report.step % static_cast<std::uint64_t>(scenario.certify_every) == 0;
  // A step without an answer is always asked for the reason.
  const bool failed = scenario.certify_every > 0 && outcome.status != SolverStatus::CONVERGED;
  if (!is_solved || (!due && !failed))
    return;
  try
  {
    CertifyOptions options;
    options.bound = scenario.certify_bound;
    certify(options, result);
  }
  catch (const std::exception& error)
  {
    result = StepCertificate();
    result.message = error.what();
    return;
  }
  if (result.islands.empty())
    trend.clear();
  else
    trend.add(report.time, result.margin);
  result.margin_rate = trend.rate();
  if (!result.warning.empty() || result.margin <= 0.0 || result.margin_rate >= 0.0)
    return;
  const double left = -result.margin / result.margin_rate;
  if (left > WARNING_TIME)
    return;
  result.seconds_left = left;
  result.warning = "the margin of existence falls and is zero in " + inOneUnit(left) +
                   " at this rate, limited by: " + joinNames(result.limiting);
}

StepCertificate Simulator::certify(const CertifyOptions& options) const
{
  if (!impl_->is_solved)
    throw std::invalid_argument("there is no problem yet: no step since the start or since the state was set");
  StepCertificate result;
  impl_->certify(options, result);
  return result;
}

void Simulator::setCertifyEvery(int steps)
{
  if (steps < 0)
    throw std::invalid_argument("certify_every is " + std::to_string(steps) + ", expected >= 0");
  impl_->scenario.certify_every = steps;
  impl_->trend.clear();
  impl_->report.certificate = StepCertificate();
}

}  // namespace frictional_contact_sim
