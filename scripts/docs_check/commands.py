"""Commands that documents show: programs, options, arguments and files."""
import re
import shlex

from . import blocks
from .repository import PACKAGE

# Programs of others that documents may use; their options are not looked at.
FOREIGN = {'apt-get', 'cat', 'catkin_make', 'cd', 'chmod', 'cmake', 'cp', 'done', 'echo', 'export', 'for', 'git', 'grep', 'head', 'kill', 'ls',
           'make', 'mkdir', 'python3', 'rm', 'rosbag', 'roscore', 'roslaunch', 'rosmsg', 'rosnode', 'rosparam', 'rosrun',
           'rosservice', 'rossrv', 'rostest', 'rostopic', 'rviz', 'sleep', 'source', 'valgrind', 'wait'}
SEPARATORS = {'&&', '||', '|', ';', '&', '(', ')'}
BEFORE = {'do', 'exec', 'sudo', 'time'}  # words a command may stand behind
# Options whose value is a file or folder that the command writes; words of ROS arguments likewise.
WRITES = {'--output', '--save-state', '--history', '--dump', '-O', '>', '>>', '-B', 'bag:=', '_bag:=', '_dump_dir:='}
WRITES_POSITIONAL = {'record_bag': 0, 'generate_problem': -1, 'robustness': 0, 'scripts/demo': 0, 'mkdir': -1, 'examples/bag_and_plots/record_and_plot': 0,
                     'scripts/compare_builds': 1}
EXTENSION = re.compile(r'\.(yaml|urdf|hdf5|csv|bag|launch|py|test|txt|bash|cpp|sh|md|state)$')
ROS_NAMES = {'rostopic', 'rosservice', 'rosbag', 'record_bag', 'rosparam'}


class Command:
    """One simple command: its words, and the document's line."""

    def __init__(self, words, redirections):
        while words and (words[0] in BEFORE or re.match(r'^\w+=', words[0])):
            words = words[1:]
        if words[:1] == ['nice']:
            words = words[3 if words[1:2] == ['-n'] else 1:]
        if words and re.search(r'(^|/)python3$', words[0]):
            words = words[1:]
        self.redirections = redirections
        self.kind, self.name, self.arguments = '', '', []
        if words:
            self.classify(words)

    def classify(self, words):
        self.name, self.arguments = words[0], words[1:]
        if words[0] in ('scripts/run', './scripts/run') and len(words) > 1:
            self.kind, self.name, self.arguments = 'program', words[1], words[2:]
        elif words[0] == 'rosrun' and len(words) > 2 and words[1] == PACKAGE:
            self.kind, self.name, self.arguments = 'program', words[2], words[3:]
        elif re.match(rf'(\./)?devel/lib/{PACKAGE}/', words[0]):
            self.kind, self.name = 'program', words[0].rsplit('/', 1)[1]
        elif '/' in words[0]:
            self.kind = 'script'
        else:
            self.kind = 'foreign' if words[0] in FOREIGN else 'program'


def split(line):
    """The simple commands of a line of shell."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars='&|;<>()')
    lexer.whitespace_split = True
    lexer.commenters = '#'
    words, redirections, found = [], [], []
    for token in list(lexer) + [';']:
        if token in SEPARATORS:
            found.append(Command(words, redirections))
            words, redirections = [], []
        elif token in ('>', '>>', '<') or redirections and redirections[-1] in ('>', '>>', '<'):
            redirections.append(token)
        else:
            words.append(token)
    return [command for command in found if command.kind]


def check(repo, document):
    """Findings in the blocks and in the inline code that starts with a program of ours."""
    found, written = [], set()
    for block in blocks.sh_blocks(repo, document):
        for number, line in block.lines:
            found += [(document, number, fault) for fault in check_line(repo, line, written)]
    for number, code in blocks.inline_code(repo, document):
        first = code.split()[0] if code.split() else ''
        if ' ' in code and (first in repo.programs or first.startswith('scripts/') or
                            first in ('roslaunch', 'rosrun', 'source', 'rostest') and PACKAGE in code + PACKAGE * (first == 'source')):
            found += [(document, number, fault) for fault in check_line(repo, code, written)]
    return found


def check_line(repo, line, written):
    try:
        commands = split(line)
    except ValueError as error:
        return [f'not a line of shell: {error}: {line}']
    faults = []
    for command in commands:
        faults += check_command(repo, command) + check_files(repo, command, written)
    return faults


def check_command(repo, command):
    """Of the command, of those that are its quoted arguments, and of a foreign program's options."""
    faults = check_own(repo, command)
    for word in command.arguments:
        if re.match(r'[\w.]+/[\w/]+ ', word):
            faults += [fault for inner in split(word) for fault in check_own(repo, inner)]
    known = repo.foreign_options(command.name) if command.kind == 'foreign' else None
    given = {word.split('=')[0] for word in command.arguments if word.startswith('--')} if known else set()
    return faults + [f'{command.name} has no option {option}' for option in sorted(given - (known or set()))]


def check_own(repo, command):
    if command.kind == 'program':
        return check_program(repo, command)
    if command.kind == 'script':
        return check_script(repo, command)
    if command.name == 'roslaunch':
        return check_launch(repo, command.arguments)
    if command.name in ('rosmsg', 'rossrv'):
        return [f'no message or service {word}' for word in command.arguments if word.startswith(PACKAGE + '/') and
                not any(repo.exists(f'{kind}/{word.split("/")[1]}.{kind}') for kind in ('msg', 'srv'))]
    if command.name in ('rosrun', 'rostest'):
        ours = PACKAGE in command.arguments or f'--package={PACKAGE}' in command.arguments
        return [] if ours else [f'another package: {" ".join(command.arguments)}']
    return check_ros_names(repo, command) if command.name in ROS_NAMES else []


