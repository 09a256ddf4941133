#pragma once
/**
 * @file dense_rows.h
 * @brief Linear programs of dense rows: how rows are added, and a first solve whose word can be taken.
 */
#include <vector>

#include "frictional_contact_sim/problem/linear_program.h"

namespace frictional_contact_sim
{
/** @brief Columns and values of a row that is put together from several parts. */
struct ProgramRow
{
  std::vector<int> columns;
  std::vector<double> values;

  void add(int column, double value)
  {
    if (value == 0.0)
      return;
    columns.push_back(column);
    values.push_back(value);
  }
  /** @param first column of the first value */
  template <typename Values>
  void add(const Values& row, int first, double factor = 1.0)
  {
    for (Eigen::Index j = 0; j < row.size(); ++j)
      add(first + static_cast<int>(j), factor * row[j]);
  }
  int addTo(LinearProgram& program, double lower, double upper) const
  {
    return program.addRow(lower, upper, columns, values);
  }
};

/**
 * @brief The first solve. Clp's presolve now and then calls a program infeasible that is not (a vertex with zeros and
 * round-off among its rows); the primal simplex method from the basis it leaves has the last word.
 */
inline bool solveFirst(LinearProgram& program)
{
  constexpr int SIMPLEX_ITERATIONS = 200000;
  return program.solve(SIMPLEX_ITERATIONS) || program.solvePrimal(SIMPLEX_ITERATIONS);
}

template <typename Values>
void addDenseRow(LinearProgram& program, double lower, double upper, const Values& values, int first)
{
  ProgramRow row;
  row.add(values, first);
  row.addTo(program, lower, upper);
}

}  // namespace frictional_contact_sim
