"""Elementary functions with the same bits on every machine, of numbers and of arrays.

They consist of sums, products, quotients and square roots, which IEEE 754 rounds in one way.  Those
of libraries differ in their last bits between processors and versions, and a brittle wall amplifies
the last bit.

Errors (tests/core/test_elementary.py): `exp`, `log`, `sin`, `cos` and `atan` below one unit in the
last place, `tan` and `sin_of_turns` below three; sines up to a million radians, exponentials of
normal size.  `exp`, `sin` and `cos` are also compiled into the time step.

Methods and coefficients are those of FDLIBM (Sun Microsystems, 1993, freely distributable);
reduction of arguments by W. J. Cody, W. Waite (1980), Software Manual for the Elementary Functions,
Prentice-Hall.
"""

import math

import numpy as np
from numba.extending import register_jitable

_LN2 = 6.93147180369123816490e-01, 1.90821492927058770002e-10
"""Parts of ln 2, of which products of the first with counts up to 2**20 are exact."""
_QUARTER = 1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21
"""Parts of a quarter of a turn [rad], of which products of all but the last with such counts are
exact."""
_ATAN = (
    3.33333333333329318027e-01,
    -1.99999999998764832476e-01,
    1.42857142725034663711e-01,
    -1.11111104054623557880e-01,
    9.09088713343650656196e-02,
    -7.69187620504482999495e-02,
    6.66107313738753120669e-02,
    -5.83357013379057348645e-02,
    4.97687799461593236017e-02,
    -3.65315727442169155270e-02,
    1.62858201153657823623e-02,
)
_CENTRES = (
    (7 / 16, 0.0, 0.0, 0.0),
    (11 / 16, 0.5, 4.63647609000806093515e-01, 2.26987774529616870924e-17),
    (19 / 16, 1.0, 7.85398163397448278999e-01, 3.06161699786838301793e-17),
    (39 / 16, 1.5, 9.82793723247329054082e-01, 1.39033110312309984516e-17),
)
"""Rows of `atan`: largest argument, centre of the series, and `atan` of the centre in two parts."""
_RIGHT_ANGLE = 1.57079632679489655800e00, 6.12323399573676603587e-17
_SQRT_HALF = 0.7071067811865476
_PART = 1024  # values


@register_jitable
def exp(x):
    """e to the power of x."""
    count = np.floor(x * 1.4426950408889634 + 0.5)
    high = x - count * _LN2[0]
    low = count * _LN2[1]
    r = high - low
    t = r * r
    c = r - t * (
        1.66666666666666019037e-01
        + t
        * (
            -2.77777777770155933842e-03
            + t
            * (
                6.61375632143793436117e-05
                + t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08)
            )
        )
    )
    return np.ldexp(1.0 - ((low - (r * c) / (2.0 - c)) - high), np.int64(count))


def log(x):
    """Natural logarithm of a positive x."""
    part, count = np.frexp(x)
    small = part < _SQRT_HALF
    f = np.where(small, 2.0 * part, part) - 1.0
    count = np.where(small, count - 1.0, count)
    s = f / (2.0 + f)
    half = 0.5 * f * f
    z = s * s
    series = z * (
        6.666666666666735130e-01
        + z
        * (
            3.999999999940941908e-01
            + z
            * (
                2.857142874366239149e-01
                + z
                * (
                    2.222219843214978396e-01
                    + z
                    * (
                        1.818357216161805012e-01
                        + z * (1.531383769920937332e-01 + z * 1.479819860511658591e-01)
                    )
                )
            )
        )
    )
    return count * _LN2[0] - ((half - (s * (half + series) + count * _LN2[1])) - f)


def power(x, y):
    """A positive x to the power of y: exp(y log x), to about 1e-15 times 1 + |y log x|."""
    return exp(y * log(x))


@register_jitable
def sin(x):
    """Sine of x [rad]."""
    return _of_quarters(*_reduced(x), 0.0)


@register_jitable
def cos(x):
    """Cosine of x [rad]."""
    return _of_quarters(*_reduced(x), 1.0)


def sin_of_turns(turns):
    """Sine of an angle in turns: sin(2 pi turns)."""
    count = np.floor(4.0 * turns + 0.5)
    return _of_quarters(count, (turns - 0.25 * count) * (2.0 * math.pi), 0.0, 0.0)


def tan(x):
    """Tangent of x [rad]."""
    return sin(x) / cos(x)


def atan(x):
    """Arc tangent of x [rad], within a quarter of a turn of zero."""
    size = np.abs(x)
    least, centre, *terms = (
        np.select([size < row[0] for row in _CENTRES], values, last)
        for values, last in zip(zip(*_CENTRES), (math.inf, 0.0, *_RIGHT_ANGLE))
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(least < math.inf, (size - centre) / (1.0 + centre * size), -1.0 / size)
    z = t * t
    w = z * z
    odd = z * (
        _ATAN[0] + w * (_ATAN[2] + w * (_ATAN[4] + w * (_ATAN[6] + w * (_ATAN[8] + w * _ATAN[10]))))
    )
    even = w * (_ATAN[1] + w * (_ATAN[3] + w * (_ATAN[5] + w * (_ATAN[7] + w * _ATAN[9]))))
    return np.copysign(terms[0] - ((t * (odd + even) - terms[1]) - t), x)


def hypot(x, z):
    """Length of a vector (x, z) of usual size."""
    return np.sqrt(x * x + z * z)


def total(values):
    """Sum of values (..., n) along the last axis.  numpy's own takes long rows in parts whose size
    depends on its version."""
    parts = np.add.reduceat(values, np.arange(0, values.shape[-1], _PART), axis=-1)
    return np.add.reduce(parts, axis=-1)


@register_jitable
def _reduced(x):
    """The nearest number of quarter turns to x [rad], and what is left of x in two parts."""
    count = np.floor(x * 0.6366197723675814 + 0.5)
    high = x - count * _QUARTER[0]
    low = count * _QUARTER[1]
    rest = high - low
    low = count * _QUARTER[2] - ((high - rest) - low)
    return count, rest - low, (rest - (rest - low)) - low


@register_jitable
def _of_quarters(count, rest, low, ahead):
    """Sine of so many quarter turns and a rest, |rest + low| <= pi / 4 [rad], further `ahead` by
    quarter turns."""
    z = rest * rest
    r = 8.33333333332248946124e-03 + z * (
        -1.98412698298579493134e-04
        + z
        * (
            2.75573137070700676789e-06
            + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
        )
    )
    sine = rest - ((z * (0.5 * low - z * rest * r) - low) + z * rest * 1.66666666666666324348e-01)
    r = z * (
        4.16666666666666019037e-02
        + z
        * (
            -1.38888888888741095749e-03
            + z
            * (
                2.48015872894767294178e-05
                + z
                * (
                    -2.75573143513906633035e-07
                    + z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)
                )
            )
        )
    )
    w = 1.0 - 0.5 * z
    cosine = w + (((1.0 - w) - 0.5 * z) + (z * r - rest * low))
    place = count + ahead
    place = place - 4.0 * np.floor(0.25 * place)  # 0, 1, 2 or 3
    odd = place - 2.0 * np.floor(0.5 * place)
    return (1.0 - (place - odd)) * (odd * cosine + (1.0 - odd) * sine)
