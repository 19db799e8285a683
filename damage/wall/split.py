"""Bricks of several parts: halves that can split, cells that make bricks deformable.

**Splitting.**  Every whole brick is two halves, bonded across a cut in its middle.  The cut has n
contact points in the middles of n equal parts of the brick's height h, so that under a moment M and
an axial force N the outermost bears, at (n - 1) / (2 n) h from the middle,

    sigma = N / (t h) + n / (n + 1) M / (t h^2 / 6)

for their second moment of area is that of the section times 1 - 1 / n^2.  Each has n / (n + 1) of
the brick's tensile strength: a brick that is bent splits at the moment of beam theory, exactly,
since what is left of the section then bears less than that; one that is pulled apart without
bending, at n / (n + 1) of its strength.  As in Lourenço and Rots (1997, J. Eng. Mech. 123(7),
660-668) tension along the wall splits bricks.

**Diagonal tension** splits them, too.  In the middle of the cut the principal tension reaches f_t
under the shear stress tau and the stress sigma_v across the bed joints, compression positive, at

    tau = f_t sqrt(1 + sigma_v / f_t),    tau = 1.15 V / (t h)

(`damage.law.joint_law.diagonal_tension`).  In the model of W. Mann and H. Müller (1982, Proc. Br.
Ceram. Soc. 30, 223-235; known from T. Bakeer's notes, TU Dresden, 2012) head joints bear no shear,
so that V / (t h) is twice a wall's mean; that the stress there is 2.3 times the mean, 2 * 1.15, is
quoted from memory.  Plane elasticity of such a brick gives 1.16 at a height of 0.28 of the length,
1.08 at 0.5, 1.02 at 0.65, and 1.16 to 1.12 where the stress on it varies linearly.  The points bear
the mean V / (t h).  Under horizontal stress sigma_x, tension positive, the principal stress has tau
falling by 1/2 sqrt(1 + sigma_v / f_t) / 1.15 of it at first, 0.43 to 0.75 for sigma_v up to 2 f_t;
the points fall by tan(phi).  sigma_v is the mean of the four bed joints' contact points next to the
cut, above and below on both sides: the stress at mid-height comes from half a brick's height to
either side of it.  It changes at samples.

**After that** a cut softens as a joint does, of fracture energy G in either mode: a diagonal crack
opens.  Without G it is brittle.  It has the friction of the joints, and does not crush.  The shear
of a brick is uniform in the bed joints' compliance, but rises linearly from zero at its ends to
twice the mean in its middle: the rest, a third of the energy, is that of a cut of stiffness 6 G / d
in place of the G / d of a bar of length d between the centres of the halves.

**Cells** (`ModelOptions.brick_cells`).  A whole brick of length L is N rigid cells, glued by cuts
that stay elastic, on a grid of L / N along the wall.  Of two cells whose centres lie d apart, two
Gauss points over the height give

    axial E t h / d,  bending E t h^3 / (12 d),  shear 2 G t h / d

so that the brick is a chain of short beams along its length.  Across its height it stays rigid, its
compliance lumped into the bed joints.  Half of the shear compliance 1/G is in the cuts and head
joints, half in the bed joints: a uniform shear stress shears a wall by tau / G, of which the cells'
rotation makes either half visible.

A cut takes its share of the brick's compliance over from the head joints (`damage.wall.kinds`).
"""

from dataclasses import fields, replace

import numpy as np

from damage.wall.kinds import BED, CAP, CUT, GROUND, TINY, lumped_stiffness

CUT_POINTS = 4
"""Contact points of a cut that splits: bending stiffness 15/16 of the section's, 4/5 of its
strength in tension."""
PEAK = 1.15
"""Shear stress in the middle of a cut over its mean."""
_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(12)  # of the height, from its middle


def cut_strengths(brick):
    """Tensile strength and cohesion [Pa] of the contact points of a Brick's cut without vertical
    stress."""
    strength = brick.tensile_strength
    return strength * CUT_POINTS / (CUT_POINTS + 1), strength / PEAK


