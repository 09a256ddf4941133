#include "frictional_contact_sim/math/dense_kernels.h"

#include "frictional_contact_sim/math/vector_clones.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int LANES = 8;
}

VECTOR_CLONES void denseProduct(const double* W, int rows, int columns, const double* x, double* y)
{
  for (int i = 0; i < rows; ++i, W += columns)
  {
    double sums[LANES] = {};
    int j = 0;
    for (; j + LANES <= columns; j += LANES)
      for (int lane = 0; lane < LANES; ++lane)
        sums[lane] += W[j + lane] * x[j + lane];
    double rest = 0.0;
    for (; j < columns; ++j)
      rest += W[j] * x[j];
    y[i] = rest + (((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7])));
  }
}

VECTOR_CLONES bool allFinite(const double* values, std::ptrdiff_t count)
{
  // 0 * x is 0 for finite x, NaN otherwise.
  double sums[LANES] = {};
  std::ptrdiff_t k = 0;
  for (; k + LANES <= count; k += LANES)
    for (int lane = 0; lane < LANES; ++lane)
      sums[lane] += 0.0 * values[k + lane];
  double rest = 0.0;
  for (; k < count; ++k)
    rest += 0.0 * values[k];
  for (double sum : sums)
    rest += sum;
  return rest == 0.0;
}

}  // namespace frictional_contact_sim
