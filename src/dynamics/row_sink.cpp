#include "frictional_contact_sim/dynamics/row_sink.h"

#include <cassert>

namespace frictional_contact_sim
{
void RowSink::clear(int velocities)
{
  velocities_ = velocities;
  closing_ = bouncing_ = false;
  h_.clear();
  g_.clear();
  w_.clear();
  b_.clear();
  laws_.clear();
  origin_ = {};
  origins_.clear();
  bilateral_origins_.clear();
  units_.clear();
  bilateral_units_.clear();
  auxiliary_mass_.clear();
  row_records_.clear();
  bilateral_records_.clear();
}

void RowSink::endRow(double w, const RowRecord& record)
{
  h_.endRow();
  w_.push_back(w);
  row_records_.push_back(record);
}

void RowSink::endLaw(const Law& law, const RowUnit& unit)
{
  laws_.push_back(law);
  units_.push_back(unit);
  origins_.push_back(origin_);
}

int RowSink::addAuxiliary(double mass)
{
  auxiliary_mass_.push_back(mass);
  return columns() - 1;
}

void RowSink::endBilateral(double b, const RowRecord& record, const RowUnit& unit)
{
  bilateral_units_.push_back(unit);
  bilateral_origins_.push_back(origin_);
  g_.endRow();
  b_.push_back(b);
  bilateral_records_.push_back(record);
}

void RowSink::copyTo(bool impact, IncrementalProblem& problem) const
{
  assert(rowCount(laws_) == rows());
  h_.copyTo(columns(), problem.H);
  g_.copyTo(columns(), problem.G);
  problem.w = Eigen::Map<const Eigen::VectorXd>(w_.data(), static_cast<Eigen::Index>(w_.size()));
  problem.b = Eigen::Map<const Eigen::VectorXd>(b_.data(), static_cast<Eigen::Index>(b_.size()));
  if (impact)
    for (size_t k = 0; k < b_.size(); ++k)
      problem.b[static_cast<Eigen::Index>(k)] = bilateral_records_[k].base_velocity;
  problem.laws = laws_;
}

}  // namespace frictional_contact_sim
