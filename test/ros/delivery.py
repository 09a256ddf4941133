#!/usr/bin/env python3
"""No subscriber stops time: it may be slow, stopped, without statistics or tell nonsense. Who must get all gets all."""
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import SetBool

import node_runner
from nonsense import NONSENSE, hang, random_answers
from raw_subscriber import RawSubscriber

TOPIC = "/joint_states"
CALL_LIMIT = 10.0  # a call that lasts longer counts as hung [s]
HOLD_LIMIT = 0.5  # [s]
STEPS = 20000  # 10 MB of joint states: more than queues and sockets hold
FREE, PACED = 0.0, 1.0


class Stopped:
    """rostopic echo, stopped as by Ctrl-Z."""

    def __init__(self, _):
        self.process = subprocess.Popen(["rostopic", "echo", TOPIC], stdout=subprocess.DEVNULL)
        time.sleep(2.0)
        self.process.send_signal(signal.SIGSTOP)

    def close(self):
        self.process.kill()
        self.process.wait()


class Slow:
    """rospy with a queue of one, which drops what it does not count."""

    def __init__(self, _):
        self.subscriber = rospy.Subscriber(TOPIC, JointState, lambda _: time.sleep(0.005), queue_size=1)

    def close(self):
        self.subscriber.unregister()


MISBEHAVED = {
    "slow": Slow,
    "stopped": Stopped,
    "reads nothing": lambda name: RawSubscriber(name, TOPIC, delay=None),
    "reads nothing and hangs": lambda name: RawSubscriber(name, TOPIC, hang, delay=None),
}


class DeliveryTest(unittest.TestCase):
    def setUp(self):
        self.clock = 0.0
        self.clock_subscriber = rospy.Subscriber("/clock", Clock, self.on_clock)
        self.open = []

    def on_clock(self, message):
        self.clock = message.clock.to_sec()

    def tearDown(self):
        for subscriber in self.open:
            subscriber.close()
        self.clock_subscriber.unregister()

    def start(self, **parameters):
        self.node = node_runner.Node(dict({"clock_rate": 200.0, "hold_limit": HOLD_LIMIT, "start_paused": True},
                                          **parameters), node_runner.quadruped_urdf())
        rospy.wait_for_service(node_runner.NAME + "/set_paused", node_runner.TIMEOUT)
        self.set_paused = rospy.ServiceProxy(node_runner.NAME + "/set_paused", SetBool)

    def attach(self, subscriber):
        self.open.append(subscriber)
        return subscriber

    def end(self):
        start = time.monotonic()
        self.assertEqual(0, self.node.interrupt(), self.node.stderr())
        self.assertLess(time.monotonic() - start, CALL_LIMIT)
        while self.open:
            self.open.pop().close()

    def call(self, paused):
        start = time.monotonic()
        self.assertTrue(self.set_paused(paused).success)
        self.assertLess(time.monotonic() - start, CALL_LIMIT)

    def check_time_goes_on(self, seconds=2.0):
        """Calls are answered all the while."""
        self.call(False)
        target = self.clock + seconds

        def arrived():
            self.call(False)
            return self.clock > target
        self.assertTrue(node_runner.wait_until(arrived), f"time stands at {self.clock} s\n" + self.node.stderr())

    def given_up(self):
        return [line for line in self.node.lines("WARN") if "~hold_limit" in line]

    def test_time_goes_on_whoever_subscribes(self):
        for factor in (PACED, FREE):
            for lossless in ([], ["joint_states"]):
                with self.subTest(f"real_time_factor {factor}, lossless_topics {lossless}"):
                    self.start(real_time_factor=factor, lossless_topics=lossless)
                    for k, make in enumerate(MISBEHAVED.values()):
                        self.attach(make(f"/misbehaved_{k}"))
                    self.check_time_goes_on()
                    if not lossless or factor == PACED:
                        self.assertEqual([], self.given_up())  # nobody was waited for
                    self.end()

    def test_each_is_waited_for_once_and_then_no_more(self):
        for what, make in MISBEHAVED.items():
            with self.subTest(what):
                self.start(real_time_factor=FREE, lossless_topics=["joint_states"])
                self.attach(make("/misbehaved"))
                self.call(False)
                self.assertTrue(node_runner.wait_until(self.given_up), self.node.stderr())
                self.check_time_goes_on()
                self.assertEqual(1, len(self.given_up()), self.node.stderr())
                self.end()

    def test_every_answer_is_survived(self):
        answers = dict(NONSENSE, **{f"random {seed}": random_answers(seed) for seed in range(10)})
        self.start(real_time_factor=FREE, lossless_topics=["joint_states"])
        subscribers = {what: self.attach(RawSubscriber("/nonsense_%d" % k, TOPIC, bus_stats))
                       for k, (what, bus_stats) in enumerate(answers.items())}
        self.check_time_goes_on()
        for what, subscriber in subscribers.items():
            self.assertGreater(subscriber.asked(), 0, what)
        self.end()
        names = [re.search(r"/nonsense_\d+", line).group() for line in self.given_up()]
        self.assertEqual(len(names), len(set(names)))  # one line each

    def read_slowly(self, steps, announce, delay):
        """Messages that a true subscriber gets which reads slower than the run publishes, and has small buffers."""
        self.start(real_time_factor=FREE, num_steps=steps, hold_limit=5.0)
        name = "/slow_reader"
        announcement = rospy.Publisher("/lossless_nodes", String, queue_size=1, latch=True)
        if announce:
            announcement.publish(name)
            self.assertTrue(node_runner.wait_until(lambda: announcement.get_num_connections() > 0))
            time.sleep(0.5)  # the message is on its way
        reader = self.attach(RawSubscriber(name, TOPIC, delay=delay, receive_buffer=4096))
        self.assertTrue(node_runner.wait_until(lambda: reader.thread.is_alive()))
        time.sleep(0.2)
        first = len(reader.sequence)  # the state while paused
        self.call(False)
        code = self.node.wait()
        self.assertEqual(0, code, self.node.stderr())
        reader.thread.join(node_runner.TIMEOUT)
        announcement.unregister()
        sequence = reader.sequence[first:]
        while self.open:
            self.open.pop().close()
        return sequence

    def test_who_is_announced_gets_every_message_of_a_free_run(self):
        steps = STEPS // 2  # held every 32 steps, some 0.1 s each
        sequence = self.read_slowly(steps, True, 2e-4)
        self.assertEqual(list(range(sequence[0], sequence[0] + steps)), sequence)
        self.assertEqual([], self.given_up())

    def test_who_is_not_announced_does_not_hold_a_free_run(self):
        # The test above can fail: without the announcement a slow reader loses messages.
        self.assertLess(len(self.read_slowly(STEPS, False, 2e-3)), STEPS)

    def test_memory_is_bounded_with_a_subscriber_that_reads_nothing(self):
        self.start(real_time_factor=FREE)
        self.attach(RawSubscriber("/reads_nothing", TOPIC, delay=None))
        process = pathlib.Path(f"/proc/{self.node.process.pid}")
        self.assertEqual("simulator_node", (process / "comm").read_text().strip())
        self.check_time_goes_on(10.0)  # 10000 steps fill its queue

        def resident():
            return int((process / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        before = resident()
        self.check_time_goes_on(40.0)
        self.assertLess(resident() - before, 10e6)  # 40000 messages of half a kilobyte are more
        self.end()


if __name__ == "__main__":
    # Wall clock: rospy must not wait for a simulated time that the test wants to see standing.
    rospy.init_node("delivery_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "delivery", DeliveryTest)
