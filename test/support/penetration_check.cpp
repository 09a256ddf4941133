#include "support/penetration_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
/** Largest depth in `other` of the points a + t (b - a), 0 <= t <= 1: concave in t, so a ternary search finds it. */
double deepestOnEdge(const ConvexSolid& other, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i)
  {
    const double left = low + (high - low) / 3.0;
    const double right = high - (high - low) / 3.0;
    if (other.depth(a + left * (b - a)) < other.depth(a + right * (b - a)))
      low = left;
    else
      high = right;
  }
  return other.depth(a + 0.5 * (low + high) * (b - a));
}

/** Compass search over the solid for the deepest point, from `start`: what lies between samples of a curved surface. */
double climb(const ConvexSolid& solid, const ConvexSolid& other, const Eigen::Isometry3d& in_other,
             Eigen::Vector3d start)
{
  double best = other.depth(in_other * start);
  double step = 0.25 * solid.radius;
  while (step > 1e-9)
  {
    bool better = false;
    for (int k = 0; k < 26; ++k)
    {
      const int code = k < 13 ? k : k + 1;  // the 26 neighbours of the middle cell of 3 x 3 x 3
      const Eigen::Vector3d move(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
      const Eigen::Vector3d point = solid.nearest(start + step * move);
      const double depth = other.depth(in_other * point);
      if (depth > best + 1e-3 * step)
      {
        best = depth;
        start = point;
        better = true;
      }
    }
    if (!better)
      step *= 0.5;
  }
  return best;
}

/** Largest depth of points of `a` in `b`, of what is deeper than 0 or might be. */
double deepest(const ConvexSolid& a, const ConvexSolid& b, const Eigen::Isometry3d& a_in_b)
{
  double best = -std::numeric_limits<double>::infinity();
  size_t at = 0;
  std::vector<double> depth(a.points.size());
  for (size_t i = 0; i < a.points.size(); ++i)
  {
    depth[i] = b.depth(a_in_b * a.points[i]);
    if (depth[i] > best)
    {
      best = depth[i];
      at = i;
    }
  }
  // A depth changes by no more than the distance walked: from samples farther away nothing can come.
  if (a.curved && best > -a.radius)
    best = std::max(best, climb(a, b, a_in_b, a.points[at]));
  for (const std::array<int, 2>& edge : a.edges)
  {
    const double length = (a.points[edge[0]] - a.points[edge[1]]).norm();
    const double most = 0.5 * (depth[edge[0]] + depth[edge[1]] + length);
    if (most > std::max(best, 0.0) + 1e-9)
      best = std::max(best, deepestOnEdge(b, a_in_b * a.points[edge[0]], a_in_b * a.points[edge[1]]));
  }
  return best;
}
}  // namespace

PenetrationCheck::PenetrationCheck(const Simulator& simulator) : simulator_(simulator)
{
  const Scenario& scenario = simulator.scenario();
  ground_ = scenario.ground ? scenario.ground->height : 0.0;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator.model(body);
    for (const CollisionShape& shape : model.shapes)
    {
      const Joint& joint = model.joints[shape.link];
      for (const ConvexSolid& solid : ConvexSolid::solidsOf(shape.geometry))
        parts_.push_back({solid, body, shape.link, model.frames[shape.frame].name, shape.placement,
                          joint.type == JointType::FIXED && joint.parent < 0});
    }
  }
  noted_.assign(simulator.bodyCount(), 0.0);
  turning_.assign(simulator.bodyCount(), 0.0);
  at_rest_.assign(simulator.bodyCount(), 0);
  update();
  addPairs();
  for (Pair& pair : pairs_)
  {
    pair.start = std::max(0.0, depth(pair));
    if (pair.start > 1e-9)
      overlaps_.push_back(name(pair));
  }
}

/** By the scenario's own words, or because the world says that the two overlap at the start. */
bool PenetrationCheck::isDisabled(const Part& a, const std::string& other, int other_body) const
{
  if (other_body == a.body)
    for (const auto& [link_1, link_2] : simulator_.scenario().bodies[a.body].disable_collisions)
      if ((link_1 == a.name && link_2 == other) || (link_2 == a.name && link_1 == other))
        return true;
  const auto endsWith = [](const std::string& text, const std::string& end)
  { return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0; };
  for (const std::string& warning : simulator_.warnings())
    if (warning.find("overlap") != std::string::npos &&
        (endsWith(warning, ": " + a.name + " - " + other) || endsWith(warning, ": " + other + " - " + a.name)))
      return true;
  return false;
}

