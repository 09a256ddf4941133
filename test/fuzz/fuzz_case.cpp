#include "fuzz_case.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "frictional_contact_sim/deformable/elastic_mesh.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/random_family.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/solver/registry.h"
#include "mutation.h"
#include "support/market_file.h"
#include "support/random_mesh.h"
#include "support/random_robot.h"
#include "support/random_scene.h"

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
namespace fs = std::filesystem;

constexpr int MOST_ITERATIONS = 50;  ///< of a solve

std::string readFile(const fs::path& path)
{
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

/** Every key there is, in block and flow style. */
const char* const SCENARIO = R"(time_step: 0.001
duration: 0.5
gravity: [0, 0, -9.81]
solver: {name: portfolio, tolerance: 1.0e-8, max_iterations: 200}
contact_law: gap
broad_phase: auto
failure:
  policy: hold
  fallback: true
  time_limit: 1
materials:
  default: {friction: 0.8, restitution: 0.1, tangential_restitution: 0.2}
  rubber: {friction: 1.2}
  pairs:
    - {between: [rubber, default], friction: 0.9, restitution: 0.2}
ground: {friction: 0.7, height: 0.0}
bodies:
  - name: robot
    urdf: robot.urdf
    base: floating
    pose: {xyz: [0, 0, 1], rpy: [0.1, 0, 0.2]}
    velocity: {linear: [0.1, 0, 0], angular: [0, 0, 1]}
    joints: {j1: {position: 0.1, velocity: 0.2}}
    commands:
      j1: {position: 0.2, kp: 10, kd: 1, max_effort: 5}
    hold_initial_position: true
    wrenches:
      - {link: l0, force: [1, 0, 0], torque: [0, 0, 0.1], point: [0, 0, 0], frame: world, from: 0, until: 0.2}
    material: rubber
    disable_collisions: [[l0, l1]]
    min_joint_inertia: 1.0e-6
  - {name: belt, urdf: belt.urdf, base: fixed, pose: {xyz: [3, 0, 0.2]}, motion: {linear: [0.1, 0, 0]}}
  - name: hair
    rod: {length: 0.2, radius: 0.002, pieces: 2, sections: 2, density: 1300, young_modulus: [1.0e7, 2.0e7],
          damping: 0.001, natural: [0, 1, 0]}
    pose: {xyz: [5, 0, 0.4]}
    motion: {type: sine, axis: [1, 0, 0], amplitude: 0.01, frequency: 2}
  - name: jelly
    elastic: {box: [0.1, 0.1], cells: [2, 2], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000, damping: 0.001,
              fixed: [bottom]}
    pose: {xyz: [6, 0, 0.2]}
)";

const char* const ROBOT =
    "<robot name='r'><link name='l0'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' "
    "ixz='0' iyz='0'/></inertial><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>"
    "<link name='l1'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>"
    "</inertial><collision><geometry><sphere radius='0.05'/></geometry></collision></link><joint name='j1' "
    "type='revolute'><parent link='l0'/><child link='l1'/><origin xyz='0.1 0 0'/><axis xyz='0 1 0'/><limit lower='-1' "
    "upper='1' effort='10' velocity='10'/></joint></robot>";

const char* const BELT =
    "<robot name='b'><link name='belt'><collision><geometry><box size='1 1 "
    "0.1'/></geometry></collision></link></robot>";

/** A robot near the ground. */
std::string simpleScenario(const std::string& urdf)
{
  return "time_step: 0.001\nground: {friction: 0.8}\nbodies:\n  - {name: robot, urdf: " + urdf +
         ", base: floating, pose: {xyz: [0, 0, 0.2]}}\n  - {name: other, urdf: belt.urdf, base: fixed}\n";
}

std::string meshUrdf(const std::string& mesh)
{
  return "<robot name='m'><link name='part'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' "
         "ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><mesh filename='" +
         mesh + "' scale='1 1 1'/></geometry></collision></link></robot>";
}

RandomMesh smallMesh(Dice& dice)
{
  return makeRandomMesh(static_cast<MeshKind>(dice.integer(0, static_cast<int>(MeshKind::KINDS) - 1)), 0.1, dice);
}

std::string asciiStl(const RandomMesh& mesh)
{
  std::string content = "solid mesh\n";
  for (const std::array<int, 3>& triangle : mesh.triangles)
  {
    content += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : triangle)
      content += "vertex " + text(mesh.vertices[static_cast<size_t>(corner)]) + "\n";
    content += "endloop\nendfacet\n";
  }
  return content + "endsolid mesh\n";
}

