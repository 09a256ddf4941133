"""The arm of urdf/arm.urdf in a node that is stepped by hand: commands, then so many steps, then a look at the joints."""
import time

import rospy
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty

import node_runner
from frictional_contact_sim.srv import Step

DT = 0.001  # [s]
ARRIVAL = 0.2  # a message is there after this long, the machine may be loaded [s]
ARM = {"yaw": 0.2, "shoulder": -0.7, "elbow": 1.7, "wrist": 0.5, "left_finger": 0.03}  # start [rad], [m]


class SteppedNode:
    def __init__(self, **parameters):
        self.states = []
        self.subscriber = rospy.Subscriber("/joint_states", JointState, self.states.append)
        defaults = {"base": "fixed", "ground": False, "start_paused": True, "hold_initial_position": True,
                    "gravity_compensation": True, "initial_joint_positions": ARM}
        self.node = node_runner.Node(dict(defaults, **parameters),
                                     (node_runner.PACKAGE_DIR / "urdf/arm.urdf").read_text())
        rospy.wait_for_service(node_runner.NAME + "/step", node_runner.TIMEOUT)
        self.steps = rospy.ServiceProxy(node_runner.NAME + "/step", Step)
        self.publishers = {}
        self.step(1)

    def end(self):
        for handle in [self.subscriber, *self.publishers.values()]:
            handle.unregister()
        return self.node.interrupt()

    def publisher(self, topic, kind):
        if topic not in self.publishers:
            self.publishers[topic] = rospy.Publisher(node_runner.NAME + "/" + topic, kind, queue_size=1000)
            node_runner.wait_until(lambda: self.publishers[topic].get_num_connections() > 0)
        return self.publishers[topic]

    def give(self, topic, *messages):
        for message in messages:
            self.publisher(topic, type(message)).publish(message)
        time.sleep(ARRIVAL)

    def step(self, n):
        """The joints after n more steps."""
        answer = self.steps(n)
        assert answer.success, answer.message
        return self.wait_for(answer.report.header.stamp)

    def wait_for(self, stamp):
        assert node_runner.wait_until(lambda: self.states and self.states[-1].header.stamp >= stamp)
        return self.states[-1]

    def call(self, service):
        rospy.ServiceProxy(node_runner.NAME + "/" + service, Empty)()

    def now(self):
        return self.states[-1].header.stamp

    def state_at(self, stamp):
        return next(state for state in self.states if abs((state.header.stamp - stamp).to_sec()) < 1e-7)

    def warnings(self, words):
        return [line for line in self.node.lines("WARN") if words in line]


def value(state, field, joint):
    return getattr(state, field)[state.name.index(joint)]
