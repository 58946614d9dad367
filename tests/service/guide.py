"""Runs every command of docs/service.md, as it stands there.  guide.py SOURCE_FOLDER BUILD_FOLDER build|run

What is before `fjr serve` builds the clients, in BUILD_FOLDER/guide and with the network as it is. The rest runs in a
network namespace of its own that has a second interface, on which nobody is to be found. Where no cyclonedds can be
imported, as where pip finds no packages, Python's commands are left out; whatever else is wrong with them fails.
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


def untold(source, page):
    """What the protocol has and the page does not name: constants by the end of their names, and topics."""
    idl, table = (source / "idl/fjr_msgs.idl").read_text(), (source / "planner/dds/topics.h").read_text()
    constants = re.findall(r"const octet (?:ACTION|STATE|REASON|MODE|COMMAND)_(\w+) =", idl)
    topics = re.findall(r'kName = "(fjr/\w+)"', table)
    if not constants or not topics:
        sys.exit("neither constants nor topics are found where they were")
    return [name for name in [*constants, *topics] if name != "NONE" and not re.search(rf"\b(\w+_)?{name}\b", page)]


def imports(folder, environment):
    python = folder / "out" / environment / "bin" / "python"
    return python.exists() and subprocess.run([python, "-c", "import cyclonedds.idl"]).returncode == 0


def pip_finds_packages(folder):
    found = run(folder, "python3 -m venv out/pip && out/pip/bin/pip download -q --no-deps -d out/pip cyclonedds==11.0.1")
    return found.returncode == 0


def build_clients(source, folder, commands):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "build").symlink_to(folder.parent)
    for part in ("config", "docs", "examples", "idl"):
        (folder / part).symlink_to(source / part)
    for client in (source / "examples" / "clients").glob("*/client.*"):
        if len(client.read_text().splitlines()) > 80:
            sys.exit(f"{client} is longer than the page says")
    for block in commands:
        failed = run(folder, "set -e\n" + block).returncode != 0
        if failed and ("pip install" not in block or imports(folder, "python/venv") or pip_finds_packages(folder)):
            sys.exit("this does not build a client")
    # What Cyclone DDS 11 says of its types once ended the service and the executor.
    run(folder, "python3 -m venv out/newer && out/newer/bin/pip install -q cyclonedds==11.0.1")


def run_clients(folder, commands):
    """Has all clients refused as well; and looks for what they printed as often as it has to be there."""
    python, newer = (imports(folder, name) for name in ("python/venv", "newer"))
    clients = ["out/c/client out/beyond.yaml", "out/cpp/client out/beyond.yaml"]
    if python:
        clients.append(PYTHON.format("python/venv", "beyond"))
    else:
        print("Python's cyclonedds cannot be had here: not tested")
        commands = [re.sub(r"^.*python.*\n", "", block, flags=re.MULTILINE) for block in commands]
    besides = "echo 'goal: {q: [0, 9]}' > out/beyond.yaml\n" + "".join(f"! {client}\n" for client in clients)
    if python and newer:
        besides += PYTHON.format("newer", "back") + "\n"
    for _ in range(3):  # the arm stops where a busy machine lets control ticks be missed
        done = run(folder, ALONE + commands[0] + besides + "".join(commands[1:]), namespace())
        if "ticks in a row were missed" not in done.stdout:
            break
    executed = len(re.findall(DURATION + "executed: code 0 \n", done.stdout))
    planned = len(re.findall(DURATION, done.stdout))
    refused = done.stderr.count("goal.q[1]: ")
    if (done.returncode, planned, executed, refused) != (0, 4 + python + (python and newer), 3 + python, 2 + python):
        print((folder / "out" / "serve.log").read_text(), (folder / "out" / "executor.log").read_text())
        sys.exit(f"{planned} planned, {executed} executed, {refused} refused, ended with {done.returncode}")


def main():
    source, build = (Path(argument).resolve() for argument in sys.argv[1:3])
    page = source / "docs" / "service.md"
    commands = blocks(page)
    first = next(i for i, block in enumerate(commands) if "fjr serve" in block)
    if sys.argv[3] == "run":
        return run_clients(build / "guide", commands[first:])
    if missing := untold(source, page.read_text()):
        sys.exit(f"the page does not name {missing}")
    build_clients(source, build / "guide", commands[:first])


if __name__ == "__main__":
    main()
