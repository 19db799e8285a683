"""Equal events on a wall whose piers have a straight or a stepped crack at their foot: how far the
wall walks.

    python3 -m paper stepped_cracks [--events 4]

All other joints are too strong to fail.  A pier rocks about either end of its crack.  Where one end
is higher by h, a rotation θ moves the end that is lifted sideways by h θ, to the side of the lower
one whichever way the pier rocks.  If it lands there, the pier walks down the steps; on a straight
crack it has no such direction.
"""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from damage.wall.file import load_wall
from paper.bench import BGAR, Bench, arguments, option, print_row, print_table

LENGTH, PIER = 4.05, 1.0125  # [m]
TWO_STEPS = [
    (0.0, 0.15),
    (0.5625, 0.15),
    (0.5625, 0.075),
    (0.675, 0.075),
    (0.675, 0.0),
    (PIER, 0.0),
]
ONE_STEP = [(LENGTH - PIER, 0.075), (3.375, 0.075), (3.375, 0.0), (LENGTH, 0.0)]
"""Cracks (x, z) [m] down to the right at the foot of the left and of the right pier, as a shaken
wall has them."""


def mirrored(line):
    return [(round(LENGTH - x, 4), z) for x, z in reversed(line)]


CRACKS = {
    "straight": [[(0.0, 0.0), (PIER, 0.0)], [(LENGTH - PIER, 0.0), (LENGTH, 0.0)]],
    "down to the right": [TWO_STEPS, ONE_STEP],
    "down to the left": [mirrored(ONE_STEP), mirrored(TWO_STEPS)],
    "down to the opening": [TWO_STEPS, mirrored(TWO_STEPS)],
}


def run(folder, cracks, events):
    """The History of a wall with these cracks, slightly open, under so many equal events: BGAR HGE
    x 1.4, 45 mm/s."""
    rows = [
        (number, point, x, z, 0.05 if point < len(line) else None)
        for number, line in enumerate(cracks)
        for point, (x, z) in enumerate(line, start=1)
    ]
    pd.DataFrame(rows, columns=["crack", "point", "x_m", "z_m", "width_mm"]).to_csv(
        folder / "cracks.csv", index=False
    )
    wall = load_wall("symmetric")
    wall = replace(wall, joint=replace(wall.joint, tensile_strength=9e6, cohesion=9e6))
    motion = [
        "--record",
        BGAR,
        "--scale",
        "1.4",
        "--window",
        "18.7",
        "20.9",
        "--rest",
        "0.1",
        "--sequence",
        ",".join("1" * events),
    ]
    return Bench(folder).run(wall, ["--cracked", folder / "cracks.csv", *motion])


def offsets(history, left, right):
    """Offset of the bed joints between two places x [m] that slipped most, at the end of each event
    [mm], to the right positive."""
    joints, shock = history.joints, history.series["shock"].to_numpy()
    last = np.flatnonzero(np.diff(shock, append=-1))
    bed = np.flatnonzero(
        (joints["kind"].astype(str) == "bed")
        & joints["x_m"].between(left, right)
        & (joints["z_m"] < 0.2)
    )
    offset = 1e3 * history.offset_m[np.ix_(last, bed)]
    return offset[:, np.abs(offset[-1]).argmax()]


def main():
    events = arguments(__doc__, option("--events", type=int, default=4)).events
    print_table("cracks", "largest drift [%]", "left pier has walked [mm]", "right pier [mm]")
    for name, cracks in CRACKS.items():
        with TemporaryDirectory() as folder:
            history = run(Path(folder), cracks, events)
            walked = [
                ", ".join(f"{value:+.2f}" for value in offsets(history, *pier))
                for pier in ((0.0, PIER), (LENGTH - PIER, LENGTH))
            ]
            drift = 100 * history.series["drift_ratio"].abs().max()
        print_row(name, f"{drift:.2f}", *walked)
