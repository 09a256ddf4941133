#!/usr/bin/env python3
"""Services of the running node: what they change is seen on the topics, refusals change nothing that is seen.

Physics of the handlers is in the tests of test/ros/*_services_test.cpp; here is what the node adds: the wire, tf, the clock,
processes that end, dynamic_reconfigure."""
import math
import os
import signal
import tempfile
import unittest

import rospy
import rostest
from dynamic_reconfigure.client import Client
from geometry_msgs.msg import Point, Pose, Quaternion, TransformStamped, Twist, Vector3, Wrench, WrenchStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

import node_runner
from frictional_contact_sim.msg import StepReport
from frictional_contact_sim.srv import (ApplyWrench, ClearWrenches, DumpFclib, GetInfo, GetLinkState, LoadState, SaveState,
                                        SetFriction, SetJointPositions, SetLinkState, SetSolver, Step)

NAN = float("nan")
MASS = 10.0  # of the box [kg]
STEP = 0.001  # [s]
FIELDS_OF_THE_WALL_CLOCK = ("real_time_factor", "solve_time")


def service(name, kind):
    rospy.wait_for_service(node_runner.NAME + "/" + name, node_runner.TIMEOUT)
    return rospy.ServiceProxy(node_runner.NAME + "/" + name, kind)


