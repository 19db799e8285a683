"""Processes of a small study or claim killed by SIGKILL at random times, each kill followed by the
same command: the proof that no process stays, and that it always completes, with the tables of one
that was left alone.

    python3 benchmarks/kills.py --out DIR [--kills 20] [--who worker|any] [--what study|claim]
                                [--seed N] [-j 2]

A worker is a process in which runs of the reference solver step, which begin again; any: also the
batch itself. Studies keep all histories and only those of a summary in turns.  DIR must be new.
Exit status: 0 all completed with equal tables and no process left, 1 not.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
KEEP = "all", "summary"
WALL = (
    "from damage import Wall\n\n\ndef wall():\n    return Wall(name='tiny', length=0.45,"
    " height=0.6)\n"
)
STUDY = """name = "kills"
pictures = "none"
[[grid]]
wall = "tiny.py"
options = { harmonic = [0.1, "{g}"], cycles = 1, rest = 0, strength-cov = 0.3 }
samples = 6
vary = { g = [0.5, 0.4] }
[[grid]]
wall = "tiny.py"
options = { harmonic = [0.1, "{g}"], cycles = 1, rest = 0 }
members = 3
vary = { g = [0.45, 0.01] }
[[runs]]
id = "alone"
wall = "tiny.py"
options = { harmonic = [0.1, 0.3], cycles = 1, rest = 0, sequence = "1,0.5" }
"""
CRACKS = (
    "crack,point,x_m,z_m,width_mm,offset,detection_limit_mm,width_error_mm\n"
    "A,1,0,0.075,0.15,no,0.1,0.05\nA,2,0.16,0.075,,,,\n"
)
CLAIM = (
    *("--at", "53.36786", "6.71359", "--from", "2012", "--to", "2014", "--above", "12"),
    *("--strong", "0.2", "0.3", "--rest", "0.1", "--draws", "6", "--cracks", "survey.csv"),
)
MOST_CALLS = 3
"""Of the same command after a kill, the last of which must complete."""
LEAVES_S = 5.0
"""Time within which the processes of a batch that was killed have to end [s]."""

BECOMES_S = 0.05
"""Time within which a child that becomes another program, as git, has its own command line [s]."""


def main():
    """Run the proof; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--who", choices=("worker", "any"), default="worker")
    parser.add_argument("--what", choices=("study", "claim"), default="study")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-j", dest="jobs", default="2")
    asked = parser.parse_args()
    out = asked.out.absolute()
    if out.exists():
        parser.error(f"--out {out} is there: expected a new folder, delete it or give another")
    out.mkdir(parents=True)
    (out / "tiny.py").write_text(WALL)
    (out / "study.toml").write_text(STUDY)
    (out / "survey.csv").write_text(CRACKS)
    draw = random.Random(asked.seed)
    proof = Proof(out, asked.jobs, asked.who, asked.what)
    longest_s = max(proof.run_alone(keep) for keep in KEEP)
    whole, good, kills = {keep: tables(out / keep) for keep in KEEP}, 0, 0
    while kills < asked.kills:
        name, keep = f"killed_{kills:02d}", KEEP[kills % 2]
        killed = proof.kill(name, keep, draw, longest_s)
        if killed is None:  # it had ended before
            longest_s *= 0.7
            continue
        kills += 1
        calls = next(
            (n for n in range(1, MOST_CALLS + 1) if proof.run_to_end(name, keep) == 0), None
        )
        equal, left = tables(out / name) == whole[keep], len(proof.left())
        good += equal and calls is not None and "0 left" in killed and not left
        print(
            f"{kills}: {killed}, --keep {keep};"
            f" {f'completed by call {calls}' if calls else f'NOT complete by call {MOST_CALLS}'},"
            f" {len(whole[keep])} tables {'equal' if equal else 'DIFFER'}, {left} left at the end",
            flush=True,
        )
    print(f"{good} of {kills} kills ended complete with equal tables and no process left")
    return 0 if good == kills else 1


