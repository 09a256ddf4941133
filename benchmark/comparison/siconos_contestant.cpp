#include <siconos/numerics/FrictionContactProblem.h>
#include <siconos/numerics/Friction_cst.h>
#include <siconos/numerics/NonSmoothDrivers.h>
#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/SolverOptions.h>

#include <algorithm>

#include "comparison/contestant.h"
#include "comparison/siconos_matrix.h"

namespace comparison
{
namespace
{
using frictional_contact_sim::DelassusProblem;
using frictional_contact_sim::LawType;

struct Recipe
{
  const char* solver;
  int id;
  int max_iterations;  ///< high enough that the time limit decides
  Storage storage;
  const char* extra;  ///< added to the name of the variant
  std::function<void(SolverOptions&)> adjust;
};

void useLusol(SolverOptions& options)
{
  options.iparam[SICONOS_FRICTION_3D_NSN_LINEAR_SOLVER] = SICONOS_FRICTION_3D_NSN_USE_CSLUSOL;
}
void useMumps(SolverOptions& options)
{
  options.iparam[SICONOS_FRICTION_3D_NSN_LINEAR_SOLVER] = SICONOS_FRICTION_3D_NSN_USE_MUMPS;
}
void lightError(SolverOptions& options)
{
  options.iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] =
      SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_LIGHT_WITH_FULL_FINAL;
}
void moreInnerIterations(SolverOptions& options)
{
  for (size_t k = 0; k < options.numberOfInternalSolvers; ++k)
    if (options.internalSolvers[k] != nullptr)
      options.internalSolvers[k]->iparam[SICONOS_IPARAM_MAX_ITER] = 100000;
}

/** A solver's first two variants are what it is judged by where both run out of time: those for large problems. */
std::vector<Recipe> spatialRecipes()
{
  std::vector<Recipe> recipes;
  for (const Storage storage : {Storage::SPARSE_BLOCK, Storage::DENSE})
  {
    recipes.push_back({"siconos NSGS", SICONOS_FRICTION_3D_NSGS, 10000000, storage, "", nullptr});
    recipes.push_back({"siconos NSGS", SICONOS_FRICTION_3D_NSGS, 10000000, storage, ", light error", &lightError});
    recipes.push_back({"siconos ACLM", SICONOS_FRICTION_3D_ACLMFP, 100000, storage, "", &moreInnerIterations});
  }
  const std::pair<const char*, int> newtons[] = {{"siconos NSN-AC", SICONOS_FRICTION_3D_NSN_AC},
                                                 {"siconos NSN-FB", SICONOS_FRICTION_3D_NSN_FB},
                                                 {"siconos NSN-NM", SICONOS_FRICTION_3D_NSN_NM}};
  for (const auto& [name, id] : newtons)
  {
    recipes.push_back({name, id, 100000, Storage::SPARSE_BLOCK, ", CSparse", &useLusol});
    recipes.push_back({name, id, 100000, Storage::DENSE, "", nullptr});
    recipes.push_back({name, id, 100000, Storage::SPARSE_BLOCK, ", MUMPS", &useMumps});
  }
  for (const Storage storage : {Storage::SPARSE, Storage::DENSE, Storage::SPARSE_BLOCK})
    recipes.push_back({"siconos ADMM", SICONOS_FRICTION_3D_ADMM, 10000000, storage, "", nullptr});
  return recipes;
}

std::vector<Recipe> planarRecipes()
{
  return {{"siconos 2D NSGS", SICONOS_FRICTION_2D_NSGS, 10000000, Storage::DENSE, "", nullptr},
          {"siconos 2D NSGS", SICONOS_FRICTION_2D_NSGS, 10000000, Storage::SPARSE_BLOCK, "", nullptr},
          {"siconos 2D CPG", SICONOS_FRICTION_2D_CPG, 1000000, Storage::DENSE, "", nullptr},
          {"siconos 2D Lemke", SICONOS_FRICTION_2D_LEMKE, 1000000, Storage::DENSE, "", nullptr}};
}

class SiconosContestant : public Contestant
{
public:
  SiconosContestant(const DelassusProblem& problem, const Recipe& recipe)
    : recipe_(recipe)
    , dimension_(problem.laws.front().dimension())
    , q_(problem.q)
    , r_(Eigen::VectorXd::Zero(q_.size()))
    , u_(Eigen::VectorXd::Zero(q_.size()))
  {
    for (const auto& law : problem.laws)
      mu_.push_back(law.coefficient);
    problem_ = frictionContactProblem_new_with_data(dimension_, static_cast<int>(mu_.size()),
                                                    copyToSiconos(problem.W, recipe.storage), q_.data(), mu_.data());
  }
  /** New options for every solve: some solvers change theirs (inner tolerances, penalties) as they go. */
  void prepare(double tolerance, int solves, double) override
  {
    for (SolverOptions* options : options_)
      solver_options_delete(options);
    options_.clear();
    for (int k = 0; k < solves; ++k)
    {
      SolverOptions* options = solver_options_create(recipe_.id);
      options->dparam[SICONOS_DPARAM_TOL] = tolerance;
      options->iparam[SICONOS_IPARAM_MAX_ITER] = recipe_.max_iterations;
      if (recipe_.adjust)
        recipe_.adjust(*options);
      options_.push_back(options);
    }
    next_ = 0;
  }
  bool solve() override
  {
    r_.setZero();
    u_.setZero();
    SolverOptions* options = options_[next_++];
    const int info = dimension_ == 3 ? fc3d_driver(problem_, r_.data(), u_.data(), options)
                                     : fc2d_driver(problem_, r_.data(), u_.data(), options);
    return info == 0;
  }
  const Eigen::VectorXd& impulses() const override { return r_; }

private:
  Recipe recipe_;
  int dimension_;
  Eigen::VectorXd q_, r_, u_;
  std::vector<double> mu_;
  FrictionContactProblem* problem_ = nullptr;  ///< lives as long as the child process
  std::vector<SolverOptions*> options_;
  size_t next_ = 0;
};
}  // namespace

std::vector<Entry> siconosEntries(const DelassusProblem& problem, const std::vector<std::string>& names)
{
  if (problem.laws.empty())
    return {};
  const LawType type = problem.laws.front().type;
  const bool uniform = std::all_of(problem.laws.begin(), problem.laws.end(),
                                   [type](const auto& law) { return law.isCoulomb() && law.type == type; });
  if (!uniform)
    return {};
  std::vector<Entry> entries;
  for (const Recipe& recipe : type == LawType::COULOMB_3D ? spatialRecipes() : planarRecipes())
    if (names.empty() || std::find(names.begin(), names.end(), recipe.solver) != names.end())
      entries.push_back({recipe.solver, std::string(toString(recipe.storage)) + recipe.extra, false,
                         [&problem, recipe] { return std::make_unique<SiconosContestant>(problem, recipe); }});
  return entries;
}

}  // namespace comparison
