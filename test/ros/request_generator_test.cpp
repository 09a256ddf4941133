// Random sequences of requests, valid and spoiled ones: what is refused changes no bit, what is taken never ends in a
// number that is not finite, in bodies within each other, or in energy from nowhere.
#include <cmath>
#include <functional>

#include "frictional_contact_sim/ros/reconfiguration.h"
#include "frictional_contact_sim/ros/setting_services.h"
#include "frictional_contact_sim/ros/state_services.h"
#include "frictional_contact_sim/ros/wrench_services.h"
#include "request_bench.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;

constexpr int REQUESTS = 120;
constexpr double DEEPEST = 1e-5;  // of bodies that were set apart: h^2 g, what run_audit.h allows in motion [m]
constexpr double BALANCE_SHARE = 1e-2;  // of the energy exchanged, as in run_audit.cpp: trees are of second order

const std::vector<std::string> NO_NAMES = {"", "nobody", "crate/", "/", "crat\ne", std::string(3000, 'x')};
const double NO_NUMBERS[] = {NOT_A_NUMBER, INFINITE, -INFINITE, 1e300};

class Generator
{
public:
  explicit Generator(std::uint32_t seed) : dice_(seed), bench_(robotAndBox(true)) {}

  void run()
  {
    for (int request = 0; request < REQUESTS && !testing::Test::HasFailure(); ++request)
    {
      const bool spoiled = dice_.chance(0.5);
      SCOPED_TRACE("request " + std::to_string(request) + (spoiled ? ", spoiled" : ""));
      const std::function<void()> call = make(spoiled);
      if (spoiled)
        bench_.expectRefused("", call);
      else
        ASSERT_NO_THROW(call());
      look();
      for (int steps = dice_.integer(0, 15); steps > 0; --steps)
      {
        ASSERT_TRUE(simulator().step().converged()) << simulator().outcome().message;
        look();
      }
    }
  }

private:
  Simulator& simulator() { return bench_.simulator; }
  const std::string& noName() { return NO_NAMES[dice_.integer(0, static_cast<int>(NO_NAMES.size()) - 1)]; }
  double noNumber() { return NO_NUMBERS[dice_.integer(0, 3)]; }

  void look()
  {
    for (int body = 0; body < simulator().bodyCount(); ++body)
      ASSERT_TRUE(simulator().position(body).allFinite() && simulator().velocity(body).allFinite());
    ASSERT_LE(simulator().report().max_penetration, DEEPEST);
    const EnergyLedger& energy = simulator().report().energy;
    const double exchanged = 1.0 + energy.kinetic + std::abs(energy.potential) + std::abs(energy.actuators) +
                             energy.friction + energy.impact + energy.joints;
    ASSERT_LE(std::abs(energy.balance_error), BALANCE_SHARE * exchanged);
  }

  std::function<void()> make(bool spoiled)
  {
    switch (dice_.integer(0, 7))
    {
      case 0:
        return wrench(spoiled);
      case 1:
        return topicWrench(spoiled);
      case 2:
        return linkState(spoiled);
      case 3:
        return joints(spoiled);
      case 4:
        return friction(spoiled);
      case 5:
        return solver(spoiled);
      case 6:
        return config(spoiled);
      default:
        return saved(spoiled);
    }
  }

  std::function<void()> wrench(bool spoiled)
  {
    ApplyWrench::Request request;
    const bool on_crate = dice_.chance(0.5);
    request.body = on_crate ? "crate" : "robot";
    request.link = on_crate ? "box" : dice_.chance(0.5) ? "arm" : "base";
    request.frame_id = dice_.chance(0.5) ? "" : "robot/arm";
    request.wrench.force.x = dice_.uniform(-20.0, 20.0);
    request.wrench.force.z = dice_.uniform(-20.0, 20.0);
    request.wrench.torque.y = dice_.uniform(-0.1, 0.1);
    request.point.x = dice_.uniform(-0.1, 0.1);
    request.duration = ros::Duration(dice_.uniform(0.002, 0.03));
    const std::function<void()> spoils[] = {
        [&] { request.body = "nobody"; },
        [&] { request.link = noName(); },
        [&] { request.frame_id = "nobody"; },
        [&] { request.point_frame_id = "nobody/base"; },
        [&] { request.wrench.force.y = noNumber(); },
        [&] { request.wrench.torque.x = noNumber(); },
        [&] { request.point.z = noNumber(); },
        [&] { request.duration = ros::Duration(-0.01); },
    };
    spoil(spoiled, spoils);
    return [this, request] { applyWrench(request, bench_.names, bench_.frames, simulator()); };
  }

  std::function<void()> topicWrench(bool spoiled)
  {
    geometry_msgs::WrenchStamped message;
    message.header.frame_id = "crate/box";
    message.wrench.force.x = dice_.chance(0.4) ? 0.0 : dice_.uniform(-5.0, 5.0);
    const std::function<void()> spoils[] = {[&] { message.header.frame_id = noName(); },
                                            [&] { message.wrench.force.z = noNumber(); }};
    spoil(spoiled, spoils);
    return [this, message] { takeWrench(message, bench_.names, simulator()); };
  }

