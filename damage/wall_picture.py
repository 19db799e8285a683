"""What the picture of a damaged wall shows: bodies where they moved to, joints with their state.

Numbers only; `damage.pictures.wall_picture` draws them.  The motion is magnified, so that drifts
of a millimetre can be seen: displacements and rotations are multiplied by one factor, and a point
of a joint lies halfway between where its two bodies carry it:

        +-------+  <- second body carries the joint's end here
        |       |  o   the end is drawn here, the mean of the two
        +-------+  <- first body carries it here
"""

from dataclasses import dataclass

import numpy as np

from damage.errors import InputError
from damage.index import THRESHOLD
from damage.units import MILLIMETRE

STATES = ("intact", "broken", "slipped", "opened", "both")
"""States of a joint in the order of drawing, the gravest on top; "broken" is below the threshold,
"both" is opened and slipped."""
VISIBLE_SHARE = 0.03  # of the wall's height: how far the largest displacement should reach
LARGEST_MAGNIFICATION = 1000.0  # beyond it a residual of a few micrometres would look like a lean
NEAR_S = 0.05  # [s]; a shape from further away belongs to another moment of the motion
LEGEND_WIDTHS_MM = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
_CORNERS = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
_TINY = 1e-6  # [m]


@dataclass(frozen=True)
class WallShape:
    """A wall at one sample of its history, ready to be drawn.

    sample: index into the series; time_s: of it; index: DI there.
    snapshot_time_s: of the bodies' displacement, None where no snapshot is near: then the wall is
        drawn undeformed.
    magnification: factor on displacements and rotations.
    corners: (n_bodies, 4, 2) [m], counter-clockwise from the lower left; is_cap: (n_bodies,) bool.
    segments: (n_joints, 2, 2) [m], both ends of each joint; state: (n_joints,) index of STATES;
    crack_width_m: (n_joints,), sqrt(opening^2 + slip^2).
    """

    sample: int
    time_s: float
    index: float
    snapshot_time_s: float | None
    magnification: float
    corners: np.ndarray
    is_cap: np.ndarray
    segments: np.ndarray
    state: np.ndarray
    crack_width_m: np.ndarray

    def select(self, state):
        """Indices of the joints in one of STATES."""
        return np.flatnonzero(self.state == STATES.index(state))


def wall_shape(history, sample="max", slip="displacement", threshold=THRESHOLD, magnify=None):
    """The shape of a History's wall at a sample.

    sample: "max" (of the damage index), "end", or an index into the series;
    slip: criterion of `damage.index.damage_index`; threshold [m];
    magnify: factor on the motion, None for one that makes it visible.
    """
    if magnify is not None and not (np.isfinite(magnify) and magnify >= 0):
        raise InputError(f"magnify = {magnify!r}: expected zero or a positive number; mend it")
    sample, damage = choose_sample(history, sample, slip, threshold)
    time_s = float(history.series["time_s"].iloc[sample])
    snapshot = nearest_snapshot(history, time_s)
    motion = np.zeros((len(history.bodies), 3)) if snapshot is None else history.displacement[snapshot]
    motion = motion.astype(float)
    if magnify is None:
        magnify = magnification(history.bodies, motion)
    opening, slipped = history.opening_m[sample].astype(float), history.slip_m[sample].astype(float)
    return WallShape(
        sample=sample, time_s=time_s, index=damage,
        snapshot_time_s=None if snapshot is None else float(history.snapshot_time_s[snapshot]),
        magnification=float(magnify), corners=body_corners(history.bodies, motion, magnify),
        is_cap=history.bodies["course"].to_numpy() < 0,
        segments=joint_segments(history.joints, history.bodies, motion, magnify),
        state=joint_states(history, sample, slip, threshold),
        crack_width_m=np.hypot(opening, slipped))


# --- which moment -------------------------------------------------------------------------------

def choose_sample(history, sample, slip="displacement", threshold=THRESHOLD):
    """Index of a sample ("max", "end" or a number, negative ones from the end) and DI at it."""
    n_times = len(history.series)
    if n_times == 0:
        raise InputError(f"{history.path} holds no sample yet ({history.status}); let the run go on")
    damage = history.index(threshold=threshold, slip=slip)["DI"].to_numpy()
    if sample == "max":
        # A run that failed may end in NaN: that is no maximum.
        sample = int(np.argmax(np.nan_to_num(damage, nan=-1.0)))
    elif sample == "end":
        sample = n_times - 1
    elif isinstance(sample, str) or not -n_times <= sample < n_times:
        raise InputError(f"sample {sample!r}: expected 'max', 'end' or a whole number from 0 to "
                         f"{n_times - 1}; choose one of them")
    sample = int(sample) % n_times
    return sample, float(damage[sample])


def nearest_snapshot(history, time_s):
    """Index of the snapshot nearest to a time, None where none is near."""
    times = history.snapshot_time_s
    if len(times) == 0:
        return None
    nearest = int(np.argmin(np.abs(times - time_s)))
    # Slow tests take their snapshots further apart than the shaking of a wall does.
    near = max(NEAR_S, float(np.median(np.diff(times)))) if len(times) > 1 else NEAR_S
    is_usable = abs(times[nearest] - time_s) <= near and np.all(np.isfinite(history.displacement[nearest]))
    return nearest if is_usable else None


def joint_states(history, sample, slip="displacement", threshold=THRESHOLD):
    """Index into STATES of every joint at a sample, (n_joints,), by the criteria of the index."""
    opened = history.opening_m[sample] > threshold
    slipped = history.at_limit[sample] if slip == "shear-limit" else np.abs(history.slip_m[sample]) > threshold
    conditions = [opened & slipped, opened, slipped, history.broken[sample]]
    codes = [STATES.index(name) for name in ("both", "opened", "slipped", "broken")]
    return np.select(conditions, codes, default=STATES.index("intact"))


