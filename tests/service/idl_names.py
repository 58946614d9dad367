"""The IDL files are taken by the generators of others.  idl_names.py IDL_FOLDER

- Names are as ROS 2's rosidl asks (rosidl_adapter/parser.py), so that every type can be had as a ROS 2 message.
- fastddsgen refuses members named like a type, letters' case aside; fastddsgen itself is run where it is installed.
- idlc makes Python of fjr_msgs.idl, where a member must not be a keyword.
"""

import keyword
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

STRUCT = re.compile(r"^[A-Z][A-Za-z0-9]*$")
MEMBER = re.compile(r"^(?!.*__)(?!.*_$)[a-z][a-z0-9_]*$")
CONSTANT = re.compile(r"^[A-Z]([A-Z0-9_]?[A-Z0-9]+)*$")


def faults(folder, files):
    text = "\n".join(re.sub(r"//.*", "", (folder / file).read_text()) for file in files)
    structs = dict(re.findall(r"struct (\w+) \{([^}]*)\}", text))
    members = [name for body in structs.values() for name in re.findall(r"(\w+)(?:\[\w+\])?;", body)]
    types = {name.lower() for name in structs}
    yield from (f"struct {name}: not a name for rosidl" for name in structs if not STRUCT.match(name))
    for name in sorted(set(members)):
        if not MEMBER.match(name):
            yield f"member {name}: not a name for rosidl"
        if name.lower() in types:
            yield f"member {name}: named like a type, which fastddsgen refuses"
        if files == ["fjr_msgs.idl"] and keyword.iskeyword(name):
            yield f"member {name}: a keyword of Python"
    for name in re.findall(r"const [\w ]+ (\w+) =", text):
        if not CONSTANT.match(name):
            yield f"constant {name}: not a name for rosidl"
    if not members:
        yield f"no structs in {files}"


def refused_by_fastddsgen(folder, file):
    with tempfile.TemporaryDirectory() as out:
        command = ["fastddsgen", "-replace", "-t", out, "-I", str(folder), "-d", out, str(folder / file)]
        run = subprocess.run(command, capture_output=True, text=True)
        made = Path(out, Path(file).stem + "PubSubTypes.cxx").exists()
    if run.returncode != 0 or not made:
        yield f"{file}: fastddsgen says {run.stdout}{run.stderr}"


def main():
    folder = Path(sys.argv[1])
    files = ["fjr_msgs.idl", "fjr_plan_request.idl", "fjr_work.idl"]
    found = [*faults(folder, files[:1]), *faults(folder, files)]
    if shutil.which("fastddsgen"):
        for file in files:
            found += refused_by_fastddsgen(folder, file)
    else:
        print("fastddsgen is not installed: not run")
    sys.exit("\n".join(found) or 0)


if __name__ == "__main__":
    main()
