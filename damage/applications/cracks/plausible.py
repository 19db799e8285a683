"""Which cracks and loops a wall can have: finds places, widths, forces and drifts in a wrong
unit."""

import numpy as np

from damage.fields import message_of, plausible
from damage.measure.cracks import points_along

CRACK_WIDTH = plausible(
    0.01, 200, "mm", "visible by a lens; a wall that is about to fall", others={"m": 1e3, "cm": 10}
)
"""Largest width of the cracks of a file."""
LOOP_FORCE = plausible(
    0.01, 1e4, "kN", "a wall of a scale model; the largest actuators", others={"N": 1e-3}
)
"""Largest force of the loops of a test."""
LOOP_DRIFT_PCT = 0.005, 1.5
"""Plausible drift of a test's loops [%]: the largest reaches the first, where a wall is still
elastic, and the smallest does not pass the second, where most walls have failed."""
OFF_WALL = 0.2
"""Share of the length of a file's cracks off the wall above which its places are implausible."""


def implausible_places(ends, wall):
    """What is implausible of the places of cracks on a damage.Wall, in words: many lie beside it or
    in its openings; None where nothing is.  ends: (n, 2, 2) x, z of both ends of straight parts of
    cracks [m]."""
    ends = np.asarray(ends, float)
    if len(ends) == 0 or _share_off(ends, wall) <= OFF_WALL:
        return None
    return _beside("of the cracks' length", _share_off(ends, wall), ends.reshape(-1, 2), wall)


def implausible_points(points, wall):
    """Warnings on points (n, 2) of a displacement field [m]; those below the wall are on its
    base."""
    points = points[points[:, 1] >= 0]
    share = np.mean(_is_off(*points.T, wall)) if len(points) else 0.0
    return (
        _beside("of the points above the base", share, points, wall) if share > OFF_WALL else None
    )


def _beside(what, share, places, wall):
    low = places.min(axis=0)
    high = places.max(axis=0)
    return (
        f"{100 * share:.0f} % {what}, x = {low[0]:.4g} to {high[0]:.4g} m, z = {low[1]:.4g} to"
        f" {high[1]:.4g} m, lie beside wall {wall.name} of {wall.length:.4g} x"
        f" {wall.built_height:.4g} m or in its openings: expected m, x from its left end and z up"
        " from its base"
    )


def implausible_width(widest_mm):
    """What is implausible of the largest width of cracks [mm], in words; None where nothing is.

    >>> implausible_width(0.0004).partition(":")[0]
    'the widest crack = 0.0004 mm, expected 0.01 to 200 mm'
    """
    message = message_of("the widest crack", widest_mm, CRACK_WIDTH)
    return message and f"{message}, of width_mm, opening_mm or slip_mm"


def implausible_loops(largest_kn, drifts_pct, height):
    """What is implausible of the loops of a test, a list of lines.

    largest_kn: largest force; drifts_pct (n,): largest drift of each loop [%]; height [m]: over
    which it counts.

    >>> implausible_loops(9e4, [0.1, 0.2], 2.0)
    ['the largest force = 90000 kN, expected 0.01 to 10000 kN: 90000 N is 90000e-3 kN']
    """
    least, most = LOOP_DRIFT_PCT
    others = {"as a ratio": 100.0, "mm": 0.1 / height}
    drifts = plausible(least, most, "%", "", others=others)
    largest = max(drifts_pct)
    smallest = min(drifts_pct)
    messages = [message_of("the largest force", largest_kn, LOOP_FORCE)]
    if largest < least:
        messages.append(message_of("the largest loop's drift", largest, drifts))
    if smallest > most:
        messages.append(message_of("the smallest loop's drift", smallest, drifts))
    return list(filter(None, messages))


def _share_off(ends, wall):
    """Share of the length of cracks that lies beside a wall, above its outline or in its openings,
    by more than a course."""
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    x, z = np.moveaxis(points_along(ends), -1, 0)
    return length @ _is_off(x, z, wall).mean(axis=1) / length.sum()


def _is_off(x, z, wall):
    """Whether places [m] lie beside a wall, above its outline or in its openings, by more than a
    course."""
    reach = wall.brick.height
    top = np.interp(x, *zip(*wall.outline)) if wall.outline else wall.built_height
    off = (x < -reach) | (x > wall.length + reach) | (z < -reach) | (z > top + reach)
    for opening in wall.openings:
        low, high = (wall.brick.height * course for course in wall.opening_courses(opening))
        off |= (
            (x > opening.left + reach)
            & (x < opening.right - reach)
            & (z > low + reach)
            & (z < high - reach)
        )
    return off
