"""Digitised cracks on the joints of a wall, and the damage index from them, with bounds.

A stretch of a polyline is cut into pieces of half a millimetre.  A piece belongs to the joint with
the least

    distance / tolerance + sin^2(angle between piece and joint)

and to none where that is 1 or more: it then runs through a brick, or beside the wall.  Its length
counts on the joint as it was drawn; no joint is cracked over more than its own length.

Where only the width w of a crack is known, opening and slip each lie between 0 and w with
w^2 = opening^2 + slip^2, and the index lies between two bounds (threshold t):

    w > sqrt(2) t         at least one of opening and slip is over t, perhaps both
    t < w <= sqrt(2) t    at most one of them is, perhaps none
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.checks import check_positive
from damage.elementary import hypot
from damage.index import COMPONENTS, DRIFT_LIMIT, THRESHOLD, combine, drift_component
from damage.measure.cracks import ENDS, PSI_FROM, cracked, ends_of, points_along, psi
from damage.units import MILLIMETRE
from damage.wall.geometry import joint_table, tributary_ends

PIECE = 0.5 * MILLIMETRE
_CHUNK = 400  # points whose distances to the joints near them are worked out at once: memory


class MappedCracks(NamedTuple):
    """The cracks of one pattern on the joints of a wall.

    table: DataFrame, a row each joint that a stretch runs along: joint (index), ENDS on the joint,
    length_m, and of the stretch, as of a CrackPattern, crack, opening_m, slip_m, width_m, mode;
    drawn_m, unmapped_m, surplus_m: length of all polylines, of what lies on no joint, and of what
    was drawn over a joint beyond the joint's own length.
    """

    table: pd.DataFrame
    drawn_m: float
    unmapped_m: float
    surplus_m: float


def map_cracks(pattern, layout, tolerance=None):
    """Put a CrackPattern on the joints of a Layout; tolerance [m], None for half a brick's
    height."""
    tolerance = layout.wall.brick.height / 2 if tolerance is None else tolerance
    check_positive("tolerance [m]", tolerance)
    ends = np.sort(tributary_ends(joint_table(layout)), axis=1)
    parts = pattern.stretches
    rows = [
        row
        for number, part in enumerate(ends_of(parts))
        for row in _on_joints(number, part, ends, tolerance)
    ]
    table = pd.DataFrame(rows, columns=["stretch", "joint", *ENDS, "length_m"]).astype(
        {"stretch": int, "joint": int}
    )
    table = table.join(parts[["crack", "opening_m", "slip_m", "width_m", "mode"]], on="stretch")
    mapped = table["length_m"].sum()
    # No joint is cracked over more than its length.  A piece across its end counts entirely on one
    # side of it: the sum may exceed the length by one piece.
    length = layout.contacts.length
    on_joint = np.bincount(table["joint"], table["length_m"], minlength=len(length))
    share = np.divide(length, on_joint, out=np.ones(len(length)), where=on_joint > length + PIECE)
    table["length_m"] *= share[table["joint"]]
    drawn = parts["length_m"].sum()
    return MappedCracks(
        table.drop(columns="stretch"),
        drawn,
        max(drawn - mapped, 0.0),
        mapped - table["length_m"].sum(),
    )


def in_chunks(function, points):
    """A function of points (n, 2) that gives (n,), for a few of them at a time."""
    return np.concatenate(
        [function(part) for part in np.split(points, range(_CHUNK, len(points), _CHUNK))]
    )


def _on_joints(number, stretch, ends, tolerance):
    """Rows (stretch, joint, x and z of both ends, length) of the joints that one stretch runs
    along."""
    low = ends[:, 0]
    high = ends[:, 1]
    whole = stretch[1] - stretch[0]
    length = hypot(*whole)
    n_pieces = max(1, int(np.ceil(length / PIECE)))
    (middle,) = points_along(stretch[np.newaxis], n_pieces)
    best = in_chunks(lambda part: _nearest(part, whole / length, low, high, tolerance), middle)
    half = np.abs(whole) / n_pieces / 2
    for joint in np.unique(best[best >= 0]):
        pieces = middle[best == joint]
        start, end = (
            np.clip(edge, low[joint], high[joint])
            for edge in (pieces.min(axis=0) - half, pieces.max(axis=0) + half)
        )
        yield number, joint, *start, *end, length * len(pieces) / n_pieces


def _nearest(middle, along, low, high, tolerance):
    """The joint that each piece of a stretch belongs to, -1 for none: (n_pieces,).

    middle: (n_pieces, 2) [m]; along: (2,) unit vector; low, high: ends of the joints (n_joints, 2)
    [m].
    """
    near = np.flatnonzero(
        np.all(
            (low <= middle.max(axis=0) + tolerance) & (high >= middle.min(axis=0) - tolerance),
            axis=1,
        )
    )
    if len(near) == 0:
        return np.full(len(middle), -1)
    is_head = (high - low)[near, 1] > (high - low)[near, 0]
    sine = along[np.where(is_head, 0, 1)]
    apart = np.maximum(np.maximum(low[near] - middle[:, None], middle[:, None] - high[near]), 0)
    cost = hypot(apart[..., 0], apart[..., 1]) / tolerance + sine**2
    best = np.argmin(cost, axis=1)
    return np.where(cost[np.arange(len(middle)), best] >= 1, -1, near[best])


def describe_level(
    pattern, mapped, layout, threshold=THRESHOLD, drift_limit=DRIFT_LIMIT, psi_from=PSI_FROM
):
    """The key numbers of one pattern and its MappedCracks, a dictionary: load_level, drift_pct
    (None where unknown), cracks, crack_length_m, unmapped_m, surplus_m, undecided_m, max_width_mm,
    psi, psi_drawn, and DI, DI_drift (None where unknown), DI_open, DI_slip, each [low, high].

    Cracks count as they were drawn, by the file's own labels: a straight line over bricks and
    joints is one.  Psi is that of the joints whose width reaches psi_from [m], as in
    `damage.measure.cracks`; psi_drawn that of the polylines as they were drawn, through bricks too.
    Without a drift DI is that of the cracks alone.  undecided_m: length over the threshold whose
    mode is unknown.
    """

    def wide(rows, least):
        return rows[cracked(rows["width_m"].to_numpy(float), least)]

    check_positive("drift limit", drift_limit)
    table = mapped.table
    parts = pattern.stretches
    chosen = wide(table, threshold)
    known = not np.isnan(pattern.drift_ratio)
    drift = min(float(drift_component(pattern.drift_ratio, drift_limit)), 1.0) if known else 0.0
    on_joints = table[layout.joint_length[table["joint"]] > 0]  # not in a brick's cut
    bounds = index_bounds(on_joints, layout.total_joint_length, drift, threshold)
    if not known:
        bounds["DI_drift"] = None
    return {
        "load_level": pattern.level,
        "drift_pct": 100 * pattern.drift_ratio if known else None,
        "cracks": wide(parts, threshold)["crack"].nunique(),
        "crack_length_m": chosen["length_m"].sum(),
        "unmapped_m": mapped.unmapped_m,
        "surplus_m": mapped.surplus_m,
        "undecided_m": chosen.loc[chosen["opening_m"].isna(), "length_m"].sum(),
        "max_width_mm": parts["width_m"].max() / MILLIMETRE if len(parts) else 0.0,
        "psi": psi(wide(table, psi_from)),
        "psi_drawn": psi(wide(parts, psi_from)),
        **bounds,
    }


def index_bounds(table, total_length, drift, threshold):
    """DI, DI_drift, DI_open, DI_slip of mapped cracks, each (low, high), equal where all modes are
    known.

    table: of MappedCracks; total_length: of all joints [m]; drift: DI_drift [-].
    """

    def share(selected):
        return table.loc[selected, "length_m"].sum() / total_length

    opening, slip, width = (table[name] for name in ("opening_m", "slip_m", "width_m"))
    unknown = opening.isna()
    opened = share(opening > threshold)
    slipped = share(slip.abs() > threshold)
    strong = share(unknown & (width > np.sqrt(2) * threshold))
    weak = share(unknown & (width > threshold) & (width <= np.sqrt(2) * threshold))
    return {
        "DI": (
            least_index(drift, opened, slipped, strong),
            largest_index(drift, opened, slipped, strong, weak),
        ),
        "DI_drift": (drift, drift),
        "DI_open": (opened, opened + strong + weak),
        "DI_slip": (slipped, slipped + strong + weak),
    }


def least_index(drift, opened, slipped, either):
    """Least DI where a share `either` of the joints has opened or slipped, not both: (1 - open)(1 -
    slip)
    is largest where the two are as equal as can be."""
    to_open = np.clip((slipped - opened + either) / 2, 0.0, either)
    return float(combine(drift, opened + to_open, slipped + either - to_open))


def largest_index(drift, opened, slipped, both, either):
    """Largest DI where a share `both` of the joints has opened and slipped, and a share `either`
    has done one of these: all of it the same."""
    opened = opened + both
    slipped = slipped + both
    return float(
        max(combine(drift, opened + either, slipped), combine(drift, opened, slipped + either))
    )


def largest(levels):
    """Each component's own maximum over levels of `describe_level`, (low, high), None where no
    level has it, and psi's."""
    result = {
        name: tuple(map(max, zip(*(level[name] for level in levels if level[name])))) or None
        for name in COMPONENTS
    }
    return result | {"psi": max(level["psi"] for level in levels)}
