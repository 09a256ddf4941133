#include "frictional_contact_sim/problem/fclib.h"

#include "fclib_check.h"
#include "fclib_encoding.h"

// The header forgets to say that it is C.
extern "C"
{
#include <unistd.h>

#include <fclib.h>
}

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
using Triplets = std::vector<Eigen::Triplet<double>>;

/// |M_ij - M_ji| allowed, relative to sqrt(M_ii M_jj): text formats on the way keep 6 digits and more.
constexpr double SYMMETRY_TOLERANCE = 1e-6;

/** Triplets of a stored matrix, shifted by a row and a column offset, transposed on demand. */
void appendTriplets(const FclibMatrix& matrix, bool transpose, int row_offset, int column_offset, Triplets& triplets)
{
  const auto add = [&](int row, int column, double value)
  {
    if (transpose)
      triplets.emplace_back(row_offset + column, column_offset + row, value);
    else
      triplets.emplace_back(row_offset + row, column_offset + column, value);
  };
  for (size_t k = 0; k < static_cast<size_t>(std::max(matrix.nz, 0)); ++k)
    add(matrix.i[k], matrix.p[k], matrix.x[k]);
  const int outer = matrix.nz >= 0 ? 0 : matrix.nz == -1 ? matrix.columns : matrix.rows;
  for (int k = 0; k < outer; ++k)
    for (auto entry = static_cast<size_t>(matrix.p[k]); entry < static_cast<size_t>(matrix.p[k + 1]); ++entry)
      if (matrix.nz == -1)
        add(matrix.i[entry], k, matrix.x[entry]);
      else
        add(k, matrix.i[entry], matrix.x[entry]);
}

SparseRows fromTriplets(int rows, int columns, const Triplets& triplets)
{
  SparseRows result(rows, columns);
  result.setFromTriplets(triplets.begin(), triplets.end());
  result.makeCompressed();
  return result;
}

SparseRows toRows(const FclibMatrix& matrix, bool transpose)
{
  Triplets triplets;
  appendTriplets(matrix, transpose, 0, 0, triplets);
  return transpose ? fromTriplets(matrix.columns, matrix.rows, triplets)
                   : fromTriplets(matrix.rows, matrix.columns, triplets);
}

std::vector<Law> coulombLaws(int dimension, int contacts, const Eigen::VectorXd& mu)
{
  std::vector<Law> laws(static_cast<size_t>(contacts));
  for (int i = 0; i < contacts; ++i)
    laws[static_cast<size_t>(i)] = {dimension == 3 ? LawType::COULOMB_3D : LawType::COULOMB_2D, mu[i]};
  return laws;
}

/**
 * Makes M exactly symmetric. Finite element codes dump one triangle of a symmetric matrix: the other one is then
 * mirrored. Otherwise both must agree up to round-off.
 */
void symmetrise(const std::string& path, SparseRows& M)
{
  bool lower = false;
  bool upper = false;
  for (int row = 0; row < M.rows(); ++row)
    for (SparseRows::InnerIterator entry(M, row); entry; ++entry)
    {
      lower = lower || (entry.col() < row && entry.value() != 0.0);
      upper = upper || (entry.col() > row && entry.value() != 0.0);
    }
  const SparseRows transposed = M.transpose();
  if (lower != upper)
  {
    // Not by assigning to the diagonal: an entry that is not stored has no place to write to.
    const Eigen::VectorXd diagonal = M.diagonal();
    M = SparseRows(M + transposed) - SparseRows(diagonal.asDiagonal());
    M.makeCompressed();
    return;
  }
  const Eigen::VectorXd root = M.diagonal().cwiseAbs().cwiseSqrt();
  const SparseRows difference = M - transposed;
  for (int row = 0; row < M.rows(); ++row)
    for (SparseRows::InnerIterator entry(difference, row); entry; ++entry)
      if (std::abs(entry.value()) > SYMMETRY_TOLERANCE * root[row] * root[entry.col()])
        throw std::runtime_error(path + ": M(" + std::to_string(row) + ", " + std::to_string(entry.col()) +
                                 ") differs from its mirror image by " + std::to_string(entry.value()) +
                                 ", expected a symmetric matrix or one triangle of it");
  M = SparseRows(0.5 * (M + transposed));
  M.makeCompressed();
}

