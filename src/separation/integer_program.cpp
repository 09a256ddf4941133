#include "frictional_contact_sim/separation/integer_program.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include "dense_rows.h"

namespace frictional_contact_sim
{
namespace
{
/// As near to a whole number counts as one.
constexpr double WHOLE = 1e-6;
}  // namespace

IntegerProgram randomIntegerProgram(int variables, int constraints, std::uint64_t seed)
{
  if (variables < 1 || constraints < 1)
    throw std::invalid_argument("random integer program: " + std::to_string(variables) + " variables and " +
                                std::to_string(constraints) + " constraints, expected one at least of each");
  std::mt19937_64 engine(seed);
  const auto draw = [&] { return 1.0 + static_cast<double>(engine() % 100); };
  IntegerProgram program;
  program.name = "n" + std::to_string(variables) + "-m" + std::to_string(constraints) + "-s" + std::to_string(seed);
  program.maximises = true;
  program.cost.resize(variables);
  program.inequalities.A.setZero(constraints + variables, variables);
  program.inequalities.b.setZero(constraints + variables);
  for (int i = 0; i < constraints; ++i)
  {
    for (int j = 0; j < variables; ++j)
      program.inequalities.A(i, j) = draw();
    program.inequalities.b[i] = program.inequalities.A.row(i).sum();
  }
  for (int j = 0; j < variables; ++j)
  {
    program.inequalities.A(constraints + j, j) = -1.0;
    program.cost[j] = -draw();
    program.variables.push_back("x" + std::to_string(j));
  }
  program.equations = {Eigen::MatrixXd(0, variables), Eigen::VectorXd(0)};
  program.whole.assign(static_cast<size_t>(variables), true);
  return program;
}

RelaxedSolution solveRelaxation(const IntegerProgram& program, const Polyhedron& cuts)
{
  LinearProgram relaxation;
  // Costs of order one: tolerances are absolute.
  const double size = program.cost.size() == 0 ? 0.0 : program.cost.lpNorm<Eigen::Infinity>();
  for (int j = 0; j < program.size(); ++j)
    relaxation.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, size > 0.0 ? program.cost[j] / size : 0.0);
  for (const Polyhedron* part : {&program.inequalities, &program.equations, &cuts})
  {
    const Polyhedron unit = withUnitRows(*part);
    for (int i = 0; i < unit.rows(); ++i)
      addDenseRow(relaxation, part == &program.equations ? unit.b[i] : -LinearProgram::INFINITE, unit.b[i],
                  unit.A.row(i), 0);
  }
  RelaxedSolution solution;
  solveFirst(relaxation);
  solution.status = relaxation.status();
  if (solution.status == LinearProgramStatus::OPTIMAL)
  {
    solution.x = relaxation.solution();
    solution.cost = program.cost.dot(solution.x);
  }
  return solution;
}

int mostFractional(const IntegerProgram& program, const Eigen::VectorXd& x)
{
  int best = -1;
  double farthest = WHOLE;
  for (int j = 0; j < program.size(); ++j)
  {
    const double distance = std::abs(x[j] - std::round(x[j]));
    if (program.whole[static_cast<size_t>(j)] && distance > farthest)
    {
      farthest = distance;
      best = j;
    }
  }
  return best;
}

}  // namespace frictional_contact_sim
