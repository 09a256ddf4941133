#!/usr/bin/env python3
"""Two runs give the same bits, also when the machine is busy with something else."""
import hashlib
import io
import subprocess
import unittest

import rospy
import rostest
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState

import node_runner
from frictional_contact_sim.msg import ContactArray, StepReport

STEPS = 400  # 0.4 s: the quadruped drops 1 mm onto its feet and sinks into its joints


def digest(message):
    """Of all bytes of a message but wall-clock times."""
    if isinstance(message, StepReport):
        message.real_time_factor = message.solve_time = 0.0
    buffer = io.BytesIO()
    message.serialize(buffer)
    return hashlib.sha256(buffer.getvalue()).hexdigest()


class DeterminismTest(unittest.TestCase):
    def run_once(self):
        digests = {}
        topics = {"/joint_states": JointState, node_runner.NAME + "/contacts": ContactArray,
                  node_runner.NAME + "/step_report": StepReport, node_runner.NAME + "/ground_truth/odom": Odometry}
        subscribers = [rospy.Subscriber(topic, kind, lambda message, key: digests[key].append(digest(message)), topic)
                       for topic, kind in topics.items() if digests.setdefault(topic, []) == []]
        node = node_runner.Node({"num_steps": STEPS, "real_time_factor": 0.0, "hold_initial_position": True,
                                 "wait_for_subscribers": list(topics)}, node_runner.quadruped_urdf())
        code = node.wait()
        complete = node_runner.wait_until(lambda: all(len(found) >= STEPS for found in digests.values()), 10.0)
        for subscriber in subscribers:
            subscriber.unregister()
        self.assertEqual(0, code, node.stderr())
        self.assertTrue(complete, {topic: len(found) for topic, found in digests.items()})
        return digests

    def test_runs_give_the_same_bits_whatever_the_load(self):
        first = self.run_once()
        load = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(2)]
        try:
            second = self.run_once()
        finally:
            for process in load:
                process.kill()
                process.wait()
        for topic, digests in first.items():
            self.assertEqual(STEPS, len(digests))
            self.assertEqual(digests, second[topic], topic)


if __name__ == "__main__":
    rospy.init_node("determinism_test")
    rostest.rosrun("frictional_contact_sim", "determinism", DeterminismTest)
