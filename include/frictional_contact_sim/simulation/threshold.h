#pragma once
/**
 * @file threshold.h
 * @brief For which values of one number of a scenario does something hold: bisection between what holds and what fails.
 *
 * A grid of values comes first, so that what is not monotone is seen as far as the grid shows it; then every place
 * where holding and failing meet is bisected. Each run is a whole simulation; one that fails (a step without an answer)
 * does not hold.
 *
 * What has to hold is a conjunction, "max_speed < 1e-6 and box.tilt < 0.1", of the quantities in quantityNames().
 */
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief A run as its numbers: quantities of the whole scene by name, of a body as "BODY.quantity". */
using RunQuantities = std::map<std::string, double>;

/** @brief {name, meaning with unit} of what an expression may speak of. */
const std::vector<std::pair<std::string, std::string>>& sceneQuantities();
const std::vector<std::pair<std::string, std::string>>& bodyQuantities();

class HoldExpression
{
public:
  /** @throws std::invalid_argument in one line for text that is none; names of quantities are judged by check() */
  explicit HoldExpression(const std::string& text);
  /** @brief Every name is there. @throws std::invalid_argument with the nearest one */
  void check(const RunQuantities& quantities) const;
  bool holds(const RunQuantities& quantities) const;

private:
  struct Comparison
  {
    std::string quantity;
    std::string relation;  ///< <, <=, >, >=
    double value;
  };
  std::vector<Comparison> comparisons_;
};

/** @brief What one run of a scenario was. */
struct RunRecord
{
  RunQuantities quantities;
  bool solved = true;  ///< every step, and the start
  std::string failure;  ///< of the step without an answer
  int checked = 0, certified = 0, refuted = 0;  ///< verdicts on existence, with Scenario::certify_every
  double least_margin = 0.0;  ///< of them [m/s]
};

/** @brief The whole duration, until the first step without an answer. @param progress called with the share done */
RunRecord recordRun(const Scenario& scenario, const std::function<void(double)>& progress = {});

struct ThresholdOptions
{
  double from = 0.0;
  double to = 1.0;  ///< > from
  int samples = 5;  ///< of the grid, ends included, >= 2
  double tolerance = 1e-4;  ///< width of a bracket [-], of to - from, in (0, 1)

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief Values that hold, with what is known beside them. */
struct HoldingInterval
{
  double from = 0.0, to = 0.0;  ///< both hold
  bool open_below = false, open_above = false;  ///< it ends with the range, nothing fails there
  double fails_below = 0.0, fails_above = 0.0;  ///< nearest values that fail, where not open
};

struct ThresholdResult
{
  std::vector<HoldingInterval> intervals;  ///< ascending
  std::vector<std::pair<double, bool>> runs;  ///< every value tried, ascending, and whether it held
  bool monotone = true;  ///< at most one change between holding and failing was seen
  /** @brief The widest interval; nullptr when nothing holds. */
  const HoldingInterval* widest() const;
};

ThresholdResult findThreshold(const ThresholdOptions& options, const std::function<bool(double)>& holds);

}  // namespace frictional_contact_sim
