#!/usr/bin/env python3
"""fjr and its peers on the same problems in one run: out/peers/results.json, a table in Markdown and a plot.

Every solve is a process of its own with one thread; the solvers take turns, and the least of the repetitions counts.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
import plot  # noqa: E402
import problems  # noqa: E402
import report  # noqa: E402
import trajectory  # noqa: E402
from arm import Arm  # noqa: E402
from files import ENVIRONMENT, ROOT, machine, read_rows  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
PEERS = {"casadi_ipopt": "CasADi, Ipopt/MUMPS", "casadi_fatrop": "CasADi, FATROP", "drake_collocation": "Drake, SNOPT",
         "crocoddyl_ddp": "Crocoddyl, FDDP"}


def worker(peer, problem, out, options, most_seconds):
    """What worker.py prints, or why it did not."""
    command = [sys.executable, HERE / "worker.py", peer, problem, "--out", out, *map(str, options)]
    try:
        done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=most_seconds)
    except subprocess.TimeoutExpired:
        return {"solved": False, "message": f"stopped after {most_seconds:g} s"}
    if done.returncode:
        last = (done.stderr.strip() or f"exit code {done.returncode}").splitlines()[-1]
        return {"solved": False, "message": last}
    return json.loads(done.stdout[done.stdout.index('{"'):])  # solvers print before it


def verify(fjr, path, count):
    """The rollout of a trajectory file on the exact arm: link errors in encoder counts, and what limits are exceeded by."""
    done = subprocess.run([fjr, "verify", path, "--json"], env=ENVIRONMENT, capture_output=True, text=True)
    try:
        certificate = json.loads(done.stdout)
        open_loop, closed_loop = certificate["open_loop"], certificate["closed_loop"]
    except (ValueError, KeyError):
        return {"failure": done.stderr.strip() or done.stdout.strip()}
    return {"miss": open_loop["max_link_error_rad"] / count, "completed": open_loop["completed"],
            "closed_loop_miss": closed_loop["max_link_error_rad"] / count, "verdict": certificate["verdict"],
            "over_limit": max(abs(limit["reached"]) / limit["limit"] - 1 for limit in certificate["limits"])}


def least(runs, keys):
    return {**runs[0], **{key: min(run[key] for run in runs) for key in keys}}


def run_peer(arguments, peer, problem, folder):
    """The mesh by a study, then the least times of the repetitions on it."""
    found = worker(peer, problem, folder, ["--study"], arguments.most_seconds * 6)
    if "intervals" not in found:
        return found
    runs = [worker(peer, problem, folder, ["--intervals", found["intervals"]], arguments.most_seconds)
            for _ in range(arguments.repetitions)]
    if not all(run["solved"] for run in runs):
        return {**next(run for run in runs if not run["solved"]), "study": found}
    result = {**least(runs, ("cpu", "wall", "build_cpu", "build_wall")), "study": found}
    for law in ("smoothed", "exact"):
        result[law].update(verify(arguments.fjr, folder / f"{law}.csv", arguments.count))
    return result


def run_fjr(arguments, problem, folder, options):
    """fjr plan on the request: CPU and wall time of the whole process."""
    runs = []
    for _ in range(arguments.repetitions):
        command = [arguments.fjr, "plan", problem.request, "--out", folder, "--json", *options]
        with tempfile.TemporaryFile() as output:
            begin = time.perf_counter()
            process = subprocess.Popen(command, env=ENVIRONMENT, stdout=output, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            wall = time.perf_counter() - begin
            process.returncode = os.waitstatus_to_exitcode(status)
            output.seek(0)
            plan = json.load(output)
        if plan["status"] != "certified":
            return {"solved": False, "message": f"{plan['status']}: {plan.get('reason')}"}
        runs.append({"cpu": usage.ru_utime + usage.ru_stime, "wall": wall})
    table = read_rows(folder / "trajectory.csv")
    exact = {"objective": trajectory.objective(arguments.arm, problem.weights, table),
             **verify(arguments.fjr, folder / "trajectory.csv", arguments.count)}
    return {**least(runs, ("cpu", "wall")), "solved": True, "message": plan["status"], "starts": plan["solver"]["starts"],
            "iterations": plan["solver"]["iterations"], "intervals": plan["mesh"]["intervals"],
            "reported": plan["objective"]["total"], "exact": exact}


def run_problem(arguments, name):
    problem = problems.read(name)
    folder = arguments.json.parent / name.replace(" ", "_")
    one_thread = ["--jobs", "1"] if "--jobs" in arguments.plan_help else []
    results = {"fjr": run_fjr(arguments, problem, folder / "fjr", one_thread)}
    tell(name, "fjr", results["fjr"])
    if results["fjr"].get("starts", 1) > 1:
        results["fjr, one start"] = run_fjr(arguments, problem, folder / "fjr_one_start", [*one_thread, "--starts", "1"])
        tell(name, "fjr, one start", results["fjr, one start"])
    for peer in arguments.peers:
        results[PEERS[peer]] = run_peer(arguments, peer, name, folder / peer)
        tell(name, PEERS[peer], results[PEERS[peer]])
    return {"request": str(problem.request.relative_to(ROOT)), "weights": problem.weights, "results": results}


def tell(problem, solver, result):
    if result.get("solved"):
        text = f"{result['cpu']:8.3f} s  {result['exact']['objective']:.5g}"
    else:
        text = result.get("cannot") or result["message"]
    print(f"{problem:18}{solver:22}{text}", flush=True)


def conditions(arguments):
    """Read after the run: what it was run on and with."""
    return {**machine(arguments.fjr), "load_before": arguments.load, "load_after": os.getloadavg(),
            "repetitions": arguments.repetitions}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fjr", type=pathlib.Path, default=ROOT / "build/fjr")
    parser.add_argument("--problems", nargs="+", choices=problems.REQUESTS, default=list(problems.REQUESTS))
    parser.add_argument("--peers", nargs="+", choices=PEERS, default=list(PEERS))
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--most-seconds", type=float, default=120, help="wall time of one solve; six times that of a study")
    parser.add_argument("--json", type=pathlib.Path, default=pathlib.Path("out/peers/results.json"))
    parser.add_argument("--redraw", action="store_true", help="table and plot from the JSON file of an earlier run")
    arguments = parser.parse_args()
    if not arguments.redraw:
        arguments.load, arguments.arm = os.getloadavg(), Arm(0)
        arguments.count = 2 * 3.141592653589793 / arguments.arm.p["encoder.link_counts"][0]
        arguments.fjr = arguments.fjr.resolve()
        arguments.plan_help = subprocess.run([arguments.fjr, "plan", "--help"], capture_output=True, text=True).stdout
        measured = {name: run_problem(arguments, name) for name in arguments.problems}
        arguments.json.parent.mkdir(parents=True, exist_ok=True)
        arguments.json.write_text(json.dumps({"conditions": conditions(arguments), "problems": measured}, indent=1) + "\n")
    results = json.loads(arguments.json.read_text())
    for suffix, text in ((".md", report.markdown(results)), (".svg", plot.svg(results))):
        path = arguments.json.with_suffix(suffix)
        path.write_text(text)
        print(path)


if __name__ == "__main__":
    main()
