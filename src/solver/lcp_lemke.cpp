#include "frictional_contact_sim/solver/lcp_lemke.h"

#include <Eigen/QR>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LCP_ASKED_AFTER = 1e6;  ///< entries of the tableau changed between two questions of the pivoting
constexpr double PI = 3.14159265358979323846;
/// Alignments with the full angle; later ones are damped, for contacts whose slip answers a turn with a larger one.
constexpr int UNDAMPED = 6;

bool isFrictional(const Law& law)
{
  return law.isCoulomb() && law.coefficient > 0.0;
}

/// Number of complementary pairs of a law.
int lcpSize(const Law& law, int facets, LcpForm form)
{
  switch (law.type)
  {
    case LawType::COULOMB_3D:
      return isFrictional(law) ? facets + 2 : 1;
    case LawType::COULOMB_2D:
      return !isFrictional(law) ? 1 : form == LcpForm::STEWART ? 4 : 3;
    case LawType::UNILATERAL:
      return 1;
    case LawType::DRY_FRICTION:
      return 2;
    case LawType::BILATERAL:
      return 0;
  }
  return 0;
}

/// r = R x + r0,  y = C u + N x + d of all laws but bilateral ones.
struct Maps
{
  Eigen::MatrixXd R, C, N;
  Eigen::VectorXd r0, d;
};

void addPlanar(const Law& law, int row, int first, Maps& maps)
{
  maps.R(row, first) = 1.0;
  maps.R(row + 1, first) = -law.coefficient;
  maps.R(row + 1, first + 1) = 2.0;
  maps.C(first, row) = 1.0;
  maps.C(first + 1, row + 1) = 1.0;
  maps.N(first + 1, first + 2) = 1.0;
  maps.N(first + 2, first) = law.coefficient;
  maps.N(first + 2, first + 1) = -1.0;
}

/// Directions of the facets: `facets` in the plane, or the two of a line.
void addSpatial(const Law& law, int row, int first, int facets, double angle, Maps& maps)
{
  const int tangents = law.dimension() - 1;
  const int slip = first + facets + 1;
  maps.R(row, first) = 1.0;
  maps.C(first, row) = 1.0;
  maps.N(slip, first) = law.coefficient;
  for (int k = 0; k < facets; ++k)
  {
    const int index = first + 1 + k;
    const Eigen::Vector2d direction(std::cos(angle + 2.0 * PI * k / facets), std::sin(angle + 2.0 * PI * k / facets));
    maps.R.block(row + 1, index, tangents, 1) = direction.head(tangents);
    maps.C.block(index, row + 1, 1, tangents) = direction.head(tangents).transpose();
    maps.N(index, slip) = 1.0;
    maps.N(slip, index) = -1.0;
  }
}

/// The threshold is an impulse: in scaled unknowns it is divided by the scale.
void addDryFriction(double threshold, int row, int first, Maps& maps)
{
  maps.R(row, first) = 2.0;
  maps.r0[row] = -threshold;
  maps.C(first, row) = 1.0;
  maps.N(first, first + 1) = 1.0;
  maps.N(first + 1, first) = -1.0;
  maps.d[first + 1] = threshold;
}

Maps makeMaps(const DelassusProblem& problem, int facets, const Eigen::VectorXd& angles, const Eigen::VectorXd& scale,
              LcpForm form)
{
  int size = 0;
  for (const Law& law : problem.laws)
    size += lcpSize(law, facets, form);
  const int rows = problem.W.rows();
  Maps maps;
  maps.R.setZero(rows, size);
  maps.C.setZero(size, rows);
  maps.N.setZero(size, size);
  maps.r0.setZero(rows);
  maps.d.setZero(size);
  int first = 0;
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const Law& law = problem.laws[i];
    const auto index = static_cast<Eigen::Index>(i);
    const int row = problem.W.offset(static_cast<int>(i));
    if (law.type == LawType::DRY_FRICTION)
      addDryFriction(law.coefficient / scale[index], row, first, maps);
    else if (!isFrictional(law) && law.type != LawType::BILATERAL)
      maps.R(row, first) = maps.C(first, row) = 1.0;
    else if (law.type == LawType::COULOMB_2D && form == LcpForm::STEWART)
      addSpatial(law, row, first, 2, 0.0, maps);
    else if (law.type == LawType::COULOMB_2D)
      addPlanar(law, row, first, maps);
    else if (law.type == LawType::COULOMB_3D)
      addSpatial(law, row, first, facets, angles[index], maps);
    first += lcpSize(law, facets, form);
  }
  return maps;
}

