"""The tables of the reference solver, a field a line with its unit: what the compiled step works on."""

from typing import NamedTuple

import numpy as np

OPENED, SLIPPED = 3, 4  # event kinds beside joint_law's TENSION and SHEAR
INPUT, FRICTION, FRACTURE, DAMPING = range(4)  # entries of `energy` [J]
REAL, INDEX, FLAG, BITS = np.float64, np.uint32, np.bool_, np.uint8


def _row(*fields):
    """The dtype of a table's row from its fields: (name, type, unit, meaning)."""
    return np.dtype([(name, kind) for name, kind, _, _ in fields], align=True)


PAIR = _row(
    # What walls that step together share, in the order of `blocks.PAIR`:
    ("ax", REAL, "m", "arm from the centre of body a to the middle of the contacts, along x"),
    ("az", REAL, "m", "the same along z"),
    ("bx", REAL, "m", "arm from the centre of body b, along x"),
    ("bz", REAL, "m", "the same along z"),
    ("kn", REAL, "N/m", "normal stiffness of all contacts together"),
    ("ks", REAL, "N/m", "shear stiffness of all contacts together"),
    ("kn_offset", REAL, "N", "sum of kn offset over the contacts"),
    ("kn_offset2", REAL, "N m", "sum of kn offset^2"),
    ("reach", REAL, "m", "offset of the outermost contact"),
    ("slide_loss", REAL, "-", "by how much an opening at the reach lowers the largest slide"),
    ("head", REAL, "-", "1 for a head joint, 0 for a bed joint"),
    ("a", INDEX, "-", "row of body a"),
    ("b", INDEX, "-", "row of body b"),
    ("start", INDEX, "-", "row of the first contact"),
    ("stop", INDEX, "-", "row after the last one"),
    # and what each has of its own:
    ("broken", INDEX, "-", "1 once a contact is broken, or has softened"),
    ("largest_opening", REAL, "m", "opening at the reach up to which no contact can break"),
    ("largest_slide", REAL, "m", "shear displacement below which none can, at no opening"),
)
SHARED = PAIR.names[:15]
CONTACT = _row(
    ("offset", REAL, "m", "from the pair's middle, along +x in bed and -z in head joints"),
    ("kn", REAL, "N/m", "normal stiffness times area"),
    ("ks", REAL, "N/m", "shear stiffness times area"),
    ("tensile_force", REAL, "N", "tensile strength left times area, zero once broken"),
    ("cohesive_force", REAL, "N", "cohesion left times area, zero once broken"),
    ("shear0", REAL, "m", "shear displacement of the last step once broken, zero before"),
    ("tau0", REAL, "N", "shear force of the last step once broken, zero before"),
    ("idle", REAL, "m", "opening up to which an open contact needs no law, below zero until it is broken"),
    ("kt", REAL, "N/m", "normal stiffness while open times area: kn, or the secant of a bond that softens"),
    ("soft", INDEX, "-", "1 once its bond has softened, until it is broken"),
    ("crushing_force", REAL, "N", "compressive strength times area, infinite where it does not crush"),
    ("closure", REAL, "m", "by how much it is crushed"),
    ("sigma0", REAL, "N", "normal force of the last step where it can crush"),
)
READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU = range(4)
"""Rows of `readings`: normal displacement from where its closure has left its faces, also negative [m], and shear
displacement [m] of a contact, normal stress, tension positive, and shear stress [Pa]."""
JOINT = _row(  # beside its contact
    ("slip", REAL, "m", "plastic slip while closed, signed"),
    ("area", REAL, "m2", ""),
    ("broken", FLAG, "-", "the bond is gone"),
    ("at_limit", FLAG, "-", "has failed in shear or slid, ever"),
    ("passed", BITS, "-", "first passings of the threshold: 1 opened, 2 slipped"),
    ("tensile_force", REAL, "N", "tensile strength of the whole bond times area"),
    ("cohesive_force", REAL, "N", "cohesion of the whole bond times area"),
    ("mode_i", REAL, "J", "mode I fracture energy times area, zero for a brittle bond"),
    ("mode_ii", REAL, "J", "mode II fracture energy times area"),
    ("kappa", REAL, "-", "how far its bond has softened"),
    ("gap", REAL, "m", "largest inelastic opening of a bond that softens"),
)
PLACE = _row(  # of a body
    ("x", REAL, "m", "displacement since the wall was built"),
    ("z", REAL, "m", "the same, upwards"),
    ("cos1", REAL, "-", "cosine of the rotation, less 1"),
    ("sin", REAL, "-", "sine of the rotation"),
    ("fx", REAL, "N", "force of the contacts along x"),
    ("fz", REAL, "N", "force along z"),
    ("moment", REAL, "N m", "about the centre, from x towards z"),
    ("turn", REAL, "rad", "rotation, from x towards z"),
)
MOTION = _row(  # of a body; velocities are those half a step ago
    ("vx", REAL, "m/s", ""),
    ("vz", REAL, "m/s", ""),
    ("spin", REAL, "rad/s", ""),
    ("mass", REAL, "kg", ""),
    ("inertia", REAL, "kg m2", "about the centre"),
    ("inverse_mass_x", REAL, "1/kg", "by which x follows its force; zero where vx is prescribed"),
    ("inverse_mass_z", REAL, "1/kg", "by which z follows its force; zero where vz is prescribed"),
    ("inverse_inertia", REAL, "1/(kg m2)", "by which the rotation follows; zero where spin is prescribed"),
)


class System(NamedTuple):
    """Tables of one wall, a row each: pairs (PAIR), contacts (CONTACT) in the order of their pairs,
    joints (JOINT) beside contacts, place (PLACE) and motion (MOTION) of the bodies and the ground.

    readings: (4, contacts) what a run's last step has left (`read_joints`), an array a quantity: apart from the rows,
    as all of them are written at every sample, and hardly any row;
    energy: (4,); events: (capacity, 3) step, joint, kind; values: (capacity, 4) normal and shear
    stress [Pa], opening and slip [m]; n_events: (1,); relaxation: (2,) the mass-proportional damping that
    adapts itself [1/s], and the kinetic energy of the last step [J].

    The compiled step takes those of several walls at once, which have one more axis before all others: the lane; and
    rows of place and motion are eight plain numbers there.
    """

    pairs: np.ndarray
    contacts: np.ndarray
    joints: np.ndarray
    readings: np.ndarray
    place: np.ndarray
    motion: np.ndarray
    energy: np.ndarray
    events: np.ndarray
    values: np.ndarray
    n_events: np.ndarray
    relaxation: np.ndarray
