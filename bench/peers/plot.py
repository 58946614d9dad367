"""The results of run.py as a plot: CPU time and miss of every solver on every problem, both on logarithmic scales."""
import math

COLOURS = {"fjr": "#1f77b4", "fjr, one start": "#6baed6", "CasADi, Ipopt/MUMPS": "#d62728", "CasADi, FATROP": "#ff7f0e",
           "Drake, SNOPT": "#2ca02c", "Crocoddyl, FDDP": "#9467bd"}
LABELS, PANEL, GAP, LINE, TOP = 250, 250, 30, 17, 46  # px


class Axis:
    """Powers of ten around the values, from `left` px on."""

    def __init__(self, values, left):
        self.low = math.floor(math.log10(min(values)))
        self.high = math.ceil(math.log10(max(values)))
        self.left = left

    def __call__(self, value):
        return self.left + PANEL * (math.log10(value) - self.low) / (self.high - self.low)

    def ticks(self):
        return [10.0**power for power in range(self.low, self.high + 1)]


def svg(results):
    rows = [(problem if i == 0 else None, *pair)  # the problem's name beside its first solver
            for problem, entry in results["problems"].items() for i, pair in enumerate(entry["results"].items())]
    solved = [result for *_, result in rows if result.get("solved")]

    def misses(result):
        return [result[law]["miss"] for law in ("smoothed", "exact") if "miss" in result.get(law, {})]

    time = Axis([result["cpu"] for result in solved], LABELS)
    miss = Axis([1, *(value for result in solved for value in misses(result))], LABELS + PANEL + GAP)
    bottom = TOP + LINE * len(rows) + 10 * len(results["problems"])
    height, width = bottom + 28, LABELS + 2 * PANEL + GAP + 20
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
           f'<rect width="{width}" height="{height}" fill="white"/>']

    def text(x, y, words, anchor="start", weight="normal", colour="black"):
        out.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-weight="{weight}" fill="{colour}">'
                   f'{words}</text>')

    def circle(x, y, colour, fill):
        out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{fill}" stroke="{colour}"/>')

    def line(x1, y1, x2, y2, colour, wide=1):
        out.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" stroke-width="{wide}"/>')

    for axis, title in ((time, "CPU time [s]"), (miss, "miss on the exact arm [encoder counts]")):
        text(axis.left + PANEL / 2, 14, title, "middle", "bold")
        for tick in axis.ticks():
            text(axis(tick), 32, f"{tick:g}", "middle")
            line(axis(tick), TOP - 8, axis(tick), bottom, "#ddd")
    line(miss(1), TOP - 8, miss(1), bottom, "#888", 2)

    y = TOP - 6
    for problem, solver, result in rows:
        if problem:
            y += 10
            text(6, y + 12, problem, weight="bold")
        y += LINE
        colour = COLOURS[solver]
        text(LABELS - 10, y - 5, solver, "end")
        if not result.get("solved"):
            text(LABELS + 6, y - 5, result.get("cannot", "failed"), colour="#888")
            continue
        line(time(time.ticks()[0]), y - 9, time(result["cpu"]), y - 9, colour, 2)
        circle(time(result["cpu"]), y - 9, colour, colour)
        for law, fill in (("smoothed", "white"), ("exact", colour)):
            if "miss" in result.get(law, {}):
                circle(miss(result[law]["miss"]), y - 9, colour, fill)
    for x, fill, words in ((LABELS, "white", "torque as solved, friction smoothed"),
                           (LABELS + 225, "black", "with the exact law of friction")):
        circle(x, height - 14, "black", fill)
        text(x + 8, height - 10, words)
    text(LABELS + 420, height - 10, "thick line: one count")
    return "\n".join([*out, "</svg>", ""])
