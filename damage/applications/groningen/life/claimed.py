"""When lives first reach a level of damage, and what an insurance that pays event by event sees of
it.

Such an insurance pays where one event adds at least the deductible.  Damage that many events add
in small steps reaches the same level, and no event adds enough.
"""

from itertools import product

import numpy as np
import pandas as pd

from damage.applications.groningen.exposure.columns import TABLES
from damage.applications.groningen.life.estimate import probability

DEDUCTIBLES = 0.0, 0.25, 0.5, 1.0
"""Psi that an event has to add."""
VISIBLE = 1.0, 2.0
"""Psi that is reached."""


def claimed(lives):
    """How `damage.applications.groningen.life.results.Lives` first reach each of VISIBLE: a row
    of claimed.csv a level and deductible.

    A wall that falls reaches every level.
    """
    keys, rows, population = ["seed", "life"], [], lives.population()
    table = lives.table.assign(psi=lives.table["psi"].where(~lives.table["fell"], np.inf))
    table["gain"] = table["psi"] - table.groupby(keys)["psi"].shift(fill_value=0.0)
    largest = table.groupby(keys)["largest_mm_s"].first()
    for level, deductible in product(VISIBLE, DEDUCTIBLES):
        first = table[table["psi"] >= level].groupby(keys).first().reindex(largest.index)
        shaken = first["event"] > 0
        hits = {
            "p": first["psi"].notna(),
            "p_settled": first["event"] == 0,
            "p_largest": shaken & np.isclose(first["pgv_mm_s"], largest),
            "p_claim": shaken & (first["gain"] >= deductible),
        }
        row = {
            "point": lives.point,
            "psi": level,
            "deductible_psi": deductible,
            "lives": len(largest),
        }
        for name, of in hits.items():
            found = probability(of, largest, population)
            row |= zip((name, f"{name}_low", f"{name}_high"), (found.p, *found.interval))
        rows.append(row)
    return pd.DataFrame(rows)[list(TABLES["claimed.csv"])]
