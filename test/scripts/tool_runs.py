"""What tests of scenarios share: run_scenario with CSV files, as the repository has just been built."""
import csv
import json
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / 'devel/lib/frictional_contact_sim/run_scenario'
GRAVITY = 9.81


class Run:
    """A scenario's text from start to end: the JSON object, states and contacts by time. @raise AssertionError as it ends"""

    def __init__(self, text, folder, duration, arguments=()):
        scenario = pathlib.Path(folder) / 'scenario.yaml'
        scenario.write_text(text.replace('../../urdf', str(ROOT / 'urdf')).replace('../rolling', str(ROOT / 'config/rolling')))
        command = [PROGRAM, scenario, '--json', '--output', folder, '--duration', str(duration), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=dict(os.environ, OMP_NUM_THREADS='1'))
        assert done.returncode == 0, done.stderr
        self.result = json.loads(done.stdout)
        self.folder = pathlib.Path(folder)
        self.states = {}  # body: [{column: number}]
        for row in self.read('states.csv'):
            self.states.setdefault(row.pop('body'), []).append({name: float(value) for name, value in row.items()})

    def read(self, name):
        with (self.folder / name).open() as file:
            return list(csv.DictReader(file))

    def way(self, body, since=0.0):
        """How far a body's root was from where it was at a time, at most [m]."""
        states = [state for state in self.states[body] if state['time'] >= since - 1e-9]
        return max(sum((state[axis] - states[0][axis]) ** 2 for axis in 'xyz') ** 0.5 for state in states)

    def speed(self, body, since=0.0):
        """The largest [m/s]."""
        return max(sum(state[axis] ** 2 for axis in ('vx', 'vy', 'vz')) ** 0.5 for state in self.states[body] if state['time'] >= since - 1e-9)

    def ground_force(self):
        """Upward force of the ground on everything in the last step [N]."""
        rows = self.read('contacts.csv')
        rows = [row for row in rows if row['time'] == rows[-1]['time'] and 'ground' in (row['body_a'], row['body_b'])]
        return sum(float(row['fz']) * (-1 if row['body_a'] == 'ground' else 1) for row in rows)
