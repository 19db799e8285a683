"""Warnings of a run: conditions under which its results are doubtful."""

import numpy as np

from damage.errors import Warned
from damage.history.reader import History
from damage.measure.energy import ENERGY_ERROR, balance_error
from damage.measure.joints import ended_joints, with_bond
from damage.motion.loading import TopDisplacement
from damage.wall.as_built import warn_of_apex, warn_of_courses, warn_of_slabs
from damage.wall.lintels import elastic_share, warn_of_share

AT_REST = 1e-5
"""Unbalanced force ratio below which the static stage has converged [-]."""

MOST_DRAG = 0.02
"""Share of the largest force that the damping of a pushed wall may carry [-]; about 0.01 stays at
any speed, where contact points open one after the other."""
NEXT_TO_NOTHING = 0.001
"""Share of the largest force's work that joints may dissipate in a sample of elastic motion [-]."""
LEAST_SAMPLES = 10
"""Least number of samples from which the drag is known."""


def warnings_of(history: History) -> list[Warned]:
    """Conditions under which the results of a History are doubtful, a list of Warned: texts with a
    `code`; those that `damage.run` gave first.  Of one without a sample: those of its static stage.

    >>> [warning.code for warning in warnings_of(history)]
    []
    """
    by_code = {"static_stage": static_warnings(history)}
    if len(history.series):
        share = elastic_share(history.plan, history.joints, history.bodies)
        by_code = {
            "changed_by_hand": changed_warnings(history),
            **by_code,
            "energy_balance": energy_warnings(balance_error(history)),
            "elastic_share": warn_of_share(share),
            "push_drag": warn_of_drag(history),
            "ended_joints": warn_of_ends(history),
            "apex": warn_of_apex(history.plan.wall.joint),
            "courses": warn_of_courses(history.plan),
            "slabs": warn_of_slabs(history.plan),
        }
    return [
        *history.heard,
        *(Warned(code, text) for code, texts in by_code.items() for text in texts),
    ]


def static_warnings(history: History) -> list[str]:
    """Warnings of the static stage, a list of str: failed contact points, or a wall that is not at
    rest.

    >>> static_warnings(history)
    []
    """
    static = history.static
    warnings = []
    failed = static["broken_joints"]
    if len(history.series):  # less those without a bond: dry joints, and what a survey took
        failed -= int(np.sum(history.states.broken[0] & ~with_bond(history)[history.states.joints]))
    if failed > 0:
        warnings.append(f"{failed:.0f} contact points failed under gravity, before the motion")
    if static["unbalanced_force"] > AT_REST:
        warnings.append(
            "the motion began before the wall was at rest: unbalanced force "
            f"{static['unbalanced_force']:.2g}, expected below {AT_REST:g}"
        )
    return warnings


def changed_warnings(history: History) -> list[str]:
    """Warning of a wall that was changed in YADE's scene before it ran, a list of str."""
    changed = history.parameters.get("changed_by_hand")
    if not changed:
        return []
    return [
        f"changed by hand in YADE's scene: {changed}; the strengths, stiffnesses and masses that"
        " are stated are those of the wall's file"
    ]


def energy_warnings(error: float | None) -> list[str]:
    """Warnings of an energy balance error [-] or None, a list of str.

    >>> len(energy_warnings(0.02)), energy_warnings(0.001)
    (1, [])
    """
    if error is None or error <= ENERGY_ERROR:
        return []
    return [
        f"energy balance error {100 * error:.3g} % of the input, expected up to"
        f" {100 * ENERGY_ERROR:g} %: do not trust this run; give a smaller --dt"
        " (docs/model/validity.md, energy balance)"
    ]


def push_drag(history: History) -> float | None:
    """Force that the damping of a wall whose top is pushed adds while it moves, over the largest
    force of the run [-]; None of other runs, and where joints slide or soften all the time.

    Its work over the way of the top, the median over the samples at speed in which joints dissipate
    next to nothing: what they set free is damped at any speed.  Local damping takes a share of the
    resultant of each body against its velocity, so that a slow vibration of a moving wall is a
    drag, in proportion to its speed and weight.
    """
    if history.solver != "reference" or not history.loading.drive.quasi_static:
        return None
    series = history.series
    way_m = np.abs(np.diff(series["top_displacement_m"]))
    largest_n = np.abs(series["top_force_n"]).max()
    lost_j = np.diff(series["friction_energy_j"] + series["fracture_energy_j"])
    chosen = way_m > 0.9 * np.max(way_m, initial=0.0)
    chosen &= np.abs(lost_j) <= NEXT_TO_NOTHING * largest_n * way_m
    if np.count_nonzero(chosen) < LEAST_SAMPLES:
        return None
    work_j = np.diff(series["damping_energy_j"])
    return float(np.median(work_j[chosen] / way_m[chosen]) / largest_n)


def warn_of_drag(history: History) -> list[str]:
    """Warning of a push that is too fast for a light wall, a list of str."""
    drag = push_drag(history)
    loading = history.loading
    if drag is None or drag <= MOST_DRAG or not isinstance(loading, TopDisplacement):
        return []
    # less than in proportion: drag falls more slowly than speed
    speed = 0.7 * loading.speed_m_s * MOST_DRAG / drag
    return [
        f"the wall is pushed too fast: damping adds about {100 * drag:.2g} % of the largest force,"
        f" expected up to {100 * MOST_DRAG:g} %; give --speed {speed:.1g}"
    ]


def warn_of_ends(history: History) -> list[str]:
    """Warning of joints that ended, a list of str."""
    ended = ended_joints(history)
    if ended is None:
        return []
    others = (
        "bricks that meet anew touch at corners and faces alone"
        if history.solver == "yade"
        else "bricks find no new contacts, so that results of bricks there are not valid from then"
        " on; in YADE they collide"
    )
    count, row, sample = ended
    first = f"{count} joints ended, the first" if count > 1 else "1 joint ended,"
    where = _place_and_time(history, row, sample)
    return [f"{first} {where}: its faces no longer overlap, it has no forces any more; {others}"]


def _place_and_time(history, row, sample):
    """Text: a contact point (row) and the time of a sample."""
    joint = history.joints.iloc[row]
    time_s = history.time_s[sample]
    return (
        f"the {joint['kind']} joint at x = {joint['x_m']:.2f} m, z = {joint['z_m']:.2f} m (t ="
        f" {time_s:.2f} s)"
    )
