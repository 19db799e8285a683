"""Fragility curves for other tools: NRML, a CSV of coefficients with their units, arrays of damage states.

A step, whose dispersion the data do not give, is no lognormal curve and is not written as one: the CSV bounds its
median, the discrete NRML and the arrays rise in a straight line between the bounds, and the continuous NRML leaves it
out.

The arrays are in the layout of GEM's Vulnerability Modellers' ToolKit (`openquake.vmtk.postprocessor`, what its
analyses return, https://github.com/GEMScienceTools/oq-vmtk): `intensities` (n,), `poes` (n, n_states), `medians`,
`betas_total` and `damage_thresholds` (n_states,), so that its `get_vulnerability_function(poes, consequences,
intensities)` takes them; `medians` and `betas_total` of a step are NaN.
"""

import io
from pathlib import Path

import numpy as np
import pandas as pd

from damage.export.nrml import fitted, has_name, levels, probability, write_nrml
from damage.files import whole_or_nothing
from damage.measure.tables import write_table
from damage.studies.states import unit_of


def write_curves(fits, folder, eigen_period_s):
    """Write all formats of the curves {wall: [Fragility]} into a folder; returns the paths.

    eigen_period_s: {wall: [s]}, needed by sa_eigen_period_g alone; files are FORMAT's own of each wall and measure,
    and one fragility_coefficients.csv.
    A level whose curve the runs do not determine is in the CSV alone, with the reason; so are all by an intensity that
    OpenQuake has no name for, but for the arrays.
    """
    folder, paths = Path(folder), []
    for wall, ones in fits.items():
        for measure in dict.fromkeys(one.measure for one in ones):
            same = [one for one in ones if one.measure == measure]
            stem = f"fragility_{wall}_{measure}_{same[0].intensity}"
            paths += [write_nrml(wall, same, folder / f"{stem}_{kind}.xml", kind, eigen_period_s.get(wall))
                      for kind in ("continuous", "discrete") if has_name(same[0].intensity)]
            paths.append(write_arrays(same, folder / f"{stem}.npz"))
    paths.append(write_table(coefficients(fits), folder / "fragility_coefficients.csv"))
    return [path for path in paths if path]


def left_out(fits):
    """Lines about curves {wall: [Fragility]} that no file has as lognormal ones, and why."""
    lines = [f"{wall}, {one.state}: a step, no lognormal curve: no run exceeds it up to {one.step[0]:.3g} "
             f"{unit_of(one.intensity)[1]}, all do from {one.step[1]:.3g} on; exported as these bounds of the median"
             for wall, ones in fits.items() for one in ones if one.step]
    lines += [f"{wall}, {one.state}: no curve: {one.n_exceeding} of {one.n_runs} runs exceed it, {one.why}"
              for wall, ones in fits.items() for one in ones if not np.isfinite(one.median)]
    odd = sorted({one.intensity for ones in fits.values() for one in ones if not has_name(one.intensity)})
    return lines + [f"no NRML by {name}: OpenQuake has no name for this intensity" for name in odd]


def coefficients(fits):
    """A DataFrame with a row a curve.

    distribution: "lognormal", P(measure > level | intensity x) = Phi(ln(x / median) / dispersion); "step", whose median
    lies between step_low and step_high and whose dispersion is not known; "none", where the runs determine no curve,
    with the reason in undetermined.
    new_record_low, new_record_high: 90 % prediction interval of the median in a new record.
    """
    return pd.DataFrame([{
        "wall": wall, "state": one.state, "measure": one.measure, "level": one.level,
        "level_unit": unit_of(one.measure)[1], "intensity": one.intensity, "intensity_unit": unit_of(one.intensity)[1],
        "distribution": "step" if one.step else "lognormal" if np.isfinite(one.median) else "none",
        "median": np.nan if one.step else one.median, "dispersion": np.nan if one.step else one.dispersion,
        **dict(zip(("step_low", "step_high"), one.step or (None, None))),
        **dict(zip(("new_record_low", "new_record_high"),
                   one.new_record.median_bounds() if one.new_record else (np.nan, np.nan))),
        "undetermined": one.why, "runs": one.n_runs, "exceeding": one.n_exceeding,
        "records": one.n_records} for wall, ones in fits.items() for one in ones])


def write_arrays(fits, path):
    """Write the arrays of one wall and measure as NPZ, whole or not at all; returns the path, None without a curve."""
    curves = fitted(fits)
    if not curves:
        return None
    x, content = levels(curves), io.BytesIO()
    np.savez(content, intensities=x, poes=np.column_stack([probability(fit, x) for fit in curves]),
             medians=[np.nan if fit.step else fit.median for fit in curves],
             betas_total=[np.nan if fit.step else fit.dispersion for fit in curves],
             damage_thresholds=[fit.level for fit in curves])
    with whole_or_nothing(path) as unfinished:
        unfinished.write_bytes(content.getvalue())
    return Path(path)
