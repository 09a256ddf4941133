#include "frictional_contact_sim/problem/random_family.h"

#include <cmath>
#include <stdexcept>

#include "option_range.h"
#include "random_draw.h"

namespace frictional_contact_sim
{
namespace
{
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr int MAX_SUBSYSTEM = 3000;  ///< a dense block
constexpr double MAX_CONDITION = 1e15;  ///< beyond it a matrix of doubles need not be definite

/** Columns orthonormal: Gram-Schmidt, twice for orthogonality to round-off. */
Eigen::MatrixXd randomOrthogonal(int size, RandomDraw& draw)
{
  Eigen::MatrixXd Q = draw.normals(size, size);
  for (int j = 0; j < size; ++j)
  {
    for (int pass = 0; pass < 2; ++pass)
      for (int k = 0; k < j; ++k)
        Q.col(j) -= Q.col(k).dot(Q.col(j)) * Q.col(k);
    Q.col(j).normalize();
  }
  return Q;
}

void addMassBlock(const RandomFamilyOptions& options, int first, RandomDraw& draw, Triplets& entries)
{
  const int size = options.subsystem_velocities;
  const Eigen::MatrixXd Q = randomOrthogonal(size, draw);
  Eigen::VectorXd d(size);
  for (int k = 0; k < size; ++k)
    d[k] = std::pow(options.condition, draw.uniform(-0.5, 0.5));
  d[0] = std::sqrt(options.condition);
  d[size - 1] = 1.0 / std::sqrt(options.condition);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j <= i; ++j)
    {
      const double value = (Q.row(i).array() * d.transpose().array() * Q.row(j).array()).sum();
      entries.emplace_back(first + i, first + j, value);
      if (i != j)
        entries.emplace_back(first + j, first + i, value);
    }
}

SparseRows assemble(int rows, int columns, const Triplets& entries)
{
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void addContact(const RandomFamilyOptions& options, int contact, RandomDraw& draw, IncrementalProblem& problem,
                Triplets& entries)
{
  const int size = options.subsystem_velocities;
  const int systems = options.velocities / size;
  const int a = draw.integer(systems);
  const int b = (a + 1 + draw.integer(systems - 1)) % systems;
  const Eigen::Matrix3d frame = contactFrame(draw.direction());
  for (const int system : {a, b})
  {
    const Eigen::MatrixXd block = frame * draw.normals(3, size);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < size; ++j)
        entries.emplace_back(3 * contact + i, system * size + j, block(i, j));
  }
  problem.w.segment<3>(3 * contact) = options.external_velocity * (frame * draw.normals(3, 1));
  problem.laws.push_back({LawType::COULOMB_3D, draw.uniform(options.friction_min, options.friction_max)});
}

std::vector<RandomFamilyEntry> table(const std::vector<RandomFamilyOptions>& lines, bool with_size)
{
  std::vector<RandomFamilyEntry> result;
  for (const RandomFamilyOptions& line : lines)
  {
    std::string name = "alea-" + std::to_string(line.velocities) + "-" + std::to_string(line.contacts);
    if (with_size)
      name += "-" + std::to_string(line.subsystem_velocities);
    result.push_back({name, line});
  }
  return result;
}

RandomFamilyOptions line(int velocities, int contacts, int subsystem_velocities, std::uint64_t seed)
{
  RandomFamilyOptions options;
  options.velocities = velocities;
  options.contacts = contacts;
  options.subsystem_velocities = subsystem_velocities;
  options.seed = seed;
  return options;
}
}  // namespace

void RandomFamilyOptions::validate() const
{
  constexpr const char* FAMILY = "random family";
  requireRange(FAMILY, "subsystem_velocities", subsystem_velocities, 1, MAX_SUBSYSTEM);
  requireRange(FAMILY, "velocities", velocities, 2 * subsystem_velocities, MAX_COUNT);
  if (velocities % subsystem_velocities != 0)
    throw std::invalid_argument("random family: velocities is " + std::to_string(velocities) +
                                ", expected a multiple of subsystem_velocities (" +
                                std::to_string(subsystem_velocities) + ")");
  requireRange(FAMILY, "contacts", contacts, 0, MAX_COUNT);
  requireRange(FAMILY, "condition", condition, 1.0, MAX_CONDITION);
  requireRange(FAMILY, "external_velocity", external_velocity, 0.0, MAX_SPEED);
  requireRange(FAMILY, "friction_min", friction_min, 0.0, MAX_FRICTION);
  requireRange(FAMILY, "friction_max", friction_max, friction_min, MAX_FRICTION);
}

IncrementalProblem randomFamilyProblem(const RandomFamilyOptions& options)
{
  options.validate();
  RandomDraw draw(options.seed);
  IncrementalProblem problem;
  const int velocities = options.velocities;
  Triplets mass, kinematics;
  for (int first = 0; first < velocities; first += options.subsystem_velocities)
    addMassBlock(options, first, draw, mass);
  problem.M = assemble(velocities, velocities, mass);
  problem.f = draw.normals(velocities, 1);
  problem.w.resize(3 * options.contacts);
  for (int contact = 0; contact < options.contacts; ++contact)
    addContact(options, contact, draw, problem, kinematics);
  problem.H = assemble(3 * options.contacts, velocities, kinematics);
  problem.G.resize(0, velocities);
  problem.b.resize(0);
  return problem;
}

std::vector<RandomFamilyEntry> smallRandomFamily()
{
  return table(
      {line(42, 5, 6, 1), line(48, 8, 6, 1), line(54, 11, 6, 1), line(60, 14, 6, 1), line(66, 17, 6, 1),
       line(72, 20, 6, 1), line(78, 23, 6, 1), line(84, 26, 6, 1), line(90, 29, 6, 1), line(96, 32, 6, 1),
       line(102, 35, 6, 1), line(108, 38, 6, 1), line(114, 41, 6, 1), line(120, 44, 6, 1), line(126, 47, 6, 1)},
      false);
}

std::vector<RandomFamilyEntry> largeRandomFamily()
{
  return table({line(750, 100, 6, 1), line(1002, 200, 6, 1), line(1122, 300, 6, 1), line(1200, 400, 6, 1),
                line(1248, 500, 6, 1), line(750, 100, 15, 1), line(1005, 200, 15, 1), line(1125, 300, 15, 1),
                line(1200, 400, 15, 1), line(1245, 500, 15, 1), line(756, 100, 36, 1), line(1008, 200, 36, 1),
                line(1116, 300, 36, 1), line(1188, 400, 36, 1), line(1260, 500, 36, 1)},
               true);
}

}  // namespace frictional_contact_sim