def beside_cuts(contacts):
    """Rows of Contacts: of the first point of each cut that can split, (cuts,), and of the points
    above and below it on either side, (cuts, 4), -1 where a face is free."""
    splits = np.flatnonzero((contacts.kind == CUT) & ~contacts.elastic)[::CUT_POINTS]
    lies = (contacts.kind == BED) | (contacts.kind == CAP)
    rows = {
        side: {
            body: np.flatnonzero(lies & (getattr(contacts, side) == body))
            for body in (*contacts.first[splits], *contacts.second[splits])
        }
        for side in ("first", "second")
    }
    found = np.full((len(splits), 4), -1)
    for k, cut in enumerate(splits):
        faces = (
            rows[side][body]
            for body in (contacts.first[cut], contacts.second[cut])
            for side in rows
        )
        for face, points in enumerate(faces):
            if len(points):
                found[k, face] = points[np.argmin(np.abs(contacts.x[points] - contacts.x[cut]))]
    return splits, found


def cuts_of(unit, brick_cells, left, right):
    """Positions [m] of the cuts through a brick with these edges, from left to right; unit: the
    damage.Brick that it is or was cut from; brick_cells: of a whole brick, 0 where it is not made
    of cells."""
    middle = [(left + right) / 2] if unit.splits and _is_whole(unit, right - left) else []
    if not brick_cells:
        return middle
    cell = unit.length / brick_cells
    first, last = (
        np.ceil((left + cell / 2 - TINY) / cell),
        np.floor((right - cell / 2 + TINY) / cell),
    )
    return [k * cell for k in range(int(first), int(last) + 1)]


def cut_bricks(layout):
    """A damage.wall.layout.Layout with every brick cut into its parts.

    The leftmost part keeps its brick's number; the others come behind the other bricks, and cuts
    behind the joints.
    """
    old, n, wall = layout.bodies, layout.n_bricks, layout.wall
    half = old.length / 2
    cuts = [
        cuts_of(wall.brick, layout.options.brick_cells, *edges) if brick < n else []
        for brick, edges in enumerate(zip(old.x - half, old.x + half))
    ]
    counts = np.array([len(positions) for positions in cuts])
    added = int(counts.sum())
    number = np.arange(len(old)) + np.where(np.arange(len(old)) < n, 0, added)
    behind = n + np.cumsum(counts) - counts  # number of each brick's second part
    cells = _on_parts(layout.cells, cuts, number, behind)
    bodies, contacts = _parts(old, cuts, n), _under_new_numbers(layout.contacts, cells)
    rows = _cuts(wall.brick, old, cuts, number, behind, cells)
    glue = int(np.sum(contacts.kind != CAP))
    contacts = _with(contacts, np.full(len(rows["x"]), glue), rows)
    sheared = 2 if layout.options.brick_cells else 1
    normal, shear = lumped_stiffness(
        wall, bodies, contacts.kind, contacts.first, contacts.second, sheared
    )
    of_lintels = (contacts.kind == CUT) & ~np.isnan(contacts.normal_stiffness)
    normal, shear = (
        np.where(of_lintels, old, new)
        for old, new in ((contacts.normal_stiffness, normal), (contacts.shear_stiffness, shear))
    )
    others = [
        behind[brick] + k for brick in np.sort(layout.drift_bodies) for k in range(counts[brick])
    ]
    return replace(
        layout,
        bodies=bodies,
        cells=cells,
        n_bricks=n + added,
        contacts=replace(contacts, normal_stiffness=normal, shear_stiffness=shear),
        n_joints=layout.n_joints + len(rows["x"]),
        drift_bodies=np.concatenate([number[layout.drift_bodies], np.array(others, int)]),
    )


def _is_whole(brick, length):
    return abs(length - brick.length) < TINY