# --- where things are ---------------------------------------------------------------------------

def displaced(bodies, motion, body, points, magnify=1.0):
    """Where points fixed to bodies go when the bodies' motion is magnified.

    motion: (n_bodies, 3) displacement of the centres [m] and rotation x towards z [rad];
    body: (n,) index of the body of each row of points, GROUND rests; points: (n, k, 2) [m].
    Returns (n, k, 2) [m].
    """
    # GROUND is -1, which takes the last row: one more body, at rest.
    motion = np.vstack([motion, np.zeros(3)])[body] * magnify
    centre = np.vstack([bodies[["x_m", "z_m"]].to_numpy(), np.zeros(2)])[body][:, None]
    turn = motion[:, 2, None]
    cos, sin = np.cos(turn), np.sin(turn)
    x, z = np.moveaxis(points - centre, 2, 0)
    return centre + motion[:, None, :2] + np.stack([cos * x - sin * z, sin * x + cos * z], axis=2)


def body_corners(bodies, motion, magnify=1.0):
    """Corners of every body after its magnified motion, (n_bodies, 4, 2) [m]."""
    centre = bodies[["x_m", "z_m"]].to_numpy()[:, None]
    size = bodies[["length_m", "height_m"]].to_numpy()[:, None]
    return displaced(bodies, motion, np.arange(len(bodies)), centre + size * _CORNERS, magnify)


def joint_segments(joints, bodies, motion, magnify=1.0):
    """Both ends of every joint's tributary length after the magnified motion, (n_joints, 2, 2) [m]."""
    ends = tributary_ends(joints)
    first, second = (displaced(bodies, motion, joints[name].to_numpy(), ends, magnify)
                     for name in ("first_body", "second_body"))
    return (first + second) / 2


def tributary_ends(joints):
    """Ends of the tributary lengths before any motion, (n_joints, 2, 2) [m]: bed joints along x,
    head joints along z, around the contact point, or inwards from it where it is a corner."""
    point, length = joints[["x_m", "z_m"]].to_numpy(), joints["length_m"].to_numpy()
    is_head = (joints["kind"] == "head").to_numpy()
    along = np.where(is_head[:, None], (0.0, 1.0), (1.0, 0.0))
    middle = point + along * (_inwards(joints, point, length) * length / 2)[:, None]
    return middle[:, None] + np.array([-0.5, 0.5])[:, None] * (along * length[:, None])[:, None]


def _inwards(joints, point, length):
    """0 for a point in the middle of its length; 1 and -1 for the two ends of a pair of facing cells.

    Two such corners are as far apart as their lengths add up to; neighbours in the middle of their
    lengths are half as far apart.
    """
    same_bodies = np.all(np.diff(joints[["first_body", "second_body"]].to_numpy(), axis=0) == 0, axis=1)
    apart = np.sum(np.abs(np.diff(point, axis=0)), axis=1)
    starts = np.flatnonzero(same_bodies & (np.abs(apart - length[:-1] - length[1:]) < _TINY))
    side = np.zeros(len(length))
    side[starts], side[starts + 1] = 1.0, -1.0
    return side


def magnification(bodies, motion):
    """Factor that makes the largest displacement of a corner about VISIBLE_SHARE of the bricks'
    height: 1, 2 or 5 times a power of ten, from 1 to LARGEST_MAGNIFICATION; 1 without motion."""
    rest = body_corners(bodies, np.zeros_like(motion))
    moved = body_corners(bodies, motion) - rest
    largest = float(np.max(np.hypot(moved[..., 0], moved[..., 1])))
    if largest == 0:
        return 1.0
    height = float(rest[bodies["course"].to_numpy() >= 0, :, 1].max())
    wanted = VISIBLE_SHARE * height / largest
    return round_125(min(max(wanted, 1.0), LARGEST_MAGNIFICATION))


def round_125(value):
    """The nearest, in ratio, of 1, 2 and 5 times a power of ten to a positive value.

    >>> [round_125(value) for value in (0.8, 3.0, 19.3, 690.0)]
    [1.0, 2.0, 20.0, 500.0]
    """
    steps = 10.0 ** np.floor(np.log10(value)) * np.array([1.0, 2.0, 5.0, 10.0])
    return float(steps[np.argmin(np.abs(np.log(steps / value)))])


# --- how wide a crack is drawn ------------------------------------------------------------------

def line_width(crack_width_m):
    """Width of a line [pt] for a crack of some width [m], the same scale in all pictures.

    The square root keeps a crack of 0.1 mm visible beside one of 5 mm, where light damage ends and
    the lines stop growing.
    """
    return 0.3 + 1.9 * np.sqrt(np.minimum(np.abs(crack_width_m) / MILLIMETRE, LEGEND_WIDTHS_MM[-1]))


def legend_widths_mm(shape):
    """Three crack widths [mm], from the smallest to the one that bounds a WallShape's, with labels."""
    largest = shape.crack_width_m.max() / MILLIMETRE
    top = int(np.searchsorted(LEGEND_WIDTHS_MM[2:-1], largest)) + 2
    chosen = [LEGEND_WIDTHS_MM[i] for i in (0, (top + 1) // 2, top)]
    return [(mm, f"{'≥ ' if mm == LEGEND_WIDTHS_MM[-1] else ''}{mm:g} mm wide") for mm in chosen]
