"""The largest overlap of two bricks, of a brick and a cap, and of either with the ground, over all snapshots of runs.

    ./yade walls/symmetric.py --lintel none --harmonic 0.2 0.1 --new-contacts --after-fall --out heap.h5
    python3 paper/overlaps.py heap.h5 [MORE.h5 ...]

Two rectangles overlap by the least of what they share along the normals of their sides.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.errors import InputError
from damage.history.reader import read_history


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("histories", nargs="+", metavar="FILE.h5")
    for path in parser.parse_args().histories:
        try:
            history = read_history(path)
        except InputError as error:
            sys.exit(f"error: {error}")
        found = overlaps(history)
        print(f"{path}: until {history.snapshot_time_s[-1]:.2f} s,",
              ", ".join(f"{what} {1e3 * depth:.2f} mm" for what, depth in found.items()))


def overlaps(history):
    """{"bricks", "caps", "ground": largest overlap [m]} of a History."""
    is_cap = history.bodies["course"].to_numpy() < 0
    found = {"bricks": 0.0, "caps": 0.0, "ground": 0.0}
    for motion in history.displacement:
        places = corners(history.bodies, motion.astype(float))
        low, high = places.min(axis=1), places.max(axis=1)
        found["ground"] = max(found["ground"], -low[:, 1].min())
        for one in range(len(places)):
            near = np.all((low[one + 1:] < high[one]) & (high[one + 1:] > low[one]), axis=1)
            for other in one + 1 + np.flatnonzero(near):
                what = "caps" if is_cap[one] or is_cap[other] else "bricks"
                found[what] = max(found[what], depth(places[one], places[other]))
    return found


def corners(bodies, motion):
    """Corners of all bodies, moved by (n_bodies, 3) [m, m, rad]: (n_bodies, 4, 2) [m]."""
    half = bodies[["length_m", "height_m"]].to_numpy() / 2
    cosine, sine = np.cos(motion[:, 2]), np.sin(motion[:, 2])
    turned = np.array([[cosine, -sine], [sine, cosine]])
    centres = bodies[["x_m", "z_m"]].to_numpy() + motion[:, :2]
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return centres[:, None] + np.einsum("xyb,bcy->bcx", turned, half[:, None] * signs)


def depth(one, other):
    """Overlap of two rectangles [m], zero where they are apart; corners: (4, 2) each."""
    shared = np.inf
    for corner in (one, other):
        for side in np.diff(corner[:3], axis=0):
            normal = np.array([-side[1], side[0]]) / np.hypot(*side)
            here, there = one @ normal, other @ normal
            shared = min(shared, min(here.max(), there.max()) - max(here.min(), there.min()))
    return max(shared, 0.0)


if __name__ == "__main__":
    main()
