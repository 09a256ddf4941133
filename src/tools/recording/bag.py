"""Reads a bag of simulator_node: of simulate.launch bag:=..., record_bag or rosbag record."""
import numpy as np

from . import rotation
from .model import Body, ContactRows, InputError, Recording, REPORT_COLUMNS, Shape, Track
from .urdf import Robot

CONTACTS = "frictional_contact_sim/ContactArray"
HOW = "roslaunch frictional_contact_sim simulate.launch ... bag:=FILE.bag (or rosbag record -a)"
KINDS = {1: "box", 2: "sphere", 3: "cylinder", 10: "mesh"}  # of visualization_msgs/Marker
TRIANGLES = 11
DEEPEST = 200  # frames above one another in tf


def open_bag(path):
    try:
        import rosbag
    except ImportError:
        raise InputError("python3-rosbag is missing: scripts/install_dependencies packages.txt") from None
    try:
        return rosbag.Bag(str(path))
    except rosbag.ROSBagUnindexedException:
        raise InputError(f"{path}: the bag was not closed: rosbag reindex {path}") from None
    except (rosbag.ROSBagException, ValueError, OSError, KeyError) as error:
        raise InputError(f"{path}: no bag can be read from it: {' '.join(str(error).split())}") from None


def xyz(vector):
    return (vector.x, vector.y, vector.z)


def pose_numbers(position, quaternion):
    return (position.x, position.y, position.z, quaternion.x, quaternion.y, quaternion.z, quaternion.w)


class Samples:
    """Of many things by name, while they are read."""

    def __init__(self):
        self.times, self.values = {}, {}

    def add(self, name, time, values):
        self.times.setdefault(name, []).append(time)
        self.values.setdefault(name, []).append(values)

    def __contains__(self, name):
        return name in self.times

    def track(self, name, fixed=False):
        return Track(np.array(self.times[name]), np.array(self.values[name], float), fixed)


