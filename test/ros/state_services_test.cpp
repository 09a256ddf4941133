// Services that save, set and tell the state; FCLib files and information.
#include "frictional_contact_sim/ros/state_services.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/ros/setting_services.h"
#include "frictional_contact_sim/solver/registry.h"
#include "request_bench.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double ROUND_OFF = 1e-12;

class StateServiceTest : public testing::Test
{
protected:
  StateServiceTest()
    : bench_(robotAndBox(true))
    , folder_((std::filesystem::temp_directory_path() / ("state_services_" + std::to_string(getpid()))).string())
  {
    std::filesystem::create_directories(folder_);
  }
  ~StateServiceTest() override { std::filesystem::remove_all(folder_); }

  void save(const std::string& file)
  {
    SaveState::Request request;
    request.file = file;
    SaveState::Response response;
    storeState(request, bench_.simulator, slot_, response);
    EXPECT_NEAR(response.stamp.toSec(), bench_.simulator.time(), 1e-9);
  }
  double load(const std::string& file, Simulator& simulator)
  {
    LoadState::Request request;
    request.file = file;
    LoadState::Response response;
    restoreState(request, slot_, simulator, response);
    return response.stamp.toSec();
  }
  GetLinkState::Response linkState(const std::string& body, const std::string& link, const std::string& frame)
  {
    GetLinkState::Request request;
    request.body = body;
    request.link = link;
    request.frame_id = frame;
    GetLinkState::Response response;
    readLinkState(request, bench_.names, bench_.frames, bench_.simulator, response);
    return response;
  }
  void place(const SetLinkState::Request& request)
  {
    placeLink(request, bench_.names, bench_.frames, bench_.simulator, set_link_);
  }
  void setJoints(const SetJointPositions::Request& request)
  {
    setJointPositions(request, bench_.names, bench_.simulator, set_joints_);
  }

  RequestBench bench_;
  std::string folder_;
  StateSlot slot_;
  SetLinkState::Response set_link_;
  SetJointPositions::Response set_joints_;
};

SetLinkState::Request armAt(double x, double y, double z)
{
  SetLinkState::Request request;
  request.body = "robot";
  request.link = "arm";
  request.pose.position.x = x;
  request.pose.position.y = y;
  request.pose.position.z = z;
  request.pose.orientation.w = 1.0;
  return request;
}

SetJointPositions::Request hingeAt(double position)
{
  SetJointPositions::Request request;
  request.body = "robot";
  request.names = {"hinge"};
  request.positions = {position};
  return request;
}

TEST_F(StateServiceTest, SavedInMemoryGoesOnToTheBitAndTimeGoesOn)
{
  bench_.simulator.velocity(CRATE)[0] = 0.5;
  bench_.simulator.stateChanged();
  bench_.run(50);
  save("");
  bench_.run(50);
  const Eigen::VectorXd q = bench_.simulator.position(CRATE);
  const EnergyLedger energy = bench_.simulator.report().energy;
  EXPECT_NEAR(load("", bench_.simulator), 0.050, 1e-12);
  EXPECT_NEAR(bench_.simulator.time(), 0.100, 1e-12);
  EXPECT_EQ(bench_.simulator.state().step, 100U);
  EXPECT_NE(bench_.simulator.position(CRATE), q);
  bench_.run(50);
  EXPECT_EQ(bench_.simulator.position(CRATE), q);
  EXPECT_EQ(bench_.simulator.report().energy.friction, energy.friction);
  EXPECT_NEAR(bench_.simulator.time(), 0.150, 1e-12);
}

TEST_F(StateServiceTest, AnotherProcessGoesOnFromTheFileWithTimeAndStep)
{
  const std::string file = folder_ + "/state";
  bench_.run(30);
  save(file);
  bench_.run(30);
  Simulator fresh(robotAndBox(true));
  EXPECT_NEAR(load(file, fresh), 0.030, 1e-12);
  for (int i = 0; i < 30; ++i)
    fresh.step();
  EXPECT_EQ(fresh.stateHash(), bench_.simulator.stateHash());
}

TEST_F(StateServiceTest, ALoadThatIsRefusedChangesNothing)
{
  bench_.run(10);
  bench_.expectRefused("nothing was saved", [&] { load("", bench_.simulator); });
  bench_.expectRefused("cannot be read", [&] { load(folder_ + "/none", bench_.simulator); });
  Scenario other = robotAndBox(true);
  other.bodies.pop_back();
  RequestBench other_bench(other);
  SaveState::Request request;
  request.file = folder_ + "/other";
  SaveState::Response response;
  storeState(request, other_bench.simulator, slot_, response);
  bench_.expectRefused("number of bodies is 1, expected 2", [&] { load(request.file, bench_.simulator); });
  bench_.expectRefused("cannot be written", [&] { save(folder_ + "/no/such/folder/state"); });
  for (const char* device : {"/dev/zero", "/dev/null"})
  {
    bench_.expectRefused("is not a regular file", [&] { load(device, bench_.simulator); });
    bench_.expectRefused("is not a regular file", [&] { save(device); });
  }
  bench_.expectRefused("is not a regular file", [&] { save(folder_); });
}