void readGlobal(const std::string& path, const FclibShape& shape, FclibProblem& result)
{
  const std::string root = "/fclib_global";
  IncrementalProblem& problem = result.global;
  problem.M = toRows(readMatrix(path, root + "/M"), false);
  symmetrise(path, problem.M);
  problem.f = -readNumbers(path, root + "/vectors/f");
  problem.H = toRows(readMatrix(path, root + "/H"), true);
  problem.w = readNumbers(path, root + "/vectors/w");
  problem.laws = coulombLaws(shape.dimension, shape.rows / shape.dimension, readNumbers(path, root + "/vectors/mu"));
  if (shape.bilaterals > 0)
  {
    problem.G = toRows(readMatrix(path, root + "/G"), true);
    problem.b = readNumbers(path, root + "/vectors/b");
  }
  else
    problem.G.resize(0, shape.velocities);
  result.info = readInfo(path, root);
  validate(problem);
}

void readLocal(const std::string& path, const FclibShape& shape, FclibProblem& result)
{
  const std::string root = "/fclib_local";
  DelassusProblem& problem = result.local;
  problem.laws = coulombLaws(shape.dimension, shape.rows / shape.dimension, readNumbers(path, root + "/vectors/mu"));
  problem.laws.resize(problem.laws.size() + static_cast<size_t>(shape.bilaterals), {LawType::BILATERAL, 0.0});
  const int size = shape.rows + shape.bilaterals;
  Triplets triplets;
  appendTriplets(readMatrix(path, root + "/W"), false, 0, 0, triplets);
  problem.q.resize(size);
  problem.q.head(shape.rows) = readNumbers(path, root + "/vectors/q");
  if (shape.bilaterals > 0)
  {
    const FclibMatrix V = readMatrix(path, root + "/V");
    appendTriplets(V, false, 0, shape.rows, triplets);
    appendTriplets(V, true, shape.rows, 0, triplets);
    appendTriplets(readMatrix(path, root + "/R"), false, shape.rows, shape.rows, triplets);
    problem.q.tail(shape.bilaterals) = readNumbers(path, root + "/vectors/s");
  }
  problem.W.assign(fromTriplets(size, size, triplets), problem.laws);
  result.info = readInfo(path, root);
  validate(problem);
}

/** libfclib ends the process on a null pointer, which the data of something empty is. */
template <typename Number>
Number* neverNull(Number* data)
{
  static Number nothing{};
  return data != nullptr ? data : &nothing;
}

/** Compressed rows handed to libfclib; keeps the arrays alive. */
class StoredMatrix
{
public:
  explicit StoredMatrix(SparseRows matrix) : values_(std::move(matrix))
  {
    values_.makeCompressed();
    matrix_.nzmax = static_cast<int>(values_.nonZeros());
    matrix_.m = static_cast<int>(values_.rows());
    matrix_.n = static_cast<int>(values_.cols());
    matrix_.p = neverNull(values_.outerIndexPtr());
    matrix_.i = neverNull(values_.innerIndexPtr());
    matrix_.x = neverNull(values_.valuePtr());
    matrix_.nz = -2;
    matrix_.info = nullptr;
  }
  StoredMatrix(const StoredMatrix&) = delete;
  StoredMatrix& operator=(const StoredMatrix&) = delete;
  fclib_matrix* get() { return &matrix_; }

private:
  SparseRows values_;
  fclib_matrix matrix_{};
};

/** Writes beside the target and renames, so that a failure leaves no half file and an old solution never survives. */
template <typename Write>
void writeBeside(const std::string& path, Write write)
{
  const H5Session session;
  if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
    throw std::runtime_error(path + ": is not a regular file, expected a file to write or a new name");
  // No two writers, of this process or others, share a name.
  static std::atomic<unsigned> written{0};
  const std::string temporary = path + ".part" + std::to_string(getpid()) + "_" + std::to_string(written++);
  if (!std::ofstream(temporary))
    throw std::runtime_error(path + ": cannot be written, expected a writable place");
  std::filesystem::remove(temporary);
  if (!write(temporary))
  {
    std::filesystem::remove(temporary);
    throw std::runtime_error(path + ": libfclib could not write it");
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error)
  {
    std::filesystem::remove(temporary);
    throw std::runtime_error(path + ": cannot be written: " + error.message());
  }
}

