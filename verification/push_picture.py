"""Force against displacement of the dry-joint stone walls: solver, limit analysis and tests."""

from matplotlib.figure import Figure

from damage.pictures import BLACK, BLUE, COLUMN_WIDTH, MEDIUM, VERMILLION, legend_below, styled
from damage.units import MILLIMETRE
from verification.lourenco import LOADS_N, SPLITTING, bound, lay, measured


@styled
def picture(pushes):
    """Figure of {name: (Push of rigid stones, Push of stones that split)}, a panel each."""
    figure = Figure(figsize=(COLUMN_WIDTH, 1.15 * COLUMN_WIDTH), layout="constrained")
    panels = figure.subplots(len(pushes), 1, sharex=True)
    for ax, (name, both) in zip(panels, pushes.items()):
        _draw(ax, name, *both)
    panels[-1].set_xlabel("displacement of the top [mm]")
    legend_below(figure, panels[0].get_legend_handles_labels()[0], 2)
    return figure


def _draw(ax, name, rigid, split):
    for test, line, label in zip(measured(name), ("-", "--"), ("first test", "second test")):
        ax.plot(test.displacement_m / MILLIMETRE, test.force_n / 1e3, line, color=MEDIUM, label=label)
    ax.axhline(bound(lay(name)) / 1e3, color=BLACK, linestyle=":", label="limit analysis, rigid stones")
    for push, colour, line, label in ((rigid, BLUE, "-", "solver, rigid stones"),
                                      (split, VERMILLION, "-.", f"solver, stones split at {SPLITTING / 1e6:g} MPa")):
        ax.plot(push.displacement / MILLIMETRE, push.force / 1e3, line, color=colour, label=label)
    ax.set_ylabel("horizontal force [kN]")
    ax.set_ylim(bottom=0)
    ax.set_title(f"{name}: {LOADS_N[name] / 1e3:g} kN on top", fontsize=7, loc="left")
