#!/usr/bin/python3
"""The demos of launch/demos: each runs a while and keeps what every run must keep; then what each is there to show, with its
numbers drawn anew. Independent of the simulator are statics of the ladder, weights, and where things stood at the start."""
import itertools
import math
import os
import pathlib
import random
import socket
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import yaml
from tool_runs import GRAVITY, ROOT, Run

SEED = 20261128
SCENARIOS = ROOT / 'config/scenarios'


def launch_files():
    return sorted((ROOT / 'launch/demos').glob('*.launch'))


def scenario_of(launch_file):
    """The scenario of a demo, none of that with a robot."""
    values = [arg.get('value') for arg in ElementTree.parse(launch_file).iter('arg') if arg.get('name') == 'scenario']
    return values[0] if values else None


def text_of(name):
    return (SCENARIOS / f'{name}.yaml').read_text()


def mass_of(urdf):
    return sum(float(mass.get('value')) for mass in ElementTree.parse(ROOT / 'urdf' / urdf).iter('mass'))


def least_friction_of_arch(stones, inner, outer):
    """Statics of half a semicircular arch of an odd number of wedges: the least mu for which forces in all cones are in balance. The
    crown carries a thrust H with the moment M about the centre; per joint all conditions are linear in (H, M)."""
    half = 0.5 * math.pi / stones
    low, high = inner * math.cos(half), outer * math.cos(half)  # of a stone's section, its axis upright
    narrow, wide = inner * math.sin(half), outer * math.sin(half)  # half widths
    area = (narrow + wide) * (high - low)
    radius = low + (high - low) / 3.0 * (narrow + 2.0 * wide) / (narrow + wide)  # of the centroid
    weight = 0.5 * area
    moment = weight * (narrow ** 2 + narrow * wide + wide ** 2) / (3.0 * (narrow + wide))  # of half of the crown stone
    joints = []
    for k in range((stones + 1) // 2):
        joints.append((math.pi * (0.5 + k) / stones, weight, moment))
        weight += area
        moment += area * radius * math.sin(math.pi * (k + 1) / stones)

    def balanced(mu):
        conditions = [(-1.0, 0.0, 0.0)]  # a H + b M <= c
        for angle, load, turn in joints:
            s, c = math.sin(angle), math.cos(angle)
            # Normal force H c + V s at a radius from inner to outer, its moment about the centre M + turn; shear V c - H s.
            conditions += [(-outer * c, 1.0, outer * load * s - turn), (inner * c, -1.0, turn - inner * load * s),
                           (-s - mu * c, 0.0, mu * load * s - load * c), (s - mu * c, 0.0, mu * load * s + load * c)]
        for (a, b, c), (d, e, f) in itertools.combinations(conditions, 2):
            determinant = a * e - d * b
            if abs(determinant) > 1e-12:
                corner = ((c * e - f * b) / determinant, (a * f - d * c) / determinant)
                if all(g * corner[0] + h * corner[1] <= k + 1e-9 for g, h, k in conditions):
                    return True
        return False

    lower, upper = 0.0, 1.0
    while upper - lower > 1e-6:
        middle = 0.5 * (lower + upper)
        lower, upper = (lower, middle) if balanced(middle) else (middle, upper)
    return upper


class DemosTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name
        self.dice = random.Random(SEED)

    def run_text(self, text, duration, *arguments):
        return Run(text, self.folder, duration, arguments)

    def test_every_demo_has_its_page_and_picture(self):
        page = (ROOT / 'docs/demos.md').read_text()
        self.assertEqual(14, len(launch_files()))
        for launch_file in launch_files():
            self.assertIn(f'{launch_file.stem}.launch', page)
            self.assertIn(f'images/demo_{launch_file.stem}.png', page)
            self.assertGreater((ROOT / f'docs/images/demo_{launch_file.stem}.png').stat().st_size, 5000)
        self.assertIn('docs/demos.md', (ROOT / 'README.md').read_text())

    def test_every_demo_keeps_the_invariants(self):
        for name in filter(None, map(scenario_of, launch_files())):
            steps = self.dice.randint(20, 60)
            with self.subTest(name, steps=steps):
                run = self.run_text(text_of(name), steps * 0.001)
                result = run.result
                self.assertEqual((steps, 0), (result['steps'], result['failed_steps']))
                tolerance = yaml.safe_load(text_of(name)).get('solver', {}).get('tolerance', 1e-8)
                self.assertLessEqual(result['worst_residual'], tolerance)
                self.assertLessEqual(result['max_penetration'], 1e-8)  # meshes have coordinates of single precision
                energy = result['energy']
                scale = max(1.0, abs(energy['kinetic']), abs(energy['actuators']))
                error = abs(energy['balance_error'])
                if error >= 1e-6 * scale:  # a tree that turns: of the scheme's order, 2, or 1 with an event inside
                    half = self.run_text(text_of(name), steps * 0.001, '--time-step', '0.0005').result
                    self.assertLess(abs(half['energy']['balance_error']), 0.6 * error)
                    self.assertLess(error, 1e-4 * scale)
                for row in run.read('contacts.csv'):  # every force in its cone, no pull
                    normal = sum(float(row['n' + axis]) * float(row['f' + axis]) for axis in 'xyz')
                    square = sum(float(row['f' + axis]) ** 2 for axis in 'xyz')
                    tangential = math.sqrt(max(0.0, square - normal ** 2))
                    self.assertGreaterEqual(normal, -1e-6)
                    self.assertLessEqual(tangential, float(row['friction']) * normal + 1e-5 * (1.0 + normal))

    def test_launch_files_run_into_a_bag(self):
        with socket.socket() as probe:
            probe.bind(('localhost', 0))
            environment = dict(os.environ, ROS_MASTER_URI=f'http://localhost:{probe.getsockname()[1]}')
        for name in (self.dice.choice([path.stem for path in launch_files() if scenario_of(path)]), 'real_robot'):
            with self.subTest(name):
                bag = pathlib.Path(self.folder) / f'{name}.bag'
                command = ['roslaunch', 'frictional_contact_sim', f'{name}.launch', 'real_time_factor:=0', 'num_steps:=30', f'bag:={bag}']
                done = subprocess.run(command, env=environment, timeout=120, capture_output=True, text=True)
                self.assertRegex(done.stdout, r'end: 30 steps, .* failed steps 0', done.stdout + done.stderr)
                self.assertTrue(bag.exists())

    def test_the_files_are_those_of_the_generator(self):
        subprocess.run([ROOT / 'scripts/generate_demos', '--output', self.folder], check=True)
        written = [path for path in pathlib.Path(self.folder).rglob('*') if path.is_file()]
        self.assertGreaterEqual(len(written), 10)
        for path in written:
            self.assertEqual(path.read_text(), (ROOT / path.relative_to(self.folder)).read_text(), path.name)

    def test_a_ladder_holds_above_its_threshold_and_slips_below(self):
        # Statics with a smooth wall: friction on the ground = force of the wall, moments about the foot.
        for _ in range(3):
            angle = self.dice.uniform(0.9, 1.2)  # of the rails to the ground [rad]
            length, thickness = 3.0, 0.06
            threshold = 0.5 * (1.0 / math.tan(angle) - thickness / length)
            foot = (-0.5 * (length * math.cos(angle) + thickness * math.sin(angle)), 0.5 * (length * math.sin(angle) + thickness * math.cos(angle)))
            document = yaml.safe_load(text_of('ladder'))
            document['materials']['rough'] = {'friction': threshold * 1.002}
            document['materials']['smooth'] = {'friction': threshold * 0.998}
            for body in document['bodies'][1:]:
                body['pose'] = {'xyz': [foot[0], body['pose']['xyz'][1], foot[1]], 'rpy': [0, -angle, 0]}
            run = self.run_text(yaml.safe_dump(document), 0.4)
            with self.subTest(angle=angle):
                self.assertLess(run.way('holding'), 1e-6)
                self.assertGreater(run.way('slipping'), 1e-4)  # 0.002 of its weight pulls it
                weight = 2 * mass_of('ladder.urdf') * GRAVITY
                self.assertLess(abs(run.result['contact_force']['wall'][2]), 1e-9 * weight)  # a smooth wall carries nothing

    def test_the_arch_stands_where_statics_allows_it(self):
        text = text_of('masonry_arch')
        least = least_friction_of_arch(11, 0.9, 1.1)
        self.assertLess(least, 0.6)
        weight = 11 * mass_of('voussoir.urdf') * GRAVITY
        for friction in (0.6, 1.01 * least):
            run = self.run_text(text.replace('friction: 0.6', f'friction: {friction:.6f}'), 0.2)
            self.assertAlmostEqual(weight, run.ground_force(), delta=1e-6 * weight)
            for stone in run.states:
                self.assertLess(run.way(stone, 0.05), 1e-6)
        run = self.run_text(text.replace('friction: 0.6', f'friction: {0.98 * least:.6f}'), 0.3)
        self.assertGreater(run.way('stone_6'), 1e-3)

    def test_the_tower_stands_still(self):
        run = self.run_text(text_of('kapla_tower'), 0.1)
        weight = len(run.states) * mass_of('plank.urdf') * GRAVITY
        self.assertAlmostEqual(weight, run.ground_force(), delta=1e-7 * weight)
        for plank in run.states:
            self.assertLess(run.speed(plank), 1e-9)
            self.assertLess(run.way(plank), 1e-10)

    def test_dominoes_fall_to_the_last(self):
        document = yaml.safe_load(text_of('domino_row'))
        document['bodies'] = document['bodies'][:self.dice.randint(3, 5)]
        run = self.run_text(yaml.safe_dump(document), 1.0)
        for states in run.states.values():
            upright = 1.0 - 2.0 * (states[-1]['qx'] ** 2 + states[-1]['qy'] ** 2)  # z of the domino in the world
            self.assertLess(upright, math.cos(math.radians(60.0)))

    def test_the_quadruped_stands_again(self):
        run = self.run_text(text_of('quadruped_pushed'), 3.0)
        sway = max(state['y'] for state in run.states['quadruped'])
        self.assertGreater(sway, 0.02)
        self.assertLess(abs(run.states['quadruped'][-1]['y']), 1e-3)
        self.assertLess(run.speed('quadruped', 2.9), 1e-6)
        weight = mass_of('quadruped.urdf') * GRAVITY
        self.assertAlmostEqual(weight, run.ground_force(), delta=1e-6 * weight)

    def test_what_is_held_does_not_creep(self):
        run = self.run_text(text_of('grasp'), 1.5)
        self.assertLess(run.way('cube', 0.5), 1e-9)
        self.assertAlmostEqual(1.0 * GRAVITY, run.result['contact_force']['cube'][2], delta=1e-7)

    def test_the_belt_slips_under_what_the_stop_holds(self):
        document = yaml.safe_load(text_of('conveyor'))
        friction = self.dice.uniform(0.15, 0.35)
        document['materials']['default']['friction'] = friction
        run = self.run_text(yaml.safe_dump(document), 4.5)
        for k in (1, 2, 3):
            self.assertLess(run.speed(f'parcel_{k}', 4.4), 1e-6)
        force = run.result['contact_force']
        self.assertAlmostEqual(friction * force['belt'][2], force['belt'][0], delta=1e-6)  # on the belt: down, backwards
        self.assertAlmostEqual(-force['belt'][0], force['stop'][0], delta=1e-6)
        self.assertAlmostEqual(-3 * GRAVITY, force['belt'][2] + force['stop'][2], delta=1e-6)

    def test_the_ground_carries_the_press_and_the_block(self):
        document = yaml.safe_load(text_of('pressed_block'))
        elastic = document['bodies'][1]['elastic']
        elastic['young_modulus'] = self.dice.uniform(0.6e5, 2e5)
        elastic['density'] = self.dice.uniform(100, 1000)
        run = self.run_text(yaml.safe_dump(document), 1.1)  # pressed since 0.8 s
        weight = elastic['density'] * math.prod(elastic['box']) * GRAVITY
        push = -run.result['contact_force']['press'][2]  # on the press: upwards, so the block takes the opposite
        self.assertGreater(abs(push), weight)
        self.assertAlmostEqual(weight + abs(push), run.ground_force(), delta=0.02 * (weight + abs(push)))

    def test_the_drum_carries_up_what_falls(self):
        run = self.run_text(text_of('washing_drum'), 1.5)
        self.assertEqual(0, run.result['failed_steps'])
        highest = max(state['z'] for name, states in run.states.items() if name != 'drum' for state in states if state['time'] > 0.7)
        self.assertGreater(highest, 0.45)  # 0.25 above the drum's floor
        self.assertGreater(run.result['energy']['actuators'], 5.0)  # the motion puts in what friction and impacts take
        for name, states in run.states.items():
            for state in states:
                self.assertLess(math.hypot(state['x'], state['z'] - 0.5), 0.33)  # none leaves the drum

    def test_the_four_bar_stays_closed_while_it_hammers(self):
        run = self.run_text(text_of('four_bar'), 1.5)
        self.assertLess(run.result['max_bilateral_violation'], 1e-9)
        self.assertTrue(any(float(row['fz']) != 0.0 for row in run.read('contacts.csv')))

    def test_the_wheel_creeps_as_its_curve_says(self):
        run = self.run_text(text_of('rolling_wheel'), 1.0)
        joints = {row['joint']: float(row['velocity']) for row in run.read('joints.csv')[-4:]}
        self.assertAlmostEqual(3.66e-5, (0.1 * joints['axle'] - joints['drive']) / joints['drive'], delta=1e-7)


if __name__ == '__main__':
    unittest.main()
