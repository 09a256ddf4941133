#include "loops.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/dynamics/closure_rows.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MOST_ITERATIONS = 200;
constexpr double LONGEST_STEP = 0.3;  ///< of one iteration, each coordinate [rad] or [m]
constexpr double CLOSED = 1e-10;  ///< [m], [rad]; steps go on while they gain
constexpr double SAID = 1e-9;  ///< a start that is farther off than this is worth a word [m], [rad]
constexpr double DEPENDENT = 1e-9;  ///< share of a row that the others leave over: none

std::string describe(const WorldModel& world, size_t loop)
{
  return "loop '" + world.loop_names[loop] + "'";
}

void addLoop(const Closure& loop, const std::string& name, WorldModel& world)
{
  world.loops.push_back(loop);
  world.loop_names.push_back(name);
}

/** Body and frame of one side of a loop. */
std::pair<int, int> findSide(const WorldModel& world, const LoopSpec& loop, const LoopSide& side)
{
  if (side.body.empty())
    return {-1, -1};
  std::vector<std::string> names;
  int body = -1;
  for (size_t b = 0; b < world.bodies.size(); ++b)
  {
    names.push_back(world.bodies[b].name);
    body = names.back() == side.body ? static_cast<int>(b) : body;
  }
  const std::string label = (loop.source.empty() ? "" : loop.source + ": ") + "loop '" + loop.name + "'";
  if (body < 0)
    throw std::invalid_argument(label + ": found body '" + side.body + "', " + didYouMean(side.body, names) +
                                "expected world or one of " + joinNames(names));
  if (world.bodies[static_cast<size_t>(body)].solid)
    throw std::invalid_argument(label + ": body '" + side.body +
                                "' is deformable, expected a rigid one: loops join rigid links");
  const MultibodyModel& tree = world.bodies[static_cast<size_t>(body)].tree;
  const int frame = tree.findFrame(side.link);
  if (frame >= 0)
    return {body, frame};
  names.clear();
  for (const Frame& known : tree.frames)
    names.push_back(known.name);
  throw std::invalid_argument(label + ": found link '" + side.link + "', " + didYouMean(side.link, names) +
                              "expected a link of body '" + side.body + "'");
}

int linkOf(const WorldModel& world, int body, int frame)
{
  return body < 0 ? -1 : world.bodies[static_cast<size_t>(body)].tree.frames[static_cast<size_t>(frame)].link;
}

/** All loops of a world as equations in the coordinates of all bodies. */
class LoopEquations
{
public:
  explicit LoopEquations(WorldModel& world) : world_(world)
  {
    for (size_t b = 0; b < world.bodies.size(); ++b)
    {
      bodies_.emplace_back(world.bodies[b], world.start[b]);
      bodies_.back().v_offset = columns_;
      columns_ += world.bodies[b].tree.nv;
      updateEnd(bodies_.back());
    }
    int rows = 0;
    for (const Closure& loop : world.loops)
    {
      first_row_.push_back(rows);
      rows += rowsOf(loop.type);
    }
    first_row_.push_back(rows);
    for (const Body& body : bodies_)
      for (const Joint& joint : body.model.tree.joints)
        rows += joint.mimic.joint >= 0 ? 1 : 0;
    matrix_.setZero(rows, columns_);
    error_.setZero(rows);
  }

  int columns() const { return columns_; }
  const std::vector<Body>& bodies() const { return bodies_; }

  /** At the present positions; mimic joints hold already and stay so. */
  void evaluate()
  {
    matrix_.setZero();
    error_.setZero();
    for (size_t i = 0; i < world_.loops.size(); ++i)
      evaluateLoop(world_.loops[i], first_row_[i]);
    int row = first_row_.back();
    for (const Body& body : bodies_)
      for (const Joint& joint : body.model.tree.joints)
        if (joint.mimic.joint >= 0)
        {
          const Joint& followed = body.model.tree.joints[static_cast<size_t>(joint.mimic.joint)];
          matrix_(row, body.v_offset + joint.v_index) = 1.0;
          matrix_(row, body.v_offset + followed.v_index) = -joint.mimic.multiplier;
          error_[row++] = body.state.q[joint.q_index] - joint.mimic.multiplier * body.state.q[followed.q_index] -
                          joint.mimic.offset;
        }
  }

