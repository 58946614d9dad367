#!/usr/bin/env python3
"""Measures the planner: `suite.py all` everything, `suite.py run` motions alone, `suite.py compare A.json B.json`,
`suite.py counts` what the examples take in iterations and factorisations, `suite.py proofs` what proofs take beside
certificates."""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # of report.py, which lies beside this file
import report  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODES = ("cold", "warm", "mumps")
LAYERS = ("dynamics_bench", "derivatives_bench", "kkt_bench", "iteration_bench", "certificate_bench")
PARTS = ("evaluation", "linear_algebra", "ipopt", "certificate")
CHANGE = 0.10  # compare flags what changed by more
GROWTH = 0.20  # and fails where iterations or factorisations grew by more
COUNTS = ("iterations", "factorisations")
COUNTS_FILE = ROOT / "bench/counts.json"
ROUNDINGS = 5  # robots that differ by rounding errors
ENVIRONMENT = dict(os.environ, OPENBLAS_NUM_THREADS="1")


def random_requests(folder, seed, count):
    """Writes rest-to-rest requests with joint angles drawn uniformly within +-2 rad, free duration. All are feasible:
    moved slowly enough along the straight line, the arm needs the torque and the deflection that gravity asks for, at
    most 6.7 of 12 and 0.53 of 5 N m, and both are within the limits everywhere (README.md)."""
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


def is_fastest(request):
    """Whether the objective is time alone, by preset or default."""
    text = re.sub(r"#.*", "", request.read_text())
    objective = re.search(r"^objective:\s*(\w*)", text, flags=re.MULTILINE)
    fixed = re.search(r"^duration:\s*[\d.]", text, flags=re.MULTILINE)
    return objective[1] == "fastest" if objective else not fixed


