// state_hashes FILE.yaml [STEPS [SECONDS]], state_hashes FILE.urdf --limp|--held [STEPS [SECONDS]]
// One run as numbers that two builds of the package can be compared by (scripts/compare_builds): a line
// `STEP HASH MOTION FAILED` after steps 1, 2, 5, 10, 20, every 50th and the last, then `done`, `slow` (SECONDS of
// processor time are over; the lines before stand) or `error: ...`. Public API only, and as little of it as possible,
// so that the same file compiles in old and new commits. HASH is FNV-1a over the fields of Simulator::stateHash()
// without the time, MOTION over q and v alone; both run on from step to step, so that no step between two lines goes
// unseen.
#include <sys/time.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr long EARLY[] = {1, 2, 5, 10, 20};  ///< and every 50th step: printed

class Hash
{
public:
  void add(double value)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(std::uint64_t bits)
  {
    for (int byte = 0; byte < 8; ++byte)
      state_ = (state_ ^ ((bits >> (8 * byte)) & 0xffU)) * 1099511628211ULL;
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& vector)
  {
    for (Eigen::Index i = 0; i < vector.size(); ++i)
      add(static_cast<double>(vector[i]));
  }
  unsigned long long value() const { return state_; }

private:
  std::uint64_t state_ = 14695981039346656037ULL;
};

void addMotion(const fcs::Simulator& simulator, Hash& hash)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    hash.add(simulator.position(body));
    hash.add(simulator.velocity(body));
  }
}

/** Contact ids as the four 16-bit numbers of commits up to d6f7087, where they fit: shapes, features, kind in the two
 * high bits. */
template <class Id>
std::uint64_t idNumber(const Id& id)
{
  if constexpr (std::is_integral_v<Id>)
  {
    return id;
  }
  else
  {
    const auto narrow = [](std::uint64_t feature) { return ((feature >> 30) << 14) | (feature & 0x3fffU); };
    return ((id.shapes >> 32) << 48) | ((id.shapes & 0xffffU) << 32) | (narrow(id.features >> 32) << 16) |
           narrow(id.features & 0xffffffffU);
  }
}

/** The order of the state hash at d0e72fa. */
void addAll(const fcs::Simulator& simulator, Hash& hash)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    hash.add(simulator.position(body));
    hash.add(simulator.velocity(body));
    for (size_t joint = 0; joint < simulator.model(body).joints.size(); ++joint)
      hash.add(simulator.effort(body, static_cast<int>(joint)));
  }
  for (const auto& contact : simulator.contacts())
  {
    hash.add(idNumber(contact.id));
    hash.add(static_cast<std::uint64_t>(contact.mode));
    for (const Eigen::Vector3d* vector : {&contact.position, &contact.normal, &contact.impulse, &contact.velocity})
      hash.add(*vector);
    hash.add(contact.gap);
    hash.add(contact.residual);
  }
  const auto& report = simulator.report();
  hash.add(static_cast<std::uint64_t>(report.step));
  hash.add(static_cast<std::uint64_t>(report.iterations));
  hash.add(static_cast<std::uint64_t>(report.status));
  const auto& energy = report.energy;
  for (const double value :
       {report.residual, report.max_penetration, report.bilateral_violation, energy.kinetic, energy.potential,
        energy.actuators, energy.friction, energy.impact, energy.joints, energy.balance_error})
    hash.add(value);
}

fcs::Scenario onTheGround(const std::string& urdf, bool held)
{
  fcs::Scenario scenario;
  scenario.ground.emplace();
  scenario.bodies.emplace_back();
  scenario.bodies.back().name = "robot";
  scenario.bodies.back().urdf_path = urdf;
  scenario.bodies.back().hold_initial_position = held;
  return scenario;
}

void run(const fcs::Scenario& scenario, long steps)
{
  fcs::Simulator simulator(scenario);
  Hash all;
  Hash motion;
  long failed = 0;
  for (long step = 1; step <= steps; ++step)
  {
    simulator.step();
    failed += simulator.report().status != fcs::SolverStatus::CONVERGED ? 1 : 0;
    addAll(simulator, all);
    addMotion(simulator, motion);
    if (step % 50 == 0 || step == steps || std::count(std::begin(EARLY), std::end(EARLY), step) > 0)
    {
      std::printf("%ld %016llx %016llx %ld\n", step, all.value(), motion.value(), failed);
      std::fflush(stdout);
    }
  }
}

/** A step that does not return is cut off as well. */
void stopSlowRun(int /*signal*/)
{
  const ssize_t written = write(STDOUT_FILENO, "slow\n", 5);
  _exit(written == 5 ? 0 : 1);
}

/** Processor time, not wall clock: a busy machine compares as many steps. */
void limitTime(unsigned long seconds)
{
  std::signal(SIGPROF, stopSlowRun);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  setitimer(ITIMER_PROF, &timer, nullptr);
}
}  // namespace

int main(int argc, char** argv)
{
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto option = std::find_if(arguments.begin(), arguments.end(),
                                   [](const std::string& text) { return text == "--limp" || text == "--held"; });
  const bool robot = option != arguments.end();
  const bool held = robot && *option == "--held";
  if (robot)
    arguments.erase(option);
  if (arguments.empty() || arguments.size() > 3)
  {
    std::fputs("usage: state_hashes FILE.yaml | FILE.urdf --limp|--held [STEPS [SECONDS]]\n", stderr);
    return 2;
  }
  try
  {
    const long steps = arguments.size() > 1 ? std::stol(arguments[1]) : 500;
    limitTime(arguments.size() > 2 ? std::stoul(arguments[2]) : 60);
    run(robot ? onTheGround(arguments[0], held) : fcs::loadScenarioFile(arguments[0]), steps);
    limitTime(0);
    std::puts("done");
  }
  catch (const std::exception& error)
  {
    std::printf("error: %s\n", error.what());
  }
  return 0;
}
