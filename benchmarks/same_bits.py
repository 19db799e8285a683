"""Did a change leave every value of the histories as it was?  A fixed set of runs, compared bit for
bit.

    python3 benchmarks/same_bits.py run OLD                          # in the old tree; --yade for
                                                                     # those in YADE (hours: 0.1)
    python3 benchmarks/same_bits.py run NEW                          # in the new tree, on the same
                                                                     # machine
    python3 benchmarks/same_bits.py compare OLD NEW                  # exit status 1 where any value
                                                                     # differs
    python3 benchmarks/same_bits.py compare OLD NEW --old-tree TREE  # whose files this tree does
                                                                     # not read
    python3 benchmarks/same_bits.py compare A.h5 B.h5 --tolerance 1e-12
    python3 benchmarks/same_bits.py digests FOLDER                   # of its histories, of YADE's,
                                                                     # too
    python3 benchmarks/same_bits.py renew                            # the published digests; prints
                                                                     # the runs that moved
    python3 benchmarks/same_bits.py settings                         # are they the same as other
                                                                     # processors and libraries
                                                                     # compute?

What `read_history` returns is compared, however the files hold it.  What the second lacks is a
difference; what it has more is listed and is none (the schema only adds).  Tables of members: but
for columns of origin.
`renew` writes `damage/data/bits/bits.csv` anew (`damage.reference.bits`): a commit that moves
values names the runs in CHANGELOG.md.
`settings` runs `check-bits --long` as if this processor had less, each with machine code of its
own, minutes each. --tolerance: share of an array's largest value up to which floating-point values
may differ; events still have to come in the same order.
"""

import argparse
import os
import pickle
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[1]
TREE = "SAME_BITS_TREE"
sys.path.insert(0, os.environ.get(TREE, str(ROOT)))

import damage.applications  # noqa: F401, options of the runs
from damage.history.reader import read_history
from damage.reference import bits

NUMPY = "AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR"
SETTINGS = {
    "as it comes": {},
    "numba for Haswell": {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": ""},
    "numba for any x86-64": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "numpy without AVX-512": {"NPY_DISABLE_CPU_FEATURES": NUMPY},
    "numpy without FMA": {"NPY_DISABLE_CPU_FEATURES": f"{NUMPY} AVX2 FMA3"},
    "C library without FMA": {
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA"
    },
    "OpenBLAS for Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "OpenBLAS for Nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},
}
"""{name: environment} by which a program computes as other processors do; numpy says which features
it knows."""
TABLES = "joints", "bodies", "supports", "series", "events", "static_stage"
ARRAYS = (
    "opening_m",
    "slip_m",
    "offset_m",
    "broken",
    "at_limit",
    "crushed",
    "ended",
    "snapshot_time_s",
    "displacement",
    "support_displacement",
    "support_force",
    "joint_stress_pa",
)
"""Fields of a History."""
ORIGIN = "commit", "model_digest", "measures_digest"
BOTH = "harmonic", "pushover", "sequence", "restrained", "crushed", "spread"
IN_YADE = {name: bits.CASES[name] for name in BOTH} | {
    "house": bits.Case("houses/box.toml", "--harmonic 0.05 2 --cycles 1 --rest 0.02"),
    "softened": bits.Case(
        "walls/variants/small_softening.py", "--harmonic 0.1 0.4 --cycles 1 --rest 0.1"
    ),
}
"""{name: Case}; houses run in YADE alone."""


def run(folder, yade):
    """Simulate the published cases into `folder` by the reference solver, or IN_YADE by YADE on a
    thread."""
    solver = [ROOT / "yade", "-n", "-j1"] if yade else [sys.executable, "-m", "damage", "reference"]
    for name, case in (IN_YADE if yade else bits.CASES).items():
        out = folder.resolve() / f"{name}_{'yade' if yade else 'reference'}.h5"
        members = ["--members", str(bits.MEMBERS)] if case.members else []
        subprocess.run(
            [
                *solver,
                case.wall,
                *case.words.split(),
                *members,
                "--out",
                out,
                "--no-pictures",
                "--overwrite",
            ],
            cwd=ROOT,
            check=True,
        )


def values(path):
    """{name: array} of what `read_history` returns: columns of tables, samples of all joints, the
    index."""
    history = read_history(path)
    tables = {name: getattr(history, name) for name in TABLES} | {"index": history.index()}
    columns = {
        f"{name}/{column}": table[column] for name, table in tables.items() for column in table
    }
    found = {
        name: np.array(column.astype(str) if column.dtype == "category" else column)
        for name, column in columns.items()
    }
    found |= {
        name: np.array(rows) for name in ARRAYS if (rows := getattr(history, name)) is not None
    }
    found |= {f"static/{name}": np.array(value) for name, value in history.static.items()}
    return found | {
        "status": np.array(history.status),
        "collapsed_at_s": np.array(history.collapsed_at_s, float),
    }


def values_by(tree, path):
    """The same, read by the software in another tree."""
    done = subprocess.run(
        [sys.executable, __file__, "values", path],
        env=os.environ | {TREE: str(tree)},
        check=True,
        stdout=subprocess.PIPE,
    )
    return pickle.loads(done.stdout)


def members(path):
    """A table of members without its columns of origin; None where there is none."""
    return pd.read_csv(path).drop(columns=list(ORIGIN), errors="ignore") if path.is_file() else None


