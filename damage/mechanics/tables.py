"""Tables of a wall that a time step reads and writes, with the unit of each field.

The joint law is homogeneous in the area.  Its parameters here are those of a contact point times its area, so that it
returns forces and works in place of stresses and works per area.
"""

from typing import NamedTuple

import numba
import numpy as np

from damage.wall.joint_law import ContactState, ElasticRange, Material

X, Z, ROTATION = range(3)
"""Coordinates of a rigid body, columns of the tables of bodies: displacement since the wall was built along x and z
[m], rotation from x towards z [rad]."""
RIGID = 3
"""Number of coordinates of a rigid body."""
OPENED, SLIPPED = 3, 4
"""Kinds of events besides TENSION and SHEAR of the joint law: opening or slip first exceeds the threshold of damage."""
INPUT, FRICTION, FRACTURE, DAMPING = range(4)
"""Entries of `energy` [J]."""
REAL, INDEX = np.float64, np.uint32


def _row(*fields):
    """Structured dtype of a table from its fields (name, type, unit, meaning)."""
    row = np.dtype([(name, kind) for name, kind, _, _ in fields], align=True)
    return np.dtype((np.record, row)) if numba.config.DISABLE_JIT else row  # plain Python, too: fields as attributes


INTERFACE = _row(
    # Equal in all walls of a batch, in the order of the blocks of the fast step:
    ("ax", REAL, "m", "arm from the centre of body a to the middle of the contact points, along x"),
    ("az", REAL, "m", "the same along z"),
    ("bx", REAL, "m", "arm from the centre of body b, along x"),
    ("bz", REAL, "m", "the same along z"),
    ("kn", REAL, "N/m", "normal stiffness of all contact points together"),
    ("ks", REAL, "N/m", "shear stiffness of all contact points together"),
    ("kn_offset", REAL, "N", "sum of kn offset over the contact points"),
    ("kn_offset2", REAL, "N m", "sum of kn offset^2"),
    ("reach", REAL, "m", "offset of the outermost contact point"),
    ("slide_loss", REAL, "-", "reduction of the largest elastic shear displacement by an opening at the reach"),
    ("head", REAL, "-", "1 for an upright interface, 0 for a bed joint"),
    ("a", INDEX, "-", "row of body a"),
    ("b", INDEX, "-", "row of body b"),
    ("start", INDEX, "-", "row of the first contact point"),
    ("stop", INDEX, "-", "row after the last one"),
    ("slide_least", REAL, "m", "shear displacement down to which the two faces overlap"),
    ("slide_most", REAL, "m", "the same upwards; both infinite on a support"),
    # Different in each wall:
    ("failed", INDEX, "-", "FAILED once a contact point has failed, softened or been crushed, then ENDING, ENDED"),
    ("largest_opening", REAL, "m", "opening at the reach up to which no contact point leaves its elastic range"),
    ("largest_slide", REAL, "m", "shear displacement up to which none does, without opening"),
)
SHARED = INTERFACE.names[:17]
FAILED, ENDING, ENDED = 1, 2, 3
"""Values of `failed`; ENDING: the two faces ceased to overlap in this step; ENDED: before, and forces are zero."""
CONTACT = _row(  # parameters of a contact point, times its area
    ("offset", REAL, "m", "from the interface's middle, along +x in bed and -z in head joints"),
    ("area", REAL, "m2", ""),
    ("kn", REAL, "N/m", "normal stiffness"),
    ("ks", REAL, "N/m", "shear stiffness"),
    ("tensile_strength", REAL, "N", "of the intact bond"),
    ("cohesion", REAL, "N", "of the intact bond"),
    ("mode_i_energy", REAL, "J", "zero for a brittle bond"),
    ("mode_ii_energy", REAL, "J", "zero for a brittle bond"),
    ("compressive_strength", REAL, "N", "infinite where it does not crush"),
    ("crushing_energy", REAL, "J", "zero where the compressive strength stays"),
)
STATE = _row(  # state of a contact point: of the joint law, its elastic range, and of the time step
    *((name, REAL, "", "as of the joint law, times area") for name in ContactState._fields),
    *((f"elastic_{name}", REAL, "", "as of the joint law, times area") for name in ElasticRange._fields),
    ("shear0", REAL, "m", "shear displacement at which the contact had `shear_stress`"),
    ("idle", REAL, "m", "opening up to which the law of a failed, open contact is not evaluated; negative before"),
    ("passed", REAL, "-", "thresholds exceeded so far: 1 opened, 2 slipped, 3 both"),
)
STATE_FIELDS = len(STATE.names)
READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU = range(4)
"""Rows of `readings` of a contact point: opening plus plastic closure, negative under compression, and shear
displacement [m]; normal stress, tension positive, and shear stress [Pa]."""


