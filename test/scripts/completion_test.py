#!/usr/bin/python3
"""Completion in bash, asked as readline asks: with COMP_WORDS and the function that `complete` has. completion_test.py DEVEL_DIR"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import unittest

DEVEL = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
FILE = DEVEL / 'share/bash-completion/completions/frictional_contact_sim'
PROGRAMS = DEVEL / 'lib/frictional_contact_sim'


def bash(script):
    environment = dict(os.environ, ROS_PACKAGE_PATH=f'{ROOT}:/usr/share')
    return subprocess.run(['bash', '-c', script], capture_output=True, text=True, timeout=60, env=environment)


def complete(line, before=''):
    """What TAB offers at the end of a line."""
    words = shlex.split(line) + ([''] if line.endswith(' ') else [])
    done = bash(f'{before}\n. {FILE}\nCOMP_WORDS=({" ".join(map(shlex.quote, words))}); COMP_CWORD={len(words) - 1}\n'
                f'function=$(complete -p {words[0]} | sed "s/.* -F \\([^ ]*\\) .*/\\1/")\n'
                f'$function {words[0]} {shlex.quote(words[-1])}; printf "%s\\n" "${{COMPREPLY[@]}}"')
    assert done.stderr == '', done.stderr
    return set(done.stdout.split())


class CompletionTest(unittest.TestCase):
    def test_programs(self):
        for command in ('rosrun frictional_contact_sim ', 'scripts/run ', './scripts/run '):
            offered = complete(command)
            self.assertLessEqual({'run_scenario', 'fclib_solve', 'simulator_node', 'load_robot'}, offered)
            self.assertFalse([name for name in offered if name.startswith('test_')])
        self.assertEqual({'run_scenario'}, complete('scripts/run run'))

    def test_options_are_those_of_the_help_of_each_program(self):
        for name in ('run_scenario', 'fclib_solve', 'compare_solvers', 'rolling_contact', 'generate_problem'):
            text = subprocess.run([PROGRAMS / name, '--help'], capture_output=True, text=True).stdout
            options = set(re.findall(r'(?<![\w-])--[a-z][a-z-]*', text))
            self.assertIn('--version', options)
            self.assertEqual(options, complete(f'rosrun frictional_contact_sim {name} FILE --'), name)
        self.assertEqual({'--save-state', '--solver', '--summary'}, complete('scripts/run run_scenario grasp --s'))

    def test_subcommands(self):
        self.assertLessEqual({'alea', 'rods', 'granular', 'boxes'}, complete('scripts/run generate_problem '))
        self.assertIn('--tilt', complete('scripts/run generate_problem boxes --'))
        self.assertNotIn('--tilt', complete('scripts/run generate_problem rods --'))

    def test_scenarios_solvers_and_parameters(self):
        names = {path.stem for path in (ROOT / 'config/scenarios').glob('*.yaml')}
        self.assertEqual(names, complete('rosrun frictional_contact_sim run_scenario '))
        self.assertEqual({'ac_newton', 'ac_fixed_point', 'admm'}, complete('scripts/run run_scenario grasp --solver a'))
        self.assertEqual({'_robots:=', '_robot_description:='}, complete('rosrun frictional_contact_sim simulator_node _rob'))

    def test_other_packages_stay_with_who_completed_them(self):
        before = 'other() { COMPREPLY=(theirs); }; complete -F other rosrun'
        self.assertEqual({'theirs'}, complete('rosrun rviz r', before))
        self.assertIn('run_scenario', complete('rosrun frictional_contact_sim r', before))

    def test_setup_bash_brings_it_where_somebody_types(self):
        done = bash(f'bash --norc -i -c ". {DEVEL}/setup.bash; complete -p rosrun; complete -p scripts/run" </dev/null')
        self.assertEqual(2, done.stdout.count('_frictional_contact_sim_'), done.stdout + done.stderr)
        done = bash(f'set -e; . {DEVEL}/setup.bash; complete -p rosrun || echo none')
        self.assertEqual('none\n', done.stdout)


if __name__ == '__main__':
    unittest.main()
