#pragma once
/**
 * @file integer_program.h
 * @brief A mixed integer linear program (7.11), min c.x, A x <= b, E x = e, some x_j whole: MPS files, random ones, and
 * its linear relaxation (7.12).
 */
#include <cstdint>
#include <string>
#include <vector>

#include "frictional_contact_sim/separation/polyhedron.h"

namespace frictional_contact_sim
{
struct IntegerProgram
{
  std::string name;
  Eigen::VectorXd cost;  ///< c, to minimise
  double offset = 0.0;  ///< of the objective
  bool maximises = false;  ///< objective() has the other sign
  Polyhedron inequalities;  ///< bounds of the variables among them
  Polyhedron equations;  ///< E x = e
  std::vector<bool> whole;  ///< x_j must be
  std::vector<std::string> variables;

  int size() const { return static_cast<int>(cost.size()); }
  /** @brief The objective as it is spoken of. */
  double objective(const Eigen::VectorXd& x) const { return (maximises ? -1.0 : 1.0) * cost.dot(x) + offset; }
};

/**
 * @brief By the reader of Clp: fixed or free format; a whole variable without bounds is 0 or 1, as MPS has it.
 * @throws std::invalid_argument in one line: no such file, no MPS file, no integer variable, a
 * section OBJSENSE
 */
IntegerProgram readMps(const std::string& path);
/** @brief With all digits. @throws std::runtime_error when the file cannot be written */
void writeMps(const IntegerProgram& program, const std::string& path);

/**
 * @brief A dense program like those of section 7.4, whose draw the thesis does not give: max c.x, A x <= b, x >= 0
 * whole, a_ij and c_j uniform among 1 .. 100, b_i = sum over j of a_ij (x = (1, ..., 1) fulfils all).
 * @throws std::invalid_argument unless variables and constraints >= 1
 */
IntegerProgram randomIntegerProgram(int variables, int constraints, std::uint64_t seed);

struct RelaxedSolution
{
  LinearProgramStatus status = LinearProgramStatus::STOPPED;
  Eigen::VectorXd x;  ///< basic: a vertex where the polyhedron has one
  double cost = 0.0;  ///< c.x
};

/** @param cuts further rows */
RelaxedSolution solveRelaxation(const IntegerProgram& program, const Polyhedron& cuts);

/** @brief The x_j that is to be whole and is farthest from it; -1: none is by more than 1e-6. */
int mostFractional(const IntegerProgram& program, const Eigen::VectorXd& x);

}  // namespace frictional_contact_sim
