"""Figures 6 to 9 of Sarhosis et al. (2021), doi:10.1016/j.engstruct.2021.112529, from a study's
tables: harmonic motions, and what they do to a wall.

Each function returns a Figure, or raises Missing when there is nothing to draw.
"""

import numpy as np
from matplotlib.patches import Patch

from damage.draw import panels
from damage.draw.style import (
    BLACK,
    BLUE,
    LIGHT,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    line_handle,
    put_title,
    shade_settling,
    styled,
)
from damage.measure.cycles import drift_cycles
from damage.measure.damage_index import CRITERIA
from damage.motion.loading import Harmonic
from damage.units import GRAVITY
from paper import marks
from paper.criteria import AMPLITUDES_G
from paper.printed import cycle_length_s, largest_di, star, star_handles
from paper.results import REFERENCE, Missing

EVOLUTION = ((0.33, 0.025), (0.33, 0.1), (0.2, 0.025), (0.2, 0.1))
"""Period [s] and amplitude [g] of the motions whose index the paper shows over time."""
AMPLITUDE_COLOURS = (BLACK, BLUE, ORANGE, PURPLE, VERMILLION)
PERFORATED_PERIOD_S = 0.2
"""Natural period of the paper's walls with an opening [s], where the tables do not give it."""
SAME = 1e-6  # [s] or [g]: two periods or amplitudes that are one


@styled
def motions(points):
    """Figure 6: base acceleration over time, a panel a period, a line an amplitude."""
    cases = points.drop_duplicates(["motion_period_s", "amplitude_g", "cycles"])
    periods = np.unique(cases["motion_period_s"])
    figure, axes = panels.grid(len(periods), 1, 1.25)
    amplitudes = np.unique(cases["amplitude_g"])
    colours = dict(zip(amplitudes, AMPLITUDE_COLOURS * len(amplitudes)))
    for number, (ax, period_s) in enumerate(zip(axes[:, 0], periods)):
        for case in (
            cases[cases["motion_period_s"] == period_s].sort_values("amplitude_g").itertuples()
        ):
            motion = Harmonic(period_s, case.amplitude_g, int(case.cycles))
            time_s = np.linspace(0, motion.duration_s, 60 * int(case.cycles) + 1)
            ax.plot(
                time_s,
                motion.base_acceleration(time_s)[:, 0] / GRAVITY,
                color=colours[case.amplitude_g],
            )
        panels.letter(ax, number, f"period {period_s:g} s")
        ax.set_ylabel("acceleration [g]")
        ax.margins(x=0)
    axes[-1, 0].set_xlabel("time [s]")
    put_title(figure, "Harmonic base motions", marks.scale_note(axes))
    return panels.finish(figure, [line_handle(colours[a], f"{a:g} g") for a in amplitudes], 5)


@styled
def evolution(results, variant):
    """Figure 7: the damage index and its components over time, for the paper's four motions.

    Lines are a point's first run; the band is the range of DI over all its runs, where their
    histories are there.
    """
    shown = [
        (period_s, amplitude_g, _at(variant.points, period_s, amplitude_g))
        for period_s, amplitude_g in EVOLUTION
    ]
    if all(len(points) == 0 for *_, points in shown):
        raise Missing("no point at 0.33 or 0.2 s with 0.025 or 0.1 g")
    figure, axes = panels.grid(2, 2, 1.9)
    handles = marks.component_handles(slip_marker=False)
    for number, (ax, (period_s, amplitude_g, points)) in enumerate(zip(axes.flat, shown)):
        panels.letter(
            ax, number, f"{period_s:g} s, {amplitude_g:g} g" + ("" if len(points) else ": no run")
        )
        if len(points) == 0:
            ax.set_axis_off()
            continue
        ax.set(xlabel="time [s]", ylabel="damage index [-]")
        for _, point in points.iterrows():
            _draw_evolution(ax, results, point)
        panels.from_zero(ax)
        ax.margins(x=0)
    handles.append(line_handle(BLACK, "DI, slip by the shear limit", 0.6, "--"))
    if len(variant.reference) and len(variant.yade):
        handles.append(line_handle(PURPLE, "DI, YADE", 0.7))
    if variant.reference["members"].max() > 1:
        handles.append(Patch(color="0.8", label="range of DI over runs"))
    handles.append(Patch(color=LIGHT, label="settling"))
    put_title(
        figure,
        f"Damage index over time: {variant.title}",
        "components: first run of each motion,"
        f" {'reference solver' if len(variant.reference) else 'YADE'}",
        marks.scale_note(axes),
    )
    return panels.finish(figure, handles)


