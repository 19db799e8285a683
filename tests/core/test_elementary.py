"""Elementary functions: their errors against 60 decimal digits, and bits that any machine must
reproduce."""

import math
from decimal import Decimal, localcontext
from functools import cache

import numpy as np
import pytest

from damage.elementary import atan, cos, exp, log, power, sin, sin_of_turns, tan

DIGITS = 60
LARGEST = 1e6
"""Up to which sines are used [rad]."""


@cache
def pi():
    """By Machin's formula: 16 atan(1/5) - 4 atan(1/239)."""
    return 16 * _series(Decimal(1) / 5, -1) - 4 * _series(Decimal(1) / 239, -1)


def _series(x, sign):
    """x + sign x^3 / 3 + x^5 / 5 + ..."""
    total, term, k = Decimal(0), x, 1
    while abs(term) > abs(x) * Decimal(10) ** -DIGITS:
        total += term / k
        term, k = term * x * x * sign, k + 2
    return total


def _sine(x):
    """Sine of a small x by its Taylor series."""
    total, term, k = Decimal(0), x, 1
    while abs(term) > abs(x) * Decimal(10) ** -DIGITS:
        total += term
        term, k = -term * x * x / ((k + 1) * (k + 2)), k + 2
    return total


def true_sin(x, ahead=0):
    """Sine of x further ahead by quarter turns: by the rest of x over pi, in [-pi/2, pi/2]."""
    x = Decimal(x) + ahead * pi() / 2
    half_turns = (x / pi()).to_integral_value()
    return _sine(x - half_turns * pi()) * (-1 if half_turns % 2 else 1)


def true_cos(x):
    return true_sin(x, 1)


def true_atan(x):
    """By halving the angle four times, then the series."""
    t = Decimal(x)
    for _ in range(4):
        t = t / (1 + (1 + t * t).sqrt())
    return 16 * _series(t, -1)


def units(value, true):
    """Error of a float in units in the last place of the true value."""
    return float(abs(Decimal(float(value)) - true) / Decimal(math.ulp(float(true))))


def largest_error(function, true, points):
    """In units in the last place, over points (n,)."""
    with localcontext() as context:
        context.prec = DIGITS
        return max(
            units(value, true(point)) for value, point in zip(function(points), points.tolist())
        )


RANDOM = np.random.RandomState(1)  # its numbers do not change
SPREAD = np.concatenate(
    [
        [0.0, -0.0],
        *(sign * 10.0 ** RANDOM.uniform(-9, high, 300) for sign in (1, -1) for high in (0, 3, 6)),
    ]
)
NEAR_QUARTERS = np.concatenate(
    [
        np.nextafter(k * (math.pi / 2), towards)
        for towards in (-np.inf, np.inf)
        for k in (np.arange(-20, 20), RANDOM.randint(-636_619, 636_619, 500))
    ]
)
"""The floats next to quarter turns, where sines are smallest beside their argument."""
ANGLES = np.concatenate(
    [
        SPREAD,
        np.arange(-40, 41) * (math.pi / 4),
        NEAR_QUARTERS,
        NEAR_QUARTERS + math.pi / 4,
        np.nextafter(math.pi / 4, [0, 1]),
        [LARGEST, -LARGEST],
        RANDOM.uniform(-LARGEST, LARGEST, 500),
        RANDOM.uniform(-7, 7, 1000),
    ]
)
TURNS = np.concatenate([SPREAD, np.arange(-9, 10) / 8, RANDOM.uniform(-2, 2, 1000)])
POWERS = np.concatenate(
    [
        [0.0, -0.0, 1.0, -1.0, 1e-300],
        RANDOM.uniform(-5, 0, 1500),
        RANDOM.uniform(-700, 700, 1500),
        10.0 ** RANDOM.uniform(-12, 0, 200),
        (np.arange(-40, 41) + 0.5) * math.log(2),
    ]
)
POSITIVE = np.concatenate(
    [
        [1.0, 0.5, 2.0, math.sqrt(0.5), 5e-324, 1.7e308, 2.2e-308],
        np.nextafter(1.0, [0, 2]),
        1 + RANDOM.uniform(-1e-3, 1e-3, 500),
        1 + 10.0 ** RANDOM.uniform(-15, 0, 300),
        RANDOM.uniform(0.4, 3, 1000),
        10.0 ** RANDOM.uniform(-300, 300, 1000),
    ]
)
SLOPES = np.concatenate(
    [SPREAD, [7 / 16, 11 / 16, 19 / 16, 39 / 16, 1.0, -1.0, 1e300], RANDOM.uniform(-4, 4, 1500)]
)


