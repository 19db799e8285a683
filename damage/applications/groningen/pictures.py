"""Pictures at an address: the PGV of every event over time and on a map; lives of a wall, what each
event did."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from damage.applications.groningen.exposure.places import TOWNS, to_rd
from damage.draw import style
from damage.draw.panels import from_zero, letter

FROM_MM_S = 0.1
"""Median PGV from which events are drawn in the picture [mm/s]: nobody feels less."""
DOT_SIZE = 6  # area of a dot on the map over its PGV [points² / (mm/s)]
_NAMED = 3  # events whose places are named
_HALO = [withStroke(linewidth=1.5, foreground="white")]


@style.styled
def exposure_picture(exposure):
    """Figure of a `damage.applications.groningen.exposure.exposure.Exposure`: medians with the
    value that 1 % exceed over time, and a map whose dots grow with the median PGV at the place."""
    table = exposure.table()
    table = table.assign(x_km=table["easting_rd_m"] / 1e3, y_km=table["northing_rd_m"] / 1e3)
    shown = table[table["median_mm_s"] >= FROM_MM_S].sort_values("median_mm_s")
    first, last = exposure.catalogue.years
    figure = Figure(figsize=(style.COLUMN_WIDTH, 1.8 * style.COLUMN_WIDTH), layout="constrained")
    time, ground = figure.subplots(2, 1, height_ratios=(1, 1.3))
    named = list(shown[::-1].head(_NAMED).itertuples())
    _over_time(time, shown, named)
    time.set_xlim(np.datetime64(f"{first}"), np.datetime64(f"{last + 1}"))
    _on_a_map(ground, exposure.place, table, shown, named)
    style.put_title(
        figure,
        (
            f"Latitude {exposure.place.latitude:.4f}, longitude {exposure.place.longitude:.4f}: PGV"
            f" ({exposure.model.component}) of {len(table)} events, {first} to {last}, {len(shown)}"
            f" of them with a median from {FROM_MM_S:g} mm/s"
        ),
        "; ".join(
            f"{k}: {event.place} {event.time_utc[:4]}, M {event.magnitude:g}"
            for k, event in enumerate(named, 1)
        ),
    )
    return figure


def _over_time(ax, shown, named):
    when = shown["time_utc"].to_numpy().astype("datetime64[s]")
    ax.vlines(
        when, shown["median_mm_s"], shown["one_percent_mm_s"], color=style.MEDIUM, lw=0.5, zorder=1
    )
    ax.plot(when, shown["median_mm_s"], "o", color=style.BLUE, ms=2.2, mew=0, zorder=2)
    for number, event in enumerate(named, 1):
        ax.annotate(
            f"{number}",
            (np.datetime64(event.time_utc), event.one_percent_mm_s),
            (0, 1.5),
            ha="center",
            textcoords="offset points",
        )
    ax.set(yscale="log", ylabel="PGV [mm/s]")
    ax.set_ylim(bottom=FROM_MM_S)
    ax.yaxis.set_major_formatter("{x:g}")
    ax.legend(
        handles=[
            style.line_handle(style.BLUE, "median", line="", marker="o", ms=2.2),
            style.line_handle(style.MEDIUM, "up to what is exceeded with 1 %", 0.8),
        ],
        ncols=2,
        loc="lower left",
        bbox_to_anchor=(0, 1),
    )


def _on_a_map(ax, place, table, shown, named):
    star = {"marker": "*", "mec": style.BLACK, "mew": 0.3, "ms": 8}
    ax.plot(table["x_km"], table["y_km"], ".", color="0.8", ms=1, zorder=1)
    ax.scatter(
        shown["x_km"],
        shown["y_km"],
        DOT_SIZE * shown["median_mm_s"],
        color=style.BLUE,
        lw=0.3,
        edgecolor="white",
        alpha=0.8,
        zorder=2,
    )
    place_km = place.x_m / 1e3, place.y_m / 1e3
    ax.plot(*place_km, ls="", color=style.VERMILLION, zorder=4, clip_on=False, **star)
    for number, event in enumerate(named, 1):
        ax.annotate(
            f"{number}",
            (event.x_km, event.y_km),
            ha="center",
            va="center",
            color="white",
            fontsize="x-small",
            zorder=3,
            bbox={"boxstyle": "circle,pad=0.15", "facecolor": style.BLACK, "linewidth": 0},
        )
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(color=style.LIGHT, lw=0.5)
    _towns(ax)
    ax.set(xlabel="easting, RD [km]", ylabel="northing, RD [km]")
    sizes = [pgv for pgv in (1, 2, 5, 20) if pgv <= 1.5 * table["median_mm_s"].max()]
    ax.legend(
        handles=[
            style.line_handle(style.VERMILLION, "the place", line="", **star | {"ms": 6}),
            style.line_handle("0.8", "weaker", line="", marker=".", ms=2),
            *(
                style.line_handle(
                    style.BLUE,
                    f"median {pgv:g} mm/s",
                    line="",
                    marker="o",
                    ms=np.sqrt(DOT_SIZE * pgv),
                    mew=0,
                )
                for pgv in sizes
            ),
        ],
        loc="upper right",
        labelspacing=0.9,
    )


def _towns(ax):
    """Names of the towns within what the axes show, which stays as it is, on the map."""
    ax.apply_aspect()
    (left, right) = ax.get_xlim()
    (low, high) = ax.get_ylim()
    ax.set(xlim=(left, right), ylim=(low, high))
    for name, *degrees in pd.read_csv(TOWNS).itertuples(index=False):
        x, y = (value / 1e3 for value in to_rd(*degrees))
        if left < x < right and low < y < high:
            ax.plot(x, y, "s", color=style.DARK, ms=2, mew=0, zorder=3)
            below = name == "Appingedam"  # Delfzijl is beside it
            ax.annotate(
                name,
                (x, y),
                (2, -6.5 if below else 1.5),
                textcoords="offset points",
                color=style.DARK,
                fontsize="small",
                zorder=3,
                path_effects=_HALO,
                clip_on=True,
            )


SECONDS_OF_A_YEAR = 31556952.0
LINES = {
    "max_psi_1": (style.BLUE, "--", "visible at some moment"),
    "psi_1": (style.BLUE, "-", "visible afterwards"),
    "max_psi_2": (style.VERMILLION, "--", r"$\Psi \geq 2$ at some moment"),
    "psi_2": (style.VERMILLION, "-", r"$\Psi \geq 2$ afterwards"),
}
"""{column of life.csv: (colour, dashes, words)}."""
_MOST_EVENTS = 8


@style.styled
def life_picture(table, yearly, alone, title):
    """Figure over the years: Psi at rest after each event of every life, and its median; the
    probabilities of visible damage with their intervals; and, where alone (of `Lives.until`) is
    given, which share of its walls ends with a Psi or less, with all events and with the largest
    alone.  table, yearly: of `damage.applications.groningen.life.results`."""
    figure, axes = style.new_figure(1.8 * style.COLUMN_WIDTH, 2 if alone is None else 3)
    years = yearly["year"].iloc[0], yearly["year"].iloc[-1] + 1
    _every_life(axes[0], table, yearly, years)
    _damaged_walls(axes[1], yearly)
    for ax in axes[:2]:
        ax.set_xlim(years)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=8))
    if alone is not None:
        _psi_at_the_end(axes[2], table, alone)
    style.put_title(figure, title)
    return figure


def _every_life(ax, table, yearly, years):
    for _, life in table.groupby(["seed", "life"]):
        seconds = life["time_utc"].to_numpy().astype("datetime64[s]").astype(np.int64)
        ax.plot(
            [years[0], *(1970 + seconds / SECONDS_OF_A_YEAR), years[1]],
            [0.0, *life["psi"], life["psi"].iloc[-1]],
            drawstyle="steps-post",
            color=style.MEDIUM,
            lw=0.3,
            alpha=0.6,
        )
    settled = table.loc[table["event"] == 0, "psi"]
    ax.plot(
        [years[0], *(yearly["year"] + 1)],
        [settled.median() if len(settled) else 0.0, *yearly["median_psi"]],
        color=style.BLACK,
        lw=1.2,
    )
    ax.axhline(1.0, color=style.BLUE, lw=0.5, ls=":")
    ax.set_ylabel(r"$\Psi$ at rest [-]")
    letter(ax, 0, "every life, and the median; dotted: just visible")
    from_zero(ax)


def _damaged_walls(ax, yearly):
    year = yearly["year"] + 1
    for outcome, (colour, dashes, label) in LINES.items():
        name = f"p_{outcome}"
        ax.fill_between(
            year, yearly[f"{name}_low"], yearly[f"{name}_high"], color=colour, alpha=0.12, lw=0
        )
        ax.plot(year, yearly[name], color=colour, ls=dashes, label=label)
    ax.set(ylabel="share of walls [-]", xlabel="year", ylim=(0, 1))
    ax.legend(loc="upper left")
    letter(ax, 1, "walls that are damaged, with 95 % intervals")


def _psi_at_the_end(ax, table, alone):
    """Draw which share of the walls of `alone` ends with a Psi or less."""
    final = table.groupby(["seed", "life"])["psi"].last()
    for values, colour, label in (
        (final[final.index.isin(alone.index)], style.BLACK, "all events"),
        (alone["psi"], style.GREEN, "the largest event alone"),
    ):
        finite = np.sort(np.asarray(values, float))
        ax.plot(
            finite,
            (np.arange(len(finite)) + 1) / len(finite),
            drawstyle="steps-post",
            color=colour,
            label=label,
        )
    ax.set(xlabel=r"$\Psi$ at the end [-]", ylabel="share of walls [-]", ylim=(0, 1))
    ax.legend(loc="lower right")
    letter(ax, 2, r"share of walls that end with this $\Psi$ or less")


@style.styled
def contributions_picture(table, title):
    """Figure of the events that contribute most: their share of the increase of Psi over all lives.
    table: of `damage.applications.groningen.life.results.contributions`."""
    figure, ax = style.new_figure(0.8 * style.COLUMN_WIDTH)
    shown = table.head(_MOST_EVENTS).iloc[::-1]
    ax.barh(
        [
            (
                row.place
                if np.isnan(row.magnitude)
                else f"{row.place} {row.time_utc[:4]}, M {row.magnitude:g}"
            )
            for row in shown.itertuples()
        ],
        shown["share"],
        color=style.BLUE,
    )
    ax.set_xlabel(r"share of the increase of $\Psi$ at rest [-]")
    style.put_title(figure, title)
    return figure
