"""Fragility of a wall: the probability that a measure of damage exceeds a level, by the motion's
intensity.

The curve is lognormal, P(x) = Phi(ln(x / median) / dispersion), fitted by maximum likelihood to the
number of runs that exceed the level at each intensity: J. W. Baker (2015), Efficient analytical
fragility function fitting using dynamic structural analysis, Earthquake Spectra 31(1),
doi:10.1193/021113EQS025M, equation (11).  It is the mean over the records.  Its bounds are
percentiles over bootstrap samples, drawn anew with replacement, of the records and of the draws of
the joints' strengths of one wall, each with all its runs; there are none of a single record or
draw.  Samples drawn from few scatter less than new ones would, so they are stretched about the fit
(`stretch`).  The interval for the curve of a new record is wider:
`damage.applications.studies.new_record`.

A curve is given only where the runs determine it (`solve`).  The same holds for every bootstrap
sample.  A sample that determines none is not left out, since an interval of the others alone would
be too narrow: its median counts as beyond all bounds, on the side of the runs that it is known to
lie on, else on both.  So a bound stands while fewer than one in twenty samples lie beyond it, and
is NaN otherwise.
"""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
import pandas as pd
import scipy  # optimize where it is used: it starts slowly
from scipy.special import log_ndtr, ndtr, ndtri, stdtrit

from damage.applications.studies.folder import KEPT
from damage.applications.studies.new_record import CONFIDENCE, TAILS, new_record
from damage.applications.studies.ordered import crossings
from damage.applications.studies.plan import unfinished
from damage.applications.studies.read import check_names, read_table
from damage.applications.studies.states import (
    LEVELS,
    STATES,
    STUDY_FILE,
    State,
    check_intensity,
    check_states,
    choices_in,
    in_unit,
    leading,
    parse_state,
    unit_of,
)
from damage.errors import InputError
from damage.toml_file import read_toml
from damage.wall.model_options import USUAL_MODEL

FEW_RECORDS = 10
"""Fewer are said to be few: 10 to 20 usually serve, D. Vamvatsikos, C. A. Cornell (2002),
doi:10.1002/eqe.141."""
WIDE = 10
"""Ratio of the bounds of a new record's median that is said to be large: of a known scatter of the
records it would be exp(2 * 1.645 * 0.7), and they scatter by 0.3 to 0.6."""
LEAST_INTENSITIES = 3
"""Through fewer a lognormal curve, of two parameters, passes whatever the wall does."""
_ALIKE = "solver", "settlement", "distortion", "shocks", "alpha_1_s", "beta_s", *USUAL_MODEL
"""Columns that are expected to be equal in all runs of a curve."""
SAME_INTENSITY = 0.01
"""Two that differ by a smaller share [-] count as one."""
SEED = 1
"""Seed of the bootstrap samples."""
_PERCENTILES = 50 * (1 - CONFIDENCE), 50 * (1 + CONFIDENCE)
DISPERSIONS = 1e-3, 3.0
"""Range of a fitted dispersion [-]; at its ends the runs determine none."""
_STARTS = 0.5, 0.2
"""Dispersions that the optimiser starts from [-]: the second where it stays at the first."""


