"""Stresses in deformable bricks, and where they would split a brick.

A brick in running bond splits through its middle, below or above a head joint.  Its middle section
is judged by the largest principal stress (Rankine) at its lower edge, its centre and its upper
edge, in every snapshot.  The stresses at the edges are means of those at the corners, which is
exact, as stresses of strain modes of order 2 are linear.  A brick's bending
moment is its mean over the brick's length, two thirds of the maximum under a uniform load between
supports at its ends. The bricks of such a run stay whole: the measure shows where they would not.
"""

import numpy as np

from damage.history.schema import Column, each, measure

SECTION_POSITIONS = ("lower edge", "centre", "upper edge")
"""Points of the middle section."""
# of the places of a history
_WEIGHTS = np.array([[0, 0.5, 0.5, 0, 0], [1, 0, 0, 0, 0], [0, 0, 0, 0.5, 0.5]])


def principal_stresses(stress):
    """Largest and smallest principal stress (..., 2) [Pa] and the angle (...) [rad] of the former's
    direction from the x axis, of stresses (..., 3) [Pa]: along x, along z, shear; tension
    positive."""
    along_x, along_z, shear = np.moveaxis(np.asarray(stress, float), -1, 0)
    middle = (along_x + along_z) / 2
    radius = np.hypot((along_x - along_z) / 2, shear)
    return (
        np.stack([middle + radius, middle - radius], axis=-1),
        np.arctan2(2 * shear, along_x - along_z) / 2,
    )


def has_stresses(history):
    """Whether a History holds stresses of bricks."""
    return history.stress_pa is not None and len(history.stress_pa) > 0


BRICKS = each(
    {
        "brick": Column("1", "row of the history's bodies"),
        "course": Column("1", "from 0 at the base"),
        "x_m, z_m": Column("m", "of its centre"),
        "max_tension_pa, max_compression_pa": Column(
            "Pa",
            "largest and smallest principal stress of the middle section "
            "over all snapshots, tension positive",
        ),
        "place": Column("", "of the largest: lower edge, centre or upper edge"),
        "time_s": Column("s", "of the largest"),
        "splits_at_s": Column("s", "first snapshot above the tensile strength, empty without one"),
    }
)


def bricks_table(history):
    """A row for each brick of a History with deformable bricks, a DataFrame; columns: BRICKS."""
    bodies = history.bodies
    bricks = np.flatnonzero(bodies["course"].to_numpy() >= 0)
    stress = np.einsum("pq,tbqs->tbps", _WEIGHTS, history.stress_pa[:, bricks].astype(float))
    # (n_snapshots, n_bricks, places)
    largest, smallest = np.moveaxis(principal_stresses(stress)[0], -1, 0)
    times = history.snapshot_time_s
    n_places = len(SECTION_POSITIONS)
    flat = np.moveaxis(largest, 1, 0).reshape(len(bricks), -1)
    at = flat.argmax(axis=1)
    strength = history.masonry_wall.brick.tensile_strength
    above = largest.max(axis=2) > (np.inf if strength is None else strength)
    table = bodies.iloc[bricks][["course", "x_m", "z_m"]].rename_axis("brick").reset_index()
    return table.assign(
        max_tension_pa=flat.max(axis=1),
        max_compression_pa=smallest.min(axis=(0, 2)),
        place=np.array(SECTION_POSITIONS)[at % n_places],
        time_s=times[at // n_places],
        splits_at_s=np.where(above.any(axis=0), times[above.argmax(axis=0)], np.nan),
    )


@measure(
    {
        "max_brick_tension_pa, max_brick_compression_pa": Column(
            "Pa",
            "of deformable bricks: largest and smallest principal stress in their middle sections,"
            " at snapshots; empty where bricks are rigid",
        ),
        "bricks_above_strength": Column(
            "1",
            "deformable bricks whose principal tension exceeded their tensile strength; "
            "empty where they have none",
        ),
    }
)
def stress_measures(history):
    """Largest principal stresses of deformable bricks [Pa], and the number of bricks whose strength
    is exceeded."""
    if not has_stresses(history):
        return None
    table = bricks_table(history)
    above = int(table["splits_at_s"].notna().sum()) if history.masonry_wall.brick.splits else None
    return float(table["max_tension_pa"].max()), float(table["max_compression_pa"].min()), above


def warn_of_splitting(history):
    """Warning of bricks whose tensile strength is exceeded and that stay whole, a list of str."""
    brick = history.masonry_wall.brick
    if not (has_stresses(history) and brick.splits):
        return []
    table = bricks_table(history).dropna(subset="splits_at_s").sort_values("splits_at_s")
    if table.empty:
        return []
    first = table.iloc[0]
    count = "1 brick" if len(table) == 1 else f"{len(table)} bricks"
    return [
        f"{count} would split at {brick.tensile_strength / 1e6:g} MPa, the first at x ="
        f" {first['x_m']:.2f} m, z = {first['z_m']:.2f} m (t = {first['splits_at_s']:.2f} s):"
        " deformable bricks stay whole; give --bricks rigid for bricks that split"
    ]
