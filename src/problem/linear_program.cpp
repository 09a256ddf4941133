#include "frictional_contact_sim/problem/linear_program.h"

#include <coin/Clp_C_Interface.h>

#include <limits>
#include <stdexcept>

namespace frictional_contact_sim
{
const double LinearProgram::INFINITE = std::numeric_limits<double>::max();

struct LinearProgram::Model
{
  Model() : clp(Clp_newModel()) { Clp_setLogLevel(clp, 0); }
  ~Model() { Clp_deleteModel(clp); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  Clp_Simplex* clp;
};

LinearProgram::LinearProgram() : model_(std::make_unique<Model>()), row_starts_(1, 0)
{
}

LinearProgram::~LinearProgram() = default;

int LinearProgram::addColumn(double lower, double upper, double cost)
{
  if (loaded_)
    throw std::logic_error("linear program: columns come before the first solve");
  column_lower_.push_back(lower);
  column_upper_.push_back(upper);
  cost_.push_back(cost);
  return static_cast<int>(cost_.size()) - 1;
}

int LinearProgram::addRow(double lower, double upper, const std::vector<int>& columns,
                          const std::vector<double>& values)
{
  row_lower_.push_back(lower);
  row_upper_.push_back(upper);
  row_columns_.insert(row_columns_.end(), columns.begin(), columns.end());
  row_values_.insert(row_values_.end(), values.begin(), values.end());
  row_starts_.push_back(static_cast<int>(row_columns_.size()));
  return rows_++;
}

bool LinearProgram::solve(int max_iterations)
{
  Clp_Simplex* clp = model_->clp;
  if (!loaded_)
  {
    const auto columns = static_cast<int>(cost_.size());
    const std::vector<int> starts(cost_.size() + 1, 0);
    Clp_addColumns(clp, columns, column_lower_.data(), column_upper_.data(), cost_.data(), starts.data(), nullptr,
                   nullptr);
    // Tighter than Clp's 1e-7: data come scaled to one.
    Clp_setPrimalTolerance(clp, 1e-9);
    Clp_setDualTolerance(clp, 1e-9);
    // No scaling: a coefficient of round-off size makes Clp scale its row by 1e8 and stop far from the optimum.
    Clp_scaling(clp, 0);
  }
  if (!row_lower_.empty())
    Clp_addRows(clp, static_cast<int>(row_lower_.size()), row_lower_.data(), row_upper_.data(), row_starts_.data(),
                row_columns_.data(), row_values_.data());
  row_lower_.clear();
  row_upper_.clear();
  row_columns_.clear();
  row_values_.clear();
  row_starts_.assign(1, 0);
  Clp_setMaximumIterations(clp, max_iterations);
  if (!loaded_)
    Clp_initialSolve(clp);
  else
    Clp_dual(clp, 0);
  loaded_ = true;
  iterations_ += Clp_numberIterations(clp);
  return Clp_isProvenOptimal(clp) != 0;
}

LinearProgramStatus LinearProgram::status() const
{
  Clp_Simplex* clp = model_->clp;
  return Clp_isProvenOptimal(clp) != 0            ? LinearProgramStatus::OPTIMAL
         : Clp_isProvenPrimalInfeasible(clp) != 0 ? LinearProgramStatus::INFEASIBLE
         : Clp_isProvenDualInfeasible(clp) != 0   ? LinearProgramStatus::UNBOUNDED
                                                  : LinearProgramStatus::STOPPED;
}

void LinearProgram::setBounds(const Eigen::VectorXd& column_lower, const Eigen::VectorXd& column_upper,
                              const Eigen::VectorXd& row_lower, const Eigen::VectorXd& row_upper)
{
  Clp_chgColumnLower(model_->clp, column_lower.data());
  Clp_chgColumnUpper(model_->clp, column_upper.data());
  Clp_chgRowLower(model_->clp, row_lower.data());
  Clp_chgRowUpper(model_->clp, row_upper.data());
}

void LinearProgram::setCosts(const Eigen::VectorXd& costs)
{
  Clp_chgObjCoefficients(model_->clp, costs.data());
}

void LinearProgram::setEntry(int row, int column, double value)
{
  Clp_modifyCoefficient(model_->clp, row, column, value, true);
}

bool LinearProgram::solvePrimal(int max_iterations)
{
  Clp_setMaximumIterations(model_->clp, max_iterations);
  Clp_primal(model_->clp, 0);
  iterations_ += Clp_numberIterations(model_->clp);
  return Clp_isProvenOptimal(model_->clp) != 0;
}

Eigen::VectorXd LinearProgram::infeasibilityRay() const
{
  double* ray = Clp_infeasibilityRay(model_->clp);
  if (ray == nullptr)
    return {};
  const Eigen::VectorXd result = Eigen::Map<const Eigen::VectorXd>(ray, Clp_numberRows(model_->clp));
  Clp_freeRay(model_->clp, ray);
  return result;
}

Eigen::VectorXd LinearProgram::unboundedRay() const
{
  double* ray = Clp_unboundedRay(model_->clp);
  if (ray == nullptr)
    return {};
  const Eigen::VectorXd result = Eigen::Map<const Eigen::VectorXd>(ray, Clp_numberColumns(model_->clp));
  Clp_freeRay(model_->clp, ray);
  return result;
}

Eigen::VectorXd LinearProgram::reducedCosts() const
{
  return Eigen::Map<const Eigen::VectorXd>(Clp_getReducedCost(model_->clp), Clp_numberColumns(model_->clp));
}

Eigen::VectorXd LinearProgram::solution() const
{
  return Eigen::Map<const Eigen::VectorXd>(Clp_getColSolution(model_->clp), Clp_numberColumns(model_->clp));
}

Eigen::VectorXd LinearProgram::prices() const
{
  return Eigen::Map<const Eigen::VectorXd>(Clp_getRowPrice(model_->clp), Clp_numberRows(model_->clp));
}

}  // namespace frictional_contact_sim
