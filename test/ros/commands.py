#!/usr/bin/env python3
"""Absurd commands, many a second: clamped or ignored with a line a second, and the simulation goes on."""
import math
import random
import time
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

import node_runner
from frictional_contact_sim.msg import StepReport

SECONDS = 4.0
RATE = 500.0  # [1/s]


class CommandsTest(unittest.TestCase):
    def setUp(self):
        self.states, self.reports = [], []
        self.subscribers = [rospy.Subscriber("/joint_states", JointState, self.states.append),
                            rospy.Subscriber(node_runner.NAME + "/step_report", StepReport, self.reports.append)]
        self.publisher = {kind: rospy.Publisher(node_runner.NAME + "/command/" + kind, JointState, queue_size=100)
                          for kind in ("position", "effort")}

    def tearDown(self):
        for handle in self.subscribers + list(self.publisher.values()):
            handle.unregister()

    def flood(self, urdf, commands, **parameters):
        """Gives commands() [(kind, joint, value), ...] at RATE; the node has to be alive and well at the end."""
        node = node_runner.Node(dict({"publish_rate": 100.0}, **parameters), urdf)
        self.assertTrue(node_runner.wait_until(lambda: self.states and all(
            publisher.get_num_connections() > 0 for publisher in self.publisher.values())), node.stderr())
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            for kind, joint, value in commands():
                self.publisher[kind].publish(JointState(name=[joint], **{kind: [value]}))
            time.sleep(1.0 / RATE)
        count = len(self.reports)
        self.assertTrue(node_runner.wait_until(lambda: len(self.reports) > count + 20), node.stderr())
        for report in self.reports:
            self.assertEqual(StepReport.CONVERGED, report.status, node.stderr())
        for state in self.states:
            self.assertTrue(all(map(math.isfinite, state.position + state.velocity + state.effort)))
        self.assertEqual(0, node.interrupt(), node.stderr())
        return node

    def check_lines(self, node, words, most):
        lines = [line for line in node.lines("WARN") if "command/" in line]
        self.assertGreaterEqual(len(lines), 1, node.stderr())
        self.assertLessEqual(len(lines), most, node.stderr())
        for word in words:
            self.assertIn(word, lines[0])

    def test_a_position_beyond_the_limits_is_taken_as_the_limit(self):
        for value, word in ((1e6, "above"), (1e300, "above"), (-1e300, "below")):
            with self.subTest(value):
                self.states.clear()
                node = self.flood(node_runner.quadruped_urdf(), lambda: [("position", "LF_HFE", value)],
                                  hold_initial_position=True)
                self.check_lines(node, ["~command/position", "'LF_HFE'", word], 10)

    def test_wrong_commands_a_thousand_times_get_a_line_a_second(self):
        node = self.flood(node_runner.quadruped_urdf(), lambda: [("position", "elbow", 1.0)],
                          hold_initial_position=True)
        self.check_lines(node, ["ignored", "'elbow'"], 10)

    def test_random_commands(self):
        dice = random.Random(20260103)
        joints = [leg + joint for leg in ("LF_", "RF_", "LH_", "RH_") for joint in ("HAA", "HFE", "KFE")]

        def commands():
            return [("position", dice.choice(joints + ["elbow"]),
                     dice.choice((-1.0, 1.0)) * 10.0 ** dice.uniform(-3.0, 300.0))]
        node = self.flood(node_runner.quadruped_urdf(), commands, hold_initial_position=True)
        self.check_lines(node, [], 100)  # ten different ones a second


if __name__ == "__main__":
    rospy.init_node("commands_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "commands", CommandsTest)
