"""Eight numbers as one value: what the compiler makes of it is what each number by itself gives, to the last bit."""

import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import REPOSITORY
from numba import njit

from damage.mechanics.eight import add, bits, either, flags_of, load, spread, store
from damage.reference.fast.blocks import INDEX
from damage.reference.fast.rows import add_rows, rows_of, set_rows

ZERO, FOUR, EIGHT, NINE, WIDER, WIDEST = (INDEX(number) for number in (0, 4, 8, 9, 16, 24))
AS_ARRAYS = """
import numpy as np
import test_eight as t

numbers, out = np.arange(20.0) - 9.5, np.zeros(16)
flags, expected = t.arithmetic(numbers, out), t.one_by_one(numbers)
assert out.tobytes() == expected[0].tobytes() and flags == expected[1]
t.flagged(0b10010110, out)
assert list(out) == t.FLAGGED
rows, out = t.ROWS.copy(), np.zeros(32)
t.turned(rows, t.FIRST, t.SECOND, out)
expected = t.turned_one_by_one()
assert out.tobytes() == expected[0].tobytes() and rows.tobytes() == expected[1].tobytes()
"""
FLAGGED = 8 * [0] + [0, 1.5, 1.5, 0, 1.5, 0, 0, 1.5]
# Where rows of eight begin: some are asked for twice, and by both.
FIRST, SECOND = (np.array(rows, INDEX) * EIGHT for rows in ([3, 0, 12, 5, 5, 1, 9, 2], [16, 3, 2, 14, 15, 5, 7, 5]))
ROWS = np.random.default_rng(2).normal(0, 1, 17 * 8) * np.geomspace(1e-8, 1e8, 17 * 8)


def arithmetic(numbers, out):
    x, y = load(numbers, ZERO), load(numbers, NINE)
    store(out, ZERO, either((abs(x) < y) | (x == 0.0), 0.5 * x + y * x, -(y - 1.0) / 3.0))
    store(out, EIGHT, either(x >= y, spread(2.0), 7.0))
    add(out, EIGHT, x)
    return bits((x > y) & (y <= 0.5))


def flagged(flags, out):
    store(out, ZERO, 0.0)
    store(out, EIGHT, either(flags_of(flags), 1.5, 0.0))


def turned(rows, first, second, out):
    a, b, c, d = rows_of(rows, first, ZERO, ZERO)
    for place, value in ((ZERO, a), (EIGHT, b), (WIDER, c), (WIDEST, d)):
        store(out, place, value)
    set_rows(rows, second, ZERO, FOUR, d, c, b, a)
    a, b, c, d = rows_of(rows, first, ZERO, ZERO)
    add_rows(rows, first, second, ZERO, FOUR, (a, b, c), (-b, -c, -d))


def turned_one_by_one():
    """What `turned` makes of nothing and of ROWS, number by number."""
    rows = ROWS.copy().reshape(-1, 8)
    first, second = FIRST.astype(int) // 8, SECOND.astype(int) // 8
    read = rows[first, :4]
    for row, numbers in zip(second, read):
        rows[row, 4:] = numbers[::-1]
    for row, other, (a, b, c, d) in zip(first, second, read):
        rows[row, 4:7] += (a, b, c)
        rows[other, 4:7] -= (b, c, d)
    return read.T.ravel(), rows.ravel()


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


def test_flags_come_from_an_integer():
    out = np.zeros(16)
    njit(error_model="numpy")(flagged)(0b10010110, out)
    assert list(out) == FLAGGED


def test_rows_are_turned_into_values_and_back():
    rows, out = ROWS.copy(), np.zeros(32)
    njit(error_model="numpy")(turned)(rows, FIRST, SECOND, out)
    read, expected = turned_one_by_one()
    assert out.tobytes() == read.tobytes()
    assert rows.tobytes() == expected.tobytes()


def test_without_the_compiler_it_is_an_array():
    """As where numba is switched off, whose indices are signed ones."""
    done = subprocess.run([sys.executable, "-c", AS_ARRAYS], capture_output=True, text=True, cwd=REPOSITORY / "tests",
                          env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(
                              [str(REPOSITORY), os.environ.get("PYTHONPATH", "")])})
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(os.environ.get("NUMBA_CPU_NAME") == "generic", reason="is itself what this test starts")
def test_a_value_of_four_numbers_does_the_same():
    """Where a register of the processor holds no eight numbers."""
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", __file__],
                          capture_output=True, text=True, env={**os.environ, "NUMBA_CPU_NAME": "generic"})
    assert done.returncode == 0, done.stdout
