#!/usr/bin/env python3
"""Commands of effort, velocity and position: what the joints do, limits, stamps, refusals; the arm is stepped by hand."""
import math
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from frictional_contact_sim.srv import LoadState, SaveState
from node_runner import NAME
from stepped_node import ARM, DT, SteppedNode, value


class CommandModesTest(unittest.TestCase):
    def setUp(self):
        self.arm = SteppedNode()

    def tearDown(self):
        self.assertEqual(0, self.arm.end(), self.arm.node.stderr())

    def test_modes(self):
        state = self.arm.step(500)
        for joint, start in ARM.items():
            self.assertAlmostEqual(start, value(state, "position", joint), delta=1e-6)  # it holds without droop

        # The yaw joint's only load is its damper's 0.5 N m s/rad, fed forward here.
        self.arm.give("command/velocity", JointState(name=["yaw"], velocity=[0.4], effort=[0.2]))
        state = self.arm.step(500)
        self.assertAlmostEqual(0.4, value(state, "velocity", "yaw"), delta=1e-6)

        # Position, its rate and an effort: kd rate and the effort stand off the target by (kd rate + effort)/kp.
        self.arm.give("command/position", JointState(name=["yaw"], position=[0.1], velocity=[0.3], effort=[2.0]))
        loaded = self.arm.step(800)
        self.arm.give("command/position", JointState(name=["yaw"], position=[0.1]))
        plain = self.arm.step(800)
        self.assertAlmostEqual(0.1, value(plain, "position", "yaw"), delta=1e-6)
        self.assertGreater(value(loaded, "position", "yaw"), 0.1 + 2.0 * 0.3 / 40.0)  # kd/kp = 2/(40/s), and more

        # An effort is what the joint gets, feed-forward or not.
        self.arm.give("command/effort", JointState(name=["yaw"], effort=[1.25]))
        self.assertEqual(1.25, value(self.arm.step(1), "effort", "yaw"))
        self.arm.give("command/velocity_array", Float64MultiArray(data=[0.1, 0.0, 0.0, 0.0, 0.0]))
        state = self.arm.step(600)
        self.assertAlmostEqual(0.1 * 1.0, value(state, "velocity", "yaw"), delta=0.03)

    def test_absurd_commands_are_taken_into_the_limits_with_a_warning_a_joint(self):
        for _ in range(3):
            self.arm.give("command/velocity", JointState(name=["yaw", "wrist"], velocity=[1e300, -1e12]))
            state = self.arm.step(100)
        self.assertLessEqual(abs(value(state, "velocity", "yaw")), 3.0 * (1.0 + 1e-9))
        self.assertTrue(all(map(math.isfinite, state.position + state.velocity + state.effort)))
        for joint in ("yaw", "wrist"):
            self.assertEqual(1, len(self.arm.warnings(f"'{joint}': the command is")), self.arm.node.stderr())
        self.arm.give("command/position", JointState(name=["yaw"], position=[0.0], effort=[1e300]))
        state = self.arm.step(10)
        self.assertLessEqual(abs(value(state, "effort", "yaw")), 60.0 * (1.0 + 1e-9))

    def test_refusals_change_nothing(self):
        before = self.arm.step(1)
        nan = float("nan")
        self.arm.give("command/velocity", JointState(name=["yaw"], velocity=[]),
                      JointState(name=["yaw"], velocity=[nan]), JointState(name=["yaw", "nose"], velocity=[1.0, 1.0]),
                      JointState(name=["yaw", "yaw"], velocity=[1.0, 1.0]),
                      JointState(name=["right_finger"], velocity=[0.1]),
                      JointState(name=["yaw"], velocity=[1.0], effort=[nan]))
        self.arm.give("command/position", JointState(name=["yaw", "elbow"], position=[1.0, 1.0], velocity=[1.0]),
                      JointState(name=["yaw"], position=[1.0], effort=[1.0, 2.0]))
        wall_clock = JointState(name=["yaw"], position=[1.0])
        wall_clock.header.stamp = rospy.Time(1.7e9)
        self.arm.give("command/position", wall_clock)
        self.arm.give("command/velocity_array", Float64MultiArray(data=[1.0]))
        after = self.arm.step(50)
        for joint in ARM:
            self.assertAlmostEqual(value(before, "position", joint), value(after, "position", joint), delta=1e-9)
        self.assertEqual(10, len(self.arm.warnings("command ignored")), self.arm.node.stderr())
        self.assertEqual(1, len(self.arm.warnings("use_sim_time")), self.arm.node.stderr())

    def test_a_stamp_says_the_step(self):
        def effort(value, stamp):
            message = JointState(name=["yaw"], effort=[value])
            message.header.stamp = stamp
            return message
        start = self.arm.now()
        ahead = [rospy.Duration(0.05), rospy.Duration(0.02), rospy.Duration(0.03), rospy.Duration(0.0305)]
        # Not in order of time; the last one is within a step, and holds from the next.
        self.arm.give("command/effort", *[effort(float(k), start + later) for k, later in enumerate(ahead)])
        self.arm.step(100)

        def after(seconds):  # effort of the step that ends then
            return value(self.arm.state_at(start + rospy.Duration(seconds)), "effort", "yaw")
        self.assertNotEqual(1.0, after(0.020))
        self.assertEqual(1.0, after(0.020 + DT))  # latency of a command that is there in time: one step
        self.assertEqual(1.0, after(0.030))
        self.assertEqual(2.0, after(0.030 + DT))
        self.assertEqual(3.0, after(0.031 + DT))
        self.assertEqual(3.0, after(0.050))
        self.assertEqual(0.0, after(0.050 + DT))
        # Of the past: at once; of one time: as they came.
        now = self.arm.now()
        self.arm.give("command/effort", effort(5.0, now - rospy.Duration(0.05)))
        self.assertEqual(5.0, value(self.arm.step(1), "effort", "yaw"))
        later = self.arm.now() + rospy.Duration(0.01)
        self.arm.give("command/effort", effort(6.0, later), effort(7.0, later))
        self.assertEqual(7.0, value(self.arm.step(11), "effort", "yaw"))
        # A reset forgets what has not come yet; too many is one line.
        self.arm.give("command/effort", effort(8.0, self.arm.now() + rospy.Duration(0.01)))
        self.arm.call("reset")
        self.assertNotEqual(8.0, value(self.arm.step(20), "effort", "yaw"))
        # So does a state that is loaded, here as in a process that has got none.
        rospy.ServiceProxy(NAME + "/save_state", SaveState)("")
        self.arm.give("command/effort", effort(9.0, self.arm.now() + rospy.Duration(0.01)))
        self.assertTrue(rospy.ServiceProxy(NAME + "/load_state", LoadState)("").success)
        self.assertNotEqual(9.0, value(self.arm.step(20), "effort", "yaw"))

    def test_the_queue_of_commands_for_later_is_bounded(self):
        message = JointState(name=["yaw"], effort=[1.0])
        message.header.stamp = self.arm.now() + rospy.Duration(100.0)
        for _ in range(11):
            self.arm.give("command/effort", *[message] * 990)
        self.assertGreaterEqual(len(self.arm.warnings("wait for their header.stamp already")), 1)
        self.assertLessEqual(len(self.arm.warnings("wait for their header.stamp already")), 5)
        self.arm.step(1)


if __name__ == "__main__":
    rospy.init_node("command_modes_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "command_modes", CommandModesTest)
