"""From a displacement field measured by digital image correlation (DIC) to cracks of the joints.

A brick moves as a rigid body: its motion is fitted by least squares to the points inside it, and
opening and shear of its joints follow from the motions of both bricks (`damage.wall.kinematics`).
So tension and shear are distinguished, unlike in a picture of the cracks alone.
`docs/reference/crack-format.md` gives the file.

What is measured is the whole displacement of a joint.  The elastic part cannot be taken off without
the stresses; `report` bounds it.  Slip is the offset of the two bricks along the joint, as by
`displacement` in a simulation, whether the joint is open or closed.
"""

from math import isnan
from typing import NamedTuple

import numpy as np

from damage.applications.cracks.crack_file import OF_LEVEL, levels_of, pattern_of
from damage.applications.cracks.plausible import implausible_points
from damage.checks import check_not_negative
from damage.csv_table import read_csv
from damage.errors import InputError, some_of
from damage.fields import Column
from damage.index import THRESHOLD
from damage.measure.cracks import crack_table
from damage.units import GRAVITY, MILLIMETRE
from damage.wall.geometry import joint_table, tributary_ends
from damage.wall.kinematics import ContactKinematics, rigid_displacement
from damage.wall.parameters import LONGEST_M

MARGIN = 10 * MILLIMETRE
"""Points closer to a brick's edge than this are left out [m]: their subset may reach over the
joint."""
LEAST_POINTS = 4
MOST_M = 0.5
"""Largest displacement of a field [m]: a wall that moves so far has fallen."""
_PLACE = Column("m", "of a point", least=-LONGEST_M, most=LONGEST_M)
_DISPLACEMENT = Column("m", "of a point", least=-MOST_M, most=MOST_M)
REQUIRED = {"x_m": _PLACE, "z_m": _PLACE, "ux_m": _DISPLACEMENT, "uz_m": _DISPLACEMENT}
"""{name: Column} of the file, beside those of the load level,
`damage.applications.cracks.crack_file.OF_LEVEL`."""
MOVES_M = 0.05 * MILLIMETRE
"""Least motion of a course, or of a point, that is judged [m]."""
UPSIDE = 2.0
"""Motion of the lowest course over that of the top one from which it is doubtful [-]."""
RIGID = 0.1
"""Largest deviation from a rigid motion, over that, of a course that moves as one [-]."""
LEAST_SEEN = 0.5
"""Share of the joints' length below which a field shows little of the wall [-]."""
STUCK = 5.0
"""Deviations of the noise from which a point without displacement is not one of its brick."""


class Field(NamedTuple):
    """Displacements at one load level: points, displacement (n, 2) [m], x and z; level, drift_ratio
    (NaN where the file gives none)."""

    level: float
    drift_ratio: float
    points: np.ndarray
    displacement: np.ndarray


class Motions(NamedTuple):
    """Rigid motions of the bricks.

    motion: (n_bodies, 3) displacement of the centres [m, m] and rotation [rad], NaN for a brick
    with too few points, 0 for caps; noise: standard deviation of a point's displacement component
    about the rigid motions [m]; n_points: (n_bodies,); centre: (n_bodies, 2) of a brick's points
    [m]; spread: (n_bodies,) sum of their squared distances from it [m2].
    """

    motion: np.ndarray
    noise: float
    n_points: np.ndarray
    centre: np.ndarray
    spread: np.ndarray


class Measured(NamedTuple):
    """Opening and slip of the joints at one level of a DIC field.

    opening, slip: (n_joints,) [m], NaN where a brick was not seen; deviation: (n_joints,) standard
    deviation of the opening from the field's noise [m]; noise: of a point [m]; drift_ratio [-]: the
    file's, else that of the top course, NaN where no brick of it was seen; motion: of the bodies,
    as of Motions.
    """

    opening: np.ndarray
    slip: np.ndarray
    deviation: np.ndarray
    noise: float
    drift_ratio: float
    motion: np.ndarray


