#!/usr/bin/env python3
"""examples/rospy_controller/pick_and_place.py, by topics and by the action: the part is lifted, held without creep, and set down."""
import math
import os
import signal
import subprocess
import tempfile
import unittest

import rosbag
import rospy
import rostest
from nav_msgs.msg import Odometry

import node_runner

ODOM = node_runner.NAME + "/ground_truth/part/odom"
CONTACTS = node_runner.NAME + "/contacts"
PAD_FORCE = 8.0  # half of the effort of the gripper [N]
LIFT = 0.33 - 0.115  # [m]
WEIGHT = 0.2 * 9.81  # [N]


def pad_forces(message):
    """Sum of the normal forces of each pad on the part [N]."""
    forces = {}
    for contact in message.contacts:
        links = {contact.link_a, contact.link_b}
        if "part" in links and links & {"left_finger", "right_finger"}:
            pad = (links - {"part"}).pop()
            normal = contact.normal
            forces[pad] = forces.get(pad, 0.0) + (contact.force.x * normal.x + contact.force.y * normal.y +
                                                  contact.force.z * normal.z)
    return forces


class PickAndPlaceTest(unittest.TestCase):
    def record(self, *arguments):
        """The example's run: states and contacts by time, and what a subscriber of queue_size 1 has seen of the part."""
        latest = []
        slow = rospy.Subscriber(ODOM, Odometry, lambda message: latest.append(message.pose.pose.position.z),
                                queue_size=1)
        node = node_runner.Node({"scenario": "pick_and_place", "real_time_factor": 2.0,
                                 "wait_for_subscribers": [CONTACTS, ODOM, ODOM]})
        with tempfile.TemporaryDirectory() as folder:
            bag = os.path.join(folder, "pick.bag")
            recorder = subprocess.Popen(["rosrun", "frictional_contact_sim", "record_bag", bag, CONTACTS, ODOM])
            script = subprocess.run([str(node_runner.PACKAGE_DIR / "examples/rospy_controller/pick_and_place.py"), *arguments],
                                    timeout=node_runner.TIMEOUT, check=False)
            self.assertEqual(0, node.interrupt(), node.stderr())
            recorder.send_signal(signal.SIGINT)
            self.assertEqual(0, recorder.wait(node_runner.TIMEOUT))
            self.assertEqual(0, script.returncode)
            slow.unregister()
            states, contacts = {}, {}
            for topic, message, _ in rosbag.Bag(bag).read_messages():
                (states if topic == ODOM else contacts)[message.header.stamp.to_nsec()] = message
        return states, contacts, latest

    def check(self, states, contacts, latest):
        heights = {stamp: message.pose.pose.position.z for stamp, message in states.items()}
        self.assertEqual(len(heights), round((max(heights) - min(heights)) * 1e-6) + 1, "every step is recorded")
        # Aloft the arm rests for 1.5 s before it turns: the second of that which ends 0.2 s before the part moves on.
        turning = min(stamp for stamp in states if states[stamp].pose.pose.position.y > 1e-3)
        end = turning - int(0.2e9)
        resting = sorted(stamp for stamp in states if end - int(1e9) <= stamp <= end)
        self.assertEqual(1001, len(resting))
        points = [states[stamp].pose.pose.position for stamp in resting]
        for axis in ("x", "y", "z"):
            values = [getattr(point, axis) for point in points]
            self.assertLess(max(values) - min(values), 1e-6, axis)
        self.assertAlmostEqual(0.025 + LIFT, points[-1].z, delta=2e-3)  # the part's own weight is not compensated
        for stamp in resting[::50]:
            forces = pad_forces(contacts[stamp])
            self.assertEqual({"left_finger", "right_finger"}, set(forces))
            for force in forces.values():
                self.assertAlmostEqual(PAD_FORCE, force, delta=0.05)
        # Set down where the yaw joint has turned it to, and let go.
        last = states[max(states)].pose.pose.position
        self.assertAlmostEqual(0.025, last.z, delta=1e-5)
        self.assertAlmostEqual(0.6, math.atan2(last.y, last.x), delta=0.02)
        self.assertEqual({}, pad_forces(contacts[max(contacts)]))
        # Who wants the latest only gets it.
        self.assertGreater(len(latest), 100)
        self.assertAlmostEqual(0.025, latest[-1], delta=1e-5)
        self.assertAlmostEqual(max(heights.values()), max(latest), delta=5e-3)

    def test_by_topics(self):
        self.check(*self.record())

    def test_by_the_action(self):
        self.check(*self.record("--action"))


if __name__ == "__main__":
    rospy.init_node("picking", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "picking", PickAndPlaceTest)
