#pragma once
/**
 * @file eigen_instances.h
 * @brief Instances of Eigen's templates (3.4) that many files need, compiled once, in eigen_instances.cpp.
 *
 * It comes with the precompiled headers (CMakeLists.txt); no file needs to include it. What is not listed here a file
 * instantiates for itself, to the same result.
 */
#include <Eigen/Dense>
#include <Eigen/SparseCore>

#ifndef EIGEN_INSTANCE
#define EIGEN_INSTANCE extern template
#endif

namespace Eigen
{
EIGEN_INSTANCE class LLT<MatrixXd>;
EIGEN_INSTANCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
EIGEN_INSTANCE class LDLT<MatrixXd>;
EIGEN_INSTANCE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
EIGEN_INSTANCE class PartialPivLU<MatrixXd>;
EIGEN_INSTANCE class FullPivLU<MatrixXd>;
EIGEN_INSTANCE class ColPivHouseholderQR<MatrixXd>;
EIGEN_INSTANCE void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
EIGEN_INSTANCE void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
EIGEN_INSTANCE class CompleteOrthogonalDecomposition<MatrixXd>;
EIGEN_INSTANCE void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
EIGEN_INSTANCE void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
EIGEN_INSTANCE class SelfAdjointEigenSolver<MatrixXd>;
EIGEN_INSTANCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                                           int);

namespace internal
{
// Parts of these decompositions, for matrices given in other types.
EIGEN_INSTANCE void tridiagonalization_inplace(MatrixXd&, VectorXd&);
EIGEN_INSTANCE ComputationInfo computeFromTridiagonal_impl(VectorXd&, VectorXd&, Index, bool, MatrixXd&);
EIGEN_INSTANCE void apply_block_householder_on_the_left(Block<MatrixXd>&, const Block<MatrixXd>&,
                                                        const VectorBlock<const VectorXd>&, bool);

// Products: matrix times vector by columns and by rows; what matrix times matrix is made of.
namespace instances
{
using Columns = const_blas_data_mapper<double, Index, ColMajor>;
using Rows = const_blas_data_mapper<double, Index, RowMajor>;
using Result = blas_data_mapper<double, Index, ColMajor, Unaligned, 1>;
using Gebp = gebp_traits<double, double>;
using Packet = Gebp::LhsPacket4Packing;
}  // namespace instances
EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, instances::Columns, ColMajor, false, double,
                                                    instances::Columns, false>;
EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, instances::Columns, ColMajor, false, double,
                                                    instances::Rows, false>;
EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, instances::Rows, RowMajor, false, double,
                                                    instances::Columns, false>;
EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, instances::Rows, RowMajor, false, double,
                                                    instances::Rows, false, BuiltIn>;
EIGEN_INSTANCE struct gebp_kernel<double, double, Index, instances::Result, instances::Gebp::mr, instances::Gebp::nr>;
EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, instances::Columns, instances::Gebp::mr,
                                    instances::Gebp::LhsProgress, instances::Packet, ColMajor>;
EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, instances::Rows, instances::Gebp::mr, instances::Gebp::LhsProgress,
                                    instances::Packet, RowMajor>;
EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, instances::Columns, instances::Gebp::nr, ColMajor>;
EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, instances::Rows, instances::Gebp::nr, RowMajor>;
EIGEN_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&, Index&, Index&, Index);
EIGEN_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&, Index&, Index&, Index);
EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor, ColMajor, 1>;
EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor, ColMajor, 1>;
EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower, false, ColMajor, ColMajor, 1>;
EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, RowMajor, ColMajor, 1>;

// The matrices of the problems are sparse, by rows.
EIGEN_INSTANCE void assign_sparse_to_sparse(SparseMatrix<double, RowMajor>&, const SparseMatrix<double, RowMajor>&);
}  // namespace internal
}  // namespace Eigen
