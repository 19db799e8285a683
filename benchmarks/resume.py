"""A study killed by SIGKILL and started again ends as one that was left alone: the proof on a real
study.

    python3 benchmarks/resume.py harmonic --solver reference -j 2 --out DIR [--share 0.3]

runs ./run_all.sh into DIR/killed, kills every one of its processes once a share of the points is
simulated and while a history is being written, runs it again, runs it once without a break into
DIR/whole, and prints what it found: seconds of each, whether every file that was finished kept its
checksum and its time, whether the tables are equal. An existing folder is continued.  Exit status:
0 all as it should be, 1 not.
"""

import argparse
import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.applications.studies.definition import load_study
from damage.applications.studies.outdated import Results


def main():
    """Run the proof; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study")
    parser.add_argument("--solver", default="reference")
    parser.add_argument("-j", dest="jobs", default="2")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument(
        "--share", type=float, default=0.3, help="of the points before the kill (default 0.3)"
    )
    asked = parser.parse_args()
    killed = asked.out.absolute() / "killed"
    whole = asked.out.absolute() / "whole"
    path = (
        Path(asked.study)
        if asked.study.endswith(".toml")
        else ROOT / "studies" / f"{asked.study}.toml"
    )
    points = load_study(path, asked.solver, ROOT).runs

    first_s, done = run_until_killed(command(asked, killed), killed, points, asked.share)
    kept = finished(killed)
    print(
        f"killed after {first_s:.0f} s, {done} of {len(points)} points and {len(kept)} runs done",
        flush=True,
    )
    second_s = run_to_end(command(asked, killed))
    after = finished(killed)
    same = all(after.get(path) == state for path, state in kept.items())
    print(
        f"ended after {second_s:.0f} s more, {len(after)} runs; finished files "
        f"{'unchanged' if same else 'CHANGED'}",
        flush=True,
    )
    whole_s = run_to_end(command(asked, whole))
    equal = tables(killed) == tables(whole) and bool(tables(whole))
    print(
        f"without a break {whole_s:.0f} s; {len(tables(whole))} tables"
        f" {'equal' if equal else 'DIFFER'}"
    )
    return 0 if same and equal else 1


def tables(folder):
    """{name: content} of the tables of a study."""
    return {path.name: path.read_bytes() for path in folder.glob("tables/*.csv")}


def command(asked, out):
    return [
        ROOT / "run_all.sh",
        asked.study,
        "--solver",
        asked.solver,
        "-j",
        asked.jobs,
        "--out",
        out,
    ]


def run_to_end(words):
    """Seconds that a batch takes; it must end well."""
    began = time.monotonic()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - began


def run_until_killed(words, folder, points, share):
    """Start a batch and kill it; returns the seconds until then and the points that were done."""
    began = time.monotonic()
    batch = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while True:
        done = sum(bool(Results(folder).records.names_of(run)) for run in points)
        if done >= share * len(points) and list((folder / "runs").glob("*.part.h5")):
            kill_tree(batch.pid)
            batch.wait()
            return time.monotonic() - began, done
        if batch.poll() is not None:
            sys.exit(
                f"error: it ended with {done} points before it was killed; expected a longer study"
            )
        time.sleep(0.05)


def kill_tree(pid):
    """SIGKILL a process and all below it, the topmost first."""
    rows = subprocess.run(
        ["ps", "-eo", "pid=,ppid="], capture_output=True, text=True, check=True
    ).stdout.split("\n")
    children = {}
    for child, parent in (map(int, row.split()) for row in rows if row):
        children.setdefault(parent, []).append(child)
    ending = [pid]
    for one in ending:
        ending += children.get(one, [])
    for one in ending:
        try:
            os.kill(one, signal.SIGKILL)
        except ProcessLookupError:
            pass


def finished(folder):
    """{history: (its SHA-256, its time)} of all that are whole."""
    return {
        path: (hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_mtime_ns)
        for path in (folder / "runs").glob("*.h5")
        if not path.name.endswith(".part.h5")
    }


if __name__ == "__main__":
    sys.exit(main())
