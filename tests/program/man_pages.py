"""Man pages of the program: man_pages.py SOURCE PROGRAM. Each command has one, found here by what --help lists, and it says
what --help says. Exit code 77: no help2man here, of which they are made."""

import gzip
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path


def help_of(program, words):
    done = subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def commands(program, words=()):
    """Of the program with those words, and below: the words of each command that --help lists, and what --help says."""
    lines = help_of(program, words)
    yield words, lines
    listed = False
    for line in lines:
        listed = line == "Subcommands:" or (listed and line != "")
        if listed and (name := re.match(r"  ([a-z]\S*)", line)):
            yield from commands(program, (*words, name[1]))


def text_of(page):
    """The words of a page, without troff's requests and fonts."""
    lines = []
    for line in page.splitlines():
        line = re.sub(r"^\.(?:SH|SS|B|TH|IP|PP|TP)\b ?", "", line)
        if not line.startswith(r".\""):
            lines.append(re.sub(r"\\f[BIR]|\\[,/&]", "", line).replace(r"\-", "-").replace(r"\e", "\\").replace('"', ""))
    return " ".join(" ".join(lines).split())


def check(name, lines, page):
    text = text_of(page)
    about = lines[0].removeprefix("fjr: ")
    assert text.startswith(f"{name.upper()} 1 "), f"{name} has another title: {text[:80]}"
    assert f"NAME {name} - {about} SYNOPSIS" in text, f"{name} does not begin with its name and what it is: {text[:300]}"
    for line in lines:
        if line.startswith("Usage:") or re.fullmatch(r"\S.*:", line):
            continue  # the synopsis, and titles, which are set in other letters
        said = " ".join(line.replace('"', "").split())
        assert said in text, f"man {name} does not say what --help says: {said}"


def main(source, program):
    if shutil.which("help2man") is None:
        print("skipped: no help2man here")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([source / "cmake" / "man_pages.sh", program, folder], check=True)
        pages = {file.name.removesuffix(".1.gz"): gzip.decompress(file.read_bytes()).decode() for file in Path(folder).iterdir()}
    helps = {"-".join(("fjr", *words)): lines for words, lines in commands(program)}
    assert set(pages) == set(helps), f"pages of nothing, or missing: {set(pages) ^ set(helps)}"
    assert {"fjr", "fjr-plan", "fjr-batch-run", "fjr-robot-new"} <= set(pages)
    for name, lines in helps.items():
        check(name, lines, pages[name])
    print(f"{len(pages)} pages")


main(Path(sys.argv[1]), sys.argv[2])
