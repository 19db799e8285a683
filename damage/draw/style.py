"""Style of all pictures: sizes, colours, titles, legends, and the writing of figures.

Only figure objects are used, so that pictures come out the same without a screen and inside any
program.
"""

from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib import style
from matplotlib.backend_bases import get_registered_canvas_class
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import ScalarFormatter

from damage.draw.words import run_title
from damage.errors import InputError
from damage.files import whole_or_nothing
from damage.history.moments import spans_of
from damage.provenance import commit
from damage.version import VERSION

COLUMN_WIDTH = 90 / 25.4  # [inch], one column of a journal
DOTS_PER_INCH = 200
TITLE_CHARACTERS = 66  # of the font size below, in a column
STYLE = {
    "font.size": 7,
    "axes.labelsize": 7,
    "figure.titlesize": 7,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "legend.handlelength": 2.0,
    "legend.columnspacing": 1.2,
    "legend.borderaxespad": 0.3,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 0.9,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "figure.dpi": DOTS_PER_INCH,
    "savefig.dpi": DOTS_PER_INCH,
    "pdf.fonttype": 42,  # complete fonts, as journals require
    "svg.hashsalt": "masonry-damage",  # same picture, same bytes
}
_LAYERS = ["default", STYLE]
"""Styles in which pictures are drawn, each over those before it."""
# Okabe and Ito's palette, which is safe for colour-blind readers.  Orange, blue and black, for what
# opened, slipped and both, also differ in grey.
BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
LIGHT = "0.91"
MEDIUM = "0.6"
DARK = "0.35"
SAND = "#f3e6c8"
BRICK_COLOUR = "0.96"
CAP_COLOUR = "0.75"
GROUND_COLOUR = "0.85"
BODY_COLOURS = {
    "bricks": BRICK_COLOUR,
    "masses": CAP_COLOUR,
    "slabs": "#b9cbd9",
    "lintels": "#dcc48e",
}
"""{kind of `damage.wall.geometry.kinds_of_bodies`: its colour}."""
BODY_WORDS = {"masses": "top mass", "slabs": "concrete floor", "lintels": "lintel"}
"""{kind: words of the legend}."""


def add_bodies(ax, corners, face, edge="none", width=0.3, **more):
    """Add bodies with these corners (n, 4, 2) [m] to axes."""
    ax.add_collection(
        PolyCollection(corners, facecolors=face, edgecolors=edge, linewidths=width, **more)
    )


def add_lines(ax, segments, colours, width, **more):
    """Add straight lines (n, 2, 2) [m] to axes."""
    ax.add_collection(LineCollection(segments, colors=colours, linewidths=width, **more))


def line_handle(colour, label, width=0.9, line="-", **more):
    """A line of a legend, or a mark where the line is ""."""
    return Line2D([], [], color=colour, lw=width, ls=line, label=label, **more)


def area_handle(face, label, edge=DARK):
    """An area of a legend."""
    return Patch(facecolor=face, edgecolor=edge, linewidth=0.3, label=label)


@contextmanager
def printed(name):
    """Context: pictures are drawn without titles, in a matplotlib style.

    name: "paper", the one that ships as paper.mplstyle, or the path of such a file.  Raises
    InputError where it cannot be read.
    """
    file = Path(__file__).with_name("paper.mplstyle") if name == "paper" else name
    try:
        with style.context(file):
            _LAYERS.append(file)
    except OSError as error:
        raise InputError(
            f"--style {name}: expected paper, or a file of matplotlib's style parameters;"
            " correct it"
        ) from error
    try:
        yield
    finally:
        _LAYERS.pop()


def styled(draw):
    """Decorator: a function draws in _LAYERS; the style of the program is restored afterwards."""

    @wraps(draw)
    def inside(*arguments, **named):
        with style.context(_LAYERS):
            return draw(*arguments, **named)

    return inside


