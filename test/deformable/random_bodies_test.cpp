// Invariants on generated scenes of elastic blocks, rods and rigid bodies that fall on and are pressed into each other:
// penetration by closed distances, energy, momentum, equal bits, going on from a saved state.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/deformable/super_helix.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_file.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;
using test_support::list;
using test_support::text;

constexpr double STEP = 0.001;
constexpr double ROD_RADIUS = 0.002;

/** A rigid shape and where it was put in; sphere: size.x() is its radius. */
struct Solid
{
  int body = 0;
  bool is_sphere = false;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
};

struct Scene
{
  Scenario scenario;
  std::vector<Solid> solids;
  bool is_driven = false;
};

std::string blockText(Dice& dice, const std::string& name, double z, const std::string& fixed)
{
  const bool is_plane = dice.chance(0.5);
  const std::string size = is_plane ? "[0.1, 0.1]" : "[0.1, 0.08, 0.1]";
  const std::string cells = is_plane ? "[" + std::to_string(dice.integer(2, 5)) + ", 4]" : "[2, 2, 2]";
  return "  - name: " + name + "\n    elastic: {box: " + size + ", cells: " + cells +
         ", thickness: 0.08, young_modulus: " + text(dice.logUniform(2e5, 5e6)) +
         ", poisson_ratio: " + text(dice.uniform(0.0, 0.45)) +
         ", density: 1000, damping: " + text(dice.chance(0.5) ? 0.0 : 0.002) + ", fixed: [" + fixed +
         "]}\n    pose: {xyz: [0, 0, " + text(z) + "]}\n";
}

std::string rodText(Dice& dice, const std::string& name, const Eigen::Vector3d& root)
{
  return "  - name: " + name + "\n    rod: {length: 0.2, radius: " + text(ROD_RADIUS) +
         ", pieces: 4, sections: 6, density: 1300, young_modulus: " + text(dice.logUniform(5e6, 5e7)) +
         ", damping: 0.002, natural: " + list(dice.vector(2.0)) + "}\n    pose: {xyz: " + list(root) + "}\n" +
         (dice.chance(0.5) ? "" : "    motion: {type: sine, axis: [0, 0.6, 0.8], amplitude: 0.01, frequency: 4}\n");
}

BodySpec rigid(Dice& dice, const std::string& name, double z, Solid& solid)
{
  solid.is_sphere = dice.chance(0.5);
  const double half = 0.06;
  solid.size = solid.is_sphere ? Eigen::Vector3d::Constant(half) : Eigen::Vector3d(0.16, 0.14, 2.0 * half);
  const std::string geometry =
      solid.is_sphere ? "<sphere radius='" + text(half) + "'/>" : "<box size='" + text(solid.size) + "'/>";
  BodySpec body;
  body.name = name;
  body.urdf_xml = "<robot name='b'><link name='b'><inertial><mass value='" + text(dice.uniform(0.2, 1.0)) +
                  "'/><inertia ixx='0.002' ixy='0' ixz='0' iyy='0.002' iyz='0' izz='0.002'/></inertial><collision>"
                  "<geometry>" +
                  geometry + "</geometry></collision></link></robot>";
  body.pose = Eigen::Isometry3d(Eigen::Translation3d(dice.uniform(-0.01, 0.01), 0.0, z + half));
  return body;
}

/** From below: a block that is free on the ground, or held at its bottom; a rigid body that falls on it or is driven
 *  into it; rods from the side that come to lie on what is there. */
Scene randomScene(std::uint32_t seed)
{
  Dice dice(seed);
  Scene scene;
  const bool is_held = dice.chance(0.4);
  const int rods = dice.integer(0, 2);
  scene.is_driven = is_held && dice.chance(0.6);
  std::string yaml = "time_step: " + text(STEP) + "\nmaterials: {default: {friction: " + text(dice.uniform(0.0, 0.8)) +
                     "}}\nground: {}\nbodies:\n" +
                     blockText(dice, "block", 0.05 + dice.uniform(0.0, 0.004), is_held ? "bottom" : "");
  for (int k = 0; k < rods; ++k)
    yaml += rodText(dice, "rod_" + std::to_string(k), {-0.2 - 0.02 * k, 0.03 * (2 * k - 1), 0.31 + 0.02 * k});
  scene.scenario = loadScenario(yaml, "scene");
  Solid solid;
  solid.body = 1 + rods;
  BodySpec body = rigid(dice, "solid", 0.108 + dice.uniform(0.0, 0.01), solid);
  if (scene.is_driven)
  {
    body.base = BaseType::FIXED;
    body.motion = BaseMotion(Eigen::Vector3d(dice.uniform(-0.02, 0.02), 0.0, -0.08), Eigen::Vector3d::Zero());
  }
  scene.scenario.bodies.push_back(body);
  scene.solids.push_back(solid);
  return scene;
}

