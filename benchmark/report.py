#!/usr/bin/python3
"""Writes docs/solvers.md from the CSV files of scripts/benchmark_solvers and a template with {{NAME}} in it.

A stage that was not run leaves a line saying so in place of its tables.
"""
import argparse
import csv
import math
import os
import re
import statistics

REFERENCE = "portfolio"
CLASSES = ["2D", "full rank, 1 to 10 contacts", "full rank, more contacts", "hyperstatic (rows > rank W), 1 to 30 contacts",
           "hyperstatic, more contacts", "with bilaterals", "random small", "random large"]


def read(results, stage):
    path = os.path.join(results, stage + ".csv")
    if not os.path.exists(path):
        return []
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["stage"] = stage
    return rows


def duration(seconds):
    for unit, factor in (("us", 1e6), ("ms", 1e3)):
        if seconds * factor < 999.5:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds:.3g} s"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def solved(row):
    return row["status"] == "solved"


def class_of(row):
    if row["stage"].startswith("random_"):
        return " ".join(row["stage"].split("_")[:2])
    if int(row["bilaterals"]) > 0:
        return "with bilaterals"
    if row["dimension"] == "2":
        return "2D"
    contacts = int(row["contacts"])
    if int(row["rows"]) > int(row["rank"]) > 0:
        return CLASSES[3] if contacts <= 30 else CLASSES[4]
    return CLASSES[1] if contacts <= 10 else CLASSES[2]


def group(rows, target):
    """{problem: rows} of one target, in the order of the file."""
    problems = {}
    for row in rows:
        if row["target"] == target:
            problems.setdefault(row["problem"], []).append(row)
    return problems


def targets_of(rows):
    return list(dict.fromkeys(row["target"] for row in rows))


def ratio_table(rows, target):
    lines, ratios, only_ours, only_theirs = [], [], 0, 0
    for problem, outcomes in group(rows, target).items():
        ours = next((row for row in outcomes if row["solver"] == REFERENCE and solved(row)), None)
        theirs = min((row for row in outcomes if row["ours"] == "0" and solved(row)),
                     key=lambda row: float(row["seconds"]), default=None)
        ratio = "-"
        if ours and theirs:
            ratios.append(float(theirs["seconds"]) / float(ours["seconds"]))
            ratio = f"{ratios[-1]:.2f}"
        only_ours += bool(ours and not theirs)
        only_theirs += bool(theirs and not ours)
        first = outcomes[0]
        lines.append([problem, class_of(first), first["contacts"], f"{first['rows']}/{first['rank'] if int(first['rank']) > 0 else '-'}",
                      duration(float(ours["seconds"])) if ours else "unsolved",
                      duration(float(theirs["seconds"])) if theirs else "none in time",
                      f"{theirs['solver'].replace('siconos ', '')}, {theirs['variant']}" if theirs else "-", ratio])
    text = table(["problem", "class", "contacts", "rows/rank W", REFERENCE, "best Siconos", "which, storage", "ratio"],
                 lines)
    if ratios:
        mean = math.exp(statistics.fmean(math.log(ratio) for ratio in ratios))
        text += (f"\n\n**Geometric mean {mean:.2f}, least {min(ratios):.2f}, largest {max(ratios):.2f}** over "
                 f"{len(ratios)} problems that both solve; "
                 f"below 1.0 on {sum(ratio < 1.0 for ratio in ratios)}. Solved by `{REFERENCE}` only: {only_ours}; by "
                 f"Siconos only: {only_theirs}.")
    return text


def ratios(rows):
    if not rows:
        return "Not measured yet."
    return "\n\n".join(f"### Target {target}\n\n{ratio_table(rows, target)}" for target in targets_of(rows))


def class_table(rows, target):
    cells, totals = {}, {}
    for row in rows:
        if row["target"] != target:
            continue
        kind = class_of(row)
        totals.setdefault(kind, set()).add(row["problem"])
        solver = row["solver"].replace("siconos 2D", "siconos")
        cells.setdefault(solver, {}).setdefault(kind, []).append(row)
    if not cells:
        return "Not measured yet."
    kinds = [kind for kind in CLASSES if kind in totals]
    lines = []
    for solver, by_kind in cells.items():
        line = [f"`{solver}`" if not solver.startswith("siconos") else solver]
        for kind in kinds:
            outcomes = by_kind.get(kind, [])
            times = [float(row["seconds"]) for row in outcomes if solved(row)]
            tried = len({row["problem"] for row in outcomes})
            line.append("-" if not tried else f"{len(times)}/{tried}" +
                        (f", {duration(statistics.median(times))}" if times else ""))
        lines.append(line)
    return table(["solver"] + [f"{kind} ({len(totals[kind])})" for kind in kinds], lines)


