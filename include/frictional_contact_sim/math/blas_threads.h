#pragma once
/**
 * @file blas_threads.h
 * @brief Tells the system's BLAS to work in one thread.
 *
 * OpenBLAS, where it is the one installed, splits products of some hundred rows over threads that wait for each other
 * by spinning: beside other busy processes a factorization of 20 ms then takes seconds. Its switch is looked up by name
 * when the library loads, since Debian lets the user choose the BLAS; another BLAS is left as it is. The switch is one
 * for the process, so it is set once, at the first call, and never put back: another thread may be factoring.
 */
namespace frictional_contact_sim
{
void useOneBlasThread();

}  // namespace frictional_contact_sim
