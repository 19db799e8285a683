"""Eight numbers as one value: what the compiler makes of it is what each number by itself gives, to the last bit."""

import os
import subprocess
import sys

import numpy as np
from conftest import REPOSITORY
from numba import njit

from damage.reference.blocks import INDEX
from damage.reference.eight import add, bits, collect, either, flags_of, load, spread, store

ZERO, ONE, EIGHT, NINE = INDEX(0), INDEX(1), INDEX(8), INDEX(9)
AS_ARRAYS = """
import numpy as np
import test_eight as t

numbers, out = np.arange(20.0) - 9.5, np.zeros(16)
flags, expected = t.arithmetic(numbers, out), t.one_by_one(numbers)
assert out.tobytes() == expected[0].tobytes() and flags == expected[1]
t.gathering(np.arange(20.0), t.PLACES, 0b10010110, out)
assert list(out) == [4, 1, 13, 6, 6, 2, 10, 3, 0, 1.5, 1.5, 0, 1.5, 0, 0, 1.5]
"""
PLACES = np.array([3, 0, 12, 5, 5, 1, 9, 2], INDEX)


def arithmetic(numbers, out):
    x, y = load(numbers, ZERO), load(numbers, NINE)
    store(out, ZERO, either((abs(x) < y) | (x == 0.0), 0.5 * x + y * x, -(y - 1.0) / 3.0))
    store(out, EIGHT, either(x >= y, spread(2.0), 7.0))
    add(out, EIGHT, x)
    return bits((x > y) & (y <= 0.5))


def gathering(numbers, places, flags, out):
    store(out, ZERO, collect(numbers, places, ZERO, ONE))
    store(out, EIGHT, either(flags_of(flags), 1.5, 0.0))


def one_by_one(numbers):
    """What `arithmetic` writes and returns, number by number."""
    x, y = numbers[:8], numbers[9:17]
    first = [0.5 * a + b * a if abs(a) < b or a == 0.0 else -(b - 1.0) / 3.0 for a, b in zip(x, y)]
    second = [(2.0 if a >= b else 7.0) + a for a, b in zip(x, y)]
    return np.array(first + second), sum(1 << k for k, (a, b) in enumerate(zip(x, y)) if a > b and b <= 0.5)


def test_arithmetic_is_that_of_each_number():
    numbers = np.random.default_rng(1).normal(0, 1, 20) * np.geomspace(1e-8, 1e8, 20)
    numbers[2], numbers[3], numbers[12] = 0.0, -0.0, 1e300
    out, expected = np.zeros(16), one_by_one(numbers)
    flags = njit(error_model="numpy")(arithmetic)(numbers, out)
    assert out.tobytes() == expected[0].tobytes()
    assert flags == expected[1]


def test_numbers_come_from_where_they_are_wanted():
    numbers, out = np.arange(20.0), np.zeros(16)
    njit(error_model="numpy")(gathering)(numbers, PLACES, 0b10010110, out)
    assert list(out[:8]) == [4, 1, 13, 6, 6, 2, 10, 3]
    assert list(out[8:] > 0) == [False, True, True, False, True, False, False, True]


def test_without_the_compiler_it_is_an_array():
    """As where numba is switched off, whose indices are signed ones."""
    done = subprocess.run([sys.executable, "-c", AS_ARRAYS], capture_output=True, text=True, cwd=REPOSITORY / "tests",
                          env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(
                              [str(REPOSITORY), os.environ.get("PYTHONPATH", "")])})
    assert done.returncode == 0, done.stderr
