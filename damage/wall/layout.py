"""From a wall's parameters to bodies, cells and contact points: the one layout of every solver.

Bodies are the bricks, course by course from the base and left to right, then slabs
(`damage.wall.floors`), the parts of lintels (`damage.wall.lintels`), the caps that carry the top
mass, or the beam of a restraint, and party walls (`damage.wall.restraints`).  The supports below
them are bodies -1, -2, ...:
support k is body `damage.wall.kinds.GROUND - k` of contact points, and in tables of all bodies they
follow the caps (`damage.wall.kinds.rows`).  A brick's cells break at every head joint of the wall,
so that facing cells of two courses match.  `damage.wall.plan` says what is built where;
`damage.wall.contact_points` places the contact points.
"""

import math
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from damage.elementary import total
from damage.errors import InputError
from damage.rounded import to_bits
from damage.units import GRAVITY
from damage.wall.contact_points import Contacts, make_contacts, scattered
from damage.wall.floors import with_timber_floors
from damage.wall.kinds import (
    ARCH_COURSE,
    CAP,
    CAP_COURSE,
    CAP_HEIGHT,
    CUT,
    LINTEL_COURSE,
    SIDE_COURSE,
    SLAB_COURSE,
    TINY,
)
from damage.wall.kinematics import slide_limits
from damage.wall.lintels import mass_per_length
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Wall
from damage.wall.plan import Plan, plan_of
from damage.wall.restraints import THICK_M, top_of
from damage.wall.soil import on_soil
from damage.wall.split import halves_of
from damage.wall.strain import Strain, strain_of
from damage.wall.tables import concatenated, inertia_of


@dataclass(frozen=True)
class Bodies:
    """Bricks, slabs, lintels and caps; every array has shape (n_bodies,).

    x, z [m] centres; length, height [m]; mass [kg]; inertia [kg m2] about y;
    course: 0 at the base, -1 for a cap, -2 for a slab, -3 for a part of a beam, -4 for a brick of
    an arch, -5 for a party wall, which has no mass.
    """

    x: np.ndarray
    z: np.ndarray
    length: np.ndarray
    height: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    course: np.ndarray

    def __len__(self):
        return len(self.x)


@dataclass(frozen=True)
class Supports:
    """The ground below the base as bodies whose motion is prescribed, with reference points at z =
    0; left, right [m]: the part of the base that each carries, (n_supports,).

    >>> Supports(np.array([0.0, 0.4]), np.array([0.4, 1.0])).x.tolist()
    [0.2, 0.7]
    """

    left: np.ndarray
    right: np.ndarray

    def __len__(self):
        return len(self.left)

    @property
    def x(self) -> np.ndarray:
        """Reference points along the wall, (n_supports,) [m]."""
        return (self.left + self.right) / 2


def contact_normals(contacts: Contacts) -> np.ndarray:
    """Unit normals (n_contacts, 2) from first to second: +x across head joints, +z else.

    >>> contact_normals(lay_out(Wall("pier", 0.9, 1.5)).contacts)[:1].tolist()
    [[0.0, 1.0]]
    """
    head = contacts.upright
    return np.column_stack([head, ~head]).astype(float)


