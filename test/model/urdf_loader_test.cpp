#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/urdf_loader.h"
#include "model/urdf_text.h"

namespace frictional_contact_sim
{
namespace
{
const std::string BODY = inertial(1.0, "0.1 0.1 0.1");

std::string collision(const std::string& content)
{
  return "<collision>" + content + "</collision>";
}

std::string shape(const std::string& text)
{
  return collision("<geometry>" + text + "</geometry>");
}

/** A folder with a package, on ROS_PACKAGE_PATH as long as this lives. */
class TemporaryPackage
{
public:
  TemporaryPackage() : folder_(std::filesystem::temp_directory_path() / ("fcs_model_" + std::to_string(::getpid())))
  {
    std::filesystem::create_directories(folder_ / "shapes" / "meshes");
    std::ofstream(folder_ / "shapes" / "package.xml")
        << "<package><name>shapes</name><version>0.0.1</version><description>d</description>"
           "<maintainer email='a@b.c'>m</maintainer><license>l</license></package>";
    std::ofstream(mesh()) << "solid empty\nendsolid empty\n";
    const char* path = std::getenv("ROS_PACKAGE_PATH");
    before_ = path == nullptr ? "" : path;
    had_path_ = path != nullptr;
    ::setenv("ROS_PACKAGE_PATH", folder_.c_str(), 1);
  }
  ~TemporaryPackage()
  {
    had_path_ ? ::setenv("ROS_PACKAGE_PATH", before_.c_str(), 1) : ::unsetenv("ROS_PACKAGE_PATH");
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  TemporaryPackage(const TemporaryPackage&) = delete;
  TemporaryPackage& operator=(const TemporaryPackage&) = delete;

  std::string folder() const { return folder_.string(); }
  std::string mesh() const { return (folder_ / "shapes" / "meshes" / "m.stl").string(); }

private:
  std::filesystem::path folder_;
  std::string before_;
  bool had_path_ = false;
};
}  // namespace

TEST(BaseTest, AutoFixesALinkNamedWorldAndFloatsAnyOther)
{
  const std::string arm = robot(link("world", "") + link("arm", BODY) + joint("j", "continuous", "world", "arm"));
  const MultibodyModel fixed = loadUrdf(arm, "arm", BaseType::AUTO).model;
  EXPECT_EQ(fixed.joints[0].type, JointType::FIXED);
  EXPECT_EQ(fixed.nv, 1);
  const MultibodyModel floating = loadUrdf(robot(link("base", BODY)), "base", BaseType::AUTO).model;
  EXPECT_EQ(floating.joints[0].type, JointType::FLOATING);
  EXPECT_EQ(floating.nq, 7);
  EXPECT_TRUE(floating.joints[0].name.empty());
}

TEST(BaseTest, WorldWeldedToTheRobotFloatsWhenAsked)
{
  const std::string text = robot(link("world", "") + link("base", BODY) + joint("j", "fixed", "world", "base"));
  const MultibodyModel model = loadUrdf(text, "robot", BaseType::FLOATING).model;
  EXPECT_EQ(model.nv, 6);
  EXPECT_EQ(model.totalMass(), 1.0);
}

TEST(BaseTest, FloatingJointBelowWorldIsAFreeBodyOnAFixedBase)
{
  const std::string text = robot(link("world", "") + link("base", BODY) + joint("free", "floating", "world", "base"));
  const MultibodyModel model = loadUrdf(text, "robot", BaseType::AUTO).model;
  EXPECT_EQ(model.joints[0].type, JointType::FIXED);
  EXPECT_EQ(model.joints[1].type, JointType::FLOATING);
  EXPECT_EQ(model.nq, 7);
  EXPECT_EQ(model.nv, 6);
  // a massless world floats on its own, it gets an inertia
  EXPECT_THAT(loadUrdf(text, "robot", BaseType::FLOATING).warnings,
              testing::ElementsAre(testing::HasSubstr("floating base 'world'")));
}

TEST(BaseTest, FixedBaseNeedsNoInertia)
{
  const std::string text = robot(link("base", "") + link("arm", BODY) + joint("j", "continuous", "base", "arm"));
  EXPECT_THAT(loadUrdf(text, "arm", BaseType::FIXED).warnings, testing::IsEmpty());
  EXPECT_THAT(loadUrdf(text, "arm", BaseType::FLOATING).warnings,
              testing::ElementsAre(testing::HasSubstr("floating base 'base'")));
}

TEST(InertiaTest, RootWithoutInertiaIsGoodWhenAFixedChildHasIt)
{
  const std::string text = robot(link("base", "") + link("trunk", BODY) + joint("j", "fixed", "base", "trunk"));
  const LoadedModel loaded = loadUrdf(text, "robot", BaseType::FLOATING);
  EXPECT_EQ(loaded.model.totalMass(), 1.0);
  EXPECT_THAT(loaded.warnings, testing::IsEmpty());
}

TEST(InertiaTest, MasslessLinkThatCarriesAMassIsAllowedAndNamed)
{
  // A universal joint: the cross has no mass, but its motion always moves the arm.
  const std::string text =
      robot(link("world", "") + link("cross", "") + link("arm", inertial(1.0, "0.1 0.1 0.1", {0, 0, 1})) +
            joint("first", "continuous", "world", "cross", "<axis xyz='1 0 0'/>") +
            joint("second", "continuous", "cross", "arm", "<axis xyz='0 1 0'/>"));
  const LoadedModel loaded = loadUrdf(text, "robot", BaseType::AUTO);
  EXPECT_THAT(loaded.warnings, testing::ElementsAre(testing::HasSubstr("'cross'")));
  MultibodyData data(loaded.model);
  forwardKinematics(loaded.model, zeroPosition(loaded.model), data);
  computeMassMatrix(loaded.model, data);
  EXPECT_TRUE(factorizeMassMatrix(loaded.model, Eigen::VectorXd(), data));
}

/// Diagonal inertia added to a joint's first coordinate.
double armature(const MultibodyModel& model, const std::string& joint)
{
  return model.armature[model.joints[model.findJoint(joint)].v_index];
}

int countAltered(const MultibodyModel& model)
{
  return static_cast<int>((model.armature.array() > 0.0).count());
}

TEST(InertiaTest, JointNearestTheRootThatMovesNothingGetsTheLeastInertia)
{
  // Both axes are the same line: the cross can turn against the arm without moving any mass.
  const std::string text = robot(link("world", "") + link("cross", "") + link("arm", BODY) +
                                 joint("first", "continuous", "world", "cross", "<axis xyz='1 0 0'/>") +
                                 joint("second", "continuous", "cross", "arm", "<axis xyz='1 0 0'/>"));
  for (const double least : {1e-3, 2e-9})
  {
    const LoadedModel loaded = loadUrdf(text, "robot", BaseType::AUTO, least);
    // 1e-7 of the arm's 0.1 kg m^2 at most, so that it is not felt.
    EXPECT_NEAR(armature(loaded.model, "first"), std::min(least, 1e-8), 1e-20);
    EXPECT_EQ(countAltered(loaded.model), 1);
    EXPECT_THAT(loaded.warnings, testing::ElementsAre(testing::AllOf(testing::HasSubstr("min_joint_inertia"),
                                                                     testing::HasSubstr("'first'"))));
  }
}

TEST(InertiaTest, DefaultIsAMillionthOfTheBody)
{
  const auto load = [](double mass, const std::string& moments)
  {
    return loadUrdf(robot(link("trunk", inertial(mass, moments)) + link("cap", "") +
                          joint("turn", "continuous", "trunk", "cap")),
                    "robot", BaseType::FLOATING)
        .model;
  };
  EXPECT_NEAR(armature(load(10.0, "9 9 9"), "turn"), 13.5e-6, 1e-18);
  EXPECT_NEAR(armature(load(0.001, "1e-6 1e-6 1e-6"), "turn"), 1.5e-12, 1e-24);
}

TEST(InertiaTest, LeavesAndPointMassesOnTheirAxisGetTheLeastInertia)
{
  const std::string limits = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  const std::string text =
      robot(link("trunk", inertial(9.0, "1 1 1")) + link("bead", inertial(1.0, "0 0 0")) + link("cap", "") +
            joint("spin", "continuous", "trunk", "bead", "<origin xyz='3 2 1' rpy='1 2 3'/><axis xyz='0.6 0 0.8'/>") +
            joint("slide", "prismatic", "trunk", "cap", limits));
  const LoadedModel loaded = loadUrdf(text, "robot", BaseType::FLOATING, 1e-6);
  EXPECT_EQ(armature(loaded.model, "spin"), 1e-6);
  EXPECT_EQ(armature(loaded.model, "slide"), 1e-6);
  EXPECT_EQ(countAltered(loaded.model), 2);
  EXPECT_THAT(loaded.warnings, testing::ElementsAre(testing::AllOf(testing::HasSubstr("'spin' 1e-06 kg m^2"),
                                                                   testing::HasSubstr("'slide' 1e-06 kg"))));
  EXPECT_EQ(loaded.model.totalMass(), 10.0);
}

TEST(InertiaTest, HipsOfNoInertiaAreHeldUpByTheLegEvenInGimbalLock)
{
  const std::string text = robot(link("trunk", inertial(9.0, "1 1 1")) + link("hip_1", "") + link("hip_2", "") +
                                 link("thigh", inertial(1.0, "0.1 0.1 0.01", {0, 0, -0.2})) +
                                 joint("yaw", "continuous", "trunk", "hip_1", "<axis xyz='0 0 1'/>") +
                                 joint("roll", "continuous", "hip_1", "hip_2", "<axis xyz='1 0 0'/>") +
                                 joint("pitch", "continuous", "hip_2", "thigh", "<axis xyz='0 1 0'/>"));
  const LoadedModel loaded = loadUrdf(text, "robot", BaseType::FLOATING);
  EXPECT_THAT(loaded.warnings,
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("held up by what it carries"),
                                                  testing::HasSubstr("'hip_1'"), testing::HasSubstr("'hip_2'"))));
  EXPECT_LT(loaded.model.armature.maxCoeff(), 2e-8);
  MultibodyData data(loaded.model);
  Eigen::VectorXd q = zeroPosition(loaded.model);
  q[loaded.model.joints[loaded.model.findJoint("roll")].q_index] = std::acos(0.0);
  forwardKinematics(loaded.model, q, data);
  computeMassMatrix(loaded.model, data);
  EXPECT_TRUE(factorizeMassMatrix(loaded.model, Eigen::VectorXd(), data));
}

