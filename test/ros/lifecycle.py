#!/usr/bin/env python3
"""Start and end of the node: bad input gives one clear line and exit code 2; an interrupt ends it at once."""
import os
import tempfile
import time
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Empty
from frictional_contact_sim.msg import StepReport

import node_runner

BAD_INPUT = 2
LINK = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
TWO_ROOTS = '<robot name="r">' + LINK.format("a") + LINK.format("b") + "</robot>"
NEGATIVE_MASS = '<robot name="r">' + LINK.format("a").replace('mass value="1"', 'mass value="-1"') + "</robot>"
UNKNOWN_MESH = '<robot name="r">' + LINK.format("a").replace(
    "</link>", '<collision><geometry><mesh filename="file:///nowhere/no.stl"/></geometry></collision></link>') + "</robot>"

BOX = None  # the 10 kg box, which is good
# name: (parameters, robot_description, what the line must say)
BAD = {
    "no robot": ({}, "", ["robot_description", "~scenario"]),
    "missing scenario": ({"scenario": "/nowhere/scenario.yaml"}, BOX, ["/nowhere/scenario.yaml"]),
    "broken XML": ({}, "<robot name='r'><link name='a'>", ["robot_description"]),
    "two roots": ({}, TWO_ROOTS, ["root"]),
    "negative mass": ({}, NEGATIVE_MASS, ["'a'", "-1"]),
    "unknown mesh": ({}, UNKNOWN_MESH, ["/nowhere/no.stl"]),
    "unknown solver": ({"solver": "oracle"}, BOX, ["~solver", "oracle", "portfolio"]),
    "wrong type": ({"time_step": "fast"}, BOX, ["~time_step", "'fast'", "number"]),
    "number for boolean": ({"start_paused": 3}, BOX, ["~start_paused", "3", "true or false"]),
    "negative friction": ({"default_friction": -0.5}, BOX, ["~default_friction", "-0.5", ">= 0"]),
    "time step of no nanosecond": ({"time_step": 1e-12}, BOX, ["~time_step", "1e-12", "1e-09"]),
    "time step beyond time": ({"time_step": 1e300}, BOX, ["~time_step", "1e+300", "1000"]),
    "negative hold": ({"hold_limit": -1.0}, BOX, ["~hold_limit", "-1", ">= 0"]),
    "unknown lossless topic": ({"lossless_topics": ["~markers"]}, BOX, ["~lossless_topics", "markers", "contacts"]),
    "zero time step": ({"time_step": 0.0}, BOX, ["~time_step", "[1e-09, 1000]"]),
    "short gravity": ({"gravity": [0.0, -9.81]}, BOX, ["~gravity", "3"]),
    "unknown base": ({"base": "flying"}, BOX, ["~base", "flying", "floating"]),
    "unknown policy": ({"on_failure": "explode"}, BOX, ["~on_failure", "explode", "hold"]),
    "unwritable bag folder": ({"bag": "/nowhere/run.bag"}, BOX, ["~bag", "/nowhere"]),
    "unwritable dump folder": ({"dump_dir": "/proc"}, BOX, ["~dump_dir", "/proc"]),
    "unknown topic": ({"wait_for_subscribers": ["~forces"]}, BOX, ["~wait_for_subscribers", "forces"]),
    "unknown joint": ({"initial_joint_positions": {"elbow": 0.1}}, BOX, ["elbow"]),
}


