"""docs/interfaces.md names all that the code offers: parameters, topics, services, scenario keys, programs, options."""
import pathlib
import re

PAGE = pathlib.Path('docs/interfaces.md')
KEY = re.compile(r'[kK]ey\(\s*"(\w+)"')
ADVERTISED = re.compile(r'\b(?:advertise\w*(?:<[^;"]*>)?|subscribe\w*(?:<[^;"]*>)?|add(?:<[\w:]+>)?)\(\s*(?:\w+, )?"([\w/]+)"')
# Kind, files, names in them, and how many there are at least: a reader that is written anew must not escape the check.
SOURCES = [
    ('parameter', 'src/ros/param*.cpp', KEY.findall, 25),
    ('topic or service', 'src/ros/*.cpp', ADVERTISED.findall, 15),
    ('key of a scenario', 'src/simulation/scenario*.cpp', KEY.findall, 20),
    ('key of a body', 'src/simulation/body_keys.cpp', KEY.findall, 25),
]
DOCUMENTED = ['run_scenario', 'fclib_solve', 'compare_solvers', 'rolling_contact', 'simulator_node', 'record_bag', 'plot_bag', 'replay']  # their options


def check(repo):
    page = repo.text(PAGE)
    found = [(PAGE, 1, f'no word of the program {path.stem}') for path in repo.paths()
             if str(path.parent) == 'src/tools' and path.suffix in ('.cpp', '') and not names(page, path.stem)]
    for kind, pattern, extract, least in SOURCES:
        offered = {name for path in sorted(repo.root.glob(pattern)) for name in extract(path.read_text())}
        if len(offered) < least:
            found.append((PAGE, 1, f'{len(offered)} names of kind {kind} found in {pattern}, expected {least} at least: '
                                   'scripts/docs_check/completeness.py looks for them wrongly'))
        found += [(PAGE, 1, f'no word of the {kind} {name}') for name in sorted(offered) if not names(page, name.rstrip('/'))]
    everywhere = '\n'.join(repo.text(path) for path in repo.documents() if path.suffix == '.md')
    for program in DOCUMENTED:
        options = (repo.options(program, []) or set()) - {'--help'}
        found += [(PAGE, 1, f'no word of the option {option} of {program}') for option in sorted(options)
                  if not re.search(rf'(?<![\w-]){option}(?![\w-])', everywhere)]
    return found


def names(page, name):
    return re.search(rf'(?<![\w/]){re.escape(name)}(?!\w)', page)
