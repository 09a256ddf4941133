#include "frictional_contact_sim/ros/certificates.h"

#include <cmath>

#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/services.h"
#include "frictional_contact_sim/solver/enumeration/enumeration.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LONGEST_ENUMERATION = 10.0;  ///< wall clock [s]

void fillIds(const std::vector<NamedRow>& rows, std::vector<std::uint64_t>& ids)
{
  ids.clear();
  for (const NamedRow& row : rows)
    if (row.is_contact)
      ids.push_back(row.id);
}

void fillNames(const std::vector<NamedRow>& rows, std::vector<std::string>& names)
{
  names.clear();
  for (const NamedRow& row : rows)
    names.push_back(row.name);
}

/** Beside the verdict. The node waits for it. */
void enumerateStep(const Simulator& simulator, Certify::Response& response)
{
  EnumerateOptions options;
  options.time_limit = LONGEST_ENUMERATION;
  const EnumerationReport found = enumerate(simulator.problem(), options);
  response.complete = found.complete;
  response.solutions = static_cast<std::uint32_t>(found.solutions);
  response.continua = static_cast<std::uint32_t>(found.continua);
  for (const SolutionFamily& family : found.families)
    if (family.dimension == 0)
      for (const double component : family.representative.v)
        response.velocities.push_back(component);
  if (found.uniqueness != Uniqueness::UNKNOWN)
    response.uniqueness = toMessage(found.uniqueness);
  response.seconds += found.seconds;
  response.message += (response.message.empty() || found.message.empty() ? "" : "; ") + found.message;
}
}  // namespace

void fillCertificate(const StepCertificate& certificate, const ros::Time& stamp, CertificateReport& message)
{
  message.header.stamp = stamp;
  message.header.frame_id = WORLD_FRAME;
  message.step = certificate.step;
  message.existence = toMessage(certificate.existence);
  message.uniqueness = toMessage(certificate.uniqueness);
  message.margin = certificate.margin;
  message.margin_rate = certificate.margin_rate;
  message.bound = certificate.bound;
  message.seconds_left = certificate.seconds_left;
  message.rows = static_cast<std::uint32_t>(certificate.rows);
  message.rank = certificate.rank;
  message.condition = certificate.condition;
  fillIds(certificate.blocking, message.blocking_contacts);
  fillNames(certificate.blocking, message.blocking);
  fillNames(certificate.limiting, message.limiting);
  message.blocking_positions.clear();
  for (const NamedRow& row : certificate.blocking)
    if (row.is_contact)
      message.blocking_positions.push_back(toPoint(row.position));
  const size_t islands = certificate.islands.size();
  message.island_contacts.resize(islands);
  message.island_existence.resize(islands);
  message.island_margin.resize(islands);
  message.island_rows.resize(islands);
  message.island_rank.resize(islands);
  message.island_condition.resize(islands);
  for (size_t i = 0; i < islands; ++i)
  {
    const IslandSummary& island = certificate.islands[i];
    message.island_contacts[i] = static_cast<std::uint32_t>(island.contacts);
    message.island_existence[i] = toMessage(island.existence);
    message.island_margin[i] = island.margin;
    message.island_rows[i] = static_cast<std::uint32_t>(island.rows);
    message.island_rank[i] = island.rank;
    message.island_condition[i] = island.condition;
  }
  message.message = certificate.message;
  message.warning = certificate.warning;
  message.seconds = certificate.seconds;
}

void certifyStep(const Certify::Request& request, const Simulator& simulator, Certify::Response& response)
{
  if (!std::isfinite(request.bound) || request.bound < 0.0)
    throw RequestError("bound: found " + std::to_string(request.bound) + ", expected >= 0");
  CertifyOptions options;
  options.bound = request.bound;
  const StepCertificate certificate = simulator.certify(options);
  response.existence = toMessage(certificate.existence);
  response.margin = certificate.margin;
  if (certificate.existence == Existence::REFUTED)
  {
    fillIds(certificate.blocking, response.blocking_contacts);
    fillNames(certificate.blocking, response.blocking);
  }
  response.uniqueness = toMessage(certificate.uniqueness);
  response.rank = certificate.rank;
  response.condition = certificate.condition;
  response.seconds = certificate.seconds;
  response.message = certificate.warning.empty() ? certificate.message : certificate.warning;
  if (request.enumerate)
    enumerateStep(simulator, response);
}

}  // namespace frictional_contact_sim
