#!/usr/bin/env python3
"""Bodies that come, are held, and go: ~robots, ~spawn, ~attach, ~detach, ~delete in a paused node, stepped by ~step."""
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

import node_runner
from frictional_contact_sim.msg import Bodies, ContactArray
from frictional_contact_sim.srv import Attach, Delete, Detach, Spawn, Step

NODE = node_runner.NAME
GRAVITY = 9.81
CRANE = """<robot name='crane'><link name='world'/><link name='hook'><inertial><mass value='5'/>
<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>
<joint name='hoist' type='prismatic'><parent link='world'/><child link='hook'/><origin xyz='0 0 0.5'/><axis xyz='0 0 1'/>
<limit lower='-1' upper='2' effort='1000' velocity='10'/></joint></robot>"""
BALL = """<robot name='ball'><link name='core'><inertial><mass value='2'/>
<inertia ixx='0.008' ixy='0' ixz='0' iyy='0.008' iyz='0' izz='0.008'/></inertial>
<collision><geometry><sphere radius='0.1'/></geometry></collision></link></robot>"""
LEG = """<robot name='leg'><link name='hip'><inertial><mass value='1'/>
<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>
<link name='foot'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial>
</link><joint name='knee' type='revolute'><parent link='hip'/><child link='foot'/><axis xyz='0 1 0'/>
<limit lower='-2' upper='2' effort='50' velocity='10'/></joint></robot>"""


def pose(x, y, z):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))


def call(service, kind, *arguments, **fields):
    rospy.wait_for_service(NODE + "/" + service, node_runner.TIMEOUT)
    return rospy.ServiceProxy(NODE + "/" + service, kind)(*arguments, **fields)


def step(count):
    answer = call("step", Step, count)
    assert answer.success, answer.message
    return answer.report


def now(topic, kind):
    """The present state, as a paused node shows it to who comes: to one subscriber of a process, so there is no other."""
    return rospy.wait_for_message(topic, kind, node_runner.TIMEOUT)


def height(body):
    return now(f"{NODE}/ground_truth/{body}odom", Odometry).pose.pose.position.z


def topics():
    return {topic for topic, _ in rospy.get_published_topics()}


