"""Tables of a wall that a time step reads and writes, with the unit of each field.

The joint law is homogeneous in the area.  Its parameters here are those of a contact point times
its area, so that it returns forces and works in place of stresses and works per area.

What differs between walls is in arrays (rows, fields, W), the wall last, of one wall or of eight
that step together (`damage.mechanics.simd`); what is equal in all of them has no such axis.
`System` has the tables of one wall, views of these arrays.
"""

from collections import namedtuple
from typing import NamedTuple

import numba
import numpy as np

from damage.law.joint_law import ContactState, ElasticRange, Material
from damage.mechanics.interfaces import Line, Springs
from damage.mechanics.simd import WIDTH, argument

X, Z, ROTATION = range(3)
"""Coordinates of a rigid body, columns of the tables of bodies: displacement since the wall was
built along x and z [m], rotation from x towards z [rad]."""
RIGID = 3
"""Number of coordinates of a rigid body."""
COS1, SIN, PLACE = range(3)
"""Fields of `bodies`: cosine of the rotation less one, its sine, the coordinates from PLACE on,
then their forces."""
VELOCITY, MASS, INVERSE_MASS, MEAN, INERTIAL = range(5)
"""Fields of `inertia`, INERTIAL of them: of coordinate k at INERTIAL k from these."""
OPENED = 3
"""Kind of an event, beside TENSION and SHEAR of the joint law: the opening first exceeds the
threshold of damage."""
SLIPPED = 4
"""Kind of an event: the slip first exceeds the threshold of damage."""
INPUT, FRICTION, FRACTURE, DAMPING = range(4)
"""Entries of `energy` [J]."""
REAL = np.float64
"""Type of real numbers in the tables."""
INDEX = np.uint32
"""Type of indices in the tables."""
ROW = np.uint64
"""Type of row numbers in compiled loops."""
PARTS = 8
"""Number of partial sums over bodies and interfaces: rows 0, 8, 16 and so on, rows 1, 9, 17 and so
on."""
SWEPT_X, SWEPT_Z, DRIVEN, TAKEN, KINETIC, DAMPED, SUMS = range(7)
"""Rows of `sums`: momenta along x and z, power of prescribed velocities, power of damping, kinetic
energy, work of the damping of interfaces."""


class Bench(NamedTuple):
    """The only row of `bench`, parameters of a step: acceleration of the base along x and z, and
    with gravity along z [m/s2]; time step [s]; mass-proportional [1/s] and local damping [-];
    stiffness-proportional damping over the time step [-]; share of a velocity in its new mean
    [-]."""

    base_x: float
    base_z: float
    pull_z: float
    step: float
    alpha: float
    local: float
    rate: float
    follow: float


STEP = Bench._fields.index("step")
TIME_STEP, LOCAL, ALPHA, BETA, ADAPTIVE, FOLLOW = range(6)
"""Columns of `controls`, a row for each wall: time step [s]; local damping [-]; mass-proportional
[1/s] and stiffness-proportional damping [s]; adaptive damping as the share of the rate of change of
the kinetic energy [-]; rate at which means of velocities, which mass-proportional damping leaves
out, follow these [1/s]."""


class Bearing(NamedTuple):
    """A row of `bearings`: stiffness [N/m], limit: largest force while it slips [N], play [m],
    load: mass that the constant load weighs [kg]; slip [m] and force [N] now."""

    stiffness: float
    limit: float
    play: float
    load: float
    slip: float
    force: float


class Beam(NamedTuple):
    """The row of `beam`, a spreader beam between a machine and bodies: place where the machine will
    be after the next step, since the wall was built [m], its velocity [m/s] and force now [N]."""

    place: float
    velocity: float
    force: float


SPRING_STIFFNESS, BEAM_SHARE, SPRING_REST = range(3)
"""Columns of `turning`, a row for each body: stiffness of a rotational spring between it and the
machine that moves it [N m/rad], share of the force of a spreader beam [-], and the rotation at
which the spring has no moment [rad]."""


class Strengths(NamedTuple):
    """Parameters of a contact point: normal and shear stiffness [Pa/m]; strengths [N] and fracture
    energies [J] as of LawParameters, times its area."""

    normal_stiffness: float
    shear_stiffness: float
    tensile_strength: float
    cohesion: float
    mode_i_energy: float
    mode_ii_energy: float
    compressive_strength: float
    crushing_energy: float


class Reading(NamedTuple):
    """Readings of a contact point: opening plus plastic closure, negative under compression, and
    shear displacement [m]; normal stress, tension positive, and shear stress [Pa]."""

    opening: float
    shear: float
    sigma: float
    tau: float