def _with(table, places, added):
    """A record of arrays with rows put in before these places."""
    return replace(
        table,
        **{name: np.insert(getattr(table, name), places, values) for name, values in added.items()},
    )


def _parts(old, cuts, n_bricks):
    """Bodies: leftmost parts in the places of their bricks, the others behind the bricks."""
    values = {field.name: getattr(old, field.name).copy() for field in fields(old)}
    added = {name: [] for name in values}
    for brick in np.flatnonzero([len(positions) > 0 for positions in cuts]):
        ends = np.array([-0.5, *((np.array(cuts[brick]) - old.x[brick]) / old.length[brick]), 0.5])
        share = np.round(np.diff(ends), 12)  # halves are exact ones
        length, mass = old.length[brick] * share, old.mass[brick] * share
        parts = {
            "x": old.x[brick] + old.length[brick] * (np.cumsum(share) - share / 2 - 0.5),
            "z": old.z[brick],
            "length": length,
            "height": old.height[brick],
            "mass": mass,
            "inertia": mass * (length**2 + np.square(old.height[brick])) / 12,
            "course": old.course[brick],
        }
        for name, column in parts.items():
            values[name][brick], *others = np.broadcast_to(column, len(length))
            added[name] += others
    return _with(replace(old, **values), np.full(len(added["x"]), n_bricks), added)


def _on_parts(cells, cuts, number, behind):
    """Contact cells under their bodies' new numbers, each of the part that its middle lies in."""
    middle = (cells.left + cells.right) / 2
    part = np.array([np.searchsorted(cuts[body], x - TINY) for body, x in zip(cells.body, middle)])
    return replace(
        cells, body=np.where(part > 0, behind[cells.body] + part - 1, number[cells.body])
    )


def _under_new_numbers(contacts, cells):
    """Contacts between the bodies that their cells belong to now."""
    bodies = {
        side: np.where(cell == GROUND, getattr(contacts, side), cells.body[cell])
        for side, cell in (("first", contacts.first_cell), ("second", contacts.second_cell))
    }
    return replace(contacts, **bodies)


def _cuts(brick, old, cuts, number, behind, cells):
    """{field: values} of the cuts' contact points, upwards in each cut."""
    last, first = (
        {body: cell for cell, body in order}
        for order in (enumerate(cells.body), reversed(list(enumerate(cells.body))))
    )
    splitting = (
        (np.arange(CUT_POINTS) + 0.5) / CUT_POINTS - 0.5,
        False,
        *(cut_strengths(brick) if brick.splits else (np.inf, np.inf)),
    )
    glued = _GAUSS, True, np.inf, np.inf
    rows = []
    for body, k in (
        (body, k) for body, positions in enumerate(cuts) for k in range(len(positions))
    ):
        x = cuts[body][k]
        splits = brick.splits and _is_whole(brick, old.length[body]) and abs(x - old.x[body]) < TINY
        places, elastic, tensile_strength, cohesion = splitting if splits else glued
        one, other = number[body] if k == 0 else behind[body] + k - 1, behind[body] + k
        length = brick.height / len(places)
        rows += [
            (
                one,
                other,
                x,
                old.z[body] + place * brick.height,
                length,
                length * brick.thickness,
                elastic,
                tensile_strength,
                cohesion,
                last[one],
                first[other],
            )
            for place in places
        ]
    names = (
        "first",
        "second",
        "x",
        "z",
        "length",
        "area",
        "elastic",
        "tensile_strength",
        "cohesion",
        "first_cell",
        "second_cell",
    )
    columns = (
        dict(zip(names, map(np.array, zip(*rows))))
        if rows
        else {name: np.zeros(0, int) for name in names}
    )
    return columns | {
        name: np.full(len(columns["x"]), value)
        for name, value in (
            # of all together, later
            ("kind", CUT),
            ("normal_stiffness", np.nan),
            ("shear_stiffness", np.nan),
            ("compressive_strength", np.inf),
        )
    }
