"""Three readings of a published fragility over thirty years at three addresses (`damage.life.readings`).

    python3 -m paper accumulation | python3 scripts/document_tables.py benchmarks/accumulation.csv
"""

from itertools import product

import numpy as np

from damage.exposure.lives import read_address
from damage.life.readings import READINGS, final_psi
from paper.bench import REPOSITORY, arguments, option, print_row, print_table

ADDRESSES = "garsthuizen", "loppersum", "delfzijl"
BEFORE = 0.0, 0.5, 1.0
"""Psi before the first event: of an intact wall, and published classes near those of walls that settled."""


def main():
    lives = arguments(__doc__, option("--lives", type=int, default=2000)).lives
    print_table("address", "Psi before", *(f"{name}, Psi >= {level}" for level in (1, 2) for name in READINGS))
    for address, before in product(ADDRESSES, BEFORE):
        draws = read_address(REPOSITORY / "studies" / "addresses" / f"{address}.toml")
        found = final_psi(draws, range(1, lives + 1), before=before)
        print_row(address, f"{before:g}",
                  *(f"{np.mean(found[name] >= level):.3f}" for level in (1, 2) for name in READINGS))