/** Distance of a point from a rigid shape, negative inside. */
double distance(const Solid& solid, const Simulator& simulator, const Eigen::Vector3d& point)
{
  const Eigen::Vector3d x = simulator.data(solid.body).link_pose[0].inverse() * point;
  if (solid.is_sphere)
    return x.norm() - solid.size.x();
  const Eigen::Vector3d beyond = x.cwiseAbs() - 0.5 * solid.size;
  return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
}

bool isRod(const Simulator& simulator, int body)
{
  return dynamic_cast<const SuperHelix*>(simulator.workspace(body).model.solid.get()) != nullptr;
}

bool isElastic(const Simulator& simulator, int body)
{
  return dynamic_cast<const ElasticSolid*>(simulator.workspace(body).model.solid.get()) != nullptr;
}

/** Points of a body's surface less the radius there: nodes, or samples of the sections' axes. */
std::vector<Eigen::Vector3d> samples(const Simulator& simulator, int body)
{
  std::vector<Eigen::Vector3d> points;
  const std::vector<Eigen::Isometry3d>& poses = simulator.data(body).link_pose;
  const double half = isRod(simulator, body) ? 0.5 * 0.2 / 24.0 : 0.0;
  for (size_t link = 1; link < poses.size(); ++link)
    for (const double share : half > 0.0 ? std::vector<double>{-1.0, -0.5, 0.0, 0.5, 1.0} : std::vector<double>{0.0})
      points.push_back(poses[link] * Eigen::Vector3d(share * half, 0.0, 0.0));
  return points;
}

/** Deepest of all nodes and rods in rigid shapes, the ground and each other [m]. */
double deepest(const Scene& scene, const Simulator& simulator)
{
  double depth = 0.0;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    if (!isRod(simulator, body) && !isElastic(simulator, body))
      continue;
    const double radius = isRod(simulator, body) ? ROD_RADIUS : 0.0;
    const std::vector<Eigen::Vector3d> points = samples(simulator, body);
    for (const Eigen::Vector3d& point : points)
    {
      depth = std::max(depth, radius - point.z());
      for (const Solid& solid : scene.solids)
        depth = std::max(depth, radius - distance(solid, simulator, point));
    }
    for (int other = body + 1; other < simulator.bodyCount(); ++other)
      if (isRod(simulator, other))
        for (const Eigen::Vector3d& theirs : samples(simulator, other))
          for (const Eigen::Vector3d& point : points)
            depth = std::max(depth, radius + ROD_RADIUS - (theirs - point).norm());
  }
  return depth;
}

/** Linear momentum of the bodies that nothing holds, and the impulses of the step on them from outside, weight too. */
struct Balance
{
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
};

bool isFree(const Simulator& simulator, int body)
{
  if (isElastic(simulator, body))
    return !simulator.workspace(body).model.solid->isSupported();
  return !isRod(simulator, body) && simulator.model(body).nv > 0;
}

Balance balanceOf(const Simulator& simulator)
{
  Balance balance;
  const Eigen::Vector3d gravity = simulator.scenario().gravity;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    if (!isFree(simulator, body))
      continue;
    double mass = simulator.model(body).totalMass();
    if (isElastic(simulator, body))
    {
      const auto& solid = static_cast<const ElasticSolid&>(*simulator.workspace(body).model.solid);
      mass = solid.totalMass();
      for (int axis = 0; axis < 3; ++axis)
        balance.momentum[axis] += solid.carried(axis).dot(simulator.velocity(body));
    }
    else
      balance.momentum +=
          mass * pointVelocity(simulator.data(body), 0, simulator.data(body).link_pose[0].translation()).head<3>();
    balance.impulse += STEP * mass * gravity;
  }
  for (const ContactState& contact : simulator.contacts())
    for (const int side : {1, -1})
    {
      const int body = simulator.shape(side > 0 ? contact.shape_a : contact.shape_b).body;
      if (body < 0 || !isFree(simulator, body))
        continue;
      // A plane body does not move along y: its plane takes that.
      const bool is_plane =
          isElastic(simulator, body) &&
          static_cast<const ElasticSolid&>(*simulator.workspace(body).model.solid).parts().dimension == 2;
      balance.impulse += side * (is_plane ? Eigen::Vector3d(contact.impulse.x(), 0.0, contact.impulse.z())
                                          : Eigen::Vector3d(contact.impulse));
    }
  return balance;
}

