#!/usr/bin/env python3
"""~command/trajectory and ~follow_joint_trajectory: the way that the joints go, replacement, tolerances, refusals."""
import unittest

import actionlib
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

import node_runner
from frictional_contact_sim.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryGoal,
                                        FollowJointTrajectoryResult, JointTolerance)
from stepped_node import ARM, SteppedNode, value

JOINTS = ["yaw", "elbow"]
# The most that a joint is behind: a/w^2 of a servo of 40 rad/s and 2.9 rad/s^2, and the URDF's damper over kp [rad].
LAG = 4e-3


def point(seconds, positions, velocities=(), accelerations=()):
    return JointTrajectoryPoint(positions=positions, velocities=velocities, accelerations=accelerations,
                                time_from_start=rospy.Duration(seconds))


def trajectory(*points, stamp=None, joints=tuple(JOINTS)):
    message = JointTrajectory(joint_names=list(joints), points=list(points))
    message.header.stamp = stamp or rospy.Time()
    return message


def quintic(start, end, s):
    return start + (end - start) * s ** 3 * (10.0 - 15.0 * s + 6.0 * s ** 2)


class TrajectoriesTest(unittest.TestCase):
    def setUp(self):
        self.arm = SteppedNode()

    def tearDown(self):
        self.assertEqual(0, self.arm.end(), self.arm.node.stderr())

    def goal(self, message, **more):
        """Sends a goal; its client once it is accepted or refused."""
        client = actionlib.SimpleActionClient(node_runner.NAME + "/follow_joint_trajectory",
                                              FollowJointTrajectoryAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(node_runner.TIMEOUT)))
        client.feedback = []
        client.send_goal(FollowJointTrajectoryGoal(trajectory=message, **more), feedback_cb=client.feedback.append)
        self.assertTrue(node_runner.wait_until(lambda: client.get_state() != GoalStatus.PENDING))
        return client

    def end(self, client, state):
        """The result of a goal, which has to have ended like this."""
        self.assertTrue(node_runner.wait_until(lambda: client.get_state() == state, 10.0),
                        client.get_goal_status_text() + self.arm.node.stderr())
        self.assertTrue(node_runner.wait_until(lambda: client.get_result() is not None, 10.0))
        return client.get_result()

    def expect_at(self, state, yaw, elbow, delta=LAG):
        self.assertAlmostEqual(yaw, value(state, "position", "yaw"), delta=delta)
        self.assertAlmostEqual(elbow, value(state, "position", "elbow"), delta=delta)

    def test_a_topic_with_start_in_the_future_and_a_replacement(self):
        start = self.arm.now()
        rest = [0.0, 0.0]
        self.arm.give("command/trajectory",
                      trajectory(point(1.0, [0.6, 1.2], rest, rest), stamp=start + rospy.Duration(0.1)))
        self.expect_at(self.arm.step(100), ARM["yaw"], ARM["elbow"], 1e-6)
        for step in range(1, 6):
            state = self.arm.step(100)
            self.expect_at(state, quintic(0.2, 0.6, 0.1 * step), quintic(1.7, 1.2, 0.1 * step))
        # In the middle of the way another one takes over: from the desired state, its speed too, in one smooth cubic.
        speed = value(state, "velocity", "yaw")
        self.arm.give("command/trajectory", trajectory(point(0.5, [0.2], [0.0]), joints=["yaw"]))
        state = self.arm.step(20)
        self.assertAlmostEqual(speed, value(state, "velocity", "yaw"), delta=0.2 * speed)
        self.expect_at(self.arm.step(480), 0.2, 1.2, 1e-2)  # the cubic ends at 10 rad/s^2; the other joint has gone on
        self.expect_at(self.arm.step(300), 0.2, 1.2, 1e-5)
        # Straight lines where positions are all that is given; a message without points stops them.
        self.arm.give("command/trajectory", trajectory(point(1.0, [0.4, 1.4])))
        self.arm.step(400)
        self.arm.give("command/trajectory", JointTrajectory())
        self.expect_at(self.arm.step(800), 0.2 + 0.4 * 0.2, 1.2 + 0.4 * 0.2, 1e-5)
        # A reset forgets them.
        self.arm.give("command/trajectory", trajectory(point(0.5, [0.4, 1.4])))
        self.arm.step(100)
        self.arm.call("reset")
        self.expect_at(self.arm.step(300), ARM["yaw"], ARM["elbow"], 1e-6)

    def test_bad_messages_change_nothing(self):
        nan = float("nan")
        good = point(1.0, [0.5, 1.0])
        bad = [(trajectory(good, joints=["yaw", "nose"]), "unknown joint 'nose'"),
               (trajectory(good, joints=["yaw", "yaw"]), "named twice"),
               (trajectory(good, joints=["yaw", "right_finger"]), "follows another"),
               (trajectory(good, joints=[]), "joint_names"),
               (trajectory(point(1.0, [0.5])), "points[0].positions: found 1 numbers, expected 2"),
               (trajectory(point(1.0, [0.5, nan])), "points[0].positions: found nan"),
               (trajectory(point(1.0, [0.5, 1.0], [0.0])), "points[0].velocities: found 1"),
               (trajectory(point(1.0, [0.5, 1.0], [], [0.0, 0.0])), "points[0].velocities: found none"),
               (trajectory(good, point(1.0, [0.5, 1.0])), "points[1].time_from_start: found 1 s, expected later"),
               (trajectory(point(-1.0, [0.5, 1.0])), "points[0].time_from_start"),
               (trajectory(point(0.0, [0.5, 1.0])), "later than now"),
               (trajectory(good, stamp=rospy.Time(1.7e9)), "use_sim_time")]
        for message, _ in bad:
            self.arm.give("command/trajectory", message)
        state = self.arm.step(300)
        for joint, start in ARM.items():
            self.assertAlmostEqual(start, value(state, "position", joint), delta=1e-6)
        for _, words in bad:
            self.assertEqual(1, len(self.arm.warnings(words)), words + self.arm.node.stderr())

    def test_a_goal_is_reached(self):
        rest = [0.0, 0.0]
        client = self.goal(trajectory(point(0.5, [0.4, 1.5], rest, rest)),
                           path_tolerance=[JointTolerance("yaw", 0.01, 0.0, 0.0)],
                           goal_tolerance=[JointTolerance("elbow", 1e-4, 0.0, 0.0)],
                           goal_time_tolerance=rospy.Duration(0.2))
        self.assertEqual(GoalStatus.ACTIVE, client.get_state(), client.get_goal_status_text())
        self.arm.step(250)
        self.assertEqual(GoalStatus.ACTIVE, client.get_state())
        self.arm.step(450)
        result = self.end(client, GoalStatus.SUCCEEDED)
        self.assertEqual(FollowJointTrajectoryResult.SUCCESSFUL, result.error_code)
        self.assertGreaterEqual(len(client.feedback), 8)
        stamps = [feedback.header.stamp.to_sec() for feedback in client.feedback]
        self.assertEqual(sorted(stamps), stamps)
        self.assertLess(stamps[-1], 1.0)  # simulated time, not the wall's
        for feedback in client.feedback:
            self.assertEqual(JOINTS, feedback.joint_names)
            s = min(1.0, feedback.desired.time_from_start.to_sec() / 0.5)
            self.assertAlmostEqual(quintic(0.2, 0.4, s), feedback.desired.positions[0], delta=1e-6)
            self.assertAlmostEqual(feedback.desired.positions[1] - feedback.actual.positions[1],
                                   feedback.error.positions[1], delta=1e-12)

    def test_goals_that_are_refused(self):
        code = FollowJointTrajectoryResult
        for message, more, expected in (
                (trajectory(point(1.0, [0.5, 1.0]), joints=["yaw", "nose"]), {}, code.INVALID_JOINTS),
                (trajectory(), {}, code.INVALID_GOAL),
                (trajectory(point(1.0, [0.5])), {}, code.INVALID_GOAL),
                (trajectory(point(0.1, [0.5, 1.0]), stamp=rospy.Time(0, 1)), {}, code.OLD_HEADER_TIMESTAMP),
                (trajectory(point(1.0, [0.5, 1.0])), {"goal_tolerance": [JointTolerance("wrist", 1.0, 0.0, 0.0)]},
                 code.INVALID_JOINTS)):
            if expected == code.OLD_HEADER_TIMESTAMP:
                self.arm.step(200)
            client = self.goal(message, **more)
            result = self.end(client, GoalStatus.REJECTED)
            self.assertEqual(expected, result.error_code, result.error_string)
            self.assertNotEqual("", result.error_string)
        self.expect_at(self.arm.step(100), ARM["yaw"], ARM["elbow"], 1e-6)

    def test_goals_that_fail_or_give_way(self):
        code = FollowJointTrajectoryResult
        # A jump of 1 rad in a millisecond: the joint cannot be there.
        client = self.goal(trajectory(point(0.001, [1.2, 1.7]), point(1.0, [1.2, 1.7])),
                           path_tolerance=[JointTolerance("yaw", 0.1, 0.0, 0.0)])
        self.arm.step(50)
        result = self.end(client, GoalStatus.ABORTED)
        self.assertEqual(code.PATH_TOLERANCE_VIOLATED, result.error_code)
        self.assertIn("'yaw'", result.error_string)
        self.arm.step(1000)
        client = self.goal(trajectory(point(0.01, [0.2, 1.7])),
                           goal_tolerance=[JointTolerance("yaw", 1e-3, 0.0, 0.0)],
                           goal_time_tolerance=rospy.Duration(0.02))
        self.arm.step(25)
        self.assertEqual(GoalStatus.ACTIVE, client.get_state())
        self.arm.step(10)
        self.assertEqual(code.GOAL_TOLERANCE_VIOLATED, self.end(client, GoalStatus.ABORTED).error_code)
        self.arm.step(1000)

        # Cancelled half-way: the joint stops where it is desired then.
        client = self.goal(trajectory(point(1.0, [0.4, 1.7])))
        self.arm.step(500)
        halfway = 0.5 * (0.4 + value(self.arm.states[-501], "position", "yaw"))
        client.cancel_goal()
        self.end(client, GoalStatus.PREEMPTED)
        self.assertAlmostEqual(halfway, value(self.arm.step(500), "position", "yaw"), delta=1e-4)

        # Another goal, a command, a reset; goals for other joints run on.
        first = self.goal(trajectory(point(1.0, [0.4, 1.7])))
        beside = self.goal(trajectory(point(0.5, [0.3]), joints=["wrist"]))
        second = self.goal(trajectory(point(0.3, [0.1]), joints=["yaw"]))
        self.end(first, GoalStatus.PREEMPTED)
        self.arm.step(350)
        self.end(second, GoalStatus.SUCCEEDED)
        self.arm.step(200)
        self.end(beside, GoalStatus.SUCCEEDED)
        client = self.goal(trajectory(point(1.0, [0.4, 1.7])))
        self.arm.give("command/position", JointState(name=["elbow"], position=[1.5]))
        self.arm.step(1)
        self.assertIn("preempted", self.end(client, GoalStatus.PREEMPTED).error_string)
        client = self.goal(trajectory(point(1.0, [0.4, 1.7])))
        self.arm.call("reset")
        self.end(client, GoalStatus.PREEMPTED)


if __name__ == "__main__":
    rospy.init_node("trajectories_test", disable_rostime=True)
    rostest.rosrun("frictional_contact_sim", "trajectories", TrajectoriesTest)