FUNCTIONS = {  # of a true value, over these points, and the error in units in the last place
    exp: (lambda x: Decimal(x).exp(), POWERS, 1.0),
    log: (lambda x: Decimal(x).ln(), POSITIVE, 1.0),
    sin: (true_sin, ANGLES, 1.0),
    cos: (true_cos, ANGLES, 1.0),
    tan: (lambda x: true_sin(x) / true_cos(x), ANGLES, 3.0),
    sin_of_turns: (lambda x: true_sin(2 * pi() * Decimal(x)), TURNS, 3.0),
    atan: (true_atan, SLOPES, 1.0),
}
of_each = pytest.mark.parametrize("function", FUNCTIONS, ids=lambda one: one.__name__)


@of_each
def test_errors_are_as_stated(function):
    true, points, most = FUNCTIONS[function]
    assert largest_error(function, true, points) < most


def test_powers_are_as_stated():
    base, exponent = 10.0 ** RANDOM.uniform(-20, 20, 1000), RANDOM.uniform(-10, 10, 1000)
    with localcontext() as context:
        context.prec = DIGITS
        for x, y, value in zip(base.tolist(), exponent.tolist(), power(base, exponent)):
            log_of = Decimal(y) * Decimal(x).ln()
            true = log_of.exp()
            assert abs(Decimal(float(value)) - true) < true * Decimal("1e-15") * (1 + abs(log_of))


@of_each
def test_numbers_arrays_and_parts_of_arrays_give_equal_bits(function):
    """Of every fifth point; parts begin at another place and lie apart, by which libraries choose
    instructions."""
    _, points, _ = FUNCTIONS[function]
    whole = function(points)
    assert np.array_equal(whole[::5], [function(x) for x in points[::5].tolist()])
    assert np.array_equal(whole[::5], [function(x) for x in points[::5]])
    assert np.array_equal(whole[3::2], function(points[3::2]))
    assert np.array_equal(whole[1:], function(points[1:]))


BITS = {
    "exp": {1.0: "0x1.5bf0a8b14576ap+1", 300.7: "0x1.c3714f17ae742p+433"},
    "log": {10.0: "0x1.26bb1bbb55516p+1", 6.02e23: "0x1.b6094e92cca28p+5"},
    "sin": {-77.7: "-0x1.7d31cb31f6496p-1", 123456.789: "-0x1.ff50e60ab53f9p-1"},
    "cos": {-77.7: "-0x1.55cf9c92e02cbp-1", 123456.789: "0x1.a74d27c41b22ap-5"},
    "tan": {-2.5: "0x1.7e79b4e00bb14p-1", 1.57: "0x1.39f0ff737e7f3p+10"},
    "sin_of_turns": {-0.7: "0x1.e6f0e134454ffp-1", 12.3: "0x1.e6f0e134454f3p-1"},
    "atan": {2.0: "0x1.1b6e192ebbe44p+0", 57.3: "0x1.8da816e576fd0p+0"},
}
POWER_BITS = {
    (2.0, 0.5): "0x1.6a09e667f3bccp+0",
    (10.0, -3.0): "0x1.0624dd2f1a9f9p-10",
    (0.3, 1.7): "0x1.08819f76d9f8dp-3",
}
"""Values at arguments, as any machine must give them."""


@of_each
def test_known_bits(function):
    known = BITS[function.__name__]
    assert {x: float(function(x)).hex() for x in known} == known


def test_known_bits_of_powers():
    assert {pair: float(power(*pair)).hex() for pair in POWER_BITS} == POWER_BITS
