// FNV-1a (Fowler, Noll, Vo 1991) over the bits of everything that is not wall-clock time.
#include <cstdint>
#include <cstring>

#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
class Hash
{
public:
  void add(double value)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(std::uint64_t bits)
  {
    for (int byte = 0; byte < 8; ++byte)
      state_ = (state_ ^ ((bits >> (8 * byte)) & 0xffU)) * 1099511628211ULL;
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& vector)
  {
    for (Eigen::Index i = 0; i < vector.size(); ++i)
      add(static_cast<double>(vector[i]));
  }
  std::uint64_t value() const { return state_; }

private:
  std::uint64_t state_ = 14695981039346656037ULL;
};
}  // namespace

std::uint64_t Simulator::stateHash() const
{
  Hash hash;
  hash.add(impl_->time);
  for (const Robot& robot : impl_->world.robots)
  {
    hash.add(robot.q);
    hash.add(robot.v);
    for (const Actuator& actuator : robot.actuators)
      hash.add(actuator.effort);
  }
  for (const ContactState& contact : impl_->contacts)
  {
    hash.add(contact.id);
    hash.add(static_cast<std::uint64_t>(contact.mode));
    for (const Eigen::Vector3d* vector : {&contact.position, &contact.normal, &contact.impulse, &contact.velocity})
      hash.add(*vector);
    hash.add(contact.gap);
    hash.add(contact.residual);
  }
  const StepSummary& report = impl_->report;
  hash.add(report.step);
  hash.add(static_cast<std::uint64_t>(report.iterations));
  hash.add(static_cast<std::uint64_t>(report.status));
  const EnergyLedger& energy = report.energy;
  for (const double value :
       {report.residual, report.max_penetration, report.bilateral_violation, energy.kinetic, energy.potential,
        energy.actuators, energy.friction, energy.impact, energy.joints, energy.balance_error})
    hash.add(value);
  return hash.value();
}

const char* toString(ContactMode mode)
{
  switch (mode)
  {
    case ContactMode::OPEN:
      return "OPEN";
    case ContactMode::STICKING:
      return "STICKING";
    case ContactMode::SLIDING:
      return "SLIDING";
    case ContactMode::IMPACT:
      return "IMPACT";
  }
  return "UNKNOWN";
}

}  // namespace frictional_contact_sim