class Fit(NamedTuple):
    """A lognormal curve: median, dispersion [-], NaN where the runs determine none; why: the
    reason, "" where they do. side: where the median lies then: 1 above all intensities that were
    run, -1 below, 0 not known.  step: of Fragility."""

    median: float = np.nan
    dispersion: float = np.nan
    why: str = ""
    side: int = 0
    step: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Fragility:
    """A fitted curve with its bounds.

    intensity: a column of summary.csv, in the unit of which all intensities are; median, dispersion
    [-]: NaN where the runs determine no curve, why: the reason; n_runs, n_exceeding, n_records;
    n_walls: draws of the wall's strengths; samples: medians and dispersions (n, 2) of the bootstrap
    samples, n_replicates or none.  Of a sample that determines none the dispersion is NaN, the
    median infinite, 0 or NaN where it lies above all intensities of the runs, below, or is not
    known.  step: two intensities where up to one no run exceeds the level and from the other on all
    do, with one other at most between them; the data then give no dispersion (it is 0), and bound
    the median by the two.  None where there are none.  name: of the damage state, "" for the
    condition.  stripes: what `new_record` takes, None where unknown."""

    measure: str
    level: float
    median: float
    dispersion: float
    n_runs: int
    n_exceeding: int
    samples: np.ndarray
    n_replicates: int
    n_records: int
    n_walls: int
    intensity: str
    step: tuple[float, float] | None = None
    name: str = ""
    stripes: tuple | None = None
    why: str = ""

    @property
    def state(self):
        """The damage state in words."""
        return State(self.measure, self.level, self.name).title

    @cached_property
    def new_record(self):
        """The NewRecord of the runs, None where there is none, as of runs that determine no
        curve."""
        return new_record(*self.stripes) if self.stripes and np.isfinite(self.median) else None

    @property
    def new_record_bounds(self):
        """Lower and upper bound (2,) of a new record's own median, NaN where there is none."""
        return self.new_record.median_bounds() if self.new_record else (np.nan, np.nan)

    def probability(self, intensity):
        """P(measure > level) at intensities of any shape."""
        return curve(intensity, self.median, self.dispersion)

    def bounds(self, intensity):
        """Return the lower and upper bound of the probability at intensities (n,), (2, n).

        None where nothing can be resampled, a single wall or record, and where the runs, or too
        many of the samples, determine no curve.
        """
        x = np.asarray(intensity, float)
        medians, dispersions = self._stretched().T
        known = np.isfinite(dispersions)
        curves = curve(x[None, :], medians[known, None], dispersions[known, None])
        unknown = np.full((np.count_nonzero(~known), len(x)), np.inf)
        low, high = _interval(np.vstack([curves, -unknown]), np.vstack([curves, unknown]))
        if np.isnan([low, high]).any():
            return None
        if self.step:
            low = np.minimum(low, curve(x, self.step[1], 0.0))
            high = np.maximum(high, curve(x, self.step[0], 0.0))
        return np.array([low, high])

    def median_bounds(self):
        """Return the lower and upper bound of (median, dispersion), (2, 2), NaN where there are
        none."""
        samples = self._stretched()
        least = np.where(np.isnan(samples) | (samples == 0) & [True, False], -np.inf, samples)
        low, high = _interval(least, np.where(np.isnan(samples), np.inf, samples))
        if self.step:
            low[0] = np.minimum(low[0], self.step[0])
            high[0] = np.maximum(high[0], self.step[1])
        return np.array([low, high])

    def _stretched(self):
        """Return medians and dispersions (n, 2) of the bootstrap samples, stretched about the fit;
        none where there is no fit."""
        samples = self.samples
        if len(samples) == 0 or not np.isfinite(self.median):
            return np.zeros((0, 2))
        fit = np.array([self.median, self.dispersion])
        fewest = min(self.n_walls, self.n_records)
        with np.errstate(divide="ignore", invalid="ignore"):
            stretched = fit * (samples / fit) ** stretch(fewest)
        return np.where((samples > 0) & (fit > 0), stretched, samples)

    def _determined(self):
        """Return the number of the bootstrap samples that determine a curve."""
        return int(np.isfinite(self.samples[:, 1]).sum())

    def notes(self):
        """Lines on what the runs, or bootstrap samples, do not determine."""
        if self.why:
            return [f"{self.state}: no curve, {self.why}"]
        lines = []
        low, high = self.new_record_bounds
        if high / low > WIDE:
            lines.append(
                f"{self.state}: a new record's median is known within a factor of"
                f" {high / low:.0f} only: these {self.n_records} records tell nothing of another;"
                " run more"
            )
        if len(self.samples) > 1 and np.isnan(self.median_bounds()).any():
            lines.append(
                f"{self.state}: {self.n_replicates - self._determined()} of {self.n_replicates}"
                " bootstrap samples determine no curve and count as beyond the bounds of the mean"
                " curve: where 5 % or more do, a bound is open (-)"
            )
        return lines

    def row(self):
        """The fit as a flat dictionary: a row of the table; medians have the intensity's unit in
        their names."""
        named = partial(in_unit, column=self.intensity)
        (low, least), (high, largest) = self.median_bounds()
        new_low, new_high = self.new_record_bounds
        return {
            "state": self.state,
            "measure": self.measure,
            "level": self.level,
            "runs": self.n_runs,
            "exceeding": self.n_exceeding,
            "records": self.n_records,
            named("median"): self.median,
            "dispersion": self.dispersion,
            "undetermined": self.why,
            named("median_both_low"): low,
            named("median_both_high"): high,
            "dispersion_both_low": least,
            "dispersion_both_high": largest,
            "fitted_both": self._determined(),
            named("median_new_record_low"): new_low,
            named("median_new_record_high"): new_high,
            "confidence": CONFIDENCE,
            "replicates": self.n_replicates,
        }


