#pragma once
/**
 * @file delassus_operator.h
 * @brief The Delassus matrix W = H M^-1 H^T [1/kg] behind one concrete class: dense storage when small, block rows when
 * large, or only its half Z. No virtual call; the inner products are inline.
 *
 * Rows are grouped in blocks of 1, 2 or 3, one block a law, in the order of the laws.
 *   dense        all rows, contiguous (row-major), so that a block's product is D dot products;
 *   sparse       a block row stores the columns it touches and, column by column, its D values;
 *   matrix-free  W = Z Z^T is never formed: Z = H C^-T (M = C C^T) in block rows and the diagonal blocks W_ii are kept;
 *                a product is Z (Z^T x). Only apply(), applyTransposed() and diagonalBlock() work.
 *
 * W need not be exactly symmetric (measured problems are not); nothing here assumes it.
 */
#include <Eigen/Core>
#include <string>
#include <vector>

#include "frictional_contact_sim/math/cone.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/problem/law.h"

namespace frictional_contact_sim
{
/** @brief How W is kept. AUTOMATIC: dense or sparse by size and density. */
enum class OperatorKind
{
  AUTOMATIC,
  DENSE,
  SPARSE,
  MATRIX_FREE
};

/** @brief "automatic", "dense", "sparse", "matrix_free". */
const char* toString(OperatorKind kind);
/** @throws std::invalid_argument on an unknown name; the message lists the valid ones. */
OperatorKind operatorKind(const std::string& name);

/** @brief What a method needs of W. */
enum class OperatorUse
{
  PRODUCTS,  ///< W x and the diagonal blocks: runs matrix-free
  BLOCK_ROWS,  ///< the entries, block row by block row: dense or sparse
  DENSE  ///< all entries as one dense matrix, whatever the storage
};

/** @brief "products", "block rows", "dense". */
const char* toString(OperatorUse use);

class DelassusOperator
{
public:
  using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /**
   * @brief The automatic choice of storage. Dense loops are quicker an entry: the fewer the rows, the emptier W must be
   * to be kept sparse.
   * @param share stored entries by all entries [-]
   */
  static bool prefersDense(int rows, double share);

  /** @brief Sets the blocks and dense storage (values undefined); fill it through dense(). No allocation when
   * unchanged. */
  void resizeDense(const std::vector<Law>& laws);
  /** @brief The dense values, to be filled or read. Only valid when isDense(). */
  Dense& dense() { return dense_; }
  const Dense& dense() const { return dense_; }

  /**
   * @brief Sets the blocks and block-row storage with the given pattern, values zero.
   * @param begin laws + 1, into block_columns
   * @param block_columns for each block row, the blocks it touches in ascending order, the diagonal always among them
   */
  void resizeSparse(const std::vector<Law>& laws, const std::vector<int>& begin, const std::vector<int>& block_columns);
  /** @brief Values of block (i, j): dimension(i) x dimension(j), column-major. @return nullptr when not stored. */
  double* block(int i, int j);

  /**
   * @brief Matrix-free storage: copies Z, block row by block row. No allocation when an earlier call had the same
   * shapes.
   * @param touched_begin laws + 1, into touched: the columns of Z that block row i touches
   * @param values of Z, dimension(i) a touched column
   * @param columns of Z: the number of velocities
   */
  void assignHalf(const std::vector<Law>& laws, const std::vector<int>& touched_begin, const std::vector<int>& touched,
                  const std::vector<double>& values, int columns);

  /**
   * @brief Copies a matrix, choosing the storage by size and density unless it is DENSE or SPARSE.
   * @throws std::invalid_argument on wrong shape
   */
  void assign(const SparseRows& matrix, const std::vector<Law>& laws, OperatorKind kind = OperatorKind::AUTOMATIC);
  void assign(const Eigen::MatrixXd& matrix, const std::vector<Law>& laws);

  /**
   * @brief The principal sub-matrix of some blocks of another operator: dense or sparse by its own size and density, or
   * as `kind` says; matrix-free when the other is. Blocks that couple them with others are dropped. No allocation when
   * an earlier call had the same shapes.
   * @param blocks which, ascending; laws are theirs
   * @param position for every block of `whole` its place in `blocks`, or -1
   */
  void assignBlocks(const DelassusOperator& whole, const std::vector<int>& blocks, const std::vector<int>& position,
                    const std::vector<Law>& laws, OperatorKind kind = OperatorKind::AUTOMATIC);

  int rows() const { return offsets_.empty() ? 0 : offsets_.back(); }
  int blocks() const { return static_cast<int>(offsets_.size()) - (offsets_.empty() ? 0 : 1); }
  /** @brief First row of block i. */
  int offset(int i) const { return offsets_[static_cast<size_t>(i)]; }
  /** @brief The block of a row or column. */
  int blockOf(int row) const { return block_of_row_[static_cast<size_t>(row)]; }
  int dimension(int i) const { return offset(i + 1) - offset(i); }
  bool isDense() const { return is_dense_; }
  bool isMatrixFree() const { return is_matrix_free_; }
  /** @brief All stored values, for checks. */
  const double* valueData() const { return is_dense_ ? dense_.data() : values_.data(); }
  Eigen::Index valueCount() const { return is_dense_ ? dense_.size() : static_cast<Eigen::Index>(values_.size()); }

