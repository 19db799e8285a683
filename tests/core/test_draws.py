"""Draws: those of numpy's Generator, by the same seeds, and bits that any machine must
reproduce."""

import numpy as np
import pytest

from damage import Wall
from damage.draws import Draws
from damage.wall.contact_points import scattered
from damage.wall.layout import lay_out

EDGE = 3.654152885361009
"""Where the ziggurat's tail begins."""
SEEDS = [0, 1, 2**31, [7, 12], [0, 4000, 1]]


@pytest.mark.parametrize("seed", SEEDS, ids=str)
def test_they_are_those_of_numpy_in_any_order(seed):
    """As numpy 1.17 to 2.4 has them; a later numpy may change its own, and then leaves this test,
    not the draws."""
    ours, theirs = Draws(seed), np.random.default_rng(seed)
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


def test_parts_are_the_whole():
    whole, parts = Draws(5), Draws(5)
    assert np.array_equal(
        whole.normal(9000), np.concatenate([parts.normal(n) for n in (1, 2, 97, 900, 8000)])
    )
    assert np.array_equal(
        whole.below(5, 100), np.concatenate([parts.below(5, n) for n in (1, 2, 0, 97)])
    )
    assert np.array_equal(whole.uniform(10), parts.uniform(10))


def test_scattered_strengths_have_known_bits(monkeypatch):
    """Also where np.unique gives places as a column, as numpy 2.0 does."""
    wall = Wall("small", 0.9, 0.45)
    contacts = lay_out(wall).contacts
    strength = scattered(wall, contacts, (0.3, 7)).tensile_strength
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
    assert np.array_equal(scattered(wall, contacts, (0.3, 7)).tensile_strength, strength)