def stretch(n):
    """Factor by which bootstrap intervals of n samples are too narrow: resamples scatter less than
    n new ones, by sqrt((n - 1) / n), and Student's quantile exceeds the normal one, since the
    scatter is itself uncertain.  After T. C. Hesterberg (2015), What teachers should know about the
    bootstrap, The American Statistician
    69(4), doi:10.1080/00031305.2015.1089789, whose narrowness bias this corrects.

    >>> [round(float(stretch(n)), 2) for n in (2, 5, 25, 1000)]
    [5.43, 1.45, 1.06, 1.0]
    """
    low, _ = TAILS
    return np.sqrt(n / (n - 1)) * stdtrit(n - 1, low) / ndtri(low)


def curve(intensity, median, dispersion):
    """The lognormal fragility curve, with no dispersion a step; broadcasts."""
    return ndtr(np.log(np.asarray(intensity) / median) / np.maximum(dispersion, 1e-12))


def solve(intensity, exceeding, runs):
    """The Fit by maximum likelihood.

    intensity: (n,) [g]; exceeding, runs: (n,) how many of how many runs exceed the level there.
    Where the runs turn from none to all at once, with one intensity between at most, no dispersion
    is the likeliest: 0, and the median is the intensity where some exceed, or else the geometric
    mean of the two, between which all medians are as likely.

    Otherwise the runs determine a curve where its likelihood has one maximum, inside the bounds of
    the dispersion, the median is no extrapolation, and LEAST_INTENSITIES were run.  The first asks
    for two intensities at which some runs exceed and some do not.  Of runs that each have their
    own intensity it asks for the
    same: that one exceeds below another that does not (M. J. Silvapulle, 1981,
    doi:10.1111/j.2517-6161.1981.tb01676.x, of one covariate).
    """
    x, y, n = (
        np.asarray(values, float)[np.asarray(runs) > 0] for values in (intensity, exceeding, runs)
    )
    low = x[y == 0].max(initial=-np.inf)
    high = x[y == n].min(initial=np.inf)
    some = x[(y > 0) & (y < n)]
    is_step = -np.inf < low <= high < np.inf and len(some) < 2
    if is_step and all((low < some) & (some < high)):
        median = some[0] if len(some) else np.sqrt(low * high)
        return Fit(float(median), 0.0, step=(float(low), float(high)))
    side = int(np.all(y < n / 2)) - int(np.all(y > n / 2))
    if y.sum() in (0, n.sum()):
        return Fit(why=f"{'no' if y.sum() == 0 else 'every'} run exceeds it", side=side)
    if x[y > 0].min() >= x[y < n].max():
        why = "one intensity only has runs of both kinds, a curve needs two"
        return Fit(why=why, side=side)
    if (distinct := _distinct(x)) < LEAST_INTENSITIES:
        why = f"{distinct} intensities only, a curve needs {LEAST_INTENSITIES} that differ by 1 %"
        return Fit(why=why, side=side)
    return _likeliest(np.log(x), y, n, side)


