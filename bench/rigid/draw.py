"""The results of run.py as plots, and one motion as an animation: SVG that needs nothing but itself."""
import io
import re

import matplotlib
import numpy as np

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

from arm import RigidArm  # noqa: E402
from files import read_rows  # noqa: E402
from report import PLANNERS, WATCHED, reached, residual, settled  # noqa: E402

COLOURS = {"ruckig": "#d62728", "toppra": "#ff7f0e", "toppra_path": "#9467bd", "ruckig_slowed": "#8c8c8c", "fjr": "#1f77b4"}
plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "fjr", "font.family": "sans-serif", "font.size": 9})


def plots(results):
    """Of every motion and planner: duration and settling, what is left after the end, what springs and motors came to."""
    names = list(results["motions"])
    figure, axes = plt.subplots(1, 4, figsize=(12, 0.3 * len(names) + 1.3), sharey=True, layout="constrained")
    not_settled = 25.0
    for offset, (key, label) in zip(np.linspace(-0.28, 0.28, len(PLANNERS)), PLANNERS.items()):
        found = [results["motions"][name]["results"][key] for name in names]
        known = [(row + offset, result) for row, result in enumerate(found) if "cannot" not in result]
        rows, runs = [row for row, _ in known], [result for _, result in known]
        until = [settled(run) or not_settled for run in runs]
        axes[0].hlines(rows, [run["duration"] for run in runs], until, color=COLOURS[key], lw=1)
        for marker, chosen in (("|", lambda time: time < not_settled), (">", lambda time: time == not_settled)):
            ends = [(time, row) for time, row in zip(until, rows) if chosen(time)]
            axes[0].plot(*zip(*ends) if ends else ([], []), marker, color=COLOURS[key], ms=5)
        columns = ([run["duration"] for run in runs], [residual(run) for run in runs],
                   *([100 * reached(run, name) for run in runs] for name in ("spring_deflection", "torque")))
        for axis, values in zip(axes, columns):
            axis.plot(values, rows, "o", color=COLOURS[key], ms=3.5, label=label)
    titles = (f"time to the end (dot) and until the links stay\nwithin one count (bar; >: not in {WATCHED} s) [s]",
              "furthest off the goal after the end\n[counts of the link encoder]",
              "largest spring deflection, also after the end\n[% of the limit]",
              "largest motor torque, also after the end\n[% of the limit]")
    for axis, title, limit in zip(axes, titles, (None, 1, 100, 100)):
        axis.set_title(title, fontsize=9)
        axis.grid(axis="x", color="#ddd")
        axis.set_axisbelow(True)
        if limit:
            axis.axvline(limit, color="#555", lw=1)
    for axis in axes[:2]:
        axis.set_xscale("log")
    axes[0].set_yticks(range(len(names)), names)
    axes[0].invert_yaxis()
    figure.legend(*axes[1].get_legend_handles_labels(), loc="outside lower center", ncols=len(PLANNERS), frameon=False)
    return as_svg(figure)


def as_svg(figure):
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return re.sub(r"(\d\.\d)\d+", r"\1", text.getvalue())  # a tenth of a point is enough


# ---- the animation ----

SHOWN = ("ruckig", "toppra", "fjr")
PANEL, TOP, SCALE = 230, 48, 150   # px, px, px/m
FRAME, AFTER, SLOWED = 0.02, 1.2, 4  # [s] between frames, [s] shown after the last end, times slower than it is
STRIP = 120                        # px of the plot below


