// What an answer does to the energy ledger: the work of every row at the mean velocity of the step.
#include "frictional_contact_sim/dynamics/assembly.h"

namespace frictional_contact_sim
{
void StepAssembly::setMeanVelocity(const Solution& solution)
{
  v_mean_.setZero(sink_.columns());
  for (Body& body : bodies_)
  {
    const int nv = body.model.nv;
    body.v_middle = 0.5 * (body.v_start + solution.v.segment(body.v_offset, nv));
    v_mean_.segment(body.v_offset, nv) = body.v_middle;
  }
}

void StepAssembly::bookRow(const RowBuilder& rows, int row, double impulse, const RowRecord& record,
                           EnergyLedger& ledger) const
{
  const double velocity = rows.dot(row, v_mean_);
  const double work = impulse * (velocity + record.base_velocity);
  switch (record.account)
  {
    case WorkAccount::IMPACT:
      ledger.impact -= work;
      break;
    case WorkAccount::FRICTION:
      ledger.friction -= work;
      break;
    case WorkAccount::JOINTS:
      ledger.joints -= work;
      break;
    case WorkAccount::ACTUATORS:
      ledger.actuators += work;
      break;
  }
  ledger.actuators -= impulse * record.base_velocity;  // what the moving base puts in
}

void StepAssembly::book(const StepContext& context, const Solution& solution, EnergyLedger& ledger) const
{
  for (int i = 0; i < problem_.rows(); ++i)
    bookRow(sink_.h(), i, solution.r[i], sink_.rowRecords()[i], ledger);
  for (int k = 0; k < problem_.bilaterals(); ++k)
    bookRow(sink_.g(), k, solution.lambda[k], sink_.bilateralRecords()[k], ledger);
  if (context.impact)
    return;
  for (size_t b = 0; b < bodies_.size(); ++b)
  {
    const Body& body = bodies_[b];
    const auto new_velocity = solution.v.segment(body.v_offset, body.model.nv);
    ledger.actuators += context.dt * body.external.dot(body.v_middle);
    ledger.joints += context.dt * (body.model.damping.array() * new_velocity.array() * body.v_middle.array()).sum();
    if (body.model.solid)
      ledger.joints += context.dt * body.model.solid->dampingPower(body.v_middle);
    for (const std::unique_ptr<RowSource>& source : sources_)
      source->book(context, static_cast<int>(b), solution, ledger);
  }
}

}  // namespace frictional_contact_sim
