#!/usr/bin/env python3
"""Adds up the results of scripts/test: every test case of every XML file, and every program that crashed.

A program counts one more failure when it left no result, left an empty one, or failed although all its cases passed.
Last line: 'N passed, N failed'.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree


def count(path):
    """(passed, names of failed) of one JUnit file."""
    passed, failed = 0, []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        if case.find("failure") is not None or case.find("error") is not None:
            failed.append(f"{case.get('classname')}.{case.get('name')}")
        elif case.get("status") != "notrun" and case.find("skipped") is None:
            passed += 1
    return passed, failed


def main():
    folder = pathlib.Path(sys.argv[1])
    passed, failed = 0, []
    results = {path: None for path in sorted(folder.glob("*.xml"))}
    programs = folder / "programs.txt"
    for line in programs.read_text().splitlines() if programs.is_file() else []:
        name, code, result = line.split(" ", 2)
        results[pathlib.Path(result)] = (name, int(code))
    for path, program in results.items():
        try:
            cases_passed, cases_failed = count(path)
        except (OSError, ElementTree.ParseError) as error:
            cases_passed, cases_failed = 0, [f"{program[0] if program else path.name}: no result ({error})"]
        if program and program[1] != 0 and not cases_failed:
            cases_failed.append(f"{program[0]}: exit code {program[1]}")
        if not cases_passed and not cases_failed:
            cases_failed.append(f"{program[0] if program else path.name}: ran no test")
        passed += cases_passed
        failed += cases_failed
    for name in failed:
        print("FAILED", name)
    print(f"{passed} passed, {len(failed)} failed")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
