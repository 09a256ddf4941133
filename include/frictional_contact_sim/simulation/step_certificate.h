#pragma once
/**
 * @file step_certificate.h
 * @brief The verdict on the problem of one step, in the words of the scene: names of contacts, and what is to come.
 *
 * margin is the maximum of (3.37) with |v|_inf <= bound [m/s, rad/s]; its trend is published, and there is a warning
 * before a scene becomes infeasible:
 *
 *   closing   the same rows with every gap closed: u_N >= 0 in place of u_N >= -gap/dt. Where that is REFUTED, bodies
 * run into each other that no velocity can keep apart; the gaps that are left last about dt margin/(-closing margin)
 *   trend     the margin falls and, at the mean rate of the last checks, is zero within WARNING_TIME
 *
 * Only contacts with a row are seen: those that the motion of a step or two could close.
 */
#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/certificate/certify.h"
#include "frictional_contact_sim/problem/certificate/uniqueness.h"

namespace frictional_contact_sim
{
/** @brief A law or a bilateral row by its name. */
struct NamedRow
{
  std::string name;  ///< "body/link - ground", "joint limits of body/joint", ...
  bool is_contact = false;
  std::uint64_t id = 0;  ///< of a contact, as in messages
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of a contact, world [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

struct IslandSummary
{
  int contacts = 0;
  Existence existence = Existence::UNDECIDED;
  double margin = 0.0;  ///< [m/s]
  int rows = 0;
  int rank = -1;
  double condition = 0.0;
};

struct StepCertificate
{
  bool checked = false;  ///< in this step; else the rest is of the last step that was
  std::uint64_t step = 0;
  double time = 0.0;  ///< [s]
  Existence existence = Existence::UNDECIDED;
  Uniqueness uniqueness = Uniqueness::UNKNOWN;
  bool exact = true;
  double margin = 0.0;  ///< [m/s]
  double margin_rate = 0.0;  ///< MarginTrend::rate() [m/s^2]
  double bound = 0.0;  ///< R [m/s, rad/s]
  int rows = 0;
  int rank = -1;
  double condition = 0.0;
  std::vector<NamedRow> blocking;  ///< REFUTED: what cannot be satisfied together; else what will not be
  std::vector<NamedRow> limiting;  ///< what the margin is attained at
  std::vector<IslandSummary> islands;
  double seconds_left = std::numeric_limits<double>::infinity();  ///< until no solution is left, where that is foreseen
  std::string message;  ///< one line
  std::string warning;  ///< one line, empty: nothing to warn of
  double seconds = 0.0;  ///< wall clock
};

constexpr double WARNING_TIME = 0.1;  ///< foreseen for so long [s, simulated]

/** @brief Names, comma separated, each once. */
std::string joinNames(const std::vector<NamedRow>& rows);

/** @brief Margins of the last checks, for their trend. */
class MarginTrend
{
public:
  void clear() { count_ = 0; }
  /** @brief Of a check at `time` [s]; one that is not later than the last starts anew. */
  void add(double time, double margin);
  /** @brief Median of the slopes between the last checks, which a jump does not move [m/s^2]; 0 for fewer than five. */
  double rate() const;

private:
  static constexpr int LENGTH = 8;
  int count_ = 0;
  double times_[LENGTH] = {}, margins_[LENGTH] = {};
};

}  // namespace frictional_contact_sim