TEST_F(StateServiceTest, ALinkOfATreeGetsPoseAndVelocityAndJointsStay)
{
  bench_.simulator.position(ROBOT)[7] = 0.7;
  bench_.simulator.velocity(ROBOT)[6] = 1.5;
  bench_.simulator.stateChanged();
  SetLinkState::Request request = armAt(-1.0, 0.5, 2.0);
  request.pose.orientation.w = std::cos(0.4);
  request.pose.orientation.x = std::sin(0.4);
  request.twist.linear.x = 0.3;
  request.twist.angular.z = -0.2;
  place(request);
  EXPECT_EQ(set_link_.message, "");
  EXPECT_EQ(bench_.simulator.position(ROBOT)[7], 0.7);
  EXPECT_NEAR(bench_.simulator.velocity(ROBOT)[6], 1.5, ROUND_OFF);
  const GetLinkState::Response arm = linkState("robot", "arm", "");
  EXPECT_EQ(arm.header.frame_id, "world");
  EXPECT_NEAR(arm.pose.position.x, -1.0, ROUND_OFF);
  EXPECT_NEAR(arm.pose.position.y, 0.5, ROUND_OFF);
  EXPECT_NEAR(arm.pose.position.z, 2.0, ROUND_OFF);
  EXPECT_NEAR(arm.pose.orientation.x, std::sin(0.4), ROUND_OFF);
  EXPECT_NEAR(arm.twist.linear.x, 0.3, ROUND_OFF);
  EXPECT_NEAR(arm.twist.linear.y, 0.0, ROUND_OFF);
  EXPECT_NEAR(arm.twist.linear.z, 0.0, ROUND_OFF);
  EXPECT_NEAR(arm.twist.angular.x, 0.0, ROUND_OFF);
  EXPECT_NEAR(arm.twist.angular.y, 0.0, ROUND_OFF);
  EXPECT_NEAR(arm.twist.angular.z, -0.2, ROUND_OFF);
}

TEST_F(StateServiceTest, StatesInTheFrameOfAnotherLinkComeBackAsTheyWereSet)
{
  bench_.simulator.position(CRATE).tail<4>() =
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ())).coeffs();
  bench_.simulator.stateChanged();
  SetLinkState::Request request = armAt(0.0, 1.0, 3.0);
  request.frame_id = "crate/box";
  request.twist.linear.x = 0.25;
  place(request);
  const GetLinkState::Response seen = linkState("robot", "arm", "box");
  EXPECT_NEAR(seen.pose.position.y, 1.0, ROUND_OFF);
  EXPECT_NEAR(seen.twist.linear.x, 0.25, ROUND_OFF);
  const GetLinkState::Response in_world = linkState("robot", "arm", "world");
  EXPECT_NEAR(in_world.pose.position.x, 2.0 - 1.0, ROUND_OFF);
  EXPECT_NEAR(in_world.pose.position.z, 0.1 + 3.0, ROUND_OFF);
  EXPECT_NEAR(in_world.twist.linear.y, 0.25, ROUND_OFF);
}

TEST_F(StateServiceTest, APlacedBodyHitsWhatItTouches)
{
  SetLinkState::Request request;
  request.body = "crate";
  request.pose.position.z = 0.1;
  request.pose.position.x = 4.0;
  request.pose.orientation.w = 1.0;
  request.twist.linear.z = -2.0;
  place(request);
  EXPECT_NEAR(linkState("crate", "", "").twist.linear.z, 0.0, 1e-7);  // the impact, without restitution
  request.pose.position.z = 0.08;
  place(request);
  EXPECT_THAT(set_link_.message, testing::HasSubstr("overlap by 0.02"));
}

TEST_F(StateServiceTest, JointsAreSetWithoutForces)
{
  bench_.run(20);
  const Eigen::VectorXd base = bench_.simulator.position(ROBOT).head<7>();
  SetJointPositions::Request request = hingeAt(-0.5);
  request.velocities = {0.25};
  setJoints(request);
  EXPECT_EQ(bench_.simulator.position(ROBOT)[7], -0.5);
  EXPECT_EQ(bench_.simulator.position(ROBOT).head<7>(), base);
  setJoints(hingeAt(0.5));
  EXPECT_EQ(bench_.simulator.position(ROBOT)[7], 0.5);
  EXPECT_NEAR(bench_.simulator.velocity(ROBOT)[6], 0.0, 1e-6);  // up to the impact that the base may take
}

