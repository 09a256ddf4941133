#pragma once
/**
 * @file row_sink.h
 * @brief Collects the rows of one step from all row sources: H, w, laws, G, b, auxiliary masses, and for each row
 * which entry of the energy ledger its impulse belongs to and where that impulse is kept for the next step.
 *
 * A law of d rows is d times `push ... endRow`, then `endLaw`. Columns of a row ascend. Storage only grows.
 */
#include <vector>

#include "frictional_contact_sim/dynamics/energy_ledger.h"
#include "frictional_contact_sim/dynamics/row_builder.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
/** @brief What is known of a row besides its numbers. */
struct RowRecord
{
  WorkAccount account = WorkAccount::JOINTS;
  double base_velocity = 0.0;  ///< share of moving bases in u [m/s]: their drives do its work
  double* memory = nullptr;  ///< the impulse of the last step, warm start of this one; none: the source keeps its own
};

/** @brief Whose a law or a bilateral row is. */
struct RowOrigin
{
  const char* source = "";  ///< RowSource::name()
  int body = -1;  ///< of the joint, -1: of no single joint
  int joint = -1;
};

/** @brief What the velocity of a law's rows is. */
struct RowUnit
{
  VelocityUnit unit = VelocityUnit::LENGTH;
  double reach = 1.0;  ///< of rows of angles: farthest point from the axis that they move [m] > 0; else 1
};

class RowSink
{
public:
  /** @brief Empties everything. @param velocities generalized velocities of all bodies, before auxiliary ones */
  void clear(int velocities);

  int rows() const { return h_.rows(); }
  int laws() const { return static_cast<int>(laws_.size()); }
  int bilaterals() const { return g_.rows(); }
  int velocities() const { return velocities_; }
  int columns() const { return velocities_ + static_cast<int>(auxiliary_mass_.size()); }

  /** @brief Of all laws and bilateral rows that follow. */
  void setOrigin(const RowOrigin& origin) { origin_ = origin; }

  /** @brief Next entry of the current row of H. */
  void push(int column, double value) { h_.push(column, value); }
  /** @brief Ends a row of H. @param w [m/s] or [rad/s] */
  void endRow(double w, const RowRecord& record);
  /** @brief The law of the rows that have ended since the last one. */
  void endLaw(const Law& law, const RowUnit& unit = {});
  /** @brief A velocity that exists for this step only. @param mass [kg] or [kg m^2] > 0 @return its column */
  int addAuxiliary(double mass);

  void pushBilateral(int column, double value) { g_.push(column, value); }
  /** @brief Ends a row of G. @param b [m/s] or [rad/s] */
  void endBilateral(double b, const RowRecord& record, const RowUnit& unit = {});

  /** @brief A row closes at this instant: an impact has something to solve. */
  void noteClosing() { closing_ = true; }
  bool closing() const { return closing_; }
  /** @brief A row asks for restitution. */
  void noteBounce() { bouncing_ = true; }
  bool bouncing() const { return bouncing_; }

  const std::vector<RowRecord>& rowRecords() const { return row_records_; }
  const std::vector<RowRecord>& bilateralRecords() const { return bilateral_records_; }
  const std::vector<RowOrigin>& origins() const { return origins_; }  ///< of the laws
  const std::vector<RowOrigin>& bilateralOrigins() const { return bilateral_origins_; }
  const std::vector<RowUnit>& units() const { return units_; }
  const std::vector<RowUnit>& bilateralUnits() const { return bilateral_units_; }
  const std::vector<double>& auxiliaryMass() const { return auxiliary_mass_; }
  const RowBuilder& h() const { return h_; }
  const RowBuilder& g() const { return g_; }
  /** @brief H, w, laws, G, b of `problem`; an impact has of b the moving bases alone (the position
   * error is the next step's). */
  void copyTo(bool impact, IncrementalProblem& problem) const;

private:
  int velocities_ = 0;
  bool closing_ = false;
  bool bouncing_ = false;
  RowBuilder h_;
  RowBuilder g_;
  std::vector<double> w_;
  std::vector<double> b_;
  std::vector<Law> laws_;
  RowOrigin origin_;
  std::vector<RowOrigin> origins_;
  std::vector<RowOrigin> bilateral_origins_;
  std::vector<RowUnit> units_;
  std::vector<RowUnit> bilateral_units_;
  std::vector<double> auxiliary_mass_;
  std::vector<RowRecord> row_records_;
  std::vector<RowRecord> bilateral_records_;
};

}  // namespace frictional_contact_sim
