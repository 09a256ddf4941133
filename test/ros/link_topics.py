#!/usr/bin/env python3
"""Topics of single links and joints, sensors, transforms and diagnostics of a running node."""
import math
import tempfile
import unittest

import genpy.dynamic
import rospy
import rostest
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import Imu, JointState
from std_srvs.srv import Empty, SetBool

import node_runner
from frictional_contact_sim.msg import ContactArray
from frictional_contact_sim.srv import Step

G = 9.81
FEET = ["LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT"]


def call(name, kind, *arguments):
    rospy.wait_for_service(node_runner.NAME + "/" + name, node_runner.TIMEOUT)
    return rospy.ServiceProxy(node_runner.NAME + "/" + name, kind)(*arguments)


def decoded(raw):
    """Debian has no Python classes of some of the messages: they are made from what the publisher says."""
    kind = raw._connection_header["type"]
    message = genpy.dynamic.generate_dynamic(kind, raw._connection_header["message_definition"])[kind]()
    return message.deserialize(raw._buff)


def xyz(vector):
    return [vector.x, vector.y, vector.z]


def scenario(text):
    file = tempfile.NamedTemporaryFile(mode="w", suffix=".yaml")
    file.write(text.replace("PACKAGE", str(node_runner.PACKAGE_DIR)))
    file.flush()
    return file


class Listener:
    """All messages of some topics, after the node has seen the subscriptions."""

    def __init__(self, topics):
        self.messages = {topic: [] for topic in topics}
        self.subscribers = [rospy.Subscriber(topic if topic[0] == "/" else node_runner.NAME + "/" + topic, kind,
                                             self.messages[topic].append, queue_size=100000)
                            for topic, kind in topics.items()]
        if not node_runner.wait_until(lambda: all(s.get_num_connections() > 0 for s in self.subscribers), 20.0):
            raise AssertionError("not advertised: %s" % sorted(topics))

    def step(self, n, topic):
        """Steps the paused node. The messages of one topic, which gets one a step."""
        known = len(self.messages[topic])
        response = call("step", Step, n)
        if not response.success or not node_runner.wait_until(lambda: len(self.messages[topic]) >= known + n, 20.0):
            raise AssertionError(f"{response.message} {len(self.messages[topic]) - known} of {n}")
        return self.messages[topic]

    def close(self):
        for subscriber in self.subscribers:
            subscriber.unregister()


class NodeTest(unittest.TestCase):
    def start(self, parameters, robot=None):
        self.node = node_runner.Node({"start_paused": True, **parameters}, robot)
        rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
        self.listeners = []

    def listen(self, topics):
        self.listeners.append(Listener(topics))
        return self.listeners[-1]

    def stop(self):
        for listener in self.listeners:
            listener.close()
        self.listeners = []
        node, self.node = self.node, None
        if node is not None:
            self.assertEqual(0, node.interrupt(), node.stderr())

    def tearDown(self):
        self.stop()


