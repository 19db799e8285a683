"""Geometry of the picture of a damaged wall: displaced bodies, and joints with their states.

`damage.draw.run.wall_picture` draws it.  The motion is magnified, so that drifts of a millimetre
are visible: displacements and rotations are multiplied by one factor.  A point of a joint is drawn
halfway between its positions on both bodies:

        +-------+  <- second body carries the joint's end here
        |       |  o   the end is drawn here, the mean of the two
        +-------+  <- first body carries it here
"""

from dataclasses import dataclass, replace

import numpy as np

from damage.errors import InputError
from damage.history.in_space import motion_of
from damage.history.moments import (
    JOINT_STATES,
    choose_sample,
    joint_states,
    nearest_snapshot,
    support_motion,
)
from damage.units import MILLIMETRE
from damage.wall import geometry

VISIBLE_SHARE = 0.03  # largest drawn displacement over the height of the wall
LARGEST_MAGNIFICATION = 100.0
"""Largest factor on displacements: at it a crack of 0.1 mm, from which the index counts, is drawn
as wide as a mortar joint; beyond, residual displacements look as if the wall had burst."""
DRAWN = ("elastic", *JOINT_STATES)
"""States of joints in the order of drawing, the most severe on top."""
COLUMN_PT = 205, 340
"""Largest width and height of a wall in a picture of one column, without labels [pt]."""
SUPPORT_DEPTH = 0.1  # [m], drawn depth of supports that move
LEGEND_WIDTHS_MM = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
THINNEST_PT = 0.3
"""Width of the line of a crack of no width [pt]."""
WIDEST_PT = 4.5
"""Width of the line of the largest of LEGEND_WIDTHS_MM where bricks are large [pt]."""
SHARE_OF_BRICK = 0.5
"""Largest width of a line over the drawn height of the lowest brick, so that half of a brick is
visible."""
WIDEST_JOINT = 0.01
"""Largest distance of the two sides of a joint that is drawn in pictures of what follows a collapse
[m]."""
LEAST_WIDEST_PT = 0.6
"""Least width of the widest line [pt], so that cracks are visible in a wall of very many
courses."""


@dataclass(frozen=True)
class WallShape:
    """Geometry of a wall at one sample of its history.

    sample: index into the series; time_s: of it; index: DI there.
    snapshot_time_s: of the bodies' displacement, None where no snapshot is near: then the wall is
        drawn undeformed.
    magnification: factor on displacements and rotations.
    corners: (n_bodies, 4, 2) [m], counter-clockwise from the lower left; kinds: (n_bodies,) of
        `damage.wall.geometry.kinds_of_bodies`.
    supports: (n_supports, 4, 2) [m], the same of the ground below the part of the base that each
        carries; ground_moves: whether there are several, or the one has moved;
    segments: (n_joints, 2, 2) [m], both ends of each joint; state: (n_joints,) index of
    JOINT_STATES;
        elastic: (n_joints,) bool, which cannot fail, without the cuts of lintels, which are not
        drawn;
    crack_width_m: (n_joints,), sqrt(opening^2 + slip^2).
    widest_pt: width of the line of the widest cracks [pt], see `widest_line`.
    """

    sample: int
    time_s: float
    index: float
    snapshot_time_s: float | None
    magnification: float
    corners: np.ndarray
    kinds: np.ndarray
    supports: np.ndarray
    ground_moves: bool
    segments: np.ndarray
    state: np.ndarray
    elastic: np.ndarray
    crack_width_m: np.ndarray
    widest_pt: float = WIDEST_PT

    def on_page(self, page_pt=COLUMN_PT, span_m=None):
        """WallShape with line widths for a page of this width and height [pt] that shows span_m,
        (2,) [m], by default the bodies."""
        span_m = np.ptp(self.corners.reshape(-1, 2), axis=0) if span_m is None else span_m
        bricks = self.corners[self.kinds == "bricks"]
        brick_m = np.linalg.norm(bricks[:, 3] - bricks[:, 0], axis=1).min()
        return replace(self, widest_pt=widest_line(brick_m, span_m, page_pt))

    def line_width(self, chosen):
        """Line widths of the cracks of the chosen joints [pt]."""
        return line_width(self.crack_width_m[chosen], self.widest_pt)

    def select(self, state):
        """Indices of the joints in one of DRAWN: the elastic ones, or those in a state of
        JOINT_STATES, the elastic ones left out of the intact."""
        if state == "elastic":
            return np.flatnonzero(self.elastic & (self.state == JOINT_STATES.index("intact")))
        chosen = self.state == JOINT_STATES.index(state)
        return np.flatnonzero(chosen & ~self.elastic if state == "intact" else chosen)


def wall_shape(history, sample="max", magnify=None):
    """Return the WallShape of a History at a sample.

    sample: "max" (of the damage index), "end", or an index into the series;
    magnify: factor on the motion, None for one that makes it visible.
    """
    check_magnify(magnify)
    sample, damage = choose_sample(history, sample)
    return shape_at(history, sample, damage, magnify)


def check_magnify(magnify):
    """Raise InputError where a factor on the motion is neither None nor zero or more."""
    if magnify is not None and not (np.isfinite(magnify) and magnify >= 0):
        raise InputError(f"magnify = {magnify!r}: expected zero or a positive number; correct it")


