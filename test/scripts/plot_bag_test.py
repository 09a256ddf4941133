#!/usr/bin/python3
"""plot_bag and plot_rolling DIR: what the pictures show against sums done one by one, pictures of random bags, and bad input."""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag

from recordings import NODE, RandomBag, ROOT
from recording import pictures, progress  # src/tools, by recordings

SEED = 20261129
NAMES = ["energy", "friction_use", "modes", "normal_forces", "penetration", "residual"]


def run(program, *arguments):
    return subprocess.run([sys.executable, ROOT / program, *map(str, arguments)], capture_output=True, text=True)


class QuantitiesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "random.bag"
        cls.bag = RandomBag(np.random.default_rng(SEED), 200)
        cls.bag.write(cls.path)
        cls.recording, _ = progress.read(cls.path, "", {}, progress.Progress())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def parts(self, contact):
        """(r_N, |r_T|) / dt"""
        force, normal = (np.array([vector.x, vector.y, vector.z]) for vector in (contact.force, contact.normal))
        along = float(force @ normal)
        return along, float(np.linalg.norm(force - along * normal))

    def test_normal_forces_are_sums_by_link(self):
        found = dict(pictures.normal_forces(self.recording))
        sums = {}
        for frame, contacts in enumerate(self.bag.contacts):
            for contact in contacts:
                name = contact.body_a if contact.body_a == contact.link_a else f"{contact.body_a}/{contact.link_a}"
                sums.setdefault(name, np.zeros(200))[frame] += self.parts(contact)[0]
        self.assertEqual(sorted(sums), sorted(found))
        for name in sums:
            np.testing.assert_allclose(found[name], sums[name], atol=1e-9)

    def test_many_links_are_the_largest_and_the_rest(self):
        limit, pictures.MOST_SIDES = pictures.MOST_SIDES, 1
        try:
            found = pictures.normal_forces(self.recording)
        finally:
            pictures.MOST_SIDES = limit
        whole = pictures.normal_forces(self.recording)
        np.testing.assert_allclose(sum(force for _, force in found), sum(force for _, force in whole))
        self.assertEqual(min(2, len(whole)), len(found))

    def test_friction_use_is_the_largest_of_a_frame(self):
        largest, mean = pictures.friction_use(self.recording)
        for frame, contacts in enumerate(self.bag.contacts):
            uses = [tangential / (contact.friction * normal) for contact in contacts for normal, tangential in [self.parts(contact)] if normal > 1e-3]
            if uses:
                self.assertAlmostEqual(max(uses), largest[frame], delta=1e-9 * max(uses))
                self.assertAlmostEqual(np.mean(uses), mean[frame], delta=1e-9 * max(uses))
            elif not any(self.parts(contact)[0] > 0 for contact in contacts):
                self.assertTrue(np.isnan(largest[frame]))

    def test_an_envelope_leaves_no_value_out(self):
        rng = np.random.default_rng(SEED)
        for _ in range(20):
            count = int(rng.integers(1, 30000))
            times, values = np.sort(rng.uniform(0, 10, count)), rng.normal(size=count)
            values[rng.random(count) < 0.1] = np.nan
            middle, low, high = pictures.envelope(times, values)
            good = np.isfinite(values)
            if not good.any():
                continue
            self.assertLessEqual(len(middle), 2 * pictures.BINS)
            self.assertEqual((np.nanmin(values), np.nanmax(values)), (low.min(), high.max()))
            # Every value lies in the band of the stretch that it is in.
            place = np.searchsorted(middle, times[good], side="right") - 1
            self.assertTrue(np.all((low[place] <= values[good]) & (values[good] <= high[place])))


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def refused(self, expected, program, *arguments):
        done = run(program, *arguments)
        self.assertEqual((2, "", 1), (done.returncode, done.stdout, done.stderr.count("\n")), done.stderr)
        self.assertIn(expected, done.stderr)

    def test_pictures_of_a_random_bag(self):
        bag = self.root / "random.bag"
        recorded = RandomBag(np.random.default_rng(SEED + 1), 50)
        recorded.robots[0].name = "_$\\frac{1$"  # no formula, and not hidden
        recorded.contacts[0] = [recorded.contact(0, number) for number in range(20)]
        recorded.write(bag)
        done = run("src/tools/plot_bag", bag)
        self.assertEqual((0, ""), (done.returncode, done.stderr))
        folder = self.root / "random_plots"
        self.assertEqual([str(folder / f"{name}.png") for name in NAMES], sorted(done.stdout.split()))
        for name in NAMES:
            self.assertEqual(b"\x89PNG", (folder / f"{name}.png").read_bytes()[:4])

    def test_a_topic_less_is_one_line_and_the_rest_is_drawn(self):
        bag = self.root / "part.bag"
        RandomBag(np.random.default_rng(SEED + 2), 1).write(bag, ("step_report",))
        done = run("src/tools/plot_bag", bag, "--output", self.root / "out")
        self.assertEqual((0, 1, 3), (done.returncode, done.stderr.count("\n"), done.stdout.count("\n")), done.stderr)
        self.assertIn(f"no messages on {NODE}/contacts; record it: roslaunch", done.stderr)

    def test_bad_input_is_one_line(self):
        bag = self.root / "empty.bag"
        with rosbag.Bag(str(bag), "w"):
            pass
        self.refused(f"no messages on {NODE}/contacts; record it", "src/tools/plot_bag", bag)
        self.refused("not found", "src/tools/plot_bag", self.root / "nosuch.bag")
        self.refused("no CASE_nodes.csv", "scripts/plot_rolling", self.root)
        (self.root / "a_nodes.csv").write_text("run,x\n0,1\n")
        self.refused("a_nodes.csv: no column 'width'", "scripts/plot_rolling", self.root)

    def test_plot_rolling_draws_a_folder_of_ones_own(self):
        with open(self.root / "mine_nodes.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow("run,x,width,r_N,r_T,slip,state,closed_N,closed_T".split(","))
            for i in range(9):
                table.writerow([0, 0.01 * i, 0.01, 1.0, 0.1, 0.0, "stick", 1.0, 0.1])
        (self.root / "mine_runs.csv").write_text("run,friction,lower_modulus,Q\n0,0.3,inf,-1.0\n")
        (self.root / "mine_history_0.csv").write_text("step,Q\n1,-0.5\n2,-1.0\n")
        (self.root / "mine_curve_0.yaml").write_text("creep_curve:\n  creepage: [0, 0.1]\n  traction: [0, 1]\n")
        done = run("scripts/plot_rolling", self.root, "--output", self.root / "out")
        self.assertEqual((0, ""), (done.returncode, done.stderr))
        self.assertEqual([str(self.root / f"out/mine_{name}.png") for name in ("creep", "history", "tractions")], done.stdout.split())


if __name__ == "__main__":
    unittest.main()
