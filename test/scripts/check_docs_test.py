#!/usr/bin/python3
"""scripts/check_docs finds what is wrong: faults of every kind planted into a copy of the repository, and random ones."""
import importlib.machinery
import importlib.util
import pathlib
import random
import re
import shutil
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MUTATIONS = 20  # of each kind
SEED = 20261127


def load(path):
    loader = importlib.machinery.SourceFileLoader('check_docs', str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader('check_docs', loader))
    loader.exec_module(module)
    return module


check_docs = load(ROOT / 'scripts/check_docs')
COMMAND_OPTION = re.compile(r'(?<![\w-])--([a-z][a-z-]+[a-z])')
PATH = re.compile(r'(?<![\w/.])((?:scripts|config|examples|urdf|docs|devel|src|include|test)/[\w./-]*\w)(?![\w/*{.-]|\.\w)')
PROGRAM = re.compile(r'(?<=scripts/run )([a-z_]+)')
ARGUMENT = re.compile(r'(?<= )([a-z_]+)(?=:=)')
NODE_NAME = re.compile(r'(?<=`~)([a-z_]+)(?=`)')
COMMENTED = re.compile(r'(docs/[a-z_]+\.md|(?:problem|solver|dynamics|simulation)/[a-z_]+\.h)')


class CheckDocsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name) / 'copy'
        shutil.copytree(ROOT, self.root, ignore=shutil.ignore_patterns('build*', 'devel', '.git', '.cache', '__pycache__', 'install'))
        self.random = random.Random(SEED)

    def tearDown(self):
        self.folder.cleanup()

    def findings(self, only=None):
        return check_docs.findings(self.root, ROOT / 'devel', only)

    def found_with(self, path, changed):
        """Texts of what is found where a file has another content; the repository itself has no findings."""
        text = path.read_text()
        path.write_text(changed)
        try:
            return [fault for _, _, fault in self.findings(str(path.relative_to(self.root)))]
        finally:
            path.write_text(text)

    def plant(self, document, before, after):
        """What is found where the first occurrence is replaced."""
        path = self.root / document
        text = path.read_text()
        self.assertIn(before, text)
        return self.found_with(path, text.replace(before, after, 1))

    def test_the_repository_itself_is_clean(self):
        self.assertEqual([], self.findings())

    def test_each_kind_of_fault_is_found(self):
        line = 'scripts/run run_scenario config/scenarios/quadruped.yaml --json\n'
        for fault in ('scripts/run run_scenario config/scenarios/quadruped.yaml --jason\n',
                      'scripts/run run_scenario config/scenarios/quadrupede.yaml --json\n',
                      'scripts/run run_scenery config/scenarios/quadruped.yaml --json\n',
                      'scripts/rum run_scenario config/scenarios/quadruped.yaml --json\n',
                      'script/run run_scenario config/scenarios/quadruped.yaml --json\n',
                      'source build/devel/setup.bash\n',
                      'build/devel/lib/frictional_contact_sim/run_scenario config/scenarios/quadruped.yaml\n',
                      'bulid/devel/lib/frictional_contact_sim/run_scenario config/scenarios/quadruped.yaml\n',
                      'rosrun frictional_contact_sim run_scenario config/scenarios/grasp.yaml --no_fallback\n',
                      'rosrun frictional_contact_simulator run_scenario config/scenarios/grasp.yaml\n',
                      'roslaunch frictional_contact_sim simulator.launch robot:=quadruped\n',
                      'roslaunch frictional_contact_sim simulate.launch robots:=quadruped\n',
                      'roslaunch frictional_contact_sim simulate.launch robot_file:=urdf/quadruped.urdf\n',
                      'roslaunch frictional_contact_sim simulate.launch robot:=quadrupod\n',
                      'roslaunch frictional_contact_sim simulate.launch scenario:=grip\n',
                      'roslaunch frictional_contact_sim simulate.launch solver:=newton\n',
                      'rosrun frictional_contact_sim simulator_node _time_steps:=0.001\n',
                      'rostopic echo /simulator_node/contact\n',
                      'rosservice call /simulator_node/unpaused\n',
                      'rosmsg show frictional_contact_sim/Contacts\n',
                      'scripts/run fclib_solve FILE.hdf5 --solver gauss\n',
                      'scripts/run generate_problem boxes --seeds 1 OUT.hdf5\n',
                      'scripts/run fclib_solve /tmp/nobody_wrote_this.hdf5\n',
                      'scripts/check_docs --all\n',
                      'scripts/check_docs "without an end\n',
                      'frobnicate\n'):
            with self.subTest(fault.strip()):
                self.assertTrue(self.plant('README.md', line, fault))

    def test_texts_that_name_what_is_not_there_are_found(self):
        for document, before, after in (
                ('docs/architecture.md', '[residuals.md](residuals.md)', '[residuals.md](residual.md)'),
                ('docs/architecture.md', '`dynamics/row_source.h`', '`dynamics/row_sources_of.h`'),
                ('docs/interfaces.md', '`~marker_rate`', '`~marker_frequency`'),
                ('docs/migration.md', '`~set_paused`', '`~set_pause`'),
                ('CHANGELOG.rst', '``scripts/demo``', '``scripts/demonstrate``'),
                ('launch/simulate.launch', 'simulate.launch robot:=quadruped', 'simulate.launch robo:=quadruped'),
                ('include/frictional_contact_sim/problem/residual.h', 'docs/residuals.md', 'docs/the_plan.md'),
                ('src/simulation/step.cpp', 'docs/architecture.md', 'DESIGN.md'),
                ('scripts/environment.sh', '# Sourced by', '# As docs/no_such_page.md says, sourced by')):
            with self.subTest(f'{document}: {after}'):
                self.assertTrue(self.plant(document, before, after))

    def test_what_the_page_of_interfaces_leaves_out_is_found(self):
        for name in ('~marker_rate', '~force_scale', '~set_paused', 'hold_initial_position', 'wrenches', 'broad_phase', '--dump-every'):
            with self.subTest(name):
                page, readme = self.root / 'docs/interfaces.md', self.root / 'README.md'
                original = page.read_text(), readme.read_text()
                for path, text in zip((page, readme), original):
                    path.write_text(text.replace(name, ''))
                self.assertTrue([text for _, _, text in self.findings() if text.startswith('no word') and name.lstrip('~') in text])
                page.write_text(original[0])
                readme.write_text(original[1])

    def test_a_letter_less_is_found(self):
        """Random letters dropped from real options, paths, programs, arguments and names."""
        for kind, pattern, documents in (('option', COMMAND_OPTION, ['README.md', 'docs/*.md']),
                                         ('path', PATH, ['README.md', 'docs/*.md']),
                                         ('program', PROGRAM, ['README.md', 'docs/*.md']),
                                         ('argument', ARGUMENT, ['README.md']),
                                         ('name of the node', NODE_NAME, ['README.md', 'docs/*.md']),
                                         ('path in a comment', COMMENTED, ['include/**/*.h', 'src/**/*.cpp'])):
            places = self.places(pattern, documents)
            self.assertGreater(len(places), 3, kind)
            for path, start, end in self.random.sample(places, min(MUTATIONS, len(places))):
                text = path.read_text()
                drop = self.random.choice([i for i in range(start, end)
                                           if text[i].islower() and text[i - 1] != '.'])  # not of placeholders; `name.` may end a sentence
                changed = text[start:drop] + text[drop + 1:end]
                with self.subTest(f'{kind}: {path.relative_to(self.root)}: {text[start:end]} -> {changed}'):
                    self.assertTrue(self.found_with(path, text[:drop] + text[drop + 1:]))

    def places(self, pattern, documents):
        """(file, start, end) of what may be mutated: commands and inline code of documents, comments of sources."""
        found = []
        for path in sorted(path for document in documents for path in self.root.glob(document)):
            text = path.read_text()
            if path.suffix == '.md':
                areas = [m.span() for m in re.finditer(r'(?s)(?<=```sh\n).*?(?=```)', text)]
                # Inline code is a command where it starts with a program or a script; a path or a name of the node otherwise.
                if pattern in (PATH, NODE_NAME):
                    areas += [m.span() for m in re.finditer(r'`[^`\n]+`', re.sub(r'(?s)```.*?```', lambda m: ' ' * len(m.group()), text))]
            else:
                areas = [m.span() for m in re.finditer(r'(?s:/\*\*.*?\*/)|^ *//[^\n]*', text, re.M)]
            for begin, finish in areas:
                found += [(path, begin + m.start(1), begin + m.end(1)) for m in pattern.finditer(text[begin:finish])
                          if '#' not in text[text.rfind('\n', 0, begin + m.start()) + 1:begin + m.start()] or path.suffix != '.md']
        return found


