"""A layout whose bricks can split: each is cut in the middle and joined there again by its own strength."""

import dataclasses

import numpy as np

from damage.wall.layout import GROUND, HEAD, Bodies

_TINY = 1e-6  # [m]


def split_stones(layout, tensile_strength=0.0, cohesion=0.0):
    """The layout with every whole brick cut in two halves that hang together by these strengths [Pa].

    A cut is a joint like the others, with contact points at its two ends and the brick's own stiffness.
    Cells and drift bodies keep their numbers: the left half stands for its brick.
    """
    wall, old = layout.wall, layout.bodies
    whole = np.flatnonzero((old.course >= 0) & (old.length > wall.brick.length - _TINY))
    number = np.arange(len(old))
    number[layout.n_bricks:] += len(whole)  # right halves come after the other bricks, before the caps
    right = np.full(len(old), GROUND)
    right[whole] = layout.n_bricks + np.arange(len(whole))
    contacts = _onto_halves(layout.contacts, layout.cells, old, number, right)
    cuts = _cuts(old, whole, right[whole], wall, tensile_strength, cohesion)
    glue = np.full(2 * len(whole), layout.n_joints)  # the caps' glue stays last
    joined = {name: np.insert(getattr(contacts, name), glue, column) for name, column in cuts.items()}
    return dataclasses.replace(
        layout, bodies=_cut(old, whole, layout.n_bricks), contacts=dataclasses.replace(contacts, **joined),
        n_bricks=layout.n_bricks + len(whole), n_joints=layout.n_joints + 2 * len(whole))


def _cut(old, whole, n_bricks):
    """Bodies: left halves in the places of their bricks, right halves after the bricks."""
    values = {field.name: getattr(old, field.name).copy() for field in dataclasses.fields(old)}
    values["length"][whole] /= 2
    values["mass"][whole] /= 2
    values["inertia"][whole] = (values["mass"] * (values["length"]**2 + values["height"]**2) / 12)[whole]
    quarter = old.length[whole] / 4
    values["x"][whole] -= quarter
    added = {name: column[whole] for name, column in values.items()}
    added["x"] = old.x[whole] + quarter
    return Bodies(**{name: np.insert(column, [n_bricks] * len(whole), added[name]) for name, column in values.items()})


def _onto_halves(contacts, cells, old, number, right):
    """Contacts under their bodies' new numbers, each moved to the half that it touches."""
    moved = {}
    for side, cell in (("first", contacts.first_cell), ("second", contacts.second_cell)):
        body = getattr(contacts, side)
        middle = np.where(cell == GROUND, 0.0, (cells.left[cell] + cells.right[cell]) / 2)
        on_right = (right[body] != GROUND) & (middle > old.x[body] + _TINY)
        moved[side] = np.where(body == GROUND, GROUND, np.where(on_right, right[body], number[body]))
    return dataclasses.replace(contacts, **moved)


def _cuts(old, left, right, wall, tensile_strength, cohesion):
    """Fields of the contacts of the cuts, at the lower and the upper end of each."""
    brick, n = wall.brick, 2 * len(left)
    ends = np.tile([-brick.height / 2, brick.height / 2], len(left))
    distance = brick.length / 2  # of the halves' centres
    values = {
        "kind": HEAD, "first": np.repeat(left, 2), "second": np.repeat(right, 2),
        "x": np.repeat(old.x[left], 2), "z": np.repeat(old.z[left], 2) + ends,
        "length": brick.height / 2, "area": brick.height / 2 * brick.thickness,
        "normal_stiffness": brick.young_modulus / distance,
        "shear_stiffness": brick.shear_modulus / distance,
        "elastic": False, "tensile_strength": float(tensile_strength), "cohesion": float(cohesion),
        "first_cell": GROUND, "second_cell": GROUND}
    return {name: np.broadcast_to(value, n) for name, value in values.items()}