  double errorOf(size_t loop) const
  {
    return error_.segment(first_row_[loop], rowsOf(world_.loops[loop].type)).cwiseAbs().maxCoeff();
  }
  double worst() const { return error_.size() == 0 ? 0.0 : error_.cwiseAbs().maxCoeff(); }

  /** One step of Gauss and Newton with the coordinates that may move. @return largest change [rad] or [m] */
  double step(const std::vector<char>& movable)
  {
    Eigen::MatrixXd reduced = matrix_;
    for (int j = 0; j < columns_; ++j)
      if (movable[static_cast<size_t>(j)] == 0)
        reduced.col(j).setZero();
    // Rows that others say already make the least squares solution, not the step.
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
    factor.setThreshold(DEPENDENT);
    factor.compute(reduced);
    Eigen::VectorXd change = -factor.solve(error_);
    const double size = change.size() == 0 ? 0.0 : change.cwiseAbs().maxCoeff();
    if (!(size > 0.0) || !std::isfinite(size))
      return 0.0;
    change *= std::min(1.0, LONGEST_STEP / size);
    for (Body& body : bodies_)
    {
      const int nv = body.model.tree.nv;
      if (nv == 0)
        continue;
      const Eigen::VectorXd moved = change.segment(body.v_offset, nv);
      integrate(body.model.tree, body.state.q, moved, 1.0, body.state.q);
      for (const Joint& joint : body.model.tree.joints)
        if (velocitySize(joint.type) == 1 && movable[static_cast<size_t>(body.v_offset + joint.v_index)] != 0)
          body.state.q[joint.q_index] =
              std::min(std::max(body.state.q[joint.q_index], joint.limit.lower), joint.limit.upper);
      updateEnd(body);
    }
    return size;
  }

  /** How many rows of each loop the rows before it and the mimic joints say already. */
  std::vector<int> redundantRows() const
  {
    std::vector<int> redundant;
    const Eigen::Index mimics = matrix_.rows() - first_row_.back();
    std::vector<Eigen::VectorXd> basis;
    const auto isNew = [&basis](Eigen::VectorXd row)
    {
      const double size = row.norm();
      for (int twice = 0; twice < 2; ++twice)
        for (const Eigen::VectorXd& other : basis)
          row -= other.dot(row) * other;
      if (!(row.norm() > DEPENDENT * std::max(size, 1.0)))
        return false;
      basis.push_back(row.normalized());
      return true;
    };
    for (Eigen::Index row = matrix_.rows() - mimics; row < matrix_.rows(); ++row)
      isNew(matrix_.row(row));
    for (size_t i = 0; i < world_.loops.size(); ++i)
    {
      redundant.push_back(0);
      for (int row = first_row_[i]; row < first_row_[i + 1]; ++row)
        redundant.back() += isNew(matrix_.row(row)) ? 0 : 1;
    }
    return redundant;
  }

  void refresh()
  {
    for (Body& body : bodies_)
      updateEnd(body);
  }

private:
  Eigen::Isometry3d poseOf(int body, int frame) const
  {
    if (body < 0)
      return Eigen::Isometry3d::Identity();
    const Body& moved = bodies_[static_cast<size_t>(body)];
    return framePose(moved.model.tree, moved.end, frame);
  }

