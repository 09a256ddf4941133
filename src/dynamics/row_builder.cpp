#include "frictional_contact_sim/dynamics/row_builder.h"

#include <algorithm>

namespace frictional_contact_sim
{
void RowBuilder::copyTo(int columns, SparseRows& matrix) const
{
  // SparseMatrix::resize allocates for zero rows even when nothing changes.
  if (matrix.rows() != rows() || matrix.cols() != columns)
    matrix.resize(rows(), columns);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(columns_.size()));
  std::copy(starts_.begin(), starts_.end(), matrix.outerIndexPtr());
  std::copy(columns_.begin(), columns_.end(), matrix.innerIndexPtr());
  std::copy(values_.begin(), values_.end(), matrix.valuePtr());
}

}  // namespace frictional_contact_sim
