"""How deep the collision geometry of a URDF body is below a horizontal plane, from its pose and joint positions: an own look
at every vertex and primitive, besides what the simulator reports (for judge_robustness)."""
import xml.etree.ElementTree as ET

import numpy as np


def turn(axis, angle):
    """Rodrigues' rotation about a unit axis."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def transform(rotation, translation):
    result = np.eye(4)
    result[:3, :3] = rotation
    result[:3, 3] = translation
    return result


def vector(element, name, default):
    text = element.get(name) if element is not None else None
    return np.array([float(x) for x in text.split()]) if text else np.array(default, float)


def origin(element):
    found = element.find('origin')
    roll, pitch, yaw = vector(found, 'rpy', (0, 0, 0))
    rotation = turn((0, 0, 1), yaw) @ turn((0, 1, 0), pitch) @ turn((1, 0, 0), roll)
    return transform(rotation, vector(found, 'xyz', (0, 0, 0)))


def stl_vertices(path):
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], 'little')
    if len(data) == 84 + 50 * count:
        facets = np.frombuffer(data[84:], np.dtype([('normal', '<f4', 3), ('points', '<f4', (3, 3)), ('rest', '<u2')]))
        return facets['points'].reshape(-1, 3).astype(float)
    return np.array([line.split()[1:4] for line in data.decode().splitlines() if 'vertex' in line], float)


def obj_vertices(path):
    return np.array([line.split()[1:4] for line in path.read_text().splitlines() if line.startswith('v ')], float)


class Shape:
    """Points of a collision element in its link's frame, and a ball that is laid around each of them."""

    def __init__(self, collision, folder):
        geometry = collision.find('geometry')[0]
        self.radius = 0.0
        self.rim = None
        if geometry.tag == 'mesh':
            path = folder / geometry.get('filename').replace('file://', '')
            read = obj_vertices if path.suffix == '.obj' else stl_vertices
            points = np.unique(read(path), axis=0) * vector(geometry, 'scale', (1, 1, 1))
        elif geometry.tag == 'box':
            signs = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T
            points = signs * vector(geometry, 'size', None)
        elif geometry.tag == 'sphere':
            points, self.radius = np.zeros((1, 3)), float(geometry.get('radius'))
        else:  # cylinder or capsule
            half = 0.5 * float(geometry.get('length'))
            points = np.array([(0, 0, -half), (0, 0, half)])
            if geometry.tag == 'cylinder':
                self.rim = float(geometry.get('radius'))
            else:
                self.radius = float(geometry.get('radius'))
        pose = origin(collision)
        self.points = points @ pose[:3, :3].T + pose[:3, 3]
        self.axis = pose[:3, 2]

    def lowest(self, pose):
        heights = self.points @ pose[2, :3] + pose[2, 3]
        drop = self.radius if self.rim is None else \
            self.rim * np.sqrt(max(0.0, 1.0 - float(pose[2, :3] @ self.axis) ** 2))
        return heights.min() - drop


class Geometry:
    """A URDF file's joints and collision shapes."""

    def __init__(self, path):
        tree = ET.parse(path).getroot()
        self.shapes = {link.get('name'): [Shape(shape, path.parent) for shape in link.findall('collision')]
                       for link in tree.findall('link')}
        self.joints = [(joint.find('parent').get('link'), joint.find('child').get('link'), joint.get('name'),
                        joint.get('type'), origin(joint), vector(joint.find('axis'), 'xyz', (1, 0, 0)))
                       for joint in tree.findall('joint')]
        children = {joint[1] for joint in self.joints}
        self.root = next(name for name in self.shapes if name not in children)
        # Joints of several coordinates have no position in joints.csv: what hangs on them is left out.
        self.is_known = all(joint[3] in ('fixed', 'revolute', 'continuous', 'prismatic') for joint in self.joints)

    def lowest(self, root_pose, positions):
        """Height of the lowest point of all shapes; positions {joint: value}. [m]"""
        poses = {self.root: root_pose}
        waiting = list(self.joints)
        while waiting:
            parent, child, name, kind, pose, axis = waiting.pop(0)
            if parent not in poses:
                waiting.append((parent, child, name, kind, pose, axis))
                continue
            axis = axis / np.linalg.norm(axis)
            value = positions.get(name, 0.0)
            motion = np.eye(4)
            if kind in ('revolute', 'continuous'):
                motion = transform(turn(axis, value), np.zeros(3))
            elif kind == 'prismatic':
                motion = transform(np.eye(3), value * axis)
            poses[child] = poses[parent] @ pose @ motion
        heights = [shape.lowest(poses[link]) for link, shapes in self.shapes.items() for shape in shapes]
        return min(heights) if heights else np.inf
