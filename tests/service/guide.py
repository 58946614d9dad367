"""Runs every command of docs/service.md, as it stands there.  guide.py SOURCE_FOLDER BUILD_FOLDER build|run

What is before `fjr serve` builds the clients, in BUILD_FOLDER/guide and with the network as it is. The rest runs in a
network namespace of its own that has a second interface, on which nobody is to be found. Where pip finds no packages
Python's commands are left out.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ALONE = """set -e
ip link set lo up
ip link add lan0 type veth peer name lan1 && ip address add 10.9.0.1/24 dev lan0 && ip link set lan0 up
trap 'kill $(jobs -p); wait' EXIT
"""
PYTHON = "PYTHONPATH=out/python out/{}/bin/python examples/clients/python/client.py out/{}.yaml"
DURATION = r"duration 0\.\d+ s, \d{3} rows\n"


def blocks(page):
    return re.findall(r"^```sh\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


def run(folder, script, how=("bash", "-c")):
    environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state")}
    done = subprocess.run([*how, script], cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    print(script, done.stdout, done.stderr, sep="\n", flush=True)
    return done


def namespace():
    for how in ("-n", "-rn"):
        if subprocess.run(["unshare", how, "true"], capture_output=True).returncode == 0:
            return ("unshare", how, "bash", "-c")
    sys.exit("network namespaces are not allowed here")


def build_clients(folder, commands):
    for client in (folder / "examples" / "clients").glob("*/client.*"):
        if len(client.read_text().splitlines()) > 80:
            sys.exit(f"{client} is longer than the page says")
    for block in commands:
        if run(folder, "set -e\n" + block).returncode != 0 and "pip install" not in block:
            sys.exit("this does not build a client")
    # What Cyclone DDS 11 says of its types once ended the service and the executor.
    run(folder, "python3 -m venv out/newer && out/newer/bin/pip install -q cyclonedds==11.0.1")


def run_clients(folder, commands, clients):
    refused = "".join(f"{client} && exit 1\n" for client in clients)
    script = ALONE + "".join(commands) + "echo 'goal: {q: [0, 9]}' > out/beyond.yaml\n" + refused
    return run(folder, script, namespace())


def main():
    source, build = (Path(argument).resolve() for argument in sys.argv[1:3])
    folder = build / "guide"
    commands = blocks(source / "docs" / "service.md")
    first = next(i for i, block in enumerate(commands) if "fjr serve" in block)
    if sys.argv[3] == "build":
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for part in ("config", "docs", "examples", "idl"):
            (folder / part).symlink_to(source / part)
        (folder / "build").symlink_to(build)
        return build_clients(folder, commands[:first])

    python, newer = ((folder / "out" / name / "bin" / "pubsub").exists() for name in ("python/venv", "newer"))
    commands = commands[first:]
    clients = ["out/c/client out/beyond.yaml", "out/cpp/client out/beyond.yaml"]
    if python:
        clients.append(PYTHON.format("python/venv", "beyond"))
    else:
        print("Python's cyclonedds cannot be had here: not tested")
        commands = [re.sub(r"^.*python.*\n", "", block, flags=re.MULTILINE) for block in commands]
    if python and newer:
        commands.append(PYTHON.format("newer", "back") + "\n")
    for _ in range(3):  # the arm stops where a busy machine lets control ticks be missed
        done = run_clients(folder, commands, clients)
        if "ticks in a row were missed" not in done.stdout:
            break
    executed = len(re.findall(DURATION + "executed: code 0 \n", done.stdout))
    planned = len(re.findall(DURATION, done.stdout))
    refused = done.stderr.count("goal.q[1]: ")
    if (planned, executed, refused) != (3 + python + (python and newer), 2 + python, 2 + python):
        print((folder / "out" / "serve.log").read_text(), (folder / "out" / "executor.log").read_text())
        sys.exit(f"{planned} planned, {executed} executed, {refused} refused, ended with {done.returncode}")


if __name__ == "__main__":
    main()