  void evaluateLoop(const Closure& loop, int first)
  {
    const Eigen::Isometry3d anchor = poseOf(loop.body_a, loop.frame_a) * loop.anchor;
    const Eigen::Isometry3d wanted = poseOf(loop.body_b, loop.frame_b) * loop.pose;
    const Eigen::Matrix3d basis = closureBasis(loop.type, wanted);
    const int rows = rowsOf(loop.type);
    error_.segment(first, rows) = closureError(loop.type, anchor, wanted, basis).head(rows);
    for (const bool is_a : {true, false})
    {
      const int index = is_a ? loop.body_a : loop.body_b;
      if (index < 0)
        continue;
      const Body& body = bodies_[static_cast<size_t>(index)];
      const int link = linkOf(world_, index, is_a ? loop.frame_a : loop.frame_b);
      Matrix6Xd jacobian(6, body.model.tree.nv);
      pointJacobian(body.model.tree, body.end, link, is_a ? anchor.translation() : wanted.translation(), jacobian);
      const double sign = is_a ? 1.0 : -1.0;
      for (int k = 0; k < rows; ++k)
      {
        auto row = matrix_.row(first + k).segment(body.v_offset, body.model.tree.nv);
        if (k < 3)
          row += sign * jacobian.row(k);
        else
          row += sign * (basis.col(k - 3).transpose() * jacobian.bottomRows<3>());
      }
    }
  }

  WorldModel& world_;
  std::vector<Body> bodies_;
  int columns_ = 0;
  std::vector<int> first_row_;  ///< loops, and one more
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd error_;
};

/** Who may move in the first, second and last attempt to close the loops. */
enum class Freedom
{
  UNSAID,
  JOINTS,
  BASES
};

std::vector<char> movableColumns(const WorldModel& world, const LoopEquations& equations, Freedom freedom)
{
  std::vector<char> movable(static_cast<size_t>(equations.columns()), 0);
  for (size_t b = 0; b < world.bodies.size(); ++b)
    for (const Joint& joint : world.bodies[b].tree.joints)
    {
      const bool is_base = joint.parent < 0;
      const bool is_said = world.scenario.bodies[b].joints.count(joint.name) > 0;
      if (is_base ? freedom == Freedom::BASES : freedom != Freedom::UNSAID || !is_said)
        for (int k = 0; k < velocitySize(joint.type); ++k)
          movable[static_cast<size_t>(equations.bodies()[b].v_offset + joint.v_index + k)] = 1;
    }
  return movable;
}

/** From the present positions; where it does not succeed they are as before. */
bool close(LoopEquations& equations, const std::vector<char>& movable, WorldModel& world)
{
  const std::vector<BodyState> before = world.start;
  double last = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < MOST_ITERATIONS; ++iteration)
  {
    equations.evaluate();
    const double now = equations.worst();
    if (now <= CLOSED && (now == 0.0 || now > 0.5 * last))
      return true;
    last = now;
    if (!(equations.step(movable) > 0.0))
      break;
  }
  for (size_t b = 0; b < before.size(); ++b)
    world.start[b].q = before[b].q;
  equations.refresh();
  equations.evaluate();
  return false;
}

std::string millimetres(double error)
{
  return numberText(error) + " m or rad";
}
}  // namespace

void addLoopsOfBody(int body, WorldModel& world)
{
  for (const LoopJoint& joint : world.bodies[static_cast<size_t>(body)].tree.loops)
  {
    Closure loop;
    loop.type = joint.type;
    loop.body_a = loop.body_b = body;
    loop.frame_a = joint.frame_a;
    loop.frame_b = joint.frame_b;
    loop.anchor = joint.anchor;
    loop.pose = joint.pose;
    addLoop(loop, world.bodies[static_cast<size_t>(body)].name + "/" + joint.name, world);
  }
}

void separate(const Closure& loop, WorldModel& world)
{
  if (loop.body_b >= 0)
    world.collision.disableJoined({loop.body_a, linkOf(world, loop.body_a, loop.frame_a)},
                                  {loop.body_b, linkOf(world, loop.body_b, loop.frame_b)});
}

void removeLoopsOfBody(int body, WorldModel& world)
{
  const std::vector<Closure> old = std::move(world.loops);
  const std::vector<std::string> old_names = std::move(world.loop_names);
  world.loops.clear();
  world.loop_names.clear();
  for (size_t i = 0; i < old.size(); ++i)
  {
    if (old[i].body_a == body || old[i].body_b == body)
      continue;
    addLoop(old[i], old_names[i], world);
    for (int* index : {&world.loops.back().body_a, &world.loops.back().body_b})
      *index -= *index > body ? 1 : 0;
  }
}

