"""What a DIC field with noise shows of a simulation, beside what the simulation says:
docs/reference/crack-format.md.

    python3 -m damage reference walls/symmetric.py --harmonic 0.2 0.1 --no-pictures --out FILE.h5
    python3 -m paper dic_field FILE.h5 [--every-s 0.1] [--noise-mm 0.01]
"""

from pathlib import Path

import numpy as np

from damage.applications.cracks.crack_mapping import describe_level, map_cracks
from damage.applications.cracks.dic import Field, measure, patterns_of_fields, turned
from damage.history.reader import read_history
from damage.index import THRESHOLD
from damage.measure.cracks import cracks_at, psi
from damage.units import MILLIMETRE
from damage.wall.layout import lay_out
from paper.bench import arguments, option

PSI_FROM_MM = (0.02, 0.05, 0.1)


def sampled_field(layout, motion, level=1.0, spacing=0.01, noise=0.0, seed=0, drift_ratio=np.nan):
    """What DIC sees of bricks that move as `motion` (n_bodies, 3) [m, m, rad] says: a Field of
    points on a grid, each component with a normal error of `noise` [m]."""
    bodies = layout.bodies
    wall = layout.wall
    grid = np.stack(
        np.meshgrid(
            np.arange(spacing / 2, wall.length, spacing),
            np.arange(spacing / 2, wall.built_height, spacing),
        ),
        -1,
    ).reshape(-1, 2)
    displacement = np.full_like(grid, np.nan)
    for brick in range(layout.n_bricks):
        place = grid - [bodies.x[brick], bodies.z[brick]]
        inside = np.all(
            np.abs(place) <= [bodies.length[brick] / 2, bodies.height[brick] / 2], axis=1
        )
        displacement[inside] = motion[brick, :2] + turned(place[inside], motion[brick, 2])
    displacement += np.random.default_rng(seed).normal(0, noise, displacement.shape)
    seen = np.isfinite(displacement[:, 0])
    return Field(level, drift_ratio, grid[seen], displacement[seen])


def fields_of(history, layout, every_s, noise):
    """A Field every so often [s] of a History's snapshots, each with errors of its own, and their
    samples (indices)."""
    times = history.series["time_s"].to_numpy()
    snapshots = history.snapshot_time_s
    moments = np.arange(snapshots[0], snapshots[-1], every_s)
    chosen = np.unique([*np.searchsorted(snapshots, moments - 1e-9), len(snapshots) - 1])
    fields = [
        sampled_field(
            layout, history.displacement[k].astype(float), number, noise=noise, seed=int(k)
        )
        for number, k in enumerate(chosen, start=1)
    ]
    return fields, [int(np.argmin(np.abs(times - snapshots[k]))) for k in chosen]


def levels_of(fields, measured, layout, least):
    """`describe_level` of each Field, of what is at least so wide [m]."""
    patterns = patterns_of_fields(fields, measured, layout, least)
    return [
        describe_level(pattern, map_cracks(pattern, layout), layout, psi_from=least)
        for pattern in patterns
    ]


def main():
    asked = arguments(
        __doc__,
        option("history", type=Path, metavar="FILE.h5"),
        option("--every-s", type=float, default=0.1, help="time between two fields (default 0.1)"),
        option("--noise-mm", type=float, default=0.01, help="of a displacement (default 0.01)"),
    )
    history = read_history(asked.history)
    layout = lay_out(history.masonry_wall, history.model)
    index = history.index()
    fields, samples = fields_of(history, layout, asked.every_s, asked.noise_mm * MILLIMETRE)
    measured = measure(fields, layout)
    for least_mm in PSI_FROM_MM:
        least = least_mm * MILLIMETRE
        (seen,) = levels_of(fields[-1:], measured[-1:], layout, least)
        print(
            f"Psi in the end, from {least_mm:g} mm on: {seen['psi']:.2f} in the field, "
            f"{psi(cracks_at(history, samples[-1], least)):.2f} in the simulation"
        )
    found = levels_of(fields, measured, layout, THRESHOLD)
    for name in ("DI_open", "DI_slip"):
        true = index[name].to_numpy()[samples]
        missed = np.abs([level[name][0] for level in found] - true)
        print(
            f"{name} in the end: {found[-1][name][0]:.4f} in the field, {true[-1]:.4f} in the"
            f" simulation; of {len(found)} fields missed by {missed.mean():.4f} in the mean,"
            f" {missed.max():.4f} at most"
        )