class RandomBodiesTest : public testing::TestWithParam<int>
{
};

TEST_P(RandomBodiesTest, NothingPassesNothingIsGainedAndForcesMakeTheMomentum)
{
  const Scene scene = randomScene(GetParam());
  Simulator simulator(scene.scenario);
  ASSERT_TRUE(simulator.outcome().converged());
  const EnergyLedger& energy = simulator.report().energy;
  bool is_moved = scene.is_driven;
  bool has_rods = false;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    is_moved = is_moved || scene.scenario.bodies[body].motion.has_value();
    has_rods = has_rods || isRod(simulator, body);
  }
  // Without rods every force of the step is constant or at the midpoint: the ledger closes but for rounding. A rod's
  // mass matrix turns with it, and its scheme is of second order in the step.
  const double open_share = has_rods ? 5e-3 : 1e-11;
  double exchanged = 1e-3;
  double least = energy.kinetic + energy.potential;
  int forces = 0;
  for (int step = 0; step < 250; ++step)
  {
    const Eigen::Vector3d before = balanceOf(simulator).momentum;
    simulator.step();
    if (scene.is_driven && simulator.outcome().message.find("has turned by") != std::string::npos)
      break;  // pressed beyond what linear elasticity is good for, and it says so
    ASSERT_TRUE(simulator.outcome().converged()) << "step " << step << ": " << simulator.outcome().message;
    // The answer's poses are looked at with the true geometry; what is left is the curvature of a path in a step.
    double spin = 0.0;
    for (int body = 0; body < simulator.bodyCount(); ++body)
      for (const Vector6d& velocity : simulator.data(body).link_velocity)
        spin = std::max(spin, velocity.tail<3>().squaredNorm());
    ASSERT_LT(deepest(scene, simulator), 1e-6 + STEP * STEP * 0.2 * spin) << "step " << step;
    const Balance after = balanceOf(simulator);
    ASSERT_LT((after.momentum - before - after.impulse).norm(), 1e-9 * (1.0 + after.momentum.norm()))
        << "step " << step;
    for (const ContactState& contact : simulator.contacts())
    {
      ASSERT_GE(contact.cone_margin, -1e-9);
      forces += contact.impulse.norm() > 0.0;
    }
    exchanged = std::max(exchanged, energy.kinetic + energy.friction + energy.impact + energy.joints);
    ASSERT_LT(std::abs(energy.balance_error), open_share * exchanged) << "step " << step;
    if (!is_moved)
    {
      // What a step gains is what normal impulses put in where the curvature of a path in the step before is pushed
      // out.
      ASSERT_LT(energy.kinetic + energy.potential, least + 1e-2 * exchanged) << "step " << step;
    }
    least = std::min(least, energy.kinetic + energy.potential);
  }
  EXPECT_GT(forces, 20) << "they have met";
}

TEST_P(RandomBodiesTest, SameBitsInTwoRunsAndFromASavedState)
{
  const Scene scene = randomScene(GetParam());
  Simulator one(scene.scenario);
  Simulator two(scene.scenario);
  const auto run = [](Simulator& simulator, int steps)
  {
    for (int step = 0; step < steps; ++step)
      simulator.step();
  };
  run(one, 100);
  run(two, 100);
  ASSERT_EQ(one.stateHash(), two.stateHash());
  const std::string file = testing::TempDir() + "random_bodies_" + std::to_string(GetParam()) + ".state";
  saveState(one, file);
  Simulator three(scene.scenario);
  loadState(three, file);
  run(one, 50);
  run(three, 50);
  EXPECT_EQ(one.stateHash(), three.stateHash());
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomBodiesTest, testing::Range(1, 21));

}  // namespace
}  // namespace frictional_contact_sim
