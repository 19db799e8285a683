"""Three readings of one published fragility over thirty years at three addresses, to lay beside
walls that were computed.

    python3 -m paper accumulation | python3 scripts/document_tables.py benchmarks/accumulation.csv

P. A. Korswagen (dissertation, TU Delft, 2024) gives for one event the PGV at which a wall of damage
Psi_0 reaches Psi_f: median and logarithmic standard deviation.  How damage accumulates over many
events is open:

    "each event": every event draws anew whether it damages the wall further
    "each wall": a wall draws once how weak it is, and keeps this in all events
    "largest alone": the largest event acts on the wall as it was before, and no other does
"""

from itertools import product

import numpy as np
from scipy.stats import norm

from damage.applications.groningen.exposure.lives import read_address
from damage.errors import InputError
from paper.bench import REPOSITORY, arguments, option, print_row, print_table

ADDRESSES = "garsthuizen", "loppersum", "delfzijl"
BEFORE = 0.0, 0.5, 1.0
"""Psi before the first event: of an intact wall, and published classes near those of walls that
settled."""
READINGS = "each event", "each wall", "largest alone"
PUBLISHED = {
    0.0: {
        0.5: (2.604, 0.624),
        1.0: (3.370, 0.725),
        1.5: (4.323, 0.860),
        2.0: (5.518, 1.082),
        2.5: (7.416, 1.516),
        3.0: (8.869, 1.729),
    },
    0.5: {
        1.0: (3.002, 0.931),
        1.5: (4.070, 0.983),
        2.0: (5.523, 1.259),
        2.5: (7.758, 1.780),
        3.0: (11.287, 2.606),
    },
    1.0: {1.5: (3.411, 1.034), 2.0: (5.293, 1.444), 2.5: (7.955, 2.091), 3.0: (11.913, 3.034)},
    1.5: {2.0: (4.631, 1.860), 2.5: (7.929, 2.585), 3.0: (12.363, 3.610)},
}
"""{Psi_0: {Psi_f: (mean of ln PGV [mm/s], standard deviation)}}; from Psi_0 = 2 on nothing is
known."""
NEGLIGIBLE_MM_S = 0.1
"""PGV below which an event is left out: the smallest median of the table is 13.5 mm/s."""


def main():
    lives = arguments(__doc__, option("--lives", type=int, default=2000)).lives
    print_table(
        "address",
        "Psi before",
        *(f"{name}, Psi >= {level}" for level in (1, 2) for name in READINGS),
    )
    for address, before in product(ADDRESSES, BEFORE):
        draws = read_address(REPOSITORY / "studies" / "addresses" / f"{address}.toml")
        found = final_psi(draws, range(1, lives + 1), before=before)
        print_row(
            address,
            f"{before:g}",
            *(f"{np.mean(found[name] >= level):.3f}" for level in (1, 2) for name in READINGS),
        )


def final_psi(draws, numbers, seed=0, before=0.0):
    """{reading: final Psi (n,)} of lives by their numbers.

    draws: a damage.applications.groningen.exposure.lives.Draws; seed: of the readings; before: Psi
    before the first event, of PUBLISHED. Raises InputError where nothing is published for it.
    """
    if before not in PUBLISHED:
        raise InputError(
            f"Psi before the first event {before:g}: expected one of"
            f" {', '.join(map(str, PUBLISHED))}"
        )
    pgv = np.array([draws.pgv(number)[0] for number in numbers])
    pgv = pgv[:, pgv.max(axis=0) >= NEGLIGIBLE_MM_S]
    rng = np.random.default_rng(seed)
    wall = rng.random(len(pgv))
    first = np.full(len(pgv), before)
    found = dict.fromkeys(READINGS[:2], first)
    for event in pgv.T:
        for name, share in zip(READINGS, (rng.random(len(pgv)), wall)):
            found[name] = after(found[name], event, share)
    return found | {READINGS[2]: after(first, pgv.max(axis=1), wall)}


def after(psi, pgv_mm_s, share):
    """Psi (n,) after an event of PGV (n,) [mm/s] on walls of psi (n,): the largest Psi_f whose
    probability exceeds the share (n,)."""
    result = psi.copy()
    for before, row in PUBLISHED.items():
        mine = psi == before
        for target, (mean, deviation) in row.items():
            reached = mine & (norm.cdf((np.log(pgv_mm_s) - mean) / deviation) > share)
            result[reached] = np.maximum(result[reached], target)
    return result
