"""One name, one thing: two types of the same name in one namespace are undefined behaviour where both are linked into a
program, and no compiler tells. clang-format puts what is in a namespace at the start of a line.

    python3 tests/unique_names.py SOURCE
"""

import pathlib
import re
import sys

TYPE = re.compile(
    r"(?:template <.*> )?(?:struct|class|union|enum(?: class)?) (?:\[\[\w+\]\] |alignas\(\d+\) )?(\w+) [^;]*\{"
)
NAMESPACE = re.compile(r"(?:inline )?namespace ?([\w:]*) \{")


def types_of(file):
    """Names of the types that a file defines in a namespace that others can see."""
    within = []
    for line in file.read_text(encoding="utf-8").splitlines():
        opened = NAMESPACE.match(line)
        if opened:
            within.append(opened[1])
        elif line.startswith("}  // namespace"):
            within.pop()
        elif "" not in within:
            defined = TYPE.match(line)
            if defined:
                yield "::".join([*within, defined[1]])


def main(source):
    places = {}
    for folder in ("common", "model", "planner"):
        for file in sorted((source / folder).rglob("*")):
            if file.suffix in (".h", ".cc"):
                for name in types_of(file):
                    places.setdefault(name, []).append(file.relative_to(source))
    assert len(places) > 300, f"only {len(places)} types found: this no longer reads the sources"
    twice = {name: files for name, files in places.items() if len(files) > 1}
    for name, files in twice.items():
        print(f"{name} is defined in {' and '.join(map(str, files))}: rename one of them", file=sys.stderr)
    return 1 if twice else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
