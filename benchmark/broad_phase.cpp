// Time and memory of a detection: balls in a loose grid, each its own body or ten in a row on one, that tremble by 1 mm
// a step or move past each other, every other one by 1 mm a step along x; FCL's trees against the list.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <cmath>
#include <random>

#include "frictional_contact_sim/collision/collision_world.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr double RADIUS = 0.1;  ///< [m]
constexpr double PITCH = 0.21;  ///< [m]
constexpr double STEP = 1e-3;  ///< most travel between two detections, in each direction [m]
constexpr double MARGIN = 3e-3;  ///< two steps' travel and 1 mm [m]

/** A free body of `shapes` balls in a row along x. */
fcs::MultibodyModel rowOfBalls(int shapes)
{
  fcs::MultibodyModel model;
  model.name = "row";
  model.links.push_back({"row", {}});
  fcs::Joint joint;
  joint.type = fcs::JointType::FLOATING;
  model.joints.push_back(joint);
  model.frames.push_back({"row", 0, Eigen::Isometry3d::Identity()});
  for (int k = 0; k < shapes; ++k)
  {
    fcs::CollisionShape shape;
    shape.name = "ball";
    shape.geometry = fcs::Sphere{RADIUS};
    shape.placement.translation().x() = PITCH * k;
    model.shapes.push_back(shape);
  }
  return model;
}

/** Bodies on a grid whose cells are rows, on a ground plane. */
class Grid
{
public:
  Grid(int bodies, int shapes, fcs::BroadPhaseKind kind, bool passing = false) : passing_(passing), random_(1)
  {
    world_.setBroadPhase(kind);
    world_.addStatic(fcs::HalfSpace{}, Eigen::Isometry3d::Identity(), "ground");
    const fcs::MultibodyModel model = rowOfBalls(shapes);
    const double count = static_cast<double>(bodies) * shapes;
    const int side = std::max(1, static_cast<int>(std::lround(std::cbrt(count))));
    const int along = std::max(1, side / shapes);
    for (int b = 0; b < bodies; ++b)
    {
      world_.addBody(model);
      const int cell = b / along;
      place_.emplace_back(PITCH * shapes * (b % along), PITCH * (cell % side), RADIUS + PITCH * (cell / side));
    }
    move();
  }
  /** Every body a random step further. */
  void move()
  {
    std::uniform_real_distribution<double> step(-STEP, STEP);
    for (size_t b = 0; b < place_.size(); ++b)
    {
      if (!passing_)
        place_[b] += Eigen::Vector3d(step(random_), step(random_), step(random_));
      else if (b % 2 == 0)
        place_[b].x() += STEP;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = place_[b];
      world_.setLinkPose(static_cast<int>(b), 0, pose);
    }
  }
  size_t detect() { return world_.detect(MARGIN).size(); }

private:
  bool passing_;
  fcs::CollisionWorld world_;
  std::vector<Eigen::Vector3d> place_;
  std::mt19937 random_;
};

void detect(benchmark::State& state, int shapes, fcs::BroadPhaseKind kind, bool passing)
{
  const int bodies = static_cast<int>(state.range(0));
  const size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  Grid grid(bodies, shapes, kind, passing);
  grid.detect();
  const size_t after = mallinfo2().uordblks + mallinfo2().hblkhd;
  size_t contacts = 0;
  for (auto _ : state)
  {
    grid.move();
    contacts = grid.detect();
  }
  state.SetComplexityN(bodies * shapes);
  state.counters["shapes"] = bodies * shapes;
  state.counters["contacts"] = static_cast<double>(contacts);
  state.counters["bytes_per_shape"] = static_cast<double>(after - before) / (bodies * shapes);
}

void onlyMove(benchmark::State& state)
{
  Grid grid(static_cast<int>(state.range(0)), 1, fcs::BroadPhaseKind::AUTO);
  for (auto _ : state)
    grid.move();
}

#define SIZES RangeMultiplier(2)->Range(16, 1024)->Complexity()->Unit(benchmark::kMicrosecond)
BENCHMARK(onlyMove)->Arg(216)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(detect, balls_list, 1, fcs::BroadPhaseKind::LIST, false)->SIZES;
BENCHMARK_CAPTURE(detect, balls_fcl, 1, fcs::BroadPhaseKind::FCL, false)->SIZES;
BENCHMARK_CAPTURE(detect, balls_auto, 1, fcs::BroadPhaseKind::AUTO, false)->SIZES;
BENCHMARK_CAPTURE(detect, passing_list, 1, fcs::BroadPhaseKind::LIST, true)->SIZES->Arg(4096);
BENCHMARK_CAPTURE(detect, passing_fcl, 1, fcs::BroadPhaseKind::FCL, true)->SIZES->Arg(4096);
BENCHMARK_CAPTURE(detect, rows_of_10_list, 10, fcs::BroadPhaseKind::LIST, false)->SIZES;
BENCHMARK_CAPTURE(detect, rows_of_10_fcl, 10, fcs::BroadPhaseKind::FCL, false)->SIZES;
}  // namespace

BENCHMARK_MAIN();
