"""Numbers of docs/paper/results.md and docs/validation/laboratory.md that no table holds.

    python3 paper/results_figures.py RESULTS

How far YADE's points of crosscheck lie from the medians of harmonic and ida; how far bricks are really offset after
each shock of a sequence, beside what slip counts; the force that YADE's sliding base loses for every millimetre.
RESULTS holds the studies' folders; what is not there is passed over.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.history.reader import read_history
from damage.index import THRESHOLD, length_fraction
from damage.wall.file import load_wall
from damage.wall.kinematics import ContactKinematics
from damage.wall.layout import lay_out

COMPARED = ("max_drift_ratio", "max_DI", "max_shear_limit_DI", "residual_DI", "residual_shear_limit_DI")


def two_codes(results):
    """Print the largest and the median difference over the points with the elastic lintel."""
    def points(study):
        table = pd.read_csv(results / study / "tables/points.csv", keep_default_na=False, na_values=[""])
        return table[table["lintel"] == "elastic"].set_index("point")

    reference = pd.concat([points("harmonic"), points("ida")])
    both = points("crosscheck").join(reference[list(COMPARED)], rsuffix="_reference", how="inner")
    print(f"YADE against the reference solver's medians, {len(both)} points")
    for name in COMPARED:
        off = (both[name] - both[f"{name}_reference"]).abs()
        share = (off / both[f"{name}_reference"]).max() if name == "max_drift_ratio" else np.nan
        print(f"  {name:24s} at most {off.max():.4f} ({off.idxmax()}), median {off.median():.5f}"
              + (f", at most {100 * share:.1f} %" if np.isfinite(share) else ""))


def offsets(path):
    """Print shock by shock the largest offset of two bricks along a broken joint, and the length offset or slipped."""
    history = read_history(path)
    layout = lay_out(load_wall(ROOT / "walls" / f"{history.wall}.py"))
    kinematics, n = ContactKinematics(layout), layout.n_joints
    length, time_s = history.joints["length_m"].to_numpy(), history.series["time_s"].to_numpy()
    print(path.stem)
    for shock, series in history.series.groupby("shock"):
        snapshot = np.argmin(np.abs(history.snapshot_time_s - series["time_s"].iloc[-1]))
        sample = np.argmin(np.abs(time_s - history.snapshot_time_s[snapshot]))
        shear = np.abs(kinematics.displacements(history.displacement[snapshot])[1][:n]) * history.broken[sample]
        off, slipped = (100 * length_fraction(values > THRESHOLD, length)
                        for values in (shear, np.abs(history.slip_m[sample])))
        print(f"  shock {shock}: offset up to {1e3 * shear.max():.2f} mm, over 0.1 mm on {off:.1f} % of the length; "
              f"slip counts {slipped:.1f} %")


def sliding(path, z_m=0.0):
    """Print the line through the top force [kN] of all samples in which the bed joint at z_m slides forward."""
    history = read_history(path)
    bed = (history.joints["kind"] == "bed") & (np.abs(history.joints["z_m"] - z_m) < 1e-3)
    slip_mm = 1e3 * np.average(history.slip_m[:, bed], weights=history.joints["length_m"][bed], axis=1)
    force_kn = history.series["top_force_n"].to_numpy() / 1e3
    slides = (np.gradient(slip_mm) > 2e-3) & (np.abs(force_kn) > 20)
    slope, start = np.polyfit(slip_mm[slides], force_kn[slides], 1)
    print(f"{path.stem}\n  sliding at {z_m:g} m: {start:.1f} kN {slope:+.2f} kN/mm, {slides.sum()} samples")


def main():
    """Print what the results allow."""
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        sys.exit("error: expected one folder with the results of studies; run them with ./run_all.sh")
    results = Path(sys.argv[1])
    if all((results / study / "tables/points.csv").is_file() for study in ("crosscheck", "harmonic", "ida")):
        two_codes(results)
    for path in sorted(results.glob("sequence/runs/*sequence-1-1-1-1-1-1*_s1.h5")):
        offsets(path)
    for path in sorted(results.glob("validation/runs/squat_tested_cyclic*_yade.h5")):
        sliding(path)


if __name__ == "__main__":
    main()
