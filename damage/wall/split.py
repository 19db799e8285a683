"""Bricks that can split into halves, joined across a cut in their middle.

A cut has contact points in the middles of CUT_POINTS equal parts of the brick's height.  What they
bear under bending, diagonal tension and after they fail is derived in docs/model/model.md,
*Splitting*.  A cut takes its share of the brick's compliance over from the head joints
(`damage.wall.kinds`).
"""

from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from damage.wall.kinds import BED, CAP, CUT, TINY
from damage.wall.tables import inertia_of, taken

CUT_POINTS = 4
"""Contact points of a cut that splits: bending stiffness 15/16 of the section's, 4/5 of its
strength in tension."""
PEAK = 1.15
"""Shear stress in the middle of a cut over its mean."""


def cut_strengths(brick):
    """Tensile strength and cohesion [Pa] of the contact points of a Brick's cut without vertical
    stress, zero of a brick that does not split."""
    strength = brick.tensile_strength or 0.0
    return strength * CUT_POINTS / (CUT_POINTS + 1), strength / PEAK


def beside_cuts(contacts):
    """Rows of Contacts: of the first point of each cut that can split, (cuts,), and of the points
    above and below it on either side, (cuts, 4), -1 where a face is free."""
    splits = np.flatnonzero((contacts.kind == CUT) & ~contacts.elastic)[::CUT_POINTS]
    lies = (contacts.kind == BED) | (contacts.kind == CAP)
    ends = contacts.first, contacts.second
    neighbours = np.full((len(splits), 4), -1)
    for k, cut in enumerate(splits):
        for face, (half, side) in enumerate(product(ends, repeat=2)):
            points = np.flatnonzero(lies & (side == half[cut]))
            if len(points):
                away = np.abs(contacts.x[points] - contacts.x[cut])
                neighbours[k, face] = points[np.argmin(away)]
    return splits, neighbours


class Halves(NamedTuple):
    """left, right: numbers of the halves of each body (n_bodies,), both its own number where it is
    whole; bodies: Bodies that are the halves and the bodies that stay whole; n_bricks: of
    these are bricks or halves.

    A left half keeps its brick's number; right halves come behind the other bricks."""

    left: np.ndarray
    right: np.ndarray
    bodies: Any
    n_bricks: int

    def of(self, whole):
        """Numbers of what some bodies, by rising numbers, are now, left halves first."""
        left = self.left[whole]
        right = self.right[whole]
        return np.append(left, right[right != left])

    def of_cells(self, whole, cells):
        """Numbers of the bodies that Cells belong to (n_cells,); whole: Bodies before the cut."""
        middle = middle_of(whole)[cells.body]
        is_right = (cells.left + cells.right) / 2 - TINY > middle
        return np.where(is_right, self.right[cells.body], self.left[cells.body])


def halves_of(brick, bodies, n_bricks, splits):
    """Return the Halves of Bodies, of which the first are bricks, cut from a damage.Brick or
    whole; splits: whether whole ones can split, each of which is cut then."""
    is_whole = np.abs(bodies.length[:n_bricks] - brick.length) < TINY
    cut = np.flatnonzero(is_whole & splits)
    left = np.arange(len(bodies))
    left[n_bricks:] += len(cut)
    right = left.copy()
    right[cut] = n_bricks + np.arange(len(cut))
    side = np.zeros(len(bodies) + len(cut))
    side[cut] = -1.0
    side[right[cut]] = 1.0
    half = taken(bodies, np.insert(np.arange(len(bodies)), n_bricks, cut))
    length = np.where(side, half.length / 2, half.length)
    mass = np.where(side, half.mass / 2, half.mass)
    inertia = np.where(side, inertia_of(mass, length, half.height), half.inertia)
    x = half.x + side * half.length / 4
    halves = replace(half, x=x, length=length, mass=mass, inertia=inertia)
    return Halves(left, right, halves, n_bricks + len(cut))


def middle_of(bodies):
    """Return x [m] halfway between the edges of Bodies, where cuts are (n_bodies,); that is x but
    for its last bit."""
    return ((bodies.x - bodies.length / 2) + (bodies.x + bodies.length / 2)) / 2


def cut_places(brick, z):
    """Return heights of the contact points of a Brick's cut whose middle is at z, upwards, and the
    length of each [m]."""
    places = (np.arange(CUT_POINTS) + 0.5) / CUT_POINTS - 0.5
    return z + places * brick.height, brick.height / CUT_POINTS
