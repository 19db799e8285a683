"""Fragility curves for other tools: NRML 0.5, a CSV of coefficients with their units.

A step, whose dispersion the data do not give, is no lognormal curve and is not written as one: the
CSV bounds its median, the discrete NRML (probabilities at levels of intensity) rises in a straight
line between the bounds, and the continuous NRML (mean and standard deviation of a lognormal
distribution, `logncdf`) leaves it out.

The curves of one NRML model have a dispersion in common (`with_one_dispersion`), since OpenQuake
takes the difference of two of them, which is negative beyond a crossing.  Beside another curve of
the measure a step takes that dispersion, too.

The NRML is that of the OpenQuake engine, `openquake/risklib/read_nrml.py` and the manual's chapter
on fragility models: https://docs.openquake.org/oq-engine/master/manual/
"""

import re
from itertools import product
from xml.etree import ElementTree as Xml

import numpy as np
import pandas as pd

from damage.applications.studies.ordered import with_one_dispersion
from damage.applications.studies.states import unit_of
from damage.errors import InputError
from damage.files import whole_or_nothing
from damage.measure.tables import write_table

NAMESPACE = "http://openquake.org/xmlns/nrml/0.5"
_Z = np.linspace(-4.0, 4.0, 33)
"""Levels of a curve, in dispersions from the median: from 0.00003 to 0.99997."""
_TYPES = {
    "record_pga_g": ("PGA", 1),
    "pga_g": ("PGA", 1),
    "pgv_m_s": ("PGV", 100),
    "pgv_rotd100_m_s": ("PGV", 100),
    "sa_0.2_s_g": ("SA(0.2)", 1),
    "sa_eigen_period_g": ("SA({:.4g})", 1),
    "avg_sa_g": ("AvgSA", 1),
    "arias_m_s": ("IA", 1),
}
"""OpenQuake's names of columns of summary.csv, with the wall's first period [s] where it is part of
one, and the factor to its unit: g, of PGV cm/s, of the Arias intensity m/s."""


def limit_state(fit):
    """Name of the limit state of a Fragility, of letters that OpenQuake takes, as max_DI_over_0p02
    or its own."""
    return re.sub(r"\W+", "_", fit.name) or f"{fit.measure}_over_{fit.level:g}".replace(
        ".", "p"
    ).replace("-", "m")


def write_nrml(wall, fits, path, kind, eigen_period_s=None):
    """Write the curves of one wall and measure as NRML, whole or not at all; returns the path, None
    where no level has a curve of this kind.

    fits: Fragility of a measure's levels, ascending; kind: "continuous" or "discrete".
    """
    curves = [fit for fit in fits if not fit.why and (kind == "discrete" or not fit.step)]
    if not curves:
        return None
    name, factor = _TYPES[curves[0].intensity]
    name = name.format(eigen_period_s)
    root = Xml.Element("nrml", xmlns=NAMESPACE)
    model = Xml.SubElement(
        root,
        "fragilityModel",
        id=f"{wall}_{curves[0].measure}",
        assetCategory="building",
        lossCategory="structural",
    )
    Xml.SubElement(model, "description").text = _description(wall, fits, name, kind)
    Xml.SubElement(model, "limitStates").text = " ".join(map(limit_state, curves))
    function = Xml.SubElement(model, "fragilityFunction", id=wall, format=kind)
    # from where the first of the curves begins to where the last has come to its end
    x = np.concatenate([fit.step or fit.median * np.exp(fit.dispersion * _Z) for fit in curves])
    x = np.unique([float(_text(value)) for value in x])
    # Without a limit OpenQuake takes, of every smaller event, the probability at `minIML` in a
    # continuous model, and a straight line to zero in a discrete one.
    imls = Xml.SubElement(function, "imls", imt=name, noDamageLimit=_text(factor * x[0]))
    if kind == "continuous":
        imls.set("minIML", imls.get("noDamageLimit"))
        imls.set("maxIML", _text(factor * x[-1]))
        function.set("shape", "logncdf")
    else:
        imls.text = " ".join(map(_text, factor * x))
    for fit in curves:
        if kind == "discrete":
            chances = Xml.SubElement(function, "poes", ls=limit_state(fit))
            # of a step the straight line between the intensities that bound its median
            p = np.interp(x, fit.step, (0.0, 1.0)) if fit.step else fit.probability(x)
            chances.text = " ".join(map(_text, p))
            continue
        # mean and standard deviation of the intensity itself, not of its logarithm
        mean = factor * fit.median * np.exp(fit.dispersion**2 / 2)
        deviation = mean * np.sqrt(np.expm1(fit.dispersion**2))
        moments = {"mean": repr(float(mean)), "stddev": repr(float(deviation))}
        Xml.SubElement(function, "params", ls=limit_state(fit), **moments)
    Xml.indent(root)
    with whole_or_nothing(path) as unfinished:
        Xml.ElementTree(root).write(unfinished, encoding="utf-8", xml_declaration=True)
    return path


