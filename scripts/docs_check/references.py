"""What texts refer to: paths in links, inline code and comments; names of the node."""
import difflib
import io
import re
import tokenize

from . import blocks

SUFFIXES = 'md|rst|h|cpp|py|yaml|urdf|launch|rviz|msg|srv|test|txt|csv|xml|bash'
FILE = re.compile(rf'(?<![\w/.~$*<>{{}}-])((?:\.\./)*(?:[\w.-]+/)*[\w*-]+\.(?:{SUFFIXES}))(?![\w/])')
FOLDERED = re.compile(r'(?<![\w/.~$*<>{}-])((?:docs|src|include|test|scripts|config|launch|urdf|examples|benchmark|msg|srv|devel)'
                      r'/[\w./*-]*\w)')
NODE_NAME = re.compile(r'(?<![\w/~.])~([a-zA-Z][\w/]*)')
CAPITALS = re.compile(r'(^|[/_])[A-Z][A-Z0-9_]{2,}|(^|/)[A-Z]{2,}\.')
COMMENTED = ('include', 'src', 'test', 'scripts', 'benchmark', 'examples', 'config', 'launch', 'msg', 'srv', 'CMakeLists.txt')


def expand(name):
    """a.{h,cpp} as [a.h, a.cpp]"""
    match = re.search(r'\{([\w,]+)\}', name)
    return [name[:match.start()] + part + name[match.end():] for part in match.group(1).split(',')] if match else [name]


def is_there(repo, name, folder):
    """@param folder of the text that says it"""
    if name.startswith('../shared/'):
        return not name.endswith('.md')  # data beside the checkout, which may be absent; never a page
    if CAPITALS.search(name) and not name.endswith('.md'):  # a placeholder, in a folder that is there
        if '/' in name and '.' in name and not re.search(rf'\.({SUFFIXES}|bag|hdf5|png)$', name):
            return False
        fixed = re.split(r'(?:^|/)[^/]*[A-Z]{2}', name)[0]
        return not fixed or repo.resolve(fixed)
    if name.endswith('.md') and not set('/*') & set(name):
        return name in repo.files
    if '/' in name:
        return repo.resolve(name) or (repo.root / folder / name).exists() or f'"{name}"' in repo.literals
    return name in repo.files or name in repo.literals or any(path.match(name) for path in repo.paths() if '*' in name) or \
        f'<{name}>' in includes(repo)


def is_near_folder(repo, name):
    """A path whose first folder is not there, but nearly."""
    first = name.split('/')[0]
    return '/' in name and first not in repo.folders and \
        bool(difflib.get_close_matches(first, [folder for folder in repo.folders if len(folder) > 2], cutoff=0.8))


def includes(repo):
    """All #include lines: comments may speak of headers of others."""
    if not hasattr(repo, 'include_lines'):
        repo.include_lines = '\n'.join(line for path in repo.paths() if path.suffix in ('.h', '.cpp')
                                       for line in repo.text(path).split('\n') if line.startswith('#include'))
    return repo.include_lines


def check_document(repo, document):
    found = []
    text = repo.text(document)
    for number, code in blocks.inline_code(repo, document):
        for name in [part for whole in re.findall(r'[\w./*{},-]+', code) for part in expand(whole)]:
            if (FILE.fullmatch(name) or FOLDERED.fullmatch(name.rstrip('.')) or is_near_folder(repo, name)) and not is_there(repo, name, document.parent):
                found.append((document, number, f'no file {name}'))
    fenced = False
    for number, line in enumerate(text.split('\n'), 1):
        fenced ^= line.strip().startswith('```')
        for target in re.findall(r'\]\(([^)#\s]+)(?:#[\w-]*)?\)', line):
            # A template becomes a page of docs/.
            folder = 'docs' if document.stem.endswith('_template') else document.parent
            if not target.startswith(('http:', 'https:')) and not (repo.root / folder / target).exists():
                found.append((document, number, f'no file {target}'))
        for name in re.findall(r'[A-Z_]{4,}\.md', line):
            if name not in repo.files:
                found.append((document, number, f'no page {name}'))
        for name in NODE_NAME.findall(line):
            if not repo.is_node_name(name.rstrip('/')):
                found.append((document, number, f'the node has no parameter, topic or service ~{name}'))
    return found


def comments(path, text):
    """(line, comment) of a source."""
    if path.suffix in ('.h', '.cpp'):
        code = re.sub(r'"(?:[^"\\\n]|\\.)*"', lambda literal: ' ' * len(literal.group()), text)
        for match in re.finditer(r'//[^\n]*|/\*.*?\*/', code, re.S):
            for offset, line in enumerate(match.group().split('\n')):
                yield text.count('\n', 0, match.start()) + 1 + offset, line
    elif path.suffix == '.py' or text.startswith(('#!/usr/bin/python3', '#!/usr/bin/env python3')):
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and token.string.startswith('"""')):
                for offset, line in enumerate(token.string.split('\n')):
                    yield token.start[0] + offset, line
    else:
        for number, line in enumerate(text.split('\n'), 1):
            if '#' in line:
                yield number, line.split('#', 1)[1]


def commented(repo):
    """Files whose comments are looked at."""
    return [path for path in repo.paths()
            if path.parts[0] in COMMENTED and path.suffix not in ('.md', '.csv', '.png', '.urdf', '.launch')]


def check_comments(repo, path):
    """A comment sends its reader to nothing that the repository does not have."""
    found = []
    for number, line in comments(path, repo.text(path)):
        for name in set(FILE.findall(line) + FOLDERED.findall(line)):
            if not is_there(repo, name, path.parent):
                found.append((path, number, f'a comment names {name}, which is not there'))
        for name in re.findall(r'(?<![\w/.-])(?:DESIGN|VERIFICATION|METHODS|INTERFACES|SEED_AUDIT)(?![\w])', line):
            found.append((path, number, f'a comment names {name}, a page that is not in the repository'))
    return found
