#include "frictional_contact_sim/problem/rod_family.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>

#include "option_range.h"
#include "random_draw.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LENGTH = 0.2;  ///< of a rod [m]
constexpr double RADIUS = 1e-3;  ///< [m]
constexpr double DENSITY = 1300.0;  ///< [kg/m^3]
constexpr double YOUNG = 1e7;  ///< [Pa]
constexpr double POISSON = 0.5;  ///< incompressible, as hair is taken to be
constexpr double TIME_STEP = 1e-3;  ///< [s]
constexpr double JERK = 0.5;  ///< deviation of the change of the support's velocity in the step [m/s, rad/s]
constexpr int SECTIONS = 16;  ///< a piece
constexpr int MAX_OBJECTS = 100000;  ///< rods, contacts
constexpr int MAX_PIECES = 1000;
constexpr double PI = 3.14159265358979323846;
constexpr double AREA = PI * RADIUS * RADIUS;
constexpr double INERTIA = PI * RADIUS * RADIUS * RADIUS * RADIUS / 4.0;  ///< of a section about a diameter [m^4]

Eigen::Matrix3d cross(const Eigen::Vector3d& x)
{
  Eigen::Matrix3d result;
  result << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  return result;
}

/** exp(s [q]x) and its integral over s, by Rodrigues' formula; a series where the angle is small. */
void rotateAlong(const Eigen::Vector3d& q, double s, Eigen::Matrix3d& rotation, Eigen::Matrix3d& integral)
{
  const double rate = q.norm();
  const double angle = rate * s;
  const Eigen::Matrix3d A = cross(q);
  double first, second, third;  // sin(a)/rate, (1 - cos(a))/rate^2, (a - sin(a))/rate^3
  if (angle < 1e-4)
  {
    first = s;
    second = 0.5 * s * s;
    third = s * s * s / 6.0;
  }
  else
  {
    first = std::sin(angle) / rate;
    second = 2.0 * std::sin(0.5 * angle) * std::sin(0.5 * angle) / (rate * rate);
    third = (angle - std::sin(angle)) / (rate * rate * rate);
  }
  rotation = Eigen::Matrix3d::Identity() + first * A + second * A * A;
  integral = s * Eigen::Matrix3d::Identity() + second * A + third * A * A;
}

/** One rod's shape: frames and positions at the middles of its short sections. */
struct Rod
{
  double step = 0.0;  ///< between sections [m]
  std::vector<Eigen::Matrix3d> frames;
  std::vector<Eigen::Vector3d> points;

  /** Velocity of the point p fixed to a section, by dq: 3 x m_ss. */
  Eigen::MatrixXd velocity(int section, const Eigen::Vector3d& p) const { return integrate(section, &p); }
  /** Angular velocity of a section. */
  Eigen::MatrixXd rotation(int section) const { return integrate(section, nullptr); }

private:
  Eigen::MatrixXd integrate(int section, const Eigen::Vector3d* p) const
  {
    const int pieces = static_cast<int>(points.size()) / SECTIONS;
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3, 3 * pieces);
    for (int j = 0; j <= section; ++j)
    {
      const auto index = static_cast<size_t>(j);
      Eigen::Matrix3d rate = (j == section ? 0.5 : 1.0) * step * frames[index];
      if (p != nullptr)
        rate = -cross(*p - points[index]) * rate;
      result.middleCols<3>(3 * (j / SECTIONS)) += rate;
    }
    return result;
  }
};

Rod shapeRod(const Eigen::VectorXd& q, const Eigen::Vector3d& root, const Eigen::Matrix3d& orientation)
{
  Rod rod;
  const int pieces = static_cast<int>(q.size()) / 3;
  const double piece = LENGTH / pieces;
  rod.step = piece / SECTIONS;
  Eigen::Vector3d start = root;
  Eigen::Matrix3d frame = orientation;
  Eigen::Matrix3d rotation, integral;
  for (int k = 0; k < pieces; ++k)
  {
    const Eigen::Vector3d rates = q.segment<3>(3 * k);
    for (int j = 0; j < SECTIONS; ++j)
    {
      rotateAlong(rates, (j + 0.5) * rod.step, rotation, integral);
      rod.frames.push_back(frame * rotation);
      rod.points.push_back(start + frame * integral.col(0));
    }
    rotateAlong(rates, piece, rotation, integral);
    start += frame * integral.col(0);
    frame = frame * rotation;
  }
  return rod;
}

