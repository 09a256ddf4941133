#!/usr/bin/python3
"""scripts/run in a package of its own: what it prints, and when it takes the last build for good. Nothing is compiled here."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent.parent / 'scripts'
PROGRAM = 'devel/lib/frictional_contact_sim/greet'
QUICK = 0.5  # of scripts/run, nothing changed, on an idle machine [s of processor time, its own and its children's]


class RunTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        shutil.copytree(SCRIPTS, self.root / 'scripts')
        for name, text in (('src/tools/greet.cpp', '// greet NAME: says hello.\n'), ('src/other.cpp', ''), ('include/a.h', ''),
                           ('msg/A.msg', ''), ('srv/A.srv', ''), ('CMakeLists.txt', ''), ('package.xml', ''), ('build/.built', ''),
                           ('devel/setup.bash', 'export GREETING=hello\n'),
                           (PROGRAM, '#!/bin/bash\necho "$GREETING $*" "$ROS_MASTER_URI"\nexit 7\n')):
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        (self.root / PROGRAM).chmod(0o755)
        # Everything is of the past, the build of now.
        for path in self.root.rglob('*'):
            os.utime(path, (1e9, 1e9))
        self.stamp = self.root / 'build/.built'
        self.stamp.write_text(f'{self.root}\n')

    def tearDown(self):
        self.folder.cleanup()

    def run_script(self, *arguments):
        environment = dict(os.environ, ROS_MASTER_URI='http://localhost:4711')
        return subprocess.run([self.root / 'scripts/run', *arguments], capture_output=True, text=True, env=environment)

    def is_built(self):
        command = f'source {self.root}/scripts/environment.sh; is_built'
        return subprocess.run(['/bin/bash', '-c', command], capture_output=True).returncode == 0

    def test_the_program_alone_speaks(self):
        before = os.times()
        done = self.run_script('greet', 'two words', '--flag')
        after = os.times()
        self.assertEqual(('hello two words --flag http://localhost:4711\n', '', 7), (done.stdout, done.stderr, done.returncode))
        self.assertLess(after.children_user + after.children_system - before.children_user - before.children_system, QUICK)

    def test_without_a_name_it_lists_the_programs(self):
        done = self.run_script()
        self.assertEqual(('', 2), (done.stdout, done.returncode))
        self.assertIn('greet NAME: says hello.', done.stderr)

    def test_a_build_holds_until_something_it_is_made_from_changes(self):
        self.assertTrue(self.is_built())
        built = self.stamp.stat().st_mtime_ns
        for name in ('src/other.cpp', 'include/a.h', 'msg/A.msg', 'srv/A.srv', 'CMakeLists.txt', 'package.xml', 'scripts/packages.txt',
                     'scripts/environment.sh', 'src/tools'):
            with self.subTest(name):
                os.utime(self.root / name, ns=(built + 10**9,) * 2)
                self.assertFalse(self.is_built())
                os.utime(self.root / name, (1e9, 1e9))
                self.assertTrue(self.is_built())

    def test_a_file_less_is_a_change(self):
        time.sleep(0.05)  # of the clock that files are stamped with
        (self.root / 'src/other.cpp').unlink()
        self.assertFalse(self.is_built())

    def test_a_build_of_another_place_or_none_is_no_build(self):
        self.stamp.write_text('/somewhere/else\n')
        self.assertFalse(self.is_built())
        self.stamp.unlink()
        self.assertFalse(self.is_built())


if __name__ == '__main__':
    unittest.main()