TEST(MimicServiceTest, FollowersFollow)
{
  Scenario scenario;
  scenario.bodies = {bodyFrom("gripper", "urdf/gripper_mimic.urdf", 0.0, 0.0, 1.0)};
  scenario.bodies.front().base = BaseType::FIXED;
  RequestBench bench(scenario);
  const auto mimic = std::find_if(bench.names.joints.begin(), bench.names.joints.end(),
                                  [](const JointHandle& joint) { return joint.mimic; });
  ASSERT_NE(mimic, bench.names.joints.end());
  const Joint& joint = bench.simulator.model(0).joints[mimic->joint];
  const Joint& leader = bench.simulator.model(0).joints[joint.mimic.joint];
  SetJointPositions::Request request;
  request.names = {leader.name};
  request.positions = {0.5 * (leader.limit.lower + leader.limit.upper)};
  SetJointPositions::Response response;
  setJointPositions(request, bench.names, bench.simulator, response);
  EXPECT_NEAR(bench.simulator.position(0)[joint.q_index],
              joint.mimic.multiplier * request.positions[0] + joint.mimic.offset, ROUND_OFF);
  request.names = {joint.name};
  bench.expectRefused("mimics another one",
                      [&] { setJointPositions(request, bench.names, bench.simulator, response); });
  SetLinkState::Request move;
  move.pose.orientation.w = 1.0;
  SetLinkState::Response moved;
  bench.expectRefused("has a fixed base", [&] { placeLink(move, bench.names, bench.frames, bench.simulator, moved); });
}

TEST_F(StateServiceTest, RefusalsOfSetLinkStateNameTheFieldAndChangeNothing)
{
  bench_.run(20);
  const std::pair<const char*, std::function<void(SetLinkState::Request&)>> changes[] = {
      {"body: found ''", [](auto& r) { r.body = r.link = ""; }},
      {"link: found 'arn', did you mean 'arm'", [](auto& r) { r.link = "arn"; }},
      {"frame_id: found 'map'", [](auto& r) { r.frame_id = "map"; }},
      {"pose.position.x: found nan", [](auto& r) { r.pose.position.x = NOT_A_NUMBER; }},
      {"pose.position.z: found 1e+300", [](auto& r) { r.pose.position.z = 1e300; }},
      {"pose.orientation: found a quaternion of length 0", [](auto& r) { r.pose.orientation.w = 0.0; }},
      {"pose.orientation: found a quaternion of length nan", [](auto& r) { r.pose.orientation.y = NOT_A_NUMBER; }},
      {"twist.linear.y: found inf", [](auto& r) { r.twist.linear.y = INFINITE; }},
      {"twist.angular.z: found 1e+200", [](auto& r) { r.twist.angular.z = 1e200; }},
  };
  for (const auto& [reason, change] : changes)
  {
    SetLinkState::Request request = armAt(0.0, 0.0, 1.0);
    change(request);
    bench_.expectRefused(reason, [&] { place(request); });
  }
}

TEST_F(StateServiceTest, RefusalsOfSetJointPositionsNameTheFieldAndChangeNothing)
{
  bench_.run(20);
  const std::pair<const char*, std::function<void(SetJointPositions::Request&)>> changes[] = {
      {"body: found 'robt', did you mean 'robot'", [](auto& r) { r.body = "robt"; }},
      {"names: found 'hing', did you mean 'hinge'", [](auto& r) { r.names = {"hing"}; }},
      {"names: found none", [](auto& r) { r.names.clear(); }},
      {"positions: found 2 numbers, expected 1", [](auto& r) { r.positions.push_back(0.0); }},
      {"velocities: found 2 numbers",
       [](auto& r) {
         r.velocities = {0.0, 0.0};
       }},
      {"is there twice",
       [](auto& r) {
         r.names = {"hinge", "hinge"}, r.positions = {0.0, 1.0};
       }},
      {"found nan", [](auto& r) { r.positions = {NOT_A_NUMBER}; }},
      {"found inf", [](auto& r) { r.velocities = {INFINITE}; }},
      {"within its limits -3.1 to 3.1", [](auto& r) { r.positions = {3.2}; }},
  };
  for (const auto& [reason, change] : changes)
  {
    SetJointPositions::Request request = hingeAt(0.1);
    change(request);
    bench_.expectRefused(reason, [&] { setJoints(request); });
  }
}

