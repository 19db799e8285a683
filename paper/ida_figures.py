"""Figures 10 to 12 of Sarhosis et al. (2021), doi:10.1016/j.engstruct.2021.112529, from a study's
tables: recorded motions at several scales (incremental dynamic analysis), and what they do to a
wall.

Each function returns a Figure, or raises Missing when there is nothing to draw.
"""

import hashlib

import matplotlib
import numpy as np
from scipy.optimize import least_squares

from damage.draw import panels
from damage.draw.style import BLACK, BLUE, MEDIUM, VERMILLION, line_handle, put_title, styled
from damage.draw.words import record_label
from damage.measure.damage_index import CRITERIA
from damage.motion.formats import read_record, shipped_record_path
from damage.motion.intensity import pga_g, response_spectrum
from damage.motion.loading import Recorded
from damage.units import GRAVITY
from paper import marks
from paper.printed import largest_residual, record_values, star, star_handles
from paper.results import Missing

SPECTRUM_PERIODS_S = np.geomspace(0.02, 2.0, 120)
WALL_PERIOD_S = 0.2  # of the walls with an opening, marked in the spectra
TREND_POINTS = 4
"""Fewest points through which a parabola is laid."""


# --- the records ----------------------------------------------------------------------------------


@styled
def records(results, points):
    """Figure 10: each record as it was used, and its response spectra at every scale factor."""
    names = marks.in_order(points["record"].unique())
    figure, axes = panels.grid(len(names), 2, 1.9, width_ratios=(3, 2))
    scales = np.unique(points["scale"])
    colours = dict(zip(scales, matplotlib.colormaps["cividis"](np.linspace(0, 0.95, len(scales)))))
    for number, (name, row) in enumerate(zip(names, axes)):
        of_record = points[points["record"] == name]
        motion = _unscaled_motion(results, of_record.iloc[0])
        row[0].plot(motion.time_s, motion.acceleration_m_s2 / GRAVITY, color=BLACK, lw=0.6)
        row[0].set_ylabel("acceleration [g]")
        row[0].margins(x=0)
        paper_pga_g, paper_sa_g = record_values(name)
        panels.letter(
            row[0],
            2 * number,
            f"{record_label(name)}, PGA {pga_g(motion):.3f} g"
            + (f" (paper {paper_pga_g:.2f})" if paper_pga_g else ""),
        )
        panels.letter(row[1], 2 * number + 1, "response spectra")
        for scale in np.unique(of_record["scale"]):
            row[1].plot(
                SPECTRUM_PERIODS_S,
                scale * response_spectrum(motion, SPECTRUM_PERIODS_S),
                color=colours[scale],
            )
        star(row[1], WALL_PERIOD_S, paper_sa_g)
        row[1].axvline(WALL_PERIOD_S, color=MEDIUM, ls=":", lw=0.8)
        row[1].set(xscale="log", ylabel="Sa (5 %) [g]", xlim=(0.02, 2.0))
        row[1].set_xticks(
            [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2],
            labels=["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"],
        )
        row[1].minorticks_off()
        row[1].set_ylim(bottom=0)
    axes[-1, 0].set_xlabel("time [s]")
    axes[-1, 1].set_xlabel("period [s]")
    notes = dict.fromkeys(marks.scale_note(column) for column in axes.T)
    put_title(
        figure,
        "Records and their response spectra at all scale factors",
        _synthetic_note(names),
        *notes,
    )
    handles = [line_handle(colours[scale], f"× {scale:g}") for scale in scales]
    handles.append(line_handle(MEDIUM, f"{WALL_PERIOD_S:g} s", 0.8, ":"))
    handles += star_handles([name for name in names if record_values(name)[1]])
    return panels.finish(figure, handles, columns=9)


def _synthetic_note(names):
    """A line that says it where a record is not a recording, else ""."""
    synthetic = [record_label(name) for name in names if "synthetic" in name]
    return (
        f"Not recorded but made to match a published spectrum: {'; '.join(synthetic)}"
        if synthetic
        else ""
    )


def _unscaled_motion(results, point):
    """The record of a point's first run as it was prepared for it, at scale 1, from a file with the
    same bytes."""
    loading = results.history(point).loading
    own = results.records
    file = loading.horizontal["file"]
    sha256 = loading.horizontal["sha256"]
    for path in (*shipped_record_path().parents[1].glob(f"*/{file}"), own / file):
        if path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == sha256:
            record = read_record(path, **loading.horizontal.get("given", {}))
            prepared = Recorded(
                record,
                window_s=loading.window_s,
                baseline_order=loading.baseline_order,
                band_hz=loading.band_hz,
                interpolated_for_s=loading.interpolated_for_s,
            )
            return prepared.applied()
    raise Missing(
        f"no record {file} with the bytes that the runs read, neither shipped nor in {own}/"
    )


# --- what they do ---------------------------------------------------------------------------------


@styled
def residual_against_pga(variant, slip="displacement"):
    """Figure 11: residual index and components against PGA, a panel a record."""
    names = marks.in_order(variant.points["record"].unique())
    figure, axes = panels.grid(len(names), 1, 1.9, sharex=True, sharey=True)
    collapsed = False
    for number, (ax, name) in enumerate(zip(axes[:, 0], names)):
        panels.letter(ax, number, record_label(name))
        reference, yade = (
            points[points["record"] == name] for points in (variant.reference, variant.yade)
        )
        collapsed |= marks.draw_components(
            ax, reference, yade, "pga_g", f"residual_{CRITERIA[slip]}"
        )
        star(ax, *largest_residual(variant, name))
        ax.set_ylabel("residual damage index [-]")
    axes[0, 0].set_xlim(left=0)  # of all panels, once all is drawn
    panels.from_zero(axes[0, 0], marks.NOTHING)
    axes[-1, 0].set_xlabel("PGA [g]")
    put_title(
        figure,
        f"Residual damage index against PGA: {variant.title}",
        marks.SLIP_LABELS[slip],
        _synthetic_note(names),
    )
    printed = [name for name in names if largest_residual(variant, name)[1] is not None]
    return marks.finish_components(figure, variant, collapsed, star_handles(printed))


