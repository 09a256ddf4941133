// A rostest in C++: two fingers hold a cube of 1 kg with 12 N each, and the forces of every contact are those of
// statics.
#include <frictional_contact_sim/ContactArray.h>
#include <frictional_contact_sim/StepReport.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <cmath>
#include <map>

using frictional_contact_sim::Contact;
using frictional_contact_sim::ContactArray;
using frictional_contact_sim::StepReport;

namespace
{
constexpr double WEIGHT = 9.81;  // of the cube [N]
constexpr double GRIP = 12.0;  // effort of each finger [N]
const ros::Duration TIMEOUT(60.0);  // simulated

TEST(GraspForcesTest, EachPadPressesWithItsEffortAndCarriesHalfOfTheWeight)
{
  ros::Duration(1.0).sleep();  // simulated
  const auto message = ros::topic::waitForMessage<ContactArray>("/simulator_node/contacts", TIMEOUT);
  ASSERT_TRUE(message);
  std::map<std::string, double> normal, lift;  // by finger [N]
  for (const Contact& contact : message->contacts)
  {
    // The force acts on link a, the normal points from b to a.
    const bool cube_is_a = contact.link_a == "cube";
    const std::string finger = cube_is_a ? contact.link_b : contact.link_a;
    normal[finger] +=
        contact.force.x * contact.normal.x + contact.force.y * contact.normal.y + contact.force.z * contact.normal.z;
    lift[finger] += cube_is_a ? contact.force.z : -contact.force.z;
    EXPECT_EQ(contact.mode, Contact::STICKING);
    EXPECT_GE(contact.cone_margin, 0.0);  // mu r_N - |r_T|
  }
  ASSERT_EQ(normal.size(), 2u);
  for (const auto& [finger, force] : normal)
  {
    EXPECT_NEAR(force, GRIP, 1e-5) << finger;
    EXPECT_NEAR(lift[finger], 0.5 * WEIGHT, 1e-5) << finger;
  }
}

TEST(GraspForcesTest, EveryStepIsSolved)
{
  const auto report = ros::topic::waitForMessage<StepReport>("/simulator_node/step_report", TIMEOUT);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->status, StepReport::CONVERGED);
  EXPECT_LE(report->residual, 1e-10);  // the scenario's tolerance
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "grasp_forces");
  const ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
