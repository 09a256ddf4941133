#!/usr/bin/env python3
"""Verdicts on existence from the node: ~certificate, ~step_report, red markers, ~certify; a crushed and a gripped block."""
import unittest

import rospy
import rostest
from visualization_msgs.msg import Marker, MarkerArray

import node_runner
from frictional_contact_sim.msg import CertificateReport, StepReport
from frictional_contact_sim.srv import Certify, Step

CRUSHED_AFTER = 0.1  # of config/scenarios/crushed_block.yaml [s]
DT = 0.001  # [s]


def service(name, kind):
    rospy.wait_for_service(node_runner.NAME + "/" + name, node_runner.TIMEOUT)
    return rospy.ServiceProxy(node_runner.NAME + "/" + name, kind)


class CertificatesTest(unittest.TestCase):
    def start(self, scenario, **parameters):
        self.certificates, self.reports, self.markers = [], [], []
        topics = {"certificate": (CertificateReport, self.certificates), "step_report": (StepReport, self.reports),
                  "markers": (MarkerArray, self.markers)}
        self.subscribers = [rospy.Subscriber(node_runner.NAME + "/" + topic, kind, messages.append)
                            for topic, (kind, messages) in topics.items()]
        path = str(node_runner.PACKAGE_DIR / "config/scenarios" / (scenario + ".yaml"))
        self.node = node_runner.Node(dict({"scenario": path, "start_paused": True, "marker_rate": 0,
                                           "wait_for_subscribers": ["~" + topic for topic in topics]}, **parameters))
        self.step = service("step", Step)
        self.certify = service("certify", Certify)
        node_runner.wait_until(lambda: self.step(1).success)

    def tearDown(self):
        code = self.node.interrupt()
        for subscriber in self.subscribers:
            subscriber.unregister()
        self.assertEqual(0, code, self.node.stderr())

    def red(self):
        """Places of the red balls of the last picture."""
        return [marker.pose.position for marker in self.markers[-1].markers
                if marker.ns == "blocking" and marker.type == Marker.SPHERE and marker.action == Marker.ADD
                and marker.color.a == 1.0]

    def test_a_crushed_block_is_refuted_and_marked(self):
        self.start("crushed_block")
        self.assertTrue(self.step(59).success)
        answer = self.certify(0.0, False)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(StepReport.CERTIFIED, answer.existence)
        self.assertFalse(answer.blocking_contacts)
        self.step(60)
        self.assertTrue(node_runner.wait_until(lambda: len(self.certificates) >= 120 and len(self.reports) >= 120))
        refuted = [message for message in self.certificates if message.existence == CertificateReport.REFUTED]
        self.assertAlmostEqual(CRUSHED_AFTER, refuted[0].header.stamp.to_sec(), delta=3 * DT)
        self.assertEqual(len(refuted[0].blocking), len(refuted[0].blocking_contacts))
        for plate in ("left_plate", "right_plate"):
            self.assertTrue(any(plate in name for name in refuted[0].blocking), refuted[0].blocking)
        self.assertTrue(any(message.warning for message in self.certificates if message not in refuted))
        self.assertEqual([message.existence for message in self.reports],
                         [message.existence for message in self.certificates])
        self.assertEqual(refuted[-1].margin, self.reports[-1].existence_margin)
        self.assertTrue(node_runner.wait_until(self.red))
        for place in self.red():
            self.assertAlmostEqual(0.025, abs(place.x), delta=0.002)
        answer = self.certify(0.0, False)
        self.assertEqual(StepReport.REFUTED, answer.existence)
        self.assertEqual(sorted(refuted[-1].blocking_contacts), sorted(answer.blocking_contacts))
        for bad in ((-1.0, False), (float("nan"), False)):
            self.assertFalse(self.certify(*bad).success)
        self.assertTrue(any("no solution" in line for line in self.node.lines("WARN")))

    def test_a_gripped_block_is_certified_and_nothing_is_checked_in_between(self):
        self.start("gripped_block", certify_every=5)
        self.assertTrue(self.step(49).success)
        self.assertTrue(node_runner.wait_until(lambda: len(self.certificates) >= 10 and len(self.reports) >= 50))
        self.assertEqual([5 * k for k in range(1, 11)], [message.step for message in self.certificates])
        self.assertEqual({CertificateReport.CERTIFIED}, {message.existence for message in self.certificates})
        self.assertEqual(40, sum(message.existence == StepReport.NOT_CHECKED for message in self.reports))
        last = self.certificates[-1]
        self.assertGreater(last.rows, last.rank)
        self.assertGreater(last.margin, 0.0)
        self.assertFalse(last.warning)


if __name__ == "__main__":
    rospy.init_node("certificates_test")
    rostest.rosrun("frictional_contact_sim", "certificates", CertificatesTest)
