#!/usr/bin/python3
"""Performance profiles (Dolan, More 2002) of comparisons: plot_profiles.py --results FOLDER --images FOLDER

rho_s(tau) = share of the problems that solver s solves within tau times the time of the quickest solver of all. One
picture a family of problems and target, 1e-4 and 1e-8 of the residual E, judged by the independent validator. Left:
our methods, where more than the portfolio was tried; right: Siconos's; our portfolio in both.
"""
import argparse
import math
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from report import profile_times, read  # noqa: E402

LARGEST_RATIO = 100.0
# Name of the pictures, title, CSV files. Several files are one family, be it other problems or other solvers (the first
# file counts where a solver is in both); a solver not tried on all problems is left out.
FAMILIES = [("profile", "FCLib, 3D", ["fclib"]),
            ("profile_large", "Large random problems of the thesis", ["random_large", "random_large_siconos"]),
            ("profile_scenes", "Scenes of the simulator", ["scenes", "scenes_bilaterals"])]


def profile(times, solver):
    """Steps (tau, share) of one solver."""
    ratios = sorted(solved[solver] / min(solved.values()) for solved in times.values() if solver in solved)
    steps = [(1.0, 0.0)]
    for count, ratio in enumerate(ratios, start=1):
        steps += [(ratio, steps[-1][1]), (ratio, count / len(times))]
    return steps + [(max(LARGEST_RATIO, steps[-1][0]), steps[-1][1])]


def plot(times, ours, theirs, title, path):
    sides = [("this package", ours)] if len(ours) > 1 else []
    sides.append(("Siconos 4.4.0 and our portfolio", ["portfolio"] + theirs))
    figure, panels = plt.subplots(1, len(sides), figsize=(6.5 * len(sides), 6.5), sharey=True, squeeze=False)
    for panel, (side, names) in zip(panels[0], sides):
        colours = plt.get_cmap("tab20").colors
        for number, name in enumerate(names):
            steps = profile(times, name)
            first = name == "portfolio"
            panel.plot([tau for tau, _ in steps], [share for _, share in steps], label=name.replace("siconos ", ""),
                       color="black" if first else colours[number % 20], linewidth=2.5 if first else 1.4,
                       linestyle="-" if first or number % 2 else "--")
        panel.set_xscale("log")
        panel.set_xlim(1.0, LARGEST_RATIO)
        panel.set_ylim(0.0, 1.02)
        panel.set_xlabel("time / time of the quickest solver")
        panel.set_title(side)
        panel.grid(alpha=0.3, which="both")
        panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=4)
    panels[0][0].set_ylabel(f"share of {len(times)} problems solved")
    figure.suptitle(title)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--results", default="docs/results", help="folder of the CSV files of compare_siconos")
    parser.add_argument("--images", default="docs/images", help="folder of the pictures")
    arguments = parser.parse_args()
    os.makedirs(arguments.images, exist_ok=True)
    for name, family, files in FAMILIES:
        parts = [read(arguments.results, file) for file in files]
        if not all(parts):
            continue
        for target in ("0.0001", "1e-08"):
            times, ours, theirs = profile_times(sum(parts, []), target)
            # A problem nobody solved has no quickest solver and says nothing of the order.
            solvable = {problem: solved for problem, solved in times.items() if solved}
            if solvable:
                plot(solvable, ours, theirs, f"{family}: E <= {float(target):g}, cold starts, CPU time",
                     os.path.join(arguments.images, f"{name}_1e{round(math.log10(float(target)))}.png"))


if __name__ == "__main__":
    main()
