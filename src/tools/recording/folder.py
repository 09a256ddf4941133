"""Reads the output folder of run_scenario --output: states.csv, joints.csv, contacts.csv, steps.csv, bodies.csv, bodies/."""
import csv
import itertools
import pathlib

import numpy as np

from .model import Body, ContactRows, InputError, MODES, Recording, REPORT_COLUMNS, STATUSES, Track

CHUNK = 50000  # rows
POSE = ["x", "y", "z", "qx", "qy", "qz", "qw"]
CONTACT_NUMBERS = ["x", "y", "z", "nx", "ny", "nz", "fx", "fy", "fz", "vx", "vy", "vz", "gap", "friction"]
HOW = "run_scenario SCENARIO.yaml --output FOLDER"


class Table:
    """A CSV file in chunks of columns."""

    def __init__(self, path, columns, progress):
        self.path, self.columns, self.progress = path, columns, progress

    def chunks(self):
        """Dicts of column: list of texts. A last line that was cut off is left out."""
        try:
            with open(self.path, newline="", encoding="utf-8", errors="replace") as file:
                reader = csv.reader(file)
                header = next(reader, [])
                missing = [name for name in self.columns if name not in header]
                if missing:
                    raise InputError(f"{self.path}: no column '{missing[0]}', expected {','.join(self.columns)} as {HOW} writes them")
                places = [header.index(name) for name in self.columns]
                self.progress.start(self.path.stat().st_size, f"reading {self.path.name}")
                self.line = 1
                while True:
                    rows = list(itertools.islice(reader, CHUNK))
                    if not rows:
                        break
                    whole = [row for row in rows if len(row) == len(header)]
                    if len(whole) < len(rows) - 1 or (len(whole) < len(rows) and len(rows[-1]) == len(header)):
                        bad = next(index for index, row in enumerate(rows) if len(row) != len(header))
                        raise InputError(f"{self.path}:{self.line + 1 + bad}: found {len(rows[bad])} columns, expected {len(header)}")
                    if whole:
                        texts = list(zip(*whole))
                        yield {name: texts[place] for name, place in zip(self.columns, places)}
                    self.line += len(rows)
                    self.progress.update(file.buffer.tell())
                self.progress.end()
        except (OSError, csv.Error) as error:
            raise InputError(f"{self.path}: cannot be read: {error}") from None

    def numbers(self, chunk, names):
        """(rows, len(names))"""
        try:
            return np.array([np.fromiter(map(float, chunk[name]), float) for name in names]).T
        except ValueError:
            for name, row in itertools.product(names, range(len(chunk[names[0]]))):
                try:
                    float(chunk[name][row])
                except ValueError:
                    raise InputError(f"{self.path}:{self.line + 1 + row}: column '{name}': found '{chunk[name][row]}', expected a number") from None
            raise


