"""The results of run.py as tables in Markdown."""
from files import number

HEAD = ("problem", "solver", "intervals", "iterations", "CPU s (building)", "wall s", "objective", "miss",
        "objective, exact law", "miss, exact law", "beyond limits")


def row(problem, name, result):
    if not result.get("solved"):
        reason = result.get("cannot") or f"failed: {result['message']}"
        return [problem, name, reason] + [""] * (len(HEAD) - 3)
    smoothed, exact = result.get("smoothed"), result["exact"]
    build = f" ({result['build_cpu']:.2f})" if "build_cpu" in result else ""
    unconverged = "" if result.get("study", {}).get("converged", True) else ", not converged"
    return [problem, name, f"{result['intervals']}{unconverged}", str(result["iterations"]), f"{result['cpu']:.2f}{build}",
            f"{result['wall']:.2f}", number(smoothed["objective"], 5) if smoothed else "", miss(smoothed) if smoothed else "",
            number(exact["objective"], 5), miss(exact), f"{number(100 * max(0, exact.get('over_limit', 0)), 2)} %"]


def miss(law):
    if "failure" in law:
        return f"not rolled out: {law['failure']}"
    return ("" if law["completed"] else "more than ") + number(law["miss"], 2)


def markdown(results):
    lines = ["| " + " | ".join(HEAD) + " |", "|---" * len(HEAD) + "|"]
    for name, problem in results["problems"].items():
        for i, entry in enumerate(problem["results"].items()):
            lines.append("| " + " | ".join(row(f"**{name}**" if i == 0 else "", *entry)) + " |")
    lines.append("")
    versions = sorted({result["versions"] for problem in results["problems"].values()
                       for result in problem["results"].values() if "versions" in result})
    conditions = results["conditions"]
    lines += [f"fjr: {conditions['fjr']}. Peers: {'; '.join(versions)}; Python {conditions['python']}.",
              f"{conditions['processor']}, {conditions['cores']} cores; load {conditions['load_before'][0]:.1f} before and "
              f"{conditions['load_after'][0]:.1f} after the run; the least of {conditions['repetitions']} runs.", ""]
    return "\n".join(lines)
