"""Contact points on the joints of a wall: where they are, what they connect, how stiff and strong
they are.

Contact points lie on the bed and head joints:

        |       |       |          head joint: normal +x, from the left to the right brick
        +---o---+---o---+  z       bed joint:  normal +z, from the lower to the upper brick
            |       |              o: contact point in the middle of its tributary length
        ----+-------+----

Two bodies that lie on each other share two contact points at least, and so do two parts of a
lintel: a joint of one resists no rotation, and a cut brick that stands on it could turn freely.  A
head joint of bricks has one.
"""

from collections import Counter
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from damage.draws import Draws
from damage.elementary import exp, log
from damage.wall.kinds import BED, CAP, CUT, GROUND, HEAD, SIDE_COURSE, TINY, contact_stiffness
from damage.wall.lintels import cut_places, cut_stiffness, in_lintel
from damage.wall.restraints import top_of
from damage.wall.split import can_split, middle_of

POINT_POSITIONS = {
    "interior": (0.0,),
    "corners": (-1.0, 1.0),
    "gauss": (-1 / np.sqrt(3), 1 / np.sqrt(3)),
}
"""Places of the contact points between two facing cells, along the half length from their middle.
Two Gauss points integrate what is of third order along the cell exactly, and with it the energy of
any opening that is linear."""
_HALVES = (-0.5, 0.5)
"""Places of the contact points of a bed joint of a single cell: the middles of its halves."""


@dataclass(frozen=True)
class Contacts:
    """Contact points, arrays of shape (n_contacts,); the caps' glue comes last.

    kind: BED, HEAD, CUT or CAP; first, second: bodies, the normal points from first to second;
    x, z [m]; length [m] tributary; area [m2]; normal_stiffness, shear_stiffness [Pa/m] with the
    compliance of rigid bricks; tensile_strength, cohesion [Pa], infinite where elastic: never
    breaks; compressive_strength [Pa], infinite where it does not crush;
    first_cell, second_cell: the facing cells (GROUND below the base).
    """

    kind: np.ndarray
    first: np.ndarray
    second: np.ndarray
    x: np.ndarray
    z: np.ndarray
    length: np.ndarray
    area: np.ndarray
    normal_stiffness: np.ndarray
    shear_stiffness: np.ndarray
    elastic: np.ndarray
    tensile_strength: np.ndarray
    cohesion: np.ndarray
    compressive_strength: np.ndarray
    first_cell: np.ndarray
    second_cell: np.ndarray

    def __len__(self):
        return len(self.x)

    @property
    def mortar(self):
        """Which are of joints that may break, bool (n_contacts,)."""
        return ~self.elastic & (self.kind != CUT)

    @property
    def upright(self):
        """Which lie across the wall's length, their normal along +x: head joints and cuts, bool
        (n_contacts,)."""
        return (self.kind == HEAD) | (self.kind == CUT)


class _Point(NamedTuple):
    """A contact point, or arrays of them: fields of Contacts."""

    kind: int
    first: int
    second: int
    first_cell: int
    second_cell: int
    x: float
    z: float
    length: float


def segments_of(options):
    """Segments of a joint of half a brick."""
    return {
        "interior": options.cells,
        "corners": max(1, options.cells - 1),
        "gauss": options.cells // 2,
    }[options.contacts]


