#pragma once
/**
 * @file csv_recorder.h
 * @brief Writes states.csv, joints.csv, contacts.csv and steps.csv of a run into a folder, and what its bodies look
 * like: bodies.csv and copies of their URDFs (docs/interfaces.md); nodes.csv of deformable bodies.
 *
 * Contact columns: force is impulse / dt in world axes, on body_a [N]; velocity is of a relative to b [m/s].
 */
#include <fstream>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
class CsvRecorder
{
public:
  /** @brief Creates the folder where needed. @throws std::runtime_error naming the folder that cannot be written */
  explicit CsvRecorder(const std::string& folder);

  /** @brief State of all bodies now; contacts and report of the last step when `with_step`. */
  void record(const Simulator& simulator, bool with_step);
  /** @brief Flushes. @throws std::runtime_error when anything could not be written (disk full) */
  void close();

private:
  void recordBodies(const Simulator& simulator) const;
  void recordNodes(const Simulator& simulator);
  void recordContacts(const Simulator& simulator);
  void recordReport(const StepSummary& report);
  std::ofstream open(const std::string& name, const char* columns) const;

  std::string folder_;
  bool knows_bodies_ = false;
  std::ofstream states_;
  std::ofstream joints_;
  std::ofstream contacts_;
  std::ofstream nodes_;  ///< opened when a body is deformable
  std::ofstream steps_;
};

}  // namespace frictional_contact_sim
