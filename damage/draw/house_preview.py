"""Drawing of a house before it is run: its plan, with corners, floors and the direction of the
motion, and its walls."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from damage.draw import style
from damage.draw.panels import PAGE_WIDTH
from damage.draw.preview import CENTRED, draw_preview, wall_preview
from damage.house.house import outline
from damage.wall.geometry import body_table, joint_table
from damage.wall.kinds import SLAB_COURSE, TINY
from damage.wall.plan import plan_of

FLOORS = {"concrete": style.BODY_COLOURS["slabs"], "timber": style.SAND}
MARKS = {"toothed": "s", "butted": "o"}
SECTION_M = 1.0  # height of the plan
ARROW = {"arrowstyle": "->", "lw": 0.8, "color": style.DARK}


def preview(layout):
    """Figure of a wall or a house before it is run, by its Layout."""
    if layout.IN_SPACE:
        return house_preview(layout)
    return wall_preview(layout.plan, body_table(layout), joint_table(layout), layout.supports)


@style.styled
def house_preview(layout):
    """Figure of a house before it is run: its plan, with corners and the direction of the motion,
    and its walls as `damage.draw.preview.wall_preview` draws them; layout: that of the House."""
    house = layout.house
    handles = {}
    walls = [placed.wall for placed in house.bearing]
    n = layout.n_joints
    concrete = [floor for floor in house.floors if floor.kind == "concrete"]
    concrete.sort(key=lambda floor: floor.level)
    lengths = [wall.length for wall in walls]
    scale = (PAGE_WIDTH - 0.5) / (1.1 * sum(lengths))  # [inch/m] of the walls
    ends = np.concatenate([placed.corners for placed in house.walls])
    plan = min(PAGE_WIDTH * np.ptp(ends[:, 1]) / np.ptp(ends[:, 0]), 3.0)
    high = max(wall.built_height for wall in walls) * scale
    figure = Figure(figsize=(PAGE_WIDTH, plan + high + 1.0), layout="constrained")
    cells = figure.add_gridspec(2, len(walls), height_ratios=(plan, high), width_ratios=lengths)
    handles |= _draw_plan(figure.add_subplot(cells[0, :]), house)
    body_wall = layout.bodies.wall
    joint_wall = layout.contacts.wall[:n]
    left = layout.placing.left
    bodies = body_table(layout).assign(x_m=layout.bodies.x - left[body_wall])
    joints = joint_table(layout).assign(x_m=layout.contacts.x[:n] - left[joint_wall])
    is_slab = layout.bodies.course == SLAB_COURSE
    slabs = bodies[is_slab].sort_values("z_m")
    middle = np.abs(layout.contacts.y[:n]) < TINY
    for number, wall in enumerate(walls):
        ax = figure.add_subplot(cells[1, number])
        on_wall = slabs[[wall.name in slab.walls for slab in concrete]]
        on_wall = on_wall.assign(x_m=wall.length / 2, length_m=wall.length)
        labels, _ = draw_preview(
            ax,
            plan_of(wall, layout.options),
            pd.concat([bodies[(body_wall == number) & ~is_slab], on_wall]),
            joints[middle & (joint_wall == number)],
        )
        handles |= {handle.get_label(): handle for handle in labels}
        ax.set_title(wall.name, loc="left", fontsize="medium")
        ax.label_outer()
    title = f"house {house.name}: {len(bodies)} bodies, {n} contact points, "
    title += f"{layout.total_mass / 1e3:.3g} t; grey arrows: x of the walls"
    if any(corner.kind == "toothed" for corner in house.corners):
        title += "; ends that are missing are bricks of the other wall"
    return style.finish_in_scale(figure, [title], list(handles.values()), columns=6)


def _area(span):
    """Opposite corners in plan of a Span of timber, (2, 2) [m]."""
    return [
        placed.origin + along * placed.axes[0, :2]
        for placed, along in ((span.one, span.along[0]), (span.other, span.other_along[1]))
    ]


def _draw_plan(ax, house):
    """Draw the plan of a house; returns {label: handle} of a legend."""
    corners = np.array([wall.corners for wall in house.walls])
    low = corners.min(axis=(0, 1))
    high = corners.max(axis=(0, 1))
    handles = {}
    for floor in house.floors:
        handles |= _draw_floor(ax, house, floor)
    style.add_bodies(ax, corners, style.CAP_COLOUR, style.DARK)
    for placed in house.walls:
        _draw_wall(ax, placed)
    for ties in house.ties:
        handles |= _draw_ties(ax, house, ties)
    for corner in house.corners:
        handles |= _draw_corner(ax, house, corner)
    turn = np.radians(house.heading)
    middle = (low + high) / 2
    way = 0.15 * np.ptp(corners[..., 0]) * np.array([np.cos(turn), np.sin(turn)])
    ax.annotate("", middle + way, middle - way, arrowprops=ARROW | {"color": style.BLUE})
    ax.text(*middle, "motion", color=style.BLUE, **CENTRED)
    margin = 0.05 * (high - low).max()
    ax.set(
        xlim=(low[0] - margin, high[0] + margin),
        ylim=(low[1] - margin, high[1] + margin),
        aspect="equal",
        xlabel="x [m]",
        ylabel="y [m]",
        title=f"plan at {SECTION_M:g} m",
    )
    ax.title.set(fontsize="medium", ha="left", x=0.0)
    return handles


def _draw_floor(ax, house, floor):
    carrying = house.carrying(floor)
    colour = FLOORS[floor.kind]
    spans = floor.spans(carrying) if floor.kind == "timber" else []
    for area in [_area(span) for span in spans] or [outline(carrying) @ carrying[0].axes[:2, :2]]:
        (x0, y0), (x1, y1) = area
        style.add_bodies(ax, [[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]], colour)
    label = f"{floor.kind} floor at {floor.level:g} m"
    return {label: style.area_handle(colour, label)}


def _draw_wall(ax, placed):
    """Draw the openings in the plan, the name and the direction of a Placed wall."""
    (along, across) = placed.axes[:2, :2]
    wall = placed.wall
    half = across * wall.brick.thickness / 2
    for opening in wall.openings:
        if opening.sill <= SECTION_M < opening.sill + opening.height:
            span = placed.origin + np.outer([opening.left, opening.left + opening.width], along)
            gap = np.concatenate([span - half, span[::-1] + half])
            style.add_bodies(ax, [gap], "white", style.DARK)
    start = placed.origin + 0.08 * wall.length * along
    middle = placed.origin + wall.length / 2 * along
    turn = 90 - (90 - placed.direction) % 180  # from -90, left out, to 90
    ax.text(*middle, wall.name, rotation=turn, **CENTRED)
    ax.annotate("", start + 0.12 * wall.length * along, start, arrowprops=ARROW)


def _draw_ties(ax, house, ties):
    span = ties.span(house)
    for share in sorted({share for share, _ in ties.places(span)}):
        x, y = span.at(share).T[:2]
        ax.plot(x, y, color=style.VERMILLION, lw=0.8)
    return {"ties": style.line_handle(style.VERMILLION, "ties")}


def _draw_corner(ax, house, corner):
    first, second = (house.walls[house.names.index(name)] for name in corner.walls)
    axes = np.array([first.axes[0, :2], -second.axes[0, :2]]).T
    way = np.linalg.solve(axes, np.subtract(second.origin, first.origin))[0]
    place = first.origin + way * first.axes[0, :2]
    mark = MARKS[corner.kind]
    ax.plot(*place, mark, color=style.VERMILLION, ms=4)
    return {
        corner.kind: style.line_handle(
            style.VERMILLION, f"{corner.kind} corner", line="", marker=mark, ms=4
        )
    }
