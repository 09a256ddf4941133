"""Blocks of commands and inline code of a document; running the blocks."""
import collections
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import time

Block = collections.namedtuple('Block', 'line mode lines')  # lines: [(number, command)]
MARK = re.compile(r'<!-- check_docs: (long|until interrupted|not run: .+) -->')
PLACEHOLDER = re.compile(r'(?<![\w$@])[A-Z][A-Z_]{2,}(?:\.{3}|\.\w+)?(?![\w=:])|/path/to/')
TIMEOUT = {'': 300, 'long': 7200}  # of a block; the machine may be loaded [s]
LIFE = 20.0  # of what never ends by itself, before SIGINT [s]


def sh_blocks(repo, document):
    """The ```sh blocks of a document; in a launch file the lines of comments that start with roslaunch."""
    text = repo.text(document).split('\n')
    if document.suffix == '.launch':
        lines = [(n, line.strip().replace('-->', '')) for n, line in enumerate(text, 1) if line.strip().startswith('roslaunch ')]
        return [Block(lines[0][0], 'not run: shown in the README too', lines)] if lines else []
    found, mode, block = [], '', None
    for number, line in enumerate(text, 1):
        mark = MARK.search(line)
        if block is None and mark:
            mode = mark.group(1)
        elif block is None and re.fullmatch(r'```(sh|bash)', line.strip()):
            block = Block(number, mode, [])
        elif block is not None and line.strip() == '```':
            found.append(block)
            mode, block = '', None
        elif block is not None:
            join(block.lines, number, line)
        elif line.strip():
            mode = ''
    return found


def join(lines, number, line):
    """Appends a line of a block; one that goes on after a backslash to the one before."""
    if lines and lines[-1][1].endswith('\\'):
        lines[-1] = (lines[-1][0], lines[-1][1][:-1] + line.strip())
    elif line.strip():
        lines.append((number, line.strip()))


def inline_code(repo, document):
    """(line, code) of `code` and ``code`` outside of blocks."""
    fenced = False
    for number, line in enumerate(repo.text(document).split('\n'), 1):
        if line.strip().startswith('```'):
            fenced = not fenced
        elif not fenced and not line.startswith('    '):
            for match in re.finditer(r'(`+)([^`]+)\1', line):
                yield number, match.group(2)


def has_placeholder(block):
    return any(PLACEHOLDER.search(re.sub(r'\s#.*', '', line)) for _, line in block.lines)


def run_all(repo, documents, with_long):
    """Number of blocks run and findings; the commands of one block share a shell, files below /tmp are the document's."""
    done, found = 0, []
    for document in documents:
        with tempfile.TemporaryDirectory(prefix='check_docs_') as scratch:
            for block in sh_blocks(repo, document):
                if has_placeholder(block) or block.mode.startswith('not run') or (block.mode != '' and not with_long):
                    continue
                done += 1
                fault = run(repo, block, scratch)
                if fault:
                    found.append((document, block.line, fault))
    return done, found


def free_port():
    with socket.socket() as probe:
        probe.bind(('', 0))
        return probe.getsockname()[1]


def run(repo, block, scratch):
    """Why the block does not work, or None."""
    script = 'set -e\n' + '\n'.join(line for _, line in block.lines).replace('/tmp/', scratch + '/')
    ros = pathlib.Path(scratch) / 'ros'
    environment = dict(os.environ, ROS_MASTER_URI=f'http://localhost:{free_port()}', ROS_HOME=str(ros), ROS_LOG_DIR=str(ros))
    interrupt = block.mode == 'until interrupted'
    with tempfile.TemporaryFile(mode='w+') as output:
        process = subprocess.Popen(['/bin/bash', '-c', script], cwd=repo.root, env=environment, stdin=subprocess.DEVNULL,
                                   stdout=output, stderr=subprocess.STDOUT, start_new_session=True, preexec_fn=take_interrupts)
        try:
            code = process.wait(LIFE if interrupt else TIMEOUT[block.mode])
            early = interrupt
        except subprocess.TimeoutExpired:
            early = False
            code = stop(process) if interrupt else f'no end within {TIMEOUT[block.mode]} s ({stop(process)})'
        end_group(process)
        output.seek(0)
        tail = ' | '.join(re.sub(r'\x1b\S*?[mK]|\x1b\].*?\x07', '', output.read()).strip().split('\n')[-5:])
    if early:
        return f'ended by itself with exit code {code}: {tail}'
    return None if code == 0 else f'exit code {code}: {tail}'


def take_interrupts():
    """What a shell has put into the background ignores SIGINT, and so would all below it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def end_group(process):
    """SIGTERM to what the block left in the background: roslaunch ends its nodes then. SIGKILL to what stays."""
    for number in [signal.SIGTERM] + [0] * 20 + [signal.SIGKILL]:
        try:
            os.killpg(process.pid, number)
        except ProcessLookupError:
            return
        time.sleep(0.5 if number == 0 else 0.1)


def stop(process):
    """SIGINT to the whole group, as Ctrl-C does; then SIGKILL. Its exit code."""
    for number, patience in ((signal.SIGINT, 30), (signal.SIGKILL, 5)):
        os.killpg(process.pid, number)
        try:
            return process.wait(patience)
        except subprocess.TimeoutExpired:
            pass
    return None