  /** @brief y = W x; y must not alias x. */
  void apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  /** @brief y = W^T x; y must not alias x. */
  void applyTransposed(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  /** @brief (W x) restricted to block i. Not matrix-free. */
  template <int D>
  Vector<D> rowProduct(int i, const Eigen::VectorXd& x) const;
  /** @brief W_ii. */
  template <int D>
  SquareMatrix<D> diagonalBlock(int i) const;

  /**
   * @brief Visits block row i: visit(column, pointer to D values, stride between them) for every stored column.
   * @throws std::logic_error when matrix-free
   */
  template <typename Visitor>
  void visitRow(int i, Visitor visit) const;
  /** @brief The same for block row i of Z. Only matrix-free. */
  template <typename Visitor>
  void visitHalfRow(int i, Visitor visit) const;
  /** @brief Columns of Z. Only matrix-free. */
  int halfColumns() const { return static_cast<int>(half_.size()); }

  Eigen::MatrixXd toDense() const;
  SparseRows toSparse() const;

private:
  void setBlocks(const std::vector<Law>& laws);
  double storedShare(const std::vector<int>& blocks, const std::vector<int>& position, int rows) const;
  void assignSparseBlocks(const DelassusOperator& whole, const std::vector<int>& blocks,
                          const std::vector<int>& position);
  void assignHalfBlocks(const DelassusOperator& whole, const std::vector<int>& blocks);
  void computeDiagonal();
  template <int D>
  void addHalfProduct(int i, const Eigen::VectorXd& x) const;
  template <int D>
  Vector<D> storedProduct(int i, const Eigen::VectorXd& x) const;
  [[noreturn]] static void throwMatrixFree();

  bool is_matrix_free_ = false;
  bool is_dense_ = true;
  std::vector<int> block_of_row_;  ///< rows
  std::vector<int> offsets_;  ///< blocks + 1, first row of each block
  Dense dense_;  ///< rows x rows, or empty
  std::vector<int> columns_;  ///< touched columns of W, or of Z when matrix-free, block row by block row
  std::vector<int> row_begin_;  ///< blocks + 1, into columns_
  std::vector<int> value_begin_;  ///< blocks + 1, into values_
  std::vector<int> diagonal_;  ///< blocks, into values_: where W_ii starts
  std::vector<double> values_;  ///< matrix-free: those of Z, then those of the diagonal blocks
  mutable Eigen::VectorXd half_;  ///< Z^T x
  std::vector<int> place_;  ///< workspace: new number of a column of Z, or -1
};

template <int D>
inline Vector<D> DelassusOperator::rowProduct(int i, const Eigen::VectorXd& x) const
{
  Vector<D> y;
  if (is_dense_)
  {
    y.noalias() = dense_.middleRows<D>(offset(i)).lazyProduct(x);
    return y;
  }
  return storedProduct<D>(i, x);
}

template <int D>
inline Vector<D> DelassusOperator::storedProduct(int i, const Eigen::VectorXd& x) const
{
  // Two sums: one would wait for its own last addition at every column.
  Vector<D> even = Vector<D>::Zero(), odd = Vector<D>::Zero();
  const auto row = static_cast<size_t>(i);
  const double* value = values_.data() + value_begin_[row];
  const int* column = columns_.data() + row_begin_[row];
  const int* const end = columns_.data() + row_begin_[row + 1];
  for (; end - column >= 2; column += 2, value += 2 * D)
  {
    even += x[column[0]] * Eigen::Map<const Vector<D>>(value);
    odd += x[column[1]] * Eigen::Map<const Vector<D>>(value + D);
  }
  if (column < end)
    even += x[*column] * Eigen::Map<const Vector<D>>(value);
  return even + odd;
}

template <int D>
inline SquareMatrix<D> DelassusOperator::diagonalBlock(int i) const
{
  if (is_dense_)
    return dense_.block<D, D>(offset(i), offset(i));
  return Eigen::Map<const SquareMatrix<D>>(values_.data() + diagonal_[static_cast<size_t>(i)]);
}

template <typename Visitor>
inline void DelassusOperator::visitRow(int i, Visitor visit) const
{
  if (is_dense_)
  {
    const double* value = dense_.data() + static_cast<std::ptrdiff_t>(offset(i)) * dense_.cols();
    for (int column = 0; column < rows(); ++column)
      visit(column, value + column, static_cast<int>(dense_.cols()));
    return;
  }
  if (is_matrix_free_)
    throwMatrixFree();
  visitHalfRow(i, visit);
}

template <typename Visitor>
inline void DelassusOperator::visitHalfRow(int i, Visitor visit) const
{
  const auto row = static_cast<size_t>(i);
  const int d = dimension(i);
  const double* value = values_.data() + value_begin_[row];
  for (int k = row_begin_[row]; k < row_begin_[row + 1]; ++k, value += d)
    visit(columns_[static_cast<size_t>(k)], value, 1);
}

}  // namespace frictional_contact_sim
