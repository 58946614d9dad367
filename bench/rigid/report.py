"""The results of run.py as tables in Markdown: one line a planner, and one for every motion and planner."""
import statistics

from files import number

PLANNERS = {"ruckig": "Ruckig", "toppra": "TOPP-RA, straight", "toppra_path": "TOPP-RA, on fjr's path",
            "ruckig_slowed": "Ruckig, slowed", "fjr": "fjr"}
WATCHED = 10  # [s] after the end
HEAD = ("motion", "planner", "duration s", "within one count after s", "furthest off afterwards, counts", "spring %", "torque %",
        "velocity %", "effort N²m²s")


def reached(result, name):
    """Largest fraction of a limit, of both joints."""
    return max(limit["reached"] / limit["limit"] for limit in result["limits"] if limit["name"] == name)


def residual(result):
    """In counts of the link encoder."""
    after = result["after_end"]
    return max(after["residual_rad"]) / after["settled_rad"]


def settled(result):
    """[s] from the start; None: not while it was watched."""
    settling = result["after_end"]["settling_time"]
    return None if settling is None else result["duration"] + settling


def percent(fraction):
    """Bold beyond the limit, by more than the feedback of an exact plan explains."""
    text = f"{100 * fraction:.0f}"
    return f"**{text}**" if fraction > 1.01 else text


def counts(value):
    return number(value, 2) if value < 10 else f"{value:.0f}"


def row(motion, planner, result):
    if "cannot" in result:
        return [motion, planner, result["cannot"]] + [""] * (len(HEAD) - 3)
    until = settled(result)
    return [motion, planner, f"{result['duration']:.3f}", f"{until:.3f}" if until is not None else f"not in {WATCHED}",
            counts(residual(result)), *(percent(reached(result, name)) for name in ("spring_deflection", "torque", "motor_velocity")),
            f"{result['effort']:.1f}"]


def medians(results):
    """A line for each planner, over the motions that it planned."""
    lines = ["| planner | motions | duration, times fjr's | settled within 10 s | the time that takes, times fjr's | furthest off "
             "afterwards, counts | beyond a spring limit | beyond a torque limit | effort, times fjr's |", "|---" * 9 + "|"]
    motions = [motion["results"] for motion in results["motions"].values()]
    for key, name in PLANNERS.items():
        pairs = [(r[key], r["fjr"]) for r in motions if "cannot" not in r[key] and "cannot" not in r["fjr"]]
        if not pairs:
            continue
        times = [settled(own) / settled(fjr) for own, fjr in pairs if settled(own) and settled(fjr)]

        def beyond(limit):
            return sum(reached(own, limit) > 1.01 for own, _ in pairs)

        def median_ratio(value):
            return f"{statistics.median(value(own) / value(fjr) for own, fjr in pairs):.2f}"

        lines.append("| " + " | ".join((
            name, str(len(pairs)), median_ratio(lambda r: r["duration"]), str(len(times)),
            f"{statistics.median(times):.2f}" if times else "", counts(statistics.median(residual(own) for own, _ in pairs)),
            str(beyond("spring_deflection")), str(beyond("torque")), median_ratio(lambda r: r["effort"]))) + " |")
    return lines


def ten_counts(results):
    """How much longer than fjr's Ruckig's motions take that leave the links within ten counts."""
    pairs = [(m["results"]["ruckig_slowed"], m["results"]["fjr"]) for m in results["motions"].values()]
    ratios = [slowed["within_ten_counts"] / fjr["duration"] for slowed, fjr in pairs if "within_ten_counts" in slowed]
    return [f"Slowed until the links stay within ten counts: {statistics.median(ratios):.2f} times fjr's duration."] if ratios else []


def markdown(results):
    lines = ["Medians over the motions:", "", *medians(results), "", *ten_counts(results), "", "| " + " | ".join(HEAD) + " |", "|---" * len(HEAD) + "|"]
    for name, motion in results["motions"].items():
        for i, (key, planner) in enumerate(PLANNERS.items()):
            lines.append("| " + " | ".join(row(f"**{name}**" if i == 0 else "", planner, motion["results"][key])) + " |")
    c = results["conditions"]
    lines += ["", f"fjr {c['fjr']}, Ruckig {c['ruckig']}, TOPP-RA {c['toppra']}.", ""]
    return "\n".join(lines)