TEST(InertiaTest, MasslessThumbFollowsItsMimicWithoutALoadOnTheLeader)
{
  const std::string mimic = "<mimic joint='finger' multiplier='-2'/>";
  const std::string text = robot(link("palm", BODY) + link("finger", inertial(0.01, "1e-5 1e-5 1e-5")) +
                                 link("thumb", "") + link("tip", "") + joint("finger", "continuous", "palm", "finger") +
                                 joint("thumb", "continuous", "palm", "thumb", mimic) +
                                 joint("tip", "continuous", "thumb", "tip", "<mimic joint='thumb' multiplier='3'/>"));
  const LoadedModel loaded = loadUrdf(text, "hand", BaseType::FLOATING);
  EXPECT_THAT(loaded.warnings, testing::ElementsAre(testing::AllOf(testing::HasSubstr("follows its mimic"),
                                                                   testing::HasSubstr("'thumb' (follows 'finger')"),
                                                                   testing::HasSubstr("'tip' (follows 'thumb')"))));
  EXPECT_EQ(countAltered(loaded.model), 2);
  const double felt = 4.0 * armature(loaded.model, "thumb") + 36.0 * armature(loaded.model, "tip");
  EXPECT_NEAR(felt, 2e-7 * 1e-5, 1e-15);
}

