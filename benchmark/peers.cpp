// The same robot in the same state, held by the same servos, in other simulators: steps per second side by side, and
// how far each is from rest. Peers smooth friction and stop early; their steps are not solved to our residual.
#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr double SETTLING_TIME = 1.0;  ///< [s] of simulated time before anything is measured

fcs::Simulator makeOurs()
{
  return fcs::Simulator(fcs::loadScenarioFile(PROJECT_DIR "/config/scenarios/quadruped.yaml"));
}

void ours(benchmark::State& state)
{
  fcs::Simulator simulator = makeOurs();
  while (simulator.time() < SETTLING_TIME)
    simulator.step();
  for (auto _ : state)
    simulator.step();
  state.counters["steps_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["speed_at_rest"] = simulator.velocity(0).norm();
  state.counters["contacts"] = simulator.report().contacts;
}

/** MuJoCo reads URDF: a floating joint to a world link that carries a box as ground makes it the same scene. */
std::string mujocoUrdf()
{
  std::ifstream file(PROJECT_DIR "/urdf/quadruped.urdf");
  std::ostringstream text;
  text << file.rdbuf();
  std::string urdf = text.str();
  const std::string head = "<robot name=\"quadruped\">";
  const size_t at = urdf.find(head);
  if (at == std::string::npos)
    throw std::runtime_error("urdf/quadruped.urdf does not begin with " + head);
  urdf.insert(
      at + head.size(),
      "<link name='world'><collision><origin xyz='0 0 -0.5'/><geometry><box size='20 20 1'/></geometry>"
      "</collision></link><joint name='root' type='floating'><parent link='world'/><child link='base'/></joint>");
  return urdf;
}

struct MujocoScene
{
  MujocoScene()
  {
    const std::string path = "/tmp/frictional_contact_sim_mujoco.urdf";
    std::ofstream(path) << mujocoUrdf();
    char error[1000] = "";
    model = mj_loadXML(path.c_str(), nullptr, error, sizeof error);
    if (model == nullptr)
      throw std::runtime_error(error);
    model->opt.timestep = 1e-3;
    data = mj_makeData(model);
    copyState();
  }
  ~MujocoScene()
  {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  MujocoScene(const MujocoScene&) = delete;
  MujocoScene& operator=(const MujocoScene&) = delete;

  /** Our initial state and servos: springs and dampers of the joints. */
  void copyState()
  {
    const fcs::Simulator simulator = makeOurs();
    const fcs::MultibodyModel& robot = simulator.model(0);
    for (int i = 0; i < 3; ++i)
      data->qpos[i] = simulator.position(0)[i];
    data->qpos[3] = simulator.position(0)[6];
    for (int i = 0; i < 3; ++i)
      data->qpos[4 + i] = simulator.position(0)[3 + i];
    for (size_t j = 1; j < robot.joints.size(); ++j)
    {
      const int id = mj_name2id(model, mjOBJ_JOINT, robot.joints[j].name.c_str());
      if (id < 0)
        throw std::runtime_error("MuJoCo has no joint " + robot.joints[j].name);
      const fcs::JointCommand& command = simulator.command(0, static_cast<int>(j));
      const int address = model->jnt_qposadr[id];
      data->qpos[address] = command.target;
      model->qpos_spring[address] = command.target;
      model->jnt_stiffness[id] = command.kp;
      model->dof_damping[model->jnt_dofadr[id]] = command.kd + robot.joints[j].damping;
    }
  }

  mjModel* model = nullptr;
  mjData* data = nullptr;
};

void mujoco(benchmark::State& state)
{
  MujocoScene scene;
  while (scene.data->time < SETTLING_TIME)
    mj_step(scene.model, scene.data);
  for (auto _ : state)
    mj_step(scene.model, scene.data);
  state.counters["steps_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  double square = 0.0;
  for (int i = 0; i < scene.model->nv; ++i)
    square += scene.data->qvel[i] * scene.data->qvel[i];
  state.counters["speed_at_rest"] = std::sqrt(square);
  state.counters["contacts"] = scene.data->ncon;
}

BENCHMARK(ours);
BENCHMARK(mujoco);
}  // namespace

BENCHMARK_MAIN();
