"""Picture of a wall before it is run: bricks, sizes of openings, supports, masses, elastic joints,
names of piers and spandrels."""

import numpy as np
from matplotlib.figure import Figure

from damage.draw import style
from damage.draw.words import wall_words
from damage.units import GRAVITY
from damage.wall.as_built import openings_as_built
from damage.wall.geometry import body_corners, body_table, kinds_of_bodies, tributary_ends

TONNE = KILO = 1e3
GROUND_DEPTH = 0.06  # of the wall's height, drawn
HIGHEST_NAME = 6  # most courses above an opening over which the name of its spandrel is centred
PAPER = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
CENTRED = {"ha": "center", "va": "center", "bbox": PAPER}
NARROW = 0.14  # of the wall's length, below which the size of an opening is written upwards


WORDS = {
    "bricks": "bricks",
    "masses": "rigid masses",
    "slabs": "concrete floors",
    "lintels": "lintels",
}
"""{kind of bodies: words of the legend}."""
EDGES = {"bricks": "0.55", "lintels": style.BODY_COLOURS["lintels"]}
"""{kind: colour of edges} where that is not dark: segments of a lintel have none between them."""


@style.styled
def wall_preview(plan, bodies, joints, supports):
    """Figure of a wall in true scale.

    plan: its damage.wall.plan.Plan; bodies, joints: tables as of a Layout or a History
    (`damage.wall.geometry`); supports: `left` and `right` (n_supports,) [m] of the parts of the
    base that carry by themselves.
    """
    figure, ax = style.new_figure(1.0)
    handles, ratio = draw_preview(ax, plan, bodies, joints, supports)
    style.fit_column(figure, ratio)
    return style.finish_in_scale(figure, title_of(plan.wall, bodies, joints), handles)


def draw_preview(ax, plan, bodies, joints, supports=None):
    """Draw a wall as of `wall_preview` into axes, in true scale, without `supports` on one below
    all; returns handles of a legend, and the height over the width of the axes."""
    wall = plan.wall
    corners = body_corners(bodies)
    kinds = kinds_of_bodies(bodies["course"])
    elastic = joints["elastic"].to_numpy(bool) & (joints["kind"] != "brick").to_numpy()
    handles = []
    for kind, label in WORDS.items():
        if (kinds == kind).any():
            colours = style.BODY_COLOURS[kind], EDGES.get(kind, style.DARK)
            style.add_bodies(ax, corners[kinds == kind], *colours)
            handles.append(style.area_handle(colours[0], label, colours[1]))
    parts = [(0.0, wall.length)] if supports is None else [*zip(supports.left, supports.right)]
    support = "support" if len(parts) == 1 else f"{len(parts)} supports"
    handles.insert(1, style.area_handle(style.GROUND_COLOUR, support))
    style.add_lines(ax, tributary_ends(joints[elastic]), style.GREEN, 0.6)
    if elastic.any():
        handles.append(style.line_handle(style.GREEN, "elastic joints (lintel)", 0.6))
    if wall.outline:
        ax.plot(*zip(*wall.outline), color=style.PURPLE, lw=0.8, ls="--")
        handles.append(style.line_handle(style.PURPLE, "outline", 0.8, "--"))
    handles += _draw_floors(ax, plan)
    depth = GROUND_DEPTH * wall.built_height
    for left, right in parts:
        ground = [((left, -depth), (right, -depth), (right, 0.0), (left, 0.0))]
        style.add_bodies(ax, ground, style.GROUND_COLOUR, style.DARK)
    _size_openings(ax, plan)
    _name_parts(ax, plan)
    points = np.vstack([corners.reshape(-1, 2), *([wall.outline] if wall.outline else [])])
    highest = points[:, 1].max()
    margin = 0.03 * max(wall.length, highest)
    ax.set(
        xlim=(-margin, wall.length + margin),
        ylim=(-depth, highest + 1.5 * margin),
        aspect="equal",
        xlabel="x [m]",
        ylabel="z [m]",
    )
    return handles, (highest + 1.5 * margin + depth) / (wall.length + 2 * margin)


def title_of(wall, bodies, joints):
    """Two lines about a wall: name and sizes; bricks, joints, precompression."""
    n_bricks = int(np.sum(kinds_of_bodies(bodies["course"]) == "bricks"))
    kinds = joints["kind"].isin(("bed", "head"))
    return (
        f"{wall_words(wall.name)}: {wall.length:.3f} x {wall.built_height:.3f} m,"
        f" {wall.brick.thickness:.3g} m thick",
        f"{n_bricks} bricks, {joints['length_m'][kinds].sum():.2f} m of joints, "
        + (
            f"precompression {wall.precompression / 1e6:g} MPa"
            if wall.precompression
            else "no precompression"
        ),
    )


