#pragma once
// One body with one row source, outside any simulation: rows, guess, readback and ledger of that source alone.
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/urdf_loader.h"

namespace frictional_contact_sim
{
class RowBench
{
public:
  /** @param make makes the source from (bodies, world, state); state.memory has one element for it */
  template <class Make>
  RowBench(const std::string& urdf, BaseType base, Make make)
    : model_(loadUrdf(urdf, "test", base).model), start_(model_)
  {
    model_.name = "body";
    bodies_.reserve(1);
    bodies_.emplace_back(model_, start_);
    world_.addBody(model_.tree);
    rows_.memory.resize(1);
    std::vector<std::unique_ptr<RowSource>> sources;
    sources.push_back(make(bodies_, world_, rows_));
    source_ = sources.back().get();
    assembly_ = std::make_unique<StepAssembly>(bodies_, std::move(sources), rows_);
  }

  Body& body() { return bodies_.front(); }
  CollisionWorld& world() { return world_; }
  RowState& rows() { return rows_; }
  StepContext& context() { return context_; }
  StepAssembly& assembly() { return *assembly_; }
  RowSource& source() { return *source_; }
  const IncrementalProblem& problem() const { return assembly_->problem(); }
  const Solution& guess() const { return guess_; }

  /** Points within `margin` and poses at the midpoint of a step from (q, v). */
  void moveToMidpoint(double margin = 1e-3)
  {
    frictional_contact_sim::moveToMidpoint(body(), context_.dt);
    updateEnd(body());
    world_.setPoses(0, body().middle);
    points_ = world_.detect(margin);
    context_.points = &points_;
  }
  /** Rows, guess and dynamics of a step from (q, v). */
  void assemble(double margin = 1e-3)
  {
    moveToMidpoint(margin);
    assembly_->begin(context_);
    assembleAgain();
  }
  void assembleAgain()
  {
    assembly_->assembleForces(context_);
    assembly_->assembleRows(context_);
    assembly_->makeGuess(context_, guess_);
    assembly_->assembleProblem(context_);
  }
  const std::vector<ContactPoint>& points() const { return points_; }
  /** A solution of the right shape, all zero. */
  Solution blank() const
  {
    Solution solution;
    solution.v.setZero(problem().velocities());
    solution.u.setZero(problem().rows());
    solution.r.setZero(problem().rows());
    solution.lambda.setZero(problem().bilaterals());
    return solution;
  }
  void accept(const Solution& solution) { assembly_->accept(context_, {solution, Eigen::VectorXd()}); }

private:
  BodyModel model_;
  BodyState start_;
  std::vector<Body> bodies_;
  CollisionWorld world_;
  RowState rows_;
  StepContext context_;
  std::vector<ContactPoint> points_;
  std::unique_ptr<StepAssembly> assembly_;
  RowSource* source_ = nullptr;
  Solution guess_;
};

}  // namespace frictional_contact_sim
