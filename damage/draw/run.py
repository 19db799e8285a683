"""Pictures of a run: the wall and its cracks, the index, drift, hysteresis and energies over time.

Each function takes a History and returns a matplotlib Figure, one journal column (90 mm) wide;
`damage.draw.house.save_all` writes them all.  Only figure objects are used, so that pictures come
out the same without a screen and inside any program.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from damage.draw import style
from damage.draw.panels import from_zero, letter
from damage.draw.wall import DRAWN, WallShape, legend_widths_mm, line_width, wall_shape
from damage.errors import InputError
from damage.history.moments import check_samples, choose_sample, choose_samples, nearest
from damage.history.reader import History
from damage.history.schema import is_moving
from damage.index import THRESHOLD
from damage.measure.cycles import shocks_table
from damage.measure.energy import (
    energy_error_of,
    energy_groups,
    energy_scale,
    imbalance,
    known_energies,
)
from damage.measure.joint_stress import contact_forces, sections, sections_table
from damage.measure.limits import bound
from damage.motion.loading import TopDisplacement
from damage.units import GRAVITY, MILLIMETRE
from damage.wall.geometry import body_corners, kinds_of_bodies

JOINT_COLOURS = {
    "elastic": style.GREEN,
    "intact": "0.8",
    "broken": "0.5",
    "slipped": style.BLUE,
    "opened": style.ORANGE,
    "both": style.BLACK,
}
THIN = {"elastic": 0.4, "intact": 0.25, "broken": 0.5}
KERN = 1 / 6
"""Largest eccentricity over the length of a section that is pressed all over."""
DASHES = {"elastic": (0, (3, 2))}
"""{state: dashes} of lines that are not solid, in widths of the line."""

DRIFT_LIMITS_PCT = [
    (100 * bound(f"drift_class_{name}", number), label, line)
    for name, number, label, line in (
        ("korswagen_calcium_silicate", 0, "light damage, calcium silicate (Korswagen)", ":"),
        ("korswagen_clay", 0, "light damage, clay (Korswagen)", "-."),
        ("graziotti", 0, "no damage up to here (Graziotti et al.)", "--"),
        ("graziotti", 1, "minor structural damage (Graziotti et al.)", "-"),
    )
]
"""Drift ratios [%] from tests of Dutch masonry, label, line; `damage.measure.limits` has their
sources."""
LIMITS_UP_TO_PCT = 0.6  # at a larger scale they would merge

ENERGIES = {  # of `energy_groups`: label, colour, line
    "input_energy_j": ("supplied", style.BLACK, "-"),
    "stored_energy_j": ("stored", style.BLUE, "-"),
    "dissipated_energy_j": ("dissipated in joints", style.VERMILLION, "--"),
    "damping_energy_j": ("damped", style.ORANGE, ":"),
}


# --- the wall ------------------------------------------------------------------------------------


@style.styled
def wall_picture(
    history: History, sample: str | int = "max", magnify: float | None = None
) -> Figure:
    """Return a Figure of the wall in true scale at a sample, with its cracks.

    sample: "max" (of the damage index), "end", or an index into the series; magnify: factor on
    displacements and rotations, None for one that makes them visible.

    >>> len(wall_picture(history, "max").axes)
    1
    """
    shape = wall_shape(history, sample, magnify)
    figure, ax = style.new_figure(1.0)
    style.fit_column(figure, draw_wall(ax, shape))
    title = [*style.title_of(history), _moment(shape, sample)]
    factor = magnified(shape.snapshot_time_s, shape.magnification)
    return style.finish_in_scale(figure, title, [*joint_handles(shape), factor])


def plot_wall(
    history: History, ax: Axes, t: str | float = "max", magnify: float | None = None
) -> WallShape:
    """Draw the wall with its cracks into axes of a figure of yours, in true scale; returns the
    WallShape that is drawn, of which `joint_handles` makes a legend.

    t: time [s], of which the nearest sample is drawn; "max" (of the damage index) or "end";
    magnify: as of `wall_picture`.  InputError for a time outside the run.

    >>> axes = Figure().add_subplot()
    >>> shape = plot_wall(history, axes, t=0.1)
    >>> _ = axes.legend(handles=joint_handles(shape))
    >>> axes.get_title().splitlines()[0]
    'DI 0.073 at 0.100 s'
    """
    (sample,) = choose_samples(history, [t])
    shape = wall_shape(history, sample, magnify)
    shape = shape.on_page(ax.get_window_extent().size / ax.figure.dpi * 72)
    draw_wall(ax, shape)
    factor = magnified(shape.snapshot_time_s, shape.magnification).get_label()
    ax.set_title(f"{_moment(shape, t)}\n{factor}", fontsize="small")
    return shape


def has_heap(history: History) -> bool:
    """Whether a History's bodies were followed beyond its collapse (`--after-fall`).

    >>> has_heap(history)
    False
    """
    times = history.snapshot_time_s
    return history.collapsed_at_s is not None and len(times) > 0 and times[-1] > history.time_s[-1]


@style.styled
def heap_picture(history: History) -> Figure:
    """Figure of all bodies at the last snapshot, in true scale and not magnified, over the outline
    of the wall.

    Raises InputError where the run ended at its collapse.
    """
    if not has_heap(history):
        raise InputError(
            f"{history.path} follows no brick beyond a collapse; expected a run in YADE with"
            " --after-fall whose wall fell; run it again with it"
        )
    motion = history.displacement[-1].astype(float)
    before = body_corners(history.bodies)
    now = body_corners(history.bodies, motion)
    kinds = kinds_of_bodies(history.bodies["course"])
    figure, ax = style.new_figure(1.0)
    style.add_bodies(ax, before, "none", "0.8")
    handles = [style.area_handle("none", "where they were", "0.8")]
    for kind, colour in style.BODY_COLOURS.items():
        if (kinds == kind).any():
            label = style.BODY_WORDS.get(kind, kind)
            style.add_bodies(ax, now[kinds == kind], colour, label=label)
            handles.append(style.area_handle(colour, label))
    style.add_bodies(ax, now, "none", style.DARK)  # all edges above all faces
    after_s = history.snapshot_time_s[-1] - history.collapsed_at_s
    style.fit_column(figure, show_all(ax, before, now))
    moment = f"{after_s:.2f} s after the first brick fell, not magnified"
    return style.finish_in_scale(figure, [*style.title_of(history), moment], handles)


@style.styled
def contact_force_picture(history: History, moment: str | float = "max") -> Figure:
    """Figure of the undeformed wall in true scale: at each contact point a line along its force, as
    long as that is large; over piers and arches where the thrust passes, and the middle third of
    their sections.

    InputError where the run kept no stresses.

    >>> from dataclasses import replace
    >>> stress_pa = np.full((*history.opening_m.shape, 2), -1e5)
    >>> figure = contact_force_picture(replace(history, joint_stress_pa=stress_pa), "end")
    >>> figure.axes[0].get_xlabel()
    'x [m]'
    """
    (sample,) = choose_samples(history, [moment])
    force = contact_forces(history, sample)
    middle = history.joints[["x_m", "z_m"]].to_numpy()
    corners = body_corners(history.bodies)
    kinds = kinds_of_bodies(history.bodies["course"])
    figure, ax = style.new_figure(1.0)
    style.add_bodies(ax, corners, [style.BODY_COLOURS[kind] for kind in kinds], "0.85", 0.2)
    size = np.hypot(*force.T)
    half = 0.5 * history.masonry_wall.brick.length / max(size.max(), 1.0) * force
    pulls = history.joint_stress_pa[sample, :, 0] > 0
    colours = np.where(pulls, style.VERMILLION, style.BLUE)
    style.add_lines(ax, np.stack([middle - half, middle + half], axis=1), colours, 0.6)
    _draw_thrust(ax, history, moment)
    handles = [
        style.line_handle(colour, f"{label}, up to {size[chosen].max(initial=0.0) / 1e3:.3g} kN")
        for colour, label, chosen in (
            (style.BLUE, "compression", ~pulls),
            (style.VERMILLION, "tension", pulls),
        )
    ]
    handles += [
        style.line_handle(style.BLACK, "thrust"),
        style.line_handle(style.BLACK, "middle third", 0.5, ":"),
    ]
    style.fit_column(figure, show_all(ax, corners))
    which = f"contact forces, {moment}: {history.time_s[sample]:.3f} s"
    return style.finish_in_scale(figure, [*style.title_of(history), which], handles)


def _draw_thrust(ax, history, moment):
    """Draw the thrust lines of the parts, broken where a section is under tension, or the thrust
    outside of it."""
    table = sections_table(history, [moment])
    lines = []
    for section, row in zip(sections(history), table.itertuples()):
        middle = np.array([(section.left + section.right) / 2, section.place])
        third = np.array([KERN * row.length_m, 0.0])
        if not section.is_bed:
            middle = middle[::-1]
            third = third[::-1]
        inside = abs(row.eccentricity_m) <= row.length_m / 2
        thrust = (row.thrust_x_m, row.thrust_z_m) if inside else (np.nan, np.nan)
        lines.append((thrust, middle - third, middle + third))
    for rows in table.groupby("part").indices.values():
        thrust, *edges = np.moveaxis(np.array(lines)[rows], 1, 0)
        ax.plot(*thrust.T, color=style.BLACK, lw=0.9, marker=".", ms=2)
        for edge in edges:
            ax.plot(*edge.T, color=style.BLACK, lw=0.5, ls=":")


def draw_wall(ax: Axes, shape: WallShape) -> float:
    """Draw a WallShape in true scale; returns height over width of the axes."""
    for kind, colour in style.BODY_COLOURS.items():
        corners = shape.corners[shape.kinds == kind]
        edge = colour if kind == "lintels" else "0.75"
        style.add_bodies(ax, corners, colour, edge, 0.2, label=kind, zorder=1)
    for layer, state in enumerate(DRAWN, start=2):
        chosen = shape.select(state)
        widths = [THIN[state]] if state in THIN else shape.line_width(chosen)
        style.add_lines(
            ax,
            shape.segments[chosen],
            JOINT_COLOURS[state],
            widths,
            label=state,
            linestyles=DASHES.get(state, "-"),
            capstyle="butt",
            zorder=layer,
        )
    if not shape.ground_moves:
        return show_all(ax, shape.corners)
    style.add_bodies(
        ax, shape.supports, style.GROUND_COLOUR, style.DARK, label="supports", zorder=0
    )
    ax.axhline(0, color=style.DARK, lw=0.4, ls=":", zorder=0)
    return show_all(ax, shape.corners, shape.supports, ground=False)


def show_all(ax: Axes, *corners: np.ndarray, ground: bool = True) -> float:
    """Set axes in true scale that contain all corners, (..., 2) [m], with the ground if asked for;
    returns their height over width."""
    points = np.concatenate([some.reshape(-1, 2) for some in corners])
    low = points.min(axis=0)
    high = points.max(axis=0)
    margin = 0.02 * (high - low).max()
    low = np.minimum(low, 0) - margin
    high = high + margin
    if ground:
        ax.axhspan(low[1], 0, facecolor=style.GROUND_COLOUR, lw=0, zorder=0)
    ax.set(
        xlim=(low[0], high[0]),
        ylim=(low[1], high[1]),
        aspect="equal",
        xlabel="x [m]",
        ylabel="z [m]",
    )
    return (high[1] - low[1]) / (high[0] - low[0])


def _moment(shape, sample):
    """Title line: the sample."""
    which = {"max": "maximum DI", "end": "end, DI"}.get(sample, "DI")
    return f"{which} {shape.index:.3f} at {shape.time_s:.3f} s"


def magnified(snapshot: int | None, factor: float | None):
    """Legend entry: the factor on displacements of a snapshot, None where there is none."""
    label = "undeformed, no snapshot near" if snapshot is None else f"displacements × {factor:g}"
    return style.area_handle("none", label, "none")


def joint_handles(shape: WallShape) -> list:
    """Return legend entries: states of joints, areas in the picture, widths of lines.

    >>> shape = plot_wall(history, Figure().add_subplot())
    >>> [handle.get_label() for handle in joint_handles(shape)][:3]
    ['opened', 'slipped', 'opened and slipped']
    """
    labels = {
        "opened": "opened",
        "slipped": "slipped",
        "both": "opened and slipped",
        "broken": f"failed, ≤ {THRESHOLD / MILLIMETRE:g} mm",
        "intact": "intact",
    }
    labels |= {"elastic": "elastic, cannot fail"} if shape.elastic.any() else {}
    width = line_width(0.5 * MILLIMETRE, shape.widest_pt)
    handles = [
        style.line_handle(
            JOINT_COLOURS[state], label, THIN.get(state, width), DASHES.get(state, "-")
        )
        for state, label in labels.items()
    ]
    handles += [
        style.area_handle(style.BODY_COLOURS[kind], label, "none")
        for kind, label in style.BODY_WORDS.items()
        if (shape.kinds == kind).any()
    ]
    if shape.ground_moves:
        handles.append(style.area_handle(style.GROUND_COLOUR, "supports"))
    return handles + [
        style.line_handle(style.DARK, label, line_width(mm * MILLIMETRE, shape.widest_pt))
        for mm, label in legend_widths_mm(shape)
    ]


# --- over time -----------------------------------------------------------------------------------


@style.styled
def index_picture(history: History) -> Figure:
    """Figure over time: base acceleration, or base shear without base motion; below, the index and
    its components.

    Thin dashed lines show the index with another slip criterion, the shear limit.

    >>> [ax.get_ylabel() for ax in index_picture(history).axes][-1]
    'damage index [-]'
    """
    sample, largest = choose_sample(history, "max")
    time_s = history.time_s
    figure, (above, below) = style.new_figure(3.2, rows=2, sharex=True, height_ratios=(2, 3))
    base = _draw_drive(above, history, time_s)
    lines = _draw_index(below, history.index(), history.index(slip="shear-limit"))
    marks = [
        (sample, largest, "o", style.BLACK, f"maximum {largest:.3f} at {time_s[sample]:.3f} s")
    ]
    if history.complete:
        residual = history.index()["DI"].iloc[-1]
        marks.append((-1, residual, "s", "white", f"residual {residual:.3f}"))
    for at, value, mark, face, label in marks:
        lines += below.plot(
            time_s[at],
            value,
            mark,
            mfc=face,
            mec=style.BLACK,
            ms=3.5,
            clip_on=False,
            zorder=5,
            label=label,
        )
    return finish_over_time(figure, history, (above, below), lines, base)


def finish_over_time(figure, history, axes, before, after=(), columns=3, title=()):
    """Add the title of a History, with further lines, the marks of its times to axes that share
    them, and a legend: handles before those of the marks, and after; returns the figure."""
    style.put_title(figure, *style.title_of(history), *title)
    figure.align_ylabels()
    marks = style.mark_times(history, axes)
    style.legend_below(figure, [*before, *marks, *after], columns)
    return figure


def _draw_drive(ax, history, time_s):
    """Draw base acceleration [g] or, without base motion, base shear [kN]; returns handles of two
    lines, else []."""
    horizontal, vertical = (
        history.series[f"base_acceleration_{axis}_m_s2"].to_numpy() / GRAVITY for axis in "xz"
    )
    if not np.any(np.nan_to_num([horizontal, vertical])):
        ax.plot(time_s, history.series["base_shear_n"] / 1e3, color=style.BLACK, lw=0.7)
        ax.set_ylabel("base shear [kN]")
        return []
    lines = ax.plot(time_s, horizontal, color=style.BLACK, lw=0.7, label="base, horizontal")
    ax.set_ylabel("base acceleration [g]")
    if not np.any(np.nan_to_num(vertical)):
        return []
    return lines + ax.plot(
        time_s, vertical, color=style.MEDIUM, lw=0.5, zorder=1, label="base, vertical"
    )


def _draw_index(ax, index, latched):
    """Draw DI and its components with two slip criteria; returns the lines in legend order."""
    time_s = index["time_s"]
    shown = {
        "DI_drift": (r"DI$_\mathrm{drift}$", style.GREEN, None),
        "DI_open": (r"DI$_\mathrm{open}$", style.ORANGE, None),
        "DI_slip": (r"DI$_\mathrm{slip}$", style.BLUE, None),
        "DI": ("DI", style.BLACK, 1.3),
    }
    lines = []
    for name, (label, colour, width) in shown.items():
        lines += ax.plot(time_s, index[name], color=colour, lw=width, label=label)
    for name in ("DI", "DI_slip"):
        label, colour, _ = shown[name]
        how = {"color": colour, "lw": 0.6, "ls": "--", "zorder": 1.5}
        lines += ax.plot(time_s, latched[name], label=f"{label}, shear limit", **how)
    top = np.maximum(index["DI"], latched["DI"]).max()
    ax.set(ylabel="damage index [-]", ylim=(0, 1.06 * top or 0.01))
    return lines


@style.styled
def drift_picture(history: History) -> Figure:
    """Figure of the drift ratio over time, with the published limits of light damage in its
    range.

    >>> len(drift_picture(history).axes) > 0
    True
    """
    check_samples(history)
    figure, ax = style.new_figure(2.1)
    drift, unit = style.scaled_drift(history)
    largest_pct = 100 * history.series["drift_ratio"].abs().max()
    limits = [
        limit for limit in DRIFT_LIMITS_PCT if limit[0] <= 1.1 * largest_pct <= LIMITS_UP_TO_PCT
    ]
    for value, label, line in limits:
        for side in (-value, value):
            ax.axhline(side, color=style.MEDIUM, lw=0.6, ls=line, label=f"{value:.3f} %: {label}")
    handles = ax.get_lines()[::2]
    ax.plot(history.time_s, drift, color=style.BLUE)
    style.plain_numbers(ax.yaxis)
    ax.set(ylabel=f"drift ratio [{unit}]")
    return finish_over_time(figure, history, [ax], handles, columns=1)


@style.styled
def hysteresis_picture(history: History) -> Figure:
    """Figure of base shear, the force of the wall on the ground, against drift ratio, without
    settling.

    Raises InputError where the run has no motion.

    >>> hysteresis_picture(pushed).axes[0].get_xlabel()
    'drift ratio [%]'
    """
    check_samples(history)
    if not is_moving(history.series).any():
        raise InputError(
            f"{history.path} has no motion: expected one for base shear against drift; run it again"
            " with a motion"
        )
    figure, ax = style.new_figure(2.4)
    drift, unit = style.scaled_drift(history)
    shear_kn = history.series["base_shear_n"].to_numpy() / 1e3
    stage = history.series["stage"].to_numpy()
    pushed = is_pushed(history)
    ax.axhline(0, color=style.LIGHT, lw=0.6, zorder=0)
    ax.axvline(0, color=style.LIGHT, lw=0.6, zorder=0)
    for name, colour, width, layer in (
        ("motion", style.BLUE, 0.9, 3),
        ("rest", style.ORANGE, 0.6, 2),
    ):
        chosen = stage == name
        if chosen.any():
            chosen = chosen | np.append(chosen[1:], False)  # joined to the stage before
            places = np.flatnonzero(chosen)
            span = slice(places[0], places[-1] + 1)
            ax.plot(
                np.where(chosen, drift, np.nan)[span],
                shear_kn[span],
                color=colour,
                lw=width,
                zorder=layer,
                label="push" if name == "motion" and pushed else name,
            )
    if history.collapsed_at_s is not None:
        sample = nearest(history.time_s, history.collapsed_at_s)
        ax.plot(
            drift[sample],
            shear_kn[sample],
            "x",
            color=style.BLACK,
            ms=5,
            zorder=4,
            label=style.collapse_label(history),
        )
    style.plain_numbers(ax.xaxis)
    ax.set(xlabel=f"drift ratio [{unit}]", ylabel="base shear [kN]")
    ax.locator_params(axis="x", nbins=7)
    style.show_single_points(ax)
    style.put_title(figure, *style.title_of(history))
    lines = [line for line in ax.get_lines() if not line.get_label().startswith("_")]
    style.legend_below(figure, lines if len(lines) > 1 else [], 3)
    return figure


@style.styled
def energy_picture(history: History) -> Figure:
    """Figure of the energies since the end of the static stage: supplied, stored, dissipated in the
    joints and damped; below, their imbalance.

    >>> len(energy_picture(history).axes) > 0
    True
    """
    check_samples(history)
    series = history.series
    groups = energy_groups(series)
    figure, (above, below) = style.new_figure(2.9, rows=2, sharex=True, height_ratios=(5, 2))
    for name, (label, colour, line) in ENERGIES.items():
        if np.isfinite(groups[name]).any():
            above.plot(
                series["time_s"],
                groups[name],
                color=colour,
                ls=line,
                label=label,
                lw=1.8 if name == "input_energy_j" else 0.9,
            )
    above.set_ylabel("energy [J]")
    error = energy_error_of(history)
    title = []
    scale = 1.0
    unit = "J"
    if error is not None:
        scale = 100 / energy_scale(known_energies(series[series["stage"] != "settling"]))
        unit = "%"
        if np.isfinite(error):
            title = [f"imbalance before settling up to {100 * error:.2g} % of the energy supplied"]
    below.axhline(0, color=style.MEDIUM, lw=0.5)
    below.plot(series["time_s"], imbalance(known_energies(series)) * scale, color=style.BLACK)
    below.set_ylabel(f"imbalance [{unit}]")
    return finish_over_time(figure, history, (above, below), above.get_lines(), title=title)


# --- files ---------------------------------------------------------------------------------------

PICTURES = {
    "wall_max": wall_picture,
    "wall_end": partial(wall_picture, sample="end"),
    "index": index_picture,
    "drift": drift_picture,
    "hysteresis": hysteresis_picture,
    "energy": energy_picture,
}
"""{file name without suffix: function that draws it}."""


def pictures_beside(history: History) -> dict[str, Callable]:
    """Return {file name without suffix: function that draws it} of what only some Histories have:
    the heap where bricks were followed beyond the collapse, the events where there are several,
    forces at rest and at the maximum index where the run kept stresses."""
    pictures: dict[str, Callable] = {}
    if has_heap(history):
        pictures["heap"] = heap_picture
    if len(history.series) and history.series["shock"].iloc[-1] > 1:
        pictures["sequence"] = sequence_picture
    if history.joint_stress_pa is not None:
        for moment in ("rest", "max"):
            pictures[f"contact_forces_{moment}"] = partial(contact_force_picture, moment=moment)
    return pictures


def pictures_of(history: History) -> dict[str, Callable]:
    """Return {file name without suffix: function that draws it} of a plane wall.

    Base shear against drift is named push where the top is pushed, and left out where there is no
    motion, as of ground that settles alone.

    >>> list(pictures_of(history))[:3]
    ['wall_max', 'wall_end', 'index']
    """
    chosen = PICTURES | pictures_beside(history)
    if not is_moving(history.series).any():
        del chosen["hysteresis"]
    elif is_pushed(history):
        chosen["push"] = chosen.pop("hysteresis")
    return chosen


def is_pushed(history: History) -> bool:
    """Whether the top of a History is pushed once, and not moved to and fro.

    >>> is_pushed(pushed), is_pushed(history)
    (True, False)
    """
    return isinstance(history.loading, TopDisplacement) and not history.loading.cycles


@style.styled
def sequence_picture(history: History) -> Figure:
    """Figure over time: base acceleration; below, a step an event: Psi and DI, largest and
    residual; largest offset of the joints at rest; newly failed contact points.

    >>> [axes.get_ylabel() for axes in sequence_picture(history).axes][2:]
    ['DI [-]', 'offset [mm]', 'contact points']
    """
    table = shocks_table(history)
    series = history.series
    figure, axes = style.new_figure(2.0 * style.COLUMN_WIDTH, 5, sharex=True)
    base, psi, index, offset, failed = axes
    base.plot(
        series["time_s"], series["base_acceleration_x_m_s2"] / GRAVITY, color=style.BLACK, lw=0.4
    )
    for ax, name in ((psi, "psi"), (index, "DI")):
        largest = _steps(ax, table, f"max_{name}", "largest in the event", style.MEDIUM, line="--")
        residual = _steps(ax, table, f"residual_{name}", "at rest after it", style.BLACK)
    after = _steps(offset, table, "offset_after_mm", "largest offset at rest", style.BLUE)
    bars = failed.bar(
        table["start_s"],
        table["newly_failed"],
        width=(table["end_s"] - table["start_s"]),
        align="edge",
        color=style.ORANGE,
        edgecolor="white",
        lw=0.3,
        label="newly failed",
    )
    failed.set_xlabel("time [s]")
    n_failed = int(table["newly_failed"].sum())
    panels = (
        ("base [g]", f"{len(table)} events"),
        (r"$\Psi$ [-]", "Psi of the cracks"),
        ("DI [-]", "damage index"),
        ("offset [mm]", "offset of the joints"),
        ("contact points", f"newly failed contact points, {n_failed} in all"),
    )
    for number, (ax, (label, heading)) in enumerate(zip(axes, panels)):
        ax.set_ylabel(label)
        letter(ax, number, heading)
        if ax is not base:
            from_zero(ax)
        ax.margins(x=0)
        for start in table["start_s"]:
            ax.axvline(start, color="0.88", lw=0.4, zorder=0)
    marks = (
        []
        if history.collapsed_at_s is None
        else [
            psi.axvline(
                history.collapsed_at_s, color=style.VERMILLION, lw=1, ls="--", label="collapse"
            )
        ]
    )
    style.put_title(figure, *style.title_of(history))
    figure.align_ylabels()
    style.legend_below(figure, [largest, residual, after, bars, *marks], columns=2)
    return figure


def _steps(ax, table, column, label, colour, line="-"):
    """Draw a value an event, constant from its start to its end; returns the line."""
    values = table[column].to_numpy(float)
    times = np.append(table["start_s"], table["end_s"].iloc[-1])
    return ax.plot(
        times,
        np.append(values, values[-1:]),
        ls=line,
        drawstyle="steps-post",
        color=colour,
        label=label,
    )[0]