class LinkTopicsTest(NodeTest):
    def test_a_standing_quadruped_is_carried_by_its_feet_and_its_joints_by_their_drives(self):
        self.start({"hold_initial_position": True, "tolerance": 1e-11,
                    "initial_joint_positions": {leg + joint: angle for leg in ("LF", "RF", "LH", "RH")
                                                for joint, angle in (("_HFE", 0.6), ("_KFE", -1.2))}},
                   node_runner.quadruped_urdf())
        call("step", Step, 1500)
        wrenches = {f"wrench/{foot}": WrenchStamped for foot in FEET}
        bumpers = {f"contacts/{foot}": ContactArray for foot in FEET}
        joints = {f"joint_wrench/{joint}": WrenchStamped for joint in ("LF_KFE", "LF_ANKLE")}
        listener = self.listen({**wrenches, **bumpers, **joints, "/joint_states": JointState, "contacts": ContactArray})
        known = {topic: len(messages) for topic, messages in listener.messages.items()}
        listener.step(1, "/joint_states")
        self.assertTrue(node_runner.wait_until(
            lambda: all(len(m) > known[t] for t, m in listener.messages.items()), 10.0))
        last = {topic: messages[-1] for topic, messages in listener.messages.items()}
        stamps = {message.header.stamp for message in last.values()}
        self.assertEqual({rospy.Time(1, 501000000)}, stamps)
        # The feet hang on the shanks: what the ground gives to one is in its own axes, its length is in any.
        every = sum(contact.force.z for contact in last["contacts"].contacts)
        for foot in FEET:
            message = last[f"wrench/{foot}"]
            self.assertEqual(foot, message.header.frame_id)
            contacts = last[f"contacts/{foot}"].contacts
            self.assertTrue(all(c.link_a == foot and c.force.z > 0 and c.normal.z > 0.99 for c in contacts), contacts)
            total = [sum(getattr(c.force, axis) for c in contacts) for axis in "xyz"]
            self.assertAlmostEqual(math.hypot(*total), math.hypot(*xyz(message.wrench.force)), 9)
        self.assertGreater(every, 100.0)
        carried = sum(sum(c.force.z for c in last[f"contacts/{foot}"].contacts) for foot in FEET)
        self.assertAlmostEqual(every, carried, 9)
        # Along its axis (y) the knee transmits what its drive gives.
        states = last["/joint_states"]
        effort = states.effort[states.name.index("LF_KFE")]
        self.assertGreater(abs(effort), 0.5)
        self.assertAlmostEqual(effort, last["joint_wrench/LF_KFE"].wrench.torque.y, 4)
        self.assertEqual("LF_SHANK", last["joint_wrench/LF_KFE"].header.frame_id)
        # Behind the fixed joint is the foot: its weight less what the ground gives.
        ankle = math.hypot(*xyz(last["joint_wrench/LF_ANKLE"].wrench.force))
        foot = sum(c.force.z for c in last["contacts/LF_FOOT"].contacts)
        self.assertLess(abs(ankle - foot), 2.0)
        self.assertGreater(ankle, 10.0)

    def test_in_a_pause_who_comes_gets_the_last_step_and_after_a_reset_no_joint_wrench(self):
        self.start({}, node_runner.quadruped_urdf())
        call("step", Step, 20)
        first = self.listen({"wrench/base": WrenchStamped, "joint_wrench/LF_KFE": WrenchStamped})
        self.assertTrue(node_runner.wait_until(lambda: all(len(m) == 1 for m in first.messages.values()), 10.0),
                        first.messages)
        self.assertEqual(rospy.Time(0, 20000000), first.messages["joint_wrench/LF_KFE"][0].header.stamp)
        call("reset", Empty)
        self.assertTrue(node_runner.wait_until(lambda: len(first.messages["wrench/base"]) == 2, 10.0))
        second = self.listen({"wrench/base": WrenchStamped, "joint_wrench/RF_KFE": WrenchStamped})
        rospy.rostime.wallsleep(0.3)
        self.assertEqual(1, len(first.messages["joint_wrench/LF_KFE"]))
        self.assertEqual([], second.messages["joint_wrench/RF_KFE"])

    def test_names_that_are_no_topics_are_made_ones(self):
        box = node_runner.box_urdf()
        self.start({}, box.replace('link name="box"', 'link name="left foot-1"'))
        listener = self.listen({"wrench/left_foot_1": WrenchStamped})
        listener.step(200, "wrench/left_foot_1")
        message = listener.messages["wrench/left_foot_1"][-1]
        self.assertEqual("left foot-1", message.header.frame_id)
        self.assertAlmostEqual(10.0 * G, message.wrench.force.z, 6)


    def test_a_node_without_them_advertises_none(self):
        self.start({"link_topics": False}, node_runner.box_urdf())
        published = [topic for topic, _ in rospy.get_published_topics(node_runner.NAME)]
        self.assertIn(node_runner.NAME + "/contacts", published)
        self.assertEqual([], [topic for topic in published if "/wrench/" in topic or "/contacts/" in topic])


