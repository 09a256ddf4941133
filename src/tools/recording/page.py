"""The replay page: a recording as data (page_data), and data, bundle and frame as one HTML file (page_html)."""
import html
import json
import pathlib
import re

import numpy as np

from . import pack
from .model import ENERGIES, InputError, MODES, STATUSES
from .poses import body_poses, sample

RESOLUTION = 2e-5   # of positions, in sizes of the scene
FAR = 1000.0        # from there on positions are told from an origin of their own, in sizes of the scene
MESHES = (".stl", ".dae", ".obj")
FRAME = pathlib.Path(__file__).resolve().parent / "page.html"


class Meshes:
    """Files of meshes, each once. From a bag any path may come: only files of meshes are read."""

    def __init__(self, notes):
        self.notes, self.numbers, self.data = notes, {}, []

    def path(self, uri, folder):
        found = re.match(r"package:/+([^/]+)/+(.*)", uri)
        if found:
            import rospkg
            try:
                return pathlib.Path(rospkg.RosPack().get_path(found[1])) / found[2]
            except rospkg.ResourceNotFound:
                return None
        uri = re.sub(r"^file:/*", "/", uri)
        return pathlib.Path(uri) if uri.startswith("/") else pathlib.Path(folder) / uri if folder else None

    def use(self, uri, folder):
        """The name by which the page has it, or None with a note."""
        path = self.path(uri, folder)
        key = str(path or uri)
        if key not in self.numbers:
            self.numbers[key] = self.read(path, uri)
        return self.numbers[key]

    def read(self, path, uri):
        kind = path.suffix.lower() if path is not None else ""
        if path is None or kind not in MESHES:
            self.notes.append(f"mesh {uri}: not drawn, {'the package is not found' if path is None else 'expected .stl, .dae or .obj'}")
            return None
        try:
            self.data.append({"data": pack.deflate(path.read_bytes())})
        except OSError as error:
            self.notes.append(f"mesh {path}: not drawn: {error.strerror}")
            return None
        return f"{len(self.data) - 1}{kind}"


def thin(recording, every):
    """Each so many frames and the last one. Contacts in between are left out: they are not added up."""
    count = len(recording.times)
    frames = np.unique(np.concatenate([np.arange(0, count, every), [count - 1]]))
    place = np.full(count, -1)
    place[frames] = np.arange(len(frames))
    recording.times = recording.times[frames]
    chosen = recording.contacts.rows(place[recording.contacts.frame] >= 0)
    chosen.frame = place[chosen.frame]
    recording.contacts = chosen
    recording.notes.append(f"one frame of {every} is shown (--every)")


def scene_size(positions):
    """Extent of a typical frame [m]; 1 where nothing is seen."""
    if not len(positions):
        return 1.0
    low, high = np.percentile(positions, [1.0, 99.0], axis=0)
    size = float(np.max(high - low))
    return size if size > 0.0 else 1.0


def page_data(recording, progress):
    """The recording as a dict for JSON."""
    times, notes, meshes = recording.times, recording.notes, Meshes(recording.notes)
    bodies, documents, tracks = [], {}, []
    progress.start(len(recording.bodies), "placing bodies")
    for count, body in enumerate(recording.bodies):
        progress.update(count)
        found = body_poses(body, times, notes)
        if found is None:
            continue
        document = found.robot.page_document(lambda uri, folder=body.folder: meshes.use(uri, folder))
        bodies.append({"name": body.name, "document": documents.setdefault(document, len(documents)),
                       "links": [{"name": name, "number": found.robot.links.index(name), "track": len(tracks) + index}
                                 for index, name in enumerate(found.links)]})
        tracks.extend(found.links.values())
    progress.end()
    shapes = []
    for shape in recording.shapes:
        mesh = meshes.use(shape.mesh, "") if shape.kind == "mesh" else None
        if shape.kind != "mesh" or mesh is not None:
            shapes.append({"kind": shape.kind, "size": finite(shape.size), "color": finite(shape.color), "mesh": mesh, "track": len(tracks)})
            tracks.append(sample(shape.track, times))
    seen = [track[:: max(len(times) // 100, 1), :3] for track in tracks] + [recording.contacts.position[:: max(len(recording.contacts.frame) // 1000, 1)]]
    seen = np.concatenate(seen) if seen else np.zeros((0, 3))
    seen = seen[np.isfinite(seen).all(axis=1)]
    size = scene_size(seen)
    middle = np.median(seen, axis=0) if len(seen) else np.zeros(3)
    origin = np.rint(middle) if np.max(np.abs(middle)) > FAR * size else np.zeros(3)
    resolution = RESOLUTION * size
    return {"source": recording.source, "frames": len(times), "times": pack.pack_floats(times, "<f8"), "modes": MODES, "statuses": STATUSES,
            "energies": ENERGIES, "size": size, "origin": origin.tolist(), "ground": recording.ground, "bodies": bodies, "documents": list(documents),
            "meshes": meshes.data, "shapes": shapes, "tracks": pack.pack_tracks(tracks, origin, resolution),
            "sides": [list(side) for side in recording.sides], "contacts": pack.pack_contacts(recording.contacts, origin, resolution),
            "report_times": pack.pack_floats(recording.report_times, "<f8"),
            "reports": {name: pack.pack_numbers(column) if name == "status" else pack.pack_floats(column) for name, column in recording.reports.items()},
            "notes": notes}


def finite(values):
    return [float(value) if np.isfinite(value) else 0.0 for value in values]


def script_text(data):
    """JSON that stays inside its script element, whatever names it holds."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for letter in "<>&":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


def page_html(data, bundle, style):
    """One self-contained file. @param bundle script @param style CSS, both of the bundle"""
    parts = {"TITLE": html.escape(f"replay of {pathlib.Path(data['source']).name}"), "STYLE": style, "DATA": script_text(data),
             "BUNDLE": re.sub(r"</(script)", r"<\\/\1", bundle, flags=re.IGNORECASE)}
    return re.sub(r"<!--(TITLE|STYLE|DATA|BUNDLE)-->", lambda found: parts[found[1]], FRAME.read_text(encoding="utf-8"))


def read_bundle(folders):
    """Script and style of the first folder that has them."""
    for folder in folders:
        script, style = folder / "replay.js", folder / "replay.css"
        if script.is_file() and style.is_file():
            return script.read_text(encoding="utf-8"), style.read_text(encoding="utf-8")
    raise InputError("the page's script is not built: run scripts/install_replay once (npm and three.js come with it)")
