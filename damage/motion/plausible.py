"""Which peaks a base motion can have, to find records and amplitudes in a wrong unit."""

HIGHEST_PLAUSIBLE_G = 5.0
"""More than any recorded ground motion: 4.1 g, the vector sum at station IWTH25 (KiK-net) in the Iwate-Miyagi
earthquake of 2008."""


def implausible_peak(peak_g):
    """What is implausible of a base motion's peak [g], in words, with the units that may be confused; None where
    nothing is.

    >>> implausible_peak(4.9)
    >>> implausible_peak(11.0).partition(":")[0]
    'a base motion with a peak of 11 g, expected up to 5 g'
    """
    if peak_g <= HIGHEST_PLAUSIBLE_G:
        return None
    return (f"a base motion with a peak of {peak_g:.3g} g, expected up to {HIGHEST_PLAUSIBLE_G:g} g: cm/s2 (gal) where "
            "m/s2 is expected makes it 100 times too large, m/s2 where g is expected 9.81 times, gal 981 times")


HIGHEST_PLAUSIBLE_M_S = 4.0
"""More than any recorded ground velocity: 3.18 m/s at station TCU068 in the Chi-Chi earthquake of 1999 (Anderson, 2010,
Bulletin of the Seismological Society of America 100)."""

LOWEST_PLAUSIBLE_G = 5e-4
"""Motions with a lower peak are not felt (0.05 % of g: Worden et al., 2012, the intensity scale of ShakeMap)."""


def implausible_velocity(pgv_m_s):
    """What is implausible of a base motion's peak velocity [m/s], in words; None where nothing is.

    >>> implausible_velocity(10.0).partition(":")[0]
    'a base motion with a PGV of 10 m/s, expected up to 4 m/s'
    """
    if pgv_m_s <= HIGHEST_PLAUSIBLE_M_S:
        return None
    return (f"a base motion with a PGV of {pgv_m_s:.3g} m/s, expected up to {HIGHEST_PLAUSIBLE_M_S:g} m/s: times that "
            "are no seconds, a wrong unit, or a baseline that is off (--baseline ORDER, --band LOW_HZ HIGH_HZ) make it "
            "too large")


def faint_warnings(peak_g):
    """Warning of a recorded motion whose peak [g] is below what is felt: a list of lines."""
    if peak_g >= LOWEST_PLAUSIBLE_G:
        return []
    return [f"a base motion with a peak of {peak_g:.3g} g, expected {LOWEST_PLAUSIBLE_G:g} g or more, as weaker ones "
            "are not felt: g where cm/s2 (gal) is expected makes it 981 times too small"]
