"""Figure of sequences: the damage index of a wall after each event, from a study's histories."""

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

from damage.draw import panels
from damage.draw.style import BLACK, BLUE, GREEN, MEDIUM, styled
from damage.measure.tables import shocks_table
from paper.results import REFERENCE

_LINES = {  # column of the table of shocks: label, style
    "max_DI": ("maximum DI", {"color": BLACK, "marker": "D"}),
    "residual_DI": ("residual DI", {"color": BLACK, "marker": "D", "mfc": "none", "ls": "--"}),
    "max_shear_limit_DI": ("maximum, slip by the shear limit", {"color": BLUE, "marker": "o"}),
    "residual_shear_limit_DI": ("residual, slip by the shear limit",
                                {"color": BLUE, "marker": "o", "mfc": "none", "ls": "--"}),
    "max_DI_drift": (r"maximum DI$_\mathrm{drift}$", {"color": GREEN, "marker": "^"}),
}


@styled
def sequences(results, points):
    """Maximum and residual index of every shock, a panel a sequence: medians over a point's runs, and ranges.

    Shocks that a fallen wall did not live to see are not there.
    """
    figure, axes = panels.grid(-(-len(points) // 2), 2, 1.9, sharex=False)
    for number, (ax, (_, point)) in enumerate(zip(axes.flat, points.iterrows())):
        tables = pd.concat([shocks_table(history) for history in results.histories(point)])
        factors = list(tables.groupby("shock")["factor"].first())
        text = f"{len(factors)} times" if len(set(factors)) == 1 else "times " + ", ".join(f"{f:g}" for f in factors)
        panels.letter(ax, number, f"{panels.motion_label(point)}, {text}")
        _draw(ax, tables)
        ax.set_ylabel("damage index [-]")
        ax.set_xlabel("shock")
        panels.from_zero(ax, panels.NOTHING)
    for ax in axes.flat[len(points):]:
        ax.set_axis_off()
    solver = "reference solver" if points["solver"].iloc[0] == REFERENCE else "YADE"
    panels.add_heading(figure, f"Damage index shock by shock: {' and '.join(points['wall'].unique())} wall",
                f"{solver}, {panels.describe_members(points)}; residual: after each shock's rest and settling",
                panels.slip_note(points), panels.scale_note(axes))
    handles = [Line2D([], [], ms=3.2, lw=0.9, label=label, **style) for label, style in _LINES.values()]
    return panels.finish(figure, handles, columns=3)


def _draw(ax, tables):
    by_shock = tables.groupby("shock")
    for column, (_, style) in _LINES.items():
        values = by_shock[column].agg(["median", "min", "max"]).dropna()
        spread = np.array([values["median"] - values["min"], values["max"] - values["median"]])
        ax.errorbar(values.index, values["median"], spread if spread.any() else None, ms=3.2, lw=0.9,
                    ecolor=MEDIUM, elinewidth=0.8, capsize=1.6, **style)
    ax.set_xticks(sorted(tables["shock"].unique()))