TEST_F(StateServiceTest, DumpedProblemsHoldTheForcesOfTheStep)
{
  const double weight = (10.0 + 2.5) * 9.81 * DT;  // as an impulse [N s]
  const double hinge = 0.02 * DT;  // its dry friction is a row too: r_N is the threshold there (problem/fclib.h)
  DumpFclib::Request request;
  DumpFclib::Response response;
  const auto dump = [&] { dumpFclib(request, bench_.simulator, folder_, response); };
  bench_.run(1);
  bench_.simulator.position(CRATE)[2] = 1.0;
  bench_.simulator.position(ROBOT)[2] = 1.0;
  bench_.simulator.stateChanged();
  bench_.expectRefused("no step since", dump);
  bench_.simulator.reset();
  bench_.run(50);
  for (const bool local : {false, true})
  {
    request.local = local;
    dump();
    const FclibProblem file = readFclib(response.file);
    EXPECT_EQ(file.kind, local ? FclibKind::LOCAL : FclibKind::GLOBAL);
    ASSERT_TRUE(file.solution);
    double normal = 0.0;
    for (int contact = 0; contact < file.contacts; ++contact)
      normal += file.solution->r[3 * contact];
    EXPECT_NEAR(normal, weight + hinge, 1e-6 * weight);
    bench_.expectRefused("expected one that does not exist",
                         [&]
                         {
                           DumpFclib::Request again;
                           again.file = response.file;
                           DumpFclib::Response ignored;
                           dumpFclib(again, bench_.simulator, folder_, ignored);
                         });
  }
  bench_.expectRefused("~dump_dir is not set", [&] { dumpFclib(request, bench_.simulator, "", response); });
  request.file = folder_ + "/no/such/folder.hdf5";
  bench_.expectRefused("folder.hdf5", dump);
}

TEST_F(StateServiceTest, SolverToleranceAndIterationsAreSetTogetherOrNotAtAll)
{
  SetSolver::Request request;
  request.name = "gauss_seidel";
  request.tolerance = 1e-10;
  request.max_iterations = 5000;
  setSolver(request, bench_.simulator);
  bench_.run(10);
  EXPECT_EQ(bench_.simulator.report().solver, "gauss_seidel");
  EXPECT_LE(bench_.simulator.report().residual, 1e-10);
  EXPECT_EQ(bench_.simulator.scenario().stopping.max_iterations, 5000);
  SetSolver::Request left;
  left.tolerance = NOT_A_NUMBER;
  setSolver(left, bench_.simulator);
  EXPECT_EQ(bench_.simulator.scenario().solver, "gauss_seidel");
  EXPECT_EQ(bench_.simulator.scenario().stopping.tolerance, 1e-10);
  for (const SolverEntry& entry : solverRegistry())
    bench_.expectRefused(entry.name,
                         [&]
                         {
                           SetSolver::Request unknown;
                           unknown.name = "gaus";
                           unknown.tolerance = 1e-3;
                           setSolver(unknown, bench_.simulator);
                         });
  const auto refuse = [&](const std::string& reason, double tolerance, int iterations)
  {
    bench_.expectRefused(reason,
                         [&]
                         {
                           SetSolver::Request bad;
                           bad.name = "portfolio";
                           bad.tolerance = tolerance;
                           bad.max_iterations = iterations;
                           setSolver(bad, bench_.simulator);
                         });
  };
  refuse("tolerance", -1e-8, 0);
  refuse("tolerance", INFINITE, 0);
  refuse("max_iterations", 1e-8, -1);
  EXPECT_EQ(bench_.simulator.scenario().solver, "gauss_seidel");
  EXPECT_EQ(bench_.simulator.scenario().stopping.tolerance, 1e-10);
}

TEST_F(StateServiceTest, InfoNamesWhatThereIs)
{
  bench_.run(3);
  GetInfo::Response info;
  fillInfo(bench_.simulator, bench_.names, info);
  EXPECT_EQ(info.scenario, "robot_and_box");
  EXPECT_EQ(info.steps, 3U);
  EXPECT_NEAR(info.simulated_time, 0.003, ROUND_OFF);
  EXPECT_THAT(info.bodies, testing::ElementsAre("robot", "crate"));
  EXPECT_THAT(info.masses, testing::ElementsAre(2.5, 10.0));
  EXPECT_THAT(info.joints, testing::ElementsAre("hinge"));
  EXPECT_THAT(info.actuated_joints, testing::ElementsAre("hinge"));
  EXPECT_THAT(info.links, testing::ElementsAre("robot/base", "robot/arm", "crate/box"));
  EXPECT_THAT(info.solvers, testing::Contains("portfolio"));
  EXPECT_EQ(info.solvers.size(), solverRegistry().size());
}

}  // namespace
}  // namespace frictional_contact_sim
