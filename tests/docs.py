"""Holds README.md and docs/ to what they say.  docs.py check SOURCE BUILD | run SOURCE BUILD | --linked SOURCE

check: every link, every heading linked to and every file that a page names is there, requests.md has the table of keys
that `fjr keys` prints, library.md names every public header, and a block behind `<!-- from: FILE -->` stands in that file.
run: every ```sh block is run, in a scratch copy for each page, and every ```yaml block with a request is planned; a ```text
block behind a ```sh block begins its lines as the output does. Blocks behind `<!-- not run: reason -->` are left alone, and
so is service.md, whose commands service/guide.py runs.
--linked: prints the pages and what they link to in the repository, for scripts/docs.sh.
"""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

FOLDERS = "bench|cmake|common|config|docs|examples|idl|model|planner|python|scripts|tests"
NAMED = re.compile(rf"(?<![\w./-])(?:{FOLDERS})/[\w./-]*[\w/]")
LINK = re.compile(r"\]\(([^)\s]+)\)")
BLOCK = re.compile(r"(?:^<!-- not run: (.+?) -->\n)?^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
QUOTED = re.compile(r"^<!-- from: (.+?) -->\n```\w+\n(.*?)^```$", re.DOTALL | re.MULTILINE)
START, GOAL = "start: {q: [0, 0]}\n", "goal: {q: [1.2, -0.8]}\n"


def pages(source):
    """All of them; those whose blocks are run come first."""
    own = [source / "README.md", *sorted((source / "docs").glob("*.md"))]
    others = ["CHANGELOG.md", "bench/README.md", "bench/peers/README.md", "bench/rigid/README.md", "config/security/README.md",
              "planner/executor/README.md"]
    return own, [source / name for name in others]


def prose(page):
    """The page without its blocks, and without what begins like a list of names: `a/{b,c}`."""
    return BLOCK.sub("", page.read_text())


def targets(page):
    """The files and headings of the repository that a page links to."""
    for target in LINK.findall(prose(page)):
        if not re.match(r"https?:", target):
            file, _, heading = target.partition("#")
            yield (page.parent / file).resolve() if file else page, heading, target


def headings(page):
    """As GitHub and MkDocs name them in links."""
    titles = re.findall(r"^#+ (.+?)\s*$", prose(page), re.MULTILINE)
    plain = (re.sub(r"[^\w\s-]", "", re.sub(r"\[(.*?)\]\(.*?\)", r"\1", title)).strip().lower() for title in titles)
    return {re.sub(r"\s", "-", title) for title in plain}


def faults(source, page):
    for file, heading, target in targets(page):
        if not file.exists():
            yield f"links to {target}, which is not there"
        elif heading and heading not in headings(file):
            yield f"links to {target}, and there is no such heading"
    if page.name == "CHANGELOG.md":
        return
    diffs = [body for _, language, body in BLOCK.findall(page.read_text()) if language == "diff"]  # of what was then
    text = page.read_text()
    for body in diffs:
        text = text.replace(body, "")
    for name in sorted(set(NAMED.findall(text))):
        if not (source / name).exists() and not (page.parent / name).exists():
            yield f"names {name}, which is not there"
    for file, body in QUOTED.findall(text):
        if body not in (source / file).read_text():
            yield f"quotes {file} with lines that are not in it:\n{body}"


def public_headers(source):
    return re.findall(r"^  ([\w/]+\.h)", (source / "cmake" / "public_headers.cmake").read_text(), re.MULTILINE)


def check(source, build):
    wrong = [f"{page.relative_to(source)} {fault}" for group in pages(source) for page in group
             for fault in faults(source, page)]
    table = subprocess.run([build / "fjr", "keys"], check=True, capture_output=True, text=True).stdout
    if table not in (source / "docs" / "requests.md").read_text():
        wrong.append("docs/requests.md has another table of keys than what `build/fjr keys` prints: put that there")
    library = (source / "docs" / "library.md").read_text()
    wrong += [f"docs/library.md does not name {header}" for header in public_headers(source) if f"`{header}`" not in library]
    sys.exit("\n".join(wrong) if wrong else 0)


def linked(source):
    every = [page for group in pages(source) for page in group]
    files = {file for page in every for file, _, _ in targets(page) if file.is_file()}
    print("\n".join(sorted(str(file.relative_to(source)) for file in {*every, *files})))


def scratch(source, build, name, requests):
    """A folder in which a page's commands run as in the repository, and write to a folder of their own."""
    folder = build / "docs" / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "build").symlink_to(build)
    (folder / "out").mkdir()
    for part in ("bench", "config", "docs", "examples", "idl", "scripts", "tests"):
        (folder / part).symlink_to(source / part)
    (folder / "requests").mkdir()
    for i, request in enumerate(requests):
        given = [key for key in (START, GOAL) if not re.search(f"^{key.split(':')[0]}:", request, re.MULTILINE)]
        (folder / "requests" / f"block_{i + 1}.yaml").write_text("".join([*given, request]))
    return folder


def namespace():
    """What is said over DDS stays among the processes of one page."""
    for how in ("-n", "-rn"):
        if subprocess.run(["unshare", how, "true"], capture_output=True).returncode == 0:
            return ["unshare", how]
    sys.exit("network namespaces are not allowed here")


def run_script(folder, script):
    environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state")}
    alone = "set -e\nip link set lo up\ntrap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT\n"
    return subprocess.run([*namespace(), "bash", "-c", alone + script], cwd=folder, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300)


def first_words(text):
    """What a line of a summary is about: its indentation and first word."""
    return re.findall(r"^( *[A-Za-z_]+)", text, re.MULTILINE)


def run_page(source, build, page):
    """Runs the shell blocks as one script: what one begins, as a service, the next one uses."""
    script, shown, requests = "", [], []
    before = ""
    for reason, language, body in BLOCK.findall(page.read_text()):
        if not reason and language == "sh":
            script += body
        if language == "text" and before == "sh":
            shown.append(body)
        if not reason and language == "yaml":
            requests.append(body)
        before = "" if reason else language
    if requests:
        script += "build/fjr batch requests --out out/blocks\n"
    if not script:
        return ""
    began = time.monotonic()
    for _ in range(3):  # the arm stops where a busy machine lets control ticks be missed
        done = run_script(scratch(source, build, page.stem, requests), script)
        if "ticks in a row were missed" not in done.stdout:
            break
    print(f"{page.name}: {time.monotonic() - began:.1f} s")
    if done.returncode != 0:
        return f"{page.name}: ended with {done.returncode}\n{script}\n{done.stdout}"
    printed = first_words(done.stdout)
    missing = [word for body in shown for word in first_words(body) if word not in printed]
    return f"{page.name}: shows {missing}, which is not printed\n{done.stdout}" if missing else ""


def run(source, build):
    own, _ = pages(source)
    wrong = [fault for page in own if page.name != "service.md" if (fault := run_page(source, build, page))]
    sys.exit("\n".join(wrong) if wrong else 0)


def main():
    what, *folders = sys.argv[1:]
    {"check": check, "run": run, "--linked": linked}[what](*(Path(folder).resolve() for folder in folders))


if __name__ == "__main__":
    main()