def thesis_table(rows, target):
    problems = group(rows, target)
    if not problems:
        return "Not measured yet."
    problems = dict(sorted(problems.items(), key=lambda item: (int(item[1][0]["contacts"]), item[0])))
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    measure = "thesis" if target.startswith("thesis") else "residual"
    lines = []
    for solver in solvers:
        line, count = [f"`{solver}`" if not solver.startswith("siconos") else solver], 0
        for outcomes in problems.values():
            row = next(row for row in outcomes if row["solver"] == solver)
            count += solved(row)
            if solved(row):
                line.append(f"{float(row['seconds']) * 1e3:.3g}")
            elif float(row[measure]) > 0.0:
                line.append(f"({float(row[measure]):.0e})")
            else:
                line.append(f"({row['status']})")
        lines.append(line + [f"**{count}/{len(problems)}**"])
    header = ["method"] + [problem.replace("alea-", "") for problem in problems] + ["solved"]
    return table(header, lines)


def thesis_tables(rows):
    if not rows:
        return "Not measured yet."
    names = {"thesis 1e-06": "Criterion (5.1) below 1e-6, rho = 1", "1e-08": "Residual E at most 1e-8"}
    return "\n\n".join(f"{names.get(target, target)}; times in ms, in brackets what was reached instead:\n\n"
                       f"{thesis_table(rows, target)}" for target in targets_of(rows))


def exponent(points):
    """Slope of log y over log x, least squares."""
    logs = [(math.log(x), math.log(y)) for x, y in points if y > 0.0]
    if len(logs) < 3:
        return None
    mean_x, mean_y = (statistics.fmean(value) for value in zip(*logs))
    return "%.2f" % (sum((x - mean_x) * (y - mean_y) for x, y in logs) / sum((x - mean_x) ** 2 for x, _ in logs))


def gauss_seidel(results):
    """What Siconos's Gauss-Seidel leaves unsolved with more time, every storage tried (scenes_gauss_seidel)."""
    rows, limit = read(results, "scenes_gauss_seidel"), stage_facts(results, "scenes_gauss_seidel").get("limit")
    if not rows or not limit:
        return "Not measured yet."
    lost, late = [], []
    for problem, outcomes in group(rows, "1e-08").items():
        ours, theirs = (next(row for row in outcomes if row["solver"] == name) for name in (REFERENCE, "siconos NSGS"))
        entry = f"{problem} ({ours['contacts']} contacts; `{REFERENCE}` "
        entry += duration(float(ours["seconds"])) if solved(ours) else "unsolved"
        if solved(theirs):
            late.append(f"{entry}, NSGS {duration(float(theirs['seconds']))})")
        elif theirs["status"] == "not reached":
            lost.append(f"{entry}, NSGS ends at E = {float(theirs['residual']):.1e})")
        else:
            lost.append(f"{entry}, NSGS out of time)" if theirs["status"] == "time limit" else f"{entry}, NSGS crashed)")
    text = f"On those of up to 300 contacts it was given {limit} s for each of its four variants. "
    if lost:
        text += f"E <= 1e-8 is still not reached on {len(lost)} of {len(rows) // 2}: {', '.join(lost)}. "
    if late:
        text += f"Solved then: {', '.join(late)}."
    return text


def profile_times(rows, target):
    """{problem: {solver: seconds}} of what was solved, names of ours, of theirs, that were tried on all problems.

    3D problems only: a solver is not to be blamed for problems it is not made for. Where a solver was measured twice
    the first row counts.
    """
    times, ours, theirs, tried = {}, [], [], {}
    for row in rows:
        solver = row["solver"]
        if row["target"] != target or row["dimension"] != "3" or solver.startswith("thesis"):
            continue
        names = ours if row["ours"] == "1" else theirs
        if solver not in names:
            names.append(solver)
        seconds = times.setdefault(row["problem"], {})
        if row["problem"] in tried.setdefault(solver, set()):
            continue
        tried[solver].add(row["problem"])
        if solved(row):
            seconds[solver] = float(row["seconds"])
    everywhere = [[name for name in names if len(tried[name]) == len(times)] for names in (ours, theirs)]
    for seconds in times.values():
        for solver in set(seconds) - set(everywhere[0] + everywhere[1]):
            del seconds[solver]
    return times, *everywhere


