#!/usr/bin/env python3
"""While nothing moves the present state is shown: to who comes, and to all after a reset."""
import unittest

import genpy.dynamic
import rospy
import rostest
from std_srvs.srv import Empty, SetBool

import node_runner
from frictional_contact_sim.srv import Step

TOPICS = ["/joint_states", "/tf"] + [node_runner.NAME + "/" + name for name in ("ground_truth/odom", "contacts", "markers")]
QUIET = 0.5  # long enough for a message that should not come [s]


def stamp(message):
    """Of a message, or of the first part of one without a header."""
    return (message if hasattr(message, "header") else getattr(message, message.__slots__[0])[0]).header.stamp


def decoded(raw):
    """Debian has no Python classes of some of the messages: they are made from what the publisher says."""
    kind = raw._connection_header["type"]
    message = genpy.dynamic.generate_dynamic(kind, raw._connection_header["message_definition"])[kind]()
    return message.deserialize(raw._buff)


class Viewer:
    def __init__(self):
        self.messages = {topic: [] for topic in TOPICS}
        self.subscribers = [rospy.Subscriber(topic, rospy.AnyMsg, self.messages[topic].append) for topic in TOPICS]

    def counts(self):
        return {topic: len(messages) for topic, messages in self.messages.items()}

    def wait(self, count):
        """Exactly so many of each topic."""
        node_runner.wait_until(lambda: min(self.counts().values()) >= count, 20.0)
        rospy.rostime.wallsleep(QUIET)
        return self.counts() == dict.fromkeys(TOPICS, count)

    def last(self, topic):
        return decoded(self.messages[topic][-1])

    def stamps(self):
        return {stamp(self.last(topic)) for topic in TOPICS}

    def close(self):
        for subscriber in self.subscribers:
            subscriber.unregister()


def call(name, kind, *arguments):
    rospy.wait_for_service(node_runner.NAME + "/" + name, node_runner.TIMEOUT)
    return rospy.ServiceProxy(node_runner.NAME + "/" + name, kind)(*arguments)


class PausedStateTest(unittest.TestCase):
    def setUp(self):
        # Without hold the legs give way, so that states differ.
        self.node = node_runner.Node({"start_paused": True, "tf_rate": 1.0, "marker_rate": 1.0},
                                     node_runner.quadruped_urdf())
        rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
        self.viewers = []

    def tearDown(self):
        self.assertEqual(0, self.node.interrupt(), self.node.stderr())
        for viewer in self.viewers:
            viewer.close()

    def view(self):
        self.viewers.append(Viewer())
        return self.viewers[-1]

    def test_the_start_is_shown_before_the_first_step(self):
        viewer = self.view()
        self.assertTrue(viewer.wait(1), viewer.counts())
        self.assertEqual({rospy.Time(0, 1)}, viewer.stamps())  # not zero, and before the first step
        self.assertEqual(12, len(viewer.last("/joint_states").position))
        height = viewer.last("/tf").transforms[0].transform.translation.z
        self.assertGreater(height, 0.1)
        self.assertEqual(height, viewer.last(node_runner.NAME + "/ground_truth/odom").pose.pose.position.z)

    def test_after_steps_and_after_a_reset_the_picture_is_the_present_one(self):
        viewer = self.view()
        self.assertTrue(viewer.wait(1), viewer.counts())
        start = viewer.last("/joint_states").position
        call("step", Step, 300)  # transforms and markers are due once a second only
        node_runner.wait_until(lambda: viewer.counts()["/joint_states"] == 301)
        self.assertTrue(node_runner.wait_until(lambda: viewer.stamps() == {rospy.Time(0, 300000000)}), viewer.stamps())
        self.assertNotEqual(start, viewer.last("/joint_states").position)
        call("reset", Empty)
        self.assertTrue(node_runner.wait_until(lambda: viewer.stamps() == {rospy.Time(0, 300000001)}), viewer.stamps())
        self.assertEqual(start, viewer.last("/joint_states").position)
        call("step", Step, 1)
        self.assertTrue(node_runner.wait_until(lambda: viewer.stamps() == {rospy.Time(0, 301000000)}), viewer.stamps())
        call("reset_simulation", Empty)
        self.assertTrue(node_runner.wait_until(lambda: viewer.stamps() == {rospy.Time(0, 2)}), viewer.stamps())

    def test_who_comes_in_a_pause_sees_it_and_no_one_else_gets_it_twice(self):
        call("step", Step, 50)
        first = self.view()
        self.assertTrue(first.wait(1), first.counts())
        self.assertEqual({rospy.Time(0, 50000000)}, first.stamps())
        # A second one in this process shares the connections; one of its own is a process.
        seen = node_runner.read_once("/joint_states")
        self.assertRegex(seen, r"nsecs: +50000000\n")
        self.assertTrue(first.wait(1), first.counts())

    def test_a_run_shows_steps_only(self):
        call("set_paused", SetBool, False)
        viewer = self.view()
        self.assertTrue(node_runner.wait_until(lambda: len(viewer.messages["/joint_states"]) > 100))
        stamps = [stamp(decoded(raw)).to_nsec() for raw in viewer.messages["/joint_states"][:20]]
        self.assertEqual({0}, {value % 1000000 for value in stamps})
        self.assertEqual(len(stamps), len(set(stamps)))


if __name__ == "__main__":
    rospy.init_node("paused_state_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "paused_state", PausedStateTest)
