"""The service's metrics:  metrics.py SOURCE_FOLDER PROGRAM

What is served is read by Prometheus's own parser, tells what has happened, and has every metric that the dashboard in
config/grafana asks for. Readers that are stuck keep nobody from anything. Exit code 77: there is no such parser here.
"""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

try:
    from prometheus_client.parser import text_string_to_metric_families
except ImportError:
    print("python3-prometheus-client is not there")
    sys.exit(77)

FAST = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n"
REFUSED = "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n"
ROBOT = 'arm "\\'  # what has to be escaped in a label
EXPRESSION = re.compile(r"\bfjr_\w+")


def alone():
    """Again in a network namespace of its own, where no other test's service is met and every port is free."""
    for how in ("-n", "-rn"):
        if subprocess.run(["unshare", how, "true"], capture_output=True).returncode == 0:
            os.environ["FJR_ALONE"] = "1"
            script = 'ip link set lo up && exec "$@"'
            os.execvp("unshare", ["unshare", how, "sh", "-c", script, "sh", sys.executable, *sys.argv])
    sys.exit("network namespaces are not allowed here")


def wait_for(holds, limit=20):
    end = time.monotonic() + limit
    while True:
        found = holds()
        if found:
            return found
        assert time.monotonic() < end, "it did not come true"
        time.sleep(0.05)


class Service:
    def __init__(self, program, folder, configuration, log="serve.log"):
        (folder / "service.yaml").write_text(configuration)
        self.log = folder / log
        with self.log.open("w") as log_file:
            words = [program, "serve", "--config", folder / "service.yaml"]
            self.process = subprocess.Popen(words, stdout=log_file, stderr=subprocess.STDOUT)

    def port(self):
        found = wait_for(lambda: re.search(r"metrics on http://127\.0\.0\.1:(\d+)/metrics", self.log.read_text()))
        return int(found[1])

    def end(self):
        began = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(timeout=20)
        assert code == 0, (code, self.log.read_text())
        return time.monotonic() - began


def get(port, path="/metrics"):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=10) as response:
        return response.headers["Content-Type"], response.read().decode()


def samples(port):
    """Value by name and labels; all that is served, as Prometheus reads it."""
    kind, text = get(port)
    assert kind == "text/plain; version=0.0.4; charset=utf-8", kind
    found = {}
    for family in text_string_to_metric_families(text):
        assert family.documentation and family.type in ("counter", "gauge", "histogram"), family
        for sample in family.samples:
            key = (sample.name, tuple(sorted(sample.labels.items())))
            assert key not in found, key
            found[key] = sample.value
    return found


def value(found, name, **labels):
    return found.get((name, tuple(sorted(labels.items()))))


def ask(program, request, *words):
    return subprocess.run([program, "request", request, "--find", "20", *words], capture_output=True, text=True, timeout=60)


def check_what_is_told(program, folder, port):
    assert ask(program, folder / "fast.yaml").returncode == 0
    assert ask(program, folder / "refused.yaml").returncode == 2
    solved = {"state": "SOLVED", "reason": "NONE"}
    found = wait_for(lambda: (s := samples(port)) and value(s, "fjr_requests_received_total") == 2 and s)
    assert value(found, "fjr_replies_total", **solved) == 1, found
    assert value(found, "fjr_replies_total", state="REJECTED", reason="BAD_INPUT") == 1, found
    assert value(found, "fjr_solve_seconds_count") == 1 and value(found, "fjr_solve_seconds_sum") > 0.001
    assert value(found, "fjr_solve_seconds_bucket", le="+Inf") == 1
    buckets = sorted((float(dict(labels)["le"]), count) for (name, labels), count in found.items()
                     if name == "fjr_solve_seconds_bucket")
    assert all(a[1] <= b[1] for a, b in zip(buckets, buckets[1:])), buckets
    assert value(found, "fjr_wait_seconds_count") == 1
    assert value(found, "fjr_slots") == 2 and value(found, "fjr_slots_busy") == 0 and value(found, "fjr_queue_length") == 0
    assert value(found, "fjr_queue_capacity") == 64 and value(found, "fjr_certificates_refused_total") == 0
    assert value(found, "fjr_owner") == 1 and value(found, "fjr_epoch") >= 1
    assert value(found, "fjr_memory_bytes") > 1e6 and value(found, "fjr_workers_lost_total") == 0
    assert value(found, "fjr_remembered_replies") == 2
    assert abs(value(found, "fjr_snapshot_timestamp_seconds") - time.time()) < 5
    named = [dict(labels) for (name, labels) in found if name == "fjr_info"]
    assert len(named) == 1 and named[0]["robot_id"] == ROBOT and len(named[0]["robot_hash"]) == 64, named