def _distinct(intensities):
    """How many of intensities (n,) differ by more than SAME_INTENSITY from the one that counted
    before them."""
    count = 0
    last = 0.0
    for value in np.sort(intensities):
        if value > last * (1 + SAME_INTENSITY):
            count = count + 1
            last = value
    return count


def _likeliest(x, y, n, side):
    """The Fit of ln intensities x (n,); side: where the median lies if no rising curve is the
    likeliest."""

    def misfit(parameters):  # Baker (2015), equation (11), with the sign changed
        z = (x - parameters[0]) / np.exp(parameters[1])
        below = log_ndtr(z)
        above = log_ndtr(-z)
        density = -0.5 * z**2 - 0.5 * np.log(2 * np.pi)
        dz = y * np.exp(density - below) - (n - y) * np.exp(density - above)
        return (
            -np.sum(y * below + (n - y) * above),
            np.array([np.sum(dz) / np.exp(parameters[1]), np.sum(dz * z)]),
        )

    centre = np.average(x, weights=n)
    ends = np.log(DISPERSIONS)
    for start in np.log(_STARTS):
        best = scipy.optimize.minimize(
            misfit,
            (centre, start),
            jac=True,
            method="L-BFGS-B",
            bounds=((x.min() - 5, x.max() + 5), tuple(ends)),
        )
        if best.x[1] != start:
            break
    median, dispersion = (float(np.exp(value)) for value in best.x)
    if best.x[1] == start:
        return Fit(why="the likelihood does not depend on the dispersion", side=side)
    if np.abs(best.x[1] - ends).min() < 1e-6:
        note = ": no rising curve fits" if best.x[1] > start else ""
        return Fit(why=f"the dispersion is at its bound of {dispersion:g}{note}", side=side)
    if above := int(best.x[0] > x.max()) - int(best.x[0] < x.min()):
        where = "above" if above > 0 else "below"
        why = f"the median would lie {where} all intensities that were run"
        return Fit(why=why, side=above)
    return Fit(median, dispersion)


_SIDES = {1: (np.inf, np.nan), 0: (np.nan, np.nan), -1: (0.0, np.nan)}
"""Median and dispersion that stand for a bootstrap sample without a curve, by `Fit.side`."""


def _interval(low, high):
    """Percentiles, lower of low (n, ...) and upper of high, NaN where they fall among those that
    are infinite."""
    if len(low) < 2:
        return np.full((2, *low.shape[1:]), np.nan)
    with np.errstate(invalid="ignore"):
        ends = [
            np.percentile(values, percentile, axis=0)
            for values, percentile in zip((low, high), _PERCENTILES)
        ]
    return np.where(np.isfinite(ends), ends, np.nan)


def exceeding(runs, measure, level):
    """Series of bool: whether runs exceed a level; a collapsed wall exceeds every level."""
    return (runs[measure] > level) | runs["collapsed_at_s"].notna()


