"""Which motions and pushes a run can have: ranges as those of a wall, which find numbers in a wrong unit.

The loading refuses what cannot be computed; these ranges are narrower.  Of a motion zero is refused, too, as a wall at
rest is no result; a factor of a sequence may be zero, a pause.
"""

from damage.motion.loading import Harmonic, Recorded, TopDisplacement
from damage.units import GRAVITY
from damage.wall.fields import Range, message_of
from damage.wall.plausible import rows

RANGES = {
    "--harmonic PERIOD_S": Range(0.01, 10, "s", {"ms": 1e-3}, "machines; a hundred times the period of a house's wall"),
    "--harmonic AMPLITUDE_G": Range(1e-4, 2, "g", {"%": 0.01, "m/s2": 1 / GRAVITY, "cm/s2": 0.01 / GRAVITY},
                                    "times the largest factor of `--sequence`: traffic; strong shaking tables"),
    "--scale": Range(0.01, 100, "", {"%": 0.01}, "without its sign; the records of studies that ship get up to 10"),
    "--sequence": Range(0.01, 100, "", {"%": 0.01}, "each factor, without its sign; 0 is a pause", zero=True),
    "--pushover, --cyclic": Range(1e-4, 20, "%", {}, "a joint stays elastic; slender piers topple"),
}
"""{option: Range}."""


def implausible_motion(loading, factors=(1.0,)):
    """What is implausible of a Loading and the factors on it, a list of str.

    >>> implausible_motion(Harmonic(0.2, 20.0))
    ['--harmonic AMPLITUDE_G = 20 g, expected 0.0001 to 2 g: 20 % is 20e-2 g, 20 cm/s2 is 0.02039 g']
    >>> implausible_motion(Harmonic(0.2, 0.1), (1.0, 0.0))
    []
    """
    largest = max(map(abs, factors))
    given = [("--sequence", factor) for factor in factors]
    if isinstance(loading, Harmonic):
        given += [("--harmonic PERIOD_S", loading.period_s), ("--harmonic AMPLITUDE_G", loading.amplitude_g * largest)]
    if isinstance(loading, Recorded):
        given += [("--scale", loading.scale)]
    if isinstance(loading, TopDisplacement):
        given += [("--pushover, --cyclic", drift_pct) for drift_pct in loading.amplitudes_pct]
    found = [message_of(name, value, RANGES[name]) for name, value in given]
    if isinstance(loading, Recorded) and loading.scale and loading.peak_g * largest == 0:
        found.append(f"{loading.name}: the base stands still, expected a motion")
    return list(dict.fromkeys(filter(None, found)))


def markdown():
    """The ranges as a table of the documents."""
    return rows("option", RANGES)