def check_program(repo, command):
    if blocks.PLACEHOLDER.fullmatch(command.name):
        return []
    # rosrun finds the package's scripts too.
    if command.name not in repo.programs and not repo.exists(f'scripts/{command.name}'):
        return [f'no program {command.name}']
    faults = check_ros_names(repo, command) if command.name in ROS_NAMES else []
    given = {word.split('=')[0] for word in command.arguments if word.startswith('--')}
    if given:
        known = repo.options(command.name, command.arguments)
        if known is None:
            return [f'{command.name} --help gives no answer: not built?']
        faults += [f'{command.name} has no option {option}' for option in sorted(given - known)]
    for option, value in zip(command.arguments, command.arguments[1:]):
        if option in ('--solver', '--solvers', '--compare') and not blocks.PLACEHOLDER.fullmatch(value):
            faults += [f'no solver {name}' for name in value.split(',') if name not in repo.solvers]
    for word in command.arguments:
        name = re.match(r'^_(\w+):=', word)
        if name and not repo.is_node_name(name.group(1)):
            faults.append(f'the node has no parameter ~{name.group(1)}')
    return faults


def check_script(repo, command):
    name = command.name[2:] if command.name.startswith('./') else command.name
    path = repo.root / name
    if name.startswith('/') or name.startswith('../shared/'):
        return []
    if not path.is_file():
        return [f'no file {name}']
    if path.suffix != '.py' and not path.stat().st_mode & 0o100:
        return [f'{name} cannot be executed']
    given = {word.split('=')[0] for word in command.arguments if word.startswith('--')}
    known = repo.script_options(path.relative_to(repo.root))
    return [f'{name} has no option {option}' for option in sorted(given - known)]


def check_launch(repo, arguments):
    words = [word for word in arguments if not word.startswith('-')]
    if not words or words[0] != PACKAGE:
        return [f'roslaunch: found {words[:1]}, expected {PACKAGE} FILE.launch'] if ':=' not in words[:1] else []
    path = next((path for path in repo.files.get(words[1] if len(words) > 1 else '', []) if path.suffix == '.launch'), None)
    if path is None:
        return [f'no launch file {words[1:2]}']
    faults = []
    for word in words[2:]:
        name, _, value = word.partition(':=')
        if name not in repo.launch_arguments(path):
            faults.append(f'{path.name} has no argument {name}')
        for argument, place in (('robot', 'urdf/{}.urdf'), ('scenario', 'config/scenarios/{}.yaml')):
            if name == argument and re.fullmatch(r'[a-z]\w*', value) and not repo.exists(place.format(value)):
                faults.append(f'no {argument} {value}')
        if name == 'solver' and value not in repo.solvers:
            faults.append(f'no solver {value}')
    return faults


def check_ros_names(repo, command):
    """Topics, services and parameters as words: /simulator_node/NAME, or a name of the node outside of its own space."""
    faults = []
    for word in command.arguments:
        match = re.fullmatch(r'/(?:simulator_node/)?([\w/]+)', word)
        if match and not word.startswith(('/tmp/', '/path/', '/use_sim_time')) and not repo.is_node_name(match.group(1)):
            faults.append(f'the node has no name {word}')
    return faults


def check_files(repo, command, written):
    """Files that are read are there, or written by an earlier command; adds what this one writes."""
    inputs, outputs = [], []
    previous, positional = '', []
    for word in command.arguments + command.redirections:
        ros_argument, colon, value = word.partition(':=')
        if colon:
            (outputs if ros_argument + ':=' in WRITES else inputs).append(value)
        elif previous in WRITES and not word.startswith('-'):
            outputs.append(word)
        elif not word.startswith('-') and word not in ('>', '>>', '<'):
            inputs.append(word)
            positional.append(word)
        elif '=' in word:
            inputs.append(word.split('=', 1)[1])
        previous = word
    target = WRITES_POSITIONAL.get(command.name)
    if target is not None and positional and (command.name != 'scripts/compare_builds' or '--record' in command.arguments):
        position = positional[target] if target < len(positional) else positional[-1]
        inputs.remove(position)
        outputs.append(position)
    ros_names = ROS_NAMES if command.name in ROS_NAMES else ()
    faults = [fault for name in inputs for fault in [check_file(repo, name, written, command, ros_names)] if fault]
    written.update(name.rstrip('/') for name in outputs)
    return faults


def check_file(repo, name, written, command, ros_names):
    if re.search(r'[$*?{}\[\]\s]', name) or blocks.PLACEHOLDER.search(name) or name.startswith(('~', '../shared/', 'http')):
        return None
    if any(name == there or name.startswith(there + '/') for there in written):
        return None
    if name.startswith('/'):
        if ros_names and not name.startswith('/tmp/'):
            return None
        return None if not name.startswith('/tmp/') else f'{name}: no earlier command of this document writes it'
    if '/' not in name and not EXTENSION.search(name):
        return None
    if name.startswith(f'{PACKAGE}/') or (command.name == 'roslaunch' and name in repo.files):
        return None
    here = command.name == 'scripts/install_dependencies' and repo.exists(f'scripts/{name}')
    there = repo.resolve(name) if name.startswith(('devel/', 'build/')) else repo.exists(name)
    return None if here or there else f'no file {name}'
