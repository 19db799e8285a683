"""Measures of the force on a wall: peak of any run, first loading of a pushed wall, forces by hand.

Force is the base shear and displacement that of the top course, as measured in a laboratory.
"""

import math

import numpy as np

from damage.history.reader import History
from damage.history.schema import Column, measure
from damage.units import GRAVITY
from damage.wall.kinds import CAP_HEIGHT
from damage.wall.parameters import Wall

INITIAL_SHARE = 0.15
"""Share of the peak force at which the initial stiffness is taken, on first loading [-]."""
SECANT_SHARE = 0.7
"""Share of the peak force at which the secant stiffness is taken, on first loading [-]."""


def since_the_push(history: History) -> tuple[np.ndarray, ...]:
    """Base shear [N], drift ratio [-] and top displacement [m] of all samples, (n,) each.  The
    latter two are counted from time zero, the last sample of a settlement stage, where the push
    begins; before it all are zero.

    >>> shear, drift, top = since_the_push(pushed)
    >>> round(float(drift.max()), 4), shear.shape
    (0.002, (21,))
    """
    force, drift, top = (
        history.series[name].to_numpy()
        for name in ("base_shear_n", "drift_ratio", "top_displacement_m")
    )
    start = max(0, np.count_nonzero(history.series["stage"] == "settlement") - 1)
    before = np.arange(len(force)) < start
    return tuple(
        np.where(before, 0.0, values) for values in (force, drift - drift[start], top - top[start])
    )


@measure(
    {
        "peak_base_shear_n": Column(
            "N", "largest absolute horizontal force of the wall on the ground"
        )
    }
)
def peak_base_shear(history: History) -> float:
    """Largest |base shear| of a History under any loading [N].

    >>> float(peak_base_shear(pushed)["peak_base_shear_n"])
    10000.0
    """
    return float(np.abs(history.series["base_shear_n"]).max())


@measure(
    {
        "peak_force_n, drift_at_peak_force": Column(
            "N, 1", "of a pushed wall: largest base shear, the drift there"
        ),
        "peak_force_wave_n": Column(
            "N",
            "of a pushed wall: amplitude of the base shear about a straight line in the first"
            " period before its peak, by which that depends on the speed",
        ),
        "initial_stiffness_n_per_m, secant_stiffness_n_per_m": Column(
            "N/m",
            "of a pushed wall: base shear over top displacement at 0.15 and 0.7 of the peak, on"
            " first loading",
        ),
    }
)
def first_loading(history: History):
    """Peak force and stiffnesses of a pushed History.

    A quasi-static push does not vibrate; the wave tells how far this one is from it.  The
    stiffnesses are taken where |base shear| first reaches INITIAL_SHARE and SECANT_SHARE of the
    peak.  They are of the entire run, in whichever direction each is reached first; `bilinear` uses
    the envelope in one direction.

    >>> float(first_loading(pushed)["drift_at_peak_force"])
    0.001
    """
    if history.loading.drive.top is None:
        return None
    # The base shear in place of the force at the top: the two differ by inertia and damping only,
    # and the steps of a prescribed velocity excite the base shear less.
    force, drift, displacement = since_the_push(history)
    peak = int(np.argmax(np.abs(force)))
    values = [float(abs(force[peak])), float(abs(drift[peak])), _wave(history, force, peak)]
    for share in (INITIAL_SHARE, SECANT_SHARE):
        first = int(np.argmax(np.abs(force) >= share * values[0]))
        values.append(
            float(force[first] / displacement[first]) if displacement[first] != 0 else None
        )
    return values


def _wave(history, force, peak):
    """Amplitude of a sine [N] that scatters about a straight line as the forces do in the first
    period up to the sample `peak`; None where that has no more than two samples."""
    time_s = history.time_s
    since = time_s[peak] - (history.eigen_period_s or 0.0)
    before = slice(int(np.searchsorted(time_s, since)), peak + 1)
    if peak + 1 - before.start < 3:
        return None
    line = np.polynomial.Polynomial.fit(time_s[before], force[before], 1)
    return float(np.sqrt(2) * np.std(force[before] - line(time_s[before])))


def hand_capacities(wall: Wall, boundary: str) -> dict[str, float]:
    """Analytical lateral capacities of a solid wall whose top is pushed, {mode: force [N]}.

    rocking: rigid rotation about toes half the length of a contact point inside the ends; where the
    top cannot rotate, about the base and about the joint below the top course.  sliding_top,
    sliding_base: friction without cohesion below the top course and at the base.  diagonal: stepped
    crack through bed joints in the middle of the wall (Mann and Müller 1982), (c + mu sigma) L t /
    b / (1 + 2 mu h / l) for bricks of length l and height h, with b = 1.5 for a parabolic shear
    stress in brittle joints, and where joints soften the height of the wall over its length, from 1
    to 1.5 (Turnšek and Sheppard 1980).  Empty for a wall with an outline, floors or restraints.

    >>> forces_n = hand_capacities(Wall("pier", 0.9, 1.5), "cantilever")
    >>> {mode: round(force / 1e3, 1) for mode, force in forces_n.items()}  # [kN]
    {'rocking': 8.0, 'sliding_top': 17.4, 'sliding_base': 18.9, 'diagonal': 18.9}
    """
    if wall.outline or wall.floors or wall.restraints:
        return {}
    brick = wall.brick
    joint = wall.joint
    height = wall.built_height
    area = wall.length * brick.thickness
    course = brick.density * GRAVITY * area * brick.height
    above = wall.precompression * area
    weight = course * height / brick.height
    arm = wall.length / 2 - brick.length / 8
    friction = math.tan(joint.friction_angle)
    middle = (above + weight / 2) / area
    stress = (joint.cohesion + friction * middle) / (1 + 2 * friction * brick.height / brick.length)
    rocking = (
        (2 * above + course + weight) * arm / (height - brick.height)
        if boundary == "fixed"
        else (above + weight) * arm / (height + CAP_HEIGHT / 2)
    )
    unevenness = min(max(height / wall.length, 1.0), 1.5) if joint.softens else 1.5
    return {
        "rocking": rocking,
        "sliding_top": friction * (above + course),
        "sliding_base": friction * (above + weight),
        "diagonal": stress * area / unevenness,
    }
