#include "frictional_contact_sim/rolling/rolling_case.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "frictional_contact_sim/rolling/closed_forms.h"

namespace frictional_contact_sim
{
namespace
{
double processSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double zoneHalfWidth(const RollingCase& study, const MaterialPair& materials)
{
  if (study.half_width > 0.0)
    return study.half_width;
  if (study.load)
    return 1.25 * hertzLine(*study.load, study.radius, materials.reducedModulus()).half_width;
  return std::sqrt(2.0 * study.radius * study.normal_displacement);
}

ContactFlexibility makeFlexibility(const RollingCase& study, const MaterialPair& materials)
{
  const double half_width = zoneHalfWidth(study, materials);
  const double datum = study.datum > 0.0 ? study.datum : 2.0 * study.radius;
  if (study.source == FlexibilitySource::HALF_PLANE)
  {
    Eigen::VectorXd x, width;
    makeUniformNodes(half_width, study.nodes, x, width);
    return halfPlaneFlexibility(materials, x, width, datum);
  }
  Contour contour;
  if (study.contour)
    contour = *study.contour;
  else
  {
    CylinderMesh mesh = study.mesh;
    mesh.radius = study.radius;
    mesh.contact_elements = study.nodes;
    if (!(half_width <= study.radius))
      throw std::invalid_argument("half_width: found a contact zone of " + std::to_string(half_width) +
                                  " m, expected at most the radius of " + std::to_string(study.radius) + " m");
    mesh.half_angle = std::asin(half_width / study.radius);
    contour = makeCylinderContour(mesh);
  }
  ContactFlexibility F = condense(contour, materials.upper, study.frames);
  if (!materials.lower_is_rigid)
    addLowerHalfPlane(materials.lower, datum, F);
  return F;
}

Eigen::VectorXd makeGap(const RollingCase& study, const Eigen::VectorXd& x)
{
  const double R = study.radius;
  if (study.gap == GapShape::PARABOLA)
    return x.array().square() / (2.0 * R);
  if (!(x.lpNorm<Eigen::Infinity>() < R))
    throw std::invalid_argument("gap: circle needs contact nodes within the radius of " + std::to_string(R) + " m");
  // R - sqrt(R^2 - x^2) without cancellation.
  return x.array().square() / (R + (R * R - x.array().square()).sqrt());
}

/// The static answer, also the start of rolling at a load.
void press(const RollingCase& study, const FrictionalLcp& lcp, const std::vector<double>& shares, const RunHooks& hooks,
           RollingRun& run)
{
  const Eigen::Index n = run.gap.size();
  if (!study.load)
  {
    run.approach = study.normal_displacement;
    run.shift = study.tangential_displacement;
    run.contact = lcp.solve(run.gap.array() - run.approach, Eigen::VectorXd::Constant(n, run.shift), hooks.interrupted);
    run.converged = run.contact.status == LcpStatus::SOLVED;
    return;
  }
  std::vector<LoadTarget> targets;
  for (const double share : shares)
  {
    targets.emplace_back();
    targets.back().P = *study.load;
    targets.back().Q = share * run.friction * *study.load;
  }
  const HertzLine hertz = hertzLine(*study.load, study.radius, run.materials.reducedModulus());
  std::vector<LoadStep> steps =
      followLoads(lcp, run.gap, targets, hertz.half_width * hertz.half_width / study.radius, hooks.interrupted);
  const LoadedContact& answer = steps.back().answer;
  run.contact = answer.contact;
  run.approach = answer.approach;
  run.shift = answer.shift;
  run.converged = answer.converged && steps.size() == targets.size();
  if (targets.size() == 1)
    return;
  for (const LoadStep& step : steps)
    run.history.push_back(step.answer.contact.Q);
  run.steps = std::move(steps);
}

void rollOn(const RollingCase& study, const FrictionalLcp& lcp, const RunHooks& hooks, RollingRun& run)
{
  RollingOptions options;
  options.load = study.load.value_or(0.0);
  options.max_steps = study.max_steps;
  options.steady_tolerance = study.steady_tolerance;
  options.interrupted = hooks.interrupted;
  if (hooks.progress)
    options.progress = [&](int step, double) { hooks.progress(static_cast<double>(step) / study.max_steps); };
  const RollingResult result =
      study.motion == Motion::TRANSIENT
          ? roll(lcp, run.gap, run.approach, run.contact.u_T, study.creepage, options)
          : rollSteadily(run.flexibility, run.friction, run.gap, run.approach, study.creepage, options);
  run.converged = result.steady;
  if (result.steps == 0)
    return;  // interrupted before the first step: what was pressed stays
  run.contact = result.contact;
  run.slip = result.slip;
  run.history = result.history;
  run.approach = result.approach;
  run.shift = 0.0;
}

RollingRun runOne(const RollingCase& study, double friction, double lower_modulus, const RunHooks& hooks)
{
  RollingRun run;
  run.friction = friction;
  run.materials.upper = study.upper;
  run.materials.lower_is_rigid = lower_modulus == RollingCase::RIGID;
  if (!run.materials.lower_is_rigid)
    run.materials.lower = {lower_modulus, study.lower_poisson_ratio};
  double start = processSeconds();
  run.flexibility = makeFlexibility(study, run.materials);
  run.flexibility_seconds = processSeconds() - start;
  run.asymmetry = run.flexibility.asymmetry();
  run.gap = makeGap(study, run.flexibility.x);

  start = processSeconds();
  run.slip.setZero(run.gap.size());
  const FrictionalLcp lcp(run.flexibility, Eigen::VectorXd::Constant(1, friction));
  const bool is_sheared = study.motion == Motion::STATIC && !study.load_shares.empty();
  press(study, lcp, is_sheared ? study.load_shares : std::vector<double>{0.0}, hooks, run);
  const bool pressed = run.converged;
  const double pressed_approach = run.approach;
  if (study.motion == Motion::STATIC)
    run.slip = slipVelocity(run.flexibility.x, run.contact.u_T, study.creepage, study.direction);
  else if (run.converged)
    rollOn(study, lcp, hooks, run);
  run.contact_seconds = processSeconds() - start;
  const bool stopped = hooks.interrupted && hooks.interrupted();
  if (study.curve_points > 0 && pressed && friction > 0.0 && !stopped)
  {
    CreepCurveOptions options;
    options.points = study.curve_points;
    options.progress = hooks.progress;
    options.interrupted = hooks.interrupted;
    const HertzLine hertz = hertzLine(*study.load, study.radius, run.materials.reducedModulus());
    run.curve = computeCreepCurve(run.flexibility, friction, *study.load, run.gap, pressed_approach,
                                  carterSaturation(hertz, study.radius, friction), options);
  }
  return run;
}
}  // namespace

double RollingRun::contactWidth() const
{
  double sum = 0.0;
  for (size_t i = 0; i < contact.states.size(); ++i)
    if (contact.states[i] != NodeState::SEPARATION)
      sum += flexibility.width[static_cast<Eigen::Index>(i)];
  return sum;
}

double RollingRun::stickWidth() const
{
  double sum = 0.0;
  for (size_t i = 0; i < contact.states.size(); ++i)
    if (contact.states[i] == NodeState::STICK)
      sum += flexibility.width[static_cast<Eigen::Index>(i)];
  return sum;
}

double RollingRun::elasticEnergy() const
{
  return 0.5 * (flexibility.width.array() *
                (contact.r_N.array() * contact.u_N.array() + contact.r_T.array() * contact.u_T.array()))
                   .sum();
}

std::vector<RollingRun> runRollingCase(const RollingCase& study, const RunHooks& hooks)
{
  std::vector<RollingRun> runs;
  const double total = static_cast<double>(study.friction.size() * study.lower_moduli.size());
  for (double friction : study.friction)
    for (double lower_modulus : study.lower_moduli)
    {
      if (hooks.interrupted && hooks.interrupted())
        return runs;
      RunHooks inner = hooks;
      if (hooks.progress)
        inner.progress = [&](double share) { hooks.progress((static_cast<double>(runs.size()) + share) / total); };
      runs.push_back(runOne(study, friction, lower_modulus, inner));
    }
  return runs;
}

}  // namespace frictional_contact_sim
