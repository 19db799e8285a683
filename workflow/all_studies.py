"""Every study of a folder, one after the other, then the figures and the verdict; `run_all.sh all` starts this.

    all_studies.py STUDIES [-j N] [--out DIR] [--solver yade|reference|both] [--slurm] [--remake]
                   [--cores N] [--shard RUNS] [--keep all|summary]

Each goes into DIR/NAME.  One that fails stops no other; one that has no run for the solver is passed over.
Exit status: the worst of the studies' (`batch.py`), the figures' and the verdict's; 130 at once when interrupted.
"""

from damage.start import EXIT_INTERRUPTED, begin, leave

if __name__ == "__main__":
    begin()  # before what takes its time to import

import argparse
import signal
import subprocess
import sys
from pathlib import Path

from shared import ROOT, end_with_parent

from damage.errors import InputError
from damage.studies.definition import load_study


def main():
    """Run all studies; returns the exit status."""
    parser = argparse.ArgumentParser(prog="all_studies.py", description=__doc__.splitlines()[0])
    parser.add_argument("studies", type=Path)
    parser.add_argument("-j", dest="jobs", default="1")
    parser.add_argument("--out", type=Path, default=ROOT / "results")
    parser.add_argument("--solver", default="yade")
    for option in ("--slurm", "--remake"):
        parser.add_argument(option, action="store_true")
    for option in ("--cores", "--shard", "--keep"):
        parser.add_argument(option)
    asked = parser.parse_args()
    ended = {}
    for path in sorted(asked.studies.glob("*.toml")):
        try:
            name = load_study(path, asked.solver, ROOT).name
        except InputError as error:
            print(f"passed over: {error}", flush=True)
            continue
        words = ["-j", asked.jobs, "--out", asked.out / name, "--solver", asked.solver]
        flags = [f"--{name}" for name in ("slurm", "remake") if getattr(asked, name)]
        words += [word for name in ("cores", "shard", "keep") if getattr(asked, name)
                  for word in (f"--{name}", getattr(asked, name))]
        ended[name] = run(ROOT / "workflow/batch.py", path, *words, *flags)
        if ended[name] == EXIT_INTERRUPTED:
            return EXIT_INTERRUPTED
    return conclude(asked.out, ended)


def conclude(out, ended):
    """Draw the figures and print the verdict of the results, and name the studies that failed."""
    if not ended:
        print("error: no study has a run for this solver; choose another", file=sys.stderr)
        return 2
    print("figures and verdict", flush=True)
    drawn = run("-m", "paper", "figures", out, "--out", out / "figures", "--records", ROOT / "records")
    judged = run("-m", "paper", "verdict", out, "--markdown", out / "tables" / "verdict.md")
    for name, status in ended.items():
        if status != 0:
            print(f"study {name}: FAILED, status {status}; see the logs in {out / name / 'logs'}", file=sys.stderr)
    return max(drawn, judged, *ended.values())


def run(*words):
    """Exit status of a Python program of this repository; an interrupt is its own to answer."""
    with subprocess.Popen([sys.executable, *map(str, words)],
                          preexec_fn=lambda: end_with_parent(signal.SIGTERM)) as program:
        while True:
            try:
                status = program.wait()
            except KeyboardInterrupt:
                continue
            return EXIT_INTERRUPTED if status < 0 else status


if __name__ == "__main__":
    leave(main())
