#!/usr/bin/python3
"""The replay page in headless Chromium: no console error, no request, the slider moves the robot to where the recording has it, a click in
a plot moves time, hostile names stay text. Run by scripts/test_replay; pictures in build/replay/pictures are to be looked at."""
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from recordings import matrix_of, RandomBag, ROOT
from recording import pack, progress  # src/tools, by recordings

SEED = 20261130
PICTURES = ROOT / "build/replay/pictures"
RUN_SCENARIO = ROOT / "devel/lib/frictional_contact_sim/run_scenario"
TIMEOUT = 300  # of one page, software rendering on a loaded machine [s]


def browse(html, picture, wanted):
    PICTURES.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(["node", ROOT / "test/scripts/browse.mjs", html, PICTURES / picture, json.dumps(wanted)], capture_output=True, text=True,
                          timeout=TIMEOUT, env=dict(os.environ, NODE_PATH=str(ROOT / "build/replay/npm/node_modules")))
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


def data_of(html):
    text = html.read_text()
    begin = text.index('id="recording">') + len('id="recording">')
    return json.loads(text[begin:text.index("</script>", begin)])


class BrowserTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.html = self.root / "page.html"

    def tearDown(self):
        self.folder.cleanup()

    def replay(self, source, *arguments):
        done = subprocess.run([sys.executable, ROOT / "src/tools/replay", source, "--output", self.html, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stderr)

    def scenario(self, name, duration):
        output = self.root / name
        subprocess.run([RUN_SCENARIO, name, "--duration", str(duration), "--output", output, "--json"], check=True, capture_output=True)
        return output

    def check_clean(self, result):
        self.assertEqual(([], [], "", None, 1), tuple(result[key] for key in ("errors", "requests", "failed", "injected", "scripts")))

    def test_the_slider_moves_the_quadruped(self):
        self.replay(self.scenario("quadruped", 0.4))
        links = [["quadruped", name] for name in ("base", "LF_FOOT", "RH_SHANK")]
        frames = [0, 7, 12, 400]
        result = browse(self.html, "quadruped.png", {"frames": frames, "links": links, "click": 0.5, "numbers": True, "select": True, "play": 3})
        self.check_clean(result)
        self.assertEqual(frames, result["frames"])
        data = data_of(self.html)
        tracks = pack.unpack_tracks(data["tracks"], data["frames"])
        track = {link["name"]: link["track"] for link in data["bodies"][0]["links"]}
        for frame, found in zip(frames, result["links"]):
            for (_, name), matrix in zip(links, found):
                np.testing.assert_allclose(np.reshape(matrix, (4, 4)).T, matrix_of(tracks[track[name]][frame]), atol=1e-5)
        self.assertGreater(result["links"][0][0][14] - result["links"][3][0][14], 1e-3)  # it has come down
        before, after = result["clicked"]
        self.assertAlmostEqual(0.4, before, delta=1e-6)
        self.assertAlmostEqual(0.2, after, delta=0.02)
        self.assertIn("|r_T| / (mu r_N)", result["contact"])
        self.assertGreater(result["play"]["pictures"], 3)
        self.assertGreater(result["triangles"], 1000)
        self.assertEqual(0, result["drawn_at_rest"])

    def test_hostile_names_stay_text(self):
        rng = np.random.default_rng(SEED)
        for _ in range(2):
            bag = RandomBag(rng, 30)
            bag.write(self.root / "hostile.bag")
            self.replay(self.root / "hostile.bag")
            result = browse(self.html, "hostile.png", {"frames": [29], "links": [[robot.name, robot.links[0]] for robot in bag.robots], "select": True})
            self.check_clean(result)
            self.assertEqual([robot.name for robot in bag.robots], result["bodies"][1:])
            for number, matrix in enumerate(result["links"][0]):
                np.testing.assert_allclose(np.reshape(matrix, (4, 4)).T[:3, 3], bag.roots[number][29][:3], atol=1e-3)

    def test_markers_meshes_and_what_is_not_finite(self):
        bag = RandomBag(np.random.default_rng(SEED + 1), 10)
        bag.contacts[4] = [bag.contact(4, 0)]
        bag.contacts[4][0].force.x = float("nan")
        for report in bag.reports:
            report.residual = float("nan")
        bag.write(self.root / "a.bag", ("contacts", "step_report", "markers"))
        self.replay(self.root / "a.bag")
        result = browse(self.html, "markers.png", {"frames": [0, 9], "follow": 0})
        self.check_clean(result)
        self.assertEqual([f"shape {number}" for number in range(len(bag.robots))], result["bodies"][1:])
        corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        (self.root / "a.stl").write_bytes(b" " * 80 + struct.pack("<I", 4) + b"".join(
            struct.pack("<12fH", 0, 0, 1, *(value for corner in face for value in corners[corner]), 0) for face in faces))
        (self.root / "a.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
        positions = " ".join(str(value) for corner in corners for value in corner)
        (self.root / "a.dae").write_text(
            '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>'
            '<library_images><image id="i"><init_from>nosuch.png</init_from></image></library_images><library_geometries><geometry id="g"><mesh><source id="p">'
            f'<float_array id="pa" count="12">{positions}</float_array><technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>'
            '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
            '<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>' + " ".join(str(index) for face in faces for index in face) +
            '</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>'
            '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>')
        visuals = "".join(f'<visual><origin xyz="{i} 0 0"/><geometry><mesh filename="a.{kind}"/></geometry></visual>' for i, kind in enumerate(["stl", "obj", "dae"]))
        (self.root / "meshes.urdf").write_text(f'<robot name="r"><link name="l">{visuals}</link></robot>')
        output = self.scenario("resting_box", 0)
        body = next(iter(progress.read(output, "", {}, progress.Progress())[0].bodies)).name
        self.replay(output, "--robot", f"{body}={self.root / 'meshes.urdf'}")
        result = browse(self.html, "meshes.png", {"frames": [0]})
        self.check_clean(result)
        self.assertGreaterEqual(result["triangles"], 3 * 4)


if __name__ == "__main__":
    unittest.main()
