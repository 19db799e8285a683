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
