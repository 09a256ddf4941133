#include "frictional_contact_sim/problem/existence.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/QR>
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "criterion_program.h"
#include "existence_certificate.h"
#include "frictional_contact_sim/math/cone.h"
#include "frictional_contact_sim/problem/certificate/conditioning.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double PI = 3.14159265358979323846;
/// While only the sign matters s is not driven beyond this, in units of |w|.
constexpr double ENOUGH = 1.0;
constexpr int APPROACH_ITERATIONS = 2000;
/// A proof of impossibility must hold for velocities this many times R.
constexpr double EXCLUSION = 1e6;
/// Columns up to which the nearest velocity to -w is found by an orthogonal factor, beyond by conjugate gradients.
constexpr int DENSE_COLUMNS = 400;
/// W - W^T relative to W: nothing at all, and what is taken as round-off of single precision and the like.
constexpr double ROUND_OFF = 1e-12;
constexpr double MOST_ASYMMETRY = 1e-3;
constexpr double LARGEST_BOUND = 1e6;  ///< of v in a program's units
/// Share of the multipliers' sum, which is one, that counts as not zero.
constexpr double BINDS = 1e-9;
/// Violation of a cone at a linear program's solution that is worth another facet, in the program's units.
constexpr double CUT_TOLERANCE = 1e-10;

/** Largest eigenvalue of H^T H from above: the largest row sum of |H^T H|, bounded by norms of H. */
double squaredNorm(const SparseRows& H)
{
  const SparseRows sizes = H.cwiseAbs();
  const Eigen::VectorXd ones_right = Eigen::VectorXd::Ones(H.cols());
  const Eigen::VectorXd ones_left = Eigen::VectorXd::Ones(H.rows());
  const double rows = (sizes * ones_right).lpNorm<Eigen::Infinity>();
  const double columns = (sizes.transpose() * ones_left).lpNorm<Eigen::Infinity>();
  return std::max(rows * columns, 1e-300);
}

class Criterion
{
public:
  Criterion(const ContactKinematics& kinematics, const ExistenceOptions& options)
    : kinematics_(kinematics), options_(options), correction_(kinematics)
  {
    for (const DualCone& cone : kinematics.cones)
      curved_ = curved_ || (cone.dimension == 3 && cone.friction > 0.0);
    double logarithms = 0.0;
    double height = 0.0;
    int count = 0;
    for (const DualCone& cone : kinematics.cones)
    {
      const double norm = kinematics.H.middleRows(cone.row, cone.dimension).norm();
      height = std::max(height, norm);
      if (norm > 0.0)
      {
        logarithms += std::log(norm);
        ++count;
      }
    }
    report_.margin = -INFINITE;
    report_.upper_bound = INFINITE;
    bound_ = options.velocity_bound;
    const double speed = std::max(kinematics.w.size() > 0 ? kinematics.w.lpNorm<Eigen::Infinity>() : 0.0,
                                  kinematics.b.size() > 0 ? kinematics.b.lpNorm<Eigen::Infinity>() : 0.0);
    if (bound_ == 0.0)
      bound_ = count > 0 && speed > 0.0 ? 1e3 * speed / std::exp(logarithms / count) : 1.0;
    units_.height = height > 0.0 ? height : 1.0;
    units_.velocity = speed > 0.0 ? speed : bound_ * units_.height;
    // Where R is far above what moves outside the program's numbers must still be of one size.
    units_.velocity = std::max(units_.velocity, bound_ * units_.height / LARGEST_BOUND);
    report_.velocity_bound = bound_;
  }

  ExistenceReport run()
  {
    consider(Eigen::VectorXd::Zero(kinematics_.H.cols()));
    if (!decided())
      followSurroundings();
    if (!decided() && !options_.maximise)
      approachCones();
    if (!decided() && curved_ && (!options_.maximise || report_.margin < 0.0))
      insideCones();
    if (!decided() && !refuteBilaterals())
      outsideCones();
    if (report_.verdict != Existence::REFUTED)
    {
      if (report_.margin >= 0.0)
        certify();
      else
        refute();
    }
    return std::move(report_);
  }

private:
  bool decided() const { return kinematics_.cones.empty() || (report_.margin >= 0.0 && !options_.maximise); }