class SensorsTest(NodeTest):
    SCENE = """
ground:
solver: {tolerance: 1.0e-11}
bodies:
  - name: box
    urdf: PACKAGE/test/ros/box_10kg.urdf
    pose: {xyz: [0, 0, 0.1]}
    sensors:
      - {type: imu, link: box, name: tilted, rate: 100, pose: {xyz: [0.05, 0, 0], rpy: [1.2, 0.3, -0.4]}}
      - {type: imu, link: box, name: noisy, seed: 3, noise: {gyro: 0.01, accel: 0.1}, bias: {accel: [0.5, 0, 0]}}
      - {type: imu, link: box, name: elsewhere, topic: imu/data, frame: imu_link}
  - {name: arm, urdf: PACKAGE/urdf/double_pendulum.urdf, base: fixed, pose: {xyz: [2, 0, 3]},
     sensors: [{type: force_torque, joint: JOINT, name: mount, rate: 10}]}
"""
    TOPICS = {"sensors/tilted": Imu, "sensors/noisy": Imu, "/imu/data": Imu, "sensors/arm/mount": WrenchStamped}

    def text(self):
        pendulum = (node_runner.PACKAGE_DIR / "urdf/double_pendulum.urdf").read_text()
        return self.SCENE.replace("JOINT", pendulum.split('<joint name="')[1].split('"')[0])

    def values(self, messages):
        return [(xyz(m.linear_acceleration), xyz(m.angular_velocity)) for m in messages]

    def test_imu_at_rest_reads_up_at_its_rate_and_noise_repeats_after_a_reset_and_in_another_run(self):
        noise = []
        for _ in range(2):
            with scenario(self.text()) as file:
                self.start({"scenario": file.name})
                listener = self.listen(self.TOPICS)
                listener.step(500, "sensors/noisy")
                first = self.values(listener.messages["sensors/noisy"])
                self.assertTrue(node_runner.wait_until(lambda: len(listener.messages["sensors/tilted"]) == 50, 10.0))
                tilted = listener.messages["sensors/tilted"]
                self.assertEqual([rospy.Time(0, 10000000 * k) for k in range(1, 51)], [m.header.stamp for m in tilted])
                self.assertEqual("tilted", tilted[-1].header.frame_id)
                # Up in the sensor's axes: the third row of Rz(-0.4) Ry(0.3) Rx(1.2).
                up = [-math.sin(0.3), math.cos(0.3) * math.sin(1.2), math.cos(0.3) * math.cos(1.2)]
                for found, axis in zip(xyz(tilted[-1].linear_acceleration), up):
                    self.assertAlmostEqual(G * axis, found, 8)
                self.assertAlmostEqual(1.0, sum(c * c for c in (tilted[-1].orientation.x, tilted[-1].orientation.y,
                                                                tilted[-1].orientation.z, tilted[-1].orientation.w)))
                self.assertEqual("imu_link", listener.messages["/imu/data"][-1].header.frame_id)
                self.assertTrue(node_runner.wait_until(lambda: len(listener.messages["sensors/arm/mount"]) == 5, 10.0))
                call("reset", Empty)
                listener.step(500, "sensors/noisy")
                self.assertEqual(first, self.values(listener.messages["sensors/noisy"])[500:])
                noise.append(first)
                self.stop()
        self.assertEqual(noise[0], noise[1])
        side = [linear[0] for linear, _ in noise[0][100:]]  # at rest
        mean = sum(side) / len(side)
        deviation = math.sqrt(sum((value - mean) ** 2 for value in side) / len(side))
        self.assertAlmostEqual(0.5, mean, delta=5 * 0.1 / math.sqrt(len(side)))
        self.assertAlmostEqual(0.1, deviation, delta=0.02)

    def test_the_robot_of_a_parameter_has_sensors_and_a_wrong_one_is_bad_input(self):
        self.start({"sensors": [{"type": "imu", "link": "box", "name": "imu"}]}, node_runner.box_urdf())
        listener = self.listen({"sensors/imu": Imu})
        self.assertAlmostEqual(0.0, xyz(listener.step(1, "sensors/imu")[-1].linear_acceleration)[2], 9)  # it falls
        self.stop()  # two nodes of one name end each other
        wrong = node_runner.Node({"sensors": [{"type": "imu", "link": "bax"}]}, node_runner.box_urdf())
        self.assertEqual(2, wrong.wait())
        self.assertIn("did you mean 'box'", wrong.stderr())


