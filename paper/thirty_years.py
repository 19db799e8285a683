"""Tables of docs/paper/thirty-years.md, from the tables of its studies.

python3 -m paper thirty_years [FOLDER]            # walls: FOLDER has life.csv and lives.csv of
                                                  # python3 -m damage lives results/lives_walls;
                                                  # by default docs/tables/lives_walls
python3 -m paper thirty_years --events SHOCKS.csv # equal events: results/repetitions/tables/
                                                  # shocks.csv of the study repetitions
"""

from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from damage.applications.groningen.life.estimate import Z95
from damage.errors import InputError
from paper.bench import REPOSITORY, arguments, option, show

LIVES = REPOSITORY / "docs" / "tables" / "lives_walls"
WALLS = {
    "symmetric, softening": "soft_lintel2",
    "symmetric, brittle": "symmetric_brittle",
    "asymmetric, softening": "asymmetric_soft",
    "asymmetric, brittle": "asymmetric_brittle",
    "solid, softening": "solid_soft",
    "solid, brittle": "solid_brittle",
}
"""{words: prefix of the points in studies/lives_walls.toml}"""
GROUND = {"at rest": "", "settled": "_settled"}
"""{the ground before the first earthquake: ending of the points}"""
ADDRESSES = "garsthuizen", "loppersum", "delfzijl"
SHAKEN = ADDRESSES[:2]
PUBLISHED = {2: "1.01 to 1.03", 8: "1.03 to 1.08"}
"""{number of equal events: medians by class of Psi before (P. A. Korswagen, dissertation, TU Delft,
2024)}"""


def read_lives(folder):
    """Reads life.csv at the last year, a row a point, and lives.csv."""
    tables = [folder / "life.csv", folder / "lives.csv"]
    if not all(path.is_file() for path in tables):
        raise InputError(
            f"{folder} holds no life.csv and lives.csv: expected the tables of python3 -m damage"
            " lives results/lives_walls"
        )
    life, lives = (pd.read_csv(path, comment="#") for path in tables)
    return life[life["year"] == life["year"].max()].set_index("point"), lives


def walls_table(folder):
    """Makes the table of walls: Psi before and at the end, P(Psi >= 1) and what other events than
    the largest add to it, in per cent with 95 % intervals."""
    final, lives = read_lives(folder)
    before = lives[lives["event"] == 0].groupby("point")["psi"].median()
    rows = []
    for (wall, prefix), (ground, ending) in product(WALLS.items(), GROUND.items()):
        points = {name: f"{prefix}_{name}{ending}" for name in ADDRESSES}
        first = points[ADDRESSES[0]]
        row = {
            "wall": wall,
            "ground before": ground,
            "Psi before": f"{before.get(first, 0.0):.2f}",
            "Psi at the end, Garsthuizen": f"{final.loc[first, 'median_psi']:.2f}",
        }
        for name in ADDRESSES:
            row[f"{name.capitalize()} [%]"] = share(final.loc[points[name]], "p_psi_1")
        for name in SHAKEN:
            row[f"other events, {name.capitalize()}"] = added_by_others(lives, points[name])
        for name in SHAKEN:
            row[f"any moment, {name.capitalize()}"] = share(final.loc[points[name]], "p_max_psi_1")
        rows.append(row)
    return pd.DataFrame(rows)


def share(row, column):
    """Writes a probability of a row of life.csv with its interval."""
    return interval(row[column], row[f"{column}_low"], row[f"{column}_high"])


def interval(value, low, high, sign=""):
    """Writes a number and its bounds [-] in per cent.

    >>> interval(0.004, -0.002, 0.21, "+")
    '0 (0 to +21)'
    """
    words = (
        f"{100 * one:{sign}.0f}".replace("-0", "0").replace("+0", "0") for one in (value, low, high)
    )
    return "{} ({} to {})".format(*words)


def added_by_others(lives, point):
    """Writes the share of lives that end with Psi >= 1 by other events than the largest, from the
    same lives with the largest alone; empty where these have not been run."""
    ends = [
        (rows["psi"] >= 1.0) | rows["fell"]
        for rows in (
            lives[lives["point"] == name].groupby(["seed", "life"]).last()
            for name in (point, f"{point}_largest")
        )
    ]
    if ends[1].empty:
        return ""
    difference = ends[0].astype(float) - ends[1].astype(float)
    mean = difference.mean()
    half = Z95 * difference.std() / np.sqrt(len(difference))
    return interval(mean, mean - half, mean + half, "+")


def events_table(shocks):
    """Makes the table of Psi after N equal events over that of one, of the runs in which one event
    leaves Psi > 0; max_psi: the largest so far.

    >>> rows = [("a", 1, 0.5), ("a", 2, 0.6), ("b", 1, 0.0), ("b", 2, 0.7), ("c", 1, 1.0)]
    >>> shocks = pd.DataFrame(rows, columns=["run", "shock", "residual_psi"])
    >>> events_table(shocks.assign(max_psi=shocks["residual_psi"]))["median"].tolist()
    [1.2, 1.2]
    """
    rows = []
    for column, words in (("residual_psi", "at rest"), ("max_psi", "largest so far")):
        psi = shocks.pivot_table(index="run", columns="shock", values=column)
        if column == "max_psi":
            psi = psi.cummax(axis=1, skipna=False)
        for count in sorted(PUBLISHED.keys() & set(psi.columns)):
            pairs = psi.loc[psi[1] > 0, [1, count]].dropna()
            ratio = pairs[count] / pairs[1]
            rows.append(
                {
                    "events": count,
                    "Psi": words,
                    "pairs": len(ratio),
                    "median": float(f"{ratio.median():.3g}"),
                    "90th percentile": float(f"{ratio.quantile(0.9):.3g}"),
                    "share that decreases": float(f"{(ratio < 1).mean():.3g}"),
                    "published medians": PUBLISHED[count],
                }
            )
    return pd.DataFrame(rows)


def main():
    asked = arguments(
        __doc__,
        option("folder", nargs="?", type=Path, default=LIVES),
        option("--events", type=Path, metavar="SHOCKS.csv"),
    )
    if asked.events:
        table = events_table(pd.read_csv(asked.events))
    else:
        table = walls_table(asked.folder)
    show(table, table.itertuples(index=False))