def plan(fjr, request, out, options):
    """Runs fjr once; CPU time [s] and peak memory [MiB] are of this process alone, from wait4."""
    command = [fjr, "plan", str(request), "--out", str(out), "--json", "--jobs", "1", *options]
    with tempfile.TemporaryFile() as stdout, tempfile.TemporaryFile() as stderr:
        process = subprocess.Popen(command, stdout=stdout, stderr=stderr, env=ENVIRONMENT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        stdout.seek(0)
        stderr.seek(0)
        text, errors = stdout.read(), stderr.read().decode(errors="replace")
    try:
        result = json.loads(text)
        solver = result["solver"]
    except (ValueError, KeyError):
        sys.exit(f"{request}: fjr exited with {process.returncode} and without a plan: {errors.strip()}")
    return {
        "status": result["status"],
        "iterations": solver["iterations"],
        "factorisations": solver["factorisations"],
        "starts": max(solver["starts"], 1),
        "intervals": result["mesh"]["intervals"],
        "cpu": usage.ru_utime + usage.ru_stime,
        "memory": usage.ru_maxrss / 1024,
        "timing": result["timing"],
    }


def summary(runs):
    cpu = [run["cpu"] for run in runs]
    parts = {part for run in runs for part in run["timing"]}
    middle = {key: statistics.median(run[key] for run in runs)
              for key in ("iterations", "factorisations", "starts", "intervals", "cpu")}
    timing = {part: statistics.median(run["timing"].get(part, 0.0) for run in runs) for part in sorted(parts)}
    return {
        "certified": sum(run["status"] == "certified" for run in runs),
        "runs": len(runs),
        **middle,
        "cpu_min": min(cpu),
        "cpu_max": max(cpu),
        "memory": max(run["memory"] for run in runs),
        "timing": timing,
        "shares": shares(timing),
    }


def shares(timing):
    """Of the plan's CPU time; the certificate's is what wall time says of it."""
    return {**{part: timing.get(part, 0.0) / timing["cpu"] for part in PARTS[:3]},
            "certificate": timing.get("certificate", 0.0) / timing["total"]}


def measure_motion(arguments, request, folder):
    """Every mode, `repetitions` times; what is not run says why under "skipped"."""
    cold = folder / "out" / request.stem
    options = {"cold": [], "warm": ["--warm", str(cold)], "mumps": ["--linear-solver", "mumps"]}
    near = neighbour(request, folder)
    runs = {mode: [] for mode in arguments.modes}
    skipped = {}
    for _ in range(arguments.repetitions):  # modes take turns: a busy spell of the machine meets them all
        for mode in arguments.modes:
            if mode == "warm" and not near:
                skipped[mode] = "no single goal angle found in the request"
            elif mode == "warm" and not (cold / "solution.cbor").exists():
                skipped[mode] = "no cold solution to start from"
            else:
                out = cold if mode == "cold" else folder / f"{mode}_{request.stem}"
                runs[mode].append(plan(arguments.fjr, near if mode == "warm" else request, out, options[mode]))
    motion = {mode: summary(some) for mode, some in runs.items() if some}
    if skipped:
        motion["skipped"] = skipped
    motion["fastest"] = is_fastest(request)
    return motion


def print_motion(name, motion):
    for mode in MODES:
        if mode in motion:
            s = motion[mode]
            shares = "".join(f"{100 * s['shares'][part]:>6.0f}" for part in PARTS)
            print(f"{name:20}{mode:6}{s['certified']:>3}/{s['runs']}{s['iterations']:>6g}{s['factorisations'] or '-':>6}"
                  f"{s['intervals']:>5g}{s['cpu']:>8.3f}{s['cpu_min']:>8.3f}{s['cpu_max']:>8.3f}"
                  f"{s['timing']['cpu']:>8.3f}{s['memory']:>5.0f}{shares}", flush=True)
    for mode, reason in motion.get("skipped", {}).items():
        print(f"{name:20}{mode:6}  skipped: {reason}", flush=True)


def print_medians(motions):
    def line(what, values, unit, wanted=""):
        if values:
            print(f"{what:52}{statistics.median(values):>8.3f} {unit:3} median of {len(values)}{wanted}")
    cold = [m for m in motions.values() if "cold" in m]
    line("fastest, cold", [m["cold"]["timing"]["cpu"] for m in cold if m["fastest"]], "s", ", wanted 0.100")
    line("others, cold, per start",
         [m["cold"]["timing"]["cpu"] / m["cold"]["starts"] for m in cold if not m["fastest"]], "s", ", wanted 0.150")
    line("warm", [m["warm"]["timing"]["cpu"] for m in motions.values() if "warm" in m], "s", ", wanted 0.010")
    both = [m for m in cold if "mumps" in m]
    line("MUMPS / chain, whole plan", [m["mumps"]["timing"]["cpu"] / m["cold"]["timing"]["cpu"] for m in both], "")
    line("MUMPS / chain, optimisation per iteration",
         [optimisation(m["mumps"]) / optimisation(m["cold"]) for m in both], "", ", wanted 5")
    line("MUMPS / chain, linear algebra per iteration",
         [m["mumps"]["timing"]["linear_algebra"] / m["mumps"]["iterations"] * m["cold"]["iterations"]
          / m["cold"]["timing"]["linear_algebra"] for m in both], "", ", wanted 10")


def optimisation(s):
    return sum(s["timing"][part] for part in ("evaluation", "linear_algebra", "ipopt")) / max(s["iterations"], 1)


def measure_motions(arguments):
    motions = {}
    print(f"{'motion':20}{'mode':6}{'ok':>5}{'iter':>6}{'fact':>6}{'N':>5}{'CPU s':>8}{'min':>8}{'max':>8}{'plan s':>8}"
          f"{'MiB':>5}{'eval%':>6}{'lin%':>6}{'Ipopt':>6}{'cert%':>6}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        requests = arguments.requests or sorted((ROOT / "config/requests").glob("*.yaml"))
        for request in [*requests, *random_requests(folder, arguments.seed, arguments.random)]:
            motions[request.stem] = measure_motion(arguments, request, folder)
            print_motion(request.stem, motions[request.stem])
    print_medians(motions)
    return motions


def uncertified(motions):
    """Motions and modes of which not every run was certified; MUMPS is only there to be compared with."""
    return [f"{name} {mode}" for name, motion in motions.items() for mode in ("cold", "warm")
            if mode in motion and motion[mode]["certified"] < motion[mode]["runs"]]


def run(arguments):
    motions = measure_motions(arguments)
    write(arguments.json, {"seed": arguments.seed, "motions": motions})
    return finish(motions)


def finish(motions):
    bad = uncertified(motions)
    if bad:
        print(f"not certified: {', '.join(bad)}")
    return 1 if bad or not motions else 0


def write(path, results):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(results, indent=1) + "\n")


def program_json(command, out):
    """What a program of bench/ writes with --json; its table goes to our stdout."""
    subprocess.run([*map(str, command), "--json", str(out)], check=True, env=ENVIRONMENT)
    return json.loads(out.read_text())


def layer(program, min_time, benchmarks):
    """Median and spread of the benchmarks of a Google Benchmark program whose names match."""
    text = subprocess.run(
        [str(program), "--benchmark_format=json", "--benchmark_repetitions=3", f"--benchmark_min_time={min_time}",
         f"--benchmark_filter={benchmarks}"],
        check=True, stdout=subprocess.PIPE, env=ENVIRONMENT).stdout
    to_seconds = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    results = {}
    for entry in json.loads(text)["benchmarks"]:
        if entry.get("error_occurred"):
            sys.exit(f"{program.name}: {entry['name']}: {entry['error_message']}")
        if entry["run_type"] == "iteration":
            # A benchmark with a time of its own reports that as real time.
            which = "real_time" if "manual_time" in entry["name"] else "cpu_time"
            results.setdefault(entry["run_name"], []).append(entry[which] * to_seconds[entry["time_unit"]])
    for name, times in results.items():
        print(f"{program.name + ' ' + name:60}{1e6 * statistics.median(times):>12.3f} us"
              f"{1e6 * min(times):>12.3f}{1e6 * max(times):>12.3f}", flush=True)
    return {name: {"median": statistics.median(times), "min": min(times), "max": max(times)}
            for name, times in results.items()}


def everything(arguments):
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    programs = pathlib.Path(arguments.fjr).resolve().parent / "bench"
    print(f"{'layers':60}{'median':>15}{'min':>12}{'max':>12}")
    layers = {name: layer(programs / name, arguments.min_time, arguments.benchmarks) for name in LAYERS}
    print("\npublished problems")
    sizes = ["--intervals", *arguments.intervals]
    published = program_json([programs / "published_bench", *sizes], out / "published.json")
    print("\ntime per iteration by mesh size")
    named = [ROOT / "config/requests" / f"{name}.yaml" for name in arguments.mesh_requests]
    mesh = program_json([programs / "mesh_bench", *named, *sizes, "--repetitions", arguments.repetitions],
                        out / "mesh.json")
    print("\nmotions")
    motions = measure_motions(arguments)
    results = {"seed": arguments.seed, "layers": layers, "published": published, "mesh": mesh, "motions": motions}
    write(out / "results.json", results)
    (out / "report.html").write_text(report.page(results))
    print(f"{out / 'results.json'}, {out / 'report.html'}")
    return finish(motions)


def figures(results):
    """Everything that can be compared, by name: times [s]."""
    named = {}
    for name, motion in results.get("motions", {}).items():
        for mode in MODES:
            if mode in motion:
                named[f"{name} {mode}"] = motion[mode]["cpu"]
    for program, benchmarks in results.get("layers", {}).items():
        for name, times in benchmarks.items():
            named[f"{program} {name}"] = times["median"]
    for line in results.get("mesh", []):
        named[f"iteration of {line['request']} N={line['intervals']} {line['linear_solver']}"] = line["per_iteration"]
    for line in results.get("published", []):
        named[f"{line['problem']} N={line['intervals']}"] = line["seconds"]
    return named


def compare(arguments):
    before, after = (json.loads(path.read_text()) for path in (arguments.before, arguments.after))
    a, b = figures(before), figures(after)
    lost = set(uncertified(after.get("motions", {}))) - set(uncertified(before.get("motions", {})))
    print(f"{'':60}{'before s':>12}{'after s':>12}{'ratio':>7}")
    for name in a:
        if name in b:
            ratio = b[name] / a[name]
            flag = "" if abs(ratio - 1) <= CHANGE else "  slower" if ratio > 1 else "  faster"
            print(f"{name:60}{a[name]:>12.4g}{b[name]:>12.4g}{ratio:>7.2f}{flag}{'  LOST' if name in lost else ''}")
    for name in sorted(a.keys() ^ b.keys()):
        print(f"{name}: only in one of the files")
    cold = [{name: m["cold"] for name, m in results.get("motions", {}).items() if "cold" in m}
            for results in (before, after)]
    return 1 if lost or grown(*cold) else 0


def differently_rounded(folder, k):
    """A copy of config/ whose robot's springs are stiffer by k 1e-11 of their stiffness: what another machine's roundings
    may do to a search, without another motion."""
    copy = folder / f"config_{k}"
    shutil.copytree(ROOT / "config", copy)
    robot = copy / "robot.yaml"
    text, count = re.subn(r"(stiffness: \{value: \[)([-+.\deE]+)",
                          lambda m: f"{m[1]}{float(m[2]) * (1 + 1e-11 * k):.17g}", robot.read_text())
    if count != 1:
        sys.exit(f"{robot}: found {count} lists named stiffness where one was expected")
    robot.write_text(text)
    return copy


def record_counts(arguments):
    """The largest counts of every example over robots that differ by rounding errors."""
    most = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for k in range(ROUNDINGS):
            ENVIRONMENT["FJR_CONFIG_DIR"] = str(differently_rounded(folder, k))
            for request in sorted((ROOT / "config/requests").glob("*.yaml")):
                copied = folder / f"config_{k}" / "requests" / request.name
                run = plan(arguments.fjr, copied, folder / "out" / request.stem, [])
                before = most.get(request.stem, {})
                most[request.stem] = {count: max(run[count], before.get(count, 0)) for count in COUNTS}
            print(f"{k + 1} of {ROUNDINGS} roundings", flush=True)
    write(COUNTS_FILE, most)
    return 0


def check_counts(arguments):
    """Whether plans, a folder each, took at most GROWTH more than the recorded counts."""
    if arguments.record:
        return record_counts(arguments)
    recorded = json.loads(COUNTS_FILE.read_text())
    counts = {path.parent.name: json.loads(path.read_text())["solver"]
              for path in sorted(arguments.plans.glob("*/plan.json"))}
    worse = grown({name: recorded[name] for name in counts if name in recorded}, counts)
    missing = sorted(recorded.keys() - counts.keys())
    for name in missing:
        print(f"{name}: no plan.json of it in {arguments.plans}")
    print(f"{len(counts) - len(worse)} of {len(recorded)} examples within {GROWTH:.0%} of their recorded counts")
    return 1 if worse or missing else 0


def grown(before, after):
    """The motions whose iterations or factorisations grew by more than GROWTH, after saying so."""
    names = []
    for name in before:
        for count in COUNTS:
            a, b = before[name].get(count) or 0, after.get(name, {}).get(count) or 0
            if a > 0 and b > (1 + GROWTH) * a:
                print(f"{name}: {count} grew from {a:g} to {b:g}, by {b / a - 1:.0%}; at most {GROWTH:.0%} is allowed")
                names.append(name)
    return sorted(set(names))


def verified(fjr, *words):
    """Runs `fjr verify` with these words; its exit code, and its CPU time [s] on all threads."""
    process = subprocess.Popen([fjr, "verify", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env=ENVIRONMENT)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_utime + usage.ru_stime


def measure_proofs(arguments):
    """CPU time of the proofs of plans, a folder each, beside that of their certificates; less that of starting up, which
    is as long as a short certificate: all three take turns, so a busy spell of the machine meets them all."""
    print(f"{'':20}{'certificate s':>14}{'proof s':>9}{'ratio':>7}")
    unproven = []
    for path in sorted(arguments.plans.glob("*/trajectory.csv")):
        words = ([os.devnull], [str(path.parent)], ["--proven", str(path.parent)])
        runs = [[verified(arguments.fjr, *w) for w in words] for _ in range(arguments.repetitions)]
        nothing, alone, both = (min(run[i][1] for run in runs) for i in range(len(words)))
        certificate, proof = alone - nothing, both - alone
        proven = all(run[-1][0] == 0 for run in runs)
        print(f"{path.parent.name:20}{certificate:14.3f}{proof:9.3f}{proof / certificate:7.1f}"
              f"{'' if proven else '  not proven'}", flush=True)
        if not proven:
            unproven.append(path.parent.name)
    return 1 if unproven else 0


def add_motion_options(parser):
    parser.add_argument("requests", nargs="*", type=pathlib.Path, help="motions; default: all of config/requests")
    parser.add_argument("--fjr", default=str(ROOT / "build/fjr"))
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--random", type=int, default=5, help="number of random requests")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--modes", nargs="+", choices=MODES, default=MODES)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(required=True)
    a = commands.add_parser("all", help="layers, published problems, mesh sizes and motions; JSON and a page of plots")
    a.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/bench"))
    a.add_argument("--min-time", type=float, default=0.2, help="of every benchmark of a layer [s]")
    a.add_argument("--benchmarks", default=".", metavar="REGEX", help="those of a layer whose names match")
    a.add_argument("--mesh-requests", nargs="+", default=["reach", "swing", "gentle_horizontal"],
                   help="names in config/requests, for the time per iteration by mesh size")
    a.add_argument("--intervals", nargs="+", type=int, default=[25, 50, 100, 200, 400, 800], help="mesh sizes")
    add_motion_options(a)
    a.set_defaults(do=everything)
    b = commands.add_parser("run", help="plan motions and measure")
    b.add_argument("--json", type=pathlib.Path, default=pathlib.Path("out/suite.json"))
    add_motion_options(b)
    b.set_defaults(do=run)
    d = commands.add_parser("counts", help="iterations and factorisations of the examples against those recorded in "
                            "bench/counts.json; exit code 1 where they grew by more than a fifth")
    d.add_argument("--plans", type=pathlib.Path, default=pathlib.Path("out/requests"), help="folder of their plans")
    d.add_argument("--record", action="store_true", help="plan the examples and record what they take")
    d.add_argument("--fjr", default=str(ROOT / "build/fjr"))
    d.set_defaults(do=check_counts)
    e = commands.add_parser("proofs", help="time of the proofs of plans beside that of their certificates; exit code 1 "
                            "where one is not proven")
    e.add_argument("--plans", type=pathlib.Path, default=pathlib.Path("out/requests"), help="folder of the plans")
    e.add_argument("--fjr", default=str(ROOT / "build/fjr"))
    e.add_argument("--repetitions", type=int, default=5)
    e.set_defaults(do=measure_proofs)
    c = commands.add_parser("compare", help="times of two results; exit code 1 if a motion is no longer certified, or "
                            "takes a fifth more iterations or factorisations")
    c.add_argument("before", type=pathlib.Path)
    c.add_argument("after", type=pathlib.Path)
    c.set_defaults(do=compare)
    arguments = parser.parse_args()
    try:
        sys.exit(arguments.do(arguments))
    except subprocess.CalledProcessError as error:
        sys.exit(f"{error.cmd[0]} exited with {error.returncode}")
    except OSError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
