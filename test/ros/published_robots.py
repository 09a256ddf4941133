#!/usr/bin/env python3
"""rosrun with nothing but a robot_description: every robot of ../shared/robots falls on the ground, arms and hands are fixed."""
import os
import re
import sys
import unittest

import rospy
import rostest
from node_runner import PACKAGE_DIR, Node

ROBOTS = PACKAGE_DIR.parent / "shared/robots"
FIXED = ("panda", "ur5", "tiago", "allegro", "gripper", "hand", "arm")
STEPS = 300
END_LINE = re.compile(r"end: (\d+) steps, (\S+) s simulated.* worst residual (\S+), failed steps (\d+), "
                      r"deepest penetration (\S+) m")


class PublishedRobots(unittest.TestCase):
    def test_every_robot_runs(self):
        robots = sorted(ROBOTS.glob("**/*.urdf"))
        self.assertTrue(robots, f"no robots in {ROBOTS}")
        os.environ["ROS_PACKAGE_PATH"] += f":{ROBOTS}"
        faults = [fault for robot in robots for fault in self.faults(robot)]
        self.assertEqual([], faults)

    def faults(self, robot):
        parameters = {"num_steps": STEPS, "real_time_factor": 0}
        if any(name in robot.stem for name in FIXED):
            parameters["base"] = "fixed"
        node = Node(parameters, robot.read_text(), robot.parent)  # H2's meshes are named relative to its file
        code = node.wait()
        end = END_LINE.search(node.stdout())
        if code != 0 or not end:
            yield f"{robot.stem}: exit code {code}: {node.stderr()[-300:]}"
            return
        if (end[1], end[4]) != (str(STEPS), "0"):
            yield f"{robot.stem}: {end[0]}"
        if not (float(end[3]) <= 1e-8 and float(end[5]) <= 1e-4):
            yield f"{robot.stem}: {end[0]}"


if __name__ == "__main__":
    rospy.init_node("published_robots")
    rostest.rosrun("frictional_contact_sim", "published_robots", PublishedRobots, sys.argv)
