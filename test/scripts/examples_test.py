#!/usr/bin/python3
"""examples/: each folder has its page and a test; those that are no rostest and no program of C++ are run here."""
import os
import pathlib
import random
import re
import socket
import subprocess
import tempfile
import unittest

import rosbag
import yaml
from tool_runs import GRAVITY, ROOT, Run

EXAMPLES = sorted(path for path in (ROOT / 'examples').iterdir() if path.is_dir())
SEED = 7
TEST_CODE = ROOT / 'test'
DEVEL = ROOT / 'devel/lib/frictional_contact_sim'


class ExamplesTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def test_each_has_a_short_page_and_a_test(self):
        tests = ''.join(path.read_text() for path in TEST_CODE.rglob('*') if path.suffix in ('.py', '.cpp', '.test'))
        index = (ROOT / 'README.md').read_text()
        for example in EXAMPLES:
            with self.subTest(example.name):
                lines = (example / 'README.md').read_text().strip().split('\n')
                self.assertTrue(5 <= len(lines) <= 20, f'{len(lines)} lines')
                self.assertIn(f'examples/{example.name}', index)
                own = list(example.glob('*.test'))
                files = [path.name for path in example.iterdir() if path.name not in ('README.md', 'CMakeLists.txt')]
                self.assertTrue(own or any(re.search(rf'\b{re.escape(pathlib.Path(name).stem)}\b', tests) for name in files))

    def test_every_gripper_lets_go_when_friction_says_so(self):
        # 2 mu N = m g at the closed form's instant; friction, grip and the time to open are drawn anew.
        dice = random.Random(SEED)
        document = yaml.safe_load((ROOT / 'examples/materials_and_commands/grippers.yaml').read_text())
        cases = [None] + [(dice.uniform(0.6, 1.0), dice.uniform(0.45, 0.55), dice.uniform(13.0, 18.0), dice.uniform(0.3, 0.6)) for _ in range(2)]
        for case in cases:
            if case:
                rubber, steel, grip, seconds = case
                document['materials']['pairs'][0]['friction'], document['materials']['pairs'][1]['friction'] = rubber, steel
                for body in document['bodies']:
                    for command in body.get('commands', {}).values():
                        command.update({'times': [0, 0.2, 0.2 + seconds], 'efforts': [-grip, -grip, 0.0]})
            pairs = {pair['between'][0]: pair['friction'] for pair in document['materials']['pairs']}
            times, efforts = (document['bodies'][0]['commands']['left_slide'][key] for key in ('times', 'efforts'))
            run = Run(yaml.safe_dump(document), self.folder, times[-1])
            for material, friction in pairs.items():
                force = GRAVITY / (2.0 * friction)  # of a finger, the cube has 1 kg [N]
                expected = times[1] + (efforts[1] + force) / (efforts[1] - efforts[2]) * (times[2] - times[1])
                slips = next(state['time'] for state in run.states[f'{material}_cube'] if state['vz'] < -1e-6)
                with self.subTest(material, case=case):
                    self.assertAlmostEqual(expected, slips, delta=2.1e-3)  # two steps

    def test_first_robot_is_held_by_friction(self):
        text = (ROOT / 'examples/first_robot/first_scenario.yaml').read_text()
        run = Run(text.replace('first_robot.urdf', str(ROOT / 'examples/first_robot/first_robot.urdf')), self.folder, 2.0)
        self.assertLess(run.way('robot', 0.5), 1e-9)
        force = run.result['contact_force']['robot']
        self.assertAlmostEqual(-10.0, force[0], delta=1e-6)
        self.assertAlmostEqual(2.5 * GRAVITY, force[2], delta=1e-6)

    def test_a_bag_and_its_plots(self):
        with socket.socket() as probe:
            probe.bind(('localhost', 0))
            port = probe.getsockname()[1]
        environment = dict(os.environ, ROS_MASTER_URI=f'http://localhost:{port}')
        done = subprocess.run([ROOT / 'examples/bag_and_plots/record_and_plot', self.folder / 'out'], env=environment, timeout=300,
                              capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        with rosbag.Bag(str(self.folder / 'out/grasp.bag')) as bag:
            reports = [message for _, message, _ in bag.read_messages('/simulator_node/step_report')]
        self.assertEqual(list(range(1, 1001)), [report.step for report in reports])
        if (DEVEL / 'plot_bag').exists():
            self.assertTrue(list((self.folder / 'out').glob('*.png')), done.stdout)


if __name__ == '__main__':
    unittest.main()