class BagReader:
    def __init__(self, path, bag, node, robots, progress):
        self.path, self.bag, self.robots, self.progress = path, bag, robots, progress
        self.types = {topic: info.msg_type for topic, info in self.bag.get_type_and_topic_info().topics.items()}
        self.node = node or self.find_node()
        self.contacts, self.frame_times = ContactRows(), []
        self.report_times, self.reports = [], []
        self.joints, self.odometry, self.transforms, self.parents = Samples(), Samples(), Samples(), {}
        self.static, self.frames_of = set(), {}
        self.markers, self.marker_of = Samples(), {}
        self.bodies, self.ground, self.notes = {}, None, []

    def find_node(self):
        """The one with contacts, else with reports; NODE/contacts/LINK are of the same type and of the same node."""
        for name, kind in (("/contacts", CONTACTS), ("/step_report", "frictional_contact_sim/StepReport")):
            found = {topic[:-len(name)] for topic, found_kind in self.types.items() if found_kind == kind and topic.endswith(name)}
            found = sorted(node for node in found if not any(node.startswith(other + "/contacts") for other in found))
            if len(found) > 1:
                raise InputError(f"{self.path}: found contacts of {', '.join(found)}, expected --node with one of them")
            if found:
                return found[0]
        return "/simulator_node"

    def handlers(self):
        """{topic: function of a message}"""
        names = {"contacts": self.take_contacts, "step_report": self.take_report, "bodies": self.take_bodies, "markers": self.take_markers}
        handlers = {f"{self.node}/{name}": function for name, function in names.items()}
        namespace = self.node.rpartition("/")[0]
        handlers[namespace + "/joint_states"] = self.take_joints
        handlers["/tf"] = self.take_transforms
        handlers["/tf_static"] = lambda message: self.take_transforms(message, True)
        for topic, kind in self.types.items():
            if kind == "nav_msgs/Odometry" and topic.startswith(self.node + "/ground_truth/"):
                handlers[topic] = self.odometry_taker(topic)
        return {topic: function for topic, function in handlers.items() if topic in self.types}

    def missing(self, *names):
        """One line a topic that the bag does not have, and how to record it."""
        return [f"{self.path}: no messages on {self.node}/{name}; record it: {HOW}" for name in names if f"{self.node}/{name}" not in self.types]

    def begin(self):
        """Bag time from which on no stamp of contacts is earlier than those before: after a reset of time only the rest is shown."""
        topic, last, begin = f"{self.node}/contacts", 0.0, None
        if topic not in self.types:
            topic = f"{self.node}/step_report"
        if topic in self.types:
            for _, (_, data, _, _, _), time in self.bag.read_messages(topics=[topic], raw=True):
                stamp = int.from_bytes(data[4:8], "little") + 1e-9 * int.from_bytes(data[8:12], "little")  # of the header
                if stamp < last:
                    begin = time
                last = stamp
        return begin

    def read(self):
        handlers = self.handlers()
        total = sum(info.message_count for topic, info in self.bag.get_type_and_topic_info(list(handlers)).topics.items())
        begin = self.begin()
        if begin is not None:
            self.notes.append("time was set back in this bag: shown is what came after that")
        self.progress.start(total, "reading")
        lasting = {f"{self.node}/bodies", "/tf_static"}
        for count, (topic, message, time) in enumerate(self.bag.read_messages(topics=list(handlers))):
            if begin is None or time >= begin or topic in lasting:
                handlers[topic](message)
            if count % 500 == 0:
                self.progress.update(count)
        self.progress.end()
        return self.recording()

    # ------------------------------------------------------------------------------------------------------ messages
    def take_contacts(self, message):
        stamp = message.header.stamp.to_sec()
        if self.frame_times and stamp == self.frame_times[-1]:
            return  # the same state once more, for a new subscriber
        frame = len(self.frame_times)
        self.frame_times.append(stamp)
        side, add = self.contacts.side, self.contacts.add
        for contact in message.contacts:
            add((frame, contact.id, side(contact.body_a or "ground", contact.link_a), side(contact.body_b or "ground", contact.link_b), contact.mode),
                xyz(contact.position) + xyz(contact.normal) + xyz(contact.force) + xyz(contact.relative_velocity) +
                (contact.gap, contact.friction))

    def take_report(self, message):
        self.report_times.append(message.header.stamp.to_sec())
        self.reports.append([message.status] + [getattr(message, name) for name in REPORT_COLUMNS])

    def take_bodies(self, message):
        self.ground = message.ground_height if np.isfinite(message.ground_height) else None
        for name, document, folder in zip(message.names, message.urdfs, message.folders):
            self.bodies[name] = Body(name, document, folder)

    def take_joints(self, message):
        stamp = message.header.stamp.to_sec()
        for name, position in zip(message.name, message.position):
            self.joints.add(name, stamp, (position,))

    def take_transforms(self, message, fixed=False):
        for transform in message.transforms:
            child, move = transform.child_frame_id.lstrip("/"), transform.transform
            self.parents[child] = transform.header.frame_id.lstrip("/")
            self.transforms.add(child, transform.header.stamp.to_sec(), pose_numbers(move.translation, move.rotation))
            if fixed:
                self.static.add(child)

    def odometry_taker(self, topic):
        body = topic[len(self.node + "/ground_truth/"):].rpartition("/")[0]

        def take(message):
            self.odometry.add(body, message.header.stamp.to_sec(), pose_numbers(message.pose.pose.position, message.pose.pose.orientation))
            self.frames_of[body] = message.child_frame_id
        return take

    def take_markers(self, message):
        for marker in message.markers:
            if marker.ns != "bodies" or marker.action != 0:
                continue
            if marker.type in KINDS:
                self.markers.add(marker.id, marker.header.stamp.to_sec(), pose_numbers(marker.pose.position, marker.pose.orientation))
                self.marker_of[marker.id] = marker
            elif marker.type == TRIANGLES and self.ground is None:
                self.ground = marker.pose.position.z

    # ------------------------------------------------------------------------------------------------------ together
    def world_track(self, frame, below=()):
        """Of a tf frame, its chain of parents followed to one that has none; None where tf does not have it, or has a circle."""
        if frame not in self.transforms or frame in below or len(below) > DEEPEST:
            return None
        own = self.transforms.track(frame, frame in self.static)
        if self.parents[frame] not in self.transforms:
            return own
        above = self.world_track(self.parents[frame], (*below, frame))
        if above is None:
            return None
        from .poses import sample  # poses knows tracks; here only to join two of them
        base = own if above.fixed and not own.fixed else above
        return Track(base.times, rotation.compose(sample(Track(above.times, above.values, True), base.times),
                                                  sample(Track(own.times, own.values, True), base.times)), own.fixed and above.fixed)

    def connect(self, body, is_first):
        """Finds what moves a body by the names that the node gives: NAME where it is the only one, else BODY/NAME."""
        try:
            robot = Robot(body.urdf, body.name)
        except InputError:
            return  # said once, where it is drawn
        for joint in robot.joints.values():
            name = next((name for name in (f"{body.name}/{joint.name}", joint.name) if name in self.joints), None)
            if name is not None:
                body.joints[joint.name] = self.joints.track(name)
        if body.name in self.odometry:
            body.root = self.odometry.track(body.name)
        elif is_first and "" in self.odometry:
            body.root = self.odometry.track("")
        for link in robot.links:
            if link == robot.root and body.root is not None:
                continue
            joint = robot.joints.get(link)
            if joint is not None and (joint.kind == "fixed" or joint.name in body.joints):
                continue
            track = next((track for track in map(self.world_track, (f"{body.name}/{link}", link)) if track is not None), None)
            if track is not None:
                body.links[link] = track

    def recording(self):
        times = np.array(self.frame_times or self.report_times)
        if not len(times):
            moving = [samples.times[name] for samples in (self.joints, self.odometry, self.transforms) for name in samples.times]
            times = np.unique(np.concatenate(moving)) if moving else np.zeros(0)
        bodies = dict(self.bodies)
        for name, (document, folder) in self.robots.items():
            bodies[name or next(iter(bodies), "robot")] = Body(name or next(iter(bodies), "robot"), document, folder)
        for index, body in enumerate(bodies.values()):
            self.connect(body, index == 0)
        shapes = []
        if not bodies:
            for number, marker in sorted(self.marker_of.items()):
                shapes.append(Shape(KINDS[marker.type], list(xyz(marker.scale)), [marker.color.r, marker.color.g, marker.color.b, marker.color.a],
                                    marker.mesh_resource, self.markers.track(number)))
            if not shapes:
                self.notes.append(f"the bag has neither {self.node}/bodies nor markers: no bodies are drawn (--robot FILE.urdf gives one)")
        reports = np.array(self.reports, float).reshape(-1, 1 + len(REPORT_COLUMNS))
        columns = {name: reports[:, 1 + index] for index, name in enumerate(REPORT_COLUMNS)}
        columns["status"] = reports[:, 0].astype(int)
        # Steps that failed have a report without contacts; both have the stamp of their end.
        return Recording(str(self.path), times, self.contacts.finish(self.notes), self.contacts.sides, np.array(self.report_times), columns,
                         list(bodies.values()), shapes, self.ground, self.notes)


def read_bag(path, node, robots, progress):
    """@param node name of the simulator_node, empty: the only one. @param robots {body or "": (URDF document, folder)}
    @return Recording and the lines that say which topics are missing"""
    try:
        with open_bag(path) as bag:
            reader = BagReader(path, bag, node, robots, progress)
            return reader.read(), reader.missing("contacts", "step_report")
    except InputError:
        raise
    except Exception as error:  # what rosbag, genpy, struct, zlib, bz2, lz4 raise where a bag is damaged: any kind
        raise InputError(f"{path}: the bag cannot be read: {' '.join(str(error).split()) or type(error).__name__}") from None
