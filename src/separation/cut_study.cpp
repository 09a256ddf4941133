#include "frictional_contact_sim/separation/cut_study.h"

#include <Eigen/QR>
#include <cmath>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
/// Right-hand sides that the vertex's digits leave off zero.
constexpr double ROUND_OFF = 1e-9;

/// Orthonormal basis of {z; E z = 0}.
Eigen::MatrixXd nullSpace(const Polyhedron& equations, Eigen::Index n)
{
  if (equations.rows() == 0)
    return Eigen::MatrixXd::Identity(n, n);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(withUnitRows(equations).A.transpose());
  const Eigen::MatrixXd Q = factor.householderQ() * Eigen::MatrixXd::Identity(n, n);
  return Q.rightCols(n - factor.rank());
}

/// The relaxation in coordinates x = vertex + basis z.
Polyhedron localRelaxation(const IntegerProgram& program, const Eigen::VectorXd& vertex, const Eigen::MatrixXd& basis)
{
  Polyhedron local = translated(withUnitRows(program.inequalities), vertex);
  for (Eigen::Index i = 0; i < local.b.size(); ++i)
    if (std::abs(local.b[i]) <= ROUND_OFF * std::max(1.0, vertex.lpNorm<Eigen::Infinity>()))
      local.b[i] = 0.0;
  local.A *= basis;
  return local;
}

class Study
{
public:
  Study(const IntegerProgram& program, const StudyOptions& options, CutStudy& result)
    : program_(program), options_(options), result_(result)
  {
  }

  void run()
  {
    if (!findVertex())
      return;
    basis_ = nullSpace(program_.equations, program_.size());
    const double x = result_.vertex[result_.variable];
    Disjunction split =
        splitDisjunction(localRelaxation(program_, result_.vertex, basis_), basis_.row(result_.variable).transpose(),
                         std::floor(x) - x, std::floor(x) + 1.0 - x);
    disjunction_ = withoutEmptyTerms(split);
    if (disjunction_.terms.empty())
    {
      result_.status = StudyStatus::INFEASIBLE;
      result_.message = "both sides of the split are empty";
      return;
    }
    cut();
  }

private:
  bool findVertex()
  {
    const RelaxedSolution relaxed = solveRelaxation(program_, none());
    if (relaxed.status != LinearProgramStatus::OPTIMAL)
    {
      const bool infeasible = relaxed.status == LinearProgramStatus::INFEASIBLE;
      result_.status = infeasible                                         ? StudyStatus::INFEASIBLE
                       : relaxed.status == LinearProgramStatus::UNBOUNDED ? StudyStatus::UNBOUNDED
                                                                          : StudyStatus::FAILED;
      result_.message = infeasible ? "the relaxation is infeasible" : "the relaxation has no optimum";
      return false;
    }
    result_.vertex = relaxed.x;
    result_.relaxed = relaxed.cost;
    result_.variable = mostFractional(program_, relaxed.x);
    if (result_.variable < 0)
      result_.status = StudyStatus::WHOLE;
    return result_.variable >= 0;
  }

  void cut()
  {
    const FacetDecomposition decomposition = decomposeDeepestCut(disjunction_, options_.decomposition);
    if (decomposition.status != NearestPointStatus::CONVERGED)
    {
      result_.message = decomposition.message.empty()
                            ? "algorithm 7.1 did not converge, gap " + std::to_string(decomposition.gap)
                            : decomposition.message;
      return;
    }
    Normalisation normalisation = options_.normalisation;
    if (normalisation == Normalisation::MULTIPLIERS && decomposition.bound == 0.0)
      normalisation = Normalisation::LIFT_AND_PROJECT;  // no vertex, or one term: no N
    const ViolatedCut violated = mostViolatedCut(disjunction_, normalisation, decomposition.bound);
    if (!violated.found)
    {
      result_.message = "no most violated cut was found";
      return;
    }
    result_.calls = decomposition.calls;
    result_.bound = decomposition.bound;
    result_.norms = decomposition.norms;
    const NearestPoint projection = projectOrigin(disjunction_, options_.decomposition.nearest);
    result_.duality_error = std::abs(decomposition.deepest.norm() * projection.point.norm() - 1.0);
    result_.most_violated = studied(violated.direction);
    result_.deepest = studied(decomposition.deepest);
    for (const FacetCut& facet : decomposition.cuts)
    {
      StudiedCut one = studied(facet.direction);
      one.weight = facet.weight;
      one.is_ray = facet.is_ray;
      one.on_bound = facet.on_bound;
      result_.facets.push_back(one);
    }
    if (options_.check_facets)
      result_.dimension = faceDimension(disjunction_, Eigen::VectorXd::Zero(basis_.cols()));
    result_.with_most_violated = costWith({result_.most_violated});
    result_.with_deepest = costWith({result_.deepest});
    result_.with_facets = costWith(result_.facets);
    result_.status = StudyStatus::STUDIED;
  }

  StudiedCut studied(const Eigen::VectorXd& direction) const
  {
    StudiedCut cut;
    const double touching = support(disjunction_, direction).value;
    cut.row = basis_ * direction;
    cut.right_hand_side = cut.row.dot(result_.vertex) + touching;
    cut.depth = std::max(0.0, -touching / direction.norm());
    if (options_.check_facets)
      cut.face_dimension = faceDimension(disjunction_, direction);
    return cut;
  }

  double costWith(const std::vector<StudiedCut>& cuts) const
  {
    Polyhedron rows = {Eigen::MatrixXd(static_cast<Eigen::Index>(cuts.size()), program_.size()),
                       Eigen::VectorXd(static_cast<Eigen::Index>(cuts.size()))};
    for (size_t i = 0; i < cuts.size(); ++i)
    {
      rows.A.row(static_cast<Eigen::Index>(i)) = cuts[i].row.transpose();
      rows.b[static_cast<Eigen::Index>(i)] = cuts[i].right_hand_side;
    }
    const RelaxedSolution solution = solveRelaxation(program_, rows);
    return solution.status == LinearProgramStatus::OPTIMAL      ? solution.cost
           : solution.status == LinearProgramStatus::INFEASIBLE ? std::numeric_limits<double>::infinity()
                                                                : result_.relaxed;
  }

  Polyhedron none() const { return {Eigen::MatrixXd(0, program_.size()), Eigen::VectorXd(0)}; }

  const IntegerProgram& program_;
  const StudyOptions& options_;
  CutStudy& result_;
  Eigen::MatrixXd basis_;
  Disjunction disjunction_;
};
}  // namespace

CutStudy studyCuts(const IntegerProgram& program, const StudyOptions& options)
{
  CutStudy result;
  Study(program, options, result).run();
  return result;
}

}  // namespace frictional_contact_sim