class System(NamedTuple):
    """Tables of one wall.

    place, velocity, force, mass, inverse_mass: (bodies, coordinates), the supports last, strain modes behind the rigid
        coordinates [m or rad and per second, N or N m, kg or kg m2]; velocities are those half a step ago; forces are
        those of the contact points; an inverse mass of zero prescribes a velocity
    trig: (bodies, 2) cosine of the rotation less one, and its sine
    interfaces (INTERFACE), contacts (CONTACT), states (STATE): contacts and states in the order of their interfaces
    readings: (4, contacts) displacements and stresses at the last sample, READ_OPENING to READ_TAU
    energy: (4,) INPUT to DAMPING [J]
    events: (capacity, 3) step, contact, kind; values: (capacity, 4) normal and shear stress [Pa], opening and slip [m];
        n_events: (1,)
    relaxation: (2,) adaptive mass-proportional damping [1/s], kinetic energy of the last step [J]
    last: (interfaces, 6) relative motion and resultant of the last step, for stiffness-proportional damping; a row for
        each contact where bricks deform
    turning: (bodies, 2) rotational spring between a body and the machine that moves it [N m/rad], and the rotation at
        which it has no moment [rad] (plain step)
    radiation: (rows of `last`, 5) dashpots of the soil, none (0, 5) without soil: damping over stiffness across and
        along the interface [s], and their resultant in the last step [N, N m] (plain step)

    The fast step takes the tables of several walls, stacked along a first axis.
    """

    place: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    mass: np.ndarray
    inverse_mass: np.ndarray
    trig: np.ndarray
    interfaces: np.ndarray
    contacts: np.ndarray
    states: np.ndarray
    readings: np.ndarray
    energy: np.ndarray
    events: np.ndarray
    values: np.ndarray
    n_events: np.ndarray
    relaxation: np.ndarray
    last: np.ndarray
    turning: np.ndarray
    radiation: np.ndarray


def table(dtype, n, **fields):
    """Structured array of n rows with these fields, (n,) or scalars; all other fields are zero."""
    rows = np.zeros(n, dtype)
    for name, values in fields.items():
        rows[name][:] = values
    return rows


class Strain(NamedTuple):
    """Strain modes of deformable bricks, none of rigid ones: stiffness, damping: (bodies, modes) of each mode [1/s2,
    1/s], the supports last; shapes: (kinds, 2, modes) displacement along the normal and the tangent of a contact point
    by a unit of each [1/sqrt(kg)]; rows: (contacts, 2) of these, in bodies a and b."""

    stiffness: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    rows: np.ndarray


class Law(NamedTuple):
    """Joint law of a wall: Material, threshold of the events OPENED and SLIPPED [m]; and the Strain of its bricks."""

    material: Material
    threshold: float
    strain: Strain


class Controls(NamedTuple):
    """Time step [s] and damping: local (Cundall's) [-], mass-proportional alpha [1/s], stiffness-proportional beta [s],
    adaptive as the share of the rate of change of the kinetic energy [-]."""

    time_step: float
    local: float
    alpha: float
    beta: float
    adaptive: float


class Scratch(NamedTuple):
    """Work arrays of a step; others: (interfaces,) indices of those that are not intact; sums: (5, PARTS)."""

    others: np.ndarray
    sums: np.ndarray