std::vector<Eigen::Index> bilateralRows(const DelassusProblem& problem)
{
  std::vector<Eigen::Index> rows;
  for (size_t i = 0; i < problem.laws.size(); ++i)
    if (problem.laws[i].type == LawType::BILATERAL)
      rows.push_back(problem.W.offset(static_cast<int>(i)));
  return rows;
}
}  // namespace

const OptionTable<LcpLemkeOptions>& LcpLemkeOptions::table()
{
  static const OptionTable<LcpLemkeOptions> table =
      OptionTable<LcpLemkeOptions>(
          "lcp_lemke",
          {
              {"method", &LcpLemkeOptions::method, {"lemke", "principal_pivoting"}, "way of pivoting"},
              {"form",
               &LcpLemkeOptions::form,
               {"reduced", "stewart"},
               "of planar contacts: (4.2), or the copositive one that cannot fail when nothing outside moves"},
              {"facets", &LcpLemkeOptions::facets, between(4, 1000), "directions",
               "of the polyhedral cone in 3D, an even number"},
              {"alignments", &LcpLemkeOptions::alignments, atLeast(0), "solves",
               "with turned directions after the first"},
              {"max_size", &LcpLemkeOptions::max_size, atLeast(1), "rows", "of the largest LCP tried"},
          })
          .include(&LcpLemkeOptions::pivoting, LcpOptions::table());
  return table;
}

void LcpLemkeOptions::validate() const
{
  table().validate(*this);
  requireOption(facets % 2 == 0, "lcp_lemke.facets", facets, "an even number");
}

ContactLcp makeContactLcp(const DelassusProblem& problem, int facets, const Eigen::VectorXd& angles,
                          const Eigen::VectorXd& scale, LcpForm form)
{
  Maps maps = makeMaps(problem, facets, angles, scale, form);
  Eigen::VectorXd row_scale(problem.W.rows());
  for (int i = 0; i < problem.W.blocks(); ++i)
    row_scale.segment(problem.W.offset(i), problem.W.dimension(i)).setConstant(scale[i]);
  const Eigen::MatrixXd W = row_scale.asDiagonal() * problem.W.toDense() * row_scale.asDiagonal();
  const Eigen::VectorXd q = row_scale.cwiseProduct(problem.q);
  const std::vector<Eigen::Index> bilateral = bilateralRows(problem);
  if (!bilateral.empty())
  {
    // u_b = 0:  r_b = -W_bb^+ (W_b (R x + r0) + q_b), least norm where bilateral rows are redundant.
    const auto count = static_cast<Eigen::Index>(bilateral.size());
    Eigen::MatrixXd block(count, count), map(count, maps.R.cols());
    Eigen::VectorXd constant(count);
    for (Eigen::Index a = 0; a < count; ++a)
    {
      const Eigen::Index row = bilateral[static_cast<size_t>(a)];
      for (Eigen::Index b = 0; b < count; ++b)
        block(a, b) = W(row, bilateral[static_cast<size_t>(b)]);
      map.row(a) = -W.row(row) * maps.R;
      constant[a] = -W.row(row).dot(maps.r0) - q[row];
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
    factor.setThreshold(1e-10);
    factor.compute(block);
    map = factor.solve(map).eval();
    constant = factor.solve(constant).eval();
    for (Eigen::Index a = 0; a < count; ++a)
    {
      maps.R.row(bilateral[static_cast<size_t>(a)]) = map.row(a);
      maps.r0[bilateral[static_cast<size_t>(a)]] = constant[a];
    }
  }
  ContactLcp lcp;
  const Eigen::SparseMatrix<double> C = maps.C.sparseView();
  const Eigen::SparseMatrix<double> R = maps.R.sparseView();
  const Eigen::MatrixXd WR = W * R;
  lcp.A = C * WR;
  lcp.A += maps.N;
  lcp.b = maps.C * (W * maps.r0 + q) + maps.d;
  lcp.R = row_scale.asDiagonal() * maps.R;
  lcp.r0 = row_scale.cwiseProduct(maps.r0);
  return lcp;
}

LcpLemke::LcpLemke(const LcpLemkeOptions& options) : Solver("lcp_lemke"), options_(options)
{
  options_.validate();
}

bool LcpLemke::align(const DelassusProblem& problem, const Eigen::VectorXd& r, double damping)
{
  bool changed = false;
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    if (law.type != LawType::COULOMB_3D || !isFrictional(law))
      continue;
    const Eigen::Vector2d slip = u_.segment<2>(problem.W.offset(i) + 1);
    const Eigen::Vector2d friction = r.segment<2>(problem.W.offset(i) + 1);
    // A sliding contact opposes its slip; one that sticks is turned so that its impulse is on an edge of the cone,
    // where the polyhedral cone and the exact one agree.
    const double noise = 1e-13 * (u_.lpNorm<Eigen::Infinity>() + problem.q.lpNorm<Eigen::Infinity>());
    const Eigen::Vector2d target = slip.norm() > noise ? Eigen::Vector2d(-slip) : friction;
    if (target.isZero(0.0))
      continue;
    const double angle = std::atan2(target[1], target[0]);
    const double turn = std::remainder(angle - angles_[i], 2.0 * PI / options_.facets);
    changed = changed || std::abs(turn) > 1e-15;
    angles_[i] += damping * turn;
  }
  return changed;
}