def _text(value):
    return f"{value:.9g}"


def _description(wall, fits, name, kind):
    """What the curves are of, and what they leave out."""
    first = fits[0]
    without = [f"{fit.level:g} ({fit.why})" for fit in fits if fit.why]
    steps = [f"{fit.level:g}" for fit in fits if fit.step]
    lines = [
        f"Wall {wall}: probability that {first.measure} exceeds a level, by {name};"
        f" {first.n_runs} runs in {first.n_records} records; masonry-damage."
    ]
    if without:
        lines.append(f"No curve for {', '.join(without)}.")
    if len(fits) > len(without) + 1 and len({fit.dispersion for fit in fits if not fit.why}) == 1:
        lines.append("One dispersion for all levels, so that curves do not cross (ordinal probit).")
    if steps:
        shown = {
            "discrete": "a straight line between the bounds.",
            "continuous": "left out, see the discrete model.",
        }
        lines.append(
            f"A step for {', '.join(steps)}: the data bound its median and give no dispersion;"
            f" {shown[kind]}"
        )
    return " ".join(lines)


def write_curves(runs, fits, folder):
    """Write all formats of the curves {wall: [Fragility]} of runs, of one intensity, into a folder;
    yields lines on what is written: paths, and why there is no NRML.

    Files are NRML of each wall and measure, and one fragility_coefficients.csv.  A level whose
    curve the runs do not determine is in the CSV alone, with the reason; so are all by an intensity
    that OpenQuake has no name for.
    """
    (intensity,) = {fit.intensity for ones in fits.values() for fit in ones}
    periods_s = _periods_s(runs) if intensity == "sa_eigen_period_g" else {}
    for wall, ones in fits.items() if intensity in _TYPES else ():
        joined = with_one_dispersion(ones)
        measures = dict.fromkeys(fit.measure for fit in joined)
        for measure, kind in product(measures, ("continuous", "discrete")):
            same = [fit for fit in joined if fit.measure == measure]
            path = folder / f"fragility_{wall}_{measure}_{intensity}_{kind}.xml"
            if write_nrml(wall, same, path, kind, periods_s.get(wall)):
                yield path
    yield write_table(coefficients(fits), folder / "fragility_coefficients.csv")
    if intensity not in _TYPES:
        yield f"no NRML by {intensity}: OpenQuake has no name for this intensity"


def _periods_s(runs):
    """{wall: first period [s]} of runs, which names their spectral acceleration."""
    periods_s = pd.to_numeric(runs.get("eigen_period_s", 0), errors="coerce")
    if not np.all(periods_s > 0):
        raise InputError(
            "--export by sa_eigen_period_g: summary.csv has no eigen_period_s in every run, the"
            " period that NRML names; expected a number above zero; choose another intensity, as"
            " --intensity pga_g, or run the study again"
        )
    return runs.groupby("wall")["eigen_period_s"].median()


def coefficients(fits):
    """A DataFrame with a row a curve.

    distribution: "lognormal", P(measure > level | intensity x) = Phi(ln(x / median) / dispersion);
    "step", whose median lies between step_low and step_high and whose dispersion is not known;
    "none", where the runs determine no curve, with the reason in undetermined.
    new_record_low, new_record_high: 90 % prediction interval of the median in a new record.
    """
    rows = []
    for wall, ones in fits.items():
        for fit, joined in zip(ones, with_one_dispersion(ones)):
            step_low, step_high = fit.step or (None, None)
            new_record_low, new_record_high = fit.new_record_bounds
            median, dispersion = _without_step(fit)
            common_median, common_dispersion = _without_step(joined)
            rows.append(
                {
                    "wall": wall,
                    "state": fit.state,
                    "measure": fit.measure,
                    "level": fit.level,
                    "level_unit": unit_of(fit.measure),
                    "intensity": fit.intensity,
                    "intensity_unit": unit_of(fit.intensity),
                    "distribution": "step" if fit.step else "none" if fit.why else "lognormal",
                    "median": median,
                    "dispersion": dispersion,
                    "step_low": step_low,
                    "step_high": step_high,
                    "new_record_low": new_record_low,
                    "new_record_high": new_record_high,
                    "common_median": common_median,
                    "common_dispersion": common_dispersion,
                    "undetermined": fit.why,
                    "runs": fit.n_runs,
                    "exceeding": fit.n_exceeding,
                    "records": fit.n_records,
                }
            )
    return pd.DataFrame(rows)


def _without_step(fit):
    """Median and dispersion of a Fragility; NaN of a step, whose dispersion is not known."""
    return (np.nan, np.nan) if fit.step else (fit.median, fit.dispersion)