def shape_at(history, sample, damage, magnify=None, snapshot=None):
    """Return the WallShape at a sample (index), where DI is `damage`; magnify: as of `wall_shape`.

    snapshot: index of the snapshot to show, None for the one nearest to the sample.  In one that
    follows bricks beyond the last sample, joints are left out whose bricks are no longer beside
    each other.
    """
    time_s = float(history.time_s[sample])
    snapshot = nearest_snapshot(history, time_s) if snapshot is None else snapshot
    motion = motion_of(history, snapshot)
    if magnify is None:
        magnify = magnification(history.bodies, motion)
    supports = support_motion(history, snapshot)
    segments = geometry.joint_segments(history.joints, history.bodies, motion, magnify, supports)
    cuts = geometry.cuts_of_lintels(history.joints, history.bodies)
    segments[cuts] = np.nan
    if snapshot is not None and history.snapshot_time_s[snapshot] > history.time_s[-1]:
        time_s = float(history.snapshot_time_s[snapshot])
        segments[
            geometry.joint_gaps(history.joints, history.bodies, motion, supports) > WIDEST_JOINT
        ] = np.nan
    return WallShape(
        sample=sample,
        time_s=time_s,
        index=damage,
        snapshot_time_s=None if snapshot is None else float(history.snapshot_time_s[snapshot]),
        magnification=float(magnify),
        corners=geometry.body_corners(history.bodies, motion, magnify),
        kinds=geometry.kinds_of_bodies(history.bodies["course"]),
        supports=geometry.support_outlines(supports, SUPPORT_DEPTH, magnify),
        ground_moves=len(supports.left) > 1 or bool(supports.motion.any()),
        segments=segments,
        state=joint_states(history, sample),
        elastic=history.joints["elastic"].to_numpy(bool) & ~cuts,
        crack_width_m=widths(history, sample),
    ).on_page()


def widths(history, sample):
    """Crack widths of all contact points at a sample, (n_joints,) [m]."""
    return np.hypot(history.opening_m[sample], history.offset_m[sample], dtype=float)


def magnification(bodies, motion):
    """Factor that makes the largest displacement of a corner about VISIBLE_SHARE of the height of
    the brickwork: 1, 2 or 5 times a power of ten, from 1 to LARGEST_MAGNIFICATION; 1 without
    motion."""
    rest = geometry.body_corners(bodies)
    moved = geometry.body_corners(bodies, motion) - rest
    largest = float(np.max(np.hypot(moved[..., 0], moved[..., 1])))
    is_brick = bodies["course"].to_numpy() >= 0
    return visible(largest, height=float(rest[is_brick, :, 1].max()))


def visible(largest, height, share=VISIBLE_SHARE):
    """Factor that makes a largest displacement [m] about this share of a height [m], as of
    `magnification`."""
    if largest == 0:
        return 1.0
    return round_125(min(max(share * height / largest, 1.0), LARGEST_MAGNIFICATION))


def round_125(value):
    """The nearest, in ratio, of 1, 2 and 5 times a power of ten to a positive value.

    >>> [round_125(value) for value in (0.8, 3.0, 19.3, 690.0)]
    [1.0, 2.0, 20.0, 500.0]
    """
    steps = 10.0 ** np.floor(np.log10(value)) * np.array([1.0, 2.0, 5.0, 10.0])
    return float(steps[np.argmin(np.abs(np.log(steps / value)))])


# --- line widths of cracks ----------------------------------------------------------------------


def line_width(crack_width_m, widest_pt=WIDEST_PT):
    """Line width [pt] of a crack width [m]; widest_pt: of the widest cracks, from `widest_line`.

    The square root keeps a crack of 0.1 mm visible beside one of 5 mm, where light damage ends and
    the lines stop growing.
    """
    share = np.sqrt(np.minimum(np.abs(crack_width_m) / MILLIMETRE / LEGEND_WIDTHS_MM[-1], 1.0))
    return THINNEST_PT + (widest_pt - THINNEST_PT) * share


def widest_line(brick_m, span_m, page_pt):
    """Line width of the widest cracks [pt]: SHARE_OF_BRICK of the lowest brick as drawn, at most
    WIDEST_PT.

    brick_m: height of that brick; span_m: length and height of what is drawn; page_pt: width and
    height that it fills, in true scale.
    """
    pt_per_m = min(page / span for page, span in zip(page_pt, span_m))
    return float(np.clip(SHARE_OF_BRICK * brick_m * pt_per_m, LEAST_WIDEST_PT, WIDEST_PT))


def legend_widths_mm(shape):
    """Three crack widths [mm], from the smallest to the one that bounds a WallShape's, with
    labels."""
    largest = shape.crack_width_m.max() / MILLIMETRE
    top = int(np.searchsorted(LEGEND_WIDTHS_MM[2:-1], largest)) + 2
    chosen = [LEGEND_WIDTHS_MM[i] for i in (0, (top + 1) // 2, top)]
    return [(mm, f"{'≥ ' if mm == LEGEND_WIDTHS_MM[-1] else ''}{mm:g} mm wide") for mm in chosen]
