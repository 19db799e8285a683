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
from damage.history.moments import nearest
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
    start, end = window_s or (-np.inf, np.inf)
    chosen = np.flatnonzero((times >= start) & (times <= end))
    if len(chosen) == 0 or len(history.time_s) == 0:
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
    top = history.time_s[history.largest_index.argmax()]
    first = int(np.clip(nearest(times, top) - most // 2, 0, len(chosen) - most))
    return chosen[first : first + most]


@style.styled
def _shoot(history, snapshots, magnify, writer, path):
    times = history.time_s
    samples = [nearest(times, time) for time in history.snapshot_time_s[snapshots]]
    damage = history.largest_index
    figure, (above, below) = style.new_figure(1.0, rows=2, height_ratios=(5, 2))
    clock = above.set_title(" ", loc="left", fontsize=style.STYLE["font.size"])
    stage = _house_stage if history.kind == "house" else _stage
    magnify, height, handles, show = stage(history, snapshots, above, below, magnify)
    below.set(
        xlabel="time [s]",
        xlim=(
            times[samples[0]],
            1e-9 + max(times[samples[-1]], history.snapshot_time_s[snapshots[-1]]),
        ),
    )
    mark = below.axvline(times[samples[0]], color=style.VERMILLION, lw=1)
    figure.set_size_inches(style.COLUMN_WIDTH, height)
    caption = f"displacements × {magnify:g}"
    if len(snapshots) > 1:
        lasts_s = np.ptp(history.snapshot_time_s[snapshots])
        caption += f", slowed down {len(snapshots) / FRAMES_PER_S / lasts_s:.2g} times"
    style.put_title(figure, *style.title_of(history), caption)
    style.legend_below(figure, handles, columns=3)
    for _ in range(2):  # the layout finds the place of axes in true scale in its second pass
        figure.draw_without_rendering()
    figure.set_layout_engine("none")  # from now on only what is in its axes moves
    with writer.saving(figure, path, DOTS_PER_INCH):
        for sample, snapshot in zip(samples, snapshots):
            time_s = show(sample, snapshot)
            clock.set_text(f"{time_s:.3f} s, DI {damage[sample]:.3f}")
            mark.set_xdata([time_s] * 2)
            writer.grab_frame()


def _stage(history, snapshots, above, below, magnify):
    """Draw a wall above, drift and index over time below; returns the factor on displacements, the
    height of the figure [inch], handles of a legend, and a function that draws a sample and
    snapshot and returns the time of what it shows [s]."""
    motions = history.displacement[snapshots].astype(float)
    if magnify is None:  # that of the largest displacements
        each = [magnification(history.bodies, motion) for motion in motions if np.any(motion)]
        magnify = min(each, default=1.0)
    damage = history.largest_index
    gravest = wall_shape(history, "max", magnify=magnify)
    draw_wall(above, gravest)
    ratio = show_all(
        above,
        *(body_corners(history.bodies, motion, magnify) for motion in motions),
        ground=False,
    )
    gravest = gravest.on_page(span_m=(np.ptp(above.get_xlim()), np.ptp(above.get_ylim())))
    labels = 0.45  # [inch] that ticks and labels take beside and below
    _draw_below(below, history)
    drawn = {collection.get_label(): collection for collection in above.collections}

    def show(sample, snapshot):
        shape = shape_at(history, sample, damage[sample], magnify=magnify, snapshot=snapshot)
        _update(drawn, replace(shape, widest_pt=gravest.widest_pt))
        return shape.time_s

    height = min(1.3 * (style.COLUMN_WIDTH - labels) * ratio, 5.0) + 2.5 * labels
    return magnify, height, joint_handles(gravest), show


def _house_stage(history, snapshots, above, below, magnify):
    """As `_stage`, of a house in perspective, about which the eye goes, once at most; below the
    indices of its walls."""
    seen = Perspective(above, history)
    magnify = house_magnification(seen.space, snapshots) if magnify is None else magnify
    step = min(MOST_TURN_DEG, 360 / len(snapshots))
    turn = dict(zip(snapshots, seen.azimuth + step * np.arange(len(snapshots))))
    ratio = seen.fit(np.arange(0, 360, 15))
    time_s = history.time_s
    for part, (colour, line) in zip(history.parts, LINES):
        below.plot(time_s, part.index()["DI"], color=colour, ls=line, label=part.wall)
    below.set(ylabel="DI [-]", ylim=(0, None))

    def show(sample, snapshot):
        seen.show(sample, snapshot, magnify, turn[snapshot])
        return time_s[sample]

    states = legend_of(history, int(history.largest_index.argmax()), seen.widest_pt)
    height = 1.4 * min(style.COLUMN_WIDTH * ratio, 4.5)
    return magnify, height, [*below.get_lines(), *states], show


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


def _draw_below(ax, history):
    """Draw drift ratio and index over time."""
    time_s = history.time_s
    drift, unit = style.scaled_drift(history)
    ax.plot(time_s, drift, color=style.BLUE)
    style.plain_numbers(ax.yaxis)
    ax.set(ylabel=f"drift [{unit}]")
    ax.yaxis.label.set_color(style.BLUE)
    right = ax.twinx()
    right.plot(time_s, history.largest_index, color=style.BLACK)
    right.set(ylabel="DI [-]", ylim=(0, None))
    right.spines["right"].set_visible(True)