def new_figure(height, rows=1, **options):
    """A Figure of the width of one column, and its axes, a single one or an array; height
    [inch]."""
    figure = Figure(figsize=(COLUMN_WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, 1, **options)


def legend_below(figure, handles, columns):
    """Add a legend below all axes, in fewer columns where they would be wider than the figure,
    which grows by its height."""
    if not handles:
        return
    width, plot = figure.get_size_inches()
    for ncols in range(columns, 0, -1):
        legend = figure.legend(handles=handles, loc="lower center", ncols=ncols)
        extent = legend.get_window_extent()
        if extent.width <= width * figure.dpi or ncols == 1:
            break
        legend.remove()
    height = extent.height / figure.dpi
    figure.set_size_inches(width, plot + height)
    share = height / (plot + height)
    figure.get_layout_engine().set(rect=(0, share, 1, 1 - share))


def settle_layout(figure):
    """Let the layout of axes in true scale find their place: it does so in its second pass."""
    for _ in range(2):
        figure.get_layout_engine().execute(figure)


def fit_column(figure, ratio):
    """Fit a figure to the width of a column and to its axes in true scale; ratio: height over width
    of these."""
    labels = 0.45  # [inch] that ticks and labels take beside and below
    figure.set_size_inches(COLUMN_WIDTH, min((COLUMN_WIDTH - labels) * ratio, 5.0) + labels)


def finish_in_scale(figure, title, handles, columns=3):
    """Add lines of a title and a legend to a figure in true scale, and return it."""
    put_title(figure, *title)
    legend_below(figure, handles, columns)
    settle_layout(figure)
    return figure


def title_of(history):
    """Lines of a title: wall and motion, premature end of the run; the file and the solver are in
    the metadata."""
    lines = [run_title(history)]
    if not history.complete:
        lines.append(f"{history.status}: the run did not come to its end")
    if history.collapsed_at_s is not None:
        lines.append(f"collapsed at {history.collapsed_at_s:.3f} s")
    return lines


def put_title(figure, *lines):
    """Put lines at the left above a figure, which grows by their height; none where a style of
    print was chosen, as the caption says it there."""
    if len(_LAYERS) > 2:
        return
    width, plot = figure.get_size_inches()
    columns = width / COLUMN_WIDTH
    text = "\n".join(fill(line, round(TITLE_CHARACTERS * columns)) for line in lines if line)
    title = figure.suptitle(text, x=0.02 / columns, ha="left")
    figure.set_size_inches(width, plot + title.get_window_extent().height / figure.dpi)


def mark_times(history, axes):
    """Label the shared time axis, shade the settling stage and mark a collapse; returns their
    handles."""
    handles = {}
    for ax in axes:
        ax.margins(x=0)
        show_single_points(ax)
        for shade in shade_settling(ax, history.series):
            handles[shade.get_label()] = shade
        if history.collapsed_at_s is not None:
            handles["collapse"] = ax.axvline(
                history.collapsed_at_s,
                color=VERMILLION,
                lw=1,
                ls="--",
                clip_on=False,
                label=collapse_label(history),
            )
    axes[-1].set_xlabel("time [s]")
    return list(handles.values())


def shade_settling(ax, series):
    """Shade the settlement and settling stages of a table with columns time_s and stage; returns
    the handles."""
    spans = []
    for name, colour in (("settling", LIGHT), ("settlement", SAND)):
        spans += [
            ax.axvspan(*span, color=colour, lw=0, zorder=0, label=name)
            for span in spans_of(series["time_s"].to_numpy(), (series["stage"] == name).to_numpy())
        ]
    return spans


TINY_DRIFT = 1e-5
"""Largest drift ratio [-] below which a drift axis is in millionths in place of per cent."""


def drift_scale(*ratios):
    """Factor on drift ratios (arrays of any shape), and the unit in which their axis needs no power
    of ten."""
    values = np.hstack([0.0, *map(np.ravel, ratios)])
    largest = np.abs(values[np.isfinite(values)]).max()
    return (1e6, "µm per m") if 0 < largest < TINY_DRIFT else (100.0, "%")


def scaled_drift(history):
    """Drift of a History over time (n_times,) in the unit of its axis, and that unit."""
    ratio = history.series["drift_ratio"].to_numpy()
    factor, unit = drift_scale(ratio)
    return factor * ratio, unit


def plain_numbers(axis):
    """Write the ticks of an Axis without a power of ten or an offset."""
    axis.set_major_formatter(ScalarFormatter(useOffset=False))
    axis.get_major_formatter().set_scientific(False)


def show_single_points(ax):
    """Add a marker to lines with a single point, which are invisible otherwise."""
    for line in ax.get_lines():
        if len(line.get_xdata()) == 1 and line.get_marker() == "None":
            line.set(marker="o", markersize=2.5)


def collapse_label(history):
    return f"collapse at {history.collapsed_at_s:.3f} s"


METADATA = {
    "png": ("Software", "Description"),
    "pdf": ("Creator", "Subject", "CreationDate"),
    "svg": ("Creator", "Description", "Date"),
}
"""{suffix: (metadata key of the software, key of the origin of the results, key of the date where
there is one)}."""
FORMATS = ("png", "pdf")
"""Suffixes of `save_figures`."""


@styled
def save_figures(figures, folder, made=""):
    """Write figures, pairs (name, Figure), as PNG and PDF into `folder`, created where missing;
    returns their paths.

    made: origin of the results, text; it is written into the metadata, with the version of this
    software.
    """
    return [
        _save(figure, Path(folder) / f"{name}.{ending}", ending, made)
        for name, figure in figures
        for ending in FORMATS
    ]


@styled
def save_picture(figure, path, made=""):
    """Write one Figure as its path's ending says; returns the path.  made: as of `save_figures`.
    Raises InputError for an ending other than those of METADATA."""
    ending = Path(path).suffix.lower().removeprefix(".")
    if ending not in METADATA:
        raise InputError(
            f"{path}: expected a name that ends in .{', .'.join(METADATA)}; give it one"
        )
    return _save(figure, Path(path), ending, made)


def _save(figure, path, ending, made):
    # no date: same run, same bytes
    values = f"masonry-damage {VERSION}, commit {commit()}", made, None
    before = figure.canvas
    with whole_or_nothing(path) as unfinished:
        # Figure.savefig would draw twice, first for a layout that drawing makes anyway: a seventh
        # later
        try:
            canvas = get_registered_canvas_class(ending)(figure)
            getattr(canvas, f"print_{ending}")(
                unfinished, metadata=dict(zip(METADATA[ending], values))
            )
        finally:
            figure.set_canvas(before)
    return path