class FolderReader:
    def __init__(self, folder, robots, progress):
        self.folder, self.robots, self.progress, self.notes = pathlib.Path(folder), robots, progress, []

    def tracks(self, name, key_columns, value_columns):
        """{key: Track} of a table with a column time."""
        numbers_of, keys, rows = {}, [], []
        table = Table(self.folder / name, ["time"] + key_columns + value_columns, self.progress)
        for chunk in table.chunks():
            rows.append(table.numbers(chunk, ["time"] + value_columns))
            keys.append(np.array([numbers_of.setdefault(key, len(numbers_of)) for key in zip(*(chunk[column] for column in key_columns))]))
        if not rows:
            return {}
        keys, rows = np.concatenate(keys), np.concatenate(rows)
        rows = rows[np.argsort(keys, kind="stable")]
        ends = np.cumsum(np.bincount(keys, minlength=len(numbers_of)))
        return {key: Track(rows[begin:end, 0], rows[begin:end, 1:]) for key, begin, end in zip(numbers_of, np.append(0, ends), ends)}

    def contacts(self, times):
        rows = ContactRows()
        table = Table(self.folder / "contacts.csv", ["time", "id", "body_a", "body_b", "link_a", "link_b", "mode"] + CONTACT_NUMBERS, self.progress)
        numbers_of_modes = {name.upper(): number for number, name in enumerate(MODES)}
        for chunk in table.chunks():
            numbers = table.numbers(chunk, ["time"] + CONTACT_NUMBERS)
            frame = np.clip(np.searchsorted(times, numbers[:, 0]), 0, max(len(times) - 1, 0))
            if not len(times) or np.any(times[frame] != numbers[:, 0]):
                raise InputError(f"{table.path}: a time that states.csv does not have; both are written by {HOW}")
            try:
                identity = np.array([int(text) for text in chunk["id"]], np.uint64)
            except (ValueError, OverflowError):
                raise InputError(f"{table.path}: column 'id', expected whole numbers") from None
            side = {key: rows.side(*key) for key in {*zip(chunk["body_a"], chunk["link_a"]), *zip(chunk["body_b"], chunk["link_b"])}}
            rows.add_arrays(frame, identity, np.array([side[key] for key in zip(chunk["body_a"], chunk["link_a"])]),
                            np.array([side[key] for key in zip(chunk["body_b"], chunk["link_b"])]),
                            np.array([numbers_of_modes.get(text.upper(), 0) for text in chunk["mode"]], np.uint8), numbers[:, 1:])
        return rows.finish(self.notes), rows.sides

    def reports(self):
        times, values, status = [np.zeros(0)], [np.zeros((0, len(REPORT_COLUMNS)))], []
        table = Table(self.folder / "steps.csv", ["time", "status"] + REPORT_COLUMNS, self.progress)
        for chunk in table.chunks():
            numbers = table.numbers(chunk, ["time"] + REPORT_COLUMNS)
            times.append(numbers[:, 0])
            values.append(numbers[:, 1:])
            status += [STATUSES.index(text) if text in STATUSES else 0 for text in chunk["status"]]
        values = np.concatenate(values)
        columns = {name: values[:, index] for index, name in enumerate(REPORT_COLUMNS)}
        columns["status"] = np.array(status, int)
        return np.concatenate(times), columns

    def bodies(self, names):
        """Of bodies.csv; [Body], height of the ground."""
        found, ground = {}, None
        if (self.folder / "bodies.csv").is_file():
            table = Table(self.folder / "bodies.csv", ["body", "urdf", "folder", "height"], self.progress)
            for chunk in table.chunks():
                for name, urdf, folder, height in zip(*(chunk[column] for column in table.columns)):
                    if height:
                        ground = float(table.numbers({"height": [height]}, ["height"])[0, 0])
                    else:
                        found[name] = (self.document(self.folder / urdf), folder)
        for name, robot in self.robots.items():
            found[name or next(iter(names), "robot")] = robot
        if not found:
            self.notes.append("no bodies.csv: no bodies are drawn (run_scenario --output writes it; --robot FILE.urdf gives one)")
        return [Body(name, *document) for name, document in found.items()], ground

    def document(self, path):
        try:
            return path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None

    def read(self):
        roots = self.tracks("states.csv", ["body"], POSE)
        times = np.unique(np.concatenate([track.times for track in roots.values()])) if roots else np.zeros(0)
        times = times[np.isfinite(times)]
        joints = self.tracks("joints.csv", ["body", "joint"], ["position"]) if (self.folder / "joints.csv").is_file() else {}
        contacts, sides = self.contacts(times)
        report_times, reports = self.reports()
        bodies, ground = self.bodies([name for name, in roots])
        for body in bodies:
            body.root = roots.get((body.name,))
            body.joints = {joint: track for (name, joint), track in joints.items() if name == body.name}
        return Recording(str(self.folder), times, contacts, sides, report_times, reports, bodies, [], ground, self.notes)


def read_folder(folder, robots, progress):
    """@return Recording"""
    missing = [name for name in ("states.csv", "contacts.csv", "steps.csv") if not (pathlib.Path(folder) / name).is_file()]
    if missing:
        raise InputError(f"{folder}: no {missing[0]} in it, expected an output folder of {HOW}")
    return FolderReader(folder, robots, progress).read()