class LifecycleTest(unittest.TestCase):
    def test_bad_input_gives_one_line_and_exit_code_2(self):
        for name, (parameters, document, words) in BAD.items():
            with self.subTest(name):
                node = node_runner.Node(parameters, node_runner.box_urdf() if document is None else document)
                code = node.wait(20.0)
                fatal = node.lines("FATAL")
                self.assertEqual(BAD_INPUT, code, node.stderr())
                self.assertEqual(1, len(fatal), node.stderr())
                for word in words:
                    self.assertIn(word, fatal[0])
                self.assertNotIn("terminate", node.stderr())

    def test_unknown_parameters_are_named(self):
        node = node_runner.Node({"num_steps": 3, "tolerence": 1e-9}, node_runner.box_urdf())
        self.assertEqual(0, node.wait(), node.stderr())
        self.assertIn("~tolerence", " ".join(node.lines("WARN")))

    def test_steps_that_fail_one_after_another_flood_neither_log_nor_disk(self):
        with tempfile.TemporaryDirectory() as folder:
            # One iteration and a tolerance below round-off: every step with a contact fails.
            node = node_runner.Node({"on_failure": "hold", "solver": "gauss_seidel", "max_iterations": 1,
                                     "tolerance": 1e-30, "dump_dir": folder, "max_dumps": 3, "num_steps": 500,
                                     "real_time_factor": 0.0}, node_runner.box_urdf())
            self.assertEqual(0, node.wait(), node.stderr())
            self.assertEqual(3, len(os.listdir(folder)), node.stderr())
        warnings = node.lines("WARN")
        failures = [line for line in warnings if " step " in line]
        self.assertTrue(1 <= len(failures) <= 10, node.stderr())  # a line a second; the run takes a fraction of one
        self.assertEqual(1, len([line for line in warnings if "~max_dumps" in line]), node.stderr())
        hidden = [int(line.split(": ")[-1]) for line in warnings if "not shown" in line]
        self.assertGreater(len(failures) + sum(hidden), 400, node.stderr())  # it falls for some 15 steps before

    def test_stop_ends_it_with_exit_code_1_and_pause_tries_again(self):
        hopeless = {"solver": "gauss_seidel", "max_iterations": 1, "tolerance": 1e-30, "real_time_factor": 0.0}
        node = node_runner.Node(dict(hopeless), node_runner.box_urdf())
        self.assertEqual(1, node.wait(), node.stderr())
        self.assertEqual(1, len([line for line in node.lines("WARN") if " step " in line]), node.stderr())
        reports = []
        subscriber = rospy.Subscriber(node_runner.NAME + "/step_report", StepReport, reports.append)
        node = node_runner.Node(dict(hopeless, on_failure="pause", wait_for_subscribers=["~step_report"]),
                                node_runner.box_urdf())
        failed = lambda: [report.step for report in reports if report.status != StepReport.CONVERGED]
        self.assertTrue(node_runner.wait_until(failed), node.stderr())
        rospy.wait_for_service(node_runner.NAME + "/unpause", node_runner.TIMEOUT)
        rospy.ServiceProxy(node_runner.NAME + "/unpause", Empty)()
        self.assertTrue(node_runner.wait_until(lambda: len(failed()) >= 2), node.stderr())
        self.assertEqual(failed()[0], failed()[1])  # the same step again
        self.assertEqual(0, node.interrupt(), node.stderr())
        subscriber.unregister()

    def test_interrupt_ends_it_at_once(self):
        for parameters in ({}, {"start_paused": True}, {"real_time_factor": 0.0}):
            with self.subTest(str(parameters)):
                node = node_runner.Node(parameters, node_runner.box_urdf())
                rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
                start = time.monotonic()
                self.assertEqual(0, node.interrupt(), node.stderr())
                self.assertLess(time.monotonic() - start, 5.0)  # a fraction of a second on an idle machine

    def test_bad_commands_are_ignored_as_a_whole_with_a_warning(self):
        states = []
        subscriber = rospy.Subscriber("/joint_states", JointState, states.append)
        # The servos' limit of zero does not concern commands for effort.
        node = node_runner.Node({"base": "fixed", "gravity": [0.0, 0.0, 0.0], "ground": False,
                                 "servo_gains": {"default": {"max_effort": 0.0}},
                                 "wait_for_subscribers": ["joint_states"]}, node_runner.quadruped_urdf())
        name = node_runner.NAME + "/command/"
        effort = rospy.Publisher(name + "effort", JointState, queue_size=10)
        array = rospy.Publisher(name + "effort_array", Float64MultiArray, queue_size=10)
        self.assertTrue(node_runner.wait_until(
            lambda: states and effort.get_num_connections() > 0 and array.get_num_connections() > 0))
        effort.publish(JointState(name=["LF_HAA", "LF_HFE"], effort=[1.0, float("nan")]))
        effort.publish(JointState(name=["LF_HAA", "no_such_joint"], effort=[1.0, 1.0]))
        effort.publish(JointState(name=["LF_HAA", "LF_HFE"], effort=[1.0]))
        array.publish(Float64MultiArray(data=[1.0]))
        self.assertTrue(node_runner.wait_until(lambda: len(node.lines("WARN")) >= 4), node.stderr())
        count = len(states)
        self.assertTrue(node_runner.wait_until(lambda: len(states) > count + 10))
        # Without gravity and command nothing has moved: not one number of the bad commands was taken.
        self.assertEqual({0.0}, set(states[-1].position) | set(states[-1].velocity))
        effort.publish(JointState(name=["LF_HAA"], effort=[1.0]))
        self.assertTrue(node_runner.wait_until(lambda: states[-1].velocity[states[-1].name.index("LF_HAA")] > 0.0))
        subscriber.unregister()
        self.assertEqual(0, node.interrupt(), node.stderr())


if __name__ == "__main__":
    rospy.init_node("lifecycle_test")
    rostest.rosrun("frictional_contact_sim", "lifecycle", LifecycleTest)
