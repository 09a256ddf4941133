#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frictional_contact_sim/model/urdf_loader.h"
#include "model/urdf_text.h"

namespace frictional_contact_sim
{
namespace
{
const std::string BODY = inertial(1.0, "0.1 0.1 0.1");
const std::string TWO_LINKS = link("a", BODY) + link("b", BODY);
const std::string LIMIT = R"(<limit lower="-1" upper="1" effort="5" velocity="2"/>)";

struct BadDocument
{
  const char* name;
  std::string text;
  std::vector<std::string> named;  ///< what the message must contain
};

void PrintTo(const BadDocument& bad, std::ostream* os)
{
  *os << bad.name;
}

std::string collision(const std::string& shape)
{
  return robot(link("a", BODY + "<collision><geometry>" + shape + "</geometry></collision>"));
}

std::string hinge(const std::string& content, const std::string& type = "revolute")
{
  return robot(TWO_LINKS + joint("knee", type, "a", "b", content));
}

std::string moving(const std::string& child)
{
  return robot(link("a", BODY) + link("b", child) + joint("knee", "continuous", "a", "b"));
}

class UrdfErrorTest : public testing::TestWithParam<BadDocument>
{
};
}  // namespace

TEST_P(UrdfErrorTest, IsOneLineNamingTheFileAndTheOffender)
{
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::string message;
  try
  {
    loadUrdf(GetParam().text, "folder/bad.urdf", BaseType::FLOATING);
  }
  catch (const ModelError& error)
  {
    message = error.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(message.empty()) << "no ModelError";
  EXPECT_THAT(message, testing::StartsWith("folder/bad.urdf"));
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("\n")));
  for (const std::string& part : GetParam().named)
  {
    EXPECT_THAT(message, testing::HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Documents, UrdfErrorTest,
    testing::Values(
        BadDocument{"empty", "", {"XML"}}, BadDocument{"not_xml", "hello", {"XML"}},
        BadDocument{"broken_xml", "<robot name='r'>\n<link name='a'>\n</robot>", {"bad.urdf:", "XML"}},
        BadDocument{"not_a_robot", "<sdf version='1.6'/>", {"<sdf>", "<robot>"}},
        BadDocument{"no_robot_name", "<robot><link name='a'/></robot>", {"name"}},
        BadDocument{"no_links", "<robot name='r'/>", {"<link>"}},
        BadDocument{"link_without_name", robot("<link/>"), {"<link>", "name"}},
        BadDocument{"two_links_of_one_name", robot(link("a", BODY) + link("a", BODY)), {":3:", "'a'", "line 2"}},
        BadDocument{"two_joints_of_one_name",
                    robot(TWO_LINKS + link("c", BODY) + joint("j", "fixed", "a", "b") + joint("j", "fixed", "b", "c")),
                    {"'j'", "line 5"}},
        BadDocument{"two_roots", robot(TWO_LINKS), {"'a'", "'b'", "root"}},
        BadDocument{"unknown_parent", robot(link("a", BODY) + joint("j", "fixed", "ghost", "a")), {"'j'", "'ghost'"}},
        BadDocument{"unknown_child", robot(link("a", BODY) + joint("j", "fixed", "a", "ghost")), {"'j'", "'ghost'"}},
        BadDocument{"two_parents",
                    robot(TWO_LINKS + link("c", BODY) + joint("j", "fixed", "a", "c") + joint("k", "fixed", "b", "c")),
                    {"'c'", "'j'", "'k'"}},
        BadDocument{"cycle_without_root",
                    robot(TWO_LINKS + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
                    {"cycle"}},
        BadDocument{
            "cycle_beside_a_root",
            robot(link("root", BODY) + TWO_LINKS + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
            {"cycle", "'a'"}},
        BadDocument{"own_parent", robot(link("root", BODY) + link("a", BODY) + joint("j", "fixed", "a", "a")), {"'a'"}},
        BadDocument{"unknown_joint_type", hinge("", "ball"), {"'knee'", "'ball'", "revolute"}},
        BadDocument{"revolute_without_limit", hinge(""), {"'knee'", "<limit>"}},
        BadDocument{"prismatic_without_limit", hinge("", "prismatic"), {"'knee'", "<limit>"}},
        BadDocument{"limit_without_effort", hinge("<limit lower='0' upper='1' velocity='1'/>"), {"'knee'", "effort"}},
        BadDocument{"lower_above_upper",
                    hinge("<limit lower='2' upper='1' effort='1' velocity='1'/>"),
                    {"'knee'", "lower = 2", "upper = 1"}},
        BadDocument{"negative_effort",
                    hinge("<limit lower='0' upper='1' effort='-3' velocity='1'/>"),
                    {"'knee'", "effort", "'-3'"}},
        BadDocument{"negative_damping", hinge(LIMIT + "<dynamics damping='-0.1'/>"), {"'knee'", "damping", "'-0.1'"}},
        BadDocument{"negative_friction", hinge(LIMIT + "<dynamics friction='-1'/>"), {"'knee'", "friction", "'-1'"}},
        BadDocument{"axis_of_zero", hinge(LIMIT + "<axis xyz='0 0.0 0e5'/>"), {"'knee'", "<axis>", "0e5"}},
        BadDocument{"axis_of_two_numbers", hinge(LIMIT + "<axis xyz='0 1'/>"), {"'knee'", "<axis>", "3 finite"}},
        BadDocument{"mimic_of_nothing", hinge(LIMIT + "<mimic joint='ghost'/>"), {"'knee'", "'ghost'"}},
        BadDocument{"mimic_of_itself", hinge(LIMIT + "<mimic joint='knee'/>"), {"'knee'", "itself"}},
        BadDocument{"not_a_number", hinge(LIMIT + "<origin xyz='0 nan 0'/>"), {"'knee'", "<origin>", "nan"}},
        BadDocument{"infinite", hinge("<limit lower='0' upper='inf' effort='1' velocity='1'/>"), {"'knee'", "'inf'"}},
        BadDocument{"too_large_for_a_double", hinge(LIMIT + "<dynamics damping='1e999'/>"), {"'knee'", "1e999"}},
        BadDocument{"words_for_numbers", hinge(LIMIT + "<origin rpy='0 0 ${pi}'/>"), {"'knee'", "rpy", "${pi}"}},
        BadDocument{"newline_in_a_value", hinge(LIMIT + "<origin xyz='0 0&#10;x'/>"), {"'knee'", "xyz"}},
        BadDocument{"negative_mass", robot(link("a", inertial(-1.0, "0.1 0.1 0.1"))), {"'a'", "<mass>", "'-1'"}},
        BadDocument{"mass_not_a_number",
                    robot(link("a",
                               "<inertial><mass value='NaN'/>"
                               "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>"
                               "</inertial>")),
                    {"'a'", "<mass>", "NaN"}},
        BadDocument{"inertial_without_mass", robot(link("a", "<inertial/>")), {"'a'", "<mass>"}},
        BadDocument{"inertia_without_izz",
                    robot(link("a",
                               "<inertial><mass value='1'/>"
                               "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0'/></inertial>")),
                    {"'a'", "izz"}},
        BadDocument{"negative_inertia",
                    moving(inertial(1.0, "0.1 -0.1 0.1")),
                    {"'b'", "-0.1", "principal moments >= 0"}},
        BadDocument{"overflowing_inertia",
                    robot(link("a", inertial(1e300, "1 1 1")) + link("b", inertial(1e300, "1 1 1")) +
                          joint("j", "fixed", "a", "b", "<origin xyz=\'1e9 0 0\'/>")),
                    {"\'a\'", "overflow"}},
        BadDocument{"sphere_of_negative_radius", collision("<sphere radius='-1'/>"), {"'a'", "<sphere>", "'-1'"}},
        BadDocument{"box_of_negative_size", collision("<box size='1 -1 1'/>"), {"'a'", "<box>", "'1 -1 1'"}},
        BadDocument{"cylinder_without_length", collision("<cylinder radius='1'/>"), {"'a'", "length"}},
        BadDocument{"flat_mesh", collision("<mesh filename='m.stl' scale='1 1 0'/>"), {"'a'", "scale"}},
        BadDocument{"mesh_without_file",
                    collision("<mesh filename='no/such.stl'/>"),
                    {"link 'a'", "'no/such.stl'", "folder/no/such.stl"}},
        BadDocument{"mesh_of_unknown_package",
                    collision("<mesh filename='package://no_such_package/m.stl'/>"),
                    {"link 'a'", "no_such_package", "ROS_PACKAGE_PATH"}},
        BadDocument{"mesh_by_http", collision("<mesh filename='http://host/m.stl'/>"), {"'a'", "http://host/m.stl"}},
        BadDocument{"xacro", robot("<xacro:macro name='leg'/>"), {"xacro"}},
        BadDocument{"negative_gazebo_friction",
                    robot(link("a", BODY) + "<gazebo reference='a'><mu1>-0.5</mu1></gazebo>"),
                    {"mu1", "'-0.5'"}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(UrdfFileTest, MissingFileAndFolderAreNamed)
{
  for (const std::string path : {"/no/such/robot.urdf", "/tmp"})
  {
    try
    {
      loadUrdfFile(path, BaseType::AUTO);
      FAIL() << "no ModelError";
    }
    catch (const ModelError& error)
    {
      EXPECT_THAT(error.what(), testing::HasSubstr(path));
    }
  }
}

TEST(BaseTypeTest, ParsesItsThreeNamesAndListsThemOtherwise)
{
  EXPECT_EQ(parseBaseType("auto"), BaseType::AUTO);
  EXPECT_EQ(parseBaseType("floating"), BaseType::FLOATING);
  EXPECT_EQ(parseBaseType("fixed"), BaseType::FIXED);
  EXPECT_THROW(parseBaseType("Fixed"), std::invalid_argument);
}

}  // namespace frictional_contact_sim
