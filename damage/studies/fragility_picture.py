"""The picture of a wall's fragility: curves with confidence bounds, and the shares that they were fitted to."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from damage.draw.panels import add_heading, finish, grid, letter, record_label, slip_note
from damage.draw.style import BLACK, BLUE, GREEN, ORANGE, VERMILLION, styled
from damage.studies.fragility import CONFIDENCE, FEW_RECORDS, INTENSITIES, LEVELS, curve, exceeding, unit_of

_PANELS = {"max_DI": "maximum DI", "max_crack_width_mm": "maximum crack width [mm]", "max_psi": r"maximum $\Psi$"}
_BANDS = {"both": (0.15, "walls and records drawn anew"), "walls": (0.35, "walls drawn anew, records held")}
"""What is drawn anew: how dark, in words; the wider one first."""
_STYLES = ((BLUE, "o", "-"), (GREEN, "s", "--"), (ORANGE, "^", "-."))


def fragility_pictures(runs, fits, intensity="pga_g"):
    """(name, Figure) of every wall; runs, fits: of `damage.studies.fragility`."""
    return [(f"fragility_{wall}_{intensity}", fragility_picture(wall, runs[runs["wall"] == wall], ones, intensity))
            for wall, ones in fits.items()]


@styled
def fragility_picture(wall, runs, fits, intensity="pga_g"):
    """Panels by measure, a curve a level; runs: the rows of this wall; fits: its list of Fragility."""
    figure, axes = grid(1, len(_PANELS), 2.3)
    x = np.linspace(0.005, 1.08, 200) * runs[intensity].max()
    for number, (ax, (measure, label)) in enumerate(zip(axes[0], _PANELS.items())):
        handles = [_draw(ax, x, runs, one, style, intensity)
                   for one, style in zip([one for one in fits if one.measure == measure], _STYLES)]
        ax.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.1), ncols=1, title=None)
        letter(ax, number, label)
        ax.set(xlabel=INTENSITIES[intensity], xlim=(0, x[-1]), ylim=(-0.03, 1.03))
    axes[0, 0].set_ylabel("probability of exceeding")
    n_walls, records = runs["strength_seed"].nunique(), runs["record"].dropna().unique()
    add_heading(figure, f"{wall} wall, {len(runs)} runs: {n_walls} draws of the joints' strengths, coefficient of "
                f"variation {runs['strength_cov'].iloc[0]:g}", "; ".join(record_label(name) for name in records),
                slip_note(runs), few_note(len(records)))
    told = [Patch(facecolor="0.3", alpha=alpha, lw=0, label=f"{100 * CONFIDENCE:.0f} % confidence, {words}")
            for over, (alpha, words) in _BANDS.items() if any(one.bounds(x, over) is not None for one in fits)]
    return finish(figure, [
        Line2D([], [], color="0.3", label="lognormal fit"), *told,
        Line2D([], [], color="0.3", marker="o", ls="", ms=3, label="share of the runs at one intensity")], columns=2)


def few_note(n_records):
    """A line of the heading where the records are too few to bound what others would do, else ""."""
    return "" if n_records >= FEW_RECORDS else (
        f"{n_records} {'records are' if n_records != 1 else 'record is'} few: bounds over walls leave others out, "
        "and those over records are rough")


def _draw(ax, x, runs, one, style, intensity):
    """Shares, curve and bounds of one level; returns the legend's entry."""
    colour, marker, line = style
    shares = exceeding(runs, one.measure, one.level).groupby(runs[intensity]).mean()
    ax.plot(shares.index, shares, color=colour, marker=marker, ls="", ms=3, mec="none", alpha=0.8)
    told = f"> {one.level:g}"
    if np.isfinite(one.median):
        ax.plot(x, one.probability(x), color=colour, ls=line)
        for over, (alpha, _) in _BANDS.items():
            if (bounds := one.bounds(x, over)) is not None:
                ax.fill_between(x, *bounds, color=colour, alpha=alpha, lw=0)
        unit = unit_of(intensity)[1]
        told += (f": between {one.step[0]:#.3g} and {one.step[1]:#.3g} {unit}" if one.step else
                 f": median {one.median:#.3g} {unit}, dispersion {one.dispersion:.2f}")
    else:
        told += f": {one.n_exceeding} of {one.n_runs} runs"
    return Line2D([], [], color=colour, marker=marker, ls=line, ms=3, label=told)


@styled
def picture_after_damage(wall, shocks, table, intensity="pga_g"):
    """A panel for Psi of 1 and of 2, a curve for each class of the damage before; shocks, table: of one wall, of
    `damage.studies.after_damage`."""
    levels = LEVELS["max_psi"]
    figure, axes = grid(1, len(levels), 3.0)
    x = np.linspace(0.005, 1.08, 200) * shocks[intensity].max()
    for number, (ax, level) in enumerate(zip(axes[0], levels)):
        rows = table[(table["measure"] == "max_psi") & (table["level"] == level)]
        handles = [_draw_after(ax, x, shocks, row, style, intensity)
                   for (_, row), style in zip(rows.iterrows(), (*_STYLES, (VERMILLION, "v", ":"), (BLACK, "x", "-")))]
        ax.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1.1), ncols=1, borderaxespad=0)
        letter(ax, number, rf"$\Psi$ > {level:g}")
        ax.set(xlabel=INTENSITIES[intensity], xlim=(0, x[-1]), ylim=(-0.03, 1.03))
    axes[0, 0].set_ylabel("probability of exceeding")
    records = shocks["record"].dropna().unique()
    add_heading(figure, f"{wall} wall, {len(shocks)} shocks, by the damage before",
                "; ".join(record_label(name) for name in records), slip_note(shocks), few_note(len(records)))
    return finish(figure, [Line2D([], [], color="0.3", label="lognormal fit"), Line2D(
        [], [], color="0.3", marker="o", ls="", ms=3, label="share of the shocks at one intensity")], columns=2)


def _draw_after(ax, x, shocks, row, style, intensity):
    """Shares and curve of one class of the damage before; returns the legend's entry."""
    colour, marker, line = style
    mine, median = shocks[shocks["before"] == row["before"]], row[f"median_{unit_of(intensity)[0]}"]
    shares = exceeding(mine, row["measure"], row["level"]).groupby(mine[intensity].round(6)).mean()
    ax.plot(shares.index, shares, color=colour, marker=marker, ls="", ms=3, mec="none", alpha=0.8)
    told = f"{row['before']}: {row['exceeding']} of {row['runs']} shocks"
    if np.isfinite(median):
        ax.plot(x, curve(x, median, row["dispersion"]), color=colour, ls=line)
        told = f"{row['before']}: median {median:#.3g} {unit_of(intensity)[1]}, dispersion {row['dispersion']:.2f}"
    return Line2D([], [], color=colour, marker=marker, ls=line, ms=3, label=told.replace("Psi", r"$\Psi$"))
