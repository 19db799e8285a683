"""Rounding of what enters a time step."""

import math

import numpy as np
import pytest

from damage.rounded import ACCELERATION, BITS, DISPLACEMENT, down_to_three_digits, to_bits, to_grid

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
        """Of 4000 values that are off by a few last bits none is rounded another way."""
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

    def test_halves_go_to_the_even_one(self):
        one = 2.0**-25  # between neighbours from 1 to 2
        assert to_bits(np.array([1 + one / 2, 1 + 3 * one / 2, 2 - one / 2])).tolist() == [
            1.0,
            1 + 2 * one,
            2.0,
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
