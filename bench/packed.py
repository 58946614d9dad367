#!/usr/bin/env python3
"""What packed batches of many requests weigh: size and CPU time of preparing, looking, finishing, gathering and reading.

    bench/packed.py BUILD [--requests N...] [--folder DIR]

A few requests are planned. Their answers, files and all, are then written under the names of all N: to plan 1e5 would take
hours. Names, digests and places are those that the manifest asks for. (Who runs a filled chunk again would see that plan.json
has the hash of another request.) Then four more requests are added, which `fjr batch run` has to find and plan.
"""

import argparse
import json
import resource
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GRID = """request: {{start: {{q: [0.3, 0.2]}}, goal: {{q: [0.3, 0.21]}}, sample_period: 0.005}}
axes:
  goal.q[0]: {{from: {first}, to: {last}, count: {rows}}}
  goal.q[1]: {{from: 0.21, to: 0.31, count: {columns}}}
"""
FEW = 4


def cpu_time():
    """Of ended processes that this one started, in s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def timed(words):
    """What it prints, and its CPU time in s: wall times are those of the disk, and of whoever else is there."""
    began = cpu_time()
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {done.returncode}\n{done.stderr}")
    return done.stdout, cpu_time() - began


def fill(batch, models):
    """Writes the answers `models` in turn under all names."""
    manifest = sqlite3.connect(batch / "manifest.sqlite")
    requests = manifest.execute("SELECT chunk, name, digest, axes FROM requests ORDER BY chunk, name").fetchall()
    (batch / "chunks").mkdir(exist_ok=True)
    files, chunk = None, None
    for number, (of_chunk, name, digest, axes) in enumerate(requests):
        if of_chunk != chunk:
            if files:
                files.commit()
            chunk, files = of_chunk, sqlite3.connect(batch / "chunks" / f"{of_chunk:05}.sqlite")
            files.executescript("PRAGMA journal_mode = WAL;" + models["tables"])
            files.execute("INSERT INTO runs VALUES (1, 'copies', 1, '2026-01-01T00:00:00Z', '2026-01-01T00:00:00Z', 0)")
        row, packed = models["answers"][number % len(models["answers"])]
        row = dict(row, name=name, axes=json.loads(axes))
        files.execute("INSERT INTO plans VALUES (?, 0, 'certified', ?, 1, ?)", [name, digest, json.dumps(row)])
        files.executemany("INSERT INTO files VALUES (?, 0, ?, ?, ?)", [[name, *file] for file in packed])
        files.execute("UPDATE runs SET planned = planned + 1")
    files.commit()


def planned(fjr, folder):
    """Some answers, as they stand in a chunk."""
    (folder / "few.yaml").write_text(GRID.format(first=0.28, last=0.29, rows=2, columns=2))
    timed([fjr, "batch", "prepare", folder / "few.yaml", "--out", folder / "few"])
    _, seconds = timed([fjr, "batch", "run", folder / "few", "--quiet"])
    chunk = sqlite3.connect(folder / "few/chunks/00001.sqlite")
    tables = ";".join(sql for (sql,) in chunk.execute("SELECT sql FROM sqlite_master WHERE type = 'table'"))
    answers = []
    for name, row in chunk.execute("SELECT name, row FROM plans").fetchall():
        packed = chunk.execute("SELECT file, size, deflated FROM files WHERE name = ?", [name]).fetchall()
        answers.append((json.loads(row), packed))
    print(f"{len(answers)} planned in {seconds:.1f} s of CPU")
    return {"tables": tables, "answers": answers}


def weigh(fjr, folder, count, models):
    batch = folder / str(count)
    columns = 10 ** (len(str(count)) // 2)
    grid = folder / "grid.yaml"
    grid.write_text(GRID.format(first=0.3, last=0.4, rows=count // columns, columns=columns))
    _, prepare = timed([fjr, "batch", "prepare", grid, "--out", batch])
    fill(batch, models)
    timed([fjr, "batch", "prepare", grid, folder / "few.yaml", "--out", batch])
    before, look = timed([fjr, "batch", "status", batch, "--json"])
    before = json.loads(before)
    assert before["status"] == {"certified": count, "open": FEW}, before
    _, finish = timed([fjr, "batch", "run", batch, *before["unfinished"], "--quiet"])
    status = json.loads(timed([fjr, "batch", "status", batch, "--json"])[0])
    assert status["status"] == {"certified": count + FEW}, status
    assert status["planned"] == before["planned"] + FEW, status
    _, gather = timed([fjr, "batch", "gather", batch])
    began = time.process_time()
    rows = sqlite3.connect(batch / "results.sqlite").execute("SELECT name, status, duration FROM results").fetchall()
    read = time.process_time() - began
    assert len(set(name for name, _, _ in rows)) == count + FEW
    _, unpack = timed([fjr, "batch", "unpack", batch, rows[-1][0], "--out", folder / "one"])
    shutil.rmtree(folder / "one")
    files = [file for file in batch.rglob("*") if file.is_file()]
    size = sum(file.stat().st_size for file in files)
    print(f"{count:>7} requests: {len(files)} files, {size / 1e6:.0f} MB, {size / count / 1e3:.1f} kB a request, "
          f"results.sqlite {(batch / 'results.sqlite').stat().st_size / count:.0f} bytes a request; prepare {prepare:.1f} s, "
          f"status {look:.1f} s, run of four more {finish:.1f} s, gather {gather:.1f} s, unpack one {unpack:.2f} s, "
          f"read the table in Python {read:.2f} s", flush=True)
    shutil.rmtree(batch)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--requests", type=int, nargs="+", default=[1000, 10000, 100000])
    parser.add_argument("--folder", type=Path, help="with room for 90 kB a request; default: a temporary one")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        fjr = arguments.build.resolve() / "fjr"
        models = planned(fjr, Path(folder))
        for count in arguments.requests:
            weigh(fjr, Path(folder), count, models)


if __name__ == "__main__":
    main()
