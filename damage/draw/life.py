"""Pictures of the lives of a wall: Psi and the probability of visible damage by year, and what each event did."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from damage.draw.panels import from_zero, letter
from damage.draw.style import BLACK, BLUE, COLUMN_WIDTH, GREEN, MEDIUM, VERMILLION, new_figure, styled

SECONDS_OF_A_YEAR = 31556952.0
LINES = {"max_psi_1": (BLUE, "--", "visible at some moment"), "psi_1": (BLUE, "-", "visible afterwards"),
         "max_psi_2": (VERMILLION, "--", r"$\Psi \geq 2$ at some moment"),
         "psi_2": (VERMILLION, "-", r"$\Psi \geq 2$ afterwards")}
"""{column of life.csv: (colour, dashes, words)}."""
_MOST_EVENTS = 8


@styled
def life_picture(table, yearly, alone, title):
    """Figure over the years: Psi at rest after each event of every life, and its median; the probabilities of visible
    damage with their intervals; and, where alone (of `Lives.until`) is given, which share of its walls ends with a Psi
    or less, with all events and with the largest alone.  table, yearly: of `damage.life.results`."""
    figure, axes = new_figure(1.8 * COLUMN_WIDTH, 2 if alone is None else 3)
    psi, probability = axes[:2]
    first, last = yearly["year"].iloc[0], yearly["year"].iloc[-1] + 1
    final = []
    for key, life in table.groupby(["seed", "life"]):
        seconds = life["time_utc"].to_numpy().astype("datetime64[s]").astype(np.int64)
        times = [first, *(1970 + seconds / SECONDS_OF_A_YEAR), last]
        end = life["psi"].iloc[-1]
        if alone is None or key in alone.index:
            final.append(end)
        psi.plot(times, [0.0, *life["psi"], end], drawstyle="steps-post", color=MEDIUM, lw=0.3, alpha=0.6)
    settled = table.loc[table["event"] == 0, "psi"]
    psi.plot([first, *(yearly["year"] + 1)], [settled.median() if len(settled) else 0.0, *yearly["median_psi"]],
             color=BLACK, lw=1.2)
    psi.axhline(1.0, color=BLUE, lw=0.5, ls=":")
    psi.set_ylabel(r"$\Psi$ at rest [-]")
    letter(psi, 0, "every life, and the median; dotted: just visible")
    for outcome, (colour, dashes, label) in LINES.items():
        year, name = yearly["year"] + 1, f"p_{outcome}"
        probability.fill_between(year, yearly[f"{name}_low"], yearly[f"{name}_high"], color=colour, alpha=0.12, lw=0)
        probability.plot(year, yearly[name], color=colour, ls=dashes, label=label)
    probability.set(ylabel="share of walls [-]", xlabel="year", ylim=(0, 1))
    probability.legend(loc="upper left")
    letter(probability, 1, "walls that are damaged, with 95 % intervals")
    from_zero(psi)
    for ax in (psi, probability):
        ax.set_xlim(first, last)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=8))
    if alone is not None:
        for values, colour, label in ((final, BLACK, "all events"), (alone["psi"], GREEN, "the largest event alone")):
            finite = np.sort(np.asarray(values, float))
            axes[2].plot(finite, (np.arange(len(finite)) + 1) / len(finite), drawstyle="steps-post", color=colour,
                         label=label)
        axes[2].set(xlabel=r"$\Psi$ at the end [-]", ylabel="share of walls [-]", ylim=(0, 1))
        axes[2].legend(loc="lower right")
        letter(axes[2], 2, r"share of walls that end with this $\Psi$ or less")
    figure.suptitle(title, x=0.02, ha="left")
    return figure


@styled
def contributions_picture(table, title):
    """Figure of the events that contribute most: their share of the increase of Psi over all lives.  table: of
    `damage.life.results.contributions`."""
    figure, ax = new_figure(0.8 * COLUMN_WIDTH, 1)
    ax = np.ravel(ax)[0]
    shown = table.head(_MOST_EVENTS).iloc[::-1]
    ax.barh([row.place if np.isnan(row.magnitude) else f"{row.place} {row.time_utc[:4]}, M {row.magnitude:g}"
             for row in shown.itertuples()], shown["share"], color=BLUE)
    ax.set_xlabel(r"share of the increase of $\Psi$ at rest [-]")
    figure.suptitle(title, x=0.02, ha="left")
    return figure