def _draw_evolution(ax, results, point):
    """The index of one point over time; of YADE the index alone where the components are there
    already."""
    table = results.index(point)
    if point["solver"] != REFERENCE and ax.lines:
        ax.plot(table["time_s"], table["DI"], color=PURPLE, lw=0.7, zorder=3)
        return
    _draw_band(ax, results, point, lambda history: history.index()["DI"])
    shade_settling(ax, table)
    for name, (_, colour, _) in list(marks.COMPONENTS.items())[::-1]:
        ax.plot(table["time_s"], table[name], color=colour, lw=1.6 if name == "DI" else 0.8)
    if "shear_limit_DI" in table:
        ax.plot(table["time_s"], table["shear_limit_DI"], color=BLACK, lw=0.6, ls="--")


def _draw_band(ax, results, point, value, until_s=np.inf):
    """Range over the members of a point of a value over time, where two histories or more are
    there."""
    histories = results.histories(point)
    if len(histories) < 2:
        return
    time_s = histories[0].series["time_s"].to_numpy()
    time_s = time_s[time_s <= until_s]
    values = np.array(
        [
            np.interp(time_s, history.series["time_s"], value(history), right=np.nan)
            for history in histories
        ]
    )
    ax.fill_between(
        time_s, np.nanmin(values, axis=0), np.nanmax(values, axis=0), color="0.8", lw=0, zorder=1
    )


@styled
def against_amplitude(results, variant, slip="displacement"):
    """Figure 8: left maximum, right residual index and components against amplitude, a row a
    period; with what the paper's text prints of them."""
    periods = np.unique(variant.points["motion_period_s"])
    figure, axes = panels.grid(len(periods), 2, 1.55, sharex=True, sharey="row")
    collapsed = False
    for row, (first, period_s) in zip(axes, zip(range(0, axes.size, 2), periods)):
        for number, (ax, state) in enumerate(zip(row, ("max", "residual")), first):
            panels.letter(
                ax, number, f"{'maximum' if state == 'max' else 'residual'}, {period_s:g} s"
            )
            reference, yade = (
                _at(points, period_s) for points in (variant.reference, variant.yade)
            )
            collapsed |= marks.draw_components(
                ax, reference, yade, "amplitude_g", f"{state}_{CRITERIA[slip]}"
            )
        star(row[0], AMPLITUDES_G[-1], largest_di(variant, period_s))
        row[0].set_ylabel("damage index [-]")
        panels.from_zero(row[0], marks.NOTHING)
    printed = [period_s for period_s in periods if largest_di(variant, period_s) is not None]
    for ax in axes[-1]:
        ax.set_xlabel("amplitude [g]")
    put_title(
        figure,
        f"Damage index against amplitude: {variant.title}",
        marks.SLIP_LABELS[slip],
        marks.scale_note(axes[:, 0]),
    )
    return marks.finish_components(figure, variant, collapsed, star_handles(printed))