def _draw_floors(ax, plan):
    """Timber floors as lines with their masses, the masses of slabs; returns the legend's
    handles."""
    for floor, left, right, _, above in plan.floors:
        level = above * plan.wall.brick.height
        if not floor.is_body:
            ax.plot(
                [left, right], [level, level], color=style.VERMILLION, lw=1.6, solid_capstyle="butt"
            )
        ax.text(
            (left + right) / 2,
            level,
            f"{floor.mass / TONNE:.3g} t ({floor.mass * GRAVITY / KILO:.3g} kN)",
            color=style.VERMILLION,
            fontsize="small",
            ha="center",
            va="bottom",
            bbox=PAPER,
        )
    timber = len(plan.floors) > len(plan.slabs)
    return [style.line_handle(style.VERMILLION, "timber floors", 1.6)] if timber else []


def _size_openings(ax, plan):
    """Width, height and, above the base, the sill of each opening as built [m]."""
    for opening, part in zip(plan.openings, openings_as_built(plan)):
        low, high = part.built
        sill = f"\nsill {low:.4g}" if low else ""
        upright = part.length < min(NARROW * plan.wall.length, high - low)
        ax.text(
            (opening.left + opening.right) / 2,
            (low + high) / 2,
            f"{part.length:.4g} x {high - low:.4g}{sill}",
            color=style.DARK,
            fontsize="small",
            rotation=90 * upright,
            **CENTRED,
        )


def _name_parts(ax, plan):
    """P1, P2 ... on the piers of each row of openings, from the base upwards, S1, S2 ... on the
    spandrels above."""
    h = plan.wall.brick.height
    named = CENTRED | {"color": style.BLUE, "fontsize": "medium", "fontweight": "bold"}
    piers = [(course, run) for course in _pier_courses(plan) for run in plan.runs[course]]
    for number, (course, (left, right)) in enumerate(piers, start=1):
        ax.text((left + right) / 2, (course + 0.5) * h, f"P{number}", **named)
    above = sorted(
        (opening.above, opening.spandrel, opening.left, opening.right) for opening in plan.openings
    )
    spandrels = [corner for corner in above if corner[1] > corner[0]]
    for number, (first, last, left, right) in enumerate(spandrels, start=1):
        ax.text(
            (left + right) / 2,
            (first + min(last, first + HIGHEST_NAME)) / 2 * h,
            f"S{number}",
            **named,
        )


def _pier_courses(plan):
    """A course in the middle of each row of openings, upwards; openings of a row have courses in
    common.  The wall's middle course where it has none."""
    rows = []
    for first, above in sorted((opening.first, opening.above) for opening in plan.openings):
        if rows and first < rows[-1][1]:
            rows[-1] = first, min(above, rows[-1][1])
        else:
            rows.append((first, above))
    return [(first + above - 1) // 2 for first, above in rows or [(0, len(plan.runs))]]


VISIBLE_SHARE = 0.08  # largest drawn displacement of a mode over the height of the wall


@style.styled
def modes_picture(layout, modes):
    """Figure of the mode shapes with their periods, two in a row, over the undeformed outline.

    layout: damage.wall.layout.Layout; modes: damage.linear.modes.Modes of it.
    """
    n = len(modes.period_s)
    rows = -(-n // 2)
    ratio = layout.wall.built_height / layout.wall.length
    size = 2 * style.COLUMN_WIDTH, rows * (style.COLUMN_WIDTH * ratio + 0.25)
    figure = Figure(figsize=size, layout="constrained")
    for number, ax in enumerate(figure.subplots(rows, 2, squeeze=False).ravel()):
        ax.axis("off")
        if number < n:
            _draw_mode(ax, layout, modes.shape[number, :, :3])
            ax.set_title(f"mode {number + 1}: {modes.period_s[number]:.4f} s", fontsize="medium")
    style.put_title(
        figure,
        f"{wall_words(layout.wall.name)}: natural modes with intact joints; critical time step "
        f"{modes.critical_time_step_s:.3g} s",
    )
    return figure


def _draw_mode(ax, layout, shape):
    bodies = body_table(layout)
    rest = body_corners(bodies)
    # Small enough that rotations are displacements of the linear mode, then enlarged as such.
    moved = body_corners(bodies, 1e-6 * shape) - rest
    largest = np.hypot(moved[..., 0], moved[..., 1]).max()
    corners = rest + moved * VISIBLE_SHARE * layout.wall.built_height / largest
    kinds = kinds_of_bodies(layout.bodies.course)
    style.add_bodies(ax, rest[kinds == "bricks"], "none", "0.85")
    for kind, colour in style.BODY_COLOURS.items():
        style.add_bodies(ax, corners[kinds == kind], colour, style.DARK, 0.25)
    ax.axhline(0, color=style.GROUND_COLOUR, lw=2, zorder=0)
    margin = 1.2 * VISIBLE_SHARE * layout.wall.built_height
    points = rest.reshape(-1, 2)
    ax.set(
        xlim=(points[:, 0].min() - margin, points[:, 0].max() + margin),
        ylim=(-margin / 2, points[:, 1].max() + margin),
        aspect="equal",
    )
