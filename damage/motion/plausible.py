"""Which motions and pushes a run can have, to find records, amplitudes and factors in a wrong unit.

The loading refuses what cannot be computed; the ranges here, and those that its fields say, are
narrower.  Of a motion zero is refused, too, as a wall at rest is no result; a factor of a sequence
may be zero, a pause.
"""

from dataclasses import replace

import numpy as np

from damage.fields import message_of, plausible, ranges_of
from damage.motion.loading import Harmonic, Recorded, TopDisplacement
from damage.motion.record import HORIZONTAL, VERTICAL
from damage.motion.sequence import Event

RANGES = dict(
    zip(
        (
            "--harmonic PERIOD_S",
            "--harmonic AMPLITUDE_G",
            "--scale",
            "--sequence",
            "--pushover, --cyclic",
        ),
        (
            usual
            for kind in (Harmonic, Recorded, Event, TopDisplacement)
            for usual in ranges_of(kind).values()
        ),
        strict=True,
    )
)
"""{option: Range}, as their fields say."""

PEAK = plausible(
    5e-4,
    5.0,
    "g",
    "weaker ones are not felt (0.05 % of g: Worden et al., 2012, the intensity scale of "
    "ShakeMap); 4.1 g, the vector sum at station IWTH25 in the Iwate-Miyagi earthquake of 2008",
)
"""Range of the PGA of a base motion [g]."""
VELOCITY = plausible(
    0.0,
    4.0,
    "m/s",
    "3.18 m/s at station TCU068 in the Chi-Chi earthquake of 1999 (Anderson, 2010, Bulletin "
    "of the Seismological Society of America 100)",
)
"""Range of the PGV of a base motion from rest [m/s]."""


def implausible_peak(peak_g):
    """What is implausible of a base motion's peak [g] that is too large, in words, with the units
    that may be confused; None where nothing is.

    >>> implausible_peak(4.9)
    >>> implausible_peak(11.0).partition(":")[0]
    'PGA of the base motion = 11 g, expected 0.0005 to 5 g'
    """
    return (
        None
        if peak_g < PEAK.least
        else _implausible(
            "PGA",
            peak_g,
            PEAK,
            "cm/s2 (gal) where m/s2 is expected makes it 100 times too large, m/s2 where g is "
            "expected 9.81 times, gal 981 times",
        )
    )


def implausible_velocity(pgv_m_s):
    """What is implausible of a base motion's peak velocity [m/s], in words; None where nothing
    is."""
    return _implausible(
        "PGV",
        pgv_m_s,
        VELOCITY,
        "times that are no seconds, a wrong unit, or a baseline that is off "
        "(--baseline ORDER, --band LOW_HZ HIGH_HZ) make it too large",
    )


def faint_warnings(peak_g):
    """Warning of a recorded motion whose peak [g] is below what is felt: a list of lines."""
    return (
        []
        if peak_g >= PEAK.least
        else [
            _implausible(
                "PGA", peak_g, PEAK, "g where cm/s2 (gal) is expected makes it 981 times too small"
            )
        ]
    )


def _implausible(name, value, usual, cause):
    message = message_of(f"{name} of the base motion", value, usual)
    return message and f"{message}: {cause}"


MOST_OFFSET = 0.1
"""Mean of a record's first OFFSET_S, as a share of its peak, above which zero is off; real ones
have up to 0.015."""
OFFSET_S = 1.0
"""Length of a record's first part, over which the mean is taken [s]."""


def offset_warnings(record):
    """Warning of a Record that moves about another value than zero, as instruments do: a list of
    lines.

    record: before any window, which may begin within the motion.
    """
    a = record.acceleration_m_s2
    mean = float(np.mean(a[: max(1, round(OFFSET_S / record.time_step_s))]))
    peak = float(np.abs(a).max())
    if abs(mean) <= MOST_OFFSET * peak:
        return []
    return [
        f"{record.name}: the mean of the first {OFFSET_S:g} s is {mean:.3g} m/s2,"
        f" {100 * abs(mean) / peak:.0f} % of the peak, expected zero: an instrument's offset, which"
        " makes PGA and PGV too large; give --baseline 0"
    ]