  void consider(Eigen::VectorXd v)
  {
    const double missing = correction_.apply(v);
    // Contradicting bilateral rows leave a correction that no velocity makes.
    const bool consistent = missing <= 1e-6 * (bound_ + v.norm());
    if (options_.maximise && v.lpNorm<Eigen::Infinity>() > bound_ * (1.0 + 1e-9))
      return;
    double margin = consistent ? verifiedMargin(kinematics_, v, missing) : -INFINITE;
    bool exact = true;
    double change = 0.0;
    if (margin < 0.0 && consistent && roundOffMissing(kinematics_, v, missing, change) <= ROUND_OFF_UNITS)
    {
      exact = false;
      margin = 0.0;
    }
    const bool better = margin > report_.margin || (exact && !report_.exact && margin >= report_.margin);
    if (!better && report_.v.size() > 0)
      return;
    report_.margin = margin;
    report_.v = v;
    report_.exact = exact;
    report_.perturbation = exact ? 0.0 : change;
  }

  /** The velocity nearest to that of the surroundings: H v = -w where they move as one rigid body (section 3.4.6). */
  void followSurroundings()
  {
    const auto rows = kinematics_.H.rows();
    if (rows == 0 || kinematics_.w.isZero(0.0))
      return;
    SparseRows stacked(rows + kinematics_.E.rows(), kinematics_.H.cols());
    stacked.topRows(rows) = kinematics_.H;
    stacked.bottomRows(kinematics_.E.rows()) = kinematics_.E;
    Eigen::VectorXd right(stacked.rows());
    right << -kinematics_.w, -kinematics_.b;
    Eigen::VectorXd v;
    if (stacked.rows() == 0 || stacked.cols() == 0)
      v.setZero(stacked.cols());
    else if (stacked.cols() <= DENSE_COLUMNS)
    {
      const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor{Eigen::MatrixXd(stacked)};
      v = factor.solve(right);
      v += factor.solve(Eigen::VectorXd(right - stacked * v));
    }
    else
    {
      const Eigen::SparseMatrix<double> columns = stacked;
      Eigen::LeastSquaresConjugateGradient<Eigen::SparseMatrix<double>> nearest(columns);
      nearest.setTolerance(DBL_EPSILON);
      nearest.setMaxIterations(APPROACH_ITERATIONS);
      v = nearest.solve(right);
    }
    if (v.allFinite())
      consider(v);
  }

  void addPolygon(CriterionProgram& program, double widening) const
  {
    for (size_t i = 0; i < kinematics_.cones.size(); ++i)
    {
      const DualCone& cone = kinematics_.cones[i];
      const int index = static_cast<int>(i);
      if (cone.dimension == 1 || cone.friction == 0.0)
        program.addFacet(index, Eigen::Vector2d::Zero(), 0.0);
      else if (cone.dimension == 2)
        for (const double side : {1.0, -1.0})
          program.addFacet(index, Eigen::Vector2d(side, 0.0), cone.friction);
      else
        for (int k = 0; k < options_.facets; ++k)
        {
          const double angle = 2.0 * PI * k / options_.facets;
          program.addFacet(index, Eigen::Vector2d(std::cos(angle), std::sin(angle)), cone.friction * widening);
        }
    }
  }

  /**
   * Minimises 1/2 dist^2(H v + w - s e, L*) for one s by accelerated gradients with restart: where the criterion holds
   * with room this is much cheaper than a linear program. In units of w for u, of w/|H| for v.
   */
  void approachCones()
  {
    const double goal = std::max(kinematics_.w.size() > 0 ? kinematics_.w.lpNorm<Eigen::Infinity>() : 0.0, 1e-300);
    const double step = 1.0 / squaredNorm(kinematics_.H);
    Eigen::VectorXd v = report_.v;
    Eigen::VectorXd previous = v, point = v;
    double momentum = 1.0;
    for (int iteration = 0; iteration < APPROACH_ITERATIONS && !decided(); ++iteration)
    {
      const Eigen::VectorXd gradient = kinematics_.H.transpose() * outside(point, goal);
      previous.swap(v);
      v = point - step * gradient;
      correction_.apply(v);
      if (!(v.lpNorm<Eigen::Infinity>() <= bound_))
        return;
      const double next =
          gradient.dot(v - previous) > 0.0 ? 1.0 : 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
      point = v + (next > 1.0 ? (momentum - 1.0) / next : 0.0) * (v - previous);
      momentum = next;
      if (iteration % 10 == 9)
        consider(v);
    }
  }