class Proof:
    """Batches of the study in one folder."""

    def __init__(self, out, jobs, who, what):
        self.out, self.jobs, self.who, self.what = out, jobs, who, what

    def start(self, name, keep):
        """Start the batch in a folder of this name."""
        words = (
            ["study", "study.toml", "--keep", keep]
            if self.what == "study"
            else ["claim", "tiny.py", *CLAIM]
        )
        return subprocess.Popen(
            [sys.executable, "-m", "damage", *words, "-j", self.jobs, "--out", self.out / name],
            cwd=self.out,
            env=os.environ
            | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1", "KILLS": str(self.out)},
            stdout=subprocess.DEVNULL,
            stderr=(self.out / f"{name}.log").open("a"),
        )

    def left(self):
        """Pids of processes that the batches have started and that still run."""
        mark, found = f"KILLS={self.out}\0".encode(), []
        for process in Path("/proc").glob("[0-9]*"):
            try:
                if mark in (process / "environ").read_bytes():
                    found.append(process.name)
            except OSError:  # ended meanwhile, or another user's
                pass
        return found

    def run_alone(self, keep):
        """Leave the batch alone, in a folder named by what it keeps; returns how long there was
        something to kill [s]."""
        batch, seen = self.start(keep, keep), []
        while batch.poll() is None:
            if victims(batch.pid, self.who):
                seen.append(time.monotonic())
            time.sleep(0.02)
        assert batch.returncode == 0 and seen, "the study that is left alone fails"
        return seen[-1] - seen[0]

    def run_to_end(self, name, keep):
        """Exit status of the batch."""
        return self.start(name, keep).wait()

    def kill(self, name, keep, draw, longest_s):
        """Start a batch and kill one of its processes; returns what was killed, None where nothing
        was left to kill or the batch completed nevertheless."""
        batch = self.start(name, keep)
        while not victims(batch.pid, self.who) and batch.poll() is None:
            time.sleep(0.01)
        began = time.monotonic()
        wait_s = draw.uniform(0, 0.9 * longest_s)
        while time.monotonic() - began < wait_s and batch.poll() is None:
            time.sleep(0.01)
        found = set(victims(batch.pid, self.who))
        time.sleep(BECOMES_S)
        found = sorted(found & set(victims(batch.pid, self.who)))
        if not found:
            batch.wait()
            subprocess.run(["rm", "-rf", self.out / name], check=True)
            return None
        pid, program = draw.choice(found)
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        after_s, status = time.monotonic() - began, batch.wait()
        ended = time.monotonic()
        while self.left() and time.monotonic() < ended + LEAVES_S:
            time.sleep(0.02)
        return (
            f"{program} killed after {after_s:.1f} s, status {status},"
            f" {len(self.left())} left {time.monotonic() - ended:.2f} s later"
        )


def victims(pid, who):
    """[(pid, program)] of the processes of a batch that are to be killed, while it has any at
    work."""
    # not what it starts, as git
    workers = [(one, "worker") for one in children(pid) if words(one) == words(pid)]
    return workers + [(pid, "batch")] * (who == "any" and bool(workers))


def children(pid):
    """Pids of the children of a process."""
    found = []
    for listed in Path(f"/proc/{pid}/task").glob("*/children"):  # of every thread
        try:
            found += map(int, listed.read_text().split())
        except OSError:  # ended meanwhile
            pass
    return found


def words(pid):
    """The command line of a process, empty of one that has ended."""
    try:
        return (
            Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        )
    except OSError:
        return ""


def tables(folder):
    """{name: content} of the tables of a study, or of the answer and patterns of a claim."""
    found = (*folder.glob("tables/*.csv"), *folder.glob("claim.json"), *folder.glob("patterns/*"))
    return {path.name: path.read_bytes() for path in found}


if __name__ == "__main__":
    sys.exit(main())
