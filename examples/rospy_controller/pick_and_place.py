#!/usr/bin/python3
"""The arm of the scenario pick_and_place grasps the part, lifts it, holds it for a second, turns and sets it down.

By topics: positions and velocities a hundred times a simulated second. With --action: a goal of
~follow_joint_trajectory for each move. The fingers close with an effort either way.
"""
import math
import sys

import actionlib
import rospy
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from frictional_contact_sim.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryGoal,
                                        FollowJointTrajectoryResult)

NODE = "/simulator_node"
ARM = ["yaw", "shoulder", "elbow", "wrist"]
LINK = 0.35  # of upper arm and forearm [m]
SHOULDER_HEIGHT = 0.4  # [m]
REACH = 0.45  # where the part lies, and is set down [m]
LOW, HIGH = 0.115, 0.33  # of the wrist: fingers around the part, well above it [m]
GRIP = -16.0  # half of it on each pad [N]
SECONDS = 1.0  # of a move


def posture(yaw, height):
    """Joint angles that bring the wrist to a height with the hand pointing down."""
    x, z = REACH, height - SHOULDER_HEIGHT
    bend = math.acos(math.hypot(x, z) / (2.0 * LINK))
    shoulder = math.atan2(-z, x) - bend
    return [yaw, shoulder, 2.0 * bend, 0.5 * math.pi - shoulder - 2.0 * bend]


class Arm:
    def __init__(self):
        self.positions = rospy.Publisher(NODE + "/command/position", JointState, queue_size=10)
        self.efforts = rospy.Publisher(NODE + "/command/effort", JointState, queue_size=10)
        while not all(topic.get_num_connections() for topic in (self.positions, self.efforts)):
            rospy.sleep(0.01)
        self.at = posture(0.0, HIGH)

    def move(self, goal):
        """A smooth way in joint angles: 6 s^5 - 15 s^4 + 10 s^3, at rest at both ends."""
        start, begin, rate = self.at, rospy.get_time(), rospy.Rate(100)
        while True:
            s = min(1.0, (rospy.get_time() - begin) / SECONDS)
            share = s ** 3 * (10.0 - 15.0 * s + 6.0 * s ** 2)
            speed = 30.0 * s ** 2 * (1.0 - s) ** 2 / SECONDS
            self.positions.publish(JointState(name=ARM, position=[a + share * (b - a) for a, b in zip(start, goal)],
                                              velocity=[speed * (b - a) for a, b in zip(start, goal)]))
            if s == 1.0:
                break
            rate.sleep()
        self.at = goal

    def grip(self, effort):
        self.efforts.publish(JointState(name=["left_finger"], effort=[effort]))
        rospy.sleep(0.3)


class ActionArm(Arm):
    def __init__(self):
        super().__init__()
        self.client = actionlib.SimpleActionClient(NODE + "/follow_joint_trajectory", FollowJointTrajectoryAction)
        self.client.wait_for_server()

    def move(self, goal):
        rest = [0.0] * len(ARM)
        point = JointTrajectoryPoint(positions=goal, velocities=rest, accelerations=rest,
                                     time_from_start=rospy.Duration(SECONDS))
        self.client.send_goal_and_wait(
            FollowJointTrajectoryGoal(trajectory=JointTrajectory(joint_names=ARM, points=[point])))
        result = self.client.get_result()
        if result is None or result.error_code != FollowJointTrajectoryResult.SUCCESSFUL:
            sys.exit(f"pick_and_place: the move to {goal} failed: {self.client.get_goal_status_text()}")


def main():
    rospy.init_node("pick_and_place")
    arm = ActionArm() if "--action" in rospy.myargv()[1:] else Arm()
    arm.move(posture(0.0, LOW))
    arm.grip(GRIP)
    arm.move(posture(0.0, HIGH))
    rospy.sleep(1.5)
    arm.move(posture(0.6, HIGH))
    arm.move(posture(0.6, LOW))
    arm.grip(-0.25 * GRIP)
    arm.move(posture(0.6, HIGH))


if __name__ == "__main__":
    main()
