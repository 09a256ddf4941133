#!/usr/bin/python3
"""The part goes up by as much as the wrist, and then hangs between the pads without moving."""
import unittest

import rospy
import rostest
from frictional_contact_sim.msg import ContactArray
from nav_msgs.msg import Odometry

START, LIFT = 0.025, 0.33 - 0.115  # centre of the part on the ground, way of the wrist [m]
WEIGHT = 0.2 * 9.81  # of the part [N]


def height():
    return rospy.wait_for_message("/simulator_node/ground_truth/part/odom", Odometry, timeout=60).pose.pose.position.z


class LiftedTest(unittest.TestCase):
    def test_the_part_is_lifted_and_held(self):
        end = rospy.get_time() + 30.0  # simulated
        while height() < START + LIFT - 0.003 and rospy.get_time() < end:
            rospy.sleep(0.1)
        rospy.sleep(0.5)
        before = height()
        self.assertAlmostEqual(START + LIFT, before, delta=0.003)  # the arm does not know the part's weight
        rospy.sleep(1.0)
        self.assertAlmostEqual(before, height(), delta=1e-6)
        contacts = rospy.wait_for_message("/simulator_node/contacts", ContactArray, timeout=60).contacts
        pads = [contact for contact in contacts if {contact.body_a, contact.body_b} == {"arm", "part"}]
        lift = sum(contact.force.z if contact.body_a == "part" else -contact.force.z for contact in pads)
        self.assertAlmostEqual(WEIGHT, lift, delta=1e-3)


if __name__ == "__main__":
    rospy.init_node("lifting")
    rostest.rosrun("frictional_contact_sim", "lifting", LiftedTest)
