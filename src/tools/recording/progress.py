"""A bar with the time left on a terminal, for work over two seconds; what programs share."""
import argparse
import os
import pathlib
import re
import sys
import time

from .model import InputError

QUIET = 2.0     # no bar before that [s]
INTERVAL = 0.1  # between two pictures of it [s]
WIDTH = 30


class Progress:
    def __init__(self):
        self.on = sys.stderr.isatty()
        self.shown = False

    def start(self, total, what):
        self.total, self.what, self.began, self.drawn = max(total, 1), what, time.monotonic(), 0.0

    def update(self, done):
        now = time.monotonic()
        spent = now - self.began
        if not self.on or spent < QUIET or now - self.drawn < INTERVAL:
            return
        self.drawn, self.shown = now, True
        share = min(max(done / self.total, 1e-3), 1.0)
        bar = "#" * int(WIDTH * share)
        sys.stderr.write(f"\r{self.what} [{bar:<{WIDTH}}] {100 * share:3.0f} %, {spent * (1.0 / share - 1.0):.0f} s left \x1b[K")
        sys.stderr.flush()

    def end(self):
        if self.shown:
            sys.stderr.write("\r\x1b[K")
            self.shown = False


def read(path, node, robots, progress):
    """A recording of a bag or a folder, and lines that say what is missing in it."""
    from .bag import read_bag
    from .folder import read_folder
    path = pathlib.Path(path)
    if path.is_dir():
        return read_folder(path, robots, progress), []
    if not path.exists():
        raise InputError(f"{path}: not found, expected a bag or an output folder of run_scenario")
    return read_bag(path, node, robots, progress)


def run(name, work):
    """Exit code of a program: 0, 2 for bad input with one line, 130 when interrupted."""
    try:
        work()
        return 0
    except InputError as error:
        print(f"{name}: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        print(f"{name}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 2


def version():
    """Of the package, in a checkout and where it is installed."""
    here = pathlib.Path(__file__).resolve().parent  # src/tools/recording, lib/NAME/recording
    for path in (here.parent.parent.parent / "package.xml", here.parent.parent.parent / "share" / "frictional_contact_sim" / "package.xml"):
        if path.is_file():
            return re.search(r"<version>(.*?)</version>", path.read_text())[1]
    return "unknown"


class Parser(argparse.ArgumentParser):
    """Bad arguments are one line, as with all programs of the package."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {message} (see --help)\n")


def positive(text):
    """An argument that counts."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"found {text}, expected 1 or more")
    return value
