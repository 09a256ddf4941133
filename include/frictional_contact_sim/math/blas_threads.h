#pragma once
/**
 * @file blas_threads.h
 * @brief While an object of this class lives, the system's BLAS works in one thread.
 *
 * OpenBLAS, where it is the one installed, splits products of some hundred rows over threads that wait for each other
 * by spinning: beside other busy processes a factorization of 20 ms then takes seconds. Its switch is looked up by name
 * when the library loads, since Debian lets the user choose the BLAS; another BLAS is left as it is. The switch is one
 * for the process, so nest calls, do not let two threads interleave them.
 */
namespace frictional_contact_sim
{
class OneBlasThread
{
public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

private:
  int before_ = 0;  ///< threads to go back to; 0 = nothing was switched
};

}  // namespace frictional_contact_sim
