#pragma once
/**
 * @file sparse_lu.h
 * @brief LU of a sparse matrix with a symmetric pattern and a strong diagonal, as those of semismooth_newton.h; n x n.
 *
 * A pivot from the diagonal is preferred (from 0.1 of the largest of its column on, 0.001 with many rows), and nothing
 * is refined: Fischer-Burmeister systems keep a factorization of their own, with partial pivoting. Few rows: Eigen's
 * supernodal SparseLU, columns ordered by COLAMD (Li, Demmel 2005). Many rows: UMFPACK's multifrontal method (Davis
 * 2004), ordered on A + A' by minimum degree or nested dissection, in one BLAS thread. The pattern is analysed only
 * when it is another than last time; storage is reused, but both libraries allocate.
 */
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace frictional_contact_sim
{
class SparseLu
{
public:
  using Matrix = Eigen::SparseMatrix<double>;

  SparseLu();
  ~SparseLu();

  /** @brief To be filled, compressed, before factor(); it is not changed. */
  Matrix& matrix();
  /** @return false when the matrix is singular */
  bool factor();
  /** @brief x <- A^-1 x with the factors of the last factor(). */
  void solve(Eigen::Ref<Eigen::VectorXd> x);

private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace frictional_contact_sim