def read_field(path):
    """The fields of a DIC file, a list of Field in the order of the file; rows without
    displacement, which the correlation lost, are left out.  Raises InputError with the line."""
    table = read_csv(path, REQUIRED | OF_LEVEL, REQUIRED)
    table.refuse_empty("x_m", "z_m")
    rows = table.rows
    table.refuse(
        rows["ux_m"].isna() != rows["uz_m"].isna(),
        "one displacement of two; give ux_m and uz_m, or neither",
    )
    fields = []
    for number, here in rows.groupby(levels_of(table), sort=False):
        drifts = here["drift_pct"].dropna().unique()
        if len(drifts) > 1:
            raise InputError(
                f"{path}: load level {number:g} has {len(drifts)} values of drift_pct; expected one"
            )
        seen = here[here["ux_m"].notna()]
        drift_ratio = drifts[0] / 100 if len(drifts) else np.nan
        # a point after the other in memory, for the same sums
        place, displacement = (
            np.array(seen[list(names)], order="C") for names in (("x_m", "z_m"), ("ux_m", "uz_m"))
        )
        fields.append(Field(number, drift_ratio, place, displacement))
    return fields


def rigid_motion(points, displacement):
    """The rigid motion nearest to displacements in the sense of least squares, exact for any
    rotation: displacement of the points' centre (2,) [m] and rotation x towards z [rad]; both
    arrays (n, 2)."""
    mean = displacement.mean(axis=0)
    before = points - points.mean(axis=0)
    after = before + displacement - mean
    turn = np.arctan2(
        np.sum(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]), np.sum(before * after)
    )
    return mean, turn


def turned(points, turn):
    """Displacement (n, 2) of points (n, 2) by a rotation about the origin."""
    return np.column_stack(rigid_displacement(0.0, 0.0, turn, *points.T))


def relative_to_base(field, margin):
    """Displacements (n, 2) relative to the base, whose points lie below -margin; as they are
    without any."""
    base = field.points[:, 1] < -margin
    if base.sum() < LEAST_POINTS:
        return field.displacement
    mean, turn = rigid_motion(field.points[base], field.displacement[base])
    arm = field.points + field.displacement - field.points[base].mean(axis=0) - mean
    return field.displacement - mean + turned(arm, -turn)


def points_of_bricks(points, layout, margin):
    """Yield (brick, indices of the points (n, 2) that lie so far inside its edges [m])."""
    bodies = layout.bodies
    order = np.argsort(points[:, 1])
    x, z = points[order].T
    for brick in range(layout.n_bricks):
        half = np.array([bodies.length[brick], bodies.height[brick]]) / 2 - margin
        course = slice(*np.searchsorted(z, bodies.z[brick] + [-half[1], half[1]]))
        yield brick, order[course][np.abs(x[course] - bodies.x[brick]) <= half[0]]


def brick_motions(field, layout, margin):
    """Motions of the bricks of a Layout relative to the base, from the points of a Field."""
    bodies = layout.bodies
    n = layout.n_bodies
    displacement = relative_to_base(field, margin)
    motion = np.full((n, 3), np.nan)
    n_points = np.zeros(n, int)
    centre = np.zeros((n, 2))
    spread = np.ones(n)
    squares = 0.0
    for brick, inside in points_of_bricks(field.points, layout, margin):
        n_points[brick] = len(inside)
        if n_points[brick] < LEAST_POINTS:
            continue
        middle = np.array([bodies.x[brick], bodies.z[brick]])
        place = field.points[inside]
        moved = displacement[inside]
        mean, turn = rigid_motion(place, moved)
        centre[brick] = place.mean(axis=0)
        spread[brick] = np.sum((place - centre[brick]) ** 2)
        motion[brick] = *(mean + turned(middle[None] - centre[brick], turn)[0]), turn
        squares += np.sum((moved - mean - turned(place - centre[brick], turn)) ** 2)
    freedom = np.sum(2 * n_points[n_points >= LEAST_POINTS] - 3)
    if freedom == 0:
        raise InputError(
            f"load level {field.level:g}: no brick of wall {layout.wall.name} has {LEAST_POINTS}"
            f" points {margin / MILLIMETRE:g} mm inside its edges; check the origin (the wall's"
            " lower left corner) and the unit, or give a smaller --margin-mm"
        )
    motion[layout.n_bricks :] = 0.0
    return Motions(motion, np.sqrt(squares / freedom), n_points, centre, spread)


