#pragma once
/**
 * @file siconos_matrix.h
 * @brief A Delassus matrix in each of Siconos's storages.
 */
#include "frictional_contact_sim/problem/delassus_operator.h"

struct NumericsMatrix;

namespace comparison
{
enum class Storage
{
  DENSE,
  SPARSE_BLOCK,
  SPARSE
};

const char* toString(Storage storage);

/** @brief Copies W; the matrix is Siconos's own (malloc) and lives as long as the (child) process. */
NumericsMatrix* copyToSiconos(const frictional_contact_sim::DelassusOperator& W, Storage storage);

}  // namespace comparison
