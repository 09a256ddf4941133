"""Numbers as compact text for a page, and back again: rounded, differences of neighbours, bytes by significance, deflated, base64.

web/src/unpack.js reads the same.
"""
import base64
import zlib

import numpy as np

from . import rotation

BLOCK = 64        # longest stretch between two keyframes [frames]
NORMAL = 32768.0   # steps of a normal's parts
FORCE_BITS = 14   # of the largest component of a contact force
SLIP_BITS = 12    # of a sliding speed
LARGEST = 2**29   # of a rounded number: differences and their zigzag stay within 32 bits


def deflate(data):
    return base64.b64encode(zlib.compress(data, 9)).decode("ascii")


def inflate(text):
    return zlib.decompress(base64.b64decode(text))


def planes(values):
    """The lowest bytes of all numbers, then the next ones, ...: what changes little stays together."""
    return values.reshape(-1).view(np.uint8).reshape(-1, values.itemsize).T.tobytes()


def unplanes(data, kind):
    return np.frombuffer(data, np.uint8).reshape(np.dtype(kind).itemsize, -1).T.copy().view(kind).reshape(-1)


def pack_floats(values, kind="<f4"):
    """As they are; NaN and infinities too."""
    return {"kind": "f4" if kind == "<f4" else "f8", "data": deflate(planes(np.ascontiguousarray(values, kind)))}


def pack_numbers(values, resolution=1.0, columns=1):
    """Rounded to multiples of a resolution, which is made coarser where the range asks for it."""
    values = np.asarray(values, float).reshape(-1, columns)
    largest = float(np.max(np.abs(values), initial=0.0))
    resolution = max(resolution, largest / LARGEST)
    rounded = np.rint(values / resolution).astype(np.int64)
    steps = np.diff(rounded, axis=0, prepend=np.zeros((1, columns), np.int64)).T
    zigzag = ((steps << 1) ^ (steps >> 63)).astype("<u4")  # small ones of both signs have zero high bytes
    return {"kind": "int", "columns": columns, "resolution": resolution, "data": deflate(planes(np.ascontiguousarray(zigzag)))}


def unpack(packed):
    """(rows) or (rows, columns); what web/src/unpack.js does."""
    data = inflate(packed["data"])
    if packed["kind"] != "int":
        return unplanes(data, "<" + packed["kind"])
    zigzag = unplanes(data, "<u4").astype(np.int64).reshape(packed["columns"], -1)
    steps = (zigzag >> 1) ^ -(zigzag & 1)
    values = np.cumsum(steps, axis=1).T * packed["resolution"]
    return values[:, 0] if packed["columns"] == 1 else values


def keyframes(pose, position_tolerance, rotation_tolerance):
    """Indices of frames between which a pose (n, 7; quaternions continuous) goes straight, within the tolerances.

    Stretches of BLOCK frames are halved until each is straight; all of one length at a time.
    """
    count = len(pose)
    keep = np.zeros(count, bool)
    keep[[0, -1]] = True
    begins, stride = np.arange(0, max(count - 1, 1), BLOCK), BLOCK
    keep[begins] = True
    limit = np.array([position_tolerance] * 3 + [rotation_tolerance] * 4)
    while stride > 1 and len(begins):
        ends = np.minimum(begins + stride, count - 1)
        index = np.minimum(begins[:, None] + np.arange(stride + 1), ends[:, None])
        share = (index - begins[:, None]) / np.maximum(ends - begins, 1)[:, None]
        line = pose[begins][:, None] * (1.0 - share[..., None]) + pose[ends][:, None] * share[..., None]
        bent = (np.abs(pose[index] - line) > limit).any(axis=(1, 2))
        stride //= 2
        begins = np.concatenate([begins[bent], begins[bent] + stride])
        begins = np.sort(begins[begins < count - 1])
        keep[begins] = True
    return np.flatnonzero(keep)


def pack_tracks(poses, origin, position_resolution, rotation_resolution=1.0 / 32767.0):
    """@param poses list of (n, 7), NaN where a thing is not there. @return the tracks' keyframes, one after the other, and
    `shown`: for each track the stretches [first, last] of frames where it is there"""
    counts, indices, values, shown = [], [], [], []
    for pose in poses:
        there = np.isfinite(pose).all(axis=1)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], there, [False]]).astype(int)))
        shown.append([[int(first), int(last) - 1] for first, last in edges.reshape(-1, 2)])
        if not there.any():
            counts.append(0)
            continue
        # Where it is not there it stays where it was, or will be: nothing to store.
        source = np.maximum.accumulate(np.where(there, np.arange(len(pose)), -1))
        filled = pose[np.where(source < 0, np.argmax(there), source)]
        filled = np.concatenate([filled[:, :3] - origin, rotation.continuous(filled[:, 3:])], axis=1)
        keys = keyframes(filled, position_resolution, rotation_resolution)
        counts.append(len(keys))
        indices.append(np.diff(keys, prepend=0))
        values.append(filled[keys])
    values = np.concatenate(values) if values else np.zeros((0, 7))
    return {"counts": counts, "shown": shown, "advance": pack_numbers(np.concatenate(indices) if indices else []),
            "position": pack_numbers(values[:, :3], position_resolution, 3),
            "rotation": pack_numbers(values[:, 3:], rotation_resolution, 4)}


