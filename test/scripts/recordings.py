"""Random recordings for the tests of plot_bag and replay: bags written by the rosbag API, with what a hostile one may hold."""
import math
import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "src" / "tools"))

import genpy  # noqa: E402
import rosbag  # noqa: E402
from frictional_contact_sim.msg import Bodies, Contact, ContactArray, StepReport  # noqa: E402
from geometry_msgs.msg import Point, TransformStamped, Vector3  # noqa: E402
from nav_msgs.msg import Odometry  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from tf2_msgs.msg import TFMessage  # noqa: E402
from visualization_msgs.msg import Marker, MarkerArray  # noqa: E402

NODE = "/simulator_node"
HOSTILE = ['</script><script>window.injected=1</script>', 'a"b\'c', "<!--", "]]>&amp;", "name with spaces", "\u2028\u00e9\U0001f916", "<!--DATA-->", "\\u003c", "_$\\frac{1$"]


def attribute(text):
    from xml.sax.saxutils import quoteattr
    return quoteattr(text)


def unit(rng, size):
    vector = rng.normal(size=size)
    return vector / np.linalg.norm(vector)


class RandomRobot:
    """A tree of links with revolute, prismatic and fixed joints; its poses computed by matrices, as the test's own reference."""

    def __init__(self, rng, name, tag):
        self.name = name
        self.links = [f"{tag}link{i}{rng.choice(HOSTILE)}" for i in range(rng.integers(1, 6))]
        self.joints = []
        for child in range(1, len(self.links)):
            self.joints.append({"name": f"{tag}joint{child}{rng.choice(HOSTILE)}", "parent": int(rng.integers(0, child)), "child": child,
                                "kind": str(rng.choice(["revolute", "continuous", "prismatic", "fixed"])), "xyz": rng.uniform(-1, 1, 3),
                                "rpy": rng.uniform(-3, 3, 3), "axis": rng.normal(size=3)})

    def urdf(self):
        text = [f"<robot name={attribute(self.name)}>"]
        for link in self.links:
            text.append(f'<link name={attribute(link)}><visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual></link>')
        for joint in self.joints:
            xyz, rpy, axis = (" ".join(repr(float(value)) for value in joint[key]) for key in ("xyz", "rpy", "axis"))
            text.append(f'<joint name={attribute(joint["name"])} type="{joint["kind"]}"><parent link={attribute(self.links[joint["parent"]])}/>'
                        f'<child link={attribute(self.links[joint["child"]])}/><origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/></joint>')
        return "".join(text) + "</robot>"

    def matrices(self, root, positions):
        """[4x4] of the links for a root pose (7) and {joint: position}."""
        result = [matrix_of(root)]
        for joint in self.joints:
            move, value, axis = np.eye(4), positions.get(joint["name"], 0.0), joint["axis"] / np.linalg.norm(joint["axis"])
            if joint["kind"] == "prismatic":
                move[:3, 3] = value * axis
            elif joint["kind"] != "fixed":
                cross = np.cross(np.eye(3), axis)  # K of Rodrigues' formula
                move[:3, :3] = np.eye(3) + math.sin(value) * cross + (1.0 - math.cos(value)) * cross @ cross
            origin = np.eye(4)
            (cr, cp, cy), (sr, sp, sy) = np.cos(joint["rpy"]), np.sin(joint["rpy"])
            origin[:3, :3] = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ \
                np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
            origin[:3, 3] = joint["xyz"]
            result.append(result[joint["parent"]] @ origin @ move)
        return result