def make_contacts(plan, options, bodies, cells, breaks):
    """All contact points of a damage.wall.plan.Plan: joints first, then the caps' glue."""
    wall = plan.wall
    pairs = _bed_pairs(plan, bodies, cells, breaks) + _head_pairs(bodies, plan.n_bricks, cells)
    joints = [
        tuple(_part_of(wall.brick, bodies, cells, cell) for cell in pair[1:]) for pair in pairs
    ]
    shared = Counter(joints)
    rows = [
        row
        for pair, joint in zip(pairs, joints)
        if pair[0] != CAP
        for row in _contact_rows(options, bodies, cells, *pair, alone=shared[joint] == 1)
    ]
    beside, cuts = _lintel_rows(plan, options, bodies, cells)
    rows += beside + [row for _, row in cuts]
    rows += [
        row
        for pair in pairs
        if pair[0] == CAP
        for row in _contact_rows(options, bodies, cells, *pair)
    ]
    points = _Point(*(np.array(column) for column in zip(*rows)))
    kind = points.kind
    normal, shear = contact_stiffness(
        wall, options, bodies, kind=kind, first=points.first, second=points.second
    )
    for index, (place, row) in zip(np.flatnonzero(kind == CUT), cuts):
        normal[index], shear[index] = cut_stiffness(wall.brick, place, row.x)
    head = kind == HEAD
    middle_x = np.where(head, points.x, (cells.left + cells.right)[points.second_cell] / 2)
    # points at a joint's ends lie at the boundaries of its courses
    middle_z = np.where(head, bodies.z[points.second], points.z)
    elastic = (kind == CAP) | (kind == CUT) | in_lintel(plan, options.lintel, middle_x, middle_z)
    joint = wall.joint
    return Contacts(
        **points._asdict(),
        area=points.length * wall.brick.thickness,
        normal_stiffness=normal,
        shear_stiffness=shear,
        elastic=elastic,
        tensile_strength=np.where(elastic, np.inf, joint.tensile_strength),
        cohesion=np.where(elastic, np.inf, joint.cohesion),
        compressive_strength=np.where(elastic, np.inf, joint.compressive_strength or np.inf),
    )


def scattered(wall, contacts, *scatters):
    """Contacts whose strengths have a factor for each joint by every one of these (coefficient of
    variation, seed)."""
    factors = np.ones(len(contacts))
    for scatter in scatters:
        factors = factors * _strength_factors(contacts.first, contacts.second, *scatter)
    return replace(
        contacts,
        **{
            name: np.where(contacts.elastic, np.inf, getattr(wall.joint, name) * factors)
            for name in ("tensile_strength", "cohesion")
        },
    )


def _bed_pairs(plan, bodies, cells, breaks):
    """(kind, cell below or GROUND, cell above) of every bed joint, base joint and cap.

    Facing cells lie between the same two breaks.
    """
    column = np.searchsorted(breaks, (cells.left + cells.right) / 2)
    below = {}
    pairs = []
    n_below_caps = plan.taken.shape[1]
    of_caps = np.full(len(bodies) - n_below_caps, len(plan.runs))  # the course above the wall
    above = BED if top_of(plan.wall) else CAP
    first, last = (np.append(course, of_caps)[cells.body] for course in plan.taken)
    for index in np.lexsort((cells.left, first)):
        under = below.get((first[index] - 1, column[index]))
        below[last[index], column[index]] = index
        if bodies.course[cells.body[index]] == SIDE_COURSE:
            continue
        kind = above if cells.body[index] >= n_below_caps else BED
        if first[index] == 0:
            pairs.append((BED, GROUND, index))
        elif under is not None:
            pairs.append((kind, under, index))
    return pairs


def _lintel_rows(plan, options, bodies, cells):
    """Rows of the contact points beside lintels, at the ends of a beam and around every brick of an
    arch, and beside party walls, and (LintelPlace, row) of those on the cuts through beams."""
    number = plan.n_bricks + len(plan.slabs)
    left_cell, right_cell = (
        {body: cell for cell, body in order}
        for order in (reversed(list(enumerate(cells.body))), enumerate(cells.body))
    )
    of_part = {
        number + k: place
        for k, place in enumerate(place for place in plan.lintels for _ in range(place.parts))
    }
    sides = np.flatnonzero(bodies.course == SIDE_COURSE).tolist()
    ends = (bodies.x - bodies.length / 2, bodies.x + bodies.length / 2)
    half = bodies.height / 2
    beside = []
    cuts = []
    least = 2 // len(POINT_POSITIONS[options.contacts])
    for part, other in _touching([*of_part, *sides], ends, bodies.z - half, bodies.z + half):
        pair = part, other, right_cell[part], left_cell[other]
        x = ends[1][part]
        bottom, top = (
            pick(bodies.z[[part, other]] + sign * half[[part, other]])
            for pick, sign in ((max, -1), (min, 1))
        )
        place = of_part.get(part)
        if place is not None and place is of_part.get(other) and place.lintel.kind != "arch":
            up, length = cut_places(place)
            cuts += [
                (place, _Point(CUT, *pair, x=x, z=bodies.z[part] + by, length=length)) for by in up
            ]
            continue
        both_lintels = place is not None and of_part.get(other)
        segments = round(segments_of(options) * (top - bottom) / (plan.wall.brick.length / 2))
        parts = max(least, segments) if both_lintels else 1
        size = (top - bottom) / parts
        positions = POINT_POSITIONS[options.contacts]
        beside += [
            _Point(
                HEAD,
                *pair,
                x=x,
                z=bottom + size * (k + (1 + up) / 2),
                length=size / len(positions),
            )
            for k in range(parts)
            for up in positions
        ]
    return beside, cuts


