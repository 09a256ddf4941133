#pragma once
/**
 * @file pacer.h
 * @brief Holds simulated time to wall-clock time, and measures the real-time factor. Pure: wall-clock time is an
 * argument.
 */
namespace frictional_contact_sim
{
class Pacer
{
public:
  /** @param factor simulated over wall-clock time; 0 = as fast as possible */
  explicit Pacer(double factor);

  /** @brief Begins anew, after a pause for example. Times in s. */
  void restart(double simulated, double wall);
  /**
   * @brief Wall-clock time to wait before the state at `simulated` is due [s]. A run that is late by more than a tenth
   * of a second gives up the lost time rather than race after it.
   */
  double wait(double simulated, double wall);
  /** @brief Takes a measurement at the end of a step. */
  void measure(double simulated, double wall);
  /** @brief Simulated over wall-clock time over the last quarter of a second or so; 0 before there is a measurement. */
  double realTimeFactor() const;
  /** @brief The same over all that was measured, without what passed before a restart (pauses). */
  double meanRealTimeFactor() const;

private:
  double factor_;
  double start_simulated_ = 0.0;
  double start_wall_ = 0.0;
  double window_simulated_ = 0.0;
  double window_wall_ = 0.0;
  double measured_ = 0.0;
  double last_simulated_ = 0.0;
  double last_wall_ = 0.0;
  double total_simulated_ = 0.0;
  double total_wall_ = 0.0;
};

}  // namespace frictional_contact_sim