@styled
def drifts(results, variant):
    """Figure 9: drift ratio over time at resonance, a panel an amplitude, the last full cycle in
    red.

    Resonance: the period nearest to that of the intact wall, or to 0.2 s where the tables lack it.
    """
    points = variant.points
    eigen_s = marks.numbers(points, "eigen_period_s")
    off = np.abs(
        points["motion_period_s"] - next(iter(eigen_s[np.isfinite(eigen_s)]), PERFORATED_PERIOD_S)
    )
    points = points[off < off.min() + SAME]
    amplitudes = np.unique(points["amplitude_g"])
    figure, axes = panels.grid(len(amplitudes), 1, 1.15, sharex=True)
    period_s = points["motion_period_s"].iloc[0]
    marked = set()
    for number, (ax, amplitude_g) in enumerate(zip(axes[:, 0], amplitudes)):
        panels.letter(ax, number, f"{amplitude_g:g} g")
        for _, point in _at(points, period_s, amplitude_g).iterrows():
            marked |= _draw_drift(ax, results, point)
        if (paper_s := cycle_length_s(variant, amplitude_g)) is not None and ax.get_title(
            loc="right"
        ):
            ax.set_title(
                f"{ax.get_title(loc='right')}, paper {paper_s:.2f} s",
                loc="right",
                color=VERMILLION,
                fontsize=7,
            )
        ax.set_ylabel("drift ratio [%]")
        ax.ticklabel_format(axis="y", style="plain", useOffset=False)
        ax.margins(x=0)
    axes[-1, 0].set_xlabel("time [s]")
    put_title(
        figure,
        f"Drift ratio over time, motion of {period_s:g} s: {variant.title}",
        "T: duration of the last full cycle, the last that begins while the base moves",
        marks.scale_note(axes),
    )
    first = "reference solver, first run" if len(variant.reference) else "YADE"
    handles = [line_handle(SKY, first, 1.5)]
    if len(variant.reference) and len(variant.yade):
        handles.append(line_handle(BLACK, "YADE", 0.6))
    if "cycle" in marked:
        handles.append(line_handle(VERMILLION, "last full cycle", 1.3, "--"))
    if "collapse" in marked:
        handles.append(line_handle(VERMILLION, "collapse", line="", marker="x", ms=6))
    if variant.reference["members"].max() > 1:
        handles.append(Patch(color="0.8", label="range over runs"))
    return panels.finish(figure, handles)


def _draw_drift(ax, results, point):
    """Drift of a point's first run without settling; returns what is marked, "cycle" and
    "collapse".

    Only the run that is drawn first has its last cycle marked.
    """
    history = results.history(point)
    time_s = history.moving["time_s"]
    drift_pct = 100 * history.moving["drift_ratio"]
    marked = set()
    if history.collapsed_at_s is not None:
        ax.plot(time_s.iloc[-1], drift_pct.iloc[-1], "x", color=VERMILLION, ms=6, zorder=7)
        marked.add("collapse")
    if len(ax.lines) > len(marked):
        ax.plot(time_s, drift_pct, color=BLACK, lw=0.6, zorder=5)
        return marked
    _draw_band(ax, results, point, lambda each: 100 * each.series["drift_ratio"], time_s.iloc[-1])
    ax.plot(time_s, drift_pct, color=SKY, lw=1.5, zorder=3)
    driven, _ = drift_cycles(history)
    if len(driven) == 0:
        return marked
    within = time_s.between(*driven[-1])
    ax.plot(time_s[within], drift_pct[within], color=VERMILLION, ls="--", lw=1.2, zorder=6)
    low, high = (point.get(f"last_cycle_s_{end}", np.nan) for end in ("min", "max"))
    spread = f" ({low:.2f} to {high:.2f} s)" if point["members"] > 1 and np.isfinite(low) else ""
    ax.set_title(
        f"T = {np.ptp(driven[-1]):.2f} s{spread}", loc="right", color=VERMILLION, fontsize=7
    )
    return marked | {"cycle"}


def _at(points, period_s, amplitude_g=None):
    """The points of one period, and of one amplitude where it is given."""
    same = np.abs(points["motion_period_s"] - period_s) < SAME
    return (
        points[same & (np.abs(points["amplitude_g"] - amplitude_g) < SAME)]
        if amplitude_g
        else points[same]
    )
