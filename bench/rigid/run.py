#!/usr/bin/env python3
"""Motions of planners for rigid arms and of fjr, on the elastic arm in closed loop: out/rigid/results.json, the table in
Markdown, plots and an animation as SVG.

All trajectories are rolled out by `fjr simulate`, which also says what came of them.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "peers"))
import importlib.metadata  # noqa: E402

import check  # noqa: E402
import draw  # noqa: E402
import planners  # noqa: E402
import report  # noqa: E402
from arm import RigidArm  # noqa: E402
from files import ENVIRONMENT, ROBOT, ROOT, machine, read_rows, write_rows  # noqa: E402
from motions import MOTIONS  # noqa: E402

RAMP = 0.02  # [s] in which Ruckig's motions build up their acceleration
SLOWER = 1.1  # step of the durations that are tried
SLOWEST = 40.0


def simulate(fjr, robot, path, **options):
    """What `fjr simulate` says, the arm held for ten seconds after the end. options: more of its own."""
    more = [part for name, value in options.items() for part in (f"--{name}", value)]
    command = [fjr, "simulate", path, "--robot", robot, "--json", "--hold", str(report.WATCHED), *more]
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True)
    if done.returncode:
        raise ValueError(done.stderr.strip() or done.stdout.strip())
    return json.loads(done.stdout)


def plan_fjr(fjr, robot, motion, folder):
    request = folder / "request.yaml"
    start, goal = list(motion.start), list(motion.goal)
    request.write_text(f"start: {{q: {start}}}\ngoal: {{q: {goal}}}\nobjective: fastest\n")
    done = subprocess.run([fjr, "plan", "-q", request, "--robot", robot, "--out", folder / "fjr", "--jobs", "1", "--json"],
                          env=ENVIRONMENT, capture_output=True, text=True)
    if done.returncode:
        raise ValueError(f"{motion.name}: fjr: {done.stderr.strip()} {json.loads(done.stdout).get('reason')}")
    return folder / "fjr/trajectory.csv"


def slowed_until_it_settles(fjr, robot, arm, motion, folder):
    """Ruckig's motion, slower by as little as leaves the links within one count from its end on; and how long it takes to
    leave them within ten."""
    factor, path, within_ten = 1.0, folder / "ruckig_slowed.csv", None
    while factor < SLOWEST:
        plan = planners.plan_ruckig(arm, motion, RAMP, factor)
        write_rows(path, plan.rows)
        found = simulate(fjr, robot, path)
        if within_ten is None and report.residual(found) <= 10:
            within_ten = found["duration"]
        if found["after_end"]["settling_time"] == 0:
            return path, {**plan.settings, "slowed": factor, "within_ten_counts": within_ten}
        factor *= SLOWER
    raise ValueError(f"not settled when slowed {SLOWEST:g} times")


def run_motion(arguments, motion):
    arm = RigidArm(arguments.robot)
    folder = arguments.out / motion.name.replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    fjr_rows = plan_fjr(arguments.fjr, arguments.robot, motion, folder)

    def written(name, plan):
        path = folder / f"{name}.csv"
        write_rows(path, plan.rows)
        return path, plan.settings

    made = {
        "ruckig": lambda: written("ruckig", planners.plan_ruckig(arm, motion, RAMP)),
        "toppra": lambda: written("toppra", planners.plan_toppra(arm, planners.Straight(*motion.ends))),
        "toppra_path": lambda: written("toppra_path", planners.plan_toppra(arm, planners.path_of(read_rows(fjr_rows)[:, 1:3]))),
        "ruckig_slowed": lambda: slowed_until_it_settles(arguments.fjr, arguments.robot, arm, motion, folder),
        "fjr": lambda: (fjr_rows, {}),
    }
    results = {}
    for name, make in made.items():
        try:
            path, settings = make()
            results[name] = {**simulate(arguments.fjr, arguments.robot, path, out=folder / f"{name}_run.csv"), **settings}
        except (ValueError, RuntimeError) as error:
            results[name] = {"cannot": str(error)}
    told = (f"{results[name].get('duration', float('nan')):.3f} s" for name in made)
    print(f"{motion.name:12}", *(f"{name} {duration}" for name, duration in zip(made, told)), flush=True)
    return {"start": motion.start, "goal": motion.goal, "results": results}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fjr", type=pathlib.Path, default=ROOT / "build/fjr")
    parser.add_argument("--robot", type=pathlib.Path, default=ROBOT, help="robot.yaml, without a payload")
    parser.add_argument("--motions", nargs="+", choices=[m.name for m in MOTIONS], default=[m.name for m in MOTIONS])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/rigid"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="motions at a time")
    parser.add_argument("--animate", default="up 1", help="motion of the animation")
    parser.add_argument("--redraw", action="store_true", help="table, plots and animation from the files of an earlier run")
    arguments = parser.parse_args()
    results_file = arguments.out / "results.json"
    if not arguments.redraw:
        arguments.fjr = arguments.fjr.resolve()
        arguments.out.mkdir(parents=True, exist_ok=True)
        check.rigid_arm_is_the_limit_of_the_elastic_one(
            lambda path, robot: simulate(arguments.fjr, robot, path), arguments.out)
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            chosen = [m for m in MOTIONS if m.name in arguments.motions]
            found = list(pool.map(lambda m: run_motion(arguments, m), chosen))
        versions = {name: importlib.metadata.version(name) for name in ("ruckig", "toppra")}
        results = {"conditions": {**machine(arguments.fjr), **versions, "ramp": RAMP, "robot": str(arguments.robot)},
                   "motions": {m.name: result for m, result in zip(chosen, found)}}
        results_file.write_text(json.dumps(results, indent=1) + "\n")
    results = json.loads(results_file.read_text())
    files = {"results.md": report.markdown(results), "rigid.svg": draw.plots(results)}
    if arguments.animate in results["motions"]:
        files["rigid_motion.svg"] = draw.animation(results, arguments.animate, arguments.out)
    for name, text in files.items():
        (arguments.out / name).write_text(text)
        print(arguments.out / name)


if __name__ == "__main__":
    main()