def matrix_of(pose):
    x, y, z, w = np.asarray(pose[3:]) / np.linalg.norm(pose[3:])
    matrix = np.eye(4)
    matrix[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                      [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                      [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    matrix[:3, 3] = pose[:3]
    return matrix


class RandomBag:
    """What is in the bag, to be compared: times, robots, roots[robot][frame], positions[robot][frame], contacts[frame]."""

    def __init__(self, rng, frames, offset=0.0):
        self.rng = rng
        self.times = [genpy.Time.from_sec(0.001 * (i + 1)) for i in range(frames)]
        self.robots = [RandomRobot(rng, f"body{i}" + str(rng.choice(HOSTILE)), f"r{i}" if i else "") for i in range(rng.integers(1, 4))]
        self.roots, self.positions = [], []
        for robot in self.robots:
            speed, spin, start = rng.uniform(-3, 3, 3), unit(rng, 3) * rng.uniform(0, 20), rng.uniform(-1, 1, 3) + offset
            rates = {joint["name"]: rng.uniform(-8, 8) for joint in robot.joints}
            stop = rng.integers(0, frames + 1)  # from there on it rests
            roots, positions = [], []
            for i in range(frames):
                time = 0.001 * min(i, stop)
                angle = np.linalg.norm(spin) * time
                turn = np.append(np.sin(angle / 2) * spin / max(np.linalg.norm(spin), 1e-9), np.cos(angle / 2)) * rng.choice([-1, 1])
                roots.append(np.concatenate([start + speed * time + [0, 0, -4.905 * time * time], turn]))
                positions.append({name: rate * time for name, rate in rates.items()})
            self.roots.append(roots)
            self.positions.append(positions)
        self.contacts = [[self.contact(i, n) for n in range(rng.integers(0, 6))] for i in range(frames)]
        for i in range(1, frames):
            if rng.random() < 0.5:  # nothing changes: a run goes on
                self.contacts[i] = self.contacts[i - 1]
        self.reports = [StepReport(step=i + 1, dt=0.001, status=int(rng.integers(0, 7)), residual=10.0**rng.uniform(-16, -6), max_penetration=rng.uniform(0, 1e-6),
                                   kinetic=rng.normal(), potential=rng.normal(), actuators=rng.normal(), friction=rng.normal(), impact=rng.normal(),
                                   joints=rng.normal(), balance_error=1e-9 * rng.normal()) for i in range(frames)]

    def contact(self, frame, number):
        rng, robot = self.rng, self.robots[self.rng.integers(0, len(self.robots))]
        normal = unit(rng, 3)
        force = rng.uniform(0, 100) * normal + rng.normal(size=3)
        place = self.roots[0][frame][:3] + rng.uniform(-1, 1, 3)
        return Contact(id=int(rng.integers(0, 2**64, dtype=np.uint64)) // 8 * 8 + number, body_a=robot.name, link_a=robot.links[-1], body_b="", link_b="ground",
                       position=Point(*place), normal=Vector3(*normal), force=Vector3(*force), relative_velocity=Vector3(*rng.normal(size=3)),
                       gap=rng.normal() * 1e-6, friction=rng.uniform(0, 1.5), mode=int(rng.integers(0, 4)))

    def write(self, path, topics=("contacts", "step_report", "bodies", "odom", "joint_states")):
        with rosbag.Bag(str(path), "w") as bag:
            if "bodies" in topics:
                message = Bodies(names=[robot.name for robot in self.robots], urdfs=[robot.urdf() for robot in self.robots],
                                 folders=[""] * len(self.robots), ground_height=0.5)
                bag.write(f"{NODE}/bodies", message, self.times[0] if self.times else genpy.Time(1))
            for i, time in enumerate(self.times):
                for topic, message in self.messages(i, topics):
                    if hasattr(message, "header"):
                        message.header.stamp = time
                    bag.write(topic, message, time)

    def messages(self, i, topics):
        for number, robot in enumerate(self.robots):
            pose = self.roots[number][i]
            if "odom" in topics:
                message = Odometry(child_frame_id=robot.links[0])
                fill_pose(message.pose.pose, pose)
                # Topic names are letters; the node's own rule is that the body's name stands in them.
                yield f"{NODE}/ground_truth/" + ("odom" if number == 0 else f"{robot.name}/odom"), message
            if "tf" in topics:
                message = TransformStamped(child_frame_id=robot.links[0])
                message.header.frame_id, message.header.stamp = "world", self.times[i]
                message.transform.translation = Vector3(*pose[:3])
                (message.transform.rotation.x, message.transform.rotation.y, message.transform.rotation.z, message.transform.rotation.w) = pose[3:]
                yield "/tf", TFMessage([message])
            if "markers" in topics:
                marker = Marker(ns="bodies", id=number, type=1 + number % 3, scale=Vector3(0.1, 0.2, 0.3))
                marker.header.stamp = self.times[i]
                marker.color.r, marker.color.g, marker.color.a = 0.8, 0.4, 0.9
                fill_pose(marker.pose, pose)
                yield f"{NODE}/markers", MarkerArray([marker])
        if "joint_states" in topics:
            names = [joint["name"] for robot in self.robots for joint in robot.joints if joint["kind"] != "fixed"]
            values = [self.positions[number][i][joint["name"]] for number, robot in enumerate(self.robots) for joint in robot.joints
                      if joint["kind"] != "fixed"]
            yield "/joint_states", JointState(name=names, position=values)
        if "contacts" in topics:
            yield f"{NODE}/contacts", ContactArray(contacts=self.contacts[i])
        if "step_report" in topics:
            yield f"{NODE}/step_report", self.reports[i]


def fill_pose(message, pose):
    message.position = Point(*pose[:3])
    message.orientation.x, message.orientation.y, message.orientation.z, message.orientation.w = pose[3:]
