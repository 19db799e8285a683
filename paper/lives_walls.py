"""Visible damage after thirty years, wall by wall, with and without damage before, in one table.

    python3 -m paper lives_walls results/lives_walls/figures

Takes the tables of `python3 -m damage lives results/lives_walls`.  A row is a wall, its joints and
the ground before the first earthquake; cells are P(Psi >= 1) with 95 % intervals in per cent.
"""

from itertools import product
from pathlib import Path

import pandas as pd

from damage.errors import InputError
from paper.bench import arguments, option, show

WALLS = {
    "symmetric, softening": "soft_lintel2",
    "symmetric, brittle": "symmetric_brittle",
    "asymmetric, softening": "asymmetric_soft",
    "asymmetric, brittle": "asymmetric_brittle",
    "solid, softening": "solid_soft",
    "solid, brittle": "solid_brittle",
}
"""{words: prefix of the points in studies/lives_walls.toml}"""
BEFORE = {"at rest": "", "settled": "_settled"}
ADDRESSES = "garsthuizen", "loppersum", "delfzijl"
SHAKEN = ADDRESSES[:2]  # where the largest event alone has been computed, too


def interval(p, low, high, signed=""):
    """Text of a probability and its bounds [-] in per cent."""
    p, low, high = (
        f"{100 * value:{signed}.0f}".replace("-0", "0").replace("+0", "0")
        for value in (p, low, high)
    )
    return f"{p} ({low} to {high})"


def row(prefix, suffix, final, settled, choices):
    """Cells of a wall: median Psi before and at the end, P at rest by address, what others than the
    largest event add, P at any moment."""

    def at(address, name):
        of = final.loc[f"{prefix}_{address}{suffix}"]
        return interval(*(of[f"p_{name}_1{end}"] for end in ("", "_low", "_high")))

    def others(address):
        point = f"{prefix}_{address}{suffix}"
        if (point, f"{point}_largest") not in choices.index:
            return ""  # the largest event alone has not been computed
        of = choices.loc[point, f"{point}_largest"]
        return interval(
            -of["change_p_psi_1"], -of["change_p_psi_1_high"], -of["change_p_psi_1_low"], "+"
        )

    first = f"{prefix}_{ADDRESSES[0]}{suffix}"
    yield from (
        f"{value:.2f}" for value in (settled.get(first, 0.0), final.loc[first, "median_psi"])
    )
    yield from (at(address, "psi") for address in ADDRESSES)
    yield from map(others, SHAKEN)
    yield from (at(address, "max_psi") for address in SHAKEN)


def main():
    folder = arguments(__doc__, option("figures", type=Path)).figures
    if not (folder / "life.csv").is_file():
        raise InputError(
            f"{folder} holds no life.csv: expected the tables of python3 -m damage lives "
            "results/lives_walls"
        )
    life, lives, choices = (
        pd.read_csv(folder / f"{name}.csv", comment="#") for name in ("life", "lives", "choices")
    )
    final = life[life["year"] == life["year"].max()].set_index("point")
    settled = lives[lives["event"] == 0].groupby("point")["psi"].median()
    choices = choices.set_index(["point", "other"])
    names = [
        "wall",
        "ground before",
        "Psi before",
        f"Psi at the end, {ADDRESSES[0].capitalize()}",
        *(f"{one.capitalize()} [%]" for one in ADDRESSES),
        *(f"other events, {one.capitalize()}" for one in SHAKEN),
        *(f"any moment, {one.capitalize()}" for one in SHAKEN),
    ]
    show(
        names,
        (
            (wall, ground, *row(prefix, suffix, final, settled, choices))
            for (wall, prefix), (ground, suffix) in product(WALLS.items(), BEFORE.items())
        ),
    )