def differences(old, new, tolerance=0.0):
    """Differences of the `values` of two histories, a line an array: a list of str."""
    found = [f"{name}: gone" for name in sorted(old.keys() - new.keys())]
    for name in sorted(old.keys() & new.keys()):
        a = np.asarray(old[name])
        b = np.asarray(new[name])
        if a.shape != b.shape or a.dtype != b.dtype:
            found.append(f"{name}: {a.dtype}{a.shape} became {b.dtype}{b.shape}")
        elif a.dtype.kind in "UO" and not np.array_equal(a, b):
            found.append(f"{name}: other words")
        elif not np.array_equal(a, b, equal_nan=a.dtype.kind == "f"):
            size = float(np.nanmax(np.abs(a))) if a.dtype.kind == "f" else 0.0
            gap = float(np.nanmax(np.abs(a.astype(float) - b.astype(float))))
            same_gaps = a.dtype.kind != "f" or np.array_equal(np.isnan(a), np.isnan(b))
            if not (same_gaps and gap <= tolerance * size):
                found.append(f"{name}: differs by up to {gap:.3g}, largest value {size:.3g}")
    return found


def compare(old, new, tolerance, old_tree):
    """Compare two histories or two folders of them; the exit status.  old_tree: that reads the old
    ones, None: this."""
    pairs = (
        [(old, new)]
        if old.is_file()
        else [(path, new / path.name) for path in sorted(old.glob("*.h5"))]
    )
    if not pairs:
        sys.exit(f"error: {old} holds no history (.h5); expected a folder that `run` filled")
    different = False
    for first, second in pairs:
        if not second.is_file():
            print(f"{second.name}: missing beside {first}")
            different = True
            continue
        before = values_by(old_tree, first) if old_tree else values(first)
        now = values(second)
        found = differences(before, now, tolerance)
        more = sorted(now.keys() - before.keys())
        print(
            f"{second.name}: "
            + (f"equal in {len(before)} arrays" if not found else f"{len(found)} arrays differ")
            + (f"; new: {', '.join(more)}" if more else ""),
            *found,
            sep="\n  ",
        )
        different |= bool(found)
    for table in [] if old.is_file() else sorted(old.glob("*.csv")):  # of members
        first = members(table)
        second = members(new / table.name)
        same = second is not None and first.equals(second.reindex(columns=first.columns))
        print(f"{table.name}: {'equal' if same else 'differs'}")
        different |= not same
    return int(different)


def renew():
    """Write the published digests anew; prints what moved."""
    found = bits.digests(bits.CASES)
    moved = bits.differing(found, bits.published())
    write_table(found)
    print(*(f"{name}: {', '.join(quantities)}" for name, quantities in moved.items()), sep="\n")
    print(f"{bits.TABLE}: {len(moved)} of {len(bits.CASES)} runs moved")


def write_table(found):
    """Replace the table; found: of `digests` of all cases."""
    rows = [(*place, digest) for place, digest in found.items()]
    head = (
        "# Digests of the histories of damage/reference/bits.py; written by benchmarks/same_bits.py"
        " renew\n"
    )
    bits.TABLE.write_text(
        head + pd.DataFrame(rows, columns=bits.COLUMNS).to_csv(index=False), encoding="utf-8"
    )


def settings(python):
    """Compare with the published digests in each of SETTINGS, by a Python; the exit status."""
    worst = 0
    for name, environment in SETTINGS.items():
        with TemporaryDirectory() as cache:
            done = subprocess.run(
                [python, "-W", "ignore", "-m", "damage", "check-bits", "--long"],
                cwd=ROOT,
                text=True,
                capture_output=True,
                env=os.environ | environment | {"NUMBA_CACHE_DIR": cache},
            )
        print(
            f"{name}: {(done.stdout.splitlines() or done.stderr.splitlines() or ['nothing'])[-1]}",
            flush=True,
        )
        worst = max(worst, done.returncode)
    return worst


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True)
    running = commands.add_parser("run")
    running.add_argument("folder", type=Path)
    running.add_argument("--yade", action="store_true")
    comparing = commands.add_parser("compare")
    comparing.add_argument("old", type=Path)
    comparing.add_argument("new", type=Path)
    comparing.add_argument("--tolerance", type=float, default=0.0)
    comparing.add_argument("--old-tree", type=Path)
    commands.add_parser("values").add_argument(
        "path", type=Path, help="written to standard output, pickled"
    )
    digesting = commands.add_parser("digests")
    digesting.add_argument("folder", type=Path)
    commands.add_parser("renew")
    commands.add_parser("settings").add_argument(
        "--python", default=sys.executable, help="with other libraries"
    )
    parsed = parser.parse_args()
    if parsed.command == "run":
        parsed.folder.mkdir(parents=True, exist_ok=True)
        run(parsed.folder, parsed.yade)
        return 0
    if parsed.command == "digests":
        for path in sorted(parsed.folder.glob("*.h5")):
            for quantity, digest in bits.digests_of([read_history(path)]).items():
                print(f"{path.stem},{quantity},{digest}")
        return 0
    if parsed.command == "values":
        sys.stdout.buffer.write(pickle.dumps(values(parsed.path)))
        return 0
    if parsed.command == "settings":
        return settings(parsed.python)
    return (
        renew()
        if parsed.command == "renew"
        else compare(parsed.old, parsed.new, parsed.tolerance, parsed.old_tree)
    )


if __name__ == "__main__":
    sys.exit(main())
