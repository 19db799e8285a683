"""Picture of the lives of a wall: Psi over the years, and the probability that damage is visible."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from damage.draw.panels import from_zero, letter
from damage.draw.style import BLACK, BLUE, COLUMN_WIDTH, MEDIUM, VERMILLION, new_figure, styled

SECONDS_OF_A_YEAR = 31556952.0
LINES = {"1": (BLUE, r"$\Psi \geq 1$: visible"), "2": (VERMILLION, r"$\Psi \geq 2$")}


@styled
def life_picture(table, yearly, title):
    """Figure over the years: Psi at rest after each event of every life, and its median; below, the probabilities of
    visible damage with their intervals.  table, yearly: of `damage.life.runs`."""
    figure, (psi, probability) = new_figure(1.3 * COLUMN_WIDTH, 2, sharex=True)
    first, last = yearly["year"].iloc[0], yearly["year"].iloc[-1] + 1
    for _, life in table.groupby("life"):
        seconds = life["time_utc"].to_numpy().astype("datetime64[s]").astype(np.int64)
        times = [first, *(1970 + seconds / SECONDS_OF_A_YEAR), last]
        psi.plot(times, [0.0, *life["psi"], life["psi"].iloc[-1]], drawstyle="steps-post", color=MEDIUM, lw=0.3,
                 alpha=0.6)
    psi.plot([first, *(yearly["year"] + 1)], [0.0, *yearly["median_psi"]], color=BLACK, lw=1.2)
    psi.set_ylabel(r"$\Psi$ [-]")
    letter(psi, 0, "every life, and the median at the end of each year")
    for level, (colour, label) in LINES.items():
        year, name = yearly["year"] + 1, f"p_psi_{level}"
        probability.fill_between(year, yearly[f"{name}_low"], yearly[f"{name}_high"], color=colour, alpha=0.15, lw=0)
        probability.plot(year, yearly[name], color=colour, label=label)
    probability.set(ylabel="probability [-]", xlabel="year", ylim=(0, 1), xlim=(first, last))
    probability.legend(loc="upper left")
    letter(probability, 1, "share of lives, with its 95 % interval")
    from_zero(psi)
    probability.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=8))
    figure.suptitle(title, x=0.02, ha="left")
    return figure
