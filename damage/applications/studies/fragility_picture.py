"""The picture of a wall's fragility: curves with confidence bounds, and the shares that they were
fitted to."""

from itertools import cycle

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from damage.applications.studies.fragility import exceeding, few_note
from damage.applications.studies.new_record import CONFIDENCE
from damage.applications.studies.states import LEVELS, label, unit_of
from damage.draw.panels import finish, grid, letter
from damage.draw.style import BLACK, BLUE, GREEN, ORANGE, VERMILLION, put_title, styled
from damage.draw.words import record_label

_BANDS = {
    "new record": (0.13, "interval of a new record's own curve"),
    "mean curve": (0.35, "interval of the mean curve, strengths and records drawn anew"),
}
"""What lies in a band: how dark, in words; the wider one first."""
STYLES = (
    (BLUE, "o", "-"),
    (GREEN, "s", "--"),
    (ORANGE, "^", "-."),
    (VERMILLION, "v", ":"),
    (BLACK, "x", "-"),
)


def fragility_pictures(runs, fits):
    """(name, Figure) of every wall; runs, fits: of `damage.applications.studies.fragility`."""
    return [
        (
            f"fragility_{wall}_{of_wall[0].intensity}",
            fragility_picture(wall, runs[runs["wall"] == wall], of_wall),
        )
        for wall, of_wall in fits.items()
    ]


@styled
def fragility_picture(wall, runs, fits):
    """Panels by measure, a curve a damage state; runs: the rows of this wall; fits: its list of
    Fragility."""
    measures = list(dict.fromkeys(fit.measure for fit in fits))
    columns = min(len(measures), 3)
    figure, axes = grid(-(-len(measures) // columns), columns, 2.5)
    for ax in axes.flat[len(measures) :]:
        ax.set_axis_off()
    kinds = set()
    for number, (ax, measure) in enumerate(zip(axes.flat, measures)):
        kinds |= _panel(ax, runs, [fit for fit in fits if fit.measure == measure])
        text = label(measure)
        letter(ax, number, text.removesuffix(" [-]") if measure in LEVELS else text)
    axes[0, 0].set_ylabel("probability of exceeding")
    n_walls = runs["strength_seed"].nunique()
    records = runs["record"].dropna().unique()
    put_title(
        figure,
        f"{wall} wall, {len(runs)} runs: {n_walls} draws of the joints' strengths, coefficient of "
        f"variation {runs['strength_cov'].iloc[0]:g}",
        f"{len(records)} records" if len(records) > 9 else "; ".join(map(record_label, records)),
        few_note(len(records)),
    )
    shares = "share of the runs at one intensity"
    fitted = [
        Line2D([], [], color="0.3", label="lognormal fit to all records"),
        Line2D([], [], color="0.3", marker="o", ls="", ms=3, label=shares),
    ]
    bands = [
        Patch(facecolor="0.3", alpha=alpha, lw=0, label=f"{100 * CONFIDENCE:.0f} % {text}")
        for kind, (alpha, text) in _BANDS.items()
        if kind in kinds
    ]
    return finish(figure, [*fitted, *bands], columns=2)


def _panel(ax, runs, fits):
    """Draw the curves of one measure; returns the kinds of bands that are drawn, a set."""
    intensity = fits[0].intensity
    x = np.linspace(0.005, 1.08, 120) * runs[intensity].max()
    handles, kinds = zip(
        *(_draw(ax, x, runs, fit, *style) for fit, style in zip(fits, cycle(STYLES)))
    )
    ax.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.1), ncols=1, title=None)
    ax.set(xlabel=label(intensity), xlim=(0, x[-1]), ylim=(-0.03, 1.03))
    return set().union(*kinds)


def _draw(ax, x, runs, fit, colour, marker, line):
    """Draw shares, curve and bounds of a Fragility; returns the legend's entry, and the names of
    the bands drawn."""
    exceeds = exceeding(runs, fit.measure, fit.level)
    shares = exceeds.groupby(runs[fit.intensity]).mean()
    ax.plot(shares.index, shares, color=colour, marker=marker, ls="", ms=3, mec="none", alpha=0.8)
    entry = (fit.name and f"{fit.name}: ") + f"> {fit.level:g}"
    drawn = []
    if np.isfinite(fit.median):
        ax.plot(x, fit.probability(x), color=colour, ls=line)
        new = fit.new_record
        bands = {"new record": new.bounds(x) if new else None, "mean curve": fit.bounds(x)}
        for kind, bounds in bands.items():
            if bounds is not None:
                ax.fill_between(x, *bounds, color=colour, alpha=_BANDS[kind][0], lw=0)
                drawn.append(kind)
        unit = unit_of(fit.intensity)
        entry += (
            f": between {fit.step[0]:#.3g} and {fit.step[1]:#.3g} {unit}"
            if fit.step
            else f": median {fit.median:#.3g} {unit}, dispersion {fit.dispersion:.2f}"
        )
        if fit.new_record:
            entry += "\nof a new record {:#.2g} to {:#.2g} {}".format(*fit.new_record_bounds, unit)
    else:
        entry += f": no curve, {fit.n_exceeding} of {fit.n_runs} runs exceed it"
        entry += f"\n{fit.why}" if 0 < fit.n_exceeding < fit.n_runs else ""
    return Line2D([], [], color=colour, marker=marker, ls=line, ms=3, label=entry), drawn
