"""Animation of a run: the wall with magnified displacements and its cracks; below it drift and
index over time.

Frames are the snapshots of the run, without interpolation.  Of a long run only those around the
maximum of the index, or those of a window, are shown.  Where bricks were followed beyond a
collapse, so are they here; index and drift end with the first fallen brick.
"""

import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from PIL import Image

from damage.applications.report.packing import fewer_colours
from damage.draw import style
from damage.draw.house import LINES, Perspective, legend_of
from damage.draw.house import magnification as house_magnification
from damage.draw.run import THIN, draw_wall, joint_handles, show_all
from damage.draw.wall import DRAWN, check_magnify, magnification, shape_at, wall_shape
from damage.errors import InputError
from damage.files import whole_or_nothing
from damage.measure.house import largest_index
from damage.wall.geometry import body_corners


class WebPWriter(PillowWriter):
    """Keeps frames of 64 colours without loss, in a third of a GIF's size."""

    def finish(self):
        colours = fewer_colours(self._frames[0])  # the legend has all of them
        first, *others = (
            frame.convert("RGB").quantize(palette=colours, dither=Image.Dither.NONE).convert("RGB")
            for frame in self._frames
        )
        duration = round(1000 / self.fps)
        first.save(
            self.outfile,
            save_all=True,
            append_images=others,
            duration=duration,
            loop=0,
            lossless=True,
        )


WRITERS = {".gif": PillowWriter, ".webp": WebPWriter, ".mp4": FFMpegWriter}
FRAMES_PER_S = 20
MOST_FRAMES = 300
"""Largest number of frames, about six seconds of a run; a GIF keeps all of them in memory, a
megabyte each."""
DOTS_PER_INCH = 150
MOST_TURN_DEG = 3.0
"""Largest turn of the eye about a house from frame to frame [deg]."""


def write_film(history, path, window_s=None, magnify=None):
    """Write the animation of a History to `path`, GIF, WebP or MP4 by its suffix; returns it.

    window_s: (start, end) of the part of the run [s], None for all of it; magnify: factor on
    displacements, None for one that makes them visible and that all frames share.
    Raises InputError where there is no frame to show, the ending is another, or ffmpeg is missing.
    """
    path = Path(path)
    check_magnify(magnify)
    writer = _writer(path)
    snapshots = choose_snapshots(history, window_s)
    # writers need the suffix, which an unfinished file lacks
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"film{path.suffix.lower()}"
        _shoot(history, snapshots, magnify, writer, made)
        with whole_or_nothing(path) as unfinished:
            shutil.copyfile(made, unfinished)
    return path


def _writer(path):
    """matplotlib writer for the suffix of a path; raises InputError where there is none."""
    kind = WRITERS.get(path.suffix.lower())
    if kind is None:
        raise InputError(
            f"{path}: expected a film that ends in {' or '.join(WRITERS)}; correct the name"
        )
    if not kind.isAvailable():
        raise InputError(
            f"{path}: expected ffmpeg on PATH, which MP4 needs (Debian's package ffmpeg); install"
            " it, or give a name that ends in .gif"
        )
    return kind(fps=FRAMES_PER_S)