/** M block and f of one rod. */
void addDynamics(const RodFamilyOptions& options, const Rod& rod, const Eigen::VectorXd& q, const Eigen::VectorXd& jerk,
                 RandomDraw& draw, Eigen::MatrixXd& mass, Eigen::VectorXd& f)
{
  const auto size = static_cast<int>(q.size());
  const Eigen::VectorXd rest = options.curl * draw.normals(size, 1);
  const Eigen::VectorXd old = options.agitation * draw.normals(size, 1);
  mass.setZero(size, size);
  f.setZero(size);
  for (int i = 0; i < static_cast<int>(rod.points.size()); ++i)
  {
    const Eigen::Vector3d& point = rod.points[static_cast<size_t>(i)];
    const Eigen::MatrixXd J = rod.velocity(i, point);
    const Eigen::MatrixXd Jw = rod.rotation(i);
    const double line = DENSITY * AREA * rod.step;
    // A section's inertia is I about diameters and 2 I about the tangent.
    const Eigen::RowVectorXd spin = rod.frames[static_cast<size_t>(i)].col(0).transpose() * Jw;
    mass += line * J.transpose() * J;
    mass += DENSITY * INERTIA * rod.step * (Jw.transpose() * Jw + spin.transpose() * spin);
    const Eigen::Vector3d carried = jerk.head<3>() + cross(jerk.tail<3>()) * point;
    f += line * J.transpose() * (carried - TIME_STEP * Eigen::Vector3d(0.0, 0.0, -9.81));
  }
  f -= mass * old;
  const double piece = LENGTH / (size / 3);
  for (int j = 0; j < size; ++j)
  {
    const double rigidity = j % 3 == 0 ? YOUNG / (2.0 * (1.0 + POISSON)) * 2.0 * INERTIA : YOUNG * INERTIA;
    f[j] += TIME_STEP * rigidity * piece * (q[j] - rest[j]);
    mass(j, j) += TIME_STEP * TIME_STEP * rigidity * piece;
  }
}

struct ClosePair
{
  double distance;
  int rod_a, rod_b, section_a, section_b;
};

/** The closest pairs of sections; of the same two rods only pairs more than half a piece apart on the first. */
std::vector<ClosePair> closestPairs(const std::vector<Rod>& rods, int count)
{
  std::vector<ClosePair> candidates;
  for (int a = 0; a < static_cast<int>(rods.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(rods.size()); ++b)
    {
      const std::vector<Eigen::Vector3d>& first = rods[static_cast<size_t>(a)].points;
      const std::vector<Eigen::Vector3d>& second = rods[static_cast<size_t>(b)].points;
      for (size_t i = 0; i < first.size(); ++i)
      {
        size_t best = 0;
        for (size_t j = 1; j < second.size(); ++j)
          if ((first[i] - second[j]).squaredNorm() < (first[i] - second[best]).squaredNorm())
            best = j;
        candidates.push_back({(first[i] - second[best]).norm(), a, b, static_cast<int>(i), static_cast<int>(best)});
      }
    }
  std::sort(candidates.begin(), candidates.end(),
            [](const ClosePair& x, const ClosePair& y) {
              return std::tie(x.distance, x.rod_a, x.rod_b, x.section_a) <
                     std::tie(y.distance, y.rod_a, y.rod_b, y.section_a);
            });
  std::vector<ClosePair> chosen;
  std::set<std::tuple<int, int, int>> taken;
  for (const ClosePair& pair : candidates)
  {
    if (static_cast<int>(chosen.size()) == count)
      break;
    bool free = true;
    for (int shift = -SECTIONS / 2; shift <= SECTIONS / 2; ++shift)
      free = free && taken.count({pair.rod_a, pair.rod_b, pair.section_a + shift}) == 0;
    if (!free)
      continue;
    taken.insert({pair.rod_a, pair.rod_b, pair.section_a});
    chosen.push_back(pair);
  }
  if (static_cast<int>(chosen.size()) < count)
    throw std::invalid_argument("rod family: contacts is " + std::to_string(count) + ", expected at most " +
                                std::to_string(chosen.size()) + " for these rods");
  return chosen;
}

Eigen::Vector3d normalOf(const Eigen::Vector3d& from_b_to_a)
{
  const double length = from_b_to_a.norm();
  return length > 0.0 ? Eigen::Vector3d(from_b_to_a / length) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

/** Roots on a square grid, tangents downwards with random tilts. */
std::vector<Rod> shapeRods(const RodFamilyOptions& options, RandomDraw& draw, std::vector<Eigen::VectorXd>& shapes)
{
  std::vector<Rod> rods;
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(options.rods))));
  for (int k = 0; k < options.rods; ++k)
  {
    const Eigen::Vector3d root(options.spacing * (k % side), options.spacing * (k / side), 0.0);
    const Eigen::Vector3d tangent =
        (-Eigen::Vector3d::UnitZ() + 0.2 * Eigen::Vector3d(draw.normals(3, 1))).normalized();
    shapes.emplace_back(options.curl * draw.normals(3 * options.pieces, 1));
    rods.push_back(shapeRod(shapes.back(), root, contactFrame(tangent).transpose()));
  }
  return rods;
}

