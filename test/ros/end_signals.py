#!/usr/bin/env python3
"""SIGINT and SIGTERM end node and recorder in order, with a master and without one, in a long step too."""
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import rosbag
import rospy
import rostest

import node_runner
from nonsense import hang
from raw_subscriber import RawSubscriber

LIMIT = 20.0  # hung beyond it; ends take a fraction of a second on an idle machine [s]
SIGNALS = (signal.SIGINT, signal.SIGTERM)
TOWER = """
solver: {{name: gauss_seidel, tolerance: 1.0e-300, max_iterations: 100000000}}
failure: {{fallback: false}}
ground:
bodies:
{bodies}
"""
CUBE = "  - {{name: cube{0}, urdf: {1}, pose: {{xyz: [0, 0, {2}], rpy: [0, 0, 0]}}}}\n"


def free_port():
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


class EndSignalsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.bag = os.path.join(self.folder.name, "run.bag")

    def tearDown(self):
        self.folder.cleanup()

    def run_program(self, *arguments, **environment):
        log = open(os.path.join(self.folder.name, "log.txt"), "w+")
        return subprocess.Popen(["rosrun", "frictional_contact_sim", *arguments], stderr=log, stdout=log,
                                env=dict(os.environ, **environment)), log

    def end(self, process, number):
        process.send_signal(number)
        try:
            return process.wait(LIMIT)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return None

    def text(self, log):
        log.flush()
        return pathlib.Path(log.name).read_text()

    def test_without_a_master(self):
        for arguments in (["simulator_node"], ["record_bag", self.bag, "/joint_states"]):
            for number in SIGNALS:
                with self.subTest(f"{arguments[0]} {number.name}"):
                    process, log = self.run_program(*arguments, ROS_MASTER_URI=f"http://localhost:{free_port()}")
                    self.assertTrue(node_runner.wait_until(lambda: "waiting for the master" in self.text(log)))
                    self.assertEqual(0, self.end(process, number), self.text(log))
                    self.assertNotIn("FATAL", self.text(log))
        self.assertFalse(os.path.exists(self.bag + ".active"))

    def test_without_an_answer_of_the_master(self):
        with socket.socket() as silent:  # takes connections, says nothing
            silent.bind(("localhost", 0))
            silent.listen(20)
            for arguments in (["simulator_node"], ["record_bag", self.bag, "/joint_states"]):
                for number in SIGNALS:
                    with self.subTest(f"{arguments[0]} {number.name}"):
                        process, log = self.run_program(
                            *arguments, ROS_MASTER_URI="http://localhost:%d" % silent.getsockname()[1])
                        self.assertTrue(node_runner.wait_until(lambda: "waiting for the master" in self.text(log)))
                        self.assertEqual(0, self.end(process, number), self.text(log))

    def test_node_and_recorder_end_in_order_with_all_messages_of_all_steps(self):
        topics = ["/joint_states"] + [node_runner.NAME + "/" + name for name in ("contacts", "step_report")]
        for number in SIGNALS:
            with self.subTest(number.name):
                recorder, log = self.run_program("record_bag", self.bag, *topics)
                node = node_runner.Node({"real_time_factor": 0.0, "wait_for_subscribers": topics},
                                        node_runner.quadruped_urdf())
                active = pathlib.Path(self.bag + ".active")
                self.assertTrue(node_runner.wait_until(lambda: active.exists() and active.stat().st_size > 1000000))
                self.assertEqual(0, self.end(node.process, number), node.stderr())
                self.assertEqual(0, self.end(recorder, number), self.text(log))
                steps = {topic: [] for topic in topics}
                with rosbag.Bag(self.bag) as reader:
                    for topic, message, _ in reader.read_messages():
                        steps[topic].append(round(message.header.stamp.to_sec() * 1000))
                count = len(steps[topics[0]])
                self.assertGreater(count, 500)
                for topic in topics:
                    self.assertEqual(list(range(1, count + 1)), steps[topic], topic)

    def test_a_long_step_is_ended(self):
        scenario = os.path.join(self.folder.name, "tower.yaml")
        urdf = node_runner.PACKAGE_DIR / "test/ros/box_10kg.urdf"
        bodies = "".join(CUBE.format(k, urdf, 0.1 + 0.2 * k) for k in range(40))
        pathlib.Path(scenario).write_text(TOWER.format(bodies=bodies))
        for number in SIGNALS:
            with self.subTest(number.name):
                node = node_runner.Node({"scenario": scenario, "real_time_factor": 0.0})
                self.addCleanup(node.process.kill)
                rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
                time.sleep(2.0)
                self.assertIsNone(node.process.poll(), node.stderr())
                self.assertEqual(0, self.end(node.process, number), node.stderr())

        node = node_runner.Node({"scenario": scenario, "real_time_factor": 0.0})
        self.addCleanup(node.process.kill)
        rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
        time.sleep(2.0)
        subprocess.run(["rosnode", "kill", node_runner.NAME], stdout=subprocess.DEVNULL, timeout=LIMIT, check=True)
        self.assertEqual(0, node.wait(LIMIT), node.stderr())

    def test_a_second_signal_ends_it_at_once(self):
        for number in SIGNALS:
            with self.subTest(number.name):
                # At its end the node waits for a subscriber that does not answer, for two minutes.
                node = node_runner.Node({"lossless_topics": ["joint_states"], "hold_limit": 120.0},
                                        node_runner.box_urdf())
                self.addCleanup(node.process.kill)
                rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
                subscriber = RawSubscriber("/hangs", "/joint_states", hang, delay=None)
                time.sleep(1.0)  # something is sent to it
                node.process.send_signal(signal.SIGINT)
                time.sleep(3.0)
                self.assertIsNone(node.process.poll(), node.stderr())
                self.assertEqual(-number, self.end(node.process, number), node.stderr())
                subscriber.close()


if __name__ == "__main__":
    rospy.init_node("end_signals_test")
    rostest.rosrun("frictional_contact_sim", "end_signals", EndSignalsTest)
