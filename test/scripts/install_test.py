#!/usr/bin/python3
"""The install space: `make install`, then rosrun, roslaunch and roslaunch-check from there, with nothing of the checkout in the
environment. install_test.py BUILD_DIR"""
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import unittest

BUILD_DIR = sys.argv.pop(1)
TIMEOUT = 120  # of one command: generous, the machine may be loaded [s]


def free_port():
    with socket.socket() as probe:
        probe.bind(('localhost', 0))
        return probe.getsockname()[1]


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        environment = dict(os.environ, DESTDIR=cls.folder.name)
        subprocess.run(['cmake', '--install', BUILD_DIR], env=environment, check=True, stdout=subprocess.DEVNULL)
        cls.setup, = pathlib.Path(cls.folder.name).rglob('setup.bash')

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def run_there(self, command):
        port = free_port()
        script = f'source {self.setup} && {command.format(port=port)}'
        environment = {'HOME': self.folder.name, 'PATH': '/usr/sbin:/usr/bin:/sbin:/bin', 'ROS_IP': '127.0.0.1',
                       'ROS_MASTER_URI': f'http://localhost:{port}'}
        return subprocess.run(['bash', '-c', script], env=environment, cwd=self.folder.name, capture_output=True, text=True,
                              timeout=TIMEOUT)

    def test_rosrun(self):
        done = self.run_there('rosrun frictional_contact_sim run_scenario resting_box --duration 0.1 --json')
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertIn('"failed_steps":0', done.stdout.replace(' ', ''))

    def test_programs_in_python(self):
        done = self.run_there('rosrun frictional_contact_sim run_scenario resting_box --duration 0.1 --output run --json >/dev/null && '
                              'rosrun frictional_contact_sim plot_bag run --output plots && rosrun frictional_contact_sim replay --version')
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertEqual(6, done.stdout.count('.png\n'))
        # With the bundle of scripts/install_replay a page, else one line that names it.
        done = self.run_there('rosrun frictional_contact_sim replay run --output page.html')
        if done.returncode == 0:
            self.assertIn('101 frames', done.stdout)
        else:
            self.assertRegex(done.stderr, r'^replay: [^\n]*scripts/install_replay[^\n]*\n$')

    def test_roslaunch_ends_without_a_red_line(self):
        done = self.run_there('roslaunch -p {port} frictional_contact_sim simulate.launch robot:=quadruped num_steps:=200 '
                              'real_time_factor:=0')
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        self.assertIn('end: 200 steps', done.stdout)
        self.assertIn('failed steps 0', done.stdout)
        self.assertNotIn('has died', done.stdout + done.stderr)

    def test_a_project_of_its_own_finds_the_library(self):
        source = self.setup.parent / 'share/frictional_contact_sim/examples/library_without_ros'
        build = f'{self.folder.name}/many_simulations'
        done = self.run_there(f'cmake -S {source} -B {build} -DCMAKE_BUILD_TYPE=Debug && cmake --build {build} && '
                              f'{build}/many_simulations {self.setup.parent}/share/frictional_contact_sim/config/scenarios/grasp.yaml 5')
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        self.assertEqual(8, done.stdout.count(' cube at ('))

    def test_completion_comes_with_setup_bash(self):
        done = self.run_there('bash --norc -i -c ". ' + str(self.setup) + '; COMP_WORDS=(scripts/run run_s); COMP_CWORD=1; '
                              '_frictional_contact_sim_run; echo \\$COMPREPLY" </dev/null')
        self.assertEqual('run_scenario\n', done.stdout, done.stderr)

    def test_a_failure_is_red(self):
        done = self.run_there('roslaunch -p {port} frictional_contact_sim simulate.launch scenario:=nosuch')
        self.assertIn('has died', done.stdout + done.stderr)

    def test_launch_files_are_whole(self):
        folders = {path.parent for path in pathlib.Path(self.setup.parent).rglob('*.launch')}
        self.assertGreaterEqual(len(folders), 3)
        for folder in folders:
            done = self.run_there(f'/usr/share/roslaunch/scripts/roslaunch-check {folder}')
            self.assertEqual(0, done.returncode, done.stdout + done.stderr)


if __name__ == '__main__':
    unittest.main()