std::vector<RodFamilyEntry> table(const std::vector<std::pair<int, int>>& sizes)
{
  std::vector<RodFamilyEntry> result;
  std::set<std::string> names;
  for (const std::pair<int, int>& size : sizes)
  {
    RodFamilyEntry entry;
    entry.options.rods = size.first / 18;
    entry.options.contacts = size.second;
    entry.name = "hair-" + std::to_string(size.first) + "-" + std::to_string(size.second);
    entry.options.seed = result.size() + 1;
    if (!names.insert(entry.name).second)
      entry.name += "-b";
    result.push_back(entry);
  }
  return result;
}
}  // namespace

void RodFamilyOptions::validate() const
{
  constexpr const char* FAMILY = "rod family";
  requireRange(FAMILY, "rods", rods, 2, MAX_OBJECTS);
  requireRange(FAMILY, "pieces", pieces, 1, MAX_PIECES);
  requireRange(FAMILY, "contacts", contacts, 0, MAX_OBJECTS);
  requireRange(FAMILY, "friction", friction, 0.0, MAX_FRICTION);
  requireRange(FAMILY, "curl", curl, 0.0, 1e6);
  requireRange(FAMILY, "spacing", spacing, 1e-9, 1e6);
  requireRange(FAMILY, "agitation", agitation, 0.0, MAX_SPEED);
}

IncrementalProblem rodFamilyProblem(const RodFamilyOptions& options)
{
  options.validate();
  RandomDraw draw(options.seed);
  const int size = 3 * options.pieces;
  std::vector<Eigen::VectorXd> shapes;
  const std::vector<Rod> rods = shapeRods(options, draw, shapes);
  const Eigen::VectorXd jerk = JERK * draw.normals(6, 1);
  IncrementalProblem problem;
  problem.f.resize(options.rods * size);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd mass;
  Eigen::VectorXd f;
  for (int k = 0; k < options.rods; ++k)
  {
    const auto index = static_cast<size_t>(k);
    addDynamics(options, rods[index], shapes[index], jerk, draw, mass, f);
    problem.f.segment(k * size, size) = f;
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j)
        entries.emplace_back(k * size + i, k * size + j, 0.5 * (mass(i, j) + mass(j, i)));
  }
  problem.M.resize(options.rods * size, options.rods * size);
  problem.M.setFromTriplets(entries.begin(), entries.end());
  entries.clear();
  const std::vector<ClosePair> pairs = closestPairs(rods, options.contacts);
  for (size_t i = 0; i < pairs.size(); ++i)
  {
    const ClosePair& pair = pairs[i];
    const Rod& a = rods[static_cast<size_t>(pair.rod_a)];
    const Rod& b = rods[static_cast<size_t>(pair.rod_b)];
    const Eigen::Vector3d& point_a = a.points[static_cast<size_t>(pair.section_a)];
    const Eigen::Vector3d& point_b = b.points[static_cast<size_t>(pair.section_b)];
    const Eigen::Vector3d middle = 0.5 * (point_a + point_b);
    const Eigen::Matrix3d frame = contactFrame(normalOf(point_a - point_b));
    const Eigen::MatrixXd block_a = frame * a.velocity(pair.section_a, middle);
    const Eigen::MatrixXd block_b = -frame * b.velocity(pair.section_b, middle);
    for (int row = 0; row < 3; ++row)
      for (int j = 0; j < size; ++j)
      {
        // Pieces below a section do not move it: those columns are exactly zero and not stored.
        if (block_a(row, j) != 0.0)
          entries.emplace_back(3 * static_cast<int>(i) + row, pair.rod_a * size + j, block_a(row, j));
        if (block_b(row, j) != 0.0)
          entries.emplace_back(3 * static_cast<int>(i) + row, pair.rod_b * size + j, block_b(row, j));
      }
    problem.laws.push_back({LawType::COULOMB_3D, options.friction});
  }
  problem.H.resize(3 * options.contacts, options.rods * size);
  problem.H.setFromTriplets(entries.begin(), entries.end());
  problem.w.setZero(3 * options.contacts);
  problem.G.resize(0, options.rods * size);
  problem.b.resize(0);
  return problem;
}

std::vector<RodFamilyEntry> smallRodFamily()
{
  return table({{54, 4},
                {54, 5},
                {36, 3},
                {54, 9},
                {54, 9},
                {90, 8},
                {90, 13},
                {90, 13},
                {90, 12},
                {108, 17},
                {108, 18},
                {108, 16},
                {90, 20},
                {108, 15},
                {126, 22}});
}

std::vector<RodFamilyEntry> largeRodFamily()
{
  return table({{468, 150},
                {540, 127},
                {522, 158},
                {702, 106},
                {576, 148},
                {738, 129},
                {666, 148},
                {792, 178},
                {792, 174},
                {756, 184},
                {738, 209},
                {810, 194},
                {954, 229},
                {882, 294},
                {972, 369}});
}

}  // namespace frictional_contact_sim
