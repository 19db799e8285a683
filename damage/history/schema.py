"""Names, codes, units and meanings in the history file, shown in
`docs/reference/history-schema.md`; and `measure`, the decorator of functions that make columns of
summary.csv."""

from functools import wraps
from inspect import signature

from damage.fields import Column

SCHEMA = "masonry-damage-history"
SCHEMA_VERSION = 9
STATUS = ("unfinished", "complete", "interrupted", "failed")
STAGES = ("motion", "rest", "settling", "settlement")
EVENTS = ("tension", "shear", "opened", "slipped")


def each(columns):
    """{name: Column} from {"name, name": Column}, each with its own unit.

    >>> each({"period_s, amplitude_g": Column("s, g", "of a motion")})["amplitude_g"]
    Column(unit='g', meaning='of a motion', dtype='f8', least=-inf, most=inf)
    """
    by_name = {}
    for several, column in columns.items():
        singles = several.split(", ")
        units = column.unit.split(", ")
        units = units if len(units) == len(singles) else [column.unit] * len(singles)
        by_name |= {name: column._replace(unit=unit) for name, unit in zip(singles, units)}
    return by_name


def measure(columns):
    """Decorator of a function that makes the measures {"name, name": Column} of a run, units at the
    names' ends.

    The function returns their values, a tuple where they are several, or None where none of them
    applies; what becomes of it returns {name: value}.  Its arguments are called `history`, as those
    of `damage.measure.summary.summarise`, or as a measure of a section before its own, and get
    that.
    """
    named = list(each(columns))

    def with_names(function):
        @wraps(function)
        def values(*given, **more):
            result = function(*given, **more)
            result = (
                (None,) * len(named) if result is None else result if len(named) > 1 else (result,)
            )
            return dict(zip(named, result, strict=True))

        values.columns = columns
        values.arguments = tuple(signature(function).parameters)
        return values

    return with_names


