"""Curves of the states of one measure, the graver of which implies the milder: where they cross,
and a fit with one dispersion for all.

Each curve by itself (`damage.applications.studies.fragility`) has its own dispersion, and two of
different dispersions cross: beyond that intensity the graver state is the likelier, and the
probability of the milder state alone, their difference, is negative.  Curves of one dispersion do
not cross.  It is fitted to all states together by maximum likelihood, the ordinal (cumulative)
probit model: D. Lallemant, A. Kiremidjian, H. Burton (2015), Earthquake Engineering and Structural
Dynamics 44, doi:10.1002/eqe.2522; M. Nguyen, D. Lallemant (2022), Risk Analysis 42,
doi:10.1111/risa.13815.
"""

from dataclasses import replace

import numpy as np
import scipy  # optimize where it is used: it starts slowly
from scipy.special import ndtr

from damage.applications.studies.states import unit_of

_LEAST_GAP = 1e-5
_MOST_GAP = 1e2
"""Bounds of the difference of the logarithms of two medians that follow each other."""
_LEAST_SHARE = 1e-300
"""Probability that stands for zero in a logarithm."""


def with_one_dispersion(fits):
    """A list of Fragility of one wall, in its order, whose curves of one measure have a dispersion
    in common.

    A step takes it, too, where another curve of the measure has one.  A level without a curve, and
    a measure with one curve or with steps alone, stay as they are.
    """
    joined = {}
    for curves in _by_measure(fits):
        if len(curves) > 1 and not all(fit.step for fit in curves):
            medians, dispersion = _ordinal_probit(curves)
            joined |= {
                id(fit): replace(
                    fit,
                    median=float(median),
                    dispersion=float(dispersion),
                    samples=np.zeros((0, 2)),
                    step=None,
                )
                for fit, median in zip(curves, medians)
            }
    return [joined.get(id(fit), fit) for fit in fits]


def crossings(fits):
    """Lines on curves of a list of Fragility that cross within the intensities that were run, with
    the fit of one dispersion beside them."""
    joined = {fit.state: fit for fit in with_one_dispersion(fits)}
    lines = []
    for curves in _by_measure(fits):
        for milder, graver in zip(curves, curves[1:]):
            if where := _likelier(milder, graver):
                first, second = (joined[fit.state] for fit in (milder, graver))
                lines.append(
                    f"{graver.state} is likelier than {milder.state}, which it implies, {where}:"
                    " their dispersions differ; fitted with one for both, as in NRML, it is"
                    f" {first.dispersion:.2f}, and the medians are {first.median:#.3g}"
                    f" ({milder.state}) and {second.median:#.3g}"
                )
    return lines


def _by_measure(fits):
    """Lists of the Fragility of each measure that have a curve or a step, by ascending level."""
    curves = sorted((fit for fit in fits if np.isfinite(fit.median)), key=lambda fit: fit.level)
    return [
        [fit for fit in curves if fit.measure == measure]
        for measure in dict.fromkeys(fit.measure for fit in curves)
    ]


def _likelier(milder, graver):
    """Where within the intensities that were run a graver state is likelier than a milder one, in
    words; None where nowhere, and of a step, whose dispersion is not known.

    Two curves cross once, at equal (ln x - ln median) / dispersion.
    """
    narrower = milder.dispersion - graver.dispersion
    if narrower == 0 or milder.step or graver.step:
        return None
    crossing = (
        milder.dispersion * np.log(graver.median) - graver.dispersion * np.log(milder.median)
    ) / narrower
    intensities = np.log(np.asarray(graver.stripes[0]))
    value = f"{np.exp(crossing):#.2g} {unit_of(graver.intensity)}"
    if narrower > 0 and crossing < intensities.max():
        return f"from {value} on"
    if narrower < 0 and crossing > intensities.min():
        return f"up to {value}"
    return None


def _ordinal_probit(curves):
    """Medians (k,) and the dispersion of k Fragility of ascending levels by maximum likelihood."""
    intensity, _, runs = curves[0].stripes
    exceeding = [fit.stripes[1].sum(axis=0) for fit in curves]
    runs = runs.sum(axis=0)
    # (k + 1, n): runs that exceed no level, the first alone, ... all of them
    counts = -np.diff([runs, *exceeding, np.zeros_like(runs)], axis=0)
    x = np.log(np.asarray(intensity))

    def misfit(parameters):
        z = (x - _logarithms(parameters)[:, None]) / np.exp(parameters[0])
        edge = np.full((1, len(x)), np.inf)
        upper = np.vstack([edge, z])
        lower = np.vstack([z, -edge])
        # of both tails the one in which the difference keeps its digits
        share = np.where(upper + lower > 0, ndtr(-lower) - ndtr(-upper), ndtr(upper) - ndtr(lower))
        return -np.sum(counts * np.log(np.maximum(share, _LEAST_SHARE)))

    medians = np.log([fit.median for fit in curves])
    dispersions = [fit.dispersion for fit in curves if not fit.step]
    gaps = np.log(np.clip(np.diff(medians), 1e-2, None))
    best = scipy.optimize.minimize(
        misfit,
        [np.log(np.mean(dispersions)), medians[0], *gaps],
        method="L-BFGS-B",
        bounds=[(None, None), (None, None), *[np.log((_LEAST_GAP, _MOST_GAP))] * len(gaps)],
        options={"ftol": 1e-13, "gtol": 1e-7},
    )
    return np.exp(_logarithms(best.x)), np.exp(best.x[0])


def _logarithms(parameters):
    """Logarithms of the medians of the parameters: logarithms of the dispersion, of the first
    median, and of the differences that follow."""
    return parameters[1] + np.concatenate([[0.0], np.cumsum(np.exp(parameters[2:]))])