void LcpLemke::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  int size = 0;
  bool spatial = false;
  for (const Law& law : problem.laws)
  {
    size += lcpSize(law, options_.facets, options_.form);
    spatial = spatial || (law.type == LawType::COULOMB_3D && isFrictional(law));
  }
  if (size > options_.max_size)
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message =
        "the LCP would have " + std::to_string(size) + " unknowns, the limit is " + std::to_string(options_.max_size);
    return;
  }
  angles_.setZero(problem.W.blocks());
  const Eigen::VectorXd scale = context.metric.step_lengths.cwiseSqrt();
  LcpOptions pivoting = options_.pivoting;
  // Asked once a pivot, or once in ASKED_AFTER changed entries of the tableau where that is later.
  const double entries = std::max<double>(LCP_ASKED_AFTER, static_cast<double>(size) * size);
  const double work = entries / std::max(1.0, static_cast<double>(problem.W.rows()) * problem.W.rows());
  pivoting.interrupted = [&context, work] { return context.spend(work); };
  OuterLoop loop(context, result, options_.alignments + 2);
  for (int k = 0; k <= (spatial ? options_.alignments : 0); ++k)
  {
    if (loop.outOfBudget("solves of the LCP exhausted"))
      return;
    const ContactLcp lcp = makeContactLcp(problem, options_.facets, angles_, scale, options_.form);
    const LcpResult answer = options_.method == LcpMethod::LEMKE ? solveLemke(lcp.A, lcp.b, pivoting)
                                                                 : solvePrincipalPivoting(lcp.A, lcp.b, pivoting);
    ++result.iterations;
    r_ = lcp.R * answer.x + lcp.r0;
    problem.W.apply(r_, u_);
    u_ += problem.q;
    if (loop.record(context.residual(problem, u_, r_), r_))
      return;
    if (answer.status == LcpStatus::INTERRUPTED || context.timeIsUp())
    {
      loop.stop(SolverStatus::TIME_LIMIT, "time limit reached");
      return;
    }
    if (answer.status != LcpStatus::SOLVED)
    {
      const bool ray = answer.status == LcpStatus::RAY;
      loop.stop(ray ? SolverStatus::STAGNATED : SolverStatus::NUMERICAL_FAILURE,
                ray ? "the pivoting path ended on a ray: no solution found" : "the pivoting lost its digits");
      return;
    }
    if (!align(problem, r_, k < UNDAMPED ? 1.0 : 0.4))
      break;
  }
  loop.stop(SolverStatus::STAGNATED, "");
  result.message = spatial ? "the exact residual of the polyhedral cone on " + std::to_string(options_.facets) +
                                 " directions is above the tolerance"
                           : "the residual of the pivoting's solution is above the tolerance";
}

}  // namespace frictional_contact_sim
