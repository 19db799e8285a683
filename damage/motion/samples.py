"""Operations on samples with the same bits on every machine: lines between points, band-limited
interpolation, polynomials, band-pass.

They consist of sums, products, quotients and `damage.elementary`; those of scipy.signal, np.interp
and np.polynomial differ in their last bits between machines (tests/core/test_records.py compares
both).
"""

import math

import numpy as np

from damage.elementary import sin_of_turns, tan

_WHOLE = 2.0**-30
"""Share of a step within which a time is that of a sample [-].  Rounding of times leaves up to
2**-32 of the step at the last of a million samples."""
_TERMS = 30
"""Terms of the power series of the Bessel function I0: for arguments up to 8 the rest is below
1e-30 of it."""


def linear(x, knots, values):
    """Values at x of the lines through points (knots, values), the knots rising; beyond the outer
    points it is theirs."""
    ends = np.append(knots, np.inf)
    values = np.append(values, values[-1])
    left = np.maximum(np.searchsorted(knots, x, side="right") - 1, 0)
    share = np.maximum((x - ends[left]) / (ends[left + 1] - ends[left]), 0.0)
    return values[left] + share * (values[left + 1] - values[left])


def at_times(time_s, step_s, samples):
    """Values at times [s] of the lines through samples a step [s] apart, the first at time zero;
    zero outside."""
    place = time_s / step_s
    nearest = np.rint(place)
    place = np.where(np.abs(place - nearest) <= _WHOLE, nearest, place)
    inside = (place >= 0) & (place <= samples.size - 1)
    return np.where(inside, linear(place, np.arange(samples.size), samples), 0.0)


def continued(samples, n):
    """Samples with n more at either end: the reflection in the outer sample, as a point."""
    while n > 0:
        part = min(n, samples.size - 1)
        before = samples[part:0:-1]
        after = samples[-2 : -2 - part : -1]
        samples = np.concatenate([2 * samples[0] - before, samples, 2 * samples[-1] - after])
        n -= part
    return samples


def finer(samples, times, reach, beta):
    """Samples that are so many times finer, from sample `reach` to the one `reach` before the last:
    a sinc in a Kaiser window of the shape beta, to which `reach` samples on either side
    contribute."""
    taps = np.append(_taps(times, reach, beta), np.zeros(times - 1)).reshape(-1, times)
    n = samples.size - 2 * reach
    fine = np.zeros((n, times))
    for behind, row in enumerate(taps):
        first = 2 * reach - behind
        fine += samples[first : first + n, np.newaxis] * row
    return fine.ravel()[: (n - 1) * times + 1]


def _taps(times, reach, beta):
    """Taps (2 times reach + 1,) of the low-pass at half the coarser sampling rate; their sum is
    `times`."""
    place = np.arange(-reach * times, reach * times + 1) / times
    share = place / reach
    angle = math.pi * np.where(place == 0, 1.0, place)
    sinc = np.where(place == 0, 1.0, sin_of_turns(0.5 * place) / angle)
    taps = sinc * _bessel(beta * np.sqrt(1 - share * share))
    return taps * (times / math.fsum(taps.tolist()))


def _bessel(x):
    """The modified Bessel function I0 of x (n,)."""
    part = total = np.ones_like(x)
    for k in range(1, _TERMS):
        part = part * (0.25 * x * x) / (k * k)
        total = total + part
    return total


def without_polynomial(samples, order):
    """Samples (n,) less their least-squares polynomial of an order below n, by orthogonal
    polynomials."""
    place = np.arange(1 - samples.size, samples.size, 2) / (samples.size - 1)
    before = np.zeros_like(place)
    now = np.ones_like(place)
    size_before = 1.0
    for _ in range(order + 1):
        size = math.fsum((now * now).tolist())
        samples = samples - math.fsum((samples * now).tolist()) / size * now
        before, now, size_before = now, place * now - size / size_before * before, size
    return samples


def band_passed(samples, corners, n, edge):
    """Samples after a Butterworth band-pass of n sections, forward and backward, so that it does
    not delay.

    corners: two, as shares of the sampling rate; edge: samples that continue them at either end.
    """
    sections = _butterworth(*corners, n)
    values = continued(samples, edge).tolist()
    for _ in range(2):
        values = _filtered(values, sections)[::-1]
    return np.array(values[edge:-edge])


def _butterworth(low, high, n):
    """Sections (gain, a1, a2) of a Butterworth band-pass of order n: y = gain (x - x'') - a1 y' -
    a2 y'', of which a prime is a sample earlier.  The bilinear transform of width s / (s^2 + b s +
    c) each."""
    low, high = (float(tan(math.pi * corner)) for corner in (low, high))
    width = high - low
    middle = low * high
    pairs = [(width, middle)] if n % 2 else []
    for m in range(n - 1, 0, -2):
        # a pole u of the low-pass becomes two, u + root and u - root, root^2 = u^2 - middle; their
        # product is middle
        across, up = (
            0.5 * width * float(sin_of_turns(turns)) for turns in (m / (4 * n) - 0.25, m / (4 * n))
        )
        real = across * across - up * up - middle
        imaginary = 2 * across * up
        large = math.sqrt(0.5 * (math.sqrt(real * real + imaginary * imaginary) + abs(real)))
        small = 0.5 * abs(imaginary) / large
        along, upright = (large, small) if real >= 0 else (small, large)
        # the farther of both from zero, of which no digits cancel
        across = across - along
        up = up + upright
        b = -2 * across
        c = across * across + up * up
        pairs += [(b, c), (middle * b / c, middle * middle / c)]
    return [
        (width / (1 + b + c), 2 * (c - 1) / (1 + b + c), (1 - b + c) / (1 + b + c))
        for b, c in pairs
    ]


def _filtered(values, sections):
    """A list of values after the sections one by one; before the first, it has always been that
    value."""
    before = values[0]
    for gain, a1, a2 in sections:
        first_delay = second_delay = -gain * before
        passed = []
        for value in values:
            sample = gain * value + first_delay
            first_delay = second_delay - a1 * sample
            second_delay = -gain * value - a2 * sample
            passed.append(sample)
        values = passed
        before = 0.0
    return values
