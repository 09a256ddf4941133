#include "comparison/siconos_matrix.h"

#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/SparseBlockMatrix.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace comparison
{
namespace
{
using frictional_contact_sim::DelassusOperator;

template <typename Value>
Value* allocate(size_t count)
{
  return static_cast<Value*>(std::calloc(std::max<size_t>(count, 1), sizeof(Value)));
}

/** All non-zero blocks and the diagonal ones, row by row, each in Fortran order. */
SparseBlockStructuredMatrix* makeBlocks(const DelassusOperator& W)
{
  const Eigen::MatrixXd dense = W.toDense();
  const auto blocks = static_cast<size_t>(W.blocks());
  SparseBlockStructuredMatrix* matrix = SBM_new();
  matrix->blocknumber0 = matrix->blocknumber1 = static_cast<unsigned>(blocks);
  matrix->blocksize0 = allocate<unsigned>(blocks);
  matrix->blocksize1 = allocate<unsigned>(blocks);
  matrix->filled1 = blocks + 1;
  matrix->index1_data = allocate<size_t>(blocks + 1);
  matrix->diagonal_blocks = allocate<unsigned>(blocks);
  std::vector<double*> values;
  std::vector<size_t> columns;
  for (int i = 0; i < W.blocks(); ++i)
  {
    const auto row = static_cast<size_t>(i);
    matrix->blocksize0[row] = matrix->blocksize1[row] = static_cast<unsigned>(W.offset(i) + W.dimension(i));
    for (int j = 0; j < W.blocks(); ++j)
    {
      const auto block = dense.block(W.offset(i), W.offset(j), W.dimension(i), W.dimension(j));
      if (i != j && (block.array() == 0.0).all())
        continue;
      if (i == j)
        matrix->diagonal_blocks[row] = static_cast<unsigned>(values.size());
      values.push_back(allocate<double>(static_cast<size_t>(block.size())));
      Eigen::Map<Eigen::MatrixXd>(values.back(), block.rows(), block.cols()) = block;
      columns.push_back(static_cast<size_t>(j));
    }
    matrix->index1_data[row + 1] = values.size();
  }
  matrix->nbblocks = static_cast<unsigned>(values.size());
  matrix->filled2 = values.size();
  matrix->block = allocate<double*>(values.size());
  matrix->index2_data = allocate<size_t>(values.size());
  std::copy(values.begin(), values.end(), matrix->block);
  std::copy(columns.begin(), columns.end(), matrix->index2_data);
  return matrix;
}
}  // namespace

const char* toString(Storage storage)
{
  switch (storage)
  {
    case Storage::DENSE:
      return "dense";
    case Storage::SPARSE_BLOCK:
      return "sparse blocks";
    case Storage::SPARSE:
      break;
  }
  return "sparse";
}

NumericsMatrix* copyToSiconos(const DelassusOperator& W, Storage storage)
{
  const int n = W.rows();
  if (storage == Storage::SPARSE_BLOCK)
    return NM_create_from_data(NM_SPARSE_BLOCK, n, n, makeBlocks(W));
  const Eigen::MatrixXd dense = W.toDense();
  if (storage == Storage::DENSE)
  {
    auto* values = allocate<double>(static_cast<size_t>(dense.size()));
    std::copy(dense.data(), dense.data() + dense.size(), values);
    return NM_create_from_data(NM_DENSE, n, n, values);
  }
  NumericsMatrix* matrix = NM_create(NM_SPARSE, n, n);
  NM_triplet_alloc(matrix, std::max<Eigen::Index>(1, (dense.array() != 0.0).count()));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      if (dense(i, j) != 0.0)
        NM_entry(matrix, i, j, dense(i, j));
  NM_csc(matrix);  // the form its products use
  return matrix;
}

}  // namespace comparison