class WorldTest(unittest.TestCase):
    def start(self, parameters, robot_description=None):
        self.node = node_runner.Node(dict({"start_paused": True}, **parameters), robot_description)
        rospy.wait_for_service(NODE + "/delete", node_runner.TIMEOUT)

    def tearDown(self):
        self.assertEqual(0, self.node.interrupt(), self.node.stderr())

    def state(self):
        joints = now("/joint_states", JointState)
        return (joints.header.stamp, joints.name, joints.position, joints.velocity,
                now(NODE + "/ground_truth/odom", Odometry).pose, topics())

    def refused(self, text, service, kind, *arguments, **fields):
        """With the reason in one line."""
        answer = call(service, kind, *arguments, **fields)
        self.assertFalse(answer.success, text)
        self.assertIn(text, answer.message)
        self.assertNotIn("\n", answer.message)

    def test_a_ball_is_spawned_lifted_dropped_and_deleted(self):
        self.start({"hold_initial_position": True}, CRANE)
        records = []
        listener = rospy.Subscriber("/joint_states", JointState, records.append)
        node_runner.wait_until(lambda: len(records) == 1)
        worlds = []  # for those who draw or record it
        rospy.Subscriber(NODE + "/bodies", Bodies, worlds.append)
        self.assertTrue(node_runner.wait_until(lambda: len(worlds) == 1))
        self.assertEqual(([CRANE], [""], 0.0), (worlds[0].urdfs, worlds[0].folders, worlds[0].ground_height))
        answer = call("spawn", Spawn, name="ball", urdf=BALL, pose=pose(1, 0, 1.5), twist=Twist(Vector3(0, 0, 0), Vector3()))
        self.assertTrue(answer.success, answer.message)
        self.assertIn(NODE + "/ground_truth/ball/odom", topics())
        self.assertTrue(node_runner.wait_until(lambda: len(worlds) == 2))
        self.assertEqual((worlds[0].names + ["ball"], [CRANE, BALL]), (worlds[1].names, worlds[1].urdfs))
        self.assertEqual({"ball/core"}, {part.child_frame_id for part in now("/tf", TFMessage).transforms})
        step(100)
        self.assertAlmostEqual(1.5 - 0.5 * GRAVITY * 0.01, height("ball/"), delta=1e-6)
        # Those who listened before the spawn have missed nothing, and the connection is the old one.
        self.assertTrue(node_runner.wait_until(lambda: len(records) == 102), len(records))
        self.assertEqual([1000000 * k for k in range(1, 101)], [r.header.stamp.to_nsec() for r in records[2:]])
        self.assertEqual([["hoist"]] * 102, [r.name for r in records])

        listener.unregister()

        step(1000)  # it has landed
        contacts = now(NODE + "/contacts", ContactArray).contacts
        self.assertAlmostEqual(2 * GRAVITY, sum(c.force.z for c in contacts), delta=1e-6)
        self.assertEqual({"ball"}, {c.body_a for c in contacts})
        answer = call("attach", Attach, body_a="ball", link_a="core", body_b="", link_b="hook")
        self.assertTrue(answer.success, answer.message)
        start = now("/joint_states", JointState).position[0]  # the servo gives way a little
        self.assertAlmostEqual(0.1 - (0.5 + start), answer.pose.position.z, delta=1e-6)
        publisher = rospy.Publisher(NODE + "/command/position", JointState, queue_size=1)
        node_runner.wait_until(lambda: publisher.get_num_connections() == 1)
        publisher.publish(JointState(name=["hoist"], position=[1.0]))
        rospy.rostime.wallsleep(0.3)
        step(3000)
        hook = now("/joint_states", JointState).position[0]
        self.assertAlmostEqual(0.1 + hook - start, height("ball/"), delta=1e-6)
        self.assertGreater(hook, 0.8)
        self.assertEqual([], now(NODE + "/contacts", ContactArray).contacts)
        effort = now("/joint_states", JointState).effort[0]
        self.assertAlmostEqual(7 * GRAVITY, effort, delta=0.1)  # the crane carries the ball

        self.assertTrue(call("detach", Detach, body_a="", link_a="hook", body_b="ball", link_b="core").success)
        held = height("ball/")
        step(100)
        self.assertAlmostEqual(held - 0.5 * GRAVITY * 0.01, height("ball/"), delta=1e-4)
        self.refused("are not welded", "detach", Detach, link_a="hook", link_b="ball/core")

        listener = rospy.Subscriber("/joint_states", JointState, records.append)
        node_runner.wait_until(lambda: len(records) == 103)
        self.assertTrue(call("delete", Delete, "ball").success)
        self.assertNotIn(NODE + "/ground_truth/ball/odom", topics())
        self.assertTrue(node_runner.wait_until(lambda: len(worlds) == 3))
        self.assertEqual(worlds[0].names, worlds[2].names)
        step(10)
        self.assertTrue(node_runner.wait_until(lambda: len(records) == 114), len(records))
        self.assertEqual({("hoist",)}, {tuple(r.name) for r in records[102:]})
        listener.unregister()

    def test_what_cannot_be_done_is_refused(self):
        self.start({}, node_runner.box_urdf())
        body = now(NODE + "/ground_truth/odom", Odometry).child_frame_id
        before = self.state()
        place = dict(urdf=BALL, pose=pose(3, 0, 1))
        self.refused("name: found ''", "spawn", Spawn, name="", **place)
        self.refused("name: found 'a/b'", "spawn", Spawn, name="a/b", **place)
        self.refused("name: found 'robot', expected one that no body has", "spawn", Spawn, name="robot", **place)
        self.refused("urdf, description: found neither", "spawn", Spawn, name="ball", pose=pose(3, 0, 1))
        self.refused("description: found 'nowhere'", "spawn", Spawn, name="ball", description="nowhere")
        self.refused("robot_description", "spawn", Spawn, name="ball", urdf="<robot name='x'>", pose=pose(3, 0, 1))
        self.refused("base: found 'loose', expected auto, floating or fixed", "spawn", Spawn, name="ball", base="loose", **place)
        self.refused("expected a finite number", "spawn", Spawn, name="ball", urdf=BALL, pose=pose(float("nan"), 0, 1))
        self.refused("quaternion of length", "spawn", Spawn, name="ball", urdf=BALL,
                     pose=Pose(Point(3, 0, 1), Quaternion(0, 0, 0, 2)))
        self.refused("frame_id: found 'moon'", "spawn", Spawn, name="ball", frame_id="moon", **place)
        self.refused("unknown joint", "spawn", Spawn, name="ball", joint_names=["knee"], joint_positions=[1.0], **place)
        self.refused("joint_positions: found 0, expected one a name", "spawn", Spawn, name="ball", joint_names=["knee"], **place)
        self.refused("deep in", "spawn", Spawn, name="ball", urdf=BALL, pose=pose(0, 0, 0.1))
        self.refused("deep in the ground, expected a free place", "spawn", Spawn, name="ball", urdf=BALL, pose=pose(3, 0, 0))
        self.refused("name: found 'rob'", "delete", Delete, "rob")
        self.refused("body_a: found 'rob'", "attach", Attach, body_a="rob", link_a=body, body_b="world")
        self.refused("link_a: found 'nothing'", "attach", Attach, link_a="nothing", body_b="world")
        self.refused("one rigid thing already", "attach", Attach, link_a=body, link_b=body)
        self.refused("one rigid thing already", "attach", Attach, body_a="world", body_b="world")
        self.assertEqual(before, self.state())
        self.assertTrue(call("attach", Attach, link_a=body, body_b="world").success)
        self.refused("are welded already", "attach", Attach, body_a="world", link_b=body)

    def test_a_spawned_leg_has_names_of_its_own_and_goes_back_to_its_place(self):
        rospy.set_param("/leg_description", LEG)
        self.start({}, LEG)
        self.assertEqual(["knee"], now("/joint_states", JointState).name)
        answer = call("spawn", Spawn, name="second", description="leg_description", pose=pose(0, 2, 1),
                      joint_names=["knee"], joint_positions=[0.5], hold_initial_position=True)
        self.assertTrue(answer.success, answer.message)
        joints = now("/joint_states", JointState)
        self.assertEqual(["knee", "second/knee"], joints.name)  # that of the first has not changed
        self.assertEqual(0.5, joints.position[1])
        own = now("/second/joint_states", JointState)
        self.assertEqual((["knee"], (0.5,)), (own.name, own.position))
        self.assertEqual("second/hip", now(NODE + "/ground_truth/second/odom", Odometry).child_frame_id)
        answer = call("spawn", Spawn, name="ball", frame_id="second/hip", urdf=BALL, pose=pose(1, 0, 1))
        self.assertTrue(answer.success, answer.message)
        placed = now(NODE + "/ground_truth/ball/odom", Odometry).pose.pose.position
        self.assertEqual((1, 2, 2), (placed.x, placed.y, placed.z))
        step(300)
        self.assertLess(height("second/"), 0.7)
        call("reset", Empty)
        self.assertEqual(1.0, height("second/"))
        self.assertEqual(2.0, height("ball/"))
        self.assertEqual(0.5, now("/joint_states", JointState).position[1])
        # The first body may go too: names and topics of the others stay.
        self.assertTrue(call("delete", Delete, "robot").success)
        self.assertEqual(["second/knee"], now("/joint_states", JointState).name)
        self.assertEqual(1.0, height("second/"))
        self.assertTrue(call("delete", Delete, "second").success)
        self.assertTrue(call("delete", Delete, "ball").success)
        step(10)
        self.assertEqual([], now("/joint_states", JointState).name)
        self.assertTrue(call("spawn", Spawn, name="ball", urdf=BALL).success)  # without a pose: on the ground
        self.assertAlmostEqual(0.101, height("ball/"), delta=1e-12)

    def test_two_robots_and_the_bodies_of_a_scenario(self):
        rospy.set_param("/leg_description", LEG)
        self.start({"scenario": "resting_box",
                    "robots": {"left": {"description": "leg_description", "pose": [2, 1, 1, 0, 0, 0], "base": "fixed"},
                               "right": {"description": LEG, "pose": {"xyz": [2, -1, 1]},
                                         "joints": {"knee": {"position": 0.25}}}}})
        joints = now("/joint_states", JointState)
        self.assertEqual(["left/knee", "right/knee"], joints.name)
        self.assertEqual((0.0, 0.25), joints.position)
        self.assertEqual(["knee"], now("/right/joint_states", JointState).name)
        for topic, frame in (("/tf_static", "left/hip"), ("/tf", "right/hip")):  # the first never moves
            self.assertIn(frame, {part.child_frame_id for part in now(topic, TFMessage).transforms})
        step(200)
        self.assertEqual(1.0, height("left/"))  # its base is fixed
        self.assertAlmostEqual(1.0 - 0.5 * GRAVITY * 0.04, height("right/"), delta=0.02)
        self.assertIn(NODE + "/ground_truth/odom", topics())  # the scenario's first body

    def test_a_robot_that_cannot_be_read_is_one_line(self):
        for robots, text in (({"left": {"pose": [0, 0, 0, 0, 0, 0]}}, "description"),
                             ({"a b": {"description": LEG}}, "expected a letter, then letters, digits and _")):
            node = node_runner.Node({"robots": robots})
            self.assertEqual(2, node.wait(), node.stderr())
            lines = node.lines("FATAL") + node.lines("ERROR")
            self.assertEqual(1, len(lines), node.stderr())
            self.assertIn("robots", lines[0])
            self.assertIn(text, lines[0])
        self.node = node_runner.Node({"start_paused": True}, LEG)  # for tearDown
        rospy.wait_for_service(NODE + "/delete", node_runner.TIMEOUT)


if __name__ == "__main__":
    rospy.init_node("world_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "world", WorldTest)
