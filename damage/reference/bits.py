"""Runs whose bits are published: one of every kind, and the digests that any machine computes from
their histories.

The table `damage/data/bits/bits.csv` has a row for each quantity of each run: the first digits of
the SHA-256 of its values.  `python3 -m damage check-bits` compares this machine with it;
`benchmarks/same_bits.py renew` writes it anew.
"""

import hashlib
import io
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.errors import RunError, heard
from damage.files import shipped_path
from damage.history.in_memory import HistoryInMemory
from damage.provenance import UNKNOWN, commit
from damage.reference.session import run_references

FOLDER = Path(__file__).parents[1] / "data" / "bits"
TABLE = FOLDER / "bits.csv"
COLUMNS = ["run", "quantity", "digest"]
DIGITS = 12
MEMBERS = 8
"""Walls that step side by side in a case of members."""


class Case(NamedTuple):
    """A run: its wall, words of its options; is_long: whether it takes more than a few seconds;
    members: whether it is MEMBERS runs with other seeds, which step together."""

    wall: str
    words: str
    is_long: bool = False
    members: bool = False


SYMMETRIC = "walls/symmetric.py"
SMALL = "walls/variants/small.py"
HOUSE = "walls/terrace_end.toml"
SOFT = "walls/variants/symmetric_softening.py"
CLAY = "walls/variants/comp2_4_split_and_crush.py"
STRIP = "damage/data/bits/strip.toml"
CRUSHING = "damage/data/bits/crushing.toml"
RECORD = "--record BGAR_HGE"
SHAKEN = "--harmonic 0.06 0.6 --rest 0.2"
CASES = {
    "harmonic": Case(SYMMETRIC, "--harmonic 0.2 0.05 --rest 0.2"),
    "record": Case(SYMMETRIC, f"{RECORD} --window 18.7 20.7 --scale 2.5 --rest 0.1"),
    "interpolated": Case(SMALL, f"{RECORD} --window 18.7 19.7 --scale 20 --rest 0.1"),
    "filtered": Case(
        SMALL, f"{RECORD} --window 18.7 19.7 --scale 20 --baseline 2 --band 0.5 30 --rest 0.1"
    ),
    "vertical": Case(
        SMALL, f"{RECORD} --vertical BGAR_HGE --window 18.7 19.7 --scale 20 --rest 0.1"
    ),
    "sequence": Case(SMALL, "--harmonic 0.06 0.6 --rest 0.3 --sequence 1,0.6"),
    "free": Case(SMALL, "--free-vibration --rest 0.2"),
    "pushover": Case(SMALL, "--pushover 0.1"),
    "cyclic": Case(SMALL, "--cyclic 0.02,0.05 --cycles 1"),
    "settled": Case(SMALL, f"--settle hogging --distortion 1/500 {SHAKEN}"),
    "tilted": Case(SMALL, "--settle tilt --distortion 1/200"),
    "soil": Case(SMALL, f"--soil 1e9 {SHAKEN}"),
    "falling": Case(SMALL, "--harmonic 0.1 1.5 --rest 0.2"),
    "drawn": Case(SMALL, f"--strength-cov 0.3 --strength-seed 7 {SHAKEN}"),
    "eight": Case(SMALL, f"--scatter 0.1 {SHAKEN}", members=True),
    "deformable": Case(
        SMALL, "--bricks deformable --contacts gauss --harmonic 0.06 0.8 --rest 0.1"
    ),
    "restrained": Case(STRIP, "--harmonic 0.06 0.6 --rest 0.1"),
    "crushed": Case(CRUSHING, "--pushover 0.1"),
    "spread": Case(CRUSHING, "--pushover 0.05 --floor-share 0.525 0.4 --floor-share 0.6 0.6"),
    "scaled": Case(SOFT, "--harmonic 0.2 0.05 --rest 0.2"),
    "softening": Case(SOFT, "--harmonic 0.2 0.05 --rest 0.1 --mass-scaling none", is_long=True),
    "crushing": Case(CLAY, "--pushover 0.05", is_long=True),
    "house": Case(HOUSE, "--harmonic 0.1 0.2 --rest 0.2", is_long=True),
    "life": Case(
        SYMMETRIC,
        "--address studies/addresses/garsthuizen.toml --life 1 --strength-cov 0.2",
        is_long=True,
    ),
    "pushed": Case(SYMMETRIC, "--pushover 0.05 --boundary fixed", is_long=True),
}


