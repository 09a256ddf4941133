#pragma once
/**
 * @file dense_kernels.h
 * @brief Dense loops every solver spends time in, with vector clones (math/vector_clones.h): same bits on every
 * machine.
 */
#include <cstddef>

namespace frictional_contact_sim
{
/** @brief y = W x for a row-major W of rows x columns; y must not alias x. */
void denseProduct(const double* W, int rows, int columns, const double* x, double* y);

/** @brief Whether no value is infinite or NaN. */
bool allFinite(const double* values, std::ptrdiff_t count);

}  // namespace frictional_contact_sim