bool PenetrationCheck::mayTouch(const Part& a, const Part& b) const
{
  if (a.immobile && b.immobile)
    return false;
  for (const Closure& loop : simulator_.loops())
  {
    const auto isAt = [&](const Part& part, int body, int frame)
    { return body == part.body && simulator_.model(body).frames[static_cast<size_t>(frame)].link == part.link; };
    if (loop.body_b >= 0 && ((isAt(a, loop.body_a, loop.frame_a) && isAt(b, loop.body_b, loop.frame_b)) ||
                             (isAt(b, loop.body_a, loop.frame_a) && isAt(a, loop.body_b, loop.frame_b))))
      return false;
  }
  if (a.body != b.body)
    return true;
  const std::vector<Joint>& joints = simulator_.model(a.body).joints;
  if (a.link == b.link || joints[a.link].parent == b.link || joints[b.link].parent == a.link)
    return false;
  return !isDisabled(a, b.name, b.body);
}

void PenetrationCheck::addPairs()
{
  const int count = static_cast<int>(parts_.size());
  for (int i = 0; i < count; ++i)
  {
    for (int k = i + 1; k < count; ++k)
      if (mayTouch(parts_[i], parts_[k]))
        pairs_.push_back({i, k});
    if (simulator_.scenario().ground && !parts_[i].immobile && !isDisabled(parts_[i], "ground", -1))
      pairs_.push_back({i, -1});
  }
}

double PenetrationCheck::spin(int body) const
{
  double fastest = 0.0;
  for (const Vector6d& velocity : simulator_.data(body).link_velocity)
    fastest = std::max(fastest, velocity.tail<3>().norm());
  return fastest;
}

void PenetrationCheck::noteSpeeds()
{
  for (int body = 0; body < simulator_.bodyCount(); ++body)
    noted_[body] = spin(body);
}

void PenetrationCheck::update()
{
  for (Part& part : parts_)
  {
    part.pose = simulator_.data(part.body).link_pose[part.link] * part.placement;
    part.center = part.pose * part.solid.center;
  }
  for (int body = 0; body < simulator_.bodyCount(); ++body)
  {
    const MultibodyData& data = simulator_.data(body);
    const double fastest = std::max(spin(body), noted_[body]);
    double reach = 0.0;
    for (const Part& part : parts_)
      if (part.body == body)
        reach = std::max(reach, (part.center - data.link_pose.front().translation()).norm() + part.solid.radius);
    turning_[body] = reach * fastest * fastest;
    const Eigen::VectorXd& v = simulator_.velocity(body);
    const bool driven = simulator_.scenario().bodies[body].motion.has_value();
    at_rest_[body] = !driven && (v.size() == 0 || v.cwiseAbs().maxCoeff() < REST_SPEED);
  }
}

double PenetrationCheck::groundDepth(const Part& part) const
{
  const Eigen::Vector3d up = part.pose.linear().row(2).transpose();
  return ground_ - part.pose.translation().z() + part.solid.reachAgainst(up);
}

double PenetrationCheck::depth(const Pair& pair) const
{
  const Part& a = parts_[pair.a];
  if (pair.b < 0)
    return a.center.z() - a.solid.radius > ground_ ? -1.0 : groundDepth(a);
  const Part& b = parts_[pair.b];
  if ((a.center - b.center).norm() > a.solid.radius + b.solid.radius)
    return -1.0;
  const Eigen::Isometry3d a_in_b = b.pose.inverse(Eigen::Isometry) * a.pose;
  return std::max(deepest(a.solid, b.solid, a_in_b), deepest(b.solid, a.solid, a_in_b.inverse(Eigen::Isometry)));
}

double PenetrationCheck::tolerance(const Pair& pair) const
{
  const int body_a = parts_[pair.a].body;
  const int body_b = pair.b < 0 ? -1 : parts_[pair.b].body;
  double allowed = 1e-6;
  if (!at_rest_[body_a] || (body_b >= 0 && !at_rest_[body_b]))
  {
    const double dt = simulator_.scenario().time_step;
    const double turning = turning_[body_a] + (body_b >= 0 && body_b != body_a ? turning_[body_b] : 0.0);
    allowed = std::max(allowed, dt * dt * (simulator_.scenario().gravity.norm() + turning));
  }
  return std::max(allowed, 1.01 * pair.start);
}

std::string PenetrationCheck::name(const Pair& pair) const
{
  const auto one = [&](const Part& part) { return simulator_.bodyName(part.body) + "/" + part.name; };
  return one(parts_[pair.a]) + " - " + (pair.b < 0 ? "ground" : one(parts_[pair.b]));
}

Penetration PenetrationCheck::worst()
{
  update();
  const Pair* found = nullptr;
  Penetration result;
  double ratio = 0.0;
  for (const Pair& pair : pairs_)
  {
    const double deep = depth(pair);
    if (deep <= 0.0 || deep / tolerance(pair) <= ratio)
      continue;
    ratio = deep / tolerance(pair);
    result.depth = deep;
    result.tolerance = tolerance(pair);
    found = &pair;
  }
  if (found != nullptr)
    result.pair = name(*found);
  return result;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