def animation(results, motion, folder):
    """The arm under three planners side by side, slower than it is; below, how far the links are from the goal."""
    found = results["motions"][motion]["results"]
    runs = {key: read_rows(folder / motion.replace(" ", "_") / f"{key}_run.csv") for key in SHOWN}
    end = max(found[key]["duration"] for key in SHOWN) + AFTER
    times = np.arange(0, end, FRAME)
    width, height = PANEL * len(SHOWN), TOP + 300 + STRIP + 40
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    whole = f'dur="{SLOWED * end:.2f}s" repeatCount="indefinite"'

    def text(x, y, words, anchor="middle", colour="black", more=""):
        out.append(f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" fill="{colour}"{more}>{words}</text>')

    goal = results["motions"][motion]["goal"]
    for panel, key in enumerate(SHOWN):
        x0, y0 = PANEL * (panel + 0.5), TOP + 130
        text(x0, 18, PLANNERS[key], colour=COLOURS[key], more=' font-weight="bold"')
        until = settled(found[key])
        text(x0, 34, f"{found[key]['duration']:.2f} s; " + (f"at rest after {until:.2f} s" if until else f"not at rest in {WATCHED} s"))
        out.append(f'<polyline points="{places(np.array([goal]), x0, y0)[0]}" fill="none" stroke="#bbb" stroke-width="9" '
                   'stroke-linecap="round" stroke-linejoin="round"/>')
        frames = places(at(runs[key], times), x0, y0)
        out.append(f'<polyline points="{frames[0]}" fill="none" stroke="{COLOURS[key]}" stroke-width="4" stroke-linecap="round" '
                   f'stroke-linejoin="round"><animate attributeName="points" {whole} values="{";".join(frames)}"/></polyline>')
        out.append(f'<circle cx="{x0:.0f}" cy="{y0:.0f}" r="4" fill="#333"/>')
    strip(out, text, runs, found, np.array(goal), end, width, TOP + 300, whole)
    return "\n".join([*out, "</svg>", ""])


def at(rows, times):
    """Links' angles (n, 2) at times; the last ones after the end."""
    return np.stack([np.interp(times, rows[:, 0], rows[:, column]) for column in (1, 2)], 1)


def places(q, x0, y0):
    """Of shoulder, elbow and tip, as SVG has the points of a polyline."""
    l1, l2 = RigidArm().p["link.length"] * SCALE
    first, both = q[:, 0], q[:, 0] + q[:, 1]
    ex, ey = x0 + l1 * np.sin(first), y0 + l1 * np.cos(first)
    tx, ty = ex + l2 * np.sin(both), ey + l2 * np.cos(both)
    return [f"{x0:.0f},{y0:.0f} {a:.1f},{b:.1f} {c:.1f},{d:.1f}" for a, b, c, d in zip(ex, ey, tx, ty)]


def strip(out, text, runs, found, goal, end, width, top, whole):
    """The links' distance from the goal over time, on a logarithmic scale, with a line that moves with the arms."""
    left, right, low, high = 60, width - 12, -5, 1
    count = found["fjr"]["after_end"]["settled_rad"]

    def x(time):
        return left + (right - left) * time / end

    def y(distance):
        return top + 24 + STRIP * (high - np.log10(np.maximum(distance, 10.0**low))) / (high - low)

    text(width / 2, top + 12, f"links' distance from the goal [rad]; {SLOWED} times slower than it is")
    for power in range(low, high + 1, 2):
        out.append(f'<path d="M{left} {y(10.0**power):.1f}H{right}" stroke="#ddd"/>')
        text(left - 6, y(10.0**power) + 4, f"1e{power}", "end")
    out.append(f'<path d="M{left} {y(count):.1f}H{right}" stroke="#555" stroke-dasharray="4 3"/>')
    text(right, y(count) - 4, "one count", "end", "#555")
    for key, rows in runs.items():
        shown = rows[rows[:, 0] <= end][::4]
        distance = np.abs(shown[:, 1:3] - goal).max(axis=1)
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x(shown[:, 0]), y(distance)))
        out.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[key]}"/>')
    for second in np.arange(0, end, 0.5):
        text(x(second), top + STRIP + 38, f"{second:g} s")
    out.append(f'<path d="M{left} {top + 24}v{STRIP}" stroke="#333"><animateTransform attributeName="transform" type="translate" '
               f'values="0 0;{right - left} 0" {whole}/></path>')
