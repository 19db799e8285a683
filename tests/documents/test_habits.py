"""The gate of habits finds what it is there for."""

import pytest

from scripts import habits


@pytest.mark.parametrize(
    "text, found",
    [
        ("LEAST, MOST = 1, 2", [(1, "parallel assignment")]),
        ("low, high = high, low\nfirst, last = ends()", []),
        ('def width():\n    """Of a wall [m]."""', [(2, "docstring without a subject")]),
        ('"""Width of a wall [m]."""', []),
    ],
)
def test_a_seeded_habit_is_found(text, found):
    assert habits.places(text) == found
