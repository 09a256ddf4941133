#!/usr/bin/env python3
"""Fails on any #include that the module table of docs/architecture.md does not allow.

A module may include itself, the modules below it that the table names (and what those may include), the C++ standard
library and Eigen, and the third-party headers listed here; these only below src/, FCL and urdfdom in .cpp files.
Headers that include each other in a circle fail too: #pragma once hides that from the compiler.
"""
import pathlib
import re
import sys

PACKAGE = "frictional_contact_sim"
ROOT = pathlib.Path(__file__).resolve().parent.parent

# module: the project modules it may include directly; permission is transitive, as linking is.
MODULES = {
    "math": [],
    "config": [],
    "problem": ["math"],
    "separation": ["problem"],
    "solver": ["problem", "separation", "math", "config"],
    "model": ["math"],
    "collision": ["model"],
    "dynamics": ["model", "collision", "problem"],
    "deformable": ["dynamics", "collision", "config"],
    "simulation": ["dynamics", "deformable", "solver", "config"],
    "rolling": ["math", "solver", "config"],
    "ros": ["simulation", "config"],
}
# Third-party headers by first path element (or whole name): the modules that may include them below src/.
PRIVATE = {
    "fclib.h": ["problem"], "fclib.hpp": ["problem"], "hdf5.h": ["problem"], "H5Cpp.h": ["problem"],
    "cholmod.h": ["problem", "solver"], "coin": ["problem", "separation"], "suitesparse": ["problem", "solver"],
    "fcl": ["collision"], "assimp": ["collision"], "libqhull_r": ["collision"], "libqhullcpp": ["collision"],
    "urdf_parser": ["model"], "urdf_model": ["model"], "urdf_world": ["model"], "urdf": ["model"],
    "console_bridge": ["model"], "tinyxml2.h": ["model"], "tinyxml.h": ["model"], "rospack": ["model"],
    "yaml-cpp": ["config"],
}
CPP_ONLY = {"fcl", "urdf_parser", "urdf_model", "urdf_world", "urdf"}  # rule 10 of docs/architecture.md: not in private headers either
ROS = {"ros", "std_msgs", "std_srvs", "sensor_msgs", "geometry_msgs", "nav_msgs", "visualization_msgs", "rosgraph_msgs",
       "tf2_msgs", "trajectory_msgs", "diagnostic_msgs", "xmlrpcpp", "XmlRpcValue.h", "XmlRpcClient.h", "XmlRpc.h",
       "rosbag", "topic_tools", "actionlib", "actionlib_msgs", "diagnostic_updater", "tf2_ros", "tf2", "dynamic_reconfigure", "boost"}  # boost: only where roscpp hands it out
TOOL_HEADERS = {"CLI", "nlohmann", "nlohmann_json"}
POSIX = {"unistd.h", "sys", "fcntl.h", "signal.h", "cxxabi.h", "dlfcn.h"}
TEST_HEADERS = {"gtest", "gmock", "benchmark", "support"}
EVERYWHERE = {"Eigen"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(<|")([^>"]+)[>"]')


def closure(module):
    """The module and everything it may include."""
    found, todo = set(), [module]
    while todo:
        name = todo.pop()
        if name not in found:
            found.add(name)
            todo += MODULES[name]
    return found


def place(path):
    """(module, is it a header, is it a public one) of a file; outside the modules the module is tools, test, ..."""
    parts = path.relative_to(ROOT).parts
    public = parts[0] == "include"
    module = parts[2] if public else parts[1] if parts[0] == "src" else parts[0]
    return module, path.suffix == ".h", public


def violation(path, quoted, name):
    """Why this include is not allowed, or None."""
    module, is_header, is_public = place(path)
    parts = name.split("/")
    first = parts[0]
    if first == PACKAGE and len(parts) == 2:  # generated message or service
        return None if module == "ros" or module not in MODULES else "generated messages belong to ros"
    if module not in MODULES:  # tools, tests and benchmarks may use every module
        if module == "tools" and first in ROS:
            return "ROS headers belong to the module ros"
        return None
    if first == PACKAGE:
        if parts[1] not in MODULES:
            return f"no module {parts[1]}"
        return None if parts[1] in closure(module) else f"{module} must not know {parts[1]}"
    if quoted and (path.parent / name).is_file() and place((path.parent / name).resolve())[0] == module:
        return None
    if first in EVERYWHERE or (not quoted and len(parts) == 1 and "." not in name):
        return None
    if first in ROS:
        return None if module == "ros" else "ROS headers belong to the module ros"
    if first in POSIX:
        return "POSIX headers belong into .cpp files" if is_header else None
    if first in PRIVATE:
        if module not in PRIVATE[first]:
            return f"{first} belongs to {' and '.join(PRIVATE[first])}"
        return f"{first} belongs into .cpp files" if is_header and (is_public or first in CPP_ONLY) else None
    if first in TOOL_HEADERS:
        return "command-line and JSON headers belong to tools"
    return "not in the table of scripts/check_layers.py"


def included(path):
    """The files of this package that a file includes."""
    for line in path.read_text().splitlines():
        match = INCLUDE.match(line)
        if match:
            name = match.group(2)
            yield from (file for file in (ROOT / "include" / name, path.parent / name) if file.is_file())


def circles(files):
    """One line for each circle of includes, found by walking down from every file."""
    state, chain = {}, []

    def walk(path):
        state[path] = "open"
        chain.append(path)
        for target in included(path):
            if state.get(target) == "open":
                yield " -> ".join(file.name for file in chain[chain.index(target):] + [target])
            elif target not in state:
                yield from walk(target)
        chain.pop()
        state[path] = "done"

    for path in files:
        if path not in state:
            yield from walk(path)


def main():
    files = [path for folder in ("include", "src", "test", "benchmark") for suffix in ("*.h", "*.cpp")
             for path in sorted((ROOT / folder).rglob(suffix))]
    failures = 0
    for path in files:
        module = place(path)[0]
        top = path.relative_to(ROOT).parts[0]
        if top in ("include", "src") and module not in MODULES and module != "tools":
            print(f"{path.relative_to(ROOT)}: module {module} is not in the table of docs/architecture.md")
            failures += 1
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            reason = match and violation(path, match.group(1) == '"', match.group(2))
            if reason:
                print(f"{path.relative_to(ROOT)}:{number}: {match.group(2)}: {reason}")
                failures += 1
    for circle in circles(files):
        print(f"circle of includes: {circle}")
        failures += 1
    print(f"check_layers: {len(files)} files, {failures} violations")
    return 1 if failures or not files else 0


if __name__ == "__main__":
    sys.exit(main())