def opening_deviation(motions, layout):
    """Standard deviation of each joint's opening that the field's noise leaves, (n_joints,) [m]."""
    contacts = layout.contacts
    n = layout.n_joints
    variance = np.zeros(n)
    for body in (contacts.first[:n], contacts.second[:n]):
        arm = np.hypot(
            contacts.x[:n] - motions.centre[body, 0], contacts.z[:n] - motions.centre[body, 1]
        )
        of_place = 1 / np.maximum(motions.n_points[body], 1) + arm**2 / motions.spread[body]
        variance += np.where(body < 0, 0.0, of_place)
    return motions.noise * np.sqrt(variance)


def measure(fields, layout, margin=MARGIN):
    """Opening and slip of the joints at each level, a list of Measured."""
    check_not_negative("margin [m]", margin)
    kinematics = ContactKinematics(layout)
    n = layout.n_joints
    levels = []
    for field in fields:
        motions = brick_motions(field, layout, margin)
        opening, shear = (part[:n] for part in kinematics.displacements(motions.motion))
        drift = field.drift_ratio
        top = motions.motion[layout.drift_bodies, 0]
        if isnan(drift) and not np.isnan(top).all():  # that of the top course, as in a simulation
            drift = np.nanmean(top) / layout.drift_height
        levels.append(
            Measured(
                opening=np.maximum(opening, 0.0),
                slip=shear,
                deviation=opening_deviation(motions, layout),
                noise=motions.noise,
                drift_ratio=drift,
                motion=motions.motion,
            )
        )
    return levels


def field_warnings(fields, measured, layout, margin=MARGIN):
    """Lines on what of fields is doubtful: points beside the wall, z that points down, a lowest
    course that moves as one, and points kept as zero that the correlation lost."""
    warnings = []
    for field, level in zip(fields, measured):
        texts = [
            implausible_points(field.points, layout.wall),
            _unseen(level, layout),
            _moving_base(field, level, layout, margin),
            _stuck(field, layout, margin),
        ]
        warnings += [f"load level {field.level:g}: {text}" for text in texts if text]
    return warnings


def _unseen(level, layout):
    """What is said of a Measured that shows less than half of the joints; None of another."""
    length = layout.joint_length
    seen = length[~np.isnan(level.opening)].sum() / length.sum()
    if seen >= LEAST_SEEN:
        return None
    return (
        f"{100 * seen:.0f} % of the joints lie at bricks with points, and all others count as"
        " uncracked; expected points all over the wall: look at their unit and origin"
    )


def _moving_base(field, level, layout, margin):
    """What is said of a lowest course that moves more than the top one, or as one rigid body above
    a base that was not measured; None of another."""
    z = layout.bodies.z
    n = layout.n_bricks
    seen = np.flatnonzero(~np.isnan(level.motion[:n, 0]))
    moved = np.hypot(*level.motion[seen, :2].T)
    lowest = seen[z[seen] == z[seen].min()]
    low, high = (np.median(moved[z[seen] == edge]) for edge in (z[seen].min(), z[seen].max()))
    if low > max(MOVES_M, UPSIDE * high):
        return (
            f"the lowest course moves by {low / MILLIMETRE:.3g} mm, the top one by"
            f" {high / MILLIMETRE:.3g} mm; expected z up from a base at rest: where z points"
            " down, as in pictures, give the wall's height less z, and -uz"
        )
    if np.sum(field.points[:, 1] < -margin) >= LEAST_POINTS:
        return None
    centres = np.column_stack([layout.bodies.x, z])[lowest]
    displacement = level.motion[lowest, :2]
    mean, turn = rigid_motion(centres, displacement)
    rigid = mean + turned(centres - centres.mean(axis=0), turn)
    largest = np.hypot(*rigid.T).max()
    if largest < MOVES_M or np.hypot(*(displacement - rigid).T).max() > RIGID * largest:
        return None
    return (
        f"the lowest course moves as one rigid body, by up to {largest / MILLIMETRE:.3g} mm and"
        f" {turn:.2g} rad, above a base without points: a wall that slides or rocks, or a camera"
        " that moved, by which the cracks along the base and the drift are wrong; give points of"
        f" the base, z below {-margin:g} m, whose motion is taken off"
    )


