#include "comparison/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "support/validator.h"

namespace comparison
{
namespace
{
using namespace frictional_contact_sim;

/** (5.1): mean square of Alart and Curnier's function with rho = 1. */
double thesisCriterion(const DelassusProblem& problem, const Eigen::VectorXd& r)
{
  Eigen::VectorXd u;
  problem.W.apply(r, u);
  u += problem.q;
  double sum = 0.0;
  int rows = 0, row = 0;
  for (const Law& law : problem.laws)
  {
    const int d = law.dimension();
    if (law.isCoulomb())
    {
      const double normal = std::max(0.0, r[row] - u[row]) - r[row];
      Eigen::VectorXd tangent = r.segment(row + 1, d - 1) - u.segment(row + 1, d - 1);
      const double radius = std::max(0.0, law.coefficient * r[row]), length = tangent.norm();
      if (length > radius)
        tangent *= radius / length;
      sum += normal * normal + (tangent - r.segment(row + 1, d - 1)).squaredNorm();
      rows += d;
    }
    row += d;
  }
  return rows > 0 ? sum / (2.0 * rows) : 0.0;
}
}  // namespace

std::string Target::label() const
{
  std::ostringstream text;
  text << (criterion == Criterion::THESIS ? "thesis " : "") << value;
  return text.str();
}

Target parseTarget(const std::string& text)
{
  const std::string prefix = "thesis:";
  Target target;
  std::string number = text;
  if (text.rfind(prefix, 0) == 0)
  {
    target.criterion = Criterion::THESIS;
    number = text.substr(prefix.size());
  }
  std::istringstream stream(number);
  if (!(stream >> target.value) || !stream.eof() || !(target.value > 0.0))
    throw std::invalid_argument("target '" + text + "', expected a positive number or thesis:NUMBER");
  return target;
}

bool Judgement::meets(const Target& target) const
{
  return target.criterion == Criterion::RESIDUAL ? residual <= target.value : thesis < target.value;
}

Judgement judge(const DelassusProblem& problem, const Eigen::VectorXd& r)
{
  Judgement judgement;
  judgement.residual = judgement.thesis = std::numeric_limits<double>::infinity();
  if (r.allFinite())
  {
    judgement.residual = test_support::validateAnswer(problem, r).worst();
    judgement.thesis = thesisCriterion(problem, r);
  }
  return judgement;
}

}  // namespace comparison