  /** H v + w - s e minus its projection on L*: opposite to an element of L. */
  Eigen::VectorXd outside(const Eigen::VectorXd& v, double s) const
  {
    const Eigen::VectorXd u = kinematics_.H * v + kinematics_.w;
    Eigen::VectorXd result = Eigen::VectorXd::Zero(u.size());
    for (const DualCone& cone : kinematics_.cones)
    {
      Eigen::Vector3d y = Eigen::Vector3d::Zero();
      y.head(cone.dimension) = u.segment(cone.row, cone.dimension);
      y[0] -= s;
      result.segment(cone.row, cone.dimension) = -projectOntoCone<3>(-y, cone.friction).head(cone.dimension);
    }
    return result;
  }

  /** Facets touching the inside: every feasible v is a certificate. */
  void insideCones()
  {
    CriterionProgram program(kinematics_, units_, bound_, ENOUGH);
    addPolygon(program, 1.0 / std::cos(PI / options_.facets));
    ++report_.rounds;
    if (program.solve(options_.max_simplex_iterations))
      consider(program.v());
  }

  /** Facets touching from outside, refined where the point leaves the cone. */
  void outsideCones()
  {
    CriterionProgram program(kinematics_, units_, bound_, options_.maximise ? LinearProgram::INFINITE : ENOUGH);
    addPolygon(program, 1.0);
    while (report_.rounds < options_.max_rounds)
    {
      ++report_.rounds;
      if (!program.solve(options_.max_simplex_iterations))
      {
        report_.message = "the simplex method stopped without an optimum";
        return;
      }
      consider(program.v());
      if (program.s() < ENOUGH || options_.maximise)
        report_.upper_bound = program.s() * units_.velocity;
      program.multipliers(report_.multiplier, report_.bilateral_multiplier);
      blocking();
      if (decided() || (program.s() < 0.0 && excluded() && !options_.maximise) || addCuts(program) == 0 ||
          report_.upper_bound - report_.margin <= options_.gap * std::abs(report_.upper_bound))
        return;
    }
  }

  bool excluded()
  {
    report_.excluded_below = verifiedExclusion(kinematics_, report_.multiplier, report_.bilateral_multiplier);
    report_.criterion_violated = report_.excluded_below >= EXCLUSION * bound_;
    return report_.criterion_violated;
  }

  void blocking()
  {
    report_.blocking.clear();
    report_.blocking_bilaterals.clear();
    for (const DualCone& cone : kinematics_.cones)
      if (report_.multiplier[cone.row] > BINDS)
        report_.blocking.push_back(cone.law);
    for (Eigen::Index j = 0; j < report_.bilateral_multiplier.size(); ++j)
      if (std::abs(report_.bilateral_multiplier[j]) > BINDS)
      {
        const auto k = static_cast<size_t>(j);
        if (kinematics_.bilateral_law[k] >= 0)
          report_.blocking.push_back(kinematics_.bilateral_law[k]);
        else
          report_.blocking_bilaterals.push_back(kinematics_.bilateral_row[k]);
      }
    std::sort(report_.blocking.begin(), report_.blocking.end());
  }

  /** Bilateral rows that contradict each other leave no velocity at all. */
  bool refuteBilaterals()
  {
    if (kinematics_.E.rows() == 0)
      return false;
    Eigen::VectorXd r = Eigen::VectorXd::Zero(kinematics_.H.rows());
    const Eigen::VectorXd lambda = contradiction(kinematics_);
    const double excluded_below = verifiedExclusion(kinematics_, r, lambda);
    if (excluded_below < EXCLUSION * bound_)
      return false;
    setRefuted(r, lambda, excluded_below, "the bilateral rows contradict each other");
    return true;
  }

  void setRefuted(const Eigen::VectorXd& r, const Eigen::VectorXd& lambda, double excluded_below, const char* message)
  {
    report_.verdict = Existence::REFUTED;
    report_.criterion_violated = true;
    report_.excluded_below = excluded_below;
    report_.multiplier = r;
    report_.bilateral_multiplier = lambda;
    blocking();
    report_.message = message;
  }

  int addCuts(CriterionProgram& program) const
  {
    int cuts = 0;
    for (size_t i = 0; i < kinematics_.cones.size(); ++i)
    {
      const DualCone& cone = kinematics_.cones[i];
      if (cone.dimension != 3 || cone.friction == 0.0)
        continue;
      const Eigen::Vector2d tangent(program.u(cone.row + 1), program.u(cone.row + 2));
      const double length = tangent.norm();
      if (cone.friction * length <= program.u(cone.row) - program.s() + CUT_TOLERANCE)
        continue;
      program.addFacet(static_cast<int>(i), tangent / length, cone.friction);
      ++cuts;
    }
    return cuts;
  }