def fragility(runs, measure, level, intensity, replicates, name=""):
    """The Fragility of runs (rows of a study's summary.csv); a wall that collapsed exceeds every
    level.

    Draws of the wall differ by `strength_seed`; replicates: number of bootstrap samples; name: of
    the damage state.
    """
    exceeds = exceeding(runs, measure, level)
    records = runs["record"].fillna("")
    (wall, walls), (record, known), (place, values) = (
        pd.factorize(column, sort=True)
        for column in (runs["strength_seed"], records, runs[intensity].astype(float))
    )
    sizes = len(walls), len(known)
    # of a wall in a record at an intensity the runs that exceed, and all
    counts = np.zeros((2, *sizes, len(values)))
    np.add.at(counts[0], (wall, record, place), exceeds.to_numpy(float))
    np.add.at(counts[1], (wall, record, place), 1)
    # of walls, and of records
    random = [np.random.default_rng((SEED, number)) for number in range(2)]
    fits = [
        solve(values, *_drawn(counts, sizes, random))
        for _ in range(replicates if min(sizes) > 1 else 0)
    ]
    samples = np.array([_SIDES[fit.side] if fit.why else fit[:2] for fit in fits]).reshape(-1, 2)
    fit = solve(values, *counts.sum(axis=(1, 2)))
    return Fragility(
        measure=measure,
        level=level,
        median=fit.median,
        dispersion=fit.dispersion,
        n_runs=len(runs),
        n_exceeding=int(exceeds.sum()),
        samples=samples,
        n_replicates=replicates,
        n_records=len(known),
        n_walls=len(walls),
        intensity=intensity,
        step=fit.step,
        name=name,
        stripes=(values, *counts.sum(axis=1)),
        why=fit.why,
    )


def _drawn(counts, sizes, random):
    """Return the numbers of runs that exceed and of all, by intensity, of a bootstrap sample of
    walls and records."""
    walls, records = (
        np.bincount(draws.integers(size, size=size), minlength=size)
        for draws, size in zip(random, sizes)
    )
    return np.einsum("kwri,w,r->ki", counts, walls, records)


def load_runs(folder):
    """The runs of a study's folder whose strengths scatter: rows of its tables/summary.csv."""
    path = folder / "tables" / "summary.csv"
    if not path.is_file():
        raise InputError(
            f"{folder} holds no tables/summary.csv; expected the folder of a study;"
            f" {unfinished(folder) or 'run one: ./run_all.sh fragility --solver reference'}"
        )
    runs = read_table(
        path,
        (
            *LEVELS,
            "pga_g",
            "strength_cov",
            "strength_seed",
            "wall",
            "record",
            "status",
            "collapsed_at_s",
        ),
    )
    check_names(runs, path)
    runs = runs[
        (pd.to_numeric(runs["strength_cov"], errors="coerce") > 0) & (runs["status"] == "complete")
    ]
    if len(runs) == 0:
        raise InputError(
            f"{path} holds no finished run with scattered strengths; expected some with"
            " strength-cov, as in studies/fragility.toml"
        )
    seed, collapse = (
        pd.to_numeric(runs[name], errors="coerce").isna()
        for name in ("strength_seed", "collapsed_at_s")
    )
    for name, bad, expected in (
        ("wall", runs["wall"].isna(), "a name"),
        ("strength_seed", seed, "a number"),
        ("collapsed_at_s", collapse & runs["collapsed_at_s"].notna(), "a time or nothing"),
    ):
        if bad.any():
            raise InputError(
                f"{path}: {bad.sum()} of {len(runs)} runs have {runs[name][bad].tolist()[0]!r} as"
                f" {name}; expected {expected} in each; take another copy of the table"
            )
    return runs


def choices_of(folder, intensity=None, states=()):
    """(runs, intensity, states) of a study's folder: `load_runs`, the column and the tuple of State
    that are asked for, else those of the study file, else the defaults.

    intensity: a column, None where none is asked for; states: texts as of `parse_state`.
    """
    path = folder / KEPT
    table = read_toml(path, *STUDY_FILE) if path.is_file() else {}
    chosen, column = choices_in(table, path)
    runs = load_runs(folder)
    asked = tuple(map(parse_state, states or ()))
    return runs, intensity or column or leading(runs), asked or chosen or STATES


def mixed(runs):
    """Sentences on walls whose runs differ by more than the motion and what is drawn."""
    for wall, runs_of_wall in runs.groupby("wall", sort=False):
        names = [
            name
            for name in _ALIKE
            if name in runs_of_wall and runs_of_wall[name].nunique(dropna=False) > 1
        ]
        if names:
            yield f"wall {wall}: one curve through runs that differ in {', '.join(names)}"


