#!/usr/bin/python3
"""One robot is commanded, the other stands; each is seen under its own names."""
import unittest
import xml.etree.ElementTree as ElementTree

import rospy
import rostest
from frictional_contact_sim.msg import ContactArray
from sensor_msgs.msg import JointState


def joints(topic):
    message = rospy.wait_for_message(topic, JointState, timeout=60)
    return dict(zip(message.name, message.position))


class TwoRobotsTest(unittest.TestCase):
    def test_a_command_moves_the_robot_it_names(self):
        rospy.sleep(1.0)  # simulated: the walker has come down
        before = joints("/walker/joint_states")
        publisher = rospy.Publisher("/simulator_node/command/position", JointState, queue_size=1, latch=True)
        publisher.publish(JointState(name=["arm/yaw"], position=[0.4]))
        rospy.sleep(1.5)
        self.assertAlmostEqual(0.4, joints("/arm/joint_states")["yaw"], delta=1e-3)
        for name, position in joints("/walker/joint_states").items():
            self.assertAlmostEqual(before[name], position, delta=1e-4)
        names = set(joints("/joint_states"))
        self.assertLessEqual({"arm/yaw", "walker/LF_HFE"}, names)

    def test_the_ground_carries_the_walker(self):
        robot = ElementTree.fromstring(rospy.get_param("/walker/robot_description"))
        weight = 9.81 * sum(float(mass.get("value")) for mass in robot.iter("mass"))  # [N]
        rospy.sleep(1.0)
        contacts = rospy.wait_for_message("/simulator_node/contacts", ContactArray, timeout=60).contacts
        lift = sum(contact.force.z if contact.body_a == "walker" else -contact.force.z for contact in contacts
                   if "walker" in (contact.body_a, contact.body_b))
        self.assertAlmostEqual(weight, lift, delta=1e-3 * weight)


if __name__ == "__main__":
    rospy.init_node("two_robots_test")
    rostest.rosrun("frictional_contact_sim", "two_robots", TwoRobotsTest)
