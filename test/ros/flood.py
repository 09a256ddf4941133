#!/usr/bin/env python3
"""Twenty subscribers, or a thousand commands a second that repeat the present one, do not change a bit of the run."""
import hashlib
import io
import time
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty

import node_runner
from frictional_contact_sim.msg import ContactArray, StepReport
from raw_subscriber import RawSubscriber

STEPS = 600
TOPICS = {"/joint_states": JointState, node_runner.NAME + "/contacts": ContactArray,
          node_runner.NAME + "/step_report": StepReport}


def digest(message):
    """Of all bytes of a message but wall-clock times and the count of messages, some of which are of the pause."""
    message.header.seq = 0
    if isinstance(message, StepReport):
        message.real_time_factor = message.solve_time = 0.0
    buffer = io.BytesIO()
    message.serialize(buffer)
    return hashlib.sha256(buffer.getvalue()).hexdigest()


class FloodTest(unittest.TestCase):
    def run_once(self, subscribers=0, flood=False):
        """Digests by topic and stamp, from the first step on; how many commands were given."""
        digests = {topic: {} for topic in TOPICS}
        starts = []
        handles = [rospy.Subscriber(topic, kind, lambda message, key: digests[key].__setitem__(
            message.header.stamp.to_nsec(), digest(message)), topic) for topic, kind in TOPICS.items()]
        handles.append(rospy.Subscriber("/joint_states", JointState, starts.append))
        publisher = rospy.Publisher(node_runner.NAME + "/command/position", JointState, queue_size=10)
        handles.append(publisher)
        node = node_runner.Node({"num_steps": STEPS, "hold_initial_position": True, "start_paused": True,
                                 "real_time_factor": 0.5}, node_runner.quadruped_urdf())
        self.assertTrue(node_runner.wait_until(lambda: starts and publisher.get_num_connections() > 0), node.stderr())
        time.sleep(0.5)  # all subscriptions stand
        raw = [RawSubscriber(f"/raw_{k}", sorted(TOPICS)[k % len(TOPICS)]) for k in range(subscribers)]
        rospy.ServiceProxy(node_runner.NAME + "/unpause", Empty)()
        given = 0
        while flood and node.process.poll() is None:
            publisher.publish(JointState(name=starts[0].name, position=starts[0].position))
            given += 1
            time.sleep(0.001)
        code = node.wait()
        for handle in handles:
            handle.unregister()
        for subscriber in raw:
            self.assertGreaterEqual(len(subscriber.sequence), STEPS)
            subscriber.close()
        self.assertEqual(0, code, node.stderr())
        self.assertEqual([], [line for line in node.lines("WARN") if "command" in line])
        start = starts[0].header.stamp.to_nsec()
        return {topic: {stamp: found for stamp, found in of.items() if stamp > start}
                for topic, of in digests.items()}, given

    def test_no_bit_changes(self):
        alone, _ = self.run_once()
        for topic, digests in alone.items():
            self.assertEqual(STEPS, len(digests), topic)
            self.assertGreater(len(set(digests.values())), STEPS - 1)
        crowded, _ = self.run_once(subscribers=20)
        self.assertEqual(alone, crowded)
        flooded, given = self.run_once(flood=True)
        self.assertGreater(given, 0.5 * STEPS)
        self.assertEqual(alone, flooded)


if __name__ == "__main__":
    rospy.init_node("flood_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "flood", FloodTest)