  /** Above the ground, each body in a region of its own. */
  std::function<void()> linkState(bool spoiled)
  {
    SetLinkState::Request request;
    const bool is_crate = dice_.chance(0.5);
    request.body = is_crate ? "crate" : "robot";
    request.link = is_crate || dice_.chance(0.5) ? "" : "arm";
    request.pose.position.x = is_crate ? 2.0 : -2.0;
    request.pose.position.y = dice_.uniform(-0.5, 0.5);
    request.pose.position.z = dice_.uniform(0.5, 1.0);
    const double half_turn = dice_.uniform(-1.5, 1.5);
    request.pose.orientation.w = std::cos(half_turn);
    request.pose.orientation.y = std::sin(half_turn);
    request.twist.linear.y = dice_.uniform(-0.5, 0.5);
    request.twist.angular.x = dice_.uniform(-1.0, 1.0);
    const std::function<void()> spoils[] = {
        [&] { request.body = "nobody"; },
        [&] { request.link = "nobody"; },
        [&] { request.frame_id = "nobody"; },
        [&] { request.pose.position.x = noNumber(); },
        [&] { request.pose.orientation.x = noNumber(); },
        [&] { request.pose.orientation.w = request.pose.orientation.y = 0.0; },
        [&] { request.twist.angular.z = noNumber(); },
    };
    spoil(spoiled, spoils);
    return [this, request]
    {
      SetLinkState::Response response;
      placeLink(request, bench_.names, bench_.frames, simulator(), response);
    };
  }

  /** On a robot that has been lifted, so that no arm ends in the ground. */
  std::function<void()> joints(bool spoiled)
  {
    SetJointPositions::Request request;
    request.body = "robot";
    request.names = {"hinge"};
    request.positions = {dice_.uniform(-0.3, 0.3)};
    if (dice_.chance(0.5))
      request.velocities = {dice_.uniform(-1.0, 1.0)};
    const std::function<void()> spoils[] = {
        [&] { request.body = "nobody"; },          [&] { request.names = {noName()}; },
        [&] { request.positions = {noNumber()}; }, [&] { request.positions = {4.0}; },
        [&] { request.positions.clear(); },        [&] { request.velocities = {noNumber()}; },
    };
    spoil(spoiled, spoils);
    return [this, request, spoiled]
    {
      if (!spoiled)
        lift();
      SetJointPositions::Response response;
      setJointPositions(request, bench_.names, simulator(), response);
    };
  }

  void lift()
  {
    SetLinkState::Request request;
    request.body = "robot";
    request.pose.position.x = -2.0;
    request.pose.position.z = 0.5;
    request.pose.orientation.w = 1.0;
    SetLinkState::Response response;
    placeLink(request, bench_.names, bench_.frames, simulator(), response);
  }

  std::function<void()> friction(bool spoiled)
  {
    SetFriction::Request request;
    request.a = dice_.chance(0.5) ? "crate" : "robot/base";
    request.b = "ground";
    request.friction = dice_.uniform(0.1, 1.0);
    request.restitution = dice_.chance(0.5) ? NOT_A_NUMBER : dice_.uniform(0.0, 0.5);
    const std::function<void()> spoils[] = {
        [&] { request.a = noName(); },
        [&] { request.friction = -0.1; },
        [&] { request.friction = NOT_A_NUMBER; },
        [&] { request.restitution = 1.1; },
    };
    spoil(spoiled, spoils);
    return [this, request] { setFriction(request, simulator()); };
  }

  std::function<void()> solver(bool spoiled)
  {
    SetSolver::Request request;
    request.name = dice_.chance(0.5) ? "portfolio" : "gauss_seidel";
    request.tolerance = dice_.logUniform(1e-10, 1e-8);
    request.max_iterations = 2000;
    const std::function<void()> spoils[] = {[&] { request.name = "nobody"; }, [&] { request.tolerance = -1.0; },
                                            [&] { request.max_iterations = -1; }};
    spoil(spoiled, spoils);
    return [this, request] { setSolver(request, simulator()); };
  }

  std::function<void()> config(bool spoiled)
  {
    SimulatorConfig request = presentConfig(simulator(), 1.0);
    request.gravity_x = dice_.uniform(-0.5, 0.5);
    request.gravity_z = dice_.uniform(-10.0, -9.0);
    request.time_step = dice_.uniform(0.0005, 0.001);
    request.default_friction = dice_.uniform(0.3, 1.0);
    const std::function<void()> spoils[] = {
        [&] { request.gravity_y = NOT_A_NUMBER; }, [&] { request.time_step = 0.0; },
        [&] { request.tolerance = NOT_A_NUMBER; }, [&] { request.solver = "nobody"; },
        [&] { request.default_friction = -1.0; },  [&] { request.real_time_factor = -1.0; },
    };
    spoil(spoiled, spoils);
    return [this, request] { applyConfig(request, simulator()); };
  }

  std::function<void()> saved(bool spoiled)
  {
    LoadState::Request request;
    if (spoiled)
      request.file = "/no/such/file";
    return [this, request]
    {
      if (request.file.empty() && (!slot_ || dice_.chance(0.5)))
      {
        SaveState::Response response;
        storeState(SaveState::Request(), simulator(), slot_, response);
      }
      const double now = simulator().time();
      LoadState::Response response;
      restoreState(request, slot_, simulator(), response);
      EXPECT_GE(simulator().time(), now);
    };
  }

  template <size_t N>
  void spoil(bool spoiled, const std::function<void()> (&spoils)[N])
  {
    if (spoiled)
      spoils[dice_.integer(0, static_cast<int>(N) - 1)]();
  }

  Dice dice_;
  RequestBench bench_;
  StateSlot slot_;
};

class RequestGeneratorTest : public testing::TestWithParam<int>
{
};

TEST_P(RequestGeneratorTest, RefusalsChangeNoBitAndWhatIsTakenIsPhysics)
{
  Generator(static_cast<std::uint32_t>(GetParam())).run();
}

INSTANTIATE_TEST_SUITE_P(Seeds, RequestGeneratorTest, testing::Range(1, 13));

}  // namespace
}  // namespace frictional_contact_sim
