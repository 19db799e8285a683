"""Bricks that can split: every whole brick is two halves, bonded across a cut in its middle.

A cut is of the brick's own stiffness and has n contact points in the middles of n equal parts of its height h, so that
under a moment M and an axial force N the outermost bears, at (n - 1) / (2 n) h from the middle,

    sigma = N / (t h) + n / (n + 1) M / (t h^2 / 6)

for their second moment of area is that of the section times 1 - 1 / n^2.  Each has n / (n + 1) of the brick's tensile
strength: a brick that is bent splits at the moment of beam theory, exactly, since what is left of the section then
bears less than that; one that is pulled apart without bending, at n / (n + 1) of its strength.  As in Lourenço and Rots
(1997, J. Eng. Mech. 123(7), 660-668), where it is not said otherwise, tension alone splits bricks.  With a cohesion c
they split in shear, too: the points bear the mean V / (t h), and have 2/3 c, so that the cut fails where 1.5 V / (t h),
a beam's shear stress in its middle, reaches c, or less where it is pulled: c = f_t is the diagonal tension of a brick
without vertical compression, which helps and is not seen here.

The cut takes its share of the brick's compliance over from the head joints (`damage.wall.compliance`).  Cuts are
brittle, have the friction of the joints once they are open, and do not crush.
"""

from dataclasses import fields, replace

import numpy as np

from damage.wall.compliance import lumped_stiffness
from damage.wall.kinds import CAP, CUT, GROUND

CUT_POINTS = 4
"""Contact points of a cut: bending stiffness 15/16 of the section's, 4/5 of its strength in pure tension."""
_TINY = 1e-6  # [m]


def cut_strengths(brick):
    """Tensile strength and cohesion [Pa] of the contact points of a Brick's cut."""
    cohesion = np.inf if brick.cohesion is None else brick.cohesion / 1.5
    return brick.tensile_strength * CUT_POINTS / (CUT_POINTS + 1), cohesion


def split_bricks(layout):
    """A damage.wall.layout.Layout with every whole brick cut in two halves.

    A left half keeps its brick's number; right halves come behind the other bricks, and cuts behind the joints.
    """
    wall, old, n = layout.wall, layout.bodies, layout.n_bricks
    whole = np.flatnonzero((old.course >= 0) & (np.abs(old.length - wall.brick.length) < _TINY))
    right = np.full(len(old), GROUND)
    right[whole] = n + np.arange(len(whole))
    number = np.arange(len(old))
    number[n:] += len(whole)
    cells = _on_halves(layout.cells, old, number, right)
    halves, contacts = _halves(old, whole, n), _under_new_numbers(layout.contacts, cells, number)
    cuts = _cuts(old, whole, right, cells, wall)
    glue = int(np.sum(contacts.kind != CAP))
    contacts = _with(contacts, np.full(len(cuts["x"]), glue), cuts)
    normal, shear = lumped_stiffness(wall, halves, contacts.kind, contacts.first, contacts.second)
    return replace(
        layout, bodies=halves, cells=cells, n_bricks=n + len(whole),
        contacts=replace(contacts, normal_stiffness=normal, shear_stiffness=shear),
        n_joints=layout.n_joints + len(cuts["x"]),
        drift_bodies=np.concatenate([number[layout.drift_bodies], right[np.intersect1d(layout.drift_bodies, whole)]]))


def _with(table, places, added):
    """A record of arrays with rows put in before these places."""
    return replace(table, **{name: np.insert(getattr(table, name), places, values)
                                         for name, values in added.items()})


def _halves(old, whole, n_bricks):
    """Bodies: left halves in the places of their bricks, right halves behind the bricks."""
    values = {field.name: getattr(old, field.name).copy() for field in fields(old)}
    values["length"][whole] /= 2
    values["mass"][whole] /= 2
    values["inertia"][whole] = (values["mass"] * (values["length"]**2 + values["height"]**2) / 12)[whole]
    quarter = old.length[whole] / 4
    values["x"][whole] -= quarter
    added = {name: column[whole] for name, column in values.items()} | {"x": old.x[whole] + quarter}
    return _with(replace(old, **values), np.full(len(whole), n_bricks), added)


def _on_halves(cells, old, number, right):
    """Cells under their bodies' new numbers, each of the half that its middle lies in."""
    on_right = (right[cells.body] != GROUND) & ((cells.left + cells.right) / 2 > old.x[cells.body] + _TINY)
    return replace(cells, body=np.where(on_right, right[cells.body], number[cells.body]))


def _under_new_numbers(contacts, cells, number):
    """Contacts between the bodies that their cells belong to now."""
    bodies = {side: np.where(cell == GROUND, getattr(contacts, side), cells.body[cell]) for side, cell in
              (("first", contacts.first_cell), ("second", contacts.second_cell))}
    return replace(contacts, **bodies)


def _cuts(old, whole, right, cells, wall):
    """{field: values} of the cuts' contact points, upwards in each cut."""
    brick, n = wall.brick, CUT_POINTS * len(whole)
    heights = ((np.arange(CUT_POINTS) + 0.5) / CUT_POINTS - 0.5) * brick.height
    last, first = ({body: cell for cell, body in order} for order in (
        enumerate(cells.body), reversed(list(enumerate(cells.body)))))
    tensile_strength, cohesion = cut_strengths(brick)
    values = {
        "kind": CUT, "first": np.repeat(whole, CUT_POINTS), "second": np.repeat(right[whole], CUT_POINTS),
        "x": np.repeat(old.x[whole], CUT_POINTS), "z": np.add.outer(old.z[whole], heights).ravel(),
        "length": brick.height / CUT_POINTS, "area": brick.height / CUT_POINTS * brick.thickness,
        "normal_stiffness": np.nan, "shear_stiffness": np.nan,  # of all together, later
        "elastic": False, "tensile_strength": tensile_strength, "cohesion": cohesion, "compressive_strength": np.inf,
        "first_cell": np.repeat([last[body] for body in whole], CUT_POINTS),
        "second_cell": np.repeat([first[right[body]] for body in whole], CUT_POINTS)}
    return {name: np.broadcast_to(value, n) for name, value in values.items()}