def digests(names):
    """{(run, quantity): digest} of the cases of these names, which run one after the other, members
    together."""
    with TemporaryDirectory(prefix="masonry-damage-") as folder:
        return {
            (name, quantity): digest
            for name in names
            for quantity, digest in _digests(CASES[name], Path(folder) / name).items()
        }


def _digests(case, out):
    given = [str(shipped_path(word) or word) for word in (case.wall, *case.words.split())]
    words = [*given, "--no-pictures", "--quiet"]
    seeds = [["--seed", str(seed)] for seed in range(MEMBERS)] if case.members else [[]]
    lines = {str(k): [*words, *seed, "--out", f"{out}_{k}.h5"] for k, seed in enumerate(seeds)}
    histories = dict.fromkeys(lines, HistoryInMemory)
    # the same record stands for the vertical component, which is warned of
    with redirect_stdout(io.StringIO()), heard():
        failed = [name for name, status in run_references(lines.items(), histories) if status]
    if failed:
        raise RunError(
            f"{case.wall} {case.words}: the run failed (member {failed[0]}); look at the messages"
            " above"
        )
    return digests_of([histories[name].history() for name in lines])


def digests_of(histories):
    """{quantity: digest} of histories, one after the other."""
    runs = [values_of(history) for history in histories]
    return {quantity: _digest([values[quantity] for values in runs]) for quantity in runs[0]}


def values_of(history):
    """{quantity: arrays} of a History whose digests are published: drift ratio and base motion over
    time, energies, failures, openings, slips and states of all joints at the end."""
    series = history.series
    events = history.events
    base = [name for name in series if name.startswith("base_acc")]
    energies = [name for name in series if name.endswith("_energy_j")]
    return {
        "base": [series[base]],
        "drift": [series["time_s"], series["drift_ratio"]],
        "energies": [series[energies]],
        "events": [events[["time_s", "joint", "opening_m", "slip_m"]], events["kind"].astype(str)],
        "joints": [
            getattr(history, name)[-1] for name in ("opening_m", "offset_m", "broken", "at_limit")
        ],
    }


def _digest(arrays):
    """First digits of the SHA-256 of the values of arrays, one after the other, in one byte
    order."""
    digest = hashlib.sha256()
    for array in (np.asarray(value) for values in arrays for value in values):
        digest.update(
            " ".join(array.tolist()).encode()
            if array.dtype == object
            else np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
        )
    return digest.hexdigest()[:DIGITS]


def published():
    """{(run, quantity): digest} of the table."""
    table = (
        pd.read_csv(TABLE, comment="#", dtype=str)
        if TABLE.is_file()
        else pd.DataFrame(columns=COLUMNS)
    )
    return {(row.run, row.quantity): row.digest for row in table.itertuples()}


def differing(digests, known):
    """{run: its quantities whose digests differ from known ones}; digests: of `digests`, known: of
    `published`."""
    different = {}
    for (name, quantity), digest in digests.items():
        if known.get((name, quantity)) != digest:
            different.setdefault(name, []).append(quantity)
    return different


def verdict(digests, known):
    """One line: how many runs have the published bits on this machine, and what may be the cause
    where some have not; digests: of `digests`, known: of `published`."""
    runs = {name for name, _ in digests}
    different = differing(digests, known)
    line = (
        f"published histories: {len(runs) - len(different)} of {len(runs)} have the same bits on"
        " this machine"
    )
    if not different:
        return line
    made_by = commit()
    why = (
        "files differ from those of the last commit, which may be the cause"
        if "changed" in made_by
        else (
            "the program may have been changed"
            if made_by == UNKNOWN
            else (
                "the program is as committed: please report this machine and its versions (python3"
                " -m damage info of a run)"
            )
        )
    )
    return f"{line}, others not ({', '.join(different)}): {why}"
