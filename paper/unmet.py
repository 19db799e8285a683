"""Why hardly any reading of the paper meets some claims: a table of docs/paper/open-points.md.

    python3 -m paper unmet

P2b by periods of walls with the opening elsewhere and with more mass; P9e, P11c and P12 by the
symmetric wall pushed at its top and shaken at 0.2 s, 0.1 g by two cycles, in the reference solver,
with an elastic lintel and one of two courses.
"""

from dataclasses import replace

import numpy as np

import damage
from damage.law.modes import natural_modes
from damage.measure.cycles import cycle_measures, drift_cycles
from damage.units import GRAVITY, MILLIMETRE
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from paper.bench import REPOSITORY, arguments, show
from paper.criteria import (
    CYCLE_LENGTHS_S,
    DI_TOLERANCE,
    LARGEST_DI,
    PERFORATED_PERIOD_S,
    PRINTED_TOLERANCE,
)
from paper.verdict import listed

WALL = REPOSITORY / "walls" / "symmetric.py"
LINTELS = ("elastic", "2")
DRIFT_PCT, SPEED_M_S = 0.5, 0.005
AMPLITUDE_G = 0.1
LEAST_LAST_S = (1 - PRINTED_TOLERANCE) * CYCLE_LENGTHS_S[-1]
"""Shortest last cycle at 0.1 g that meets P12d, e, f [s]."""


def first_period_s(wall):
    return float(natural_modes(lay_out(wall)).period_s[0])


def periods():
    """Rows on P2b: the asymmetric wall with wider narrow piers, and the three walls with more mass
    on top."""
    walls = [
        load_wall(WALL.with_name(f"{name}.py")) for name in ("solid", "symmetric", "asymmetric")
    ]
    [opening] = walls[-1].openings
    for bricks in (2.5, 3, 3.5):
        moved = replace(
            walls[-1], openings=[replace(opening, left=bricks * walls[-1].brick.length)]
        )
        yield (
            "P2b",
            f"period with a narrow pier of {bricks:g} bricks [s]",
            f"{first_period_s(moved):.3f}",
        )
    for share in (1.07, 1.2):
        of = [
            first_period_s(replace(wall, precompression=share * wall.precompression))
            for wall in walls
        ]
        yield (
            "P2b",
            f"periods of solid, symmetric, asymmetric wall with {share:g} of the mass on top [s]",
            listed(of, 4),
        )


def pushed(lintel):
    """The wall pushed at its top: drift ratio, base shear [N], DI by displacement and by the shear
    limit, each (n,)."""
    history = damage.run(str(WALL), pushover=DRIFT_PCT, speed=SPEED_M_S, lintel=lintel)
    moving = history.moving
    by = [
        history.index(slip=slip).loc[moving.index, "DI"].to_numpy()
        for slip in ("displacement", "shear-limit")
    ]
    return (moving["drift_ratio"].abs().to_numpy(), moving["base_shear_n"].abs().to_numpy(), *by)


def first_at(reached, values):
    """The value where something is reached first, nan where it never is; reached: bool (n,);
    values: (n,)."""
    return float(values[np.argmax(reached)]) if reached.any() else np.nan


def slow_motion(drift, force, indices, height_m, weight_n, period_s):
    """Rows on P9e: drift and DI of a wall that follows 0.1 g statically, and what the paper's DI
    takes."""
    static_m = AMPLITUDE_G * GRAVITY * (period_s / (2 * np.pi)) ** 2
    there = [first_at(drift >= static_m / height_m, index) for index in indices]
    yield (
        "P9e",
        "static displacement of the top at 0.1 g, a (T0 / 2 pi)² [mm]",
        f"{static_m / MILLIMETRE:.2f}",
    )
    yield (
        "P9e",
        "DI of the wall pushed so far, by displacement, by the shear limit",
        listed(there, 3),
    )
    least = LARGEST_DI[1.0] - DI_TOLERANCE
    far = [first_at(index >= least, drift) * height_m / MILLIMETRE for index in indices]
    yield (
        "P9e",
        f"displacement from which the pushed wall has a DI of {least:g} [mm]",
        listed(far, 2),
    )
    share = [first_at(index >= least, force) / weight_n for index in indices]
    yield "P9e", "base shear there over the weight", listed(share, 3)


def last_cycle(lintel, drift, force, height_m, weight_n, period_s, friction):
    """Rows on P12 and P11c: 0.2 s, 0.1 g, two cycles, against the secant stiffness of the pushed
    wall."""
    history = damage.run(
        str(WALL), harmonic=(PERFORATED_PERIOD_S, AMPLITUDE_G), cycles=2, rest=1, lintel=lintel
    )
    words = "all courses elastic" if lintel == "elastic" else f"{lintel} courses elastic"
    elastic = np.searchsorted(drift, 5e-5)  # before the first break
    secant_s = period_s * np.sqrt(
        force[elastic] / drift[elastic] * drift[elastic:] / force[elastic:]
    )
    needed_m = height_m * first_at(secant_s >= LEAST_LAST_S, drift[elastic:])
    start_s, end_s = drift_cycles(history)[1][0]
    series = history.moving
    free = series[(series["time_s"] >= start_s) & (series["time_s"] <= end_s)]
    swing_m = height_m * free["drift_ratio"].abs().max()
    yield (
        "P12",
        (
            f"{words}: displacement from which the secant period is {LEAST_LAST_S:.3f} s; largest"
            " in the first free cycle [mm]"
        ),
        listed((needed_m / MILLIMETRE, swing_m / MILLIMETRE), 2),
    )
    yield (
        "P12",
        f"{words}: length of that cycle [s]",
        f"{cycle_measures(history)['first_free_cycle_s']:.3f}",
    )
    shear = series["base_shear_n"].abs().max() / (friction * weight_n)
    yield "P11c", f"{words}: largest base shear over the friction of the weight", f"{shear:.2f}"
    left_m = height_m * abs(history.series["drift_ratio"].iloc[-1])
    most_m = height_m * series["drift_ratio"].abs().max()
    yield (
        "P11c",
        f"{words}: largest and residual displacement of the top [mm]",
        listed((most_m / MILLIMETRE, left_m / MILLIMETRE), 2),
    )


def main():
    """Print the table."""
    arguments(__doc__)
    wall = load_wall(WALL)
    layout, period_s = lay_out(wall), first_period_s(wall)
    weight_n = GRAVITY * float(layout.bodies.mass.sum())
    height_m, friction = (
        wall.built_height - wall.brick.height / 2,
        np.tan(wall.joint.friction_angle),
    )
    rows = [*periods()]
    for lintel in LINTELS:
        drift, force, *indices = pushed(lintel)
        if lintel == LINTELS[0]:
            rows += slow_motion(drift, force, indices, height_m, weight_n, period_s)
        rows += last_cycle(lintel, drift, force, height_m, weight_n, period_s, friction)
    show(
        ("claim", "number", "value"),
        sorted(rows, key=lambda row: ("P2b", "P9e", "P11c", "P12").index(row[0])),
    )
