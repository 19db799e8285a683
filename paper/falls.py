"""Falls of one wall in both solvers: when the first brick fell, since when the heap rests,
overlaps, and a picture.

    python3 -m paper falls --out docs/pictures/heaps.png        # a small dry spandrel, minutes
    W="walls/symmetric.py --lintel none --harmonic 0.2 0.1 --new-contacts --after-fall
       --no-pictures"
    ./yade $W --out yade.h5; python3 -m damage reference $W --out reference.h5
    python3 -m paper falls yade.h5 reference.h5 --out heaps.png

The first brick has fallen once it is lower by half its height, by snapshots 10 ms (spandrel) or 20
ms apart, interpolated.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from damage.draw import style
from damage.errors import InputError
from damage.history.reader import read_history
from damage.linear.modes import natural_modes
from damage.run.monitor import fastest_fallen, lowest_places
from damage.run.settings import RESTS_BELOW_M_S
from damage.wall.geometry import body_corners, body_table
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Opening, Wall
from paper.bench import REPOSITORY, arguments, option
from yade_scripts import COMMAND

SECONDS = 3.0
"""Time for which the spandrel is followed [s]."""
INTERVAL_S = 0.01
"""Time between two looks at the spandrel [s]."""


def main():
    options = arguments(
        __doc__,
        option("histories", nargs="*", metavar="FILE.h5"),
        option("--out", metavar="FILE.png", required=True),
    )
    try:
        falls = [of_history(read_history(path)) for path in options.histories] or [
            in_yade(),
            in_reference(),
        ]
    except InputError as error:
        sys.exit(f"error: {error}")
    for fall in falls:
        rests_s = fall.at[1 + np.flatnonzero(speeds(fall) > RESTS_BELOW_M_S)[-1]]
        print(
            f"{fall.solver}: first brick falls at {first_fall(fall):.4f} s, all rest since"
            f" {rests_s:.2f} s; largest overlaps: "
            + ", ".join(f"{what} {1e3 * depth:.2f} mm" for what, depth in overlaps(fall).items())
        )
    heaps(falls).savefig(options.out, dpi=130)


def fall_of(solver, layout, at, motion, energy_j=None):
    """A wall that falls: solver; layout; bodies as of `body_table`; at: (n,) [s]; displacement: (n,
    n_bodies, 3); energy_j: (n,) elastic, kinetic and of gravity, or None."""
    return SimpleNamespace(
        solver=solver,
        layout=layout,
        bodies=body_table(layout),
        at=np.asarray(at),
        displacement=np.asarray(motion, float),
        energy_j=energy_j,
    )


def of_history(history):
    layout = lay_out(Wall.from_dict(history.parameters["wall"]), history.model)
    return fall_of(history.solver, layout, history.snapshot_time_s, history.displacement)


def spandrel():
    """Layout of three dry courses over an opening without a lintel, as in
    tests/yade/checks/fallen_wall.py."""
    joint = Joint(tensile_strength=0.0, cohesion=0.0)
    return lay_out(
        Wall("spandrel", 1.8, 0.9, [Opening(0.45, 0.9, 0.675)], precompression=0.0, joint=joint),
        ModelOptions(lintel="none"),
    )


def in_yade():
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "fall.npz"
        check = REPOSITORY / "tests/yade/checks/fallen_wall.py"
        subprocess.run(
            [*COMMAND, check, "interior", str(SECONDS), out], check=True, stdout=subprocess.DEVNULL
        )
        with np.load(out) as found:
            return fall_of("yade", spandrel(), found["time_s"], found["place"], found["energy_j"])


def in_reference(seconds=SECONDS):
    from damage.reference.solver import ReferenceSolver

    layout = spandrel()
    wall = ReferenceSolver(
        layout, 0.6 * natural_modes(layout).critical_time_step_s, new_contacts=True
    )
    at = [0.0]
    motion = [wall.displacement]
    while at[-1] < seconds:
        wall.run(round(INTERVAL_S / wall.time_step))
        at.append(wall.step * wall.time_step)
        motion.append(wall.displacement)
    return fall_of("reference", layout, at, motion)


def first_fall(fall):
    """When the first brick is lower by half its height [s]."""
    lowest = lowest_places(fall.layout)
    over = (fall.displacement[:, : len(lowest), 1] - lowest).min(axis=1)
    after = int(np.argmax(over < 0))
    return float(np.interp(0.0, -over[after - 1 : after + 1], fall.at[after - 1 : after + 1]))


def speeds(fall):
    """Speeds of the fastest fallen brick between one instant and the next, (n - 1,) [m/s]."""
    return np.array(
        [
            fastest_fallen(fall.layout, now, before, interval)
            for now, before, interval in zip(
                fall.displacement[1:], fall.displacement, np.diff(fall.at)
            )
        ]
    )


def overlaps(history):
    """{"bricks", "caps", "ground": largest overlap [m]} of a History over all snapshots: of two
    bricks, of one and a cap, of either and the ground.  Rectangles overlap by the least of what
    they share along the normals of their sides."""
    is_cap = history.bodies["course"].to_numpy() < 0
    found = {"bricks": 0.0, "caps": 0.0, "ground": 0.0}
    for motion in history.displacement:
        places = body_corners(history.bodies, motion.astype(float))
        low = places.min(axis=1)
        high = places.max(axis=1)
        found["ground"] = max(found["ground"], -low[:, 1].min())
        for one in range(len(places)):
            near = np.all((low[one + 1 :] < high[one]) & (high[one + 1 :] > low[one]), axis=1)
            for other in one + 1 + np.flatnonzero(near):
                what = "caps" if is_cap[one] or is_cap[other] else "bricks"
                found[what] = max(found[what], depth(places[one], places[other]))
    return found


def depth(one, other):
    """Overlap of two rectangles [m], zero where they are apart; corners: (4, 2) each."""
    shared = np.inf
    for corner in (one, other):
        for side in np.diff(corner[:3], axis=0):
            normal = np.array([-side[1], side[0]]) / np.hypot(*side)
            here = one @ normal
            there = other @ normal
            shared = min(shared, min(here.max(), there.max()) - max(here.min(), there.min()))
    return max(shared, 0.0)


@style.styled
def heaps(falls):
    """Figure of the heaps at the last instants, side by side in true scale, over the outlines of
    the wall."""
    figure, axes = plt.subplots(
        1, len(falls), figsize=(2 * style.COLUMN_WIDTH, 0.62 * style.COLUMN_WIDTH), sharey=True
    )
    for ax, fall in zip(axes, falls):
        caps = fall.bodies["course"].to_numpy() < 0
        before, now = (
            body_corners(fall.bodies, motion)
            for motion in (0 * fall.displacement[-1], fall.displacement[-1])
        )
        for corners, face, edge in (
            (before, "none", "0.85"),
            (now[~caps], style.BRICK_COLOUR, style.DARK),
            (now[caps], style.CAP_COLOUR, style.DARK),
        ):
            ax.add_collection(
                PolyCollection(corners, facecolors=face, edgecolors=edge, linewidths=0.4)
            )
        ax.axhline(0, color=style.DARK, lw=0.6)
        ax.set(
            aspect="equal",
            xlim=(before[..., 0].min() - 0.1, before[..., 0].max() + 0.1),
            xlabel="x [m]",
            ylim=(-0.05, before[..., 1].max() + 0.05),
            title=f"{fall.solver}, {fall.at[-1]:.1f} s",
        )
    axes[0].set_ylabel("z [m]")
    figure.tight_layout()
    return figure
