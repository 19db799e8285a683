"""Parts of the figures of studies: grids of panels, headings, legends."""

from matplotlib.figure import Figure

from damage.draw.style import legend_below

PAGE_WIDTH = 190 / 25.4  # [inch], two columns of a journal and the space between


def grid(rows, columns, panel_height, width=PAGE_WIDTH, **options):
    """A Figure and its axes (rows, columns); panel_height [inch] with its labels."""
    figure = Figure(figsize=(width, rows * panel_height), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def finish(figure, handles, columns=4):
    """Add a legend below, filled row by row, and align the axis labels; returns the figure."""
    figure.align_ylabels()
    by_column = [handle for first in range(columns) for handle in handles[first::columns]]
    legend_below(figure, by_column, columns)
    return figure


def from_zero(ax, at_least=0.0):
    """Format a y axis of non-negative values: room for a marker at zero, plain numbers.

    at_least: least upper limit, so that negligible values do not fill the axis.
    """
    top = max(ax.get_ylim()[1], at_least)
    ax.set_ylim(-0.05 * top, 1.05 * top)
    ax.ticklabel_format(axis="y", style="plain", useOffset=False)


def letter(ax, number, text=""):
    """Label a panel (a), (b), ..., (z), (aa), ... with a text, above its left corner.

    number: of the panel in its figure, from zero.
    """
    rounds, place = divmod(number, 26)
    ax.set_title(
        f"({chr(ord('a') + place) * (rounds + 1)}) {text}".rstrip(), loc="left", fontsize="medium"
    )
