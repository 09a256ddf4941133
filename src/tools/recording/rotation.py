"""Quaternions x y z w and poses (position, quaternion) by arrays: the last axis holds 4 or 7 numbers, the others broadcast."""
import numpy as np


def multiply(a, b):
    """The rotation b, then a."""
    ax, ay, az, aw = np.moveaxis(np.asarray(a, float), -1, 0)
    bx, by, bz, bw = np.moveaxis(np.asarray(b, float), -1, 0)
    return np.stack([aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz], axis=-1)


def rotate(quaternion, vector):
    quaternion, vector = np.asarray(quaternion, float), np.asarray(vector, float)
    axis = quaternion[..., :3]
    twice = 2.0 * np.cross(axis, vector)
    return vector + quaternion[..., 3:] * twice + np.cross(axis, twice)


def compose(a, b):
    """The pose b in the frame a."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    position = a[..., :3] + rotate(a[..., 3:], b[..., :3])
    return np.concatenate([position, np.broadcast_to(multiply(a[..., 3:], b[..., 3:]), position.shape[:-1] + (4,))], axis=-1)


def from_rpy(roll, pitch, yaw):
    """Of fixed axes x, y, z in turn, as in URDF."""
    def about(axis, angle):
        quaternion = np.zeros(4)
        quaternion[axis], quaternion[3] = np.sin(angle / 2.0), np.cos(angle / 2.0)
        return quaternion
    return multiply(about(2, yaw), multiply(about(1, pitch), about(0, roll)))


def about_axis(axis, angles):
    """(n, 4) of angles (n) about a unit axis (3)."""
    half = 0.5 * np.asarray(angles, float)[..., None]
    return np.concatenate([np.sin(half) * np.asarray(axis, float), np.cos(half)], axis=-1)


def continuous(quaternions):
    """(n, 4) of unit length, each with the sign nearer to the one before: fit to be interpolated."""
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    unit = np.where(length > 0.0, quaternions / np.where(length > 0.0, length, 1.0), [0.0, 0.0, 0.0, 1.0])
    flips = np.where(np.einsum("ij,ij->i", unit[1:], unit[:-1]) < 0.0, -1.0, 1.0)
    return unit * np.concatenate([[1.0], np.cumprod(flips)])[:, None] if len(unit) else unit
