#!/usr/bin/env python3
"""Writes scenes of many bodies (YAML, URDF, OBJ) for run_scenario --dump: real friction problems of 1 to 700 contacts.

    generate_scenes.py OUT [--robots DIR]     DIR: example-robot-data's robots folder, for more legged robots; its
                                              grandparent must be on ROS_PACKAGE_PATH

OUT/scenes.tsv lists: scene, steps it lasts, dump every N steps. Same output for the same script: one seed a scene.
"""
import argparse
import math
import pathlib
import random

import geometry as solid

SOLVER = 'solver: {name: portfolio, tolerance: 1.0e-7, max_iterations: 300}'
OWN_URDF = pathlib.Path(__file__).resolve().parents[2] / 'urdf'


class Scene:
    def __init__(self, folder, name, friction, restitution=0.0, time_step=0.001, ground=True, gravity=(0, 0, -9.81)):
        self.folder, self.name = folder, name
        self.rng = random.Random(name)
        self.time_step = time_step
        self.lines = [f'time_step: {time_step}', f'gravity: [{gravity[0]}, {gravity[1]}, {gravity[2]}]', SOLVER,
                      f'materials: {{default: {{friction: {friction}, restitution: {restitution}}}}}']
        if ground:
            self.lines.append('ground: {}')
        self.lines.append('bodies:')
        self.count = 0

    def file(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def body(self, urdf, xyz=None, rpy=(0, 0, 0), linear=None, angular=(0, 0, 0), base='floating', more=()):
        self.count += 1
        self.lines.append(f'  - {{name: b{self.count}, urdf: {urdf}, base: {base}')
        if xyz is not None:
            self.lines[-1] += ', pose: {{xyz: [{:.12g}, {:.12g}, {:.12g}], rpy: [{:.12g}, {:.12g}, {:.12g}]}}'.format(
                *xyz, *rpy)
        if linear is not None:
            self.lines[-1] += ', velocity: {{linear: [{}, {}, {}], angular: [{}, {}, {}]}}'.format(*linear, *angular)
        for entry in more:
            self.lines[-1] += ', ' + entry
        self.lines[-1] += '}'

    def turn(self):
        return [self.rng.uniform(-math.pi, math.pi) for _ in range(3)]

    def close(self, steps, every):
        self.lines.insert(0, f'duration: {steps * self.time_step:.12g}')
        self.file(self.name + '.yaml', '\n'.join(self.lines) + '\n')
        with open(self.folder / 'scenes.tsv', 'a') as table:
            table.write(f'{self.name}\t{steps}\t{every}\n')


def box_stack(out, count, friction, steps, every, tilt=0.0, suffix=''):
    gravity = (9.81 * math.sin(tilt), 0, -9.81 * math.cos(tilt))
    scene = Scene(out, f'boxstack{count}{suffix}', friction, gravity=gravity)
    size = 0.2
    urdf = scene.file('box.urdf', solid.box('box', (size, size, size), 1000))
    for i in range(count):
        offset = [scene.rng.uniform(-0.02, 0.02) for _ in range(2)]
        scene.body(urdf, (*offset, (i + 0.5) * size + (i + 1) * 1e-4), (0, 0, scene.rng.uniform(-0.4, 0.4)))
    scene.close(steps, every)


def pyramid(out, rows, friction, steps, every):
    """A wall of boxes hit by a heavy ball."""
    scene = Scene(out, f'pyramid{rows}', friction, restitution=0.2)
    urdf = scene.file('brick.urdf', solid.box('brick', (0.2, 0.1, 0.1), 1800))
    ball = scene.file('cannonball.urdf', solid.sphere('cannonball', 0.1, 7800))
    for row in range(rows):
        for k in range(rows - row):
            scene.body(urdf, ((k - 0.5 * (rows - row)) * 0.202, 0, 0.05 + row * 0.1 + 1e-6 * (row + 1)))
    scene.body(ball, (0.05, -0.4, 0.25), linear=(0, 6, 0))
    scene.close(steps, every)


def kapla_tower(out, layers, boards, friction, steps, every, ball=False, suffix=''):
    """Layers of parallel boards, each layer across the one below."""
    scene = Scene(out, f'kapla{layers * boards}{suffix}', friction)
    length, width, thickness = 0.12, 0.024, 0.008
    urdf = scene.file('board.urdf', solid.box('board', (length, width, thickness), 560))
    for layer in range(layers):
        z = (layer + 0.5) * thickness + (layer + 1) * 1e-6
        for k in range(boards):
            shift = (k / (boards - 1) - 0.5) * (length - width) * 0.95
            across = layer % 2 == 1
            scene.body(urdf, (shift, 0, z) if across else (0, shift, z), (0, 0, math.pi / 2 if across else 0))
    if ball:
        shot = scene.file('shot.urdf', solid.sphere('shot', 0.03, 2500))
        scene.body(shot, (0, -0.12, 0.6 * layers * thickness), linear=(0.1, 3, 0.2))
    scene.close(steps, every)


def round_tower(out, sides, layers, friction, steps, every):
    """Boards on edges of a polygon, layer by layer turned by half a side."""
    scene = Scene(out, f'kaplaround{sides * layers}', friction)
    urdf = scene.file('board.urdf', solid.box('board', (0.12, 0.024, 0.008), 560))
    radius = 0.5 * 0.12 / math.tan(math.pi / sides) * 1.15
    for layer in range(layers):
        for k in range(sides):
            angle = 2 * math.pi * (k + 0.5 * (layer % 2)) / sides
            z = (layer + 0.5) * 0.008 + (layer + 1) * 1e-6
            scene.body(urdf, (radius * math.cos(angle), radius * math.sin(angle), z), (0, 0, angle + math.pi / 2))
    scene.close(steps, every)


def pile(out, kind, count, friction, steps, every, restitution=0.0, time_step=0.002, spacing=0.13):
    """Bodies of one kind fall into an open box; the grippers' fingers mimic each other (bilateral rows)."""
    scene = Scene(out, f'{kind}{count}', friction, restitution, time_step, ground=False)
    across = max(2, round(count**(1 / 3)))
    container = scene.file(f'container{across}.urdf', solid.open_box('container', across * spacing, 4 * spacing, 0.1))
    scene.body(container, (0, 0, 0), base='fixed')
    urdfs = []
    if kind == 'spheres':
        urdfs = [scene.file(f'ball{i}.urdf', solid.sphere(f'ball{i}', 0.04 + 0.005 * i, 2500)) for i in range(4)]
    elif kind == 'capsules':
        urdfs = [scene.file('capsule.urdf', solid.capsule('capsule', 0.025, 0.06, 1000))]
    elif kind == 'boxes':
        urdfs = [scene.file('crate.urdf', solid.box('crate', (0.09, 0.07, 0.05), 800))]
    elif kind == 'grippers':
        urdfs = [OWN_URDF / 'gripper_mimic.urdf']
    else:
        for i in range(6):
            text, obj, _ = solid.rock(f'rock{i}', random.Random(i), 0.06, 2600)
            scene.file(f'rock{i}.obj', obj)
            urdfs.append(scene.file(f'rock{i}.urdf', text))
    for i in range(count):
        cell = (i % across, i // across % across, i // across**2)
        xyz = [(cell[d] + 0.5 - 0.5 * across) * spacing + scene.rng.uniform(-0.005, 0.005) for d in range(2)]
        scene.body(urdfs[i % len(urdfs)], (*xyz, 0.08 + cell[2] * spacing), scene.turn(), linear=(0, 0, -0.5))
    scene.close(steps, every)


def arch(out, stones, friction, steps, every, push=0.0, suffix=''):
    """Half circle of voussoirs on the ground; the first and the last are fixed."""
    scene = Scene(out, f'arch{stones}{suffix}', friction)
    angle = math.pi / stones
    text, obj, centre = solid.voussoir('voussoir', 1.0, 1.25, 0.4, angle * (1 - 1e-6), 2400)
    scene.file('voussoir%d.obj' % stones, obj)
    urdf = scene.file('voussoir%d.urdf' % stones, text.replace('voussoir.obj', 'voussoir%d.obj' % stones))
    for k in range(stones):
        phi = -math.pi / 2 + (k + 0.5) * angle
        more = []
        if k == stones // 3 and push:
            more = [f'wrenches: [{{link: voussoir, force: [{push}, 0, 0]}}]']
        fixed = k in (0, stones - 1)
        scene.body(urdf, (centre[2] * math.sin(phi), 0, 0.05 + centre[2] * math.cos(phi)), (0, phi, 0),
                   base='fixed' if fixed else 'floating', more=more)
    scene.close(steps, every)


def grasp(out, friction, steps, every):
    """A gripper, palm down, holds a cube; one finger is driven, the other mimics it (a bilateral row)."""
    scene = Scene(out, 'grasp', friction, ground=False)
    scene.body(OWN_URDF / 'gripper_mimic.urdf', (0, 0, 0.5), (math.pi, 0, 0), base='fixed',
               more=['joints: {left_slide: {position: 0.05}, right_slide: {position: 0.05}}',
                     'commands: {left_slide: {effort: -24}}'])
    scene.body(OWN_URDF / 'cube.urdf', (0, 0, 0.4))
    scene.close(steps, every)


def chain_urdf(links, coupled):
    """Capsule links joined by two continuous joints with a light cross piece; coupled: all bend as the first does."""
    text = ['<?xml version="1.0"?>', '<robot name="chain">']
    for i in range(links):
        text.append(f'<link name="l{i}"><inertial><origin xyz="0 0 0.05"/><mass value="0.2"/><inertia ixx="2e-4" ixy="0" '
                    'ixz="0" iyy="2e-4" iyz="0" izz="3e-5"/></inertial><collision><origin xyz="0 0 0.05"/><geometry>'
                    '<capsule radius="0.015" length="0.06"/></geometry></collision></link>')
        if i == 0:
            continue
        text.append(f'<link name="c{i}"><inertial><mass value="0.02"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" '
                    'iyz="0" izz="1e-5"/></inertial></link>')
        mimic = {axis: f'<mimic joint="{axis}1"/>' if coupled and i > 1 else '' for axis in 'xy'}
        text.append(f'<joint name="x{i}" type="continuous"><parent link="l{i - 1}"/><child link="c{i}"/><origin '
                    f'xyz="0 0 0.1"/><axis xyz="1 0 0"/><dynamics damping="1e-3"/>{mimic["x"]}</joint>')
        text.append(f'<joint name="y{i}" type="continuous"><parent link="c{i}"/><child link="l{i}"/><axis '
                    f'xyz="0 1 0"/><dynamics damping="1e-3"/>{mimic["y"]}</joint>')
    return '\n'.join(text + ['</robot>', ''])


def chain(out, links, friction, steps, every, coupled=False):
    """An articulated chain falls over a fixed bar and coils on the ground."""
    scene = Scene(out, f'chain{links}' + ('coupled' if coupled else ''), friction)
    urdf = scene.file(f'{scene.name}.urdf', chain_urdf(links, coupled))
    bar = scene.file('bar.urdf', solid.box('bar', (0.1, 1.0, 0.1), 1000))
    scene.body(bar, (0, 0, 0.3), (0.0, 0.4, 0.0), base='fixed')
    scene.body(urdf, (-0.05 * links, 0.02, 0.45), (0, math.pi / 2, 0.1))
    scene.close(steps, every)


def rover_urdf():
    wheel = ('<inertial><mass value="1.5"/><inertia ixx="0.004" ixy="0" ixz="0" iyy="0.0068" iyz="0" izz="0.004"/>'
             '</inertial><collision><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.1" length="0.06"/>'
             '</geometry></collision>')
    text = ['<?xml version="1.0"?>', '<robot name="rover">',
            '<link name="chassis"><inertial><mass value="12"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.5" iyz="0" '
            'izz="0.6"/></inertial><collision><geometry><box size="0.7 0.3 0.1"/></geometry></collision></link>']
    for i, x in enumerate((-0.3, 0.0, 0.3)):
        for side, y in (('l', 0.22), ('r', -0.22)):
            text.append(f'<link name="w{i}{side}">{wheel}</link><joint name="j{i}{side}" type="continuous"><parent '
                        f'link="chassis"/><child link="w{i}{side}"/><origin xyz="{x} {y} -0.05"/><axis xyz="0 1 0"/>'
                        '<dynamics damping="0.01" friction="0.02"/></joint>')
    return '\n'.join(text + ['</robot>', ''])


def rover(out, friction, steps, every, suffix, skid):
    """Six wheels over a field of curbs; skid: the two sides turn against each other."""
    scene = Scene(out, f'rover{suffix}', friction)
    urdf = scene.file('rover.urdf', rover_urdf())
    curb = scene.file('curb.urdf', solid.box('curb', (0.08, 1.2, 0.05), 1000))
    speeds = ', '.join(f'j{i}{s}: {{velocity: {-8 if skid and s == "r" else 8}, kd: 2}}' for i in range(3) for s in 'lr')
    scene.body(urdf, (0, 0, 0.151), more=[f'commands: {{{speeds}}}'])
    for k in range(3):
        scene.body(curb, (0.55 + 0.6 * k, 0, 0.02), (0, 0, 0.3 - 0.2 * k), base='fixed')
    scene.close(steps, every)


def slide(out, name, size, friction, speed, steps, every, spin=0.0):
    scene = Scene(out, f'slide{name}', friction)
    urdf = scene.file(f'slab{name}.urdf', solid.box(f'slab{name}', size, 700))
    scene.body(urdf, (0, 0, 0.5 * size[2]), linear=(speed, 0.3, 0), angular=(0, 0, spin))
    scene.close(steps, every)


def dominoes(out, count, friction, steps, every):
    scene = Scene(out, f'dominoes{count}', friction, restitution=0.1)
    urdf = scene.file('domino.urdf', solid.box('domino', (0.01, 0.03, 0.06), 700))
    for k in range(count):
        scene.body(urdf, (0.025 * k, 0, 0.03 + 1e-6), angular=(0, 6 if k == 0 else 0, 0), linear=(0.2 if k == 0 else 0, 0, 0))
    scene.close(steps, every)


def ball(out, friction, steps, every):
    scene = Scene(out, 'oneball', friction)
    scene.body(scene.file('ball1.urdf', solid.sphere('ball1', 0.05, 2500)), (0, 0, 0.051), linear=(2, 0, 0),
               angular=(0, 0, 20))
    scene.close(steps, every)


def robot(out, name, path, friction, steps, every, base='floating', height=None, linear=None, more=()):
    if not path.exists():
        return
    scene = Scene(out, name, friction)
    scene.body(path.resolve(), None if height is None else (0, 0, height), base=base, linear=linear,
               more=['hold_initial_position: true', *more])
    scene.close(steps, every)


def robots(out, folder):
    legs = ', '.join(f'{leg}_{j}: {{position: {s * p}}}' for leg, s in (('LF', 1), ('RF', 1), ('LH', -1), ('RH', -1))
                     for j, p in (('HFE', 0.7), ('KFE', -1.4)))
    robot(out, 'quadrupedstand', OWN_URDF / 'quadruped.urdf', 0.8, 300, 150, more=[f'joints: {{{legs}}}'])
    robot(out, 'quadrupedslide', OWN_URDF / 'quadruped.urdf', 0.3, 160, 80, linear=(1.5, 0.4, 0),
          more=[f'joints: {{{legs}}}'])
    if folder is None:
        return
    robot(out, 'anymalfall', folder / 'anymal_b_simple_description/robots/anymal.urdf', 0.7, 400, 100, height=0.6)
    robot(out, 'go1fall', folder / 'go1_description/urdf/go1.urdf', 0.5, 400, 100, height=0.4)
    robot(out, 'solofall', folder / 'solo_description/robots/solo12.urdf', 0.9, 400, 100, height=0.3)
    robot(out, 'humanoidfall', folder / 'simple_humanoid_description/urdf/simple_humanoid.urdf', 0.6, 800, 200, height=1.1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('out', type=pathlib.Path)
    parser.add_argument('--robots', type=pathlib.Path)
    arguments = parser.parse_args()
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    (out / 'scenes.tsv').unlink(missing_ok=True)
    ball(out, 0.3, 200, 100)
    slide(out, 'plank', (1.0, 0.1, 0.05), 0.3, 2.0, 200, 100, spin=3.0)
    slide(out, 'cube', (0.2, 0.2, 0.2), 1.2, 1.5, 150, 50)
    slide(out, 'disc', (0.3, 0.3, 0.02), 0.1, 1.0, 200, 100, spin=10.0)
    box_stack(out, 3, 0.7, 100, 50)
    box_stack(out, 8, 0.4, 200, 100)
    box_stack(out, 15, 0.9, 100, 50)
    box_stack(out, 6, 0.35, 300, 100, tilt=0.3, suffix='slope')
    pyramid(out, 5, 0.5, 120, 40)
    pyramid(out, 9, 0.6, 120, 60)
    dominoes(out, 15, 0.4, 300, 100)
    dominoes(out, 40, 0.2, 300, 100)
    kapla_tower(out, 10, 2, 0.3, 60, 30)
    kapla_tower(out, 15, 2, 0.5, 80, 40, ball=True, suffix='shot')
    kapla_tower(out, 35, 2, 0.3, 30, 15)
    kapla_tower(out, 20, 3, 0.5, 30, 15)
    kapla_tower(out, 40, 2, 0.7, 40, 20, ball=True, suffix='shot')
    round_tower(out, 6, 10, 0.4, 40, 20)
    pile(out, 'spheres', 8, 0.1, 300, 100, restitution=0.3)
    pile(out, 'spheres', 30, 0.5, 300, 100)
    pile(out, 'spheres', 100, 0.3, 240, 80)
    pile(out, 'capsules', 12, 0.8, 300, 100)
    pile(out, 'capsules', 40, 0.3, 240, 80)
    pile(out, 'capsules', 90, 0.7, 200, 100)
    pile(out, 'boxes', 12, 0.5, 300, 100)
    pile(out, 'boxes', 40, 0.3, 200, 100)
    pile(out, 'rocks', 10, 1.2, 300, 100)
    pile(out, 'rocks', 35, 0.6, 600, 200, time_step=0.0005)
    pile(out, 'rocks', 50, 0.8, 600, 200, time_step=0.0005)
    arch(out, 7, 0.7, 60, 30)
    arch(out, 15, 0.6, 60, 30, push=400, suffix='push')
    arch(out, 31, 0.5, 40, 20)
    chain(out, 10, 0.4, 600, 200)
    chain(out, 25, 0.8, 600, 200)
    chain(out, 10, 0.4, 300, 100, coupled=True)
    chain(out, 25, 0.8, 300, 100, coupled=True)
    grasp(out, 0.7, 200, 100)
    pile(out, 'grippers', 8, 0.6, 300, 100, spacing=0.2)
    pile(out, 'grippers', 27, 0.4, 300, 100, spacing=0.2)
    rover(out, 0.6, 900, 300, 'drive', False)
    rover(out, 1.0, 600, 200, 'skid', True)
    robots(out, arguments.robots)


if __name__ == '__main__':
    main()