def profile_ends(rows, target):
    """({method: (quickest of all, within twice the quickest, solved)}, number of problems somebody solved)."""
    times, ours, theirs = profile_times(rows, target)
    ends = {}
    for solver in ours + theirs:
        ratios = [own[solver] / min(own.values()) for own in times.values() if solver in own]
        name = f"`{solver}`" if solver in ours else solver
        ends[name] = (sum(ratio <= 1.0 for ratio in ratios), sum(ratio <= 2.0 for ratio in ratios), len(ratios))
    return ends, sum(bool(own) for own in times.values())


def profile_table(rows):
    """The ends of the curves: all of Siconos's, and the five of ours that are most often within twice the quickest."""
    if not rows:
        return "Not measured yet."
    ends = {target: profile_ends(rows, target) for target in ("0.0001", "1e-08")}
    tight = ends["1e-08"][0]
    order = sorted(tight, key=lambda name: (-tight[name][1], -tight[name][2], name))
    ours = [name for name in order if name.startswith("`")][:5]
    lines = [[name] + [" / ".join(map(str, own[name])) if name in own else "-" for own, _ in ends.values()]
             for name in ours + [name for name in order if not name.startswith("`")]]
    return table(["quickest of all / within twice the quickest / solved"] +
                 [f"E <= {float(target):.0e} ({count} problems)" for target, (_, count) in ends.items()], lines)


def unsolved_by(rows, solver, target):
    """Names of the problems of which `solver` solved none."""
    names = [row["problem"] for row in rows if row["solver"] == solver and row["target"] == target and not solved(row)]
    return f"{len(names)} of {len(group(rows, target))}" + (f": {', '.join(names)}" if names else "")


def least_samples(tables, seconds):
    """Least number of samples behind a compared time below so many seconds, ours and the best of theirs."""
    counts = []
    for rows in tables:
        for target in targets_of(rows):
            for outcomes in group(rows, target).values():
                theirs = min((row for row in outcomes if row["ours"] == "0" and solved(row)),
                             key=lambda row: float(row["seconds"]), default=None)
                ours = [row for row in outcomes if row["solver"] == REFERENCE and solved(row)]
                counts += [int(row["samples"]) for row in ours + ([theirs] if theirs else [])
                           if float(row["seconds"]) < seconds]
    return str(min(counts)) if counts else "?"


def scaling(rows):
    if not rows:
        return "Not measured yet."
    lines, notes = [], []
    for solver in dict.fromkeys(row["solver"] for row in rows):
        own = [row for row in rows if row["solver"] == solver]
        for row in own:
            line = [f"`{solver}`", row["contacts"], row["velocities"], row["status"]]
            if 0.0 < float(row["seconds"]) < 1e9:
                line += [row["iterations"], f"{float(row['residual']):.1e}", duration(float(row["reduction_seconds"])),
                         duration(float(row["seconds"])), f"{float(row['megabytes']):.3g}"]
            else:  # the process was ended from outside
                line += ["-"] * 5
            lines.append(line)
        good = [row for row in own if row["status"] == "CONVERGED" and int(row["contacts"]) >= 100]
        times = exponent([(float(row["contacts"]), float(row["seconds"])) for row in good])
        memory = exponent([(float(row["contacts"]), float(row["megabytes"])) for row in good])
        reduction = exponent([(float(row["contacts"]), float(row["reduction_seconds"])) for row in own
                              if int(row["contacts"]) >= 100 and 0.0 < float(row["reduction_seconds"]) < 1e9])
        grows = [f"{name} grows as n^{value}" for name, value in
                 (("time", times), ("the reduction alone", reduction), ("memory", memory)) if value is not None]
        notes.append(f"`{solver}`: " + (", ".join(grows) or "fewer than three sizes converged, no exponent")
                     + " (least squares in logarithms, converged runs from 100 contacts on).")
    return table(["method", "contacts", "velocities", "status", "iterations", "E", "reduction", "whole solve",
                  "memory [MB]"], lines) + "\n\n" + "\n".join(f"* {note}" for note in notes)