class StoredInfo
{
public:
  explicit StoredInfo(const FclibInfo& info) : copy_(info)
  {
    info_.title = copy_.title.data();
    info_.description = copy_.description.data();
    info_.math_info = copy_.math_info.data();
  }
  fclib_info* get() { return &info_; }

private:
  FclibInfo copy_;
  fclib_info info_{};
};

/** True when the solution was stored or none was given. */
bool writeSolution(const std::string& path, EncodedSolution* solution)
{
  if (solution == nullptr)
    return true;
  fclib_solution stored{};
  stored.v = solution->v.data();
  stored.u = neverNull(solution->u.data());
  stored.r = neverNull(solution->r.data());
  stored.l = solution->lambda.data();
  return fclib_write_solution(&stored, path.c_str()) == 1;
}
}  // namespace

FclibProblem readFclib(const std::string& path)
{
  const H5Session session;
  const FclibShape shape = checkFclib(path);
  FclibProblem result;
  result.kind = shape.kind;
  result.dimension = shape.dimension;
  result.contacts = shape.rows / shape.dimension;
  if (shape.kind == FclibKind::GLOBAL)
    readGlobal(path, shape, result);
  else
    readLocal(path, shape, result);
  if (shape.kind == FclibKind::GLOBAL)
  {
    result.global.scales = readScales(path, LAW_SCALES, result.contacts);
    result.global.bilateral_scales = readScales(path, BILATERAL_SCALES, shape.bilaterals);
  }
  else if (shape.bilaterals == 0)
    result.local.scales = readScales(path, LAW_SCALES, result.contacts);
  if (shape.has_solution)
    result.solution = readSolutionGroup(path, "/solution", shape);
  for (int k = 1; k <= shape.guesses; ++k)
    result.guesses.push_back(readSolutionGroup(path, "/guesses/" + std::to_string(k), shape));
  return result;
}

void writeFclib(const std::string& path, const IncrementalProblem& problem, const FclibInfo& info,
                const Solution* solution)
{
  validate(problem);
  EncodedGlobal encoded = encodeGlobal(problem, solution);
  StoredMatrix M(encoded.problem.M), H(encoded.problem.H.transpose()), G(encoded.problem.G.transpose());
  StoredInfo texts(info);
  Eigen::VectorXd f = -encoded.problem.f;
  fclib_global stored{};
  stored.M = M.get();
  stored.H = H.get();
  stored.G = encoded.problem.bilaterals() > 0 ? G.get() : nullptr;
  stored.mu = neverNull(encoded.friction.data());
  stored.f = neverNull(f.data());
  stored.b = neverNull(encoded.problem.b.data());
  stored.w = neverNull(encoded.problem.w.data());
  stored.spacedim = encoded.dimension;
  stored.info = texts.get();
  writeBeside(path,
              [&](const std::string& temporary)
              {
                return fclib_write_global(&stored, temporary.c_str()) == 1 &&
                       writeScales(temporary, encoded.problem.scales, encoded.problem.bilateral_scales) &&
                       writeSolution(temporary, solution == nullptr ? nullptr : &encoded.solution);
              });
}

void writeFclib(const std::string& path, const DelassusProblem& problem, const FclibInfo& info,
                const Solution* solution)
{
  validate(problem);
  EncodedLocal encoded = encodeLocal(problem, solution);
  StoredMatrix W(encoded.W), V(encoded.V), R(encoded.R);
  StoredInfo texts(info);
  const bool bilateral = encoded.s.size() > 0;
  fclib_local stored{};
  stored.W = W.get();
  stored.V = bilateral ? V.get() : nullptr;
  stored.R = bilateral ? R.get() : nullptr;
  stored.mu = neverNull(encoded.friction.data());
  stored.q = neverNull(encoded.q.data());
  stored.s = neverNull(encoded.s.data());
  stored.spacedim = encoded.dimension;
  stored.info = texts.get();
  writeBeside(path,
              [&](const std::string& temporary)
              {
                return fclib_write_local(&stored, temporary.c_str()) == 1 &&
                       writeScales(temporary, encoded.scales, {}) &&
                       writeSolution(temporary, solution == nullptr ? nullptr : &encoded.solution);
              });
}

}  // namespace frictional_contact_sim
