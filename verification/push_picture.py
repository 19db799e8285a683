"""Force against displacement of the dry-joint stone walls: solver, limit analysis and tests."""

from matplotlib.figure import Figure

from damage.draw.style import BLACK, BLUE, COLUMN_WIDTH, MEDIUM, VERMILLION, legend_below, styled
from damage.units import MILLIMETRE


@styled
def picture(panels, splitting):
    """Figure of a panel for each wall.

    panels: {title: (tests, bound [N], Push of rigid stones, Push of stones that split)}; a test has displacement_m
    and force_n, a Push displacement and force; splitting: the stones' tensile strength [Pa].
    """
    figure = Figure(figsize=(COLUMN_WIDTH, 1.15 * COLUMN_WIDTH), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True)
    for ax, (title, drawn) in zip(axes, panels.items()):
        _draw(ax, title, splitting, *drawn)
    axes[-1].set_xlabel("displacement of the top [mm]")
    legend_below(figure, axes[0].get_legend_handles_labels()[0], 2)
    return figure


def _draw(ax, title, splitting, tests, bound, rigid, split):
    for test, line, label in zip(tests, ("-", "--"), ("first test", "second test")):
        ax.plot(test.displacement_m / MILLIMETRE, test.force_n / 1e3, line, color=MEDIUM, label=label)
    ax.axhline(bound / 1e3, color=BLACK, linestyle=":", label="limit analysis, rigid stones")
    for push, colour, line, label in ((rigid, BLUE, "-", "solver, rigid stones"),
                                      (split, VERMILLION, "-.", f"solver, stones split at {splitting / 1e6:g} MPa")):
        ax.plot(push.displacement / MILLIMETRE, push.force / 1e3, line, color=colour, label=label)
    ax.set_ylabel("horizontal force [kN]")
    ax.set_ylim(bottom=0)
    ax.set_title(title, fontsize=7, loc="left")