def _row(**fields):
    """Structured dtype of a table from its fields, {type of numpy: their names}."""
    row = np.dtype(
        [(name, kind) for kind, names in fields.items() for name in names.split()], align=True
    )
    # plain Python, too: fields as attributes
    return np.dtype((np.record, row)) if numba.config.DISABLE_JIT else row


INTERFACE = _row(
    f8="ax az bx bz head slide_least slide_most",
    u4="a b start stop",
)
"""Row of an interface, equal in all walls that step together.

ax, az, bx, bz: arms from the centres of bodies a and b to the middle of the contact points [m];
head: 1 for an upright interface, 0 for a bed joint; slide_least, slide_most: shear displacements
down and up to which the two faces overlap, infinite on a support [m]; a, b: rows of the bodies;
start, stop: row of the first contact point, and that after the last one.
"""
LIMITS = "largest_opening", "largest_slide", "failed"
"""Fields of the limits of an interface: of `damage.mechanics.interfaces.ElasticLimits`."""
LARGEST_OPENING, LARGEST_SLIDE, HAS_FAILED = range(3)
"""Fields of `limits`, in the order of LIMITS."""
SPRINGS = Springs._fields
"""Fields of `springs`: what an intact interface needs of its contact points."""
LINES = Line._fields + Springs._fields
"""Fields of `lines`: middle line and springs of an intact interface."""
CONTACT = _row(f8="offset area")
"""Row of a contact point, equal in all walls that step together: offset from the interface's
middle, along +x in bed and -z in head joints [m]; area [m2]."""
STRENGTHS = Strengths._fields
"""Fields of `strengths`."""
READINGS = Reading._fields
"""Fields of `readings`."""
LAST = "opening", "shear", "rotation", "last_normal", "last_shear", "last_couple"
"""Fields of `last`: RelativeMotion and Resultant of the last step."""
OF_STEP = "shear0", "idle", "passed"
"""Fields of a state that the step adds: shear displacement at which the contact had `shear_stress`
[m]; opening up to which the law of a failed, open contact is not evaluated, negative before [m];
thresholds exceeded so far: 1 opened, 2 slipped, 3 both."""
CONTACT_FIELDS = (
    *ContactState._fields,
    *(f"elastic_{name}" for name in ElasticRange._fields),
    *OF_STEP,
)
"""Fields of the state of a contact point: of the joint law, its elastic range, both times its area,
and OF_STEP."""


class System(
    namedtuple(
        "System",
        "place velocity force mass inverse_mass trig interfaces limits contacts strengths states"
        " readings energy events values n_events relaxation last turning beam bearings springs"
        " material",
    )
):
    """Tables of one wall.

    place, velocity, force, mass, inverse_mass: (bodies, coordinates), the supports last, strain
        modes behind the rigid coordinates [m or rad and per second, N or N m, kg or kg m2];
        velocities are those half a step ago; forces are those of the contact points; an inverse
        mass of zero prescribes a velocity
    trig: (bodies, 2) cosine of the rotation less one, and its sine
    interfaces (INTERFACE), limits (LIMITS); contacts (CONTACT), strengths (STRENGTHS), states
        (CONTACT_FIELDS): contacts in the order of their interfaces
    readings: (4, contacts) displacements and stresses at the last sample, READINGS
    energy: (4,) INPUT to DAMPING [J]
    events: (capacity, 3) step, contact, kind; values: (capacity, 4) normal and shear stress [Pa],
        opening and slip [m]; n_events: (1,)
    relaxation: (2,) adaptive mass-proportional damping [1/s], kinetic energy of the last step [J]
    last: (interfaces, LAST) for stiffness-proportional damping; a row for each contact where bricks
    deform
    turning: (bodies, 3) SPRING_STIFFNESS, BEAM_SHARE and SPRING_REST; beam (Beam): (1,)
    bearings (Bearing): (bodies,) what is between a restrained top and the ground, none without
    springs: (interfaces, SPRINGS) of intact interfaces; material: (fields of Material,)
    """

    __slots__ = ()


@argument
class Tables(
    namedtuple(
        "Tables",
        "bodies inertia interfaces limits contacts strengths states readings energy events values"
        " n_events relaxation last turning beam bearings springs material bench"
        " sums others used lines alike first second every",
    )
):
    """Tables of one wall or of eight, with the fields of System that change or differ, (rows,
    fields, W).

    bodies: COS1, SIN, all coordinates, then all forces; inertia: velocity, mass, inverse mass and
    running mean of the velocity of each coordinate; energy, relaxation: (1, fields, W); events,
    values, n_events: the wall first; first, second: (interfaces,) rows of the bodies; every:
    (bodies,) all rows; lines: (blocks of eight interfaces, LINES, 8), copied by `copy_lines`;
    alike: whether all walls have the `springs` of `lines`.

    Work arrays: bench, sums; others: (interfaces,) bits of the walls in which an interface is
    evaluated contact point by contact point; used: (contacts,) 0 where a contact point is an intact
    spring in all walls.

    Tables of a single wall have rows up to a multiple of eight; interfaces there join the last body
    to itself without springs and stay intact.  Its inertia, limits and last are in the order
    of columns: a field of eight rows is a vector.
    """


