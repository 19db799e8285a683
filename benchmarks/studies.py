"""Runs an hour of studies on this machine's cores, as `./run_all.sh` computes them, in turn with
another checkout.

    python3 benchmarks/studies.py                       # this checkout alone, about 6 minutes
    python3 benchmarks/studies.py --old OLD --rounds 2  # OLD: the folder of another checkout
    python3 benchmarks/studies.py --account softening   # profile of eight runs in a process; bytes
                                                        # of a run

A time is that of the clock from the start of the command to its last table, with `--keep summary`
and a process for each core; other programs should rest.  A first study of each checkout, which is
not counted, compiles, or loads what is compiled.  Each checkout chooses its time step, as for its
users.
"""

import argparse
import contextlib
import cProfile
import io
import json
import os
import pstats
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.applications.studies.records import record_of
from damage.history.in_memory import HistoryInMemory
from damage.reference.session import run_references

SOFTENING = "walls/variants/symmetric_softening.py"
BRITTLE = "walls/symmetric.py"
DRAWN = {"rest": 0.1, "strength-cov": 0.3}
RECORD = {
    "record": "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv",
    "window": [18.2, 22.1],
    "scale": 1.5,
    **DRAWN,
}
LIFE = {"address": "studies/addresses/garsthuizen.toml", **DRAWN}
DEFORMABLE = {"bricks": "deformable", "contacts": "gauss"}
CASES = {
    "softening": (SOFTENING, RECORD, "samples", 64),
    "lives": (SOFTENING, LIFE, "lives", 16),
    "deformable": (SOFTENING, {**RECORD, **DEFORMABLE}, "samples", 16),
    "brittle": (BRITTLE, RECORD, "samples", 64),
}
"""{case: (wall file, options, what a study calls the runs of a point, their number)}."""


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--old", type=Path)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--account", choices=CASES)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        if asked.account:
            print_account(Path(name), asked.account)
        else:
            checkouts = [asked.old.resolve(), ROOT] if asked.old else [ROOT]
            print_runs_an_hour(Path(name), checkouts, asked.cases, asked.rounds)


# --- runs an hour ---------------------------------------------------------------------------------


def print_runs_an_hour(folder, checkouts, cases, rounds):
    """Print a line for each case: runs an hour of the checkouts, their least and most, and the
    ratios of the rounds."""
    for case in cases:
        for checkout in checkouts:
            time_study(folder, checkout, case, 1)
        hourly = []
        for number in range(rounds):
            turn = checkouts if number % 2 == 0 else checkouts[::-1]
            found = {
                checkout: 3600 * CASES[case][3] / time_study(folder, checkout, case, CASES[case][3])
                for checkout in turn
            }
            hourly.append([found[checkout] for checkout in checkouts])
        texts = [spread(of_checkout, 0) for of_checkout in zip(*hourly)]
        if len(checkouts) > 1:
            texts.append("new to old " + spread([new / old for old, new in hourly], 2))
        print(f"{case}, {CASES[case][3]} runs: runs an hour {'; '.join(texts)}", flush=True)


def spread(values, digits):
    """Median and range of some numbers, as text."""
    return (
        f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to"
        f" {max(values):.{digits}f})"
    )


def time_study(folder, checkout, case, runs):
    """Clock time of a study of so many runs of a case [s]."""
    wall, options, word, _ = CASES[case]
    out = folder / "out"
    study = folder / f"{case}.toml"
    options = ", ".join(f"{name} = {json.dumps(value)}" for name, value in options.items())
    study.write_text(
        f'name = "{case}"\ntitle = "{case}"\npictures = "none"\n[[runs]]\nwall = "{wall}"\n'
        f"options = {{ {options} }}\n{word} = {runs}\n",
        encoding="utf-8",
    )
    shutil.rmtree(out, ignore_errors=True)
    start = time.monotonic()
    subprocess.run(
        [
            sys.executable,
            "-m",
            "damage",
            "study",
            study,
            "-j",
            str(os.cpu_count()),
            "--out",
            out,
            "--solver",
            "reference",
            "--keep",
            "summary",
        ],
        cwd=checkout,
        check=True,
        stdout=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(checkout), "OPENBLAS_NUM_THREADS": "1"},
    )
    return time.monotonic() - start


# --- where the time goes --------------------------------------------------------------------------


def print_account(folder, case, runs=8):
    """Print the profile of runs in one process, as a study with `--keep summary` computes them,
    then bytes of a run."""
    wall, options, _, _ = CASES[case]
    words = [
        str(word)
        for name, value in options.items()
        for word in (f"--{name}", *(value if isinstance(value, list) else [value]))
    ]
    os.chdir(ROOT)
    compute(folder, [wall, *words], 1, {})
    with cProfile.Profile() as profile:
        histories = {str(k): HistoryInMemory for k in range(runs)}
        compute(folder, [wall, *words], runs, histories)
        records = [
            json.dumps(record_of(kept.history(), name, case)) for name, kept in histories.items()
        ]
    pstats.Stats(profile).sort_stats("tottime").print_stats(25)
    size = (folder / "0.h5").stat().st_size
    print(
        f"a history has {size / 1e6:.2f} MB, a record"
        f" {statistics.mean(map(len, records)) / 1e3:.1f} kB"
    )


def compute(folder, words, runs, histories):
    """Compute runs side by side; histories: {name: HistoryInMemory} of those that write no file."""
    draw = "--life" if "--address" in words else "--strength-seed"
    with contextlib.redirect_stdout(io.StringIO()):
        for name, status in run_references(
            (
                (
                    str(k),
                    [
                        *words,
                        draw,
                        str(k + 1),
                        "--no-pictures",
                        "--overwrite",
                        "--out",
                        str(folder / f"{k}.h5"),
                    ],
                )
                for k in range(runs)
            ),
            histories,
        ):
            if status:
                sys.exit(f"error: run {name} ended with exit status {status}")


if __name__ == "__main__":
    main()