void addLoopsOfScenario(WorldModel& world)
{
  for (const LoopSpec& spec : world.scenario.loops)
  {
    const bool is_swapped = spec.a.body.empty();  // link a is never the world
    const LoopSide& side_a = is_swapped ? spec.b : spec.a;
    const LoopSide& side_b = is_swapped ? spec.a : spec.b;
    Closure loop;
    loop.type = spec.type;
    std::tie(loop.body_a, loop.frame_a) = findSide(world, spec, side_a);
    std::tie(loop.body_b, loop.frame_b) = findSide(world, spec, side_b);
    loop.anchor = side_a.placement;
    loop.pose = side_b.placement;
    const std::string label = (spec.source.empty() ? "" : spec.source + ": ") + "loop '" + spec.name + "'";
    const int link_a = linkOf(world, loop.body_a, loop.frame_a);
    const int link_b = linkOf(world, loop.body_b, loop.frame_b);
    if (loop.body_a < 0 || (loop.body_a == loop.body_b && link_a == link_b))
      throw std::invalid_argument(label +
                                  ": both sides are one rigid thing, expected two that move against each other");
    const auto moves = [&](int body, int link)
    { return body >= 0 && !world.bodies[static_cast<size_t>(body)].chains[static_cast<size_t>(link)].empty(); };
    if (!moves(loop.body_a, link_a) && !moves(loop.body_b, link_b))
      throw std::invalid_argument(label + ": neither side can move, expected one that can");
    addLoop(loop, spec.name, world);
  }
}

void closeLoops(WorldModel& world, size_t first)
{
  if (world.loops.size() == first)
    return;
  LoopEquations equations(world);
  equations.evaluate();
  std::vector<double> open;
  for (size_t i = 0; i < world.loops.size(); ++i)
    open.push_back(equations.errorOf(i));
  std::vector<Eigen::VectorXd> before;
  for (const BodyState& body : world.start)
    before.push_back(body.q);
  bool is_closed = false;
  for (const Freedom freedom : {Freedom::UNSAID, Freedom::JOINTS, Freedom::BASES})
    is_closed = is_closed || close(equations, movableColumns(world, equations, freedom), world);
  if (!is_closed)
  {
    size_t worst = 0;
    for (size_t i = 0; i < world.loops.size(); ++i)
      worst = equations.errorOf(i) > equations.errorOf(worst) ? i : worst;
    throw std::invalid_argument(describe(world, worst) + " cannot be closed: it is " +
                                millimetres(equations.errorOf(worst)) +
                                " open at the start, and no position within the joints' limits was found that closes "
                                "all loops");
  }
  double moved = 0.0;
  for (size_t b = 0; b < world.start.size(); ++b)
    if (before[b].size() > 0)
      moved = std::max(moved, (world.start[b].q - before[b]).cwiseAbs().maxCoeff());
  for (size_t i = first; i < world.loops.size(); ++i)
    if (open[i] > SAID)
      world.warnings.push_back(describe(world, i) + " was open by " + millimetres(open[i]) +
                               " at the start: joints were moved by up to " + numberText(moved) + " to close it");
  const std::vector<int> redundant = equations.redundantRows();
  for (size_t i = first; i < world.loops.size(); ++i)
    if (redundant[i] > 0)
      world.warnings.push_back(describe(world, i) + ": " + std::to_string(redundant[i]) + " of its " +
                               std::to_string(rowsOf(world.loops[i].type)) +
                               " rows say what other joints say already; motions are the same without them, how they "
                               "share the forces is a choice (least norm)");
}

void checkLoops(const WorldModel& world)
{
  if (world.loops.empty())
    return;
  WorldModel copy = world;
  LoopEquations equations(copy);
  equations.evaluate();
  for (size_t i = 0; i < world.loops.size(); ++i)
    if (equations.errorOf(i) > 1e-6)
      throw std::invalid_argument(describe(world, i) + " is open by " + millimetres(equations.errorOf(i)) +
                                  " since a body without a pose was set on the ground: expected a pose of each body "
                                  "that it joins");
}

}  // namespace frictional_contact_sim