@dataclass(frozen=True)
class Layout:
    """A wall laid out under given options.

    wall: as given; plan: of what is built.
    n_joints: the first n_joints contacts are joints, behind them the cuts where bricks can split;
        the rest is the caps' glue.
    n_bricks: bodies that are bricks, or parts of them (`damage.wall.split`); those of slabs and
    lintels follow.
    drift_bodies: bricks of the plan's drift course whose centres stand over piers; drift_height [m]
    of them.
    supports: below the base.
    strain: of the bricks where they deform, else None.

    Class variables say how it differs from that of a house (`damage.house.space.HouseLayout`):
    IN_SPACE, whether bodies move out of the plane of their wall; HORIZONTAL and TRANSLATIONS,
    numbers of coordinates; SHEAR, type of a shear displacement; MOTION_AXES, components of the
    motion of the base; BASE_COLUMNS, of the rigid motion of the base in a history.

    >>> layout = lay_out(Wall("pier", 0.9, 1.5, precompression=0.3e6))
    >>> round(layout.total_mass), round(layout.top_mass), round(layout.pier_stress)  # [kg], [Pa]
    (3084, 2821, 300000)
    >>> round(layout.total_joint_length, 2), layout.joint_length[:2].round(4).tolist()  # [m]
    (23.25, [0.0562, 0.0562])
    >>> layout.pushed_bodies.tolist(), layout.push_shares(())[layout.pushed_bodies].tolist()
    ([90], [1.0])
    """

    IN_SPACE: ClassVar = False
    HORIZONTAL: ClassVar = (0,)
    TRANSLATIONS: ClassVar = (0, 1)
    SHEAR: ClassVar = float
    MOTION_AXES: ClassVar = 2
    BASE_COLUMNS: ClassVar = ("base_translation_m", "base_rotation_rad")

    wall: Wall
    plan: Plan
    options: ModelOptions
    bodies: Bodies
    contacts: Contacts
    n_bricks: int
    n_joints: int
    drift_bodies: np.ndarray
    drift_height: float
    supports: Supports
    strain: Strain | None = None

    @property
    def n_bodies(self) -> int:
        """Number of all bodies."""
        return len(self.bodies)

    @property
    def n_below_caps(self) -> int:
        """Number of bricks, slabs and parts of lintels."""
        # bricks that are cut are more here
        return self.n_bricks - self.plan.n_bricks + self.plan.taken.shape[1]

    @property
    def total_joint_length(self) -> float:
        """Length of all bed, head and base joints [m], the caps' glue and bricks' cuts excluded."""
        return float(self.joint_length.sum())

    @property
    def joint_length(self) -> np.ndarray:
        """Length of joint that each of the first n_joints contacts stands for, none on a brick's
        cut [m]."""
        n = self.n_joints
        return np.where(self.contacts.kind[:n] == CUT, 0.0, self.contacts.length[:n])

    @property
    def ground(self):
        """Supports by their places along a settlement."""
        return self.supports

    @property
    def building(self):
        """The damage.Wall, or House, that is laid out."""
        return self.wall

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The damage.Walls that are laid out."""
        return self.building.each_wall

    @property
    def more_tables(self) -> dict:
        """{group of a history: arrays} of where walls and contact points are in a house."""
        return {}

    @property
    def house_parameters(self) -> dict:
        """{"house": parameters of a house, for files}."""
        return {}

    def of_contacts(self, values: Sequence) -> np.ndarray:
        """Value of each contact point (n_contacts,) of those of the walls."""
        return np.full(len(self.contacts), values[0])

    def inner(self, joints: np.ndarray) -> np.ndarray:
        """Contact points beside these, towards the middle of the thickness."""
        return np.zeros(0, int)

    def box(self, body: int) -> tuple[tuple[float, ...], np.ndarray]:
        """Centre (x, y, z) and size of a body (3,) [m].

        >>> [round(float(value), 4) for value in np.ravel(lay_out(Wall("pier", 0.9, 1.5)).box(0))]
        [0.1125, 0.0, 0.0375, 0.225, 0.1025, 0.075]
        """
        bodies = self.bodies
        centre = float(bodies.x[body]), 0.0, float(bodies.z[body])
        return centre, np.array(
            [bodies.length[body], self.wall.brick.thickness, bodies.height[body]]
        )

    @property
    def places(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places and normals of the contact points in the wall of each of their two bodies (2,
        n_contacts, 3), x along it, y through its thickness and z upwards [m]; and the distance
        (n_contacts,) [m] from there to the inside of both bodies."""
        contacts = self.contacts
        nothing = np.zeros(len(contacts))
        upright = contacts.upright
        place = np.column_stack([contacts.x, nothing, contacts.z])
        normal = np.column_stack([upright, nothing, ~upright]).astype(float)
        return np.stack([place] * 2), np.stack([normal] * 2), contacts.reach

    @property
    def slide_limits(self) -> np.ndarray:
        """Shear displacements between which the faces of each contact point's joint overlap, least
        and most (2, n_contacts) [m]."""
        contacts = self.contacts
        return np.array(
            slide_limits(contacts.first, contacts.second, contacts.upright, self.bodies)
        )

    @property
    def rigid_mass(self) -> np.ndarray:
        """Mass and inertia of the bodies' rigid coordinates (n_bodies, 3), zero of those that
        restraints hold [kg, kg, kg m2]."""
        bodies = self.bodies
        mass = np.column_stack([bodies.mass, bodies.mass, bodies.inertia])
        return np.where(self.restrained, 0.0, mass)

    @property
    def directions(self) -> list[np.ndarray]:
        """What a unit of each coordinate of the first and the second body of each contact adds to
        the relative displacement of second to first across and along the joint, and in space
        through the thickness, a list of (2, n_contacts, coordinates); zero on the ground."""
        return [self._rows(direction) for direction in range(self.MOTION_AXES)]

    def _rows(self, direction):
        ends = self.contacts.first, self.contacts.second
        moving = [np.flatnonzero(body >= 0) for body in ends]
        by_unit = [self._by_unit(side, moving[side], direction) for side in (0, 1)]
        rows = np.zeros((2, len(self.contacts), by_unit[1].shape[1]))
        rows[0, moving[0]] = -by_unit[0]
        rows[1, moving[1]] = by_unit[1]
        return rows

    def _by_unit(self, side, points, direction):
        """Displacement of these contact points in a direction by a unit of each coordinate of their
        first or second body, (n, coordinates)."""
        contacts = self.contacts
        bodies = self.bodies
        strain = self.strain
        index = (contacts.first, contacts.second)[side][points]
        rx = contacts.x[points] - bodies.x[index]
        rz = contacts.z[points] - bodies.z[index]
        dx = (contacts.upright[points] == (direction == 0)).astype(float)
        dz = 1 - dx
        modes = ()
        if strain is not None:
            modes = strain.shapes[(strain.first, strain.second)[side][points], direction].T
        return np.column_stack([dx, dz, dz * rx - dx * rz, *modes])

    @property
    def elastic_arrays(self) -> tuple:
        """What stiffness depends on beside the bodies and the contact points' own numbers."""
        strain = self.strain
        return () if strain is None else (strain.mass, strain.stiffness, strain.shapes)

    @property
    def bases(self) -> list[tuple[np.ndarray, float]]:
        """Bodies of the lowest course and height of the drift above the ground [m] of each wall, a
        list of (indices, height)."""
        return [(np.flatnonzero(self.bodies.course == 0), self.drift_height)]

    def tops(self, motion: np.ndarray) -> np.ndarray:
        """Displacement along each wall of its top over the piers (n, n_walls) [m]; motion: (n,
        n_bodies, 3)."""
        top = motion[:, :, 0].take(self.drift_bodies, axis=1)
        return np.add.reduce(top, axis=1, keepdims=True) / top.shape[1]

    def top_and_drift(self, tops: np.ndarray, of_base: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement of the top [m] and drift ratio [-], both (n,).

        tops: `tops`; of_base: by what the rigid motion of the base moves them (n, n_walls) [m].
        """
        top = tops[:, 0]
        return top, (top - of_base[:, 0]) / self.drift_height

    @property
    def pushed_bodies(self) -> np.ndarray:
        """Bodies that a quasi-static loading moves: the caps; the drift course where there are
        none, or a restraint holds the top."""
        caps = np.flatnonzero(self.bodies.course == CAP_COURSE)
        return caps if len(caps) and top_of(self.wall) is None else self.drift_bodies

    def push_shares(self, floor_shares: Sequence) -> np.ndarray:
        """Share of a push that each body takes, (n_bodies,) [-]: that of its floor by mass.

        floor_shares: ((level [m], share [-]), ...), none for the top.  Raises InputError for a
        level that is neither a floor's nor the wall's.
        """
        shares = np.zeros(len(self.bodies))
        mass = self.bodies.mass
        for level, share in floor_shares or ((None, 1.0),):
            on = self.pushed_bodies if level is None else self._carries(level)
            shares[on] += share * mass[on] / total(mass[on])
        return to_bits(shares / total(shares))

    def _carries(self, level):
        """Indices of the bodies that carry the floors, or the top, at this level [m]."""
        wall = self.wall
        bodies = self.bodies
        course = self.wall.brick.height
        places = [place for place in self.plan.floors if place.above == round(level / course)]
        if places:
            of_course = np.abs(bodies.z - (places[0].above - 0.5) * course) < bodies.height / 2
            over = [
                (bodies.x - bodies.length / 2 < right - TINY)
                & (bodies.x + bodies.length / 2 > left + TINY)
                for _, left, right, _, _ in places
            ]
            return np.flatnonzero(of_course & np.any(over, axis=0))
        if wall.courses == round(level / course):
            return self.pushed_bodies
        levels = sorted({wall.height, *(floor.level for floor in wall.floors)})
        raise InputError(
            f"--floor-share at {level:g} m: wall {wall.name} has no floor there, expected one of"
            f" {', '.join(f'{level:g}' for level in levels)} m; correct it"
        )

    def height_of_push(self, floor_shares: Sequence = ()) -> float:
        """Height at which a push is measured [m]: of the drift, or of the resultant on these
        floors.

        >>> round(float(lay_out(Wall("pier", 0.9, 1.5)).height_of_push()), 4)
        1.4625
        """
        if not floor_shares:
            return self.drift_height
        return float(total(self.push_shares(floor_shares) * self.bodies.z))

    @property
    def top_mass(self) -> float:
        """Mass of the precompression [kg]."""
        return _top_mass(self.plan, self.options)

    @property
    def pier_stress(self) -> float:
        """Vertical stress in the piers by that mass [Pa], without the bricks above."""
        return self.top_mass * GRAVITY / (_length(self.plan.piers) * self.wall.brick.thickness)

    @property
    def total_mass(self) -> float:
        """Mass that the base carries [kg]: bricks and top mass, a constant load with it."""
        return float(self.weighing.sum())

    @property
    def restrained(self) -> np.ndarray:
        """Coordinates whose velocity restraints prescribe, bool (n_bodies, 3)."""
        beam = self.bodies.course == CAP_COURSE
        top = top_of(self.wall)
        restrained = np.repeat(self.bodies.course == SIDE_COURSE, 3).reshape(-1, 3)
        if top:
            restrained[beam] = [top.stiffness is None, False, top.rotation == "fixed"]
        return restrained

    @property
    def weighing(self) -> np.ndarray:
        """Masses (n_bodies,) [kg] whose weight the bodies have: their own, and the constant load on
        a restrained top."""
        return self.bodies.mass + self.load_mass

    @property
    def load_mass(self) -> np.ndarray:
        """What the constant load on a restrained top weighs, (n_bodies,) [kg]."""
        load = self.top_mass - self.bodies.mass if top_of(self.wall) else 0.0
        return np.where(self.bodies.course == CAP_COURSE, load, 0.0)


def lay_out(
    wall: Wall, options: ModelOptions | None = None, *, scatter: float = 0.0, seed: int = 0
) -> Layout:
    """Lay a wall out: bricks in running bond, caps, cells and contact points.

    scatter: coefficient of variation [-] of a second factor on each joint's strengths, beside that
    of the options; by its seed the members of an ensemble differ.
    Raises InputError where the openings' edges leave cells too narrow to compute with, or there are
    too many.

    >>> layout = lay_out(Wall("pier", 0.9, 1.5))
    >>> layout.n_bricks, layout.n_joints
    (90, 390)
    """
    options = options or ModelOptions()
    alike = _lay_out_alike(wall, replace(options, strength_cov=0.0, strength_seed=0))
    layout = deepcopy(alike, {id(alike.plan): alike.plan})  # a plan never changes
    layout = replace(
        layout,
        wall=wall,
        options=options,
        contacts=scattered(
            layout.contacts,
            (options.strength_cov, options.strength_seed),
            (scatter, (seed, 1)),
        ),
    )
    return _rounded(on_soil(layout))


def _rounded(layout):
    """The Layout with masses, stiffnesses and strengths of fewer bits (`damage.rounded`)."""

    def rounded(table, *names):
        return replace(table, **{name: to_bits(getattr(table, name)) for name in names})

    return replace(
        layout,
        bodies=rounded(layout.bodies, "mass", "inertia"),
        contacts=rounded(
            layout.contacts,
            "normal_stiffness",
            "shear_stiffness",
            "tensile_strength",
            "cohesion",
            "compressive_strength",
        ),
    )


@lru_cache(maxsize=4)
def _lay_out_alike(wall, options):
    """The Layout whose joints are all as strong as the wall says: what members of an ensemble
    share."""
    plan = plan_of(wall, options)
    bodies = _make_bodies(plan, options)
    drift_bodies = _find_drift_bodies(plan, bodies)
    splits = wall.brick.splits and not options.has_modes
    halves = halves_of(wall.brick, bodies, plan.n_bricks, splits)
    contacts = make_contacts(plan, options, bodies, halves)
    return Layout(
        wall=wall,
        plan=plan,
        options=options,
        bodies=halves.bodies,
        contacts=contacts,
        n_bricks=halves.n_bricks,
        n_joints=int(np.sum(contacts.kind != CAP)),
        drift_bodies=halves.of(drift_bodies),
        drift_height=float(bodies.z[drift_bodies].mean()),
        supports=_supports_below(bodies, wall.length, options.supports),
        strain=(
            strain_of(wall.brick, options, bodies, contacts, plan.n_bricks)
            if options.has_modes
            else None
        ),
    )


# --- bricks -------------------------------------------------------------------------------------


def _length(spans):
    """Length of all spans (left, right) together [m]."""
    return math.fsum(right - left for left, right in spans)


def _top_mass(plan, options):
    """Mass of the precompression over the length, or over the piers [kg]."""
    return plan.wall.top_mass * (
        _length(plan.piers) / plan.wall.length if options.load == "piers" else 1.0
    )


def _make_bodies(plan, options):
    """Bricks, slabs and lintels, with the masses that are spread over them, and caps for a top mass
    that is not spread."""
    brick = plan.wall.brick
    top_mass = _top_mass(plan, options)
    (first, last) = plan.taken
    n = plan.n_bricks
    length = plan.ends[1] - plan.ends[0]
    height = (last + 1 - first) * brick.height
    mass = brick.density * length * height * brick.thickness
    course = first.copy()
    behind = n + len(plan.slabs)
    mass[n:behind] = [slab.floor.mass for slab in plan.slabs]
    course[n:behind] = SLAB_COURSE
    parts = [place for place in plan.lintels for _ in range(place.parts)]
    mass[behind:] = np.array([mass_per_length(brick, place) for place in parts]) * length[behind:]
    course[behind:] = [
        ARCH_COURSE if place.lintel.kind == "arch" else LINTEL_COURSE for place in parts
    ]
    bodies = with_timber_floors(
        plan,
        _blocks(
            x=plan.ends.mean(axis=0),
            z=(first + last + 1) / 2 * brick.height,
            length=length,
            height=height,
            mass=mass,
            course=course,
        ),
    )
    if plan.wall.restraints:
        return _with_restraints(plan, options, bodies, top_mass)
    if top_mass and options.top == "uniform":
        return _with_spread_mass(plan, bodies, top_mass)
    return _with_caps(plan, options, bodies, top_mass) if top_mass else bodies


def _with_restraints(plan, options, bodies, top_mass):
    """Bodies, and behind them caps, or the beam of a restraint, and party walls."""
    wall = plan.wall
    top = top_of(plan.wall)
    if options.top == "uniform":
        raise InputError(
            f"--top uniform with restraints of wall {wall.name}: expected a top mass of its own,"
            " which a beam carries; leave --top out"
        )
    if top is None:
        bodies = _with_caps(plan, options, bodies, top_mass) if top_mass else bodies
    else:
        mass = top_mass if top.mass is None else top.mass
        if mass > top_mass * (1 + TINY):
            raise InputError(
                f"wall {wall.name}: a restraint's beam of {mass:g} kg: expected up to the"
                f" {top_mass:.4g} kg that the precompression weighs; give less, or more"
                " precompression"
            )
        beam = _blocks(
            x=wall.length / 2,
            z=wall.built_height + THICK_M / 2,
            length=wall.length,
            height=THICK_M,
            mass=mass,
            course=CAP_COURSE,
        )
        bodies = concatenated([bodies, beam])
    sides = [restraint.side for restraint in wall.restraints if restraint.side != "top"]
    party_walls = _blocks(
        x=[-THICK_M / 2 if side == "left" else wall.length + THICK_M / 2 for side in sides],
        z=wall.built_height / 2,
        length=THICK_M,
        height=wall.built_height,
        mass=0.0,
        course=SIDE_COURSE,
    )
    return concatenated([bodies, party_walls])


def _with_spread_mass(plan, bodies, top_mass):
    """The top mass added to bricks and lintels of the top course in proportion to length, inertia
    growing with mass; to its slabs where they are all of it."""
    in_course = plan.taken[1] == len(plan.runs) - 1
    top = in_course & (bodies.course != SLAB_COURSE)
    top = top if top.any() else in_course
    carrying = _length(plan.runs[-1]) + bodies.length[plan.n_bricks :][top[plan.n_bricks :]].sum()
    factor = np.where(top, 1 + top_mass * bodies.length / carrying / bodies.mass, 1.0)
    return replace(bodies, mass=bodies.mass * factor, inertia=bodies.inertia * factor)


def _with_caps(plan, options, bodies, top_mass):
    """Bodies, and behind them one rigid cap a pier, or one over all, mass shared by length."""
    spans = np.array(plan.piers if options.top == "piers" else ((0.0, plan.wall.length),))
    width = spans[:, 1] - spans[:, 0]
    caps = _blocks(
        x=spans.mean(axis=1),
        z=plan.wall.built_height + CAP_HEIGHT / 2,
        length=width,
        height=CAP_HEIGHT,
        mass=top_mass * width / width.sum(),
        course=CAP_COURSE,
    )
    return concatenated([bodies, caps])


def _blocks(*, x, z, length, height, mass, course):
    """Bodies that are blocks, by numbers or arrays (n,)."""
    inertia = inertia_of(mass, length, height)
    columns = np.broadcast_arrays(x, z, length, height, mass, inertia, course)
    return Bodies(*map(np.atleast_1d, columns))


def _find_drift_bodies(plan, bodies):
    """Bricks of the drift course with their centre inside a pier, one on a pier's very edge left
    out; a slab where it takes the course's place."""
    top = np.flatnonzero(bodies.course[: plan.n_bricks] == plan.drift_course)
    if not len(top):
        return np.flatnonzero(plan.taken[1] == plan.drift_course)
    over = [
        any(left + TINY < x < right - TINY for left, right in plan.piers) for x in bodies.x[top]
    ]
    return top[over] if any(over) else top


def _supports_below(bodies, length, kind):
    """The Supports of a wall of this length [m]: "one" below all of it, or "bricks": one below each
    brick of the base."""
    if kind == "one":
        return Supports(np.array([0.0]), np.array([float(length)]))
    base = bodies.course == 0
    half = bodies.length[base] / 2
    return Supports(bodies.x[base] - half, bodies.x[base] + half)