def stage_facts(results, stage):
    path = os.path.join(results, stage + ".stage")
    if not os.path.exists(path):
        return {}
    with open(path) as file:
        return dict(zip(("name", "full", "limit", "seconds", "date", "cores"), file.read().strip().split(",")))


def runs(results):
    lines = []
    for stage in ("fclib", "families", "scenes", "random_small", "random_large", "conditions", "scaling"):
        facts = stage_facts(results, stage)
        if facts:
            lines.append([facts["name"], facts["date"], facts["cores"], f"{facts['limit']} s", facts["full"],
                          f"{facts['seconds']} s"])
    return table(["stage", "date", "cores", "time limit of a solve", "--full", "took"], lines)


def condition_table(tables, target):
    """{condition: rows} as one table: solved of tried, a line a method."""
    tables = {condition: rows for condition, rows in tables.items() if rows}
    if not tables:
        return "Not measured yet."
    counts = {}
    for condition, rows in tables.items():
        for row in rows:
            if row["target"] == target and row["ours"] == "1":
                counts.setdefault(row["solver"], {}).setdefault(condition, []).append(solved(row))
    lines = [[f"`{solver}`"] + [f"{sum(by.get(c, []))}/{len(by.get(c, []))}" for c in tables]
             for solver, by in counts.items()]
    return table(["method"] + [f"condition {condition}" for condition in tables], lines)


def count_lines(rows, target):
    """One line a method: how many it solves."""
    counts = {}
    for row in rows:
        if row["target"] == target:
            counts.setdefault(row["solver"], []).append(solved(row))
    return ", ".join(f"{solver} {sum(values)}/{len(values)}" for solver, values in counts.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--results", default="docs/results")
    parser.add_argument("--template", default="benchmark/solvers_template.md")
    parser.add_argument("--output", default="docs/solvers.md")
    arguments = parser.parse_args()
    fclib, families = read(arguments.results, "fclib"), read(arguments.results, "families")
    small, large = read(arguments.results, "random_small"), read(arguments.results, "random_large")
    large_siconos = read(arguments.results, "random_large_siconos")
    large_all = large + [row for row in large_siconos if row["ours"] == "0"]
    bilaterals = read(arguments.results, "scenes_bilaterals")
    scenes = read(arguments.results, "scenes") + bilaterals
    values = {
        "RUNS": runs(arguments.results),
        "RATIOS": ratios(fclib),
        "RATIOS_FAMILIES": ratios(families),
        "RATIOS_SCENES": ratios(scenes),
        "NSGS_SCENES": unsolved_by(scenes, "siconos NSGS", "1e-08"),
        "NSGS_LONG": gauss_seidel(arguments.results),
        "PROFILE_ENDS": profile_table(fclib),
        "PROFILE_ENDS_LARGE": profile_table(large_all),
        "PROFILE_ENDS_SCENES": profile_table(scenes),
        "RATIOS_SMALL": ratio_table(small, "1e-08") if small else "Not measured yet.",
        "RATIOS_LARGE": ratio_table(large_siconos, "1e-08") if large_siconos else "Not measured yet.",
        "SAMPLES": least_samples([fclib, families, scenes, small, large_siconos], 0.05),
        "CLASSES": class_table(fclib + bilaterals + small + large_all, "1e-08"),
        "CLASSES_LOOSE": class_table(fclib, "0.0001"),
        "TABLE_5_7": thesis_tables([row for row in small if row["ours"] == "1"]),
        "TABLE_5_9": thesis_tables([row for row in large if row["ours"] == "1" and row["target"] != "0.0001"]),
        "CONDITIONS": condition_table({"10": small, "1e3": read(arguments.results, "conditions_1e3"),
                                       "1e6": read(arguments.results, "conditions_1e6")}, "thesis 1e-06"),
        "COUNTS_5_7": count_lines(small, "thesis 1e-06"),
        "COUNTS_5_9": count_lines(large, "thesis 1e-06"),
        "SCALING": scaling(read(arguments.results, "scaling")),
    }
    with open(arguments.template) as file:
        text = file.read()
    text = re.sub(r"\{\{(\w+)\}\}", lambda match: values[match.group(1)], text)
    with open(arguments.output, "w") as file:
        file.write(text)


if __name__ == "__main__":
    main()
