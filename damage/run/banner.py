"""What is said at the start of a run: sizes, masses in t, strengths in MPa, the first period, and
what is doubtful."""

import math

from damage.errors import warn
from damage.house.meeting import warn_of_lone_walls
from damage.motion.intensity import drift_warnings, end_warnings, late_lines
from damage.motion.loading import Recorded
from damage.motion.plausible import faint_warnings, record_warnings
from damage.motion.record import FINER
from damage.motion.settlement import FASTEST_M_S
from damage.run.schedule import deformable_warnings, sample_steps, softening_warnings, stages
from damage.run.scheme import scaling_warnings
from damage.wall.as_built import (
    describe_floors,
    describe_lintels,
    describe_openings,
    describe_top,
    replaced_lintels,
)
from damage.wall.geometry import body_table, joint_table
from damage.wall.lintels import describe_share, elastic_share

MEGA = 1e6
TONNE = 1e3


def announce(plan):
    """Print what a damage.run.prepare.RunPlan will be, and warn of what is doubtful in it."""
    settings = plan.settings
    wall = plan.layout.wall
    loading = plan.settings.loading
    warn(*deformable_warnings(settings.model, wall), code="deformable_bricks")
    warn(*scaling_warnings(settings, wall), code="mass_scaling")
    if settings.recorded:
        warn(*faint_warnings(settings.peak_g), code="faint_motion")
    for text in dict.fromkeys(
        text for event in settings.recorded for text in record_warnings(event.loading)
    ):
        warn(text, code="record")
    if isinstance(loading, Recorded) and not settings.events:
        warn(*end_warnings(loading.applied()), code="end_velocity")
        warn(*drift_warnings(loading), code="drift")
    if wall.joint.softens:
        warn(
            *softening_warnings(
                settings,
                plan.time_step,
                plan.modes.critical_time_step_s,
                plan.backend.softening_beta_s,
            ),
            code="softening_step",
        )
    warn(*warn_of_lone_walls(plan.layout.building), code="lone_walls")
    print(
        *wall_lines(plan),
        *settlement_lines(settings, plan.layout),
        *event_lines(settings),
        *record_lines(settings),
        *sequence_lines(settings),
        *stress_lines(plan),
        sep="\n",
        flush=True,
    )


def wall_lines(run):
    """Lines about the wall of a RunPlan, its first period and time step, and its motion."""
    layout = run.layout
    wall = layout.wall
    plan = layout.plan
    options = layout.options
    mass_scaling = run.settings.mass_scaling
    lintels = describe_lintels(plan)
    lintels_in_words = f"lintel {options.lintel}: " if wall.openings else ""
    if lintels and options.lintel == "elastic":
        lintels_in_words = "lintels of their own: "
    replaced = [text for wall in layout.walls for text in replaced_lintels(wall, options.lintel)]
    bricks_kg = layout.total_mass - layout.top_mass - sum(floor.mass for floor in wall.floors)
    return [
        (
            f"wall {wall.name}: {wall.length:.3f} x {wall.built_height:.3f} m, {wall.courses}"
            f" courses, {layout.n_bricks} bricks ({bricks_kg / TONNE:.3g} t together),"
            f" {layout.n_joints} contact points on {layout.total_joint_length:.2f} m of joints"
        ),
        *describe_top(layout),
        *describe_openings(plan),
        *describe_floors(plan),
        *masonry_lines(layout),
        *lintels,
        *replaced,
        lintels_in_words
        + describe_share(elastic_share(plan, joint_table(layout), body_table(layout))),
        (
            f"first period by eigenvalue {run.modes.period_s[0]:.4f} s; time step"
            f" {run.time_step:.4g} s ({run.time_step / run.modes.critical_time_step_s:.2f} of the"
            " critical"
            f"{'' if mass_scaling == 'none' else f', {mass_scaling} mass scaling'})"
        ),
        f"motion: {run.settings.loading.name}",
        *describe_sampling(run.settings.loading),
    ]


def masonry_lines(layout):
    """Lines about the joints and bricks of a wall, of a house with the names of its walls where
    these differ."""
    by_wall = {}
    for wall in layout.walls:
        lines = (
            describe_joint(wall.joint, layout.options.strength_cov),
            describe_brick(wall.brick, layout.options),
        )
        by_wall.setdefault(lines, []).append(wall.name)
    return [
        line if len(by_wall) == 1 else f"{', '.join(names)}: {line}"
        for lines, names in by_wall.items()
        for line in lines
    ]


def describe_sampling(loading):
    """A line about a Loading whose record is interpolated, in a list; none where it is not."""
    if loading.lost_by_lines is None:
        return []
    step_s = loading.record.time_step_s
    return [
        f"record: its step of {step_s:g} s is more than a tenth of the first period; interpolated"
        f" (band-limited) to {step_s / FINER:g} s, as lines between samples would take off"
        f" {100 * loading.lost_by_lines:.2g} % at that period"
    ]


