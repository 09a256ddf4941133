"""What there is: files, programs and their options, launch arguments, names of the node."""
import ast
import functools
import os
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

PACKAGE = 'frictional_contact_sim'
NOT_OURS = re.compile(r'^(build.*|devel|install|\.git|\.cache|__pycache__)$')  # as .gitignore
OPTION = re.compile(r'(?<![\w-])--[a-z][a-z0-9-]*')
HELP_TIMEOUT = 8.0  # of PROGRAM --help [s]: the machine may be loaded


@functools.lru_cache(maxsize=None)
def ask(*command):
    """Output of a command that needs no master; empty when it fails or does not end."""
    environment = dict(os.environ, ROS_MASTER_URI='http://localhost:1')
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=HELP_TIMEOUT, env=environment,
                              stdin=subprocess.DEVNULL)
    except (subprocess.TimeoutExpired, OSError):
        return ''
    return done.stdout if done.returncode == 0 else ''


def head(text):
    """The comment or docstring that a script opens with."""
    if text.startswith('#!') and 'python' in text.split('\n', 1)[0]:
        return ast.get_docstring(ast.parse(text)) or ''
    lines = text.split('\n')
    end = next((i for i, line in enumerate(lines) if not line.startswith('#')), len(lines))
    return '\n'.join(lines[1:end])


class Repository:
    def __init__(self, root, devel):
        self.root, self.devel = root, devel
        self.files = {}
        for folder, folders, names in os.walk(root):
            folders[:] = [name for name in folders if not NOT_OURS.match(name)]
            for name in names:
                path = pathlib.Path(folder) / name
                self.files.setdefault(name, []).append(path.relative_to(root))

    def paths(self):
        return sorted(path for paths in self.files.values() for path in paths)

    @functools.cached_property
    def folders(self):
        """At the top, and the modules: what paths start with."""
        return {'devel', 'build'} | {path.parts[0] for path in self.paths() if len(path.parts) > 1} | \
            {path.parts[1] for path in self.paths() if path.parts[0] == 'src' and len(path.parts) > 2}

    @functools.lru_cache(maxsize=None)
    def text(self, path):
        return (self.root / path).read_text(errors='replace')

    def documents(self):
        return [path for path in self.paths()
                if path.suffix in ('.md', '.rst', '.launch') and path.parts[0] not in ('.ci', 'scripts')]

    def exists(self, path):
        return (self.root / path).exists()

    def resolve(self, name):
        """Whether a path as documents and comments write it is there: from the root, or from the folders of the sources."""
        bases = ['', f'include/{PACKAGE}', 'src', 'test', 'scripts', 'benchmark']
        if name.startswith('devel/'):
            return (self.devel / name[len('devel/'):]).exists()
        if name.startswith('build/'):
            return name.rstrip('/') == 'build' or (self.root / name).exists()
        return any(next(self.root.glob(f'{base}/{name}'.strip('/')), None) for base in bases)

    @functools.cached_property
    def programs(self):
        """Names of the executables of a build with tests and benchmarks (CMakeLists.txt makes them from these files)."""
        names = {path.stem for path in self.paths() if path.suffix == '.cpp' and
                 (path.parts[0] == 'examples' or str(path.parent) in ('src/tools', 'test/state_hashes', 'test/robustness'))}
        names |= {path.name for path in self.paths() if str(path.parent) == 'src/tools' and not path.suffix}  # in Python
        names |= {f'test_{path.parts[1]}' for path in self.paths() if path.parts[0] == 'test' and path.suffix == '.cpp'}
        return names | {f'benchmark_{path.stem}' for path in self.paths()
                        if str(path.parent) == 'benchmark' and path.suffix == '.cpp'}

    def help(self, program, *subcommand):
        return ask(str(self.devel / 'lib' / PACKAGE / program), *subcommand, '--help')

    def options(self, program, arguments):
        """Known options of a program (with its subcommand), None when it cannot be asked."""
        text = self.help(program)
        subcommands = re.search(r'Subcommands:\n(.*)', text, re.S)
        for name in re.findall(r'^  ([\w-]+)', subcommands.group(1), re.M) if subcommands else []:
            if name in arguments:
                text += self.help(program, name)
        return set(OPTION.findall(text)) if text else None

    def foreign_options(self, name):
        """Of the programs of others that documents give options to; None: not looked at."""
        return {'cmake': {'--build', '--target', '--parallel', '--install', '--prefix'}}.get(name) or \
            (set(OPTION.findall(ask(name, '--help'))) if name in ('roslaunch', 'rostest') else None)

    def script_options(self, path):
        text = self.text(path)
        return set(OPTION.findall(head(text))) | set(re.findall(r'add_argument\(\s*[\'"](--[\w-]+)', text)) | {'--help'}

    @functools.cached_property
    def solvers(self):
        return {line.split()[0] for line in ask(str(self.devel / 'lib' / PACKAGE / 'fclib_solve'), '--list-solvers').split('\n')
                if line.strip()}

    def launch_arguments(self, path):
        """Arguments that a caller may set."""
        return {arg.get('name') for arg in ElementTree.fromstring(self.text(path)).iter('arg') if arg.get('value') is None}

    @functools.cached_property
    def node_words(self):
        """Parts, split at slashes, of the string literals of src/ros that are names: of parameters, topics and services."""
        words = set()
        for path in self.paths():
            if path.parent.name == 'ros' and path.suffix in ('.cpp', '.h'):
                for literal in re.findall(r'"[~/]?([\w/]+)"', self.text(path)):
                    words |= set(literal.split('/'))
        return words

    def is_node_name(self, name):
        """Every part of ~name is known, where a part in capitals or digits is a placeholder."""
        def known(part):
            stem, _, suffix = part.rpartition('_')
            return part in self.node_words or (stem in self.node_words and '_' + suffix in self.node_words)
        return all(re.fullmatch(r'[A-Z0-9_]+', part) or known(part) for part in name.split('/'))

    @functools.cached_property
    def literals(self):
        """All string literals of the sources and scripts: names of files that programs write are among them."""
        texts = [self.text(path) for path in self.paths()
                 if path.parts[0] in ('src', 'scripts', 'benchmark', 'test', 'examples') and
                 path.suffix in ('.cpp', '.h', '.py', '')]
        return '\n'.join(re.sub(r'^\s*(//|\*|#).*$', '', text, flags=re.M) for text in texts)
