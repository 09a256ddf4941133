"""A URDF as a tree of links: where links are for given joint positions, and a document that a page may draw.

The document comes from a bag, so nothing in it is trusted: names are replaced by numbers, only geometry and colours go on.
"""
import dataclasses
import xml.etree.ElementTree as ElementTree

import numpy as np

from . import rotation
from .model import InputError

TURNING = ("revolute", "continuous")
GEOMETRIES = ("box", "sphere", "cylinder", "mesh", "capsule")


@dataclasses.dataclass
class Joint:
    name: str
    kind: str
    parent: str
    child: str
    origin: np.ndarray  # (7)
    axis: np.ndarray    # (3)
    mimic: tuple        # (joint, multiplier, offset) or None


def numbers(element, attribute, default):
    """Those of an attribute; of a missing element or a text that holds no such numbers the default."""
    text = element.get(attribute) if element is not None else None
    try:
        found = [float(part) for part in text.split()] if text is not None else []
    except ValueError:
        found = []
    return np.array(found) if len(found) == len(default) and np.isfinite(found).all() else np.array(default, float)


def origin(element):
    found = element.find("origin")
    return np.concatenate([numbers(found, "xyz", [0.0] * 3), rotation.from_rpy(*numbers(found, "rpy", [0.0] * 3))])


class Robot:
    """links: names, parents before children; joints: by child link."""

    def __init__(self, document, where):
        try:
            self.root_element = ElementTree.fromstring(document)
        except ElementTree.ParseError as error:
            raise InputError(f"{where}: the URDF cannot be read: {error}") from None
        self.elements = {link.get("name", ""): link for link in self.root_element.findall("link")}
        self.joints = {}
        for element in self.root_element.findall("joint"):
            parent, child = element.find("parent"), element.find("child")
            if parent is None or child is None or parent.get("link") not in self.elements or child.get("link") not in self.elements:
                continue
            axis = numbers(element.find("axis"), "xyz", [1.0, 0.0, 0.0])
            length = np.linalg.norm(axis)
            mimic = element.find("mimic")
            self.joints[child.get("link")] = Joint(
                element.get("name", ""), element.get("type", "fixed"), parent.get("link"), child.get("link"), origin(element),
                axis / length if length > 0.0 else axis,
                None if mimic is None else (mimic.get("joint", ""), float(numbers(mimic, "multiplier", [1.0])[0]),
                                            float(numbers(mimic, "offset", [0.0])[0])))
        self.links = self._order()
        if not self.links:
            raise InputError(f"{where}: the URDF has no root link")

    def _order(self):
        children = {}
        for joint in self.joints.values():
            children.setdefault(joint.parent, []).append(joint.child)
        order = [name for name in self.elements if name not in self.joints][:1]
        for name in order:  # grows while it is walked; a circle is never reached from a root
            order.extend(children.get(name, []))
        return order

    @property
    def root(self):
        return self.links[0]

    def drawn_links(self):
        """Those with something to draw."""
        return [name for name in self.links if drawn(self.elements[name])]

    def link_poses(self, root, positions, known):
        """{link: (n, 7)} in the world. @param root (n, 7) @param positions {joint: (n)} @param known {link: (n, 7)}: not computed"""
        poses = {}
        for name in self.links:
            if name in known:
                poses[name] = known[name]
            elif name == self.root:
                poses[name] = root
            else:
                joint = self.joints[name]
                poses[name] = rotation.compose(rotation.compose(poses[joint.parent], joint.origin), self._motion(joint, positions, len(root)))
        return poses

    def _motion(self, joint, positions, count):
        value = positions.get(joint.name)
        if value is None and joint.mimic and joint.mimic[0] in positions:
            value = joint.mimic[1] * positions[joint.mimic[0]] + joint.mimic[2]
        pose = np.zeros((count, 7))
        pose[:, 6] = 1.0
        if value is None:
            return pose
        if joint.kind in TURNING:
            pose[:, 3:] = rotation.about_axis(joint.axis, value)
        elif joint.kind == "prismatic":
            pose[:, :3] = value[:, None] * joint.axis
        return pose

    def unknown_joints(self, positions, known):
        """Names of those that move and of which nothing is recorded."""
        return [joint.name for joint in self.joints.values() if joint.kind != "fixed" and joint.name not in positions and
                joint.child not in known and not (joint.mimic and joint.mimic[0] in positions)]

    def page_document(self, use_mesh):
        """URDF text with links l0, l1, ... (as in `links`) and nothing but what is drawn.
        @param use_mesh(filename) -> name of an embedded mesh, or None where there is none"""
        robot = ElementTree.Element("robot", name="robot")
        colors = {material.get("name"): material.find("color") for material in self.root_element.findall("material")}
        for number, name in enumerate(self.links):
            link = ElementTree.SubElement(robot, "link", name=f"l{number}")
            for element in drawn(self.elements[name]):
                append_visual(link, element, colors, use_mesh)
        for number, name in enumerate(self.links[1:], 1):
            joint = ElementTree.SubElement(robot, "joint", name=f"j{number}", type="fixed")
            ElementTree.SubElement(joint, "parent", link=f"l{self.links.index(self.joints[name].parent)}")
            ElementTree.SubElement(joint, "child", link=f"l{number}")
        return ElementTree.tostring(robot, encoding="unicode")


def shape_of(element):
    """The element of its geometry, or None."""
    geometry = element.find("geometry")
    return next((child for child in geometry if child.tag in GEOMETRIES), None) if geometry is not None else None


def drawn(link):
    """<visual> elements, or <collision> ones where there are none."""
    return [element for element in link.findall("visual") if shape_of(element) is not None] or \
        [element for element in link.findall("collision") if shape_of(element) is not None]


def text(values):
    return " ".join(repr(float(value)) for value in values)


def append_visual(link, element, colors, use_mesh):
    shape = shape_of(element)
    found = element.find("origin")
    xyz, rpy = numbers(found, "xyz", [0.0] * 3), numbers(found, "rpy", [0.0] * 3)
    material = element.find("material")
    color = None
    if material is not None:
        color = material.find("color")
        color = colors.get(material.get("name")) if color is None else color
    rgba = None if color is None else np.clip(numbers(color, "rgba", [0.6, 0.6, 0.6, 1.0]), 0.0, 1.0)

    def add(tag, attributes, shift=0.0):
        visual = ElementTree.SubElement(link, "visual")
        place = xyz + rotation.rotate(rotation.from_rpy(*rpy), [0.0, 0.0, shift])
        ElementTree.SubElement(visual, "origin", xyz=text(place), rpy=text(rpy))
        ElementTree.SubElement(ElementTree.SubElement(visual, "geometry"), tag, attributes)
        if rgba is not None:
            ElementTree.SubElement(ElementTree.SubElement(visual, "material", name=""), "color", rgba=text(rgba))

    if shape.tag == "mesh":
        name = use_mesh(shape.get("filename", ""))
        if name is not None:
            add("mesh", {"filename": name, "scale": text(numbers(shape, "scale", [1.0] * 3))})
    elif shape.tag == "box":
        add("box", {"size": text(numbers(shape, "size", [0.0] * 3))})
    elif shape.tag == "sphere":
        add("sphere", {"radius": text(numbers(shape, "radius", [0.0]))})
    else:
        radius, length = numbers(shape, "radius", [0.0]), numbers(shape, "length", [0.0])
        add("cylinder", {"radius": text(radius), "length": text(length)})
        if shape.tag == "capsule":  # length is that of the cylindrical part
            add("sphere", {"radius": text(radius)}, 0.5 * length[0])
            add("sphere", {"radius": text(radius)}, -0.5 * length[0])