def _touching(parts, ends, bottom, top):
    """Pairs (left, right) of bodies whose upright faces touch, one of them at least among these
    parts."""
    left, right = ends
    pairs = set()
    for part in parts:
        shares = (bottom < top[part] - TINY) & (top > bottom[part] + TINY)
        pairs |= {
            (part, int(other))
            for other in np.flatnonzero(shares & (np.abs(left - right[part]) < TINY))
        }
        pairs |= {
            (int(other), part)
            for other in np.flatnonzero(shares & (np.abs(right - left[part]) < TINY))
        }
    return sorted(pairs)


def _head_pairs(bodies, n_bricks, cells):
    """(kind, cell on the left, cell on the right) of every head joint."""
    here = cells.body[:-1]
    right = cells.body[1:]
    met = (
        (right < n_bricks)
        & (here != right)
        & (bodies.course[here] == bodies.course[right])
        & (np.abs(cells.right[:-1] - cells.left[1:]) < TINY)
    )
    return [(HEAD, index, index + 1) for index in np.flatnonzero(met)]


def _part_of(brick, bodies, cells, cell):
    """The body of a cell, or GROUND, and whether the cell is of the right half of a brick that can
    split."""
    if cell == GROUND:
        return GROUND, False
    body = cells.body[cell]
    middle = (cells.left[cell] + cells.right[cell]) / 2
    x = bodies.x[body]
    length = bodies.length[body]
    return body, bool(can_split(brick, length) and middle > middle_of(x, length))


def _contact_rows(options, bodies, cells, kind, first_cell, second_cell, *, alone=False):
    """Contact points of one pair of facing cells, as `POINT_POSITIONS` says, but two where it is
    alone in its bed joint; of a cap's glue Gauss points, or else one in the middle of each cell, or
    two under a cap of a single cell."""
    second = cells.body[second_cell]
    first = cells.body[first_cell]
    if first_cell == GROUND:  # bricks of the base are the first bodies
        first = GROUND - second if options.supports == "bricks" else GROUND
    bottom = bodies.z[second] - bodies.height[second] / 2
    start = np.array([cells.left[second_cell], bottom])
    along = (
        (0.0, bodies.height[second])
        if kind == HEAD
        else (cells.right[second_cell] - cells.left[second_cell], 0.0)
    )
    end = start + along
    length = float(np.sum(end - start))
    # on one point a cap could turn freely
    hinge = kind == CAP and np.count_nonzero(cells.body == second) == 1
    where = options.contacts
    if kind == CAP and where != "gauss":
        where = "corners" if hinge else "interior"
    places = _HALVES if alone and kind == BED and where == "interior" else POINT_POSITIONS[where]
    points = [(1 - place) / 2 * start + (1 + place) / 2 * end for place in places]
    return [
        _Point(kind, first, second, first_cell, second_cell, x=x, z=z, length=length / len(places))
        for x, z in points
    ]


def _strength_factors(first, second, variation, seed):
    """Lognormal factors of mean 1 on the strengths, one for each joint between two bodies, the same
    for every placing of its contact points: (n_contacts,).  variation: their coefficient of
    variation [-]."""
    if variation == 0:
        return np.ones(len(first))
    joints, number = np.unique(
        np.column_stack([np.maximum(first, GROUND), second]), axis=0, return_inverse=True
    )
    spread = np.sqrt(log(1.0 + variation * variation))
    normal = Draws(seed).normal(len(joints))
    return exp(spread * normal - spread * spread / 2)[number.ravel()]  # a column in numpy 2.0