STATIC = {
    "base_reaction_n": Column("N", "vertical force on the ground"),
    "weight_n": Column("N", "weight of the layout"),
    "unbalanced_force": Column("1", "mean resultant on a body over mean contact force"),
    "broken_joints": Column("1", "contact points broken before the motion"),
    "duration_s": Column("s", "length of the static stage"),
}
JOINTS = {
    "kind": Column(
        "code",
        "bed (the base joint, too), head; brick: the cut where a brick can split, no joint and not "
        "in the index",
        "u1",
    ),
    "first_body": Column(
        "index, -1 ground", "lower body, or left one; -1, -2, ... the supports", "i8"
    ),
    "second_body": Column("index", "upper body, or right one", "i8"),
    "x_m": Column("m", "place in the undeformed wall, along it"),
    "z_m": Column("m", "the same, upwards"),
    "length_m": Column("m", "tributary length"),
    "area_m2": Column("m2", "tributary length times the thickness"),
    "normal_stiffness_pa_m": Column("Pa/m", "with the compliance of rigid bricks"),
    "shear_stiffness_pa_m": Column("Pa/m", "with the compliance of rigid bricks"),
    "elastic": Column("bool", "held by the lintel, cannot break", "?"),
    "tensile_strength_pa": Column(
        "Pa, infinite where elastic", "of this joint (`--strength-cov` scatters them)"
    ),
    "cohesion_pa": Column(
        "Pa, infinite where elastic",
        "of this joint (`--strength-cov` scatters them); infinite of a "
        "brick's cut that tension alone breaks",
    ),
}
BODIES = {
    "x_m": Column("m", "centre, along the wall"),
    "z_m": Column("m", "centre, upwards"),
    "length_m": Column("m", "along the wall"),
    "height_m": Column("m", "upwards"),
    "mass_kg": Column("kg", "mass"),
    "inertia_kg_m2": Column("kg m2", "moment of inertia about the centre"),
    "course": Column(
        "index, -1 cap",
        "0 at the base, -1 for a cap of the top mass, -2 for a slab, -3 for a segment of "
        "a beam, -4 for a brick of an arch, -5 for a party wall",
        "i8",
    ),
}
SUPPORTS = {
    "left_m": Column("m", "of the part of the base that it carries"),
    "right_m": Column("m", "the same"),
}
SERIES = {
    "stage": Column(
        "code",
        "motion, rest, settling (local damping 0.7, or adaptive with mass scaling), settlement of"
        " the ground before the first motion (the same damping)",
        "u1",
    ),
    "time_s": Column(
        "s", "since the start of the (first) motion; negative while the ground settles"
    ),
    "base_acceleration_x_m_s2": Column("m/s2", "of the ground, along the wall"),
    "base_acceleration_z_m_s2": Column("m/s2", "of the ground, upwards"),
    "top_displacement_m": Column(
        "m", "mean of the top-course bricks over piers, since the static stage"
    ),
    "drift_ratio": Column(
        "1",
        "top displacement over the height of these bricks' centres; where the ground moves, "
        "without the rigid motion of the base course",
    ),
    "base_translation_m": Column(
        "m", "mean horizontal displacement of the base course; NaN where the ground does not move"
    ),
    "base_rotation_rad": Column(
        "rad",
        "rotation of the base course from x towards z, least squares; NaN where the "
        "ground does not move",
    ),
    "base_shear_n": Column(
        "N", "horizontal force of the wall on the ground, positive with positive drift"
    ),
    "top_force_n": Column(
        "N", "force that moves the top in a pushover, zero before it; NaN in dynamics"
    ),
    "kinetic_energy_j": Column("J", "stored, in all, with that of deformable bricks' strain modes"),
    "elastic_energy_j": Column(
        "J", "stored in joints and deformable bricks, since the end of the static stage"
    ),
    "gravity_energy_j": Column("J", "stored, since the end of the static stage"),
    "input_energy_j": Column(
        "J",
        "work of the base's inertia forces in the frame that moves with the base, or of the "
        "pushed top",
    ),
    "friction_energy_j": Column("J", "dissipated by sliding"),
    "fracture_energy_j": Column("J", "lost as bonds soften and break, and as joints crush"),
    "damping_energy_j": Column(
        "J",
        "taken by damping; in YADE's settling stages, and while it pushes the top, "
        "inferred from the balance",
    ),
}
ACTIVE = {
    "joint": Column(
        "index of joints",
        "contact points in the order in which they became active: row k is of column k of `frames`",
        "i4",
    )
}
FRAMES = {
    "opening_m": Column(
        "m",
        "inelastic opening: past the broken bond, or what a softened one has given way; 0 while "
        "closed or intact; of the faces as crushing has left them",
        "f4",
    ),
    "slip_m": Column(
        "m",
        "signed plastic slip of the closed contact, frozen while open, 0 while intact: the slip "
        "`accumulated`",
        "f4",
    ),
    "offset_m": Column(
        "m",
        "signed offset of the two faces now, along the joint, less its elastic part (none while "
        "open), 0 while intact: the slip by `displacement`",
        "f4",
    ),
    "state": Column(
        "bits: 1 broken, 2 has been at the shear limit, 4 has been crushed, 8 has ended",
        "1: the bond has failed; 2: has failed in shear or slid, ever; 4: has been pressed to its"
        " compressive strength and has closed for good, ever; 8: its faces have ceased to overlap:"
        " it has no forces any more, and keeps opening, slip and offset",
        "u1",
    ),
}
GROUND = {
    "displacement": Column(
        "m, m, rad",
        "of the middle of the part of the base that each support carries, since the "
        "end of the static stage; in the frame of the base's acceleration",
        "f4",
    ),
    "force": Column(
        "N, N, N m", "of the wall on each support along x and z, and moment about that middle", "f4"
    ),
}
EVENT_COLUMNS = {
    "time_s": Column("s", "negative in the static stage"),
    "joint": Column("index of joints", "row of `joints`", "i4"),
    "kind": Column(
        "code",
        "tension, shear (the bond has failed); opened, slipped (first passing of 0.1 mm by "
        "`opening_m`, `slip_m`)",
        "u1",
    ),
    "normal_stress_pa": Column("Pa", "trial stress at a break"),
    "shear_stress_pa": Column("Pa", "trial stress at a break"),
    "opening_m": Column("m", "at a first passing"),
    "slip_m": Column("m", "at a first passing"),
}
SNAPSHOTS = {
    "time_s": Column("s", "since the start of the (first) motion; every tenth sample, and the end"),
    "displacement": Column(
        "m, m, rad",
        "of the centres, and rotation x towards z, since the end of the static stage",
        "f4",
    ),
    "out_of_plane": Column(
        "m, rad, rad",
        "only of a house: of the centres across their wall, and rotations about the axes along it"
        " and upwards, since the end of the static stage",
        "f4",
    ),
}
PLACING = {
    "body_wall": Column("index", "only of a house: number of the wall of each body", "i4"),
    "joint_wall": Column(
        "index", "only of a house: number of the wall of each contact point, -1 between two", "i4"
    ),
    "joint_y_m": Column(
        "m", "only of a house: place of each contact point from the middle plane of its wall"
    ),
    "body_y_m": Column(
        "m", "only of a house: centre of each body from that plane, of a concrete floor not zero"
    ),
    "body_depth_m": Column("m", "only of a house: size of each body across its wall"),
}
HOUSE = {
    "top_displacement_m": Column(
        "m", "only of a house: of each wall along it, as that of the series"
    ),
    "across_m": Column(
        "m", "only of a house: of each wall, largest displacement of a body across it"
    ),
    "top_across_m": Column(
        "m", "only of a house: of each wall across it, of the top whose displacement is its drift"
    ),
    "base_acceleration_m_s2": Column(
        "m/s2",
        "only of a house: of the ground across its heading; those of the series are along it and"
        " upwards",
    ),
    "failed_ties": Column("1", "only of a house: number of its ties that have failed", "i4"),
}
STRESSES = {
    "joint_stress_pa": Column(
        "Pa",
        "only with `--stresses`: normal stress, tension positive, and shear stress, signed "
        "as `slip_m`, of each contact point: its force over its area",
        "f4",
    )
}
STATIC_STAGE = {
    "time_s": Column("s", "since the start of the static stage, every 500 steps"),
    "unbalanced_force": Column(
        "1",
        "mean resultant on a body over mean contact force, the solve ratio of UDEC and "
        "YADE: the stage ends below 1e-5",
    ),
}
STATE = "state/solver"
STATE_COLUMNS = {
    "solver": Column(
        "bytes",
        "NumPy archive of the solver's own tables at the end of a complete run, with which "
        "another run continues; empty where there is none; its content belongs to one version of "
        "the model's code",
        "u1",
    )
}
GROWING = {
    "series": SERIES,
    "active": ACTIVE,
    "frames": FRAMES,
    "ground": GROUND,
    "events": EVENT_COLUMNS,
    "snapshots": SNAPSHOTS,
    "stresses": STRESSES,
    "house": HOUSE,
    "static_stage": STATIC_STAGE,
    "state": STATE_COLUMNS,
}
"""Groups whose datasets grow during a run."""
TABLES = {
    "static": STATIC,
    "joints": JOINTS,
    "bodies": BODIES,
    "supports": SUPPORTS,
    "placing": PLACING,
    **GROWING,
}
RUN = {
    "status": Column("code", "unfinished (running or killed), complete, interrupted, failed", "u1"),
    "collapsed_at_s": Column("s", "when a brick had dropped by half its height; NaN if none did"),
}
COLUMNS = {
    f"{group}/{name}": column
    for group, columns in {"run": RUN, **TABLES}.items()
    for name, column in columns.items()
}
ROW_SHAPES = {
    "frames": ("active",),
    "ground": ("supports", 3),
    "snapshots/displacement": ("bodies", 3),
    "snapshots/out_of_plane": ("bodies", 3),
    "stresses": ("joints", 2),
    "house": ("walls",),
    "house/base_acceleration_m_s2": (),
    "house/failed_ties": (),
}
"""Dimensions of a row of the growing datasets of a group, or of one dataset, by name; () of all
others."""
CODES = {
    "run/status": STATUS,
    "series/stage": STAGES,
    "events/kind": EVENTS,
    "joints/kind": ("bed", "head", "brick"),
}
"""Meanings of the numbers of a dataset."""


def is_moving(series):
    """Flags (n_times,) of the samples outside the settlement and settling stages, whose damping is
    not part of the model."""
    return ~series["stage"].isin(("settling", "settlement"))


def moving(series):
    """Samples of a series outside the settlement and settling stages."""
    return series[is_moving(series)]
