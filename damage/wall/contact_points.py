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
from damage.errors import InputError
from damage.wall import lintels, split
from damage.wall.cells import cells_of, segments_of
from damage.wall.kinds import BED, CAP, CUT, GROUND, HEAD, SIDE_COURSE, TINY, contact_stiffness
from damage.wall.restraints import top_of

MOST_CONTACTS = 100_000
"""Contact points of a wall: a sample holds nine bytes of each."""
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
    breaks; compressive_strength [Pa], infinite where it does not crush; reach [m]: from the contact
    point to the inside of both bodies along the normal.
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
    reach: np.ndarray

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
    """A contact point, or arrays of them: its kind, the facing cells, GROUND below the base, x, z
    and tributary length [m]."""

    kind: int
    first_cell: int
    second_cell: int
    x: float
    z: float
    length: float


def make_contacts(plan, options, bodies, halves):
    """All contact points of a damage.wall.plan.Plan: joints first, then the caps' glue; bodies:
    with whole bricks; halves: damage.wall.split.Halves of these."""
    wall = plan.wall
    brick = wall.brick
    joint = wall.joint
    cells = cells_of(plan, options, bodies)
    _check_count(wall, options, len(cells.body) + plan.n_bricks, halves.n_bricks - plan.n_bricks)
    part = np.append(halves.of_cells(bodies, cells), GROUND)  # of a cell, the last the ground
    points, lintel_cuts = _points(plan, options, bodies, cells, part)
    kind = points.kind
    second = part[points.second_cell]
    # bricks of the base are the first bodies
    support = GROUND - cells.body[points.second_cell] if options.supports == "bricks" else GROUND
    first = np.where(points.first_cell == GROUND, support, part[points.first_cell])
    normal, shear = contact_stiffness(wall, options, halves.bodies, kind, first, second)
    for index, (place, row) in zip(np.flatnonzero(kind == CUT), lintel_cuts):
        normal[index], shear[index] = lintels.cut_stiffness(brick, place, row.x)
    head = kind == HEAD
    middle_x = np.where(head, points.x, (cells.left + cells.right)[points.second_cell] / 2)
    # points at a joint's ends lie at the boundaries of its courses
    middle_z = np.where(head, halves.bodies.z[second], points.z)
    splits = (kind == CUT) & (first < halves.n_bricks)
    elastic = (kind == CAP) | ((kind == CUT) & ~splits)
    elastic |= ~splits & lintels.in_lintel(plan, options.lintel, middle_x, middle_z)
    of_cuts = split.cut_strengths(brick)
    strengths = {
        name: np.select([elastic, splits], [np.inf, of_cut], of_joint)
        for name, of_cut, of_joint in (
            ("tensile_strength", of_cuts[0], joint.tensile_strength),
            ("cohesion", of_cuts[1], joint.cohesion),
            ("compressive_strength", np.inf, joint.compressive_strength or np.inf),
        )
    }
    width = cells.right - cells.left
    narrow = np.minimum(width[points.first_cell], width[points.second_cell])
    return Contacts(
        kind=kind,
        first=first,
        second=second,
        x=points.x,
        z=points.z,
        length=points.length,
        area=points.length * brick.thickness,
        normal_stiffness=normal,
        shear_stiffness=shear,
        elastic=elastic,
        **strengths,
        reach=np.where(head | (kind == CUT), narrow, brick.height) / 2,
    )


def _check_count(wall, options, pairs, cuts):
    """Refuse more contact points than can be computed, by the numbers of facing cells and cuts."""
    number = pairs * len(POINT_POSITIONS[options.contacts]) + split.CUT_POINTS * cuts
    if number > MOST_CONTACTS:
        raise InputError(
            f"wall {wall.name} with {options.cells} cells per half brick has about {number} contact"
            f" points: expected up to {MOST_CONTACTS}; give fewer --cells, or a smaller wall"
        )


def _points(plan, options, bodies, cells, part):
    """Contact points of all joints, lintels, cuts and caps, a _Point of arrays, and the
    (LintelPlace, _Point) of those on the cuts through lintels' beams; part: body of each cell."""
    pairs = _bed_pairs(plan, bodies, cells) + _head_pairs(bodies, plan.n_bricks, cells)
    shared = Counter((part[first], part[second]) for _, first, second in pairs)
    joints = []
    glue = []
    for kind, first, second in pairs:
        alone = shared[part[first], part[second]] == 1
        rows = glue if kind == CAP else joints
        rows += _contact_rows(options, bodies, cells, kind, first, second, alone)
    beside, lintel_cuts = _lintel_rows(plan, options, bodies, cells)
    cuts = [row for _, row in lintel_cuts] + _cut_rows(plan.wall.brick, bodies, cells, part)
    rows = joints + beside + cuts + glue
    return _Point(*map(np.array, zip(*rows))), lintel_cuts


