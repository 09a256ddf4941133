"""Starts simulator_node from a test, with parameters of its own, and waits for its end."""
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time

import rospy

PACKAGE_DIR = pathlib.Path(__file__).resolve().parent.parent.parent
NAME = "/simulator_node"
TIMEOUT = 60.0  # of any single wait: generous, the machine may be loaded [s]


def box_urdf():
    return (PACKAGE_DIR / "test/ros/box_10kg.urdf").read_text()


def quadruped_urdf():
    return (PACKAGE_DIR / "urdf/quadruped.urdf").read_text()


class Node:
    """The node as a child process; what it prints goes to files."""

    def __init__(self, parameters, robot_description=None, folder=None):
        for name in (NAME, "/robot_description"):
            if rospy.has_param(name):
                rospy.delete_param(name)
        if parameters:
            rospy.set_param(NAME, parameters)
        if robot_description is not None:
            rospy.set_param("/robot_description", robot_description)
        # Read through a handle of its own: seeking in the one the node writes to would move its writes too.
        self.log = tempfile.NamedTemporaryFile(mode="w")
        self.output = tempfile.NamedTemporaryFile(mode="w")
        environment = dict(os.environ, ROSCONSOLE_FORMAT="[${severity}] ${message}")
        self.process = subprocess.Popen(["rosrun", "frictional_contact_sim", "simulator_node"], stderr=self.log,
                                        stdout=self.output, env=environment, cwd=folder)

    def wait(self, timeout=TIMEOUT):
        """Exit code; a node that does not end is killed and gives None."""
        try:
            return self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return None

    def interrupt(self, timeout=TIMEOUT):
        self.process.send_signal(signal.SIGINT)
        return self.wait(timeout)

    def stderr(self):
        with open(self.log.name) as log:
            return log.read()

    def stdout(self):
        with open(self.output.name) as output:
            return output.read()

    def lines(self, severity):
        """Messages of one severity, without colours."""
        text = re.sub(r"\x1b\[\d*m", "", self.stderr())
        return [line for line in text.splitlines() if re.match(rf"\[ *{severity}\]", line)]


def wait_until(condition, timeout=TIMEOUT):
    """True when the condition comes to hold in time (wall clock)."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return condition()


def read_once(topic):
    """The next message of a topic as text, read by a process of its own."""
    return subprocess.run(["rostopic", "echo", "-n", "1", topic], stdout=subprocess.PIPE, text=True, timeout=TIMEOUT,
                          check=True).stdout
