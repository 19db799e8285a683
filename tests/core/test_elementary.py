"""Elementary functions: their errors against 60 decimal digits; rounding; draws, which are those of
numpy's Generator; and bits that any machine must reproduce."""

import math
from decimal import Decimal, localcontext
from functools import cache

import numpy as np
import pytest

from damage import Wall
from damage.draws import Draws
from damage.elementary import atan, cos, exp, log, power, sin, sin_of_turns, tan
from damage.rounded import ACCELERATION, BITS, DISPLACEMENT, down_to_three_digits, to_bits, to_grid
from damage.wall.contact_points import scattered
from damage.wall.layout import lay_out

DIGITS = 60
LARGEST = 1e6
"""Up to which sines are used [rad]."""


@cache
def pi():
    """By Machin's formula: 16 atan(1/5) - 4 atan(1/239)."""
    return 16 * _series(Decimal(1) / 5, -1) - 4 * _series(Decimal(1) / 239, -1)


def _series(x, sign):
    """x + sign x^3 / 3 + x^5 / 5 + ..."""
    total = Decimal(0)
    term = x
    k = 1
    while abs(term) > abs(x) * Decimal(10) ** -DIGITS:
        total += term / k
        term = term * x * x * sign
        k = k + 2
    return total


def _sine(x):
    """Sine of a small x by its Taylor series."""
    total = Decimal(0)
    term = x
    k = 1
    while abs(term) > abs(x) * Decimal(10) ** -DIGITS:
        total += term
        term = -term * x * x / ((k + 1) * (k + 2))
        k = k + 2
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
    base = 10.0 ** RANDOM.uniform(-20, 20, 1000)
    exponent = RANDOM.uniform(-10, 10, 1000)
    with localcontext() as context:
        context.prec = DIGITS
        for x, y, value in zip(base.tolist(), exponent.tolist(), power(base, exponent)):
            log_of = Decimal(y) * Decimal(x).ln()
            true = log_of.exp()
            assert abs(Decimal(float(value)) - true) < true * Decimal("1e-15") * (1 + abs(log_of))


@of_each
def test_numbers_arrays_and_parts_of_arrays_give_equal_bits(function):
    """Every fifth point; parts begin at another place and lie apart, by which libraries choose
    instructions."""
    _, points, _ = FUNCTIONS[function]
    whole = function(points)
    assert np.array_equal(whole[::5], [function(x) for x in points[::5].tolist()])
    assert np.array_equal(whole[::5], [function(x) for x in points[::5]])
    assert np.array_equal(whole[3::2], function(points[3::2]))
    assert np.array_equal(whole[1:], function(points[1:]))