class TransformsTest(NodeTest):
    def test_what_never_moves_is_latched_and_links_come_on_demand(self):
        with scenario("bodies: [{name: arm, urdf: PACKAGE/urdf/double_pendulum.urdf, base: fixed},"
                      "{name: table, urdf: PACKAGE/urdf/block.urdf, base: fixed, pose: {xyz: [1, 2, 3]}},"
                      "{name: box, urdf: PACKAGE/test/ros/box_10kg.urdf, pose: {xyz: [0, 0, 9]},"
                      " sensors: [{type: imu, link: box, name: imu, pose: {xyz: [0, 0, 0.1]}}]}]") as file:
            self.start({"scenario": file.name, "publish_link_tf": True, "tf_rate": 0.0})
            listener = self.listen({"/tf": rospy.AnyMsg, "/tf_static": rospy.AnyMsg})
            self.assertTrue(node_runner.wait_until(lambda: all(listener.messages.values()), 10.0))
            fixed = {t.child_frame_id: t for m in listener.messages["/tf_static"] for t in decoded(m).transforms}
            moving = {t.child_frame_id: t for m in listener.messages["/tf"] for t in decoded(m).transforms}
            self.assertEqual("box", fixed["imu"].header.frame_id)
            self.assertEqual(0.1, fixed["imu"].transform.translation.z)
            self.assertEqual([1.0, 2.0, 3.0], [xyz(t.transform.translation) for t in fixed.values()
                                               if t.header.frame_id == "world"][0])
            self.assertEqual(set(), set(fixed) & set(moving))
            self.assertEqual("world", moving["box"].header.frame_id)
            self.assertGreater(len(moving), 2)


class DiagnosticsTest(NodeTest):
    def statuses(self, listener):
        return {status.name: status for message in listener.messages["/diagnostics"][-1:]
                for status in decoded(message).status}

    def test_levels_follow_the_run_with_simulated_time(self):
        rospy.set_param("/use_sim_time", True)
        try:
            self.start({"on_failure": "hold", "tolerance": 1e-300, "fallback": False, "max_iterations": 5},
                       node_runner.box_urdf())
            listener = self.listen({"/diagnostics": rospy.AnyMsg})
            named = lambda part: [s for n, s in self.statuses(listener).items() if n.endswith(part)]
            self.assertTrue(node_runner.wait_until(lambda: named("solver"), 10.0))  # in a pause too
            self.assertEqual(0, named("solver")[0].level)
            call("set_paused", SetBool, False)
            self.assertTrue(node_runner.wait_until(lambda: named("solver") and named("solver")[0].level == 2, 15.0),
                            self.statuses(listener))
            values = {v.key: v.value for v in named("solver")[0].values}
            self.assertGreater(int(values["failed steps"]), 0)
            self.assertEqual(4, len(self.statuses(listener)))
            self.assertNotEqual(0, decoded(listener.messages["/diagnostics"][-1]).header.stamp.to_nsec())
        finally:
            rospy.delete_param("/use_sim_time")


if __name__ == "__main__":
    rospy.init_node("link_topics_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "link_topics", "__main__")
