"""Where everything is in each frame: tracks sampled at the frames' times, links of robots by forward kinematics."""
import numpy as np

from . import rotation
from .model import InputError
from .urdf import Robot

OUTSIDE = 0.1  # a body is still shown so long before its first sample and after its last one [s]


def sample(track, times):
    """(n, columns) at the times, linear between samples; NaN where there are none."""
    values = np.asarray(track.values, float)
    order = np.argsort(track.times, kind="stable")
    stamps, values = np.asarray(track.times, float)[order], values[order]
    good = np.isfinite(stamps) & np.isfinite(values).all(axis=1)
    stamps, values = stamps[good], values[good]
    if not len(stamps):
        return np.full((len(times), values.shape[1]), np.nan)
    is_pose = values.shape[1] == 7
    if is_pose:
        values = np.concatenate([values[:, :3], rotation.continuous(values[:, 3:])], axis=1)
    result = np.stack([np.interp(times, stamps, column) for column in values.T], axis=1)
    if is_pose:
        result[:, 3:] /= np.linalg.norm(result[:, 3:], axis=1, keepdims=True)
    if not track.fixed:
        result[(times < stamps[0] - OUTSIDE) | (times > stamps[-1] + OUTSIDE)] = np.nan
    return result


class LinkPoses:
    """Links of one body with something to draw."""

    def __init__(self, body, robot, links):
        self.body, self.robot, self.links = body, robot, links  # links: {name: (n, 7)}


def body_poses(body, times, notes):
    """@return LinkPoses, or None with a note where nothing says where the body is"""
    try:
        robot = Robot(body.urdf, body.name)
    except InputError as error:
        notes.append(f"{error}; it is not drawn")
        return None
    known = {name: sample(track, times) for name, track in body.links.items() if name in robot.elements}
    root = sample(body.root, times) if body.root is not None else known.get(robot.root)
    if root is None:
        if robot.root != "world" and not set(robot.links) <= set(known):
            notes.append(f"{body.name}: neither odometry nor tf says where it is; it is not drawn")
            return None
        root = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (len(times), 1))
    # Joints are recorded more often than tf is, and exactly: a link of known joints is computed.
    positions = {name: sample(track, times)[:, 0] for name, track in body.joints.items()}
    computed = {joint.child for joint in robot.joints.values()
                if joint.kind == "fixed" or joint.name in positions or (joint.mimic and joint.mimic[0] in positions)}
    known = {name: pose for name, pose in known.items() if name not in computed and (name != robot.root or body.root is None)}
    unknown = robot.unknown_joints(positions, known)
    if unknown:
        notes.append(f"{body.name}: nothing recorded of {', '.join(unknown[:3])}{' ...' if len(unknown) > 3 else ''}: drawn at zero")
    poses = robot.link_poses(root, positions, known)
    return LinkPoses(body, robot, {name: poses[name] for name in robot.drawn_links()})
