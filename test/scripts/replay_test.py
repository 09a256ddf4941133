#!/usr/bin/python3
"""replay: pages of random bags and of run_scenario's folders, decoded again and compared with what went in. Needs no browser and no npm:
scripts/test_replay looks at the page itself."""
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag

import recordings
from recordings import NODE, RandomBag, ROOT
from recording import pack, page, progress, rotation  # noqa: E402  (src/tools, by recordings)
from recording.model import InputError, Track
from recording.poses import sample

SEED = 20261128
BAGS = 8
RUN_SCENARIO = pathlib.Path(os.environ.get("FRICTIONAL_CONTACT_SIM_LIBEXEC", ROOT / "devel/lib/frictional_contact_sim")) / "run_scenario"
TURN = 3.0 / 32767.0  # of a quaternion's part: rounded, and straight between keyframes to the same


class Scripts(html.parser.HTMLParser):
    """What a browser takes for elements and for the text of scripts."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.scripts, self.open = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.open = tag == "script"
        if self.open:
            self.scripts.append("")

    def handle_endtag(self, tag):
        self.open = False

    def handle_data(self, data):
        if self.open:
            self.scripts[-1] += data


def page_of(path, every=1):
    """(recording, data as the page has it)"""
    recording, _ = progress.read(path, "", {}, progress.Progress())
    if every > 1:
        page.thin(recording, every)
    text = page.page_html(page.page_data(recording, progress.Progress()), "replay('</script>');", "body{}")
    found = Scripts(text)
    assert found.tags.count("script") == 2, found.tags
    assert found.scripts[1] == "replay('<\\/script>');", found.scripts[1]
    return recording, json.loads(found.scripts[0])


class PackTest(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(SEED)

    def test_numbers_come_back_to_half_a_step(self):
        for _ in range(50):
            rows, columns, resolution = self.rng.integers(0, 300), self.rng.integers(1, 5), 10.0**self.rng.uniform(-9, 1)
            values = self.rng.normal(size=(rows, columns)) * 10.0**self.rng.uniform(-9, 9)
            packed = json.loads(json.dumps(pack.pack_numbers(values, resolution, int(columns))))
            back = pack.unpack(packed).reshape(-1, columns)
            self.assertEqual(values.shape, back.shape)
            # Coarser only where 32 bits ask for it.
            self.assertLessEqual(packed["resolution"], max(resolution, np.max(np.abs(values), initial=0.0) / 2**29))
            self.assertLessEqual(np.max(np.abs(values - back), initial=0.0), 0.501 * packed["resolution"])

    def test_floats_come_back_as_they_are(self):
        values = np.append(self.rng.normal(size=1000), [np.nan, np.inf, -np.inf, 0.0])
        np.testing.assert_array_equal(values, pack.unpack(pack.pack_floats(values, "<f8")))
        np.testing.assert_array_equal(values.astype(np.float32), pack.unpack(pack.pack_floats(values)))

    def test_tracks_stay_within_the_tolerance_and_hide_where_they_are_not(self):
        for count in [1, 2, 3, 63, 64, 65, 66, 500, 1000]:
            time = np.linspace(0.0, 1.0, count)[:, None]
            moves = np.concatenate([self.rng.normal(size=3) * time + np.sin(30 * time) * self.rng.normal(size=3), rotation.about_axis([0, 0.6, 0.8], 20 * time[:, 0])], axis=1)
            jumps = moves + np.where(time > self.rng.random(), 5.0, 0.0) * [1, 0, 0, 0, 0, 0, 0]
            rests = np.tile(moves[0], (count, 1))
            gone = moves.copy()
            gone[self.rng.random(count) < 0.3] = np.nan
            never = np.full((count, 7), np.nan)
            poses = [moves, jumps, rests, gone, never]
            back = pack.unpack_tracks(pack.pack_tracks(poses, np.zeros(3), 1e-5), count)
            for pose, found in zip(poses, back):
                np.testing.assert_array_equal(np.isnan(pose), np.isnan(found))
                np.testing.assert_allclose(pose[:, :3], found[:, :3], atol=1.6e-5)
                sign = np.sign(np.einsum("ij,ij->i", pose[:, 3:], found[:, 3:]))[:, None]
                np.testing.assert_allclose(pose[:, 3:], sign * found[:, 3:], atol=TURN)
        self.assertEqual([], pack.unpack_tracks(pack.pack_tracks([], np.zeros(3), 1.0), 0))

    def test_what_rests_costs_nothing(self):
        rests = np.tile([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0], (10000, 1))
        self.assertLess(len(json.dumps(pack.pack_tracks([rests] * 200, np.zeros(3), 1e-5))), 20000)

    def test_forces_keep_four_digits(self):
        force = self.rng.normal(size=(1000, 3)) * 10.0**self.rng.uniform(-3, 6, (1000, 1))
        error = np.linalg.norm(pack.round_forces(force, 0.0) - force, axis=1)
        self.assertLess(np.max(error / np.linalg.norm(force, axis=1)), 1.1e-4)  # sqrt(3) / 2^14

    def test_samples_between_turn_the_short_way(self):
        track = Track(np.array([0.0, 1.0]), np.array([[0, 0, 0, 0, 0, 0, 1.0], [2, 0, 0, 0, 0, -np.sin(0.5), -np.cos(0.5)]]))
        middle = sample(track, np.array([0.5]))[0]
        np.testing.assert_allclose(middle, [1, 0, 0, 0, 0, np.sin(0.25), np.cos(0.25)], atol=1e-12)
        self.assertTrue(np.isnan(sample(track, np.array([3.0]))).all())


class BagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "random.bag"

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def compare(self, bag, data, frames=None):
        """The page's data against the bag's own."""
        frames = list(range(len(bag.times))) if frames is None else frames
        np.testing.assert_allclose(pack.unpack(data["times"]), [bag.times[i].to_sec() for i in frames], atol=1e-9)
        origin, resolution = np.array(data["origin"]), page.RESOLUTION * data["size"]
        tracks = pack.unpack_tracks(data["tracks"], len(frames))
        self.assertEqual([robot.name for robot in bag.robots], [body["name"] for body in data["bodies"]])
        for number, (robot, body) in enumerate(zip(bag.robots, data["bodies"])):
            self.assertEqual(sorted(robot.links), sorted(link["name"] for link in body["links"]))
            for place, frame in enumerate(frames):
                wanted = dict(zip(robot.links, robot.matrices(bag.roots[number][frame], bag.positions[number][frame])))
                for link in body["links"]:
                    pose = tracks[link["track"]][place] + np.append(origin, [0, 0, 0, 0])
                    found = recordings.matrix_of(pose)
                    np.testing.assert_allclose(found[:3, 3], wanted[link["name"]][:3, 3], atol=1.6 * resolution)
                    np.testing.assert_allclose(found[:3, :3], wanted[link["name"]][:3, :3], atol=6 * TURN)
        self.compare_contacts(bag, data, frames)
        for name in ("residual", "kinetic", "balance_error"):
            np.testing.assert_allclose(pack.unpack(data["reports"][name]), [getattr(report, name) for report in bag.reports], rtol=1e-6)
        np.testing.assert_array_equal(pack.unpack(data["reports"]["status"]), [report.status for report in bag.reports])

    def compare_contacts(self, bag, data, frames):
        found = pack.unpack_contacts(data["contacts"])
        rows = {}
        for row in range(len(found["frame"])):
            rows[found["frame"][row], int(found["id"][row])] = row
        self.assertEqual(sum(len(bag.contacts[i]) for i in frames), len(found["frame"]))
        origin, resolution = np.array(data["origin"]), page.RESOLUTION * data["size"]
        for place, frame in enumerate(frames):
            for contact in bag.contacts[frame]:
                row = rows[place, contact.id]
                vector = {name: np.array([getattr(getattr(contact, name), axis) for axis in "xyz"]) for name in ("position", "normal", "force", "relative_velocity")}
                self.assertEqual([contact.body_a, contact.link_a], data["sides"][int(found["side_a"][row])])
                self.assertEqual(["ground", contact.link_b], data["sides"][int(found["side_b"][row])])
                np.testing.assert_allclose(found["position"][row] + origin, vector["position"], atol=0.6 * resolution)
                np.testing.assert_allclose(found["normal"][row], vector["normal"], atol=0.6 / pack.NORMAL)
                # Four digits, but not finer than a millionth of a typical force (here below 100 N).
                self.assertLess(np.linalg.norm(found["force"][row] - vector["force"]), max(1.1e-4 * np.linalg.norm(vector["force"]), 1e-4))
                slip = np.linalg.norm(vector["relative_velocity"] - vector["relative_velocity"] @ vector["normal"] * vector["normal"])
                self.assertAlmostEqual(slip, found["slip"][row], delta=max(1e-6, 2**-12 * slip))
                self.assertAlmostEqual(contact.gap, found["gap"][row], delta=1e-3 * resolution)
                self.assertAlmostEqual(contact.friction, found["friction"][row], delta=1e-6)
                self.assertEqual(contact.mode, found["mode"][row])

    def test_random_bags_come_back(self):
        for seed in range(BAGS):
            rng = np.random.default_rng(SEED + seed)
            bag = RandomBag(rng, int(rng.choice([1, 2, 3, 40, 100])), offset=3e7 if seed % 4 == 3 else 0.0)
            bag.write(self.path)
            with self.subTest(seed):
                recording, data = page_of(self.path)
                self.compare(bag, data)
                self.assertEqual(0.5, data["ground"])
                self.assertEqual([], recording.notes)

    def test_transforms_do_where_there_is_no_odometry(self):
        bag = RandomBag(np.random.default_rng(SEED), 30)
        bag.write(self.path, ("contacts", "step_report", "bodies", "tf", "joint_states"))
        self.compare(bag, page_of(self.path)[1])

    def test_thinned_is_each_nth_frame_and_the_last_one(self):
        bag = RandomBag(np.random.default_rng(SEED + 1), 100)
        bag.write(self.path)
        recording, data = page_of(self.path, every=7)
        self.compare(bag, data, list(range(0, 99, 7)) + [99])
        self.assertIn("--every", recording.notes[0])

    def test_markers_do_where_there_are_no_documents(self):
        bag = RandomBag(np.random.default_rng(SEED + 2), 20)
        bag.write(self.path, ("contacts", "step_report", "markers"))
        _, data = page_of(self.path)
        self.assertEqual(len(bag.robots), len(data["shapes"]))
        for number, track in enumerate(pack.unpack_tracks(data["tracks"], 20)):
            np.testing.assert_allclose(track[:, :3], np.array(bag.roots[number])[:, :3], atol=1.6 * page.RESOLUTION * data["size"])
            self.assertEqual(["box", "sphere", "cylinder"][number % 3], data["shapes"][number]["kind"])

    def test_numbers_that_are_not_finite(self):
        bag = RandomBag(np.random.default_rng(SEED + 3), 20)
        bag.contacts[3] = [bag.contact(3, 0), bag.contact(3, 1)]
        bag.contacts[3][0].force.x = float("nan")
        bag.reports[4].residual = float("inf")
        bag.roots[0][5] = np.full(7, np.nan)
        bag.write(self.path)
        recording, data = page_of(self.path)
        self.assertEqual(1, sum("not finite" in note for note in recording.notes))
        found = pack.unpack_contacts(data["contacts"])
        self.assertEqual(1, np.count_nonzero(found["frame"] == 3))
        self.assertTrue(np.isfinite(np.concatenate(pack.unpack_tracks(data["tracks"], 20))).all())

    def test_after_a_reset_of_time_the_rest_is_shown(self):
        bag, path = RandomBag(np.random.default_rng(SEED + 4), 10), self.path
        bag.write(path)
        second = path.with_name("second.bag")
        with rosbag.Bag(str(path)) as source, rosbag.Bag(str(second), "w") as target:
            for shift in (0.0, 100.0):
                for topic, message, time in source.read_messages():
                    target.write(topic, message, type(time).from_sec(time.to_sec() + shift))
        recording, data = page_of(second)
        self.assertEqual(10, data["frames"])
        self.assertIn("set back", recording.notes[0])

    def test_nothing_drawn_names_what_is_missing(self):
        bag = RandomBag(np.random.default_rng(SEED + 5), 5)
        bag.write(self.path, ("contacts",))
        recording, missing = progress.read(self.path, "", {}, progress.Progress())
        self.assertEqual(1, len(missing))
        self.assertIn(f"{NODE}/step_report; record it: roslaunch", missing[0])
        self.assertIn(f"{NODE}/bodies", recording.notes[0])

    def test_the_node_is_found_or_asked_for(self):
        bag = RandomBag(np.random.default_rng(SEED + 7), 4)
        bag.write(self.path)
        other = self.path.with_name("nodes.bag")

        def copy(names):
            with rosbag.Bag(str(self.path)) as source, rosbag.Bag(str(other), "w") as target:
                for topic, message, time in source.read_messages():
                    for name in names:
                        target.write(topic.replace(NODE, name), message, time)
        copy(["/ns/sim"])
        with rosbag.Bag(str(other), "a") as target:  # of a link that is named contacts
            target.write("/ns/sim/contacts/contacts", recordings.ContactArray(), bag.times[0])
        self.compare_contacts(bag, page_of(other)[1], range(4))
        copy(["/first", "/second"])
        with self.assertRaisesRegex(InputError, "found contacts of /first, /second, expected --node"):
            progress.read(other, "", {}, progress.Progress())
        self.assertEqual(4, len(progress.read(other, "/second", {}, progress.Progress())[0].times))

    def test_a_circle_of_transforms_is_no_place(self):
        bag = RandomBag(np.random.default_rng(SEED + 8), 4)
        bag.write(self.path, ("contacts", "step_report", "bodies"))
        with rosbag.Bag(str(self.path), "a") as target:
            for child, parent in ((bag.robots[0].links[0], "a"), ("a", bag.robots[0].links[0])):
                transform = recordings.TransformStamped(child_frame_id=child)
                transform.header.frame_id, transform.transform.rotation.w = parent, 1.0
                target.write("/tf", recordings.TFMessage([transform]), bag.times[0])
        recording, data = page_of(self.path)
        self.assertEqual([], data["bodies"])
        self.assertEqual(len(bag.robots), sum("it is not drawn" in note for note in recording.notes))

    def test_damaged_bags_are_one_line(self):
        rng = np.random.default_rng(SEED + 6)
        bag = RandomBag(rng, 30)
        bag.write(self.path)
        whole, damaged = self.path.read_bytes(), self.path.with_name("damaged.bag")
        for case in range(30):
            content = bytearray(whole)
            if case % 2:
                content = content[:rng.integers(0, len(content))]
            else:
                for place in rng.integers(0, len(content), 20):
                    content[place] = rng.integers(0, 256)
            damaged.write_bytes(content)
            try:
                recording, _ = progress.read(damaged, "", {}, progress.Progress())
                page.script_text(page.page_data(recording, progress.Progress()))
            except InputError as error:
                self.assertNotIn("\n", str(error))
                self.assertIn("damaged.bag", str(error))


class ProgramTest(unittest.TestCase):
    """The program itself, in a copy of the package with a bundle of its own."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        shutil.copytree(ROOT / "src/tools", self.root / "src/tools", ignore=shutil.ignore_patterns("*.cpp", "__pycache__"))
        shutil.copy(ROOT / "package.xml", self.root)
        (self.root / "build/replay").mkdir(parents=True)
        (self.root / "build/replay/replay.js").write_text("show();")
        (self.root / "build/replay/replay.css").write_text("p{}")
        self.html = self.root / "page.html"

    def tearDown(self):
        self.folder.cleanup()

    def replay(self, *arguments):
        return subprocess.run([sys.executable, self.root / "src/tools/replay", *map(str, arguments)], capture_output=True, text=True)

    def refused(self, expected, *arguments):
        done = self.replay(*arguments)
        self.assertEqual((2, "", 1), (done.returncode, done.stdout, done.stderr.count("\n")), done.stderr)
        self.assertIn(expected, done.stderr)

    def scenario(self, *arguments):
        output = self.root / "run"
        done = subprocess.run([RUN_SCENARIO, *arguments, "--output", output, "--json"], capture_output=True, text=True, check=True)
        return output, json.loads(done.stdout)

    def data(self):
        return json.loads(Scripts(self.html.read_text()).scripts[0])

    def test_a_run_of_the_quadruped_ends_where_run_scenario_says(self):
        output, summary = self.scenario("quadruped", "--duration", "0.3")
        done = self.replay(output, "--output", self.html)
        self.assertEqual((0, ""), (done.returncode, done.stderr))
        data = self.data()
        self.assertEqual(301, data["frames"])
        body, = data["bodies"]
        self.assertEqual(13 + 4, len(body["links"]))  # trunk, legs, feet
        tracks = pack.unpack_tracks(data["tracks"], data["frames"])
        base = next(tracks[link["track"]] for link in body["links"] if link["name"] == "base")
        np.testing.assert_allclose(base[-1, :3], summary["bodies"]["quadruped"]["position"], atol=2 * page.RESOLUTION * data["size"])
        # Feet of a standing robot are spheres on the ground.
        foot = next(tracks[link["track"]] for link in body["links"] if link["name"] == "LF_FOOT")
        self.assertAlmostEqual(0.025, foot[-1, 2], delta=1e-4)
        contacts = pack.unpack_contacts(data["contacts"])
        total = contacts["force"][contacts["frame"] == 300].sum(axis=0)
        np.testing.assert_allclose(total, summary["contact_force"]["quadruped"], atol=0.02)
        self.assertEqual(0.0, data["ground"])
        self.assertLess(self.html.stat().st_size, 400e3)

    def test_no_step_and_one_step_are_proper_pages(self):
        for duration, frames in (("0", 1), ("0.001", 2)):
            output, _ = self.scenario("resting_box", "--duration", duration)
            self.assertEqual(0, self.replay(output, "--output", self.html).returncode)
            self.assertEqual(frames, self.data()["frames"])

    def test_meshes_are_embedded_and_nothing_else_is(self):
        output, _ = self.scenario("resting_box", "--duration", "0")
        secret = self.root / "secret.txt"
        secret.write_text("secret")
        (self.root / "part.stl").write_bytes(b"solid")
        urdf = self.root / "with_meshes.urdf"
        name = json.loads(json.dumps(next(csv_rows(output / "states.csv"))["body"]))
        urdf.write_text(f'<robot name="r"><link name="l"><visual><geometry><mesh filename="part.stl" scale="2 2 2"/></geometry></visual>'
                        f'<visual><geometry><mesh filename="{secret}"/></geometry></visual><visual><geometry><capsule radius="1" length="2"/></geometry></visual>'
                        f'<visual><geometry><mesh filename="package://nosuch_package/a.stl"/></geometry></visual></link></robot>')
        done = self.replay(output, "--output", self.html, "--robot", f"{name}={urdf}")
        self.assertEqual(0, done.returncode)
        self.assertEqual(2, done.stderr.count("not drawn"), done.stderr)
        data = self.data()
        self.assertEqual([b"solid"], [pack.inflate(mesh["data"]) for mesh in data["meshes"]])
        document = data["documents"][data["bodies"][0]["document"]]
        self.assertEqual(["0.stl"], re.findall(r'filename="([^"]*)"', document))
        self.assertEqual((1, 2), (document.count("<cylinder"), document.count("<sphere")))

    def test_bad_input_is_one_line(self):
        bag = self.root / "a.bag"
        self.refused("not found", self.root / "nosuch.bag", "--output", self.html)
        self.refused("--help", "--output", self.html)
        self.refused("found 0", self.root, "--every", "0", "--output", self.html)
        self.refused("no states.csv", self.root, "--output", self.html)
        self.refused("not appear to be a bag", self.root / "package.xml", "--output", self.html)
        with rosbag.Bag(str(bag), "w"):
            pass
        self.refused(f"no messages on {NODE}/contacts; record it", bag, "--output", self.html)
        self.refused("cannot read", bag, "--output", self.html, "--robot", "nosuch.urdf")
        RandomBag(np.random.default_rng(SEED), 3).write(bag)
        self.refused("cannot be written", bag, "--output", self.root / "nosuch/page.html")
        output, _ = self.scenario("quadruped", "--duration", "0.05")
        text = (output / "contacts.csv").read_text().splitlines()
        (output / "contacts.csv").write_text("\n".join([text[0].replace("fx", "gx")] + text[1:]))
        self.refused("contacts.csv: no column 'fx'", output, "--output", self.html)
        (output / "contacts.csv").write_text("\n".join(text[:3] + [text[3].replace(text[3].split(",")[7], "abc")] + text[4:]))
        self.refused("contacts.csv:4: column 'y': found 'abc'", output, "--output", self.html)
        shutil.rmtree(self.root / "build")
        self.refused("run scripts/install_replay", bag, "--output", self.html)

    def test_help_and_version(self):
        self.assertEqual(0, self.replay("--help").returncode)
        self.assertRegex(self.replay("--version").stdout, r"^replay \d+\.\d+\.\d+\n$")


def csv_rows(path):
    import csv
    with open(path, newline="") as file:
        yield from csv.DictReader(file)


if __name__ == "__main__":
    unittest.main()
