#!/usr/bin/env python3
"""What a program plans, to compare with what another one plans: moves and renamings must not change a byte.

  bench/reference.py record build/fjr OUT [--requests FOLDER]   every example, and every request in FOLDER
  bench/reference.py compare BEFORE AFTER                       exit 1 where a trajectory or a plan.json differs

Kept are trajectory.csv and plan.json without times. Requests for FOLDER: build/bench/random_requests --out FOLDER.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIMES = {"timing", "cpu", "evaluation", "linear_algebra", "ipopt", "version", "seconds"}


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items() if key not in TIMES}
    if isinstance(value, list):
        return [without_times(item) for item in value]
    return value


def plan(program, request, out):
    folder = out / request.stem
    subprocess.run([program, "plan", request, "--out", folder], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for path in folder.iterdir():
        if path.name == "plan.json":
            path.write_text(json.dumps(without_times(json.loads(path.read_text())), indent=1, sort_keys=True))
        elif path.name != "trajectory.csv":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    return request.stem


def record(arguments):
    requests = sorted((ROOT / "config/requests").glob("*.yaml"))
    if arguments.requests:
        requests += sorted(arguments.requests.glob("*.yaml"))
    arguments.out.mkdir(parents=True)
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for done, name in enumerate(pool.map(lambda r: plan(arguments.program, r, arguments.out), requests), 1):
            if sys.stderr.isatty():
                print(f"\r{done} of {len(requests)}  {name:40}", end="", file=sys.stderr)
    print(f"{len(requests)} plans in {arguments.out}")


def compare(arguments):
    def files(root):
        return {path.relative_to(root): path.read_bytes() for path in sorted(root.rglob("*")) if path.is_file()}

    before, after = files(arguments.before), files(arguments.after)
    differing = [name for name in sorted(before.keys() | after.keys()) if before.get(name) != after.get(name)]
    for name in differing:
        print("differs:", name)
    print(f"{len(before)} files before, {len(after)} after, {len(differing)} differ")
    return 1 if differing else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    recording = commands.add_parser("record")
    recording.add_argument("program", type=pathlib.Path)
    recording.add_argument("out", type=pathlib.Path)
    recording.add_argument("--requests", type=pathlib.Path)
    recording.add_argument("--jobs", type=int, default=1)
    recording.set_defaults(run=record)
    comparing = commands.add_parser("compare")
    comparing.add_argument("before", type=pathlib.Path)
    comparing.add_argument("after", type=pathlib.Path)
    comparing.set_defaults(run=compare)
    arguments = parser.parse_args()
    return arguments.run(arguments) or 0


if __name__ == "__main__":
    sys.exit(main())
