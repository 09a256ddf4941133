#!/usr/bin/python3
"""After two seconds the ground carries the weight of the quadruped, no more and no less."""
import unittest
import xml.etree.ElementTree as ElementTree

import rospy
import rostest
from frictional_contact_sim.msg import ContactArray


class StandingTest(unittest.TestCase):
    def test_the_ground_carries_the_robot(self):
        robot = ElementTree.fromstring(rospy.get_param("/robot_description"))
        weight = 9.81 * sum(float(mass.get("value")) for mass in robot.iter("mass"))  # [N]
        rospy.sleep(2.0)  # simulated
        message = rospy.wait_for_message("/simulator_node/contacts", ContactArray, timeout=60)
        # The force of a contact acts on body a; the ground is the body without a name.
        lift = sum(contact.force.z if contact.body_a else -contact.force.z for contact in message.contacts)
        self.assertAlmostEqual(lift, weight, delta=1e-4 * weight)


if __name__ == "__main__":
    rospy.init_node("standing_test")
    rostest.rosrun("frictional_contact_sim", "standing", StandingTest)
