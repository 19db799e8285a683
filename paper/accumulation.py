"""Three readings of a published fragility over thirty years at three addresses (`damage.life.readings`).

    python3 paper/accumulation.py | python3 scripts/document_tables.py benchmarks/accumulation.csv
"""

import argparse
import sys
from itertools import product
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from damage.exposure.lives import read_address
from damage.life.readings import READINGS, final_psi

ADDRESSES = "garsthuizen", "loppersum", "delfzijl"
BEFORE = 0.0, 0.5, 1.0
"""Psi before the first event: of an intact wall, and published classes near those of walls that settled."""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lives", type=int, default=2000)
    lives = parser.parse_args().lives
    levels = [f"{name}, Psi >= {level}" for level in (1, 2) for name in READINGS]
    print("| address | Psi before | " + " | ".join(levels) + " |\n|" + " --- |" * (len(levels) + 2))
    for address, before in product(ADDRESSES, BEFORE):
        draws = read_address(REPOSITORY / "studies" / "addresses" / f"{address}.toml")
        found = final_psi(draws, range(1, lives + 1), before=before)
        shares = [np.mean(found[name] >= level) for level in (1, 2) for name in READINGS]
        print(f"| {address} | {before:g} | " + " | ".join(f"{share:.3f}" for share in shares) + " |")


if __name__ == "__main__":
    main()