class CommandsAreRunTest(unittest.TestCase):
    """A small repository whose commands fail, hang or end in their own ways."""

    def run_block(self, mark, commands):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / 'README.md').write_text(f'{mark}\n```sh\n{commands}\n```\n')
            repo = check_docs.repository.Repository(root, root / 'devel')
            return check_docs.blocks.run_all(repo, repo.documents(), True)

    def test_exit_codes_count(self):
        self.assertEqual((1, []), self.run_block('', 'true\necho x > /tmp/x\ncat /tmp/x'))
        done, found = self.run_block('', 'echo first\nfalse\ntrue')
        self.assertEqual((1, 1), (done, len(found)))
        self.assertIn('exit code 1: first', found[0][2])

    def test_what_is_marked_is_not_run(self):
        self.assertEqual((0, []), self.run_block('<!-- check_docs: not run: no reason -->', 'false'))
        self.assertEqual((0, []), self.run_block('', 'false FILE.yaml'))

    def test_what_runs_until_interrupted(self):
        life, check_docs.blocks.LIFE = check_docs.blocks.LIFE, 1.0
        mark = '<!-- check_docs: until interrupted -->'
        self.assertEqual((1, []), self.run_block(mark, "trap 'exit 0' 2\nwhile true; do sleep 0.1; done"))
        self.assertEqual(1, len(self.run_block(mark, "trap 'exit 3' 2\nwhile true; do sleep 0.1; done")[1]))
        self.assertEqual(1, len(self.run_block(mark, 'true')[1]))
        check_docs.blocks.LIFE = life


if __name__ == '__main__':
    unittest.main()