_NEIGHBOURS = 4
"""Samples on either side of a spike that are looked at."""
SPIKE = 5.0
"""Least spike over the largest deviation but one of its neighbours; that of the real records tried,
with half of the peak or more, is up to 2.6 times."""


def spike_warnings(record):
    """Warning of a Record with a sample far from its neighbours and from the rest, which no ground
    motion has: a list of lines.  One further such sample may be beside it."""
    a = record.acceleration_m_s2
    size = np.abs(a)
    padded = np.pad(a, _NEIGHBOURS, mode="reflect")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * _NEIGHBOURS + 1)
    candidates = np.flatnonzero(size > 0.5 * size.max())
    beside = np.delete(around[candidates], _NEIGHBOURS, axis=1)
    middle = np.median(beside, axis=1)
    spread = np.sort(np.abs(beside - middle[:, np.newaxis]), axis=1)[:, -2]
    spikes = candidates[np.abs(a[candidates] - middle) > SPIKE * spread]
    rest = np.delete(size, spikes)
    if not spikes.size or size[spikes].max() <= rest.max(initial=0.0):
        return []
    k = spikes[np.argmax(size[spikes])]
    more = f", and {spikes.size - 1} more like it" if spikes.size > 1 else ""
    near = round(middle[candidates == k][0], 4) + 0.0
    return [
        f"{record.name}: sample {k} (from 0) at {k * record.time_step_s:g} s is {a[k]:.4g}"
        f" m/s2{more}; expected about {near:.3g} as its neighbours, and up to"
        f" {rest.max(initial=0.0):.3g} as all others: a spike, or a number for a missing sample;"
        " correct it in the file"
    ]


def channel_warnings(loading):
    """Warnings of components of a Recorded whose names are those of another direction: a list of
    lines."""
    return [
        f"{record.name}: its name is that of a {named} component, and it is taken as the {taken}"
        f" motion; expected a {taken} one, give that"
        for record, taken, channels, named in (
            (loading.record, "horizontal", VERTICAL, "vertical"),
            (loading.vertical, "vertical", HORIZONTAL, "horizontal"),
        )
        if record and channels.fullmatch(record.name)
    ]


def record_warnings(loading):
    """Warnings of the records of a Recorded, as named, as read and, for their offset, after
    baseline and band-pass."""
    whole = replace(loading, window_s=None, scale=1.0)
    prepared = [
        component for component in (*whole.motion, whole.applied_across()) if component is not None
    ]
    read = [text for component in loading.components for text in spike_warnings(component)]
    return [*channel_warnings(loading), *read] + [
        text for component in prepared for text in offset_warnings(component)
    ]


def implausible_motion(loading, factors=(1.0,)):
    """What is implausible of a Loading and the factors on it, a list of str.

    >>> print(*implausible_motion(Harmonic(0.2, 20.0)))
    --harmonic AMPLITUDE_G = 20 g, expected 0.0001 to 2 g: 20 % is 20e-2 g, 20 cm/s2 is 0.02039 g
    >>> implausible_motion(Harmonic(0.2, 0.1), (1.0, 0.0))
    []
    """
    largest = max(map(abs, factors))
    given = [("--sequence", factor) for factor in factors]
    if isinstance(loading, Harmonic):
        given += [
            ("--harmonic PERIOD_S", loading.period_s),
            ("--harmonic AMPLITUDE_G", loading.amplitude_g * largest),
        ]
    if isinstance(loading, Recorded):
        given += [("--scale", loading.scale)]
    if isinstance(loading, TopDisplacement):
        given += [("--pushover, --cyclic", drift_pct) for drift_pct in loading.amplitudes_pct]
    messages = [message_of(name, value, RANGES[name]) for name, value in given]
    if isinstance(loading, Recorded) and loading.scale and loading.peak_g * largest == 0:
        messages.append(f"{loading.name}: the base stands still, expected a motion")
    return list(dict.fromkeys(filter(None, messages)))
