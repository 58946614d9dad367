"""One peer, one problem, one process: `python worker.py PEER PROBLEM (--intervals N | --study) --out DIR` prints JSON.

Times are this process's and its children's (compilers), so a fresh process is a cold start and one thread is one thread.
"""
import argparse
import importlib
import json
import pathlib
import resource
import sys
import time

import check
import files
import problems
import trajectory
from arm import Arm

SMOOTHING = 0.05        # width of the peers' friction [rad/s]
SIZES = (25, 50, 100)   # intervals
CONVERGED = 0.01        # twice the intervals change the objective by less


def cpu():
    usages = [resource.getrusage(whose) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def timed(function, *arguments):
    begin = cpu(), time.perf_counter()
    result = function(*arguments)
    return result, cpu() - begin[0], time.perf_counter() - begin[1]


def objective(arm, problem, solution):
    return trajectory.objective(arm, problem.weights, trajectory.rows(arm, solution, exact=False))


def study(peer, problem, arm):
    """The coarsest mesh whose objective stays within 1 % when it is solved on, with twice the intervals, from its solution:
    from the guess again it might be another minimum, whose difference would tell nothing of the mesh."""
    tried, solved = [], None
    for intervals in SIZES:
        solution = peer.solve(*peer.build(problem, arm, intervals, problem.minimum_jerk(arm)))
        entry = {"intervals": intervals, "solved": bool(solution.solved), "message": solution.message}
        tried.append(entry)
        if not solution.solved:
            continue
        solved = intervals
        finer = peer.solve(*peer.build(problem, arm, 2 * intervals, solution.guess()))
        entry["objective"], entry["finer_solved"] = objective(arm, problem, solution), bool(finer.solved)
        if not finer.solved:
            entry["finer_message"] = finer.message
            continue
        entry["finer_objective"] = objective(arm, problem, finer)
        if abs(entry["finer_objective"] / entry["objective"] - 1) < CONVERGED:
            return {"intervals": intervals, "converged": True, "tried": tried}
    return {"intervals": solved or SIZES[1], "converged": False, "tried": tried}


def measure(peer, problem, arm, intervals, out):
    def build():
        return peer.build(problem, arm, intervals, problem.minimum_jerk(arm))

    built, build_cpu, build_wall = timed(build)
    solution, solve_cpu, solve_wall = timed(peer.solve, *built)
    result = {"solved": bool(solution.solved), "message": solution.message, "iterations": int(solution.iterations),
              "intervals": len(solution.times) - 1, "build_cpu": build_cpu, "build_wall": build_wall,
              "cpu": solve_cpu, "wall": solve_wall}
    if solution.solved:
        for law in ("smoothed", "exact"):
            table = trajectory.rows(arm, solution, law == "exact")
            files.write_rows(out / f"{law}.csv", table)
            result[law] = {"objective": trajectory.objective(arm, problem.weights, table)}
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("peer")
    parser.add_argument("problem", choices=problems.REQUESTS)
    parser.add_argument("--intervals", type=int)
    parser.add_argument("--study", action="store_true")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    arm = Arm(SMOOTHING)
    check.require_equal(arm)
    peer, problem = importlib.import_module(arguments.peer), problems.read(arguments.problem)
    reason = peer.cannot(problem)
    if reason:
        result = {"cannot": reason}
    elif arguments.study:
        result = study(peer, problem, arm)
    else:
        result = measure(peer, problem, arm, arguments.intervals, arguments.out)
    json.dump({**result, "versions": peer.versions()}, sys.stdout)


if __name__ == "__main__":
    main()