def fit_all(runs, intensity, replicates, states=STATES):
    """{wall: [Fragility of each State]} of runs; intensity: a column of theirs."""
    check_intensity(runs, intensity)
    check_states(runs, states)
    return {
        wall: [
            fragility(of_wall, state.measure, state.level, intensity, replicates, name=state.name)
            for state in states
        ]
        for wall, of_wall in runs.groupby("wall", sort=False)
    }


def fragility_table(fits):
    """A DataFrame with a row for each wall, measure and level."""
    return pd.DataFrame(
        [
            {"wall": wall, "intensity": fit.intensity, **fit.row()}
            for wall, ones in fits.items()
            for fit in ones
        ]
    )


def in_words(fits):
    """Text on curves {wall: [Fragility]}: a line each, with the intervals of the median for the
    mean curve and for a new record."""
    lines = []
    notes = []
    for wall, of_wall in fits.items():
        first = of_wall[0]
        lines += [
            (
                f"{wall} wall by {first.intensity} [{unit_of(first.intensity)}],"
                f" runs: {first.n_runs}, draws of strengths: {first.n_walls}, records:"
                f" {first.n_records}; intervals of {100 * CONFIDENCE:.0f} %"
            ),
            (
                f"{'damage state':28} {'exceed':>6} {'median':>16} {'dispersion':>10}"
                f" {'mean curve':>16} {'a new record':>16}"
            ),
        ]
        for fit in of_wall:
            median = _span(fit.step or [fit.median])
            dispersion = "step" if fit.step else "-" if fit.why else f"{fit.dispersion:.2f}"
            mean = fit.median_bounds()[:, 0]
            lines.append(
                f"{fit.state:28} {fit.n_exceeding:6} {median:>16} {dispersion:>10}"
                f" {_span(mean):>16} {_span(fit.new_record_bounds):>16}"
            )
            notes += fit.notes()
        notes += filter(None, [few_note(first.n_records)])
        notes += crossings(of_wall)
    return "\n".join(lines + notes)


def few_note(n_records):
    """A line where the records are too few to bound what others would do, else ""."""
    if n_records >= FEW_RECORDS:
        return ""
    are = "record is" if n_records == 1 else "records are"
    return f"{n_records} {are} few: another may give medians far from these"


def _span(bounds):
    """Two bounds, or one number, in words; what is missing as "-"."""
    if np.isnan(bounds).all():
        return "-"
    return " to ".join("-" if np.isnan(end) else f"{end:#.3g}" for end in bounds)


def at_intensities(fits, values):
    """A DataFrame with a row for each curve {wall: [Fragility]} and intensity of values: the
    probability of exceeding by the curve, the interval of the mean curve, that of a new record's
    own probability with its median, and the mean of the latter."""
    unknown = np.full((3, len(values)), np.nan)
    tables = []
    for wall, fit in ((wall, fit) for wall, ones in fits.items() for fit in ones):
        mean = fit.bounds(values)
        low, high = unknown[:2] if mean is None else mean
        new = fit.new_record
        new_low, new_median, new_high = new.percentiles(values) if new else unknown
        table = {
            "wall": wall,
            "state": fit.state,
            "measure": fit.measure,
            "level": fit.level,
            "intensity": fit.intensity,
            "value": values,
            "unit": unit_of(fit.intensity),
            "probability": fit.probability(values),
            "mean_low": low,
            "mean_high": high,
            "new_record_low": new_low,
            "new_record_median": new_median,
            "new_record_high": new_high,
            "new_record": new.probability(values) if new else np.nan,
            "undetermined": fit.why,
        }
        tables.append(pd.DataFrame(table))
    return pd.concat(tables, ignore_index=True)