TEST(InertiaTest, FloatingBaseWithoutInertiaGetsAMassThatFalls)
{
  const LoadedModel dust = loadUrdf(robot(link("dust", "")), "dust", BaseType::FLOATING, 1e-4);
  EXPECT_EQ(dust.model.totalMass(), 1e-4);
  EXPECT_EQ(dust.model.links[0].inertia.rotational, Eigen::Matrix3d(1e-4 * Eigen::Matrix3d::Identity()));
  // A rod without thickness keeps its own moments.
  const LoadedModel rod = loadUrdf(robot(link("rod", inertial(1.0, "0.08 0.08 0"))), "rod", BaseType::FLOATING, 1e-9);
  EXPECT_LT(
      (rod.model.links[0].inertia.rotational - Eigen::Matrix3d(Eigen::Vector3d(0.08, 0.08, 1e-9).asDiagonal())).norm(),
      1e-16);
}

TEST(InertiaTest, BrokenTriangleInequalityIsAWarning)
{
  const LoadedModel loaded = loadUrdf(robot(link("plate", inertial(1.0, "0.1 0.1 0.3"))), "plate", BaseType::FLOATING);
  EXPECT_THAT(loaded.warnings, testing::ElementsAre(testing::HasSubstr("'plate'")));
}

TEST(JointTest, LimitsDampingFrictionAndMimicAreRead)
{
  const std::string limit = R"(<limit lower="-1.5" upper="2" effort="30" velocity="7"/>)";
  const std::string text =
      robot(link("world", "") + link("a", BODY) + link("b", BODY) + link("c", BODY) +
            joint("lead", "revolute", "world", "a",
                  limit + R"(<axis xyz="0 0 2"/><dynamics damping="0.25" friction="0.5"/>)") +
            joint("follow", "prismatic", "a", "b", limit + R"(<mimic joint="lead" multiplier="-2" offset="0.1"/>)") +
            joint("wheel", "continuous", "b", "c", R"(<limit effort="3" velocity="4"/>)"));
  const MultibodyModel model = loadUrdf(text, "robot", BaseType::AUTO).model;
  const Joint& lead = model.joints[model.findJoint("lead")];
  EXPECT_EQ(lead.axis, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(lead.limit.lower, -1.5);
  EXPECT_EQ(lead.limit.upper, 2.0);
  EXPECT_EQ(lead.limit.effort, 30.0);
  EXPECT_EQ(lead.limit.velocity, 7.0);
  EXPECT_EQ(lead.damping, 0.25);
  EXPECT_EQ(lead.dry_friction, 0.5);
  EXPECT_EQ(lead.mimic.joint, -1);
  const Joint& follow = model.joints[model.findJoint("follow")];
  EXPECT_EQ(follow.mimic.joint, model.findJoint("lead"));
  EXPECT_EQ(follow.mimic.multiplier, -2.0);
  EXPECT_EQ(follow.mimic.offset, 0.1);
  EXPECT_EQ(follow.axis, Eigen::Vector3d::UnitX());  // URDF's default
  const Joint& wheel = model.joints[model.findJoint("wheel")];
  EXPECT_EQ(wheel.limit.upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(wheel.limit.effort, 3.0);
}

TEST(JointTest, OrderIsThatOfTheDocumentParentsFirst)
{
  const std::string text = robot(link("r", BODY) + link("z", BODY) + link("a", BODY) + link("m", BODY) +
                                 joint("z1", "continuous", "r", "z") + joint("a1", "continuous", "r", "a") +
                                 joint("b1", "continuous", "z", "m"));
  const MultibodyModel model = loadUrdf(text, "robot", BaseType::FLOATING).model;
  std::vector<std::string> names;
  for (const Joint& joint : model.joints)
  {
    names.push_back(joint.name);
  }
  EXPECT_THAT(names, testing::ElementsAre("", "z1", "b1", "a1"));
}

TEST(ShapeTest, AllPrimitivesWithTheirPlacesAndNames)
{
  const std::string text = robot(link(
      "a", BODY + shape("<sphere radius='0.1'/>") + shape("<box size='1\t2 3'/>") +
               "<collision name='tube'><origin xyz='1 2 3'/><geometry><cylinder radius='0.2' length='3'/></geometry>"
               "</collision>" +
               shape("<capsule radius='0.3' length='4'/>") + shape("<cylinder radius='0.4' length='5'/>")));
  const MultibodyModel model = loadUrdf(text, "robot", BaseType::FLOATING).model;
  ASSERT_EQ(model.shapes.size(), 5u);
  EXPECT_EQ(std::get<Sphere>(model.shapes[0].geometry).radius, 0.1);
  EXPECT_EQ(std::get<Box>(model.shapes[1].geometry).half_size, Eigen::Vector3d(0.5, 1.0, 1.5));
  EXPECT_EQ(std::get<Cylinder>(model.shapes[2].geometry).half_length, 1.5);
  EXPECT_EQ(std::get<Capsule>(model.shapes[3].geometry).radius, 0.3);
  EXPECT_EQ(std::get<Capsule>(model.shapes[3].geometry).half_length, 2.0);
  EXPECT_EQ(std::get<Cylinder>(model.shapes[4].geometry).radius, 0.4);
  EXPECT_EQ(model.shapes[1].name, "a_collision_1");
  EXPECT_EQ(model.shapes[2].name, "tube");
  EXPECT_EQ(model.shapes[2].placement.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_LT(model.shapes[0].friction, 0.0);
}

TEST(GazeboTest, FrictionIsReadWhereIsotropicElseNamed)
{
  const std::string foot = BODY + shape("<sphere radius='0.1'/>");
  const std::string text =
      robot(link("a", foot) + link("b", foot) + link("c", foot) + joint("j", "fixed", "a", "b") +
            joint("k", "fixed", "b", "c") + "<gazebo reference='a'><mu1>0.7</mu1><mu2> 0.7 </mu2></gazebo>" +
            "<gazebo reference='b'><mu1 value='0.9'/></gazebo>" +
            "<gazebo reference='c'><mu1>0.1</mu1><mu2>0.2</mu2><kp>1e5</kp></gazebo>" +
            "<gazebo reference='ghost'><mu1>1</mu1></gazebo><gazebo><plugin filename='x'/></gazebo>");
  const LoadedModel loaded = loadUrdf(text, "robot", BaseType::FLOATING);
  ASSERT_EQ(loaded.model.shapes.size(), 3u);
  EXPECT_EQ(loaded.model.shapes[0].friction, 0.7);
  EXPECT_EQ(loaded.model.shapes[1].friction, 0.9);
  EXPECT_LT(loaded.model.shapes[2].friction, 0.0);
  EXPECT_THAT(loaded.warnings, testing::IsSupersetOf({testing::HasSubstr("'c'"), testing::HasSubstr("<kp>"),
                                                      testing::HasSubstr("'ghost'"), testing::HasSubstr("<plugin>")}));
}

TEST(WarningTest, NamesEachKindOnceAndVisualsNever)
{
  const std::string text = robot(
      "<material name='m'/>" +
      link("a", BODY + "<visual><geometry><mesh filename='package://no/m.dae'/></geometry>"
                       "<material name='undefined'/></visual><sensor/>") +
      link("b", BODY) +
      joint("j", "continuous", "a", "b", "<safety_controller k_velocity='1'/><dynamics damping='0' spring='3'/>") +
      "<transmission name='t'/><transmission name='u'/>");
  const LoadedModel loaded = loadUrdf(text, "robot", BaseType::FLOATING);
  EXPECT_THAT(loaded.warnings,
              testing::UnorderedElementsAre(testing::HasSubstr("<sensor>"), testing::HasSubstr("<safety_controller>"),
                                            testing::HasSubstr("'spring'"), testing::HasSubstr("<transmission>")));
  for (const std::string& warning : loaded.warnings)
  {
    EXPECT_THAT(warning, testing::Not(testing::HasSubstr("\n")));
  }
}

TEST(MeshPathTest, PackageFileAbsoluteAndRelativePathsResolve)
{
  const TemporaryPackage package;
  testing::internal::CaptureStdout();
  EXPECT_EQ(resolvePath("package://shapes/meshes/m.stl", ""), package.mesh());
  EXPECT_EQ(resolvePath("file://" + package.mesh(), ""), package.mesh());
  EXPECT_EQ(resolvePath(package.mesh(), "/elsewhere"), package.mesh());
  EXPECT_EQ(resolvePath("meshes/../meshes/m.stl", package.folder() + "/shapes"), package.mesh());
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  for (const std::string uri : {"package://shapes/meshes/none.stl", "package://shapes", "meshes/m.stl"})
  {
    EXPECT_THROW(resolvePath(uri, package.folder()), ModelError) << uri;
  }
}

TEST(MeshPathTest, LoadedMeshHasItsFileAndScale)
{
  const TemporaryPackage package;
  const std::string text =
      robot(link("a", BODY + shape("<mesh filename='package://shapes/meshes/m.stl' scale='1 2 -3'/>")));
  const MultibodyModel model = loadUrdf(text, "robot_description", BaseType::FLOATING).model;
  EXPECT_EQ(std::get<Mesh>(model.shapes[0].geometry).path, package.mesh());
  EXPECT_EQ(std::get<Mesh>(model.shapes[0].geometry).scale, Eigen::Vector3d(1, 2, -3));
}

TEST(LongChainTest, OfAThousandLinksLoads)
{
  std::string text = link("l0", BODY);
  const int links = 1000;
  for (int i = 1; i < links; ++i)
  {
    const std::string child = "l" + std::to_string(i);
    text += link(child, BODY) + joint("j" + std::to_string(i), "continuous", "l" + std::to_string(i - 1), child);
  }
  EXPECT_EQ(loadUrdf(robot(text), "chain", BaseType::FLOATING).model.nv, links + 5);
}

}  // namespace frictional_contact_sim