std::string fclibFile(Dice& dice, const fs::path& path)
{
  RandomFamilyOptions options;
  options.velocities = 6 * dice.integer(2, 5);
  options.contacts = dice.integer(1, 5);
  options.seed = static_cast<std::uint64_t>(dice.integer(0, 1000));
  writeFclib(path.string(), randomFamilyProblem(options), {"fuzz", "a valid problem", ""});
  return readFile(path);
}

/** A rectangle or a block above the ground. @param source of its `elastic` */
std::string elasticScenario(const std::string& source)
{
  return "time_step: 0.001\nground: {friction: 0.8}\nbodies:\n  - {name: jelly, elastic: {" + source +
         "}, pose: {xyz: [0, 0, 0.2]}}\n";
}

ElasticMesh smallElasticMesh(Dice& dice)
{
  return dice.chance(0.5) ? boxMesh({0.2, 0.1}, {dice.integer(1, 4), dice.integer(1, 3)})
                          : boxMesh({0.2, 0.1, 0.1}, {dice.integer(1, 2), 1, dice.integer(1, 2)});
}

std::string gmshFile(const ElasticMesh& mesh, Dice& dice)
{
  std::ostringstream file;
  const bool is_plane = mesh.dimension == 2;
  const int corners = mesh.dimension + 1;
  const int type = is_plane ? 2 : 4;
  const size_t count = mesh.nodes.size();
  const bool is_version_4 = dice.chance(0.5);
  const std::string group = "$PhysicalNames\n1\n" + std::to_string(mesh.dimension) + " 7 \"body\"\n$EndPhysicalNames\n";
  const auto place = [&](const Eigen::Vector3d& node)
  { return is_plane ? text(Eigen::Vector3d(node.x(), node.z(), 0.0)) : text(node); };
  file << "$MeshFormat\n" << (is_version_4 ? "4.1" : "2.2") << " 0 8\n$EndMeshFormat\n" << group << "$Nodes\n";
  if (is_version_4)
  {
    file << "1 " << count << " 1 " << count << "\n" << mesh.dimension << " 1 0 " << count << "\n";
    for (size_t k = 1; k <= count; ++k)
      file << k << "\n";
    for (const Eigen::Vector3d& node : mesh.nodes)
      file << place(node) << "\n";
  }
  else
  {
    file << count << "\n";
    for (size_t k = 0; k < count; ++k)
      file << k + 1 << " " << place(mesh.nodes[k]) << "\n";
  }
  file << "$EndNodes\n$Elements\n";
  if (is_version_4)
    file << "1 " << mesh.cells.size() << " 1 " << mesh.cells.size() << "\n" << mesh.dimension << " 1 " << type << " ";
  file << mesh.cells.size() << "\n";
  for (size_t k = 0; k < mesh.cells.size(); ++k)
  {
    file << k + 1;
    if (!is_version_4)
      file << " " << type << " 2 7 1";
    for (int corner = 0; corner < corners; ++corner)
      file << " " << mesh.cells[k][static_cast<size_t>(corner)] + 1;
    file << "\n";
  }
  file << "$EndElements\n";
  return file.str();
}

std::string nodeTable(const ElasticParts& parts)
{
  std::string table = "x,y,z,surface,fixed\n";
  for (size_t k = 0; k < parts.nodes.size(); ++k)
    table += text(parts.nodes[k], ",") + "," +
             std::to_string(std::count(parts.surface.begin(), parts.surface.end(), static_cast<int>(k))) + ",0\n";
  return table;
}

FuzzCase makeScene(std::uint32_t seed)
{
  const RandomScene scene = randomScene(seed);
  FuzzCase files;
  files.main = "scene.yaml";
  files.files[files.main] = scene.scenario;
  for (size_t k = 0; k < scene.urdfs.size(); ++k)
    files.files["seed_" + std::to_string(seed) + "_" + std::to_string(k) + ".urdf"] = scene.urdfs[k];
  return files;
}

std::string judgeMessage(const std::string& message, const FuzzCase& files)
{
  if (message.empty() || message.find('\n') != std::string::npos)
    return "the error is not one line: " + message;
  const bool names_one = std::any_of(files.files.begin(), files.files.end(),
                                     [&](const auto& file) { return message.find(file.first) != std::string::npos; });
  return names_one ? "" : "the error names no file: " + message;
}

std::string stepThrice(Scenario scenario)
{
  scenario.stopping.max_iterations = std::min(scenario.stopping.max_iterations, MOST_ITERATIONS);
  Simulator simulator(scenario);
  for (int step = 0; step < 3; ++step)
  {
    try
    {
      simulator.step();
    }
    catch (const std::exception& error)
    {
      return std::string("a step throws: ") + error.what();
    }
    for (int body = 0; body < simulator.bodyCount(); ++body)
      if (!simulator.position(body).allFinite() || !simulator.velocity(body).allFinite())
        return "a number of the state is not finite after step " + std::to_string(step);
  }
  return "";
}