def unpack_tracks(packed, count):
    """[(count, 7)] as the page draws them, without the origin."""
    keys_all, position, turn = unpack(packed["advance"]), unpack(packed["position"]).reshape(-1, 3), unpack(packed["rotation"]).reshape(-1, 4)
    result, first = [], 0
    for number, shown in zip(packed["counts"], packed["shown"]):
        pose = np.full((count, 7), np.nan)
        if number:
            rows = slice(first, first + number)
            keys = np.cumsum(keys_all[rows])
            values = np.concatenate([position[rows], turn[rows]], axis=1)
            pose = np.stack([np.interp(np.arange(count), keys, column) for column in values.T], axis=1)
            pose[:, 3:] /= np.linalg.norm(pose[:, 3:], axis=1, keepdims=True)
            hidden = np.ones(count, bool)
            for begin, end in shown:
                hidden[begin:end + 1] = False
            pose[hidden] = np.nan
        first += number
        result.append(pose)
    return result


def round_slip(speed):
    """(m) to SLIP_BITS, nothing below a micrometre a second."""
    mantissa, exponent = np.frexp(np.where(speed < 1e-6, 0.0, speed))
    return np.ldexp(np.rint(np.ldexp(mantissa, SLIP_BITS)), exponent - SLIP_BITS)


def round_forces(force, smallest):
    """(m, 3), each contact's components to FORCE_BITS of the largest of them; none finer than `smallest`."""
    largest = np.max(np.abs(force), axis=1, initial=0.0)
    _, exponent = np.frexp(np.maximum(largest, 1e-300))
    quantum = np.maximum(np.ldexp(1.0, exponent - FORCE_BITS), smallest)[:, None]
    return np.rint(force / quantum) * quantum


def pack_contacts(contacts, origin, position_resolution):
    """Runs: stretches of frames in which a contact (its id and sides) and its rounded numbers stay the same."""
    slip = contacts.velocity - np.einsum("ij,ij->i", contacts.velocity, contacts.normal)[:, None] * contacts.normal
    size = np.linalg.norm(contacts.force, axis=1)
    typical = float(np.median(size[size > 0.0])) if (size > 0.0).any() else 1.0
    # A contact is an id between two sides; its rows stand together, in the order of frames.
    order = np.lexsort((contacts.frame, contacts.side_b, contacts.side_a, contacts.id))
    contacts, slip = contacts.rows(order), slip[order]
    new = np.zeros(len(order), bool)
    new[:1] = True
    for column in (contacts.id, contacts.side_a, contacts.side_b):
        new[1:] |= column[1:] != column[:-1]
    key, first, frame = np.cumsum(new) - 1, np.flatnonzero(new), contacts.frame
    rounded = np.concatenate([np.rint((contacts.position - origin) / position_resolution) * position_resolution,
                              np.rint(contacts.normal * NORMAL) / NORMAL,
                              round_forces(contacts.force, 1e-6 * typical),
                              np.rint(contacts.gap / (1e-3 * position_resolution))[:, None] * 1e-3 * position_resolution,
                              round_slip(np.linalg.norm(slip, axis=1))[:, None],
                              np.float32(contacts.friction)[:, None], contacts.mode[:, None]], axis=1)
    same = (np.diff(key) == 0) & (np.diff(frame) == 1) & (np.diff(rounded, axis=0) == 0.0).all(axis=1)
    starts = np.flatnonzero(np.concatenate([[True], ~same])) if len(key) else np.zeros(0, int)
    lengths = np.diff(np.concatenate([starts, [len(key)]])) if len(starts) else starts
    runs = rounded[starts]
    identity = contacts.id[first]
    return {"keys": {"id_low": pack_numbers(identity & np.uint64(0xffff)), "id_middle": pack_numbers((identity >> np.uint64(16)) & np.uint64(0xffffff)),
                     "id_high": pack_numbers(identity >> np.uint64(40)),
                     "side_a": pack_numbers(contacts.side_a[first]), "side_b": pack_numbers(contacts.side_b[first])},
            "key": pack_numbers(key[starts]), "start": pack_numbers(frame[starts]), "length": pack_numbers(lengths),
            "position": pack_numbers(runs[:, 0:3], position_resolution, 3), "normal": pack_numbers(runs[:, 3:6], 1.0 / NORMAL, 3),
            "force": pack_floats(runs[:, 6:9].T), "gap": pack_numbers(runs[:, 9], 1e-3 * position_resolution),
            "slip": pack_floats(runs[:, 10]), "friction": pack_floats(runs[:, 11]), "mode": pack_numbers(runs[:, 12])}


def unpack_contacts(packed):
    """Rows again, one a contact and frame, in the order of keys and frames: dict of arrays."""
    start, length, key = (unpack(packed[name]).astype(np.int64) for name in ("start", "length", "key"))
    row = np.repeat(np.arange(len(start)), length)
    ids = {name: unpack(packed["keys"][name]) for name in packed["keys"]}
    identity = (ids["id_high"].astype(np.uint64) << np.uint64(40)) | (ids["id_middle"].astype(np.uint64) << np.uint64(16)) | ids["id_low"].astype(np.uint64)
    within = np.arange(len(row)) - np.repeat(np.cumsum(length) - length, length)
    columns = {name: unpack(packed[name])[row] for name in ("gap", "slip", "friction", "mode")}
    return dict(columns, frame=start[row] + within, id=identity[key][row], side_a=ids["side_a"][key][row], side_b=ids["side_b"][key][row],
                position=unpack(packed["position"]).reshape(-1, 3)[row], normal=unpack(packed["normal"]).reshape(-1, 3)[row],
                force=unpack(packed["force"]).reshape(3, -1).T[row])
