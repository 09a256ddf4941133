#pragma once
/**
 * @file market_file.h
 * @brief A matrix as finite-element programs export it.
 */
#include <sstream>
#include <string>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief Text of a Matrix Market file. @param symmetric only the entries on the diagonal and below */
inline std::string marketFile(const SparseRows& matrix, bool symmetric)
{
  std::ostringstream text;
  text.precision(17);
  long count = 0;
  std::ostringstream entries;
  entries.precision(17);
  for (int row = 0; row < matrix.rows(); ++row)
    for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      if (!symmetric || entry.col() <= row)
      {
        entries << row + 1 << ' ' << entry.col() + 1 << ' ' << entry.value() << '\n';
        ++count;
      }
  text << "%%MatrixMarket matrix coordinate real " << (symmetric ? "symmetric" : "general") << "\n% made by a test\n"
       << matrix.rows() << ' ' << matrix.cols() << ' ' << count << '\n'
       << entries.str();
  return text.str();
}

}  // namespace test_support
}  // namespace frictional_contact_sim