  void certify()
  {
    report_.verdict = Existence::CERTIFIED;
    report_.criterion_violated = false;
    report_.multiplier.resize(0);
    report_.bilateral_multiplier.resize(0);
    report_.message = kinematics_.cones.empty() ? "nothing restricts the velocities"
                      : report_.exact           ? "a velocity inside the dual cones was verified"
                                      : "a velocity on the boundary of the dual cones was verified to round-off of w";
  }

  /** Without friction the criterion is necessary; u_N >= 0 everywhere is necessary for any friction. */
  void refute()
  {
    const std::string obstacle = report_.message;
    ContactKinematics normals = kinematics_;
    for (DualCone& cone : normals.cones)
      cone.friction = 0.0;
    CriterionProgram program(normals, units_, bound_, ENOUGH);
    for (size_t i = 0; i < normals.cones.size(); ++i)
      program.addFacet(static_cast<int>(i), Eigen::Vector2d::Zero(), 0.0);
    ++report_.rounds;
    if (program.solve(options_.max_simplex_iterations) && program.s() < 0.0)
    {
      Eigen::VectorXd r, lambda;
      program.multipliers(r, lambda);
      const double excluded_below = verifiedExclusion(normals, r, lambda);
      if (excluded_below >= EXCLUSION * bound_)
      {
        setRefuted(r, lambda, excluded_below, "no velocity keeps all contacts from penetrating");
        return;
      }
    }
    if (report_.criterion_violated)
      report_.message = "no velocity satisfies the criterion, which is not necessary";
    else
    {
      report_.multiplier.resize(0);
      report_.bilateral_multiplier.resize(0);
      report_.message = obstacle.empty() ? "no velocity inside the dual cones was found" : obstacle;
    }
  }

  const ContactKinematics& kinematics_;
  const ExistenceOptions& options_;
  BilateralCorrection correction_;
  ExistenceReport report_;
  double bound_ = 1.0;
  CriterionUnits units_;
  bool curved_ = false;
};

}  // namespace

const char* toString(Existence existence)
{
  switch (existence)
  {
    case Existence::CERTIFIED:
      return "CERTIFIED";
    case Existence::REFUTED:
      return "REFUTED";
    case Existence::UNDECIDED:
      break;
  }
  return "UNDECIDED";
}

void ExistenceOptions::validate() const
{
  const auto require = [](bool condition, const std::string& text)
  {
    if (!condition)
      throw std::invalid_argument("existence: " + text);
  };
  require(std::isfinite(velocity_bound) && velocity_bound >= 0.0,
          "velocity_bound is " + std::to_string(velocity_bound) + ", expected >= 0");
  require(facets >= 3, "facets is " + std::to_string(facets) + ", expected at least 3");
  require(max_rounds >= 1, "max_rounds is " + std::to_string(max_rounds) + ", expected at least 1");
  require(max_simplex_iterations >= 1,
          "max_simplex_iterations is " + std::to_string(max_simplex_iterations) + ", expected at least 1");
  require(gap > 0.0, "gap is " + std::to_string(gap) + ", expected > 0");
}

ExistenceReport checkExistence(const IncrementalProblem& problem, const ExistenceOptions& options)
{
  validate(problem);
  options.validate();
  const ContactKinematics kinematics = collectKinematics(problem.H, problem.w, problem.laws, &problem.G, &problem.b);
  return Criterion(kinematics, options).run();
}

ExistenceReport checkExistence(const DelassusProblem& problem, const ExistenceOptions& options)
{
  validate(problem);
  options.validate();
  SparseRows W = problem.W.toSparse();
  const double defect = delassusDefect(W);
  const bool repaired = defect > ROUND_OFF && defect <= MOST_ASYMMETRY;
  if (repaired)
    W = (0.5 * (W + SparseRows(W.transpose()))).eval();
  const ContactKinematics kinematics = collectKinematics(W, problem.q, problem.laws, nullptr, nullptr);
  ExistenceReport report = Criterion(kinematics, options).run();
  if (repaired)
  {
    report.exact = false;
    report.message += "; of the symmetric part of W, which is not symmetric";
  }
  if (report.verdict == Existence::CERTIFIED && defect > MOST_ASYMMETRY)
  {
    report.verdict = Existence::UNDECIDED;
    report.message = "W is not symmetric and positive semi-definite: the criterion proves nothing";
  }
  return report;
}

}  // namespace frictional_contact_sim
