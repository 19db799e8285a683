"""Fragility curves for other tools: NRML, a CSV of coefficients with their units, arrays of damage states.

The arrays are in the layout of GEM's Vulnerability Modellers' ToolKit (`openquake.vmtk.postprocessor`, what its
analyses return, https://github.com/GEMScienceTools/oq-vmtk): `intensities` (n,), `poes` (n, n_states), `medians`,
`betas_total` and `damage_thresholds` (n_states,), so that its `get_vulnerability_function(poes, consequences,
intensities)` takes them.
"""

import io
from pathlib import Path

import numpy as np
import pandas as pd

from damage.export.nrml import fitted, levels, spread, write_nrml
from damage.files import whole_or_nothing
from damage.measure.columns import unit_in
from damage.measure.tables import write_table
from damage.studies.fragility import unit_of


def write_curves(fits, folder, eigen_period_s):
    """Write all formats of the curves {wall: [Fragility]} into a folder; returns the paths.

    eigen_period_s: {wall: [s]}; files are FORMAT's own of each wall and measure, and one fragility_coefficients.csv.
    A level that none or all runs exceed has no curve, and is in the CSV alone.
    """
    folder, paths = Path(folder), []
    for wall, ones in fits.items():
        for measure in dict.fromkeys(one.measure for one in ones):
            same = [one for one in ones if one.measure == measure]
            stem = f"fragility_{wall}_{measure}_{same[0].intensity}"
            paths += [write_nrml(wall, same, folder / f"{stem}_{kind}.xml", kind, eigen_period_s[wall])
                      for kind in ("continuous", "discrete")]
            paths.append(write_arrays(same, folder / f"{stem}.npz"))
    paths.append(write_table(coefficients(fits), folder / "fragility_coefficients.csv"))
    return [path for path in paths if path]


def coefficients(fits):
    """A DataFrame with a row a curve: P(measure > level | intensity x) = Phi(ln(x / median) / dispersion).

    step_low, step_high: of a curve that is a step, between which intensities its median lies; the dispersion is then 0.
    """
    return pd.DataFrame([{
        "wall": wall, "measure": one.measure, "level": one.level, "level_unit": unit_in(one.measure),
        "intensity": one.intensity, "intensity_unit": unit_of(one.intensity)[1], "distribution": "lognormal",
        "median": one.median, "dispersion": one.dispersion, "step_low": (one.step or (None, None))[0],
        "step_high": (one.step or (None, None))[1], "runs": one.n_runs, "exceeding": one.n_exceeding,
        "records": one.n_records} for wall, ones in fits.items() for one in ones])


def write_arrays(fits, path):
    """Write the arrays of one wall and measure as NPZ, whole or not at all; returns the path, None without a curve."""
    curves = fitted(fits)
    if not curves:
        return None
    x, content = levels(curves), io.BytesIO()
    np.savez(content, intensities=x, poes=np.column_stack([fit.probability(x) for fit in curves]),
             medians=[fit.median for fit in curves], betas_total=[spread(fit) for fit in curves],
             damage_thresholds=[fit.level for fit in curves])
    with whole_or_nothing(path) as unfinished:
        unfinished.write_bytes(content.getvalue())
    return Path(path)