class ServicesTest(unittest.TestCase):
    """A box of 10 kg at rest on the ground, paused, and what it publishes."""

    def start(self, parameters=None, urdf=None):
        self.joint_states, self.reports, self.odometry, self.clocks = [], [], [], []
        self.node = node_runner.Node(dict({"start_paused": True, "time_step": STEP}, **(parameters or {})),
                                     urdf or node_runner.box_urdf())
        self.subscribers = [
            rospy.Subscriber("/joint_states", JointState, self.joint_states.append),
            rospy.Subscriber(node_runner.NAME + "/step_report", StepReport, self.reports.append),
            rospy.Subscriber(node_runner.NAME + "/ground_truth/odom", Odometry, self.odometry.append),
            rospy.Subscriber("/clock", Clock, lambda message: self.clocks.append(message.clock)),
        ]
        self.addCleanup(self.stop)
        self.step = service("step", Step)
        self.assertTrue(node_runner.wait_until(lambda: self.joint_states and self.odometry))

    def stop(self):
        for subscriber in self.subscribers:
            subscriber.unregister()
        if self.node.process.poll() is None:
            self.assertEqual(0, self.node.interrupt(), self.node.stderr())

    def steps(self, count):
        answer = self.step(count)
        self.assertTrue(answer.success, answer.message)
        return answer.report

    def speed(self):
        """Velocity of the box along x."""
        answer = service("get_link_state", GetLinkState)("", "", "")
        self.assertTrue(answer.success, answer.message)
        return answer.twist.linear.x

    def push(self, force, frame="world", duration=0.0):
        return service("apply_wrench", ApplyWrench)("", "box", frame, Wrench(Vector3(force, 0, 0), Vector3()), "",
                                                    Point(0, 0, -0.1), rospy.Time(0), rospy.Duration(duration))

    def test_a_push_slides_the_box_for_its_duration(self):
        self.start({"default_friction": 0.5})
        self.steps(100)
        self.assertTrue(self.push(100.0, duration=0.05).success)
        self.steps(50)
        expected = (100.0 / MASS - 0.5 * 9.81) * 0.05
        self.assertAlmostEqual(expected, self.speed(), places=6)
        self.steps(10)
        self.assertAlmostEqual(expected - 0.5 * 9.81 * 0.01, self.speed(), places=6)

    def test_friction_and_clearing_act_from_the_next_step_on(self):
        self.start({"default_friction": 0.8})
        self.steps(100)
        self.assertTrue(self.push(50.0).success)
        self.steps(10)
        self.assertAlmostEqual(0.0, self.speed(), places=9)
        self.assertTrue(service("set_friction", SetFriction)("robot", "ground", 0.2, NAN).success)
        self.steps(10)
        self.assertAlmostEqual((50.0 / MASS - 0.2 * 9.81) * 0.01, self.speed(), places=6)
        self.assertTrue(service("clear_wrenches", ClearWrenches)("", "").success)
        self.steps(10)
        self.assertAlmostEqual((50.0 / MASS - 0.4 * 9.81) * 0.01, self.speed(), places=6)

    def test_frames_of_tf_and_the_wrench_topic(self):
        self.start({"ground": False, "gravity": [0, 0, 0]})
        refusal = self.push(10.0, frame="camera")
        self.assertFalse(refusal.success)
        self.assertIn("frame_id: found 'camera'", refusal.message)
        # A camera that is mounted on the box, its x axis along the box's y axis.
        transform = TransformStamped(child_frame_id="camera")
        transform.header.frame_id = "box"
        transform.transform.rotation = Quaternion(0, 0, math.sin(math.pi / 4), math.cos(math.pi / 4))
        static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        static.publish(TFMessage([transform]))
        self.assertTrue(node_runner.wait_until(lambda: self.push(20.0, frame="camera", duration=0.01).success))
        self.steps(10)
        velocity = service("get_link_state", GetLinkState)("", "box", "").twist.linear
        self.assertAlmostEqual(20.0 / MASS * 0.01, velocity.y, places=9)
        self.assertAlmostEqual(0.0, velocity.x, places=9)

        wrench = WrenchStamped(wrench=Wrench(Vector3(0, 0, 30.0), Vector3()))
        wrench.header.frame_id = "box"
        topic = rospy.Publisher(node_runner.NAME + "/wrench", WrenchStamped, queue_size=10)
        self.assertTrue(node_runner.wait_until(lambda: topic.get_num_connections() > 0))
        topic.publish(wrench)
        self.assertTrue(node_runner.wait_until(lambda: self.steps(1).actuators > 0.0015))  # its 2 mJ were the push's
        wrench.header.frame_id = "nowhere"
        topic.publish(wrench)
        self.assertTrue(node_runner.wait_until(
            lambda: any("~wrench: message ignored" in line for line in self.node.lines("WARN"))))

    def test_set_state_is_shown_while_paused(self):
        self.start()
        self.steps(20)
        answer = service("set_link_state", SetLinkState)("", "", "", Pose(Point(1, 2, 3), Quaternion(0, 0, 0, 1)),
                                                         Twist(Vector3(0.5, 0, 0), Vector3()))
        self.assertTrue(answer.success, answer.message)
        # The stamp of the state is later than that of the last step.
        self.assertTrue(node_runner.wait_until(lambda: self.odometry[-1].header.stamp > rospy.Time(0, 20000000)))
        seen = self.odometry[-1]
        self.assertAlmostEqual(3.0, seen.pose.pose.position.z, places=12)
        self.assertAlmostEqual(0.5, seen.twist.twist.linear.x, places=12)
        self.assertEqual(sorted(self.clocks), self.clocks)

    def test_refusals_say_why_and_change_nothing(self):
        self.start({"dump_dir": tempfile.gettempdir()})
        self.steps(20)
        file = os.path.join(tempfile.mkdtemp(), "state")
        self.assertTrue(service("save_state", SaveState)(file).success)
        with open(file, "rb") as saved:
            before = saved.read()
        pose, twist = Pose(Point(), Quaternion(0, 0, 0, 1)), Twist()
        none, some = Wrench(), rospy.Duration(1.0)
        requests = [
            ("link", service("apply_wrench", ApplyWrench), ("", "lid", "", none, "", Point(), rospy.Time(), some)),
            ("nan", service("apply_wrench", ApplyWrench),
             ("", "box", "", Wrench(Vector3(NAN, 0, 0), Vector3()), "", Point(), rospy.Time(), some)),
            ("start", service("apply_wrench", ApplyWrench), ("", "box", "", none, "", Point(), rospy.Time(0.001), some)),
            ("duration", service("apply_wrench", ApplyWrench),
             ("", "box", "", none, "", Point(), rospy.Time(), rospy.Duration(-1))),
            ("body", service("clear_wrenches", ClearWrenches), ("nobody", "")),
            ("nothing was saved", service("load_state", LoadState), ("",)),
            ("cannot be read", service("load_state", LoadState), ("/no/such/file",)),
            ("cannot be written", service("save_state", SaveState), ("/no/such/folder/file",)),
            ("link", service("set_link_state", SetLinkState), ("", "lid", "", pose, twist)),
            ("orientation", service("set_link_state", SetLinkState), ("", "", "", Pose(), twist)),
            ("frame_id", service("get_link_state", GetLinkState), ("", "", "nowhere")),
            ("names", service("set_joint_positions", SetJointPositions), ("", ["hinge"], [0.0], [])),
            ("friction", service("set_friction", SetFriction), ("robot", "ground", -1.0, NAN)),
            ("expected a material", service("set_friction", SetFriction), ("robt", "ground", 0.5, NAN)),
            ("portfolio", service("set_solver", SetSolver), ("nosolver", 0.0, 0)),
            ("tolerance", service("set_solver", SetSolver), ("", -1.0, 0)),
            ("does not exist", service("dump_fclib", DumpFclib), (file, False)),
        ]
        for reason, call, arguments in requests:
            answer = call(*arguments)
            self.assertFalse(answer.success, reason)
            self.assertIn(reason, answer.message)
            self.assertNotIn("\n", answer.message)
        self.assertTrue(service("save_state", SaveState)(file).success)
        with open(file, "rb") as saved:
            self.assertEqual(before, saved.read())
        info = service("get_info", GetInfo)()
        self.assertTrue(info.paused)
        self.assertEqual(("portfolio", 1e-8, 20), (info.solver, info.tolerance, info.steps))

    def run_on(self, count):
        """Records of the next steps, without what the wall clock says."""
        last = self.steps(count).header.stamp
        for messages in (self.reports, self.joint_states):
            self.assertTrue(node_runner.wait_until(lambda some=messages: some and some[-1].header.stamp == last))
        for report in self.reports:
            report.header.seq = 0
            for field in FIELDS_OF_THE_WALL_CLOCK:
                setattr(report, field, 0.0)
        return ([(joint.header.stamp, joint.position, joint.velocity, joint.effort)
                 for joint in self.joint_states[-count:]], self.reports[-count:])

    def test_a_run_goes_on_to_the_bit_after_kill_9(self):
        parameters = {"hold_initial_position": True}
        self.start(parameters, node_runner.quadruped_urdf())
        self.steps(150)
        file = os.path.join(tempfile.mkdtemp(), "state")
        saved = service("save_state", SaveState)(file)
        self.assertTrue(saved.success, saved.message)
        self.assertEqual(rospy.Time(0, 150000000), saved.stamp)
        expected = self.run_on(100)
        self.node.process.send_signal(signal.SIGKILL)
        self.node.process.wait()
        self.stop()

        self.start(parameters, node_runner.quadruped_urdf())
        self.steps(7)  # whatever it did before
        loaded = service("load_state", LoadState)(file)
        self.assertTrue(loaded.success, loaded.message)
        self.assertEqual(saved.stamp, loaded.stamp)
        found = self.run_on(100)
        self.assertEqual(expected[0], found[0])
        self.assertEqual(expected[1], found[1])
        # Back to the same state once more: time goes on.
        self.assertTrue(service("load_state", LoadState)(file).success)
        again = self.run_on(100)
        self.assertEqual([record[1:] for record in expected[0]], [record[1:] for record in again[0]])
        self.assertEqual(rospy.Time(0, 350000000), again[0][-1][0])
        self.assertEqual(sorted(self.clocks), self.clocks)

    def test_settings_by_dynamic_reconfigure(self):
        self.start({"ground": False, "tolerance": 1e-9})
        client = Client(node_runner.NAME, timeout=node_runner.TIMEOUT)
        present = client.get_configuration(timeout=node_runner.TIMEOUT)
        self.assertEqual((STEP, 1e-9, "portfolio", -9.81, 0.8),
                         tuple(present[name] for name in ("time_step", "tolerance", "solver", "gravity_z",
                                                          "default_friction")))
        answer = client.update_configuration({"gravity_z": 0.0, "gravity_x": 2.0, "time_step": 0.002, "solver": "admm"})
        self.assertEqual((2.0, 0.0, 0.002, "admm"),
                         tuple(answer[name] for name in ("gravity_x", "gravity_z", "time_step", "solver")))
        report = self.steps(10)
        self.assertEqual(0.002, report.dt)
        self.assertAlmostEqual(0.020, report.header.stamp.to_sec(), places=9)
        self.assertAlmostEqual(2.0 * 0.020, self.speed(), places=12)
        self.assertAlmostEqual(0.0, report.balance_error, places=12)

        answer = client.update_configuration({"gravity_x": 5.0, "tolerance": -1.0})
        self.assertEqual((2.0, 1e-9), (answer["gravity_x"], answer["tolerance"]))
        self.assertTrue(any("tolerance" in line for line in self.node.lines("WARN")))
        self.assertTrue(service("set_solver", SetSolver)("gauss_seidel", 0.0, 0).success)
        self.assertTrue(node_runner.wait_until(
            lambda: client.get_configuration(timeout=node_runner.TIMEOUT)["solver"] == "gauss_seidel"))
        # The next node starts with its own parameters.
        self.assertEqual(0, self.node.interrupt(), self.node.stderr())
        self.stop()
        client.close()
        self.start({"ground": False})
        info = service("get_info", GetInfo)()
        self.assertEqual(("portfolio", STEP, 1e-8), (info.solver, info.time_step, info.tolerance))
        self.assertEqual([], [line for line in self.node.lines("WARN") if "parameter" in line])


if __name__ == "__main__":
    rospy.init_node("services_test")
    rostest.rosrun("frictional_contact_sim", "services", ServicesTest)
