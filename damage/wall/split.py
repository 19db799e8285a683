"""Bricks that can split into halves, joined across a cut in their middle.

A cut has contact points in the middles of CUT_POINTS equal parts of the brick's height.  What they
bear under bending, diagonal tension and after they fail is derived in docs/model/model.md,
*Splitting*.  A cut takes its share of the brick's compliance over from the head joints
(`damage.wall.kinds`).
"""

from dataclasses import fields, replace

import numpy as np

from damage.wall.kinds import BED, CAP, CUT, GROUND, TINY, lumped_stiffness

CUT_POINTS = 4
"""Contact points of a cut that splits: bending stiffness 15/16 of the section's, 4/5 of its
strength in tension."""
PEAK = 1.15
"""Shear stress in the middle of a cut over its mean."""


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
    neighbours = np.full((len(splits), 4), -1)
    for k, cut in enumerate(splits):
        faces = (
            rows[side][body]
            for body in (contacts.first[cut], contacts.second[cut])
            for side in rows
        )
        for face, points in enumerate(faces):
            if len(points):
                neighbours[k, face] = points[
                    np.argmin(np.abs(contacts.x[points] - contacts.x[cut]))
                ]
    return splits, neighbours


def can_split(brick, length):
    """Return whether bricks of these lengths [m], cut from a damage.Brick or whole, can split."""
    return brick.splits & (np.abs(length - brick.length) < TINY)


def middle_of(x, length):
    """Return x [m] halfway between the edges of bricks, where cuts are; that is x but for its last
    bit."""
    return ((x - length / 2) + (x + length / 2)) / 2


def cut_bricks(layout):
    """Return a damage.wall.layout.Layout whose whole bricks are two halves each.

    A left half keeps its brick's number; right halves come behind the other bricks, and cuts behind
    the joints.
    """
    old = layout.bodies
    n = layout.n_bricks
    wall = layout.wall
    is_brick = np.arange(len(old)) < n
    splits = is_brick & can_split(wall.brick, old.length)
    cut = np.flatnonzero(splits)
    number = np.arange(len(old)) + np.where(is_brick, 0, len(cut))
    right_half = n + np.cumsum(splits) - 1  # of the bricks that split
    middle = middle_of(old.x, old.length)
    cells = layout.cells
    on_right = splits[cells.body] & ((cells.left + cells.right) / 2 - TINY > middle[cells.body])
    cells = replace(cells, body=np.where(on_right, right_half[cells.body], number[cells.body]))
    bodies = _halves(old, cut, n)
    contacts = _under_new_numbers(layout.contacts, cells)
    glue = int(np.sum(contacts.kind != CAP))
    n_points = CUT_POINTS * len(cut)
    points = _cut_points(
        wall.brick,
        cells,
        x=middle[cut],
        z=old.z[cut],
        left_half=cut,
        right_half=right_half[cut],
    )
    contacts = _with(contacts, np.full(n_points, glue), points)
    normal, shear = lumped_stiffness(wall, bodies, contacts.kind, contacts.first, contacts.second)
    of_lintels = (contacts.kind == CUT) & ~np.isnan(contacts.normal_stiffness)
    normal, shear = (
        np.where(of_lintels, old, new)
        for old, new in ((contacts.normal_stiffness, normal), (contacts.shear_stiffness, shear))
    )
    drifting = np.sort(layout.drift_bodies)
    return replace(
        layout,
        bodies=bodies,
        cells=cells,
        n_bricks=n + len(cut),
        contacts=replace(contacts, normal_stiffness=normal, shear_stiffness=shear),
        n_joints=layout.n_joints + n_points,
        drift_bodies=np.concatenate(
            [number[layout.drift_bodies], right_half[drifting[splits[drifting]]]]
        ),
    )


def _with(table, places, added):
    """Return a record of arrays with rows put in before these places."""
    return replace(
        table,
        **{name: np.insert(getattr(table, name), places, values) for name, values in added.items()},
    )


def _halves(old, cut, n_bricks):
    """Return Bodies: left halves in the places of their bricks, right ones behind the bricks."""
    length = old.length[cut] / 2
    mass = old.mass[cut] / 2
    halves = {
        "length": length,
        "mass": mass,
        "inertia": mass * (length**2 + np.square(old.height[cut])) / 12,
    }
    values = {field.name: getattr(old, field.name).copy() for field in fields(old)}
    added = {name: column[cut] for name, column in values.items()} | halves
    added["x"] = old.x[cut] + old.length[cut] / 4
    for name, column in halves.items():
        values[name][cut] = column
    values["x"][cut] -= old.length[cut] / 4
    return _with(replace(old, **values), np.full(len(cut), n_bricks), added)


def _under_new_numbers(contacts, cells):
    """Return Contacts between the bodies that their cells belong to now."""
    bodies = {
        side: np.where(cell == GROUND, getattr(contacts, side), cells.body[cell])
        for side, cell in (("first", contacts.first_cell), ("second", contacts.second_cell))
    }
    return replace(contacts, **bodies)


def _cut_points(brick, cells, *, x, z, left_half, right_half):
    """Return {field: values} of the cuts' contact points, upwards in each cut.

    x, z: middles of the bricks that split [m]; left_half, right_half: numbers of their halves.
    """
    last_cell = {body: cell for cell, body in enumerate(cells.body)}
    first_cell = {body: cell for cell, body in reversed(list(enumerate(cells.body)))}
    length = brick.height / CUT_POINTS
    places = (np.arange(CUT_POINTS) + 0.5) / CUT_POINTS - 0.5
    tensile_strength, cohesion = cut_strengths(brick)
    of_cuts = {
        "first": left_half,
        "second": right_half,
        "x": x,
        "first_cell": [last_cell[body] for body in left_half],
        "second_cell": [first_cell[body] for body in right_half],
    }
    return {name: np.repeat(values, CUT_POINTS) for name, values in of_cuts.items()} | {
        "z": (z[:, None] + places * brick.height).ravel(),
        "length": length,
        "area": length * brick.thickness,
        "elastic": False,
        "tensile_strength": tensile_strength,
        "cohesion": cohesion,
        "compressive_strength": np.inf,
        "kind": CUT,
        # of all together, later
        "normal_stiffness": np.nan,
        "shear_stiffness": np.nan,
    }