KNOWN_BITS = {
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
    known = KNOWN_BITS[function.__name__]
    assert {x: float(function(x)).hex() for x in known} == known


def test_known_bits_of_powers():
    assert {pair: float(power(*pair)).hex() for pair in POWER_BITS} == POWER_BITS


# --- rounding of what enters a time step ----------------------------------------------------------

VALUES = np.concatenate(
    [sign * 10.0 ** np.random.RandomState(1).uniform(-30, 30, 2000) for sign in (1, -1)]
)


class TestToBits:
    def test_half_a_unit_of_26_bits_is_lost_at_most(self):
        """2**-27 of the power of two above, so 2**-26 of a value just over a power of two."""
        lost = np.abs(to_bits(VALUES) - VALUES)
        assert (lost <= 2.0**-27 * 2.0 ** np.frexp(VALUES)[1]).all() and (
            lost <= 2.0**-26 * np.abs(VALUES)
        ).all()
        assert lost.max() > 0

    def test_what_comes_has_26_bits_and_stays(self):
        rounded = to_bits(VALUES)
        part = np.frexp(rounded)[0] * 2.0**BITS
        assert np.array_equal(part, np.rint(part)) and np.array_equal(to_bits(rounded), rounded)

    def test_errors_of_libraries_vanish(self):
        """None of 4000 values that are off by a few last bits is rounded another way."""
        for towards in (-np.inf, np.inf):
            assert np.array_equal(
                to_bits(np.nextafter(np.nextafter(VALUES, towards), towards)), to_bits(VALUES)
            )

    @pytest.mark.parametrize(
        "value", [0.0, 1.0, -0.375, 9.75, 1800.0, 2.0**-1000, 2.0**26 - 1, math.inf, -math.inf]
    )
    def test_few_bits_and_infinity_stay(self, value):
        assert to_bits(value) == value and to_bits(np.array([value, value])).tolist() == [
            value,
            value,
        ]


class TestToGrid:
    @pytest.mark.parametrize("step", [ACCELERATION, DISPLACEMENT])
    def test_multiples_of_the_step_within_half_of_it(self, step):
        values = np.random.RandomState(2).uniform(-10, 10, 1000)
        rounded = to_grid(values, step)
        assert (
            np.array_equal(rounded / step, np.rint(values / step))
            and np.abs(rounded - values).max() <= step / 2
        )
        assert np.array_equal(to_grid(rounded, step), rounded)
        assert to_grid(float(values[0]), step) == rounded[0] and to_grid(
            [values[0]], step
        ).shape == (1,)


class TestThreeDigits:
    @pytest.mark.parametrize(
        "value, expected",
        [
            (4.7159e-05, 4.71e-05),
            (1e-4, 1e-4),
            (9.99e-5, 9.99e-5),
            (9.999e-5, 9.99e-5),
            (0.3 - 1e-15, 0.3),
            (0.3, 0.3),
            (1.0049, 1.0),
            (123456.0, 123000.0),
            (2.0e-5 * (1 - 1e-8), 2.0e-5),
        ],
    )
    def test_down_but_for_a_millionth(self, value, expected):
        assert down_to_three_digits(value) == expected and isinstance(
            down_to_three_digits(value), float
        )

    def test_never_more_and_not_much_less(self):
        for value in 10.0 ** np.random.RandomState(3).uniform(-9, 2, 500):
            rounded = down_to_three_digits(value)
            assert (
                0.99 * value < rounded <= value * (1 + 2.0**-20)
                and float(f"{rounded:.2e}") == rounded
            )


# --- draws ----------------------------------------------------------------------------------------

EDGE = 3.654152885361009
"""Where the ziggurat's tail begins."""
SEEDS = [0, 1, 2**31, [7, 12], [0, 4000, 1]]


@pytest.mark.parametrize("seed", SEEDS, ids=str)
def test_they_are_those_of_numpy_in_any_order(seed):
    """As numpy 1.17 to 2.4 has them; a later numpy may change its own, and then leaves this test,
    not the draws."""
    ours = Draws(seed)
    theirs = np.random.default_rng(seed)
    for n in (1, 0, 2, 3, 501, 6000):
        assert ours.normal(n) == pytest.approx(theirs.standard_normal(n), abs=1e-12)
        assert np.array_equal(ours.uniform(n), theirs.random(n))
        assert np.array_equal(2.0 * ours.below(2, n) - 1.0, theirs.choice([-1.0, 1.0], n))
        for number in (1, 2, 3, 10, 1000, 3 * 2**30, 2**32 - 1, 2**32):
            assert np.array_equal(ours.below(number, n), theirs.integers(0, number, n))


def test_known_bits_of_the_wedges_and_the_tail():
    """Numbers that a density, or logarithms, decided on."""
    drawn = Draws(0).normal(20_000)
    far = np.flatnonzero(np.abs(drawn) > EDGE)
    assert {int(k): float(drawn[k]).hex() for k in far} == {
        303: "-0x1.e2d9e98d87bc6p+1",
        478: "-0x1.f3204051f2938p+1",
        10477: "0x1.f907c5aa2ff63p+1",
        13325: "-0x1.f5ad782db91bdp+1",
        14920: "-0x1.017b6e68781fcp+2",
        17077: "0x1.e94b36300e4f5p+1",
    }
    assert float(np.cumsum(drawn)[-1]).hex() == "0x1.7683dbfbb090ap+6"


def test_scattered_strengths_have_known_bits(monkeypatch):
    """Also where np.unique gives places as a column, as numpy 2.0 does."""
    contacts = lay_out(Wall("small", 0.9, 0.45)).contacts
    strength = scattered(contacts, (0.3, 7)).tensile_strength
    assert [float(one).hex() for one in strength[:4]] == [
        "0x1.890015dd8cf2bp+17",
        "0x1.890015dd8cf2bp+17",
        "0x1.890015dd8cf2bp+17",
        "0x1.890015dd8cf2bp+17",
    ]
    unique = np.unique

    def in_a_column(*given, **options):
        found, place = unique(*given, **options)
        return found, place.reshape(-1, 1)

    monkeypatch.setattr(np, "unique", in_a_column)
    assert np.array_equal(scattered(contacts, (0.3, 7)).tensile_strength, strength)