def choose_snapshots(history, window_s=None, most=MOST_FRAMES):
    """Indices of the snapshots to show, (n,): those in a window [s], or up to `most` around the
    maximum of the index.

    Raises InputError where the window has none, or more than `most`.
    """
    times = history.snapshot_time_s
    series = history.series
    start, end = window_s or (-np.inf, np.inf)
    chosen = np.flatnonzero((times >= start) & (times <= end))
    if len(chosen) == 0 or len(series) == 0:
        raise InputError(
            f"{history.path} has no snapshot from {start:g} to {end:g} s; expected one or more,"
            " give another --window, or let the run continue"
        )
    if len(chosen) <= most:
        return chosen
    if window_s:
        raise InputError(
            f"--window {start:g} {end:g} holds {len(chosen)} snapshots; expected up to {most}, give"
            " a shorter one"
        )
    top = series["time_s"].iloc[int(largest_index(history).argmax())]
    first = int(np.clip(np.argmin(np.abs(times - top)) - most // 2, 0, len(chosen) - most))
    return chosen[first : first + most]


@style.styled
def _shoot(history, snapshots, magnify, writer, path):
    times = history.series["time_s"].to_numpy()
    samples = [int(np.argmin(np.abs(times - time))) for time in history.snapshot_time_s[snapshots]]
    stage = _house_stage if history.is_house else _stage
    figure, show = stage(history, snapshots, samples, magnify)
    with writer.saving(figure, path, DOTS_PER_INCH):
        for sample, snapshot in zip(samples, snapshots):
            show(sample, snapshot)
            writer.grab_frame()


def _common_magnification(history, snapshots):
    """Magnification for all snapshots: that of the one with the largest displacements."""
    motions = [motion for motion in history.displacement[snapshots].astype(float) if np.any(motion)]
    return min((magnification(history.bodies, motion) for motion in motions), default=1.0)


def _stage(history, snapshots, samples, magnify):
    """The figure, and a function that draws a sample and snapshot in it."""
    magnify = _common_magnification(history, snapshots) if magnify is None else magnify
    damage = history.index()["DI"].to_numpy()
    gravest = wall_shape(history, "max", magnify=magnify)
    figure, (wall, below) = style.new_figure(1.0, rows=2, height_ratios=(5, 2))
    draw_wall(wall, gravest)
    ratio = show_all(
        wall,
        *(
            body_corners(history.bodies, history.displacement[k].astype(float), magnify)
            for k in snapshots
        ),
        ground=False,
    )
    gravest = gravest.on_page(span_m=(np.ptp(wall.get_xlim()), np.ptp(wall.get_ylim())))
    labels = 0.45  # [inch] that ticks and labels take beside and below
    figure.set_size_inches(
        style.COLUMN_WIDTH, min(1.3 * (style.COLUMN_WIDTH - labels) * ratio, 5.0) + 2.5 * labels
    )
    clock = wall.set_title(" ", loc="left", fontsize=style.STYLE["font.size"])
    mark = _draw_below(below, history, samples, history.snapshot_time_s[snapshots[-1]])
    style.add_title(figure, history, _pace(history, snapshots, magnify))
    style.legend_below(figure, joint_handles(gravest), columns=3)
    _fix(figure)
    drawn = {collection.get_label(): collection for collection in wall.collections}

    def show(sample, snapshot):
        shape = shape_at(history, sample, damage[sample], magnify=magnify, snapshot=snapshot)
        _update(drawn, replace(shape, widest_pt=gravest.widest_pt))
        clock.set_text(f"{shape.time_s:.3f} s, DI {shape.index:.3f}")
        mark.set_xdata([shape.time_s, shape.time_s])

    return figure, show


def _pace(history, snapshots, magnify):
    """Words on the magnification, and on how much slower than the run the film is."""
    times = history.snapshot_time_s[snapshots]
    words = f"displacements × {magnify:g}"
    if len(times) > 1:
        words += f", slowed down {len(times) / FRAMES_PER_S / (times[-1] - times[0]):.2g} times"
    return words


def _fix(figure):
    """Lay a figure out, once: from now on only what is in its axes moves."""
    for _ in range(2):  # the layout finds the place of axes in true scale in its second pass
        figure.draw_without_rendering()
    figure.set_layout_engine("none")


def _house_stage(history, snapshots, samples, magnify):
    """As `_stage`, of a house in perspective, about which the eye goes, once at most."""
    figure, (above, below) = style.new_figure(1.0, rows=2, height_ratios=(5, 1.6))
    seen = Perspective(above, history, (72 * style.COLUMN_WIDTH,) * 2)
    magnify = house_magnification(seen.space, snapshots) if magnify is None else magnify
    step = min(MOST_TURN_DEG, 360 / len(snapshots))
    turn = dict(zip(snapshots, seen.azimuth + step * np.arange(len(snapshots))))
    ratio = seen.fit(np.arange(0, 360, 15))
    figure.set_size_inches(style.COLUMN_WIDTH, min(style.COLUMN_WIDTH * ratio, 4.5) * 1.35)
    clock = above.set_title(" ", loc="left", fontsize=style.STYLE["font.size"])
    time_s = history.series["time_s"].to_numpy()
    damage = largest_index(history)
    for part, (colour, line) in zip(history.parts, LINES):
        below.plot(time_s, part.index()["DI"], color=colour, ls=line, label=part.wall)
    below.set(xlabel="time [s]", ylabel="DI [-]", ylim=(0, None))
    below.set_xlim(time_s[samples[0]], max(time_s[samples[-1]], time_s[samples[0]] + 1e-9))
    mark = below.axvline(time_s[samples[0]], color=style.DARK, lw=1)
    style.add_title(figure, history, _pace(history, snapshots, magnify))
    handles = [*below.get_lines()[:-1], *legend_of(history, int(damage.argmax()), seen.widest_pt)]
    style.legend_below(figure, handles, columns=3)
    _fix(figure)

    def show(sample, snapshot):
        seen.show(sample, snapshot, magnify, turn[snapshot])
        clock.set_text(f"{time_s[sample]:.3f} s, largest DI {damage[sample]:.3f}")
        mark.set_xdata([time_s[sample]] * 2)

    return figure, show


def _update(drawn, shape):
    """Move the collections that `draw_wall` made, by their labels, to another shape."""
    for kind in style.BODY_COLOURS:
        drawn[kind].set_verts(shape.corners[shape.kinds == kind])
    if "supports" in drawn:
        drawn["supports"].set_verts(shape.supports)
    for state in DRAWN:
        chosen = shape.select(state)
        drawn[state].set_segments(shape.segments[chosen])
        drawn[state].set_linewidths([THIN[state]] if state in THIN else shape.line_width(chosen))


def _draw_below(ax, history, samples, until_s):
    """Draw drift ratio and index over the time shown; returns the line that marks a time.

    until_s: time of the last snapshot [s], which may follow the last sample.
    """
    time_s = history.series["time_s"].to_numpy()
    drift, unit = style.scaled_drift(history)
    ax.plot(time_s, drift, color=style.BLUE)
    style.plain_numbers(ax.yaxis)
    ax.set(
        ylabel=f"drift [{unit}]",
        xlabel="time [s]",
        xlim=(time_s[samples[0]], max(time_s[samples[-1]], until_s) + 1e-9),
    )
    ax.yaxis.label.set_color(style.BLUE)
    right = ax.twinx()
    right.plot(time_s, history.index()["DI"], color=style.BLACK)
    right.set(ylabel="DI [-]", ylim=(0, None))
    right.spines["right"].set_visible(True)
    return ax.axvline(time_s[samples[0]], color=style.VERMILLION, lw=1)
