#pragma once
/**
 * @file results.h
 * @brief What a comparison leaves: one CSV row a problem, solver and target; the table of ratios.
 */
#include <fstream>
#include <string>
#include <vector>

#include "comparison/measure.h"

namespace comparison
{
struct ProblemFacts
{
  std::string name;
  std::string kind;  ///< local or global
  int dimension = 3;
  int contacts = 0;
  int rows = 0;
  int bilaterals = 0;
  int rank = 0;  ///< of W, 0 when not computed
};

class CsvTable
{
public:
  /** @throws std::runtime_error when the file cannot be written */
  explicit CsvTable(const std::string& path);
  void add(const ProblemFacts& facts, const Target& target, const Outcome& outcome);

private:
  std::ofstream file_;
};

/** @brief Prints portfolio against the best Siconos solver, line by line, and keeps the ratios of a target. */
class RatioTable
{
public:
  RatioTable(const Target& target, const std::string& reference);
  void add(const ProblemFacts& facts, const std::vector<Outcome>& outcomes);
  void print() const;

private:
  std::string target_, reference_;
  std::vector<std::string> lines_;
  std::vector<double> ratios_;
  int only_ours_ = 0, only_theirs_ = 0;
};

}  // namespace comparison
