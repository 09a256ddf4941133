#include "frictional_contact_sim/problem/rigid_families.h"

#include <cmath>
#include <string>
#include <vector>

#include "option_range.h"
#include "random_draw.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double GRAVITY = 9.81;  ///< [m/s^2]
constexpr int FIXED = -1;  ///< the floor as a body

constexpr const char* FAMILY = "rigid family";
constexpr int MAX_WIDTH = 1000;
constexpr double MAX_MASS_RATIO = 1e15;  ///< beyond it a matrix of doubles need not be definite
constexpr double MAX_TILT = 7.0;  ///< [rad], more than a turn

struct Ball
{
  Eigen::Vector3d center;
  double mass;
};

Eigen::Matrix3d cross(const Eigen::Vector3d& x)
{
  Eigen::Matrix3d result;
  result << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  return result;
}

/** Collects bodies and contacts, then makes the problem. */
class Builder
{
public:
  Builder(const RigidFamilyOptions& options, RandomDraw& draw) : options_(options), draw_(draw) {}

  /** @param inertia moment about every axis [kg m^2] */
  void addBody(double mass, double inertia)
  {
    masses_.insert(masses_.end(), {mass, mass, mass, inertia, inertia, inertia});
  }

  /** Contact with the normal from body b to body a, either of which may be FIXED. */
  void addContact(int a, const Eigen::Vector3d& arm_a, int b, const Eigen::Vector3d& arm_b,
                  const Eigen::Vector3d& normal)
  {
    const Eigen::Matrix3d frame = contactFrame(normal);
    const int row = row_count_;
    addBlocks(row, a, frame, arm_a);
    addBlocks(row, b, -frame, arm_b);
    row_count_ += 3;
    laws_.push_back({LawType::COULOMB_3D, draw_.uniform(options_.friction_min, options_.friction_max)});
  }

  IncrementalProblem finish()
  {
    IncrementalProblem problem;
    const int size = static_cast<int>(masses_.size());
    const Eigen::VectorXd mass = Eigen::Map<const Eigen::VectorXd>(masses_.data(), size);
    problem.M.resize(size, size);
    problem.M.reserve(Eigen::VectorXi::Constant(size, 1));
    for (int i = 0; i < size; ++i)
      problem.M.insert(i, i) = mass[i];
    problem.M.makeCompressed();
    Eigen::VectorXd velocity = options_.agitation * draw_.normals(size, 1);
    const double step = options_.time_step * GRAVITY;
    for (int body = 0; body < size; body += 6)
    {
      velocity[body] += step * std::sin(options_.tilt);
      velocity[body + 2] -= step * std::cos(options_.tilt);
    }
    problem.f = -mass.cwiseProduct(velocity);
    problem.H.resize(row_count_, size);
    problem.H.setFromTriplets(entries_.begin(), entries_.end());
    problem.w.setZero(row_count_);
    problem.laws = std::move(laws_);
    problem.G.resize(0, size);
    problem.b.resize(0);
    return problem;
  }

private:
  void addBlocks(int row, int body, const Eigen::Matrix3d& frame, const Eigen::Vector3d& arm)
  {
    if (body == FIXED)
      return;
    const Eigen::Matrix3d angular = -frame * cross(arm);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
      {
        entries_.emplace_back(row + i, 6 * body + j, frame(i, j));
        entries_.emplace_back(row + i, 6 * body + 3 + j, angular(i, j));
      }
  }

  const RigidFamilyOptions& options_;
  RandomDraw& draw_;
  std::vector<double> masses_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<Law> laws_;
  int row_count_ = 0;
};
}  // namespace

void RigidFamilyOptions::validate() const
{
  requireRange(FAMILY, "friction_min", friction_min, 0.0, MAX_FRICTION);
  requireRange(FAMILY, "friction_max", friction_max, friction_min, MAX_FRICTION);
  requireRange(FAMILY, "mass_ratio", mass_ratio, 1.0, MAX_MASS_RATIO);
  requireRange(FAMILY, "agitation", agitation, 0.0, MAX_SPEED);
  requireRange(FAMILY, "time_step", time_step, 1e-12, MAX_SPEED);
  requireRange(FAMILY, "tilt", tilt, -MAX_TILT, MAX_TILT);
}

IncrementalProblem granularProblem(int contacts, int width, const RigidFamilyOptions& options)
{
  options.validate();
  requireRange(FAMILY, "contacts", contacts, 1, MAX_COUNT);
  requireRange(FAMILY, "width", width, 0, MAX_WIDTH);
  if (width == 0)
    width = static_cast<int>(std::ceil(std::cbrt(contacts / 3.0)));
  RandomDraw draw(options.seed);
  Builder builder(options, draw);
  std::vector<Ball> balls;
  const int layer = width * width;
  for (int index = 0, count = 0; count < contacts; ++index)
  {
    const int x = index % width;
    const int y = index / width % width;
    const int z = index / layer;
    Ball ball;
    ball.center = Eigen::Vector3d(x, y, z + 0.5) + 0.05 * Eigen::Vector3d(draw.normals(3, 1));
    ball.mass = std::pow(options.mass_ratio, draw.uniform());
    builder.addBody(ball.mass, 0.4 * ball.mass * 0.25);
    balls.push_back(ball);
    if (z == 0)
    {
      builder.addContact(index, -0.5 * Eigen::Vector3d::UnitZ(), FIXED, Eigen::Vector3d::Zero(),
                         Eigen::Vector3d::UnitZ());
      ++count;
    }
    for (const int neighbour : {z > 0 ? index - layer : -1, x > 0 ? index - 1 : -1, y > 0 ? index - width : -1})
    {
      if (neighbour < 0 || count >= contacts)
        continue;
      const Eigen::Vector3d arm = 0.5 * (balls[static_cast<size_t>(neighbour)].center - ball.center);
      builder.addContact(index, arm, neighbour, -arm, -arm.normalized());
      ++count;
    }
  }
  return builder.finish();
}

IncrementalProblem boxStackProblem(int levels, int points_per_side, const RigidFamilyOptions& options)
{
  options.validate();
  requireRange(FAMILY, "points_per_side", points_per_side, 2, MAX_WIDTH);
  requireRange(FAMILY, "levels", levels, 1, MAX_COUNT / (points_per_side * points_per_side));
  RandomDraw draw(options.seed);
  Builder builder(options, draw);
  for (int level = 0; level < levels; ++level)
  {
    const double mass = levels > 1 ? std::pow(options.mass_ratio, static_cast<double>(level) / (levels - 1)) : 1.0;
    builder.addBody(mass, mass / 6.0);
    for (int i = 0; i < points_per_side; ++i)
      for (int j = 0; j < points_per_side; ++j)
      {
        const double step = 1.0 / (points_per_side - 1);
        const Eigen::Vector3d corner(i * step - 0.5, j * step - 0.5, 0.0);
        builder.addContact(level, corner - Eigen::Vector3d(0.0, 0.0, 0.5), level - 1,
                           corner + Eigen::Vector3d(0.0, 0.0, 0.5), Eigen::Vector3d::UnitZ());
      }
  }
  return builder.finish();
}

}  // namespace frictional_contact_sim
