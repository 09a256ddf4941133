"""PNG pictures of a recording, one a quantity. Needs python3-matplotlib (scripts/packages_plots.txt)."""
import warnings

import numpy as np

from .model import ENERGIES, InputError, MODES

MODE_COLORS = ["#8a8a8a", "#1a9e3f", "#e87800", "#1a59e0"]  # as in ~markers
MOST_SIDES = 8     # lines of normal forces; the others are one
BINS = 1000        # of time: more frames than twice that are drawn as least and largest value of each
LEAST = 1e-17      # what a logarithmic axis shows of zero
CARRIES = 1e-6     # of the median force: below it a contact carries nothing, its friction use means nothing


def pyplot():
    try:
        import matplotlib
    except ImportError:
        raise InputError("python3-matplotlib is missing: scripts/install_dependencies packages_plots.txt") from None
    matplotlib.use("Agg")
    warnings.filterwarnings("ignore", "Glyph")  # a name in a script that the font does not have: a box is drawn
    import matplotlib.pyplot
    return matplotlib.pyplot


def envelope(times, values):
    """(time, least, largest) of BINS stretches of equal duration, empty ones left out; values (n) may be NaN."""
    good = np.isfinite(values) & np.isfinite(times)
    times, values = times[good], values[good]
    if len(times) <= 2 * BINS:
        return times, values, values
    width = (times[-1] - times[0]) / BINS or 1.0
    place = np.minimum(((times - times[0]) / width).astype(int), BINS - 1)
    first = np.flatnonzero(np.diff(place, prepend=-1))  # times do not decrease
    return times[first], np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)


def as_label(name):
    """A name as matplotlib shows it: no formula, and not hidden where it begins with an underscore."""
    return (" " if name.startswith("_") else "") + name.replace("$", r"\$")


def line(axes, times, values, label, color=None):
    """A line; of many values the band between the least and the largest, with no value left out."""
    middle, low, high = envelope(np.asarray(times, float), np.asarray(values, float))
    if len(middle) < 2:
        return axes.plot(middle, high, "o", label=label, color=color)
    drawn, = axes.plot(middle, high, linewidth=0.9, label=label, color=color)
    if np.any(low != high):
        axes.plot(middle, low, linewidth=0.9, color=drawn.get_color())
        axes.fill_between(middle, low, high, color=drawn.get_color(), alpha=0.3, linewidth=0)
    return drawn


def finish(pictures, plt, figure, axes, title, unit, folder, name, legend=True):
    axes.set(title=title, xlabel="time [s]", ylabel=unit)
    axes.grid(True, linewidth=0.4, alpha=0.6)
    if legend:
        axes.legend(fontsize=8, loc="best")
    figure.tight_layout()
    path = folder / f"{name}.png"
    try:
        figure.savefig(path, dpi=110)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        plt.close(figure)
    pictures.append(path)


def normal_forces(recording):
    """[(name, (n) sum of r_N / dt on that link [N])], the largest means first; the ground's left out, of many the rest as one."""
    contacts, count = recording.contacts, len(recording.times)
    force = contacts.normal_force()
    sides = np.concatenate([contacts.side_a, contacts.side_b])
    frames, forces = np.tile(contacts.frame, 2), np.tile(force, 2)
    moving = [side for side in range(len(recording.sides)) if recording.sides[side][0] != "ground"]
    mean = np.bincount(sides, np.abs(forces), len(recording.sides))
    order = sorted((side for side in moving if mean[side] > 0.0 or np.any(sides == side)), key=lambda side: -mean[side])
    shown = order[:MOST_SIDES]
    result = [(recording.side_name(side), np.bincount(frames[sides == side], forces[sides == side], count)) for side in shown]
    rest = np.isin(sides, order[MOST_SIDES:])
    if rest.any():
        result.append((f"{len(order) - MOST_SIDES} others", np.bincount(frames[rest], forces[rest], count)))
    return result


