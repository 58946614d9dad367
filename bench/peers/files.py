"""What peers and other comparisons share without CasADi: the arm's numbers, trajectory files, and how fjr is run."""
import csv
import math
import os
import pathlib
import platform
import subprocess

import numpy as np
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROBOT = ROOT / "config/robot.yaml"
COLUMNS = "time,q1,q2,dq1,dq2,theta1,theta2,dtheta1,dtheta2,tau1,tau2".split(",")
ONE_THREAD = {name: "1" for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
ENVIRONMENT = {"FJR_CONFIG_DIR": str(ROOT / "config"), **os.environ, **ONE_THREAD, "PYTHONDONTWRITEBYTECODE": "1"}


def parameters(path=ROBOT):
    """{"section.name": [joint 1, joint 2]} of a robot.yaml without a payload."""
    document = yaml.safe_load(path.read_text())
    if "payload" in document:
        raise ValueError(f"{path}: payload: the peers' arm carries nothing")
    return {f"{section}.{name}": np.array(entry["value"], dtype=float)
            for section, entries in document.items() for name, entry in entries.items()}


def write_rows(path, table):
    """A trajectory file of (n, 11)."""
    with path.open("w", newline="") as file:
        file.write(",".join(COLUMNS) + "\n")
        csv.writer(file, lineterminator="\n").writerows([f"{value:.17g}" for value in row] for row in table)


def read_rows(path):
    with path.open() as file:
        lines = [line for line in file if not line.startswith("#")]
    table = list(csv.DictReader(lines))
    return np.array([[float(row[column]) for column in COLUMNS] for row in table])


def machine(fjr):
    """What it was run on and with."""
    processor = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "")
    version = subprocess.run([fjr, "--version"], capture_output=True, text=True).stdout.strip()
    return {"processor": processor, "cores": os.cpu_count(), "python": platform.python_version(), "fjr": version}


def number(value, digits=3):
    """To so many digits, trailing zeros included, never as a power of ten."""
    places = digits - 1 - math.floor(math.log10(abs(value))) if value else 0
    return f"{value:.{max(0, places)}f}"
