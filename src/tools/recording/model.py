"""A recording in memory: one frame a recorded state, contacts by row, step reports, bodies and what moves them.

SI units, world axes, quaternions x y z w; n frames, m contacts (over all frames), k reports.
"""
import dataclasses

import numpy as np

MODES = ["open", "sticking", "sliding", "impact"]  # by number, as in msg/Contact.msg
ENERGIES = ["kinetic", "potential", "actuators", "friction", "impact", "joints", "balance_error"]  # [J], as in msg/StepReport.msg
REPORT_COLUMNS = ["residual", "max_penetration"] + ENERGIES
STATUSES = ["NOT_RUN", "CONVERGED", "MAX_ITERATIONS", "TIME_LIMIT", "STAGNATED", "NUMERICAL_FAILURE", "STOPPED_BY_USER"]


class InputError(Exception):
    """Bad input: one line that names file or topic, what was found and what was expected."""


@dataclasses.dataclass
class Track:
    """Samples of something that moves: times (s), values (s, 1) of a joint or (s, 7) of a pose: position, quaternion."""
    times: np.ndarray
    values: np.ndarray
    fixed: bool = False  # holds before its first sample and after its last one, however long


@dataclasses.dataclass
class Contacts:
    """Rows in the order of frames; sides are indices into Recording.sides."""
    frame: np.ndarray     # (m) int
    id: np.ndarray        # (m) uint64
    side_a: np.ndarray    # (m) int
    side_b: np.ndarray
    position: np.ndarray  # (m, 3) [m]
    normal: np.ndarray    # (m, 3) unit, from b to a
    force: np.ndarray     # (m, 3) on a [N]
    velocity: np.ndarray  # (m, 3) of a relative to b [m/s]
    gap: np.ndarray       # (m) [m]
    friction: np.ndarray  # (m) mu
    mode: np.ndarray      # (m) index into MODES

    def rows(self, chosen):
        """Those of an index or a mask."""
        return Contacts(**{field.name: getattr(self, field.name)[chosen] for field in dataclasses.fields(self)})

    def normal_force(self):
        """(m) r_N / dt [N]"""
        return np.einsum("ij,ij->i", self.force, self.normal)

    def tangential_force(self):
        """(m) |r_T| / dt [N]"""
        return np.linalg.norm(self.force - self.normal_force()[:, None] * self.normal, axis=1)


@dataclasses.dataclass
class Body:
    """A robot or thing with a URDF; what moves it is found by name."""
    name: str
    urdf: str
    folder: str = ""                                  # where relative mesh paths start
    root: Track = None                                # pose of the root link
    joints: dict = dataclasses.field(default_factory=dict)  # name: Track
    links: dict = dataclasses.field(default_factory=dict)   # name: Track of the pose in the world, where tf has it


@dataclasses.dataclass
class Shape:
    """A marker of the namespace bodies: what is drawn where there is no URDF."""
    kind: str            # box, sphere, cylinder, mesh
    size: list           # edges, diameters, or scale of the mesh
    color: list          # red, green, blue, opacity
    mesh: str
    track: Track


@dataclasses.dataclass
class Recording:
    source: str
    times: np.ndarray                                 # (n) [s]
    contacts: Contacts
    sides: list                                       # (body, link) of contact sides; body "ground" of static shapes
    report_times: np.ndarray                          # (k) [s]
    reports: dict                                     # REPORT_COLUMNS: (k); "status": (k) int
    bodies: list = dataclasses.field(default_factory=list)
    shapes: list = dataclasses.field(default_factory=list)
    ground: float = None                              # height [m]
    notes: list = dataclasses.field(default_factory=list)  # what a reader has to know, a line each

    def side_name(self, side):
        body, link = self.sides[side]
        return body if body == link or not link else f"{body}/{link}" if body else link


class ContactRows:
    """Collects contacts while they are read; `array` takes chunks of rows, so that a large bag does not become lists."""
    COLUMNS = ["frame", "id", "side_a", "side_b", "mode"]
    CHUNK = 20000

    def __init__(self):
        self.sides, self.numbers, self.chunks, self.rows, self.values = [], {}, [], [], []

    def side(self, body, link):
        key = (body, link)
        if key not in self.numbers:
            self.numbers[key] = len(self.sides)
            self.sides.append(key)
        return self.numbers[key]

    def add(self, integers, numbers):
        """@param integers of COLUMNS; @param numbers position, normal, force, velocity (3 each), gap, friction"""
        self.rows.append(integers)
        self.values.append(numbers)
        if len(self.rows) >= self.CHUNK:
            self.flush()

    def flush(self):
        if self.rows:
            frame, identity, side_a, side_b, mode = zip(*self.rows)
            self.add_arrays(np.array(frame), np.array(identity, np.uint64), np.array(side_a), np.array(side_b), np.array(mode, np.uint8),
                            np.array(self.values, float))
        self.rows, self.values = [], []

    def add_arrays(self, frame, identity, side_a, side_b, mode, values):
        self.chunks.append((frame.astype(np.int64), identity, side_a.astype(np.int32), side_b.astype(np.int32), mode, values))

    def finish(self, notes):
        """Contacts in the order of frames; those with numbers that are not finite are left out, and said to be."""
        self.flush()
        empty = (np.zeros(0, np.int64), np.zeros(0, np.uint64), np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, np.uint8), np.zeros((0, 14)))
        frame, identity, side_a, side_b, mode, values = (np.concatenate(column) for column in zip(*(self.chunks or [empty])))
        mode = np.where(mode < len(MODES), mode, 0)
        contacts = Contacts(frame, identity, side_a, side_b, values[:, 0:3], values[:, 3:6], values[:, 6:9], values[:, 9:12], values[:, 12],
                            values[:, 13], mode)
        finite = np.isfinite(values).all(axis=1)
        if not finite.all():
            notes.append(f"{np.count_nonzero(~finite)} contacts with numbers that are not finite are left out")
            contacts = contacts.rows(finite)
        return contacts.rows(np.argsort(contacts.frame, kind="stable"))