def _cut_rows(brick, bodies, cells, part):
    """Contact points of the cuts between the halves of bricks."""
    middle = split.middle_of(bodies)
    rows = []
    for cell in np.flatnonzero((np.diff(part[:-1]) != 0) & (np.diff(cells.body) == 0)):
        body = cells.body[cell]
        heights, length = split.cut_places(brick, bodies.z[body])
        rows += [_Point(CUT, cell, cell + 1, middle[body], z, length) for z in heights]
    return rows


def scattered(contacts, *scatters):
    """Contacts whose strengths have a factor for each joint by every one of these (coefficient of
    variation, seed); those of bricks' cuts have none."""
    factors = np.ones(len(contacts))
    for variation, seed in scatters:
        factors = factors * _strength_factors(contacts, variation, seed)
    return replace(
        contacts,
        tensile_strength=contacts.tensile_strength * factors,
        cohesion=contacts.cohesion * factors,
    )


def _bed_pairs(plan, bodies, cells):
    """(kind, cell below or GROUND, cell above) of every bed joint, base joint and cap."""
    column = cells.column
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
    of_part = {
        number + k: place
        for k, place in enumerate(place for place in plan.lintels for _ in range(place.parts))
    }
    sides = np.flatnonzero(bodies.course == SIDE_COURSE).tolist()
    ends = (bodies.x - bodies.length / 2, bodies.x + bodies.length / 2)
    low = bodies.z - bodies.height / 2
    high = bodies.z + bodies.height / 2
    beside = []
    cuts = []
    positions = POINT_POSITIONS[options.contacts]
    for part, other in _touching([*of_part, *sides], ends, low, high):
        right_cell = np.searchsorted(cells.body, part, "right") - 1
        pair = right_cell, np.searchsorted(cells.body, other)
        x = ends[1][part]
        place = of_part.get(part)
        other_place = of_part.get(other)
        if place is not None and place is other_place and place.lintel.kind != "arch":
            up, length = lintels.cut_places(place)
            cuts += [(place, _Point(CUT, *pair, x, bodies.z[part] + by, length)) for by in up]
            continue
        bottom = max(low[part], low[other])
        height = min(high[part], high[other]) - bottom
        parts = 1
        if place is not None and other_place is not None:
            segments = round(segments_of(options) * height / (plan.wall.brick.length / 2))
            parts = max(2 // len(positions), segments)
        size = height / parts
        beside += [
            _Point(HEAD, *pair, x, bottom + size * (k + (1 + up) / 2), size / len(positions))
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
        on_right = np.flatnonzero(shares & (np.abs(left - right[part]) < TINY)).tolist()
        on_left = np.flatnonzero(shares & (np.abs(right - left[part]) < TINY)).tolist()
        pairs |= {(part, other) for other in on_right} | {(other, part) for other in on_left}
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


def _contact_rows(options, bodies, cells, kind, first_cell, second_cell, alone):
    """Contact points of one pair of facing cells, as `POINT_POSITIONS` says, but two where it is
    alone in its bed joint; of a cap's glue Gauss points, or else one in the middle of each cell, or
    two under a cap of a single cell."""
    second = cells.body[second_cell]
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
    return [_Point(kind, first_cell, second_cell, x, z, length / len(places)) for x, z in points]


def _strength_factors(contacts, variation, seed):
    """Lognormal factors of mean 1 on the strengths, one for each joint between two bodies, the same
    for every placing of its contact points and for both halves of a brick: (n_contacts,).
    variation: their coefficient of variation [-]."""
    factors = np.ones(len(contacts))
    if variation == 0:
        return factors
    is_joint = contacts.elastic | (contacts.kind != CUT)
    ends = np.maximum([contacts.first, contacts.second], GROUND)
    brick = np.append(np.arange(ends.max() + 1), GROUND)
    brick[contacts.second[~is_joint]] = contacts.first[~is_joint]
    joints, number = np.unique(brick[ends[:, is_joint].T], axis=0, return_inverse=True)
    spread = np.sqrt(log(1.0 + variation * variation))
    normal = Draws(seed).normal(len(joints))
    # a column in numpy 2.0
    factors[is_joint] = exp(spread * normal - spread * spread / 2)[number.ravel()]
    return factors