@styled
def against_drift(variant, slip="displacement"):
    """Figure 12: (a) maximum, (b) residual index against maximum drift, with second-order trend
    lines.

    The parabola is a least-squares fit to the medians of the reference solver over all records, or
    to
    YADE's runs where there are no others, without walls that fell, among those that are nowhere
    negative in the range of the drifts.
    """
    names = marks.in_order(variant.points["record"].unique())
    markers = marks.record_markers(names)
    hollow = dict(zip(names, marks.SINGLE_MARKERS * len(names)))
    figure, axes = panels.grid(1, 2, 2.5)
    reference = in_percent(variant.reference)
    yade = in_percent(variant.yade)
    collapsed = trend = False
    for number, (ax, state) in enumerate(zip(axes[0], ("max", "residual"))):
        column = f"{state}_{CRITERIA[slip]}DI"
        for name in names:
            medians, single = (points[points["record"] == name] for points in (reference, yade))
            marks.draw_cloud(ax, medians, "max_drift_pct", column, BLACK, markers[name])
            marks.draw_yade(ax, single, "max_drift_pct", column, VERMILLION, hollow[name])
        collapsed |= any(
            [
                marks.mark_collapses(ax, points, "max_drift_pct", column)
                for points in (reference, yade)
            ]
        )
        label = _draw_trend(ax, reference if len(reference) else yade, column)
        trend |= label is not None
        panels.letter(ax, number, f"{'maximum' if state == 'max' else 'residual'} DI{label or ''}")
        ax.set(xlabel="maximum drift ratio [%]", ylabel="damage index [-]", xlim=(0, None))
        panels.from_zero(ax, marks.NOTHING)
    put_title(
        figure,
        f"Damage index against maximum drift: {variant.title}",
        marks.SLIP_LABELS[slip],
        _synthetic_note(names),
    )
    handles = _record_handles(variant, names, markers, hollow)
    if trend:
        words = "second-order polynomial, least squares, nowhere negative"
        handles.append(line_handle(BLUE, words, 1.0))
    if collapsed:
        handles.append(marks.collapse_handle())
    return panels.finish(figure, handles, columns=2)


def in_percent(points):
    """Points with max_drift_pct and its range [%] beside the drift ratio."""
    columns = {
        f"max_drift_pct{end}": 100 * points[f"max_drift_ratio{end}"].astype(float)
        for end in ("", "_min", "_max")
        if f"max_drift_ratio{end}" in points
    }
    return points.assign(**columns)


def _draw_trend(ax, points, column):
    """Draw the least-squares parabola; returns its R2 for the title, None where points that stand
    are too few."""
    drift, value = (marks.numbers(points, name) for name in ("max_drift_pct", column))
    known = np.isfinite(drift) & np.isfinite(value) & ~marks.fallen(points)
    drift = drift[known]
    value = value[known]
    if np.unique(drift).size < TREND_POINTS:
        return None
    trend, held = nonnegative_parabola(drift, value)
    along = np.linspace(drift.min(), drift.max(), 200)
    ax.plot(along, trend(along), color=BLUE, lw=1.0, zorder=5)
    rest = np.mean((value - trend(drift)) ** 2)
    spread = np.var(value)
    return (
        f", trend{' held at 0 or above,' if held else ''} R² = {1 - rest / spread:.2f}"
        if spread > 0
        else ""
    )


def nonnegative_parabola(x, y):
    """The parabola of least squares among those that are nowhere negative between the least and the
    largest x.

    x, y: (n,).  Returns it as a function of x, and whether the free fit would have been negative
    somewhere.  On 0 <= t <= 1 these parabolas are (u + v t)² + w t (1 - t) with w >= 0 (Lukács): u
    and v of one sign, or of two.
    """
    free = np.polynomial.Polynomial.fit(x, y, 2)
    low = np.min(x)
    span = np.ptp(x)
    turns = [at for at in free.deriv().roots().real if low < at < low + span]
    if min(free(at) for at in (low, low + span, *turns)) >= 0:
        return free, False

    def held(parameters, at):
        t = (at - low) / span
        return (parameters[0] + parameters[1] * t) ** 2 + parameters[2] * t * (1 - t)

    size = np.max(np.abs(y)) or 1.0
    starts = [
        (begin, end - begin, 0.1) for begin in (0.1, 0.5, 1.0) for end in (-1.0, -0.3, 0.3, 1.0)
    ]
    fits = [
        least_squares(
            lambda p: held(p, x) - y / size,
            start,
            bounds=((-np.inf, -np.inf, 0), np.inf),
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
        )
        for start in starts
    ]
    best = min(fits, key=lambda fit: fit.cost).x
    return lambda at: size * held(best, at), True


def _record_handles(variant, names, markers, hollow):
    handles = []
    for name in names:
        for solver, points, (colour, mark) in (
            ("reference", variant.reference, (BLACK, {"marker": markers[name]})),
            ("YADE", variant.yade, (VERMILLION, {"marker": hollow[name], "mfc": "none"})),
        ):
            if len(points):
                label = f"{record_label(name)}: {solver}, {marks.describe_members(points)}"
                handles.append(line_handle(colour, label, line="", ms=5, **mark))
    return handles
