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
from damage.draw.run import THIN, draw_wall, joint_handles, show_all
from damage.draw.wall import DRAWN, check_magnify, magnification, shape_at, wall_shape
from damage.errors import InputError
from damage.files import whole_or_nothing
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
    times, series = history.snapshot_time_s, history.series
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
    top = series["time_s"].iloc[int(history.index()["DI"].to_numpy().argmax())]
    first = int(np.clip(np.argmin(np.abs(times - top)) - most // 2, 0, len(chosen) - most))
    return chosen[first : first + most]


@style.styled
def _shoot(history, snapshots, magnify, writer, path):
    damage, times = history.index()["DI"].to_numpy(), history.series["time_s"].to_numpy()
    samples = [int(np.argmin(np.abs(times - time))) for time in history.snapshot_time_s[snapshots]]
    magnify = _common_magnification(history, snapshots) if magnify is None else magnify
    figure, show = _stage(history, snapshots, samples, magnify)
    with writer.saving(figure, path, DOTS_PER_INCH):
        for sample, snapshot in zip(samples, snapshots):
            show(shape_at(history, sample, damage[sample], magnify=magnify, snapshot=snapshot))
            writer.grab_frame()


def _common_magnification(history, snapshots):
    """Magnification for all snapshots: that of the one with the largest displacements."""
    motions = [motion for motion in history.displacement[snapshots].astype(float) if np.any(motion)]
    return min((magnification(history.bodies, motion) for motion in motions), default=1.0)


def _stage(history, snapshots, samples, magnify):
    """The figure, and a function that draws a WallShape in it."""
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
    times, words = history.snapshot_time_s[snapshots], f"displacements × {magnify:g}"
    mark = _draw_below(below, history, samples, times[-1])
    if len(times) > 1:
        words += f", slowed down {len(times) / FRAMES_PER_S / (times[-1] - times[0]):.2g} times"
    style.add_title(figure, history, words)
    style.legend_below(figure, joint_handles(gravest), columns=3)
    for _ in range(2):  # the layout finds the place of axes in true scale in its second pass
        figure.draw_without_rendering()
    figure.set_layout_engine("none")  # from now on only the wall moves
    drawn = {one.get_label(): one for one in wall.collections}

    def show(shape):
        _update(drawn, replace(shape, widest_pt=gravest.widest_pt))
        clock.set_text(f"{shape.time_s:.3f} s, DI {shape.index:.3f}")
        mark.set_xdata([shape.time_s, shape.time_s])

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
    ratio = history.series["drift_ratio"].to_numpy()
    factor, unit = style.drift_scale(ratio)
    ax.plot(time_s, factor * ratio, color=style.BLUE)
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