def sequence_lines(settings):
    """Lines about the sequence of different records of RunSettings, none where there is none."""
    if not settings.events:
        return []
    records = {event.loading.record.name for event in settings.events}
    return [
        f"sequence: {len(settings.events)} events of {len(records)} records, peak"
        f" {settings.peak_g:.3g} g; the motion above is the strongest of them"
    ]


def settlement_lines(settings, layout):
    """A line on how long the ground of RunSettings below a Layout moves, none where it rests."""
    if not (settlement := settings.settlement):
        return []
    common_mm = 1e3 * settlement.common_m
    taken = f"; {common_mm:.4g} mm of all points are taken off" if common_mm else ""
    moving_s = settlement.moving_s(float(layout.ground.right.max()))
    return [
        f"settlement: the ground moves for {moving_s:.3g} s, at most at {1e3 * FASTEST_M_S:g}"
        f" mm/s{taken}"
    ]


def event_lines(settings):
    """A line about the event at an address whose motion RunSettings have, none where there is
    none."""
    if not (event := settings.event):
        return []
    pgv = f"{event['pgv_mm_s']:.3g} mm/s" + (
        ", its median there" if event["life"] is None else f", drawn in life {event['life']}"
    )
    return [
        f"event of {event['time_utc']} UTC, M {event['magnitude']:g} at {event['place']}: PGV of"
        f" {pgv}; record {event['record']} x {event['scale']:.3g}, {event['start_s']:g} to"
        f" {event['end_s']:g} s"
    ]


def stress_lines(plan):
    """A line on the size of the joints' stresses, none where a RunPlan does not keep them."""
    settings = plan.settings
    layout = plan.layout
    if not settings.stresses:
        return []
    interval = sample_steps(plan.time_step, settings.mass_scaling)
    samples = stages(settings, layout, plan.time_step, interval)[-1].end_step // interval + 1
    return [
        f"stresses of {layout.n_joints} contact points at {samples} samples: "
        f"{8e-6 * samples * layout.n_joints:.3g} MB in memory where the history is read, "
        "in the file up to four fifths of that"
    ]


def record_lines(settings):
    """Lines that say which unit the records of RunSettings were taken to be in, and which component
    was moved in time; none where there is no record."""
    units = {}
    late_s = {}
    for event in settings.recorded:
        late_s |= event.loading.late_s
        for record in event.loading.components:
            units.setdefault(record.unit or "m_s2 (made in Python)", {})[record.name] = None
    return [
        f"unit of {', '.join(names) if len(names) < 4 else f'{len(names)} records'}: {unit}"
        for unit, names in units.items()
    ] + late_lines(late_s)


def describe_joint(joint, scatter=0.0):
    """A damage.Joint in one line; scatter: coefficient of variation of its strengths [-].

    >>> from damage.wall.parameters import Joint
    >>> describe_joint(Joint())
    'joints: tensile strength 0.21 MPa, cohesion 0.24 MPa, friction angle 32 deg, brittle'
    """
    never = " (never acts: beyond cohesion / tan(friction angle))" if joint.is_beyond_apex else ""
    parts = [
        f"tensile strength {joint.tensile_strength / MEGA:.4g} MPa{never}",
        f"cohesion {joint.cohesion / MEGA:.4g} MPa",
    ]
    parts += [f"both scattered by {100 * scatter:.3g} %"] if scatter else []
    parts += [f"friction angle {math.degrees(joint.friction_angle):.4g} deg"]
    parts += (
        [
            f"fracture energies {joint.mode_i_fracture_energy:.4g} and"
            f" {joint.mode_ii_fracture_energy:.4g} J/m2"
        ]
        if joint.softens
        else ["brittle"]
    )
    parts += (
        [f"compressive strength {joint.compressive_strength / MEGA:.4g} MPa"]
        if joint.compressive_strength
        else []
    )
    parts += (
        [f"its fracture energy {joint.compressive_fracture_energy:.4g} J/m2"]
        if joint.compressive_fracture_energy
        else []
    )
    return f"joints: {', '.join(parts)}"


def describe_brick(brick, options=None):
    """A damage.Brick in one line; options: ModelOptions, None where bricks are rigid.

    >>> from damage.wall.parameters import Brick
    >>> describe_brick(Brick(tensile_strength=1e6))
    'bricks: 0.225 x 0.075 x 0.1025 m, 1900 kg/m3, modulus 5200 MPa, splitting at 1 MPa in tension'
    """
    line = (
        f"bricks: {brick.length:.4g} x {brick.height:.4g} x {brick.thickness:.4g} m,"
        f" {brick.density:.4g} kg/m3, modulus {brick.young_modulus / MEGA:.4g} MPa"
    )
    if options and options.has_modes:
        line += ", deformable"
        return (
            f"{line}, tensile strength {brick.tensile_strength / MEGA:.4g} MPa"
            if brick.splits
            else line
        )
    if not brick.splits:
        return f"{line}, never splitting"
    energy = f", fracture energy {brick.fracture_energy:.4g} J/m2" if brick.fracture_energy else ""
    return f"{line}, splitting at {brick.tensile_strength / MEGA:.4g} MPa in tension{energy}"