std::string solveFclib(const std::string& path)
{
  const FclibProblem problem = readFclib(path);
  StoppingOptions stopping;
  stopping.max_iterations = MOST_ITERATIONS;
  const std::unique_ptr<Solver> solver = createSolver("portfolio");
  solver->setStopping(stopping);
  try
  {
    const SolverResult result =
        problem.kind == FclibKind::LOCAL ? solver->solve(problem.local) : solver->solve(problem.global);
    if (result.status == SolverStatus::CONVERGED && !result.solution.r.allFinite())
      return "converged to impulses that are not finite";
  }
  catch (const std::exception& error)
  {
    // The tool names the file; a solver knows none.
    return std::string(error.what()).find('\n') == std::string::npos ? "" : "a solve throws more than one line";
  }
  return "";
}
}  // namespace

const char* toString(FuzzInput input)
{
  static const char* const NAMES[] = {"urdf", "scenario", "obj", "stl", "fclib", "gmsh", "matrices"};
  return NAMES[static_cast<size_t>(input)];
}

FuzzCase makeFuzzCase(FuzzInput input, std::uint32_t seed, const std::string& scratch)
{
  Dice dice(0x9e3779b9u * (seed + 1) + static_cast<std::uint32_t>(input));
  FuzzCase files;
  std::string target = "robot.urdf";
  bool is_binary = false;
  files.main = "scene.yaml";
  files.files["belt.urdf"] = BELT;
  files.files["scene.yaml"] = simpleScenario("robot.urdf");
  switch (input)
  {
    case FuzzInput::URDF:
      files.files[target] = dice.chance(0.3) ? ROBOT : randomRobot(dice).xml;
      break;
    case FuzzInput::SCENARIO:
      if (dice.chance(0.5))
        files = makeScene(seed);
      else
        files.files = {{"scene.yaml", SCENARIO}, {"robot.urdf", ROBOT}, {"belt.urdf", BELT}};
      target = "scene.yaml";
      break;
    case FuzzInput::OBJ:
      target = "part.obj";
      writeObj({smallMesh(dice)}, scratch + "/valid.obj");
      files.files["robot.urdf"] = meshUrdf(target);
      files.files[target] = readFile(scratch + "/valid.obj");
      break;
    case FuzzInput::STL:
      target = "part.stl";
      files.files["robot.urdf"] = meshUrdf(target);
      is_binary = dice.chance(0.6);
      if (is_binary)
      {
        writeStl(smallMesh(dice), scratch + "/valid.stl");
        files.files[target] = readFile(scratch + "/valid.stl");
      }
      else
        files.files[target] = asciiStl(smallMesh(dice));
      break;
    case FuzzInput::FCLIB:
      target = files.main = "problem.hdf5";
      is_binary = true;
      files.files = {{target, fclibFile(dice, scratch + "/valid.hdf5")}};
      break;
    case FuzzInput::GMSH:
      target = "mesh.msh";
      files.files = {
          {"scene.yaml", elasticScenario("mesh: mesh.msh, young_modulus: 1e6, poisson_ratio: 0.3, density: 1000")},
          {target, gmshFile(smallElasticMesh(dice), dice)}};
      break;
    case FuzzInput::MATRICES:
    {
      ElasticMaterial material;
      material.young_modulus = 1e6;
      material.poisson_ratio = 0.3;
      material.density = 1000.0;
      const ElasticParts parts = assembleElastic(smallElasticMesh(dice), material);
      files.files = {{"scene.yaml", elasticScenario("mass: M.mtx, stiffness: K.mtx, nodes: nodes.csv")},
                     {"M.mtx", marketFile(parts.mass, true)},
                     {"K.mtx", marketFile(parts.stiffness, true)},
                     {"nodes.csv", nodeTable(parts)}};
      target = std::array<const char*, 3>{"M.mtx", "K.mtx", "nodes.csv"}[static_cast<size_t>(dice.integer(0, 2))];
      break;
    }
  }
  files.files[target] = mutate(files.files[target], is_binary, dice);
  return files;
}

std::string judgeFuzzCase(FuzzInput input, const FuzzCase& files, const std::string& folder)
{
  for (const auto& [name, content] : files.files)
    std::ofstream(fs::path(folder) / name, std::ios::binary) << content;
  const std::string main = (fs::path(folder) / files.main).string();
  try
  {
    return input == FuzzInput::FCLIB ? solveFclib(main) : stepThrice(loadScenarioFile(main));
  }
  catch (const std::exception& error)
  {
    return judgeMessage(error.what(), files);
  }
}

}  // namespace test_support
}  // namespace frictional_contact_sim
