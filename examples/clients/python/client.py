"""Has the motion of a request file planned and, with --execute, made by the arm:  client.py REQUEST.yaml [--execute]"""

import secrets
import sys
import time
from pathlib import Path

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from fjr import msg

SENT = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepAll)
READ = SENT + Qos(Policy.Durability.TransientLocal)


def wait_for(reader, holds, seconds):
    """The sample for which `holds`, if one comes within that many seconds."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for sample in reader.take():
            if sample.sample_info.valid_data and holds(sample):
                return sample
        time.sleep(0.01)
    return None


def ask(writer, replies, request):
    """The final reply; asks again after half a second without it. None: nobody answers for ten seconds."""
    heard = time.monotonic()

    def answers(sample):
        nonlocal heard
        heard = time.monotonic()
        return sample.id == request.id and sample.state != msg.STATE_ACCEPTED and sample.reason != msg.REASON_QUEUE_FULL

    reply = None
    while not reply and time.monotonic() < heard + 10:
        writer.write(request)
        reply = wait_for(replies, answers, 0.5)
    return reply


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    path, execute = Path(sys.argv[1]), "--execute" in sys.argv
    client = secrets.token_bytes(16)  # arrays of octets are bytes in Python
    request = msg.MotionRequest(
        id=msg.RequestId(client, 1),
        action=msg.ACTION_PLAN_AND_EXECUTE if execute else msg.ACTION_PLAN,
        trajectory_id=msg.RequestId(bytes(16), 0),
        robot_id="", robot_hash="", name=path.name, priority=0, budget=0, start_within=0,
        document=path.read_text())  # fmt: skip

    everybody = DomainParticipant()
    mine = Subscriber(everybody, qos=Qos(Policy.Partition([client.hex()])))
    replies = DataReader(mine, Topic(everybody, "fjr/plan_reply", msg.PlanReply), qos=READ)
    results = DataReader(everybody, Topic(everybody, "fjr/execution_result", msg.ExecutionResult), qos=READ)
    writer = DataWriter(everybody, Topic(everybody, "fjr/motion_request", msg.MotionRequest), qos=SENT)

    reply = ask(writer, replies, request)
    if not reply:
        sys.exit("nobody answers: is the service running?")
    if reply.state != msg.STATE_SOLVED:
        sys.exit(f"{reply.field}: {reply.sentence}")
    print(f"duration {reply.rows[-1].time:g} s, {len(reply.rows)} rows")
    if execute:
        result = wait_for(results, lambda sample: sample.trajectory_id == request.id, reply.rows[-1].time + 10)
        if not result:
            sys.exit("the executor has not reported")
        print(f"executed: code {result.error_code} {result.sentence}")
        sys.exit(result.error_code != msg.RESULT_SUCCESSFUL)


if __name__ == "__main__":
    main()