def _stuck(field, layout, margin):
    """What is said of the `stuck_points` of a Field; None without any."""
    stuck = stuck_points(field, layout, margin)
    if len(stuck) == 0:
        return None
    places = [f"({x:g}, {z:g})" for x, z in field.points[stuck]]
    return (
        f"{len(stuck)} of {len(field.points)} points, at x, z = {some_of(places, 3)}"
        " [m], have zero displacement on bricks that move; expected no ux_m and uz_m where"
        " the correlation failed: leave them empty there"
    )


def stuck_points(field, layout, margin=MARGIN):
    """Indices of points whose displacement is zero, while that of their brick by its other points
    is not."""
    zero = ~field.displacement.any(axis=1)
    stuck = [np.zeros(0, int)]
    for _, inside in points_of_bricks(field.points, layout, margin):
        still = inside[zero[inside]]
        others = inside[~zero[inside]]
        if len(still) == 0 or len(others) < LEAST_POINTS:
            continue
        mean, turn = rigid_motion(field.points[others], field.displacement[others])
        moved = mean + turned(field.points[inside] - field.points[others].mean(axis=0), turn)
        noise = np.median(np.hypot(*(moved - field.displacement[inside])[~zero[inside]].T))
        stuck.append(still[np.hypot(*moved[zero[inside]].T) > max(STUCK * noise, MOVES_M)])
    return np.sort(np.concatenate(stuck))


def patterns_of_fields(fields, measured, layout, threshold=THRESHOLD):
    """The CrackPattern of each level of `measure`."""
    ends = tributary_ends(joint_table(layout))
    return [
        pattern_of(
            crack_table(ends, level.opening, level.slip, threshold),
            field.level,
            level.drift_ratio,
            threshold,
        )
        for field, level in zip(fields, measured)
    ]


def report(measured, layout):
    """What limits a measurement: noise_m of a point, opening_deviation_m (the median joint's, the
    largest of the levels), unseen_m of joints (the most), elastic_opening_m, elastic_slip_m.

    The latter two are the most that elastic deformation adds: an intact joint opens by f_t / k_n; a
    closed one that slides is sheared by tan(phi) times the precompression over k_s.
    """
    contacts = layout.contacts
    n = layout.n_joints
    wall = layout.wall
    strength = contacts.tensile_strength[:n]
    breakable = np.isfinite(strength)
    opening = np.max(strength[breakable] / contacts.normal_stiffness[:n][breakable], initial=0.0)
    weight = wall.precompression + GRAVITY * wall.brick.density * wall.built_height
    slip = np.max(
        np.tan(wall.joint.friction_angle) * weight / contacts.shear_stiffness[:n], initial=0.0
    )
    length = layout.joint_length
    deviations = [level.deviation[np.isfinite(level.opening)] for level in measured]
    return {
        "noise_m": max(level.noise for level in measured),
        "opening_deviation_m": max(map(np.median, filter(len, deviations)), default=np.nan),
        "unseen_m": max(length[np.isnan(level.opening)].sum() for level in measured),
        "elastic_opening_m": opening,
        "elastic_slip_m": slip,
    }