def friction_use(recording):
    """(n) largest and mean |r_T| / (mu r_N) over the contacts of a frame that carry something; NaN without any."""
    contacts, count = recording.contacts, len(recording.times)
    normal, tangential = contacts.normal_force(), contacts.tangential_force()
    size = normal[normal > 0.0]
    carries = (normal > CARRIES * (np.median(size) if len(size) else 0.0)) & (contacts.friction > 0.0)
    frame, use = contacts.frame[carries], tangential[carries] / (contacts.friction[carries] * normal[carries])
    largest = np.full(count, np.nan)
    np.fmax.at(largest, frame, use)
    number = np.bincount(frame, minlength=count)
    mean = np.where(number > 0, np.bincount(frame, use, count) / np.maximum(number, 1), np.nan)
    return largest, mean


def draw_contacts(pictures, plt, recording, folder):
    contacts, times = recording.contacts, recording.times
    figure, axes = plt.subplots(figsize=(9, 4.5))
    for name, force in normal_forces(recording):
        line(axes, times, force, as_label(name))
    finish(pictures, plt, figure, axes, "normal contact forces", "sum of normal forces on the link [N]", folder, "normal_forces")
    figure, axes = plt.subplots(figsize=(9, 4.5))
    for number, name in enumerate(MODES):
        count = np.bincount(contacts.frame[contacts.mode == number], minlength=len(times))
        line(axes, times, count, name, MODE_COLORS[number])
    axes.set_ylim(bottom=0)
    finish(pictures, plt, figure, axes, "contacts by mode", "contacts [-]", folder, "modes")
    figure, axes = plt.subplots(figsize=(9, 4.5))
    largest, mean = friction_use(recording)
    line(axes, times, largest, "largest of all contacts", "tab:red")
    line(axes, times, mean, "mean", "tab:blue")
    axes.axhline(1.0, color="k", linewidth=0.8, linestyle=":", label="on the cone")
    axes.set_ylim(0.0, 1.1 if not np.any(largest > 1.1) else None)
    finish(pictures, plt, figure, axes, "friction use", r"$|r_T|/(\mu\, r_N)$ [-]", folder, "friction_use")


def draw_reports(pictures, plt, recording, folder):
    times, reports = recording.report_times, recording.reports
    figure, axes = plt.subplots(figsize=(9, 4.5))
    residual = np.asarray(reports["residual"], float)
    line(axes, times, np.where(np.isfinite(residual), np.maximum(residual, LEAST), np.nan), "residual E", "tab:blue")
    failed = np.flatnonzero(reports["status"] != 1)
    if len(failed):
        axes.plot(times[failed], np.where(np.isfinite(residual[failed]), np.maximum(residual[failed], LEAST), 1.0), "rx",
                  label=f"{len(failed)} steps without an answer")
    axes.set_yscale("log")
    finish(pictures, plt, figure, axes, "residual of each step", "E [-]", folder, "residual")
    figure, axes = plt.subplots(figsize=(9, 4.5))
    line(axes, times, reports["max_penetration"], "deepest", "tab:purple")
    finish(pictures, plt, figure, axes, "deepest penetration", "depth [m]", folder, "penetration", legend=False)
    figure, (ledger, balance) = plt.subplots(2, 1, figsize=(9, 6.5), height_ratios=[3, 1], sharex=True)
    for name in ENERGIES[:-1]:
        label = name if name in ("kinetic", "potential") else f"work of {name}" if name == "actuators" else f"dissipated by {name}"
        line(ledger, times, reports[name], label)
    ledger.set(title="energy ledger", ylabel="energy [J]")
    ledger.grid(True, linewidth=0.4, alpha=0.6)
    ledger.legend(fontsize=8)
    line(balance, times, reports["balance_error"], "balance error", "k")
    finish(pictures, plt, figure, balance, "", "balance error [J]", folder, "energy", legend=False)


def draw(recording, folder):
    """Pictures of what the recording has; their paths."""
    plt, pictures = pyplot(), []
    if len(recording.times) and len(recording.contacts.frame):
        draw_contacts(pictures, plt, recording, folder)
    if len(recording.report_times):
        draw_reports(pictures, plt, recording, folder)
    return pictures