SHARED = ("interfaces", "contacts")
LOGS = ("events", "values", "n_events")
WORK = "bench", "sums", "others", "used", "lines", "alike", "first", "second", "every"


def make_tables(n_bodies, coordinates, interfaces, contacts, n_bearings, capacity, width=1):
    """Tables of walls with these interfaces and contacts, all else zero; n_bearings: rows of
    `bearings`; capacity: largest number of events."""

    def up(rows):
        return rows if width > 1 else -(-rows // 8) * 8

    c = len(contacts)
    p = up(len(interfaces))
    blocks = -(-len(interfaces) // 8)
    first, second = (np.full(p, n_bodies - 1, INDEX) for _ in range(2))
    first[: len(interfaces)] = interfaces["a"]
    second[: len(interfaces)] = interfaces["b"]

    def zeros(rows, fields):
        return aligned_zeros(rows, fields, width)

    def by_columns(rows, fields):
        return zeros(rows, fields) if width > 1 else aligned_zeros(1, fields, up(rows)).T

    n_last = len(interfaces if coordinates == RIGID else contacts)
    limits = by_columns(len(interfaces), len(LIMITS))
    limits[:, :HAS_FAILED] = np.inf  # places that no wall takes stay intact
    return Tables(
        bodies=zeros(up(n_bodies), 2 + 2 * coordinates),
        inertia=by_columns(n_bodies, INERTIAL * coordinates),
        interfaces=interfaces,
        limits=limits,
        contacts=contacts,
        strengths=zeros(c, len(STRENGTHS)),
        states=zeros(c, len(CONTACT_FIELDS)),
        readings=zeros(c, len(READINGS)),
        energy=zeros(1, 4),
        events=np.zeros((width, capacity, 3), np.int64),
        values=np.zeros((width, capacity, 4)),
        n_events=np.zeros((width, 1), np.int64),
        relaxation=zeros(1, 2),
        last=by_columns(n_last, len(LAST)),
        turning=zeros(n_bodies, 3),
        beam=zeros(1, len(Beam._fields)),
        bearings=zeros(n_bearings, len(Bearing._fields)),
        springs=zeros(len(interfaces), len(SPRINGS)),
        material=zeros(1, len(Material._fields)),
        bench=zeros(1, len(Bench._fields)),
        sums=zeros(SUMS, PARTS),
        others=np.zeros(p, np.uint8),
        used=np.zeros(c, np.uint8),
        lines=aligned_zeros(blocks, len(LINES), 8),
        alike=True,
        first=first,
        second=second,
        every=np.arange(up(n_bodies), dtype=INDEX),
    )


def copy_lines(tables):
    """Copy LINES from the interfaces, and the springs of the first wall, into `lines`."""
    of_line = [tables.interfaces[name] for name in Line._fields]
    for field, values in enumerate([*of_line, *tables.springs[..., 0].T]):
        tables.lines[:, field].flat[: len(values)] = values


def aligned_zeros(*shape):
    """Array of zeros that is aligned to the 64 bytes of a cache line, so that a vector lies in one
    line."""
    n = int(np.prod(shape))
    bytes_ = np.zeros(8 * n + 64, np.uint8)
    first = -bytes_.ctypes.data % 64
    return bytes_[first : first + 8 * n].view(float).reshape(shape)


def join(members):
    """Tables of walls that step together, of one or eight; members: (Tables, place in them) of
    each."""
    old = members[0][0]
    new = make_tables(
        len(old.turning),
        old.inertia.shape[1] // INERTIAL,
        old.interfaces.copy(),
        old.contacts.copy(),
        n_bearings=len(old.bearings),
        capacity=old.events.shape[1],
        width=1 if len(members) == 1 else WIDTH,
    )
    for w, (tables, lane) in enumerate(members):
        logged = {
            "n_events": 1,
            "events": int(tables.n_events[lane, 0]),
            "values": int(tables.n_events[lane, 0]),
        }
        for name, from_, to in zip(Tables._fields, tables, new):
            if name in LOGS:
                # its events as far as there are any
                to[w, : logged[name]] = from_[lane, : logged[name]]
            elif name not in SHARED + WORK:
                rows = min(len(from_), len(to))
                to[:rows, :, w] = from_[:rows, :, lane]
    for table in (new.springs, new.strengths):  # places that no wall takes
        table[..., len(members) :] = table[..., :1]
    copy_lines(new)
    return new._replace(alike=bool((new.springs == new.springs[..., :1]).all()))


def system_of(tables, w):
    """System of wall w of Tables."""
    n = len(tables.turning)
    inertia = tables.inertia[..., w]
    coordinates = inertia.shape[1] // INERTIAL
    damped = len(tables.interfaces if coordinates == RIGID else tables.contacts)
    trig, place, force = np.split(tables.bodies[:n, :, w], [PLACE, PLACE + coordinates], axis=1)
    return System(
        place=place,
        force=force,
        trig=trig,
        velocity=inertia[:n, VELOCITY::INERTIAL],
        mass=inertia[:n, MASS::INERTIAL],
        inverse_mass=inertia[:n, INVERSE_MASS::INERTIAL],
        interfaces=tables.interfaces,
        contacts=tables.contacts,
        limits=tables.limits[: len(tables.interfaces), :, w],
        strengths=_records(tables.strengths, STRENGTHS, w),
        states=_records(tables.states, CONTACT_FIELDS, w),
        readings=tables.readings[..., w].T,
        energy=tables.energy[0, :, w],
        events=tables.events[w],
        values=tables.values[w],
        n_events=tables.n_events[w],
        relaxation=tables.relaxation[0, :, w],
        last=tables.last[:damped, :, w],
        turning=tables.turning[..., w],
        beam=_records(tables.beam, Beam._fields, w),
        bearings=_records(tables.bearings, Bearing._fields, w),
        springs=tables.springs[..., w],
        material=tables.material[0, :, w],
    )


def _records(table, names, w):
    """View of wall w of a table as a structured array with named fields."""
    rows, fields, width = table.shape
    size = 8 * fields * width
    row = np.dtype(
        {
            "names": names,
            "formats": [REAL] * fields,
            "itemsize": size,
            "offsets": [8 * (k * width + w) for k in range(fields)],
        }
    )
    return table.reshape(rows, fields * width).view(row)[:, 0]


def table(dtype, n, **fields):
    """Structured array of n rows with these fields, (n,) or scalars; all other fields are zero."""
    rows = np.zeros(n, dtype)
    for name, values in fields.items():
        rows[name][:] = values
    return rows


@argument
class Strain(NamedTuple):
    """Strain modes of deformable bricks: stiffness, damping: (bodies, modes) of each mode [1/s2,
    1/s], the supports last; shapes: (kinds, 2, modes) displacement along the normal and the tangent
    of a contact point by a unit of each [1/sqrt(kg)]; rows: (contacts, 2) of these, in bodies a and
    b."""

    stiffness: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    rows: np.ndarray


@argument
class Matrix(NamedTuple):
    """Mass matrix of selective mass scaling as a block factor L D L', its nodes in the order of
    elimination; a node has three coordinates of a body.

    body, first, count: (nodes,) row of its body, the first of its coordinates and their number;
    alone: number of nodes, the first ones, whose bodies, in ascending order, have their mass alone;
    start: (nodes + 1,) first block of each column of L; below: (blocks,) node of each block's row;
    lower: (blocks, 9) these blocks; diagonal, inverse: (nodes, 9) blocks of D, zero where massless
    and prescribed, and of its inverse; all three (..., W), (..., 1) where all walls have the same;
    room: (nodes, 6, W) work array.
    """

    body: np.ndarray
    first: np.ndarray
    count: np.ndarray
    alone: int
    start: np.ndarray
    below: np.ndarray
    lower: np.ndarray
    diagonal: np.ndarray
    inverse: np.ndarray
    room: np.ndarray


@argument
class Cuts(NamedTuple):
    """Cuts through bricks that can split: interface: (cuts,) row of each; start: (cuts + 1,) first
    of its rows in contact, (n,) the up to four contacts of the bed joints above and below it;
    strength: (walls,) of the bricks [Pa]."""

    interface: np.ndarray
    start: np.ndarray
    contact: np.ndarray
    strength: np.ndarray


@argument
class Model(namedtuple("Model", "threshold strain matrix cuts")):
    """What walls that step together share besides their tables.

    threshold: of the events OPENED and SLIPPED [m]; cuts: Cuts, of none where bricks stay whole;
    strain: Strain, None of rigid bricks; matrix: Matrix of these walls, None without mass scaling.
    """