def check_executor(program, folder, port):
    assert value(samples(port), "fjr_executor_up") == 0
    words = [program, "executor", "--robot-id", ROBOT, "--state", folder / "state"]
    executor = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(lambda: value(samples(port), "fjr_executor_mode", mode="resting") == 1)
        found = samples(port)
        assert value(found, "fjr_executor_up") == 1
        modes = {dict(labels)["mode"]: count for (name, labels), count in found.items() if name == "fjr_executor_mode"}
        assert len(modes) == 6 and sum(modes.values()) == 1, modes
    finally:
        executor.kill()
        executor.wait()
    wait_for(lambda: value(samples(port), "fjr_executor_up") == 0)


def check_stuck_readers(program, folder, port):
    """They connect and say nothing, or ask and do not read; the service answers, and so does the page."""
    stuck = [socket.create_connection(("127.0.0.1", port)) for _ in range(4)]
    stuck[0].sendall(b"GET /metrics HTTP/1.1\r\nHost: x\r\n")
    began = time.monotonic()
    assert ask(program, folder / "fast.yaml", "--robot-id", ROBOT).returncode == 0
    found = samples(port)
    assert time.monotonic() - began < 10
    assert value(found, "fjr_owner") == 1
    return stuck


def check_dashboard(source, port):
    dashboard = json.loads((source / "config/grafana/fjr.json").read_text())
    targets = [target["expr"] for panel in dashboard["panels"] for target in panel.get("targets", [])]
    asked = {name for expression in targets for name in EXPRESSION.findall(expression)}
    assert len(targets) >= 10 and asked, targets
    served = {name for name, _ in samples(port)}
    assert asked <= served, f"the dashboard asks for what is not served: {sorted(asked - served)}"
    families = {re.sub(r"_(bucket|sum|count)$", "", name) for name in served}
    shown = {re.sub(r"_(bucket|sum|count)$", "", name) for name in asked}
    assert families <= shown | {"fjr_info"}, f"the dashboard does not show {sorted(families - shown)}"
    page = (source / "docs/service.md").read_text()
    untold = [name for name in families if f"`{name}" not in page]
    assert not untold, f"docs/service.md does not name {untold}"


def check_several(program, folder):
    """Each sample of a service of two robots says of which, and those of a metric stand together."""
    service = Service(program, folder, "{metrics: {port: 0}, robots: [{id: left}, {id: right}]}\n", "several.log")
    port = service.port()
    owner = wait_for(lambda: (s := samples(port)) and value(s, "fjr_owner", robot_id="left") == 1 and
                     value(s, "fjr_owner", robot_id="right") == 1 and s)
    unlabelled = [key for key in owner if "robot_id" not in dict(key[1])]
    assert not unlabelled, unlabelled
    assert {dict(labels)["robot_id"] for name, labels in owner if name == "fjr_info"} == {"left", "right"}
    text = get(port)[1]
    names = [line.split("{")[0] for line in text.splitlines() if not line.startswith("#")]
    assert names.count("fjr_owner") == 2 and names.index("fjr_owner") + 1 == names.index("fjr_owner", names.index("fjr_owner") + 1)
    assert text.count("# TYPE fjr_owner ") == 1
    service.end()


def main(source, program):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "fast.yaml").write_text(FAST)
        (folder / "refused.yaml").write_text(REFUSED)
        service = Service(program, folder, f"{{workers: 2, robot_id: '{ROBOT}', metrics: {{port: 0}}}}\n")
        try:
            port = service.port()
            wait_for(lambda: value(samples(port), "fjr_owner") == 1)
            check_what_is_told(program, folder, port)
            check_executor(program, folder, port)
            check_dashboard(source, port)
            try:
                get(port, "/")
                raise AssertionError("there is more than /metrics")
            except urllib.error.HTTPError as error:
                assert error.code == 404, error
            # Of two on one machine the second says that the port is taken, serves all the same, and has it afterwards.
            second = Service(program, folder, f"{{workers: 1, robot_id: other, metrics: {{port: {port}}}}}\n", "second.log")
            wait_for(lambda: f"port {port} of 127.0.0.1 cannot be listened on" in second.log.read_text())
            wait_for(lambda: "owner robot_id=other" in second.log.read_text())
            stuck = check_stuck_readers(program, folder, port)
            assert service.end() < 5
            for reader in stuck:
                reader.close()
            assert second.port() == port
            wait_for(lambda: value(samples(port), "fjr_requests_received_total") == 0)
            second.end()
            check_several(program, folder)
        except BaseException:
            for log in folder.glob("*.log"):
                print(log.read_text())
            raise
        finally:
            service.process.kill()


if __name__ == "__main__":
    if "FJR_ALONE" not in os.environ:
        alone()
    main(Path(sys.argv[1]), sys.argv[2])
