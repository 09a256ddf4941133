#!/usr/bin/env python3
"""Pause, step and reset over services: /clock and the stamps of messages never run back."""
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty, SetBool

import node_runner
from frictional_contact_sim.msg import StepReport
from frictional_contact_sim.srv import Step

ROUNDS = 20
STEPS = 100


def service(name, kind):
    rospy.wait_for_service(node_runner.NAME + "/" + name, node_runner.TIMEOUT)
    return rospy.ServiceProxy(node_runner.NAME + "/" + name, kind)


class SteppingTest(unittest.TestCase):
    def setUp(self):
        self.clocks, self.stamps, self.reports = [], [], []
        self.subscribers = [
            rospy.Subscriber("/clock", Clock, lambda message: self.clocks.append(message.clock)),
            rospy.Subscriber("/joint_states", JointState, lambda message: self.stamps.append(message.header.stamp)),
            rospy.Subscriber(node_runner.NAME + "/step_report", StepReport, self.reports.append),
        ]
        self.node = node_runner.Node({"start_paused": True, "time_step": 0.001,
                                      "wait_for_subscribers": ["/clock", "joint_states", "~step_report"]},
                                     node_runner.quadruped_urdf())

    def tearDown(self):
        code = self.node.interrupt()
        for subscriber in self.subscribers:
            subscriber.unregister()
        self.assertEqual(0, code, self.node.stderr())

    def step(self, count):
        """Steps; right after the start the node may still wait for the subscribers."""
        call = service("step", Step)
        self.assertTrue(node_runner.wait_until(lambda: call(0).message != "waiting for subscribers"))
        return call(count)

    def test_time_never_runs_back(self):
        pause, reset = service("pause", Empty), service("reset", Empty)
        first_height = []
        for k in range(ROUNDS):
            pause()
            answer = self.step(STEPS)
            self.assertTrue(answer.success, answer.message)
            self.assertEqual((k + 1) * STEPS, answer.report.step)
            self.assertAlmostEqual((k + 1) * STEPS * 0.001, answer.report.header.stamp.to_sec(), places=9)
            first_height.append(answer.report.potential)
            reset()
        # Each round starts from the same state and so ends in the same state.
        self.assertEqual([first_height[0]] * ROUNDS, first_height)
        self.assertTrue(node_runner.wait_until(lambda: len(self.reports) >= ROUNDS * STEPS, 10.0))
        self.assertTrue(node_runner.wait_until(lambda: len(self.stamps) >= ROUNDS * STEPS + ROUNDS + 1, 10.0))
        self.assertEqual(list(range(1, ROUNDS * STEPS + 1)), [report.step for report in self.reports])
        # Steps have one stamp on all topics; beside them there is the state at the start and after each reset.
        steps = [report.header.stamp for report in self.reports]
        resets = [steps[(k + 1) * STEPS - 1] + rospy.Duration(0, 1) for k in range(ROUNDS)]
        self.assertEqual(self.stamps, sorted([rospy.Time(0, 1)] + steps + resets))
        self.assertFalse(self.stamps[0].is_zero())
        self.assertEqual(self.clocks, sorted(self.clocks))
        self.assertFalse(self.clocks[0].is_zero())

    def test_bad_requests_change_nothing(self):
        self.assertFalse(self.step(0).success)
        service("set_paused", SetBool)(False)
        answer = service("step", Step)(1)
        self.assertFalse(answer.success)
        self.assertIn("pause it first", answer.message)
        self.assertTrue(service("set_paused", SetBool)(True).success)
        before = self.step(1).report.step
        self.assertEqual(before + 1, self.step(1).report.step)

    def test_gazebo_names_pause_reset_and_restart_the_clock(self):
        service("unpause_physics", Empty)()
        self.assertTrue(node_runner.wait_until(lambda: len(self.reports) > 5))
        service("pause_physics", Empty)()
        service("reset_world", Empty)()
        going = self.step(1).report
        self.assertGreater(going.header.stamp.to_sec(), 0.005)
        service("reset_simulation", Empty)()
        again = self.step(1).report
        self.assertAlmostEqual(0.001, again.header.stamp.to_sec(), places=9)
        self.assertEqual(going.step + 1, again.step)
        self.assertEqual(going.potential, again.potential)


if __name__ == "__main__":
    rospy.init_node("stepping_test")
    rostest.rosrun("frictional_contact_sim", "stepping", SteppingTest)
