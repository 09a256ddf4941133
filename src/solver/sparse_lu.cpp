#include "frictional_contact_sim/solver/sparse_lu.h"

#include <Eigen/SparseLU>
#include <Eigen/UmfPackSupport>
#include <algorithm>
#include <mutex>
#include <vector>

#include "frictional_contact_sim/math/blas_threads.h"

namespace frictional_contact_sim
{
namespace
{
/// A diagonal entry of at least this share of the largest in its column is taken as the pivot: less fill.
constexpr double PIVOT_THRESHOLD = 0.1;
/// UMFPACK above this many rows: three to fifteen times quicker on packings; below, its analysis does not pay.
constexpr int MULTIFRONTAL_ROWS = 1800;
/// Nested dissection (METIS) above this many rows: it costs three times as much as minimum degree and halves the fill.
constexpr int DISSECTION_ROWS = 5000;
}  // namespace

struct SparseLu::Workspace
{
  Matrix matrix;
  std::vector<int> columns, rows;  ///< pattern of the last analysis
  Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> supernodal;
  Eigen::UmfPackLU<Matrix> multifrontal;
  Eigen::VectorXd right;

  bool isLarge() const { return matrix.cols() > MULTIFRONTAL_ROWS; }
  void analyse();
  void analyseLarge();
};

/** Orders the columns for the factorization, when the pattern is not that of the last call. */
void SparseLu::Workspace::analyse()
{
  const int* const outer = matrix.outerIndexPtr();
  const int* const inner = matrix.innerIndexPtr();
  const int* const outer_end = outer + matrix.cols() + 1;
  const int* const inner_end = inner + matrix.nonZeros();
  if (std::equal(outer, outer_end, columns.begin(), columns.end()) &&
      std::equal(inner, inner_end, rows.begin(), rows.end()))
    return;
  columns.clear();  // until the analysis has succeeded: it may throw for want of memory
  if (isLarge())
    analyseLarge();
  else
  {
    supernodal.setPivotThreshold(PIVOT_THRESHOLD);
    supernodal.analyzePattern(matrix);
  }
  rows.assign(inner, inner_end);
  columns.assign(outer, outer_end);
}

void SparseLu::Workspace::analyseLarge()
{
  // The pattern is symmetric and the diagonal strong: an ordering of A + A', pivots from the diagonal where possible.
  auto& control = multifrontal.umfpackControl();
  control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  control[UMFPACK_ORDERING] = matrix.cols() > DISSECTION_ROWS ? UMFPACK_ORDERING_METIS : UMFPACK_ORDERING_AMD;
  control[UMFPACK_IRSTEP] = 0.0;
  // METIS draws from the process's one rand(), seeded at its start: two at once would not order as one does.
  static std::mutex ordering;
  const std::lock_guard<std::mutex> lock(ordering);
  multifrontal.analyzePattern(matrix);
}

SparseLu::SparseLu() : workspace_(std::make_unique<Workspace>())
{
}

SparseLu::~SparseLu() = default;

SparseLu::Matrix& SparseLu::matrix()
{
  return workspace_->matrix;
}

bool SparseLu::factor()
{
  Workspace& work = *workspace_;
  work.analyse();
  if (work.isLarge())
  {
    useOneBlasThread();
    work.multifrontal.factorize(work.matrix);
    return work.multifrontal.info() == Eigen::Success;
  }
  work.supernodal.factorize(work.matrix);
  return work.supernodal.info() == Eigen::Success;
}

void SparseLu::solve(Eigen::Ref<Eigen::VectorXd> x)
{
  Workspace& work = *workspace_;
  if (work.isLarge())
  {
    // UMFPACK does not solve in place.
    work.right = x;
    x = work.multifrontal.solve(work.right);
  }
  else
    x = work.supernodal.solve(x);
}

}  // namespace frictional_contact_sim
