#!/usr/bin/env python3
"""Plans named and seeded random motions with fjr and measures: `suite.py run`, `suite.py compare A.json B.json`."""
import argparse
import json
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODES = ("cold", "warm", "mumps")
CHANGE = 0.10  # compare flags what changed by more


def random_requests(folder, seed, count):
    """Writes rest-to-rest requests with joint angles drawn uniformly within +-2 rad, free duration."""
    draw = random.Random(seed)
    paths = []
    for i in range(count):
        start, goal = ([round(draw.uniform(-2, 2), 3) for _ in range(2)] for _ in range(2))
        path = folder / f"random_{seed}_{i}.yaml"
        path.write_text(f"start: {{q: {start}}}\ngoal: {{q: {goal}}}\n")
        paths.append(path)
    return paths


def neighbour(request, folder):
    """The request with the first goal angle 0.01 rad nearer to zero, so that it stays allowed; None if not found."""
    moved, count = re.subn(
        r"(^goal:\s*\{?\s*q:\s*\[\s*)([-+.\deE]+)",
        lambda m: f"{m[1]}{float(m[2]) + (-0.01 if float(m[2]) > 0 else 0.01):.6g}",
        request.read_text(), flags=re.MULTILINE)
    path = folder / f"neighbour_{request.stem}.yaml"
    path.write_text(moved)
    return path if count == 1 else None


def plan(fjr, request, out, options):
    """Runs fjr once; CPU time [s] and peak memory [MiB] are of this process alone, from wait4."""
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1")
    command = [fjr, "plan", str(request), "--out", str(out), "--json", *options]
    with tempfile.TemporaryFile() as stdout, tempfile.TemporaryFile() as stderr:
        process = subprocess.Popen(command, stdout=stdout, stderr=stderr, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        stdout.seek(0)
        stderr.seek(0)
        text, errors = stdout.read(), stderr.read().decode(errors="replace")
    try:
        result = json.loads(text)
    except ValueError:
        sys.exit(f"{request}: fjr exited with {process.returncode} and without a plan: {errors.strip()}")
    return {
        "status": result["status"],
        "iterations": result["solver"]["iterations"],
        "intervals": result["mesh"]["intervals"],
        "cpu": usage.ru_utime + usage.ru_stime,
        "memory": usage.ru_maxrss / 1024,
        "timing": result["timing"],
    }


def summary(runs):
    cpu = [run["cpu"] for run in runs]
    parts = {part for run in runs for part in run["timing"]}
    return {
        "certified": sum(run["status"] == "certified" for run in runs),
        "runs": len(runs),
        "iterations": statistics.median(run["iterations"] for run in runs),
        "intervals": statistics.median(run["intervals"] for run in runs),
        "cpu": statistics.median(cpu),
        "cpu_min": min(cpu),
        "cpu_max": max(cpu),
        "memory": max(run["memory"] for run in runs),
        "timing": {part: statistics.median(run["timing"].get(part, 0.0) for run in runs) for part in sorted(parts)},
    }


def run(arguments):
    results = {}
    print(f"{'motion':24}{'mode':7}{'ok':>5}{'iter':>6}{'N':>5}{'CPU s':>9}{'min':>9}{'max':>9}{'MiB':>6}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        requests = arguments.requests or sorted((ROOT / "config/requests").glob("*.yaml"))
        requests = [*requests, *random_requests(folder, arguments.seed, arguments.random)]
        for request in requests:
            cold = folder / "out" / request.stem
            options = {"cold": [], "warm": ["--warm", str(cold)], "mumps": ["--linear-solver", "mumps"]}
            near = neighbour(request, folder)
            runs = {mode: [] for mode in arguments.modes}
            for i in range(arguments.repetitions):  # modes take turns: a busy spell of the machine meets them all
                for mode in arguments.modes:
                    if mode == "warm" and not (near and (cold / "solution.cbor").exists()):
                        continue
                    out = cold if mode == "cold" else folder / f"{mode}_{request.stem}"
                    runs[mode].append(plan(arguments.fjr, near if mode == "warm" else request, out, options[mode]))
            results[request.stem] = {mode: summary(some) for mode, some in runs.items() if some}
            for mode, s in results[request.stem].items():
                print(f"{request.stem:24}{mode:7}{s['certified']:>3}/{s['runs']}{s['iterations']:>6g}{s['intervals']:>5g}"
                      f"{s['cpu']:>9.3f}{s['cpu_min']:>9.3f}{s['cpu_max']:>9.3f}{s['memory']:>6.0f}", flush=True)
    for mode in arguments.modes:
        some = [motion[mode]["cpu"] for motion in results.values() if mode in motion]
        if some:
            print(f"{mode}: median {statistics.median(some):.3f} s over {len(some)} motions")
    arguments.json.parent.mkdir(parents=True, exist_ok=True)
    arguments.json.write_text(json.dumps({"seed": arguments.seed, "motions": results}, indent=1) + "\n")


def compare(arguments):
    before, after = (json.loads(path.read_text())["motions"] for path in (arguments.before, arguments.after))
    for motion in sorted(before.keys() & after.keys()):
        for mode in MODES:
            if mode in before[motion] and mode in after[motion]:
                a, b = before[motion][mode], after[motion][mode]
                ratio = b["cpu"] / a["cpu"]
                flag = "" if abs(ratio - 1) <= CHANGE else "  slower" if ratio > 1 else "  faster"
                lost = "  LOST" if b["certified"] / b["runs"] < a["certified"] / a["runs"] else ""
                print(f"{motion:24}{mode:7}{a['cpu']:>9.3f}{b['cpu']:>9.3f}{ratio:>7.2f}{flag}{lost}")
    for motion in sorted(before.keys() ^ after.keys()):
        print(f"{motion}: only in one of the files")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(required=True)
    a = commands.add_parser("run", help="plan and measure")
    a.add_argument("requests", nargs="*", type=pathlib.Path, help="request files; default: all of config/requests")
    a.add_argument("--fjr", default=str(ROOT / "build/fjr"))
    a.add_argument("--json", type=pathlib.Path, default=pathlib.Path("out/suite.json"))
    a.add_argument("--repetitions", type=int, default=3)
    a.add_argument("--random", type=int, default=5, help="number of random requests")
    a.add_argument("--seed", type=int, default=1)
    a.add_argument("--modes", nargs="+", choices=MODES, default=MODES)
    a.set_defaults(do=run)
    b = commands.add_parser("compare", help="CPU time of two results, motion by motion")
    b.add_argument("before", type=pathlib.Path)
    b.add_argument("after", type=pathlib.Path)
    b.set_defaults(do=compare)
    arguments = parser.parse_args()
    arguments.do(arguments)


if __name__ == "__main__":
    main()
