"""Numbers of docs/validation/two-solvers.md that no table holds.

    python3 -m paper results_figures RESULTS

How far YADE's points of crosscheck lie from the medians of harmonic and ida; RESULTS holds the
studies' folders.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from damage.errors import InputError
from paper.bench import arguments, option

COMPARED = (
    "max_drift_ratio",
    "max_DI",
    "max_shear_limit_DI",
    "residual_DI",
    "residual_shear_limit_DI",
)


def main():
    """Print the largest and the median difference over the points with the elastic lintel."""
    results = arguments(__doc__, option("results", type=Path)).results
    if not results.is_dir():
        raise InputError(
            f"{results}: expected the folder with the results of studies; run them with"
            " ./run_all.sh"
        )

    def points(study):
        table = pd.read_csv(
            results / study / "tables/points.csv", keep_default_na=False, na_values=[""]
        )
        return table[table["lintel"] == "elastic"].set_index("point")

    reference = pd.concat([points("harmonic"), points("ida")])
    both = points("crosscheck").join(reference[list(COMPARED)], rsuffix="_reference", how="inner")
    print(f"YADE against the reference solver's medians, {len(both)} points")
    for name in COMPARED:
        off = (both[name] - both[f"{name}_reference"]).abs()
        share = (off / both[f"{name}_reference"]).max() if name == "max_drift_ratio" else np.nan
        print(
            f"  {name:24s} at most {off.max():.4f} ({off.idxmax()}), median {off.median():.5f}"
            + (f", at most {100 * share:.1f} %" if np.isfinite(share) else "")
        )
