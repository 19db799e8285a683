"""Picture of a sequence: what each event found, did and left."""

import numpy as np

from damage.draw.panels import from_zero, letter
from damage.draw.style import (
    BLACK,
    BLUE,
    COLUMN_WIDTH,
    MEDIUM,
    ORANGE,
    VERMILLION,
    add_title,
    legend_below,
    new_figure,
    styled,
)
from damage.measure.tables import shocks_table
from damage.units import GRAVITY


def has_sequence(history):
    """Whether a History has more than one event."""
    return len(history.series) > 0 and history.series["shock"].iloc[-1] > 1


@styled
def sequence_picture(history):
    """Figure over time: base acceleration; below, a step an event: Psi and DI, largest and residual; largest offset of
    the joints at rest; newly failed contact points."""
    table, series = shocks_table(history), history.series
    figure, (base, psi, index, offset, failed) = new_figure(2.0 * COLUMN_WIDTH, 5, sharex=True)
    base.plot(series["time_s"], series["base_acceleration_x_m_s2"] / GRAVITY, color=BLACK, lw=0.4)
    base.set_ylabel("base [g]")
    letter(base, 0, f"{len(table)} events")
    for number, (ax, name, label) in enumerate(((psi, "psi", r"$\Psi$ [-]"), (index, "DI", "DI [-]")), 1):
        largest, residual = _steps(ax, table, f"max_{name}", MEDIUM, "--"), _steps(ax, table, f"residual_{name}", BLACK)
        ax.set_ylabel(label)
        letter(ax, number, {"psi": "Psi of the cracks", "DI": "damage index"}[name])
    largest.set_label("largest in the event")
    residual.set_label("at rest after it")
    after = _steps(offset, table, "offset_after_mm", BLUE)
    after.set_label("largest offset at rest")
    offset.set_ylabel("offset [mm]")
    letter(offset, 3, "offset of the joints")
    bars = failed.bar(table["start_s"], table["newly_failed"], width=(table["end_s"] - table["start_s"]), align="edge",
                      color=ORANGE, edgecolor="white", lw=0.3, label="newly failed")
    failed.set_ylabel("contact points")
    failed.set_xlabel("time [s]")
    letter(failed, 4, f"newly failed contact points, {int(table['newly_failed'].sum())} in all")
    for ax in (psi, index, offset, failed):
        from_zero(ax)
    for ax in (base, psi, index, offset, failed):
        ax.margins(x=0)
        for start in table["start_s"]:
            ax.axvline(start, color="0.88", lw=0.4, zorder=0)
    marks = [ax.axvline(history.collapsed_at_s, color=VERMILLION, lw=1, ls="--", label="collapse")
             for ax in (psi,) if history.collapsed_at_s is not None]
    add_title(figure, history)
    figure.align_ylabels()
    legend_below(figure, [largest, residual, after, bars, *marks], columns=2)
    return figure


def _steps(ax, table, column, colour, line="-"):
    """Draw a value an event, constant from its start to its end; returns the line."""
    values = table[column].to_numpy(float)
    times = np.append(table["start_s"], table["end_s"].iloc[-1])
    return ax.plot(times, np.append(values, values[-1:]), ls=line, drawstyle="steps-post", color=colour)[0]
