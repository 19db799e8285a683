"""Pictures of a house: its walls unfolded with the cracks of both faces, the house in perspective,
walls and corners over time, and the house before it is run.

Each function returns a matplotlib Figure; `save_all` writes those of a History, of a plane wall,
too.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from damage.draw import run, style
from damage.draw.panels import PAGE_WIDTH, from_zero, grid, letter
from damage.draw.preview import PAPER, draw_preview
from damage.draw.wall import (
    LARGEST_MAGNIFICATION,
    line_width,
    round_125,
    shape_at,
    widest_line,
)
from damage.history.in_space import InSpace
from damage.history.info import origin
from damage.history.moments import (
    JOINT_STATES,
    check_samples,
    joint_states,
    nearest_snapshot,
    state_codes,
)
from damage.index import THRESHOLD
from damage.measure.house import corner_joints, corners_table, largest_index, walls_table
from damage.units import MILLIMETRE
from damage.wall.geometry import body_table, displaced, joint_table, kinds_of_bodies
from damage.wall.house import outline
from damage.wall.kinds import SLAB_COURSE, TINY
from damage.wall.placing import FACES
from damage.wall.plan import plan_of

COLOURS = style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.BLACK, style.ORANGE
LINES = [(colour, line) for line in ("-", "--", ":", "-.") for colour in COLOURS]
"""Colour and line of the walls, then of the corners, in their order."""
SIDES = np.array(
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [3, 2, 6, 7], [0, 3, 7, 4], [1, 2, 6, 5]]
)
"""Corners of the sides of a box, as of `damage.wall.placing.BOX`."""
ABOVE_DEG, BESIDE_DEG = 24.0, 35.0
"""Where one looks from: above the horizon, and beside the normal of the first wall."""
AWAY = 3.5  # distance of the eye from the middle of the house, over the radius of the house
OTHER_COLOUR = "0.85"
DARKEST = 0.8  # share of its colour that a side has which the light does not reach
FLOORS = {"concrete": style.BODY_COLOURS["slabs"], "timber": style.SAND}
SECTION_M = 1.0  # height of the plan
ARROW = {"arrowstyle": "->", "lw": 0.8, "color": style.DARK}
BEFORE_M = 0.001  # cracks before the bricks beside them
VISIBLE_SHARE = 0.05  # largest drawn displacement over the height of the house


def moment_of(history, sample):
    """Sample of "max" (of the largest index of a wall), "end" or a number, with that index, and the
    nearest snapshot or None."""
    check_samples(history)
    damage = largest_index(history)
    named = {"max": int(damage.argmax()), "end": len(damage) - 1}
    sample = int(named.get(sample, sample))
    time_s = history.series["time_s"].iloc[sample]
    return sample, float(damage[sample]), nearest_snapshot(history, time_s)


def cracks(space, sample, snapshot, magnify=1.0):
    """Cracks of both faces of all walls at a sample; space: InSpace.  Ends (n, 2, 3) [m], code of
    JOINT_STATES (n,), width (n,) [m], the face's normal (n, 3), and the bodies of the joint, -1 the
    ground (n, 2)."""
    history, house, codes = space.history, space.history.house, joint_states(space.history, sample)
    on_face = (house.joint_wall >= 0) & (np.abs(house.joint_y_m) > TINY)
    chosen = np.flatnonzero(on_face & (codes > JOINT_STATES.index("broken")))
    normals = history.placing.axes[house.joint_wall[chosen], 1]
    return (
        space.ends(snapshot, magnify, chosen),
        codes[chosen],
        widths(history, sample)[chosen],
        np.sign(house.joint_y_m[chosen])[:, None] * normals,
        space.joint_bodies[chosen],
    )


def widths(history, sample):
    """Crack widths of all contact points at a sample, (n_joints,) [m]."""
    return np.hypot(history.opening_m[sample], history.slip_by("displacement")[sample], dtype=float)


def magnification(space, snapshots):
    """Factor that makes the largest displacement in these snapshots visible, as
    `damage.draw.wall.magnification` does; space: InSpace."""
    largest = max(
        (float(np.abs(space.corners(one) - space.boxes).max()) for one in snapshots),
        default=0.0,
    )
    if largest == 0:
        return 1.0
    wanted = VISIBLE_SHARE * space.boxes[..., 2].max() / largest
    return round_125(min(max(wanted, 1.0), LARGEST_MAGNIFICATION))


# --- unfolded ------------------------------------------------------------------------------------


@style.styled
def elevation_picture(history, sample="max", magnify=None):
    """Figure of the walls of a house side by side, each from the side of its negative y, with the
    cracks of its face outside, and below of that inside; joints to other walls with both.

    sample: "max" (of the largest index of a wall), "end" or an index into the series; magnify:
    factor on displacements and rotations, None for one that makes them visible.
    """
    space = InSpace(history)
    sample, damage, snapshot = moment_of(history, sample)
    magnify = magnification(space, [snapshot]) if magnify is None else magnify
    parts = history.parts
    widths = [part.attributes["length_m"] for part in parts]
    height = max(part.attributes["height_m"] for part in parts)
    figure, axes = grid(2, len(parts), 1.0, sharey=True, width_ratios=widths)
    page_m = sum(widths) + 0.3 * len(widths)
    panel = (PAGE_WIDTH - 0.6) * height / page_m + 0.25
    figure.set_size_inches(PAGE_WIDTH, 2 * min(panel, 3.5) + 0.35)
    points = 72 * (PAGE_WIDTH - 0.6) / page_m * np.array([page_m, height])
    drawn = []
    for row, face in zip(axes, FACES):
        for number, (ax, part) in enumerate(zip(row, parts)):
            seen = part.of_face(face)
            one = shape_at(seen, sample, damage, magnify=magnify, snapshot=snapshot)
            one = _with_corners(one, history, number, sample, snapshot)
            drawn.append(one.on_page(points, (page_m, height)))
            style.add_bodies(
                ax,
                _of_other_walls(space, number, face, snapshot, magnify),
                OTHER_COLOUR,
                "0.75",
                0.2,
                zorder=0.5,
            )
            run.draw_wall(ax, drawn[-1])
            ax.label_outer()
            side = "+y" if history.placing.sign_of(face)[number] > 0 else "-y"
            ax.set_title(f"{part.wall}, {face} ({side})", loc="left", fontsize=7)
    every = replace(
        drawn[0],
        **{
            name: np.concatenate([getattr(one, name) for one in drawn])
            for name in ("kinds", "elastic", "crack_width_m")
        },
    )
    style.add_title(
        figure,
        history,
        _moment(history, sample, damage, snapshot, magnify),
        "all faces as seen from the wall's negative y",
    )
    handles = run.joint_handles(every)
    handles.append(style.area_handle(OTHER_COLOUR, "brick of the other wall", "0.75"))
    style.legend_below(figure, handles, 6)
    style.settle_layout(figure)
    return figure


def _moment(history, sample, damage, snapshot, magnify):
    time_s = history.series["time_s"].iloc[sample]
    shown = (
        "undeformed, no snapshot near"
        if snapshot is None
        else f"shape at {history.snapshot_time_s[snapshot]:.3f} s, displacements × {magnify:g}"
    )
    return f"{time_s:.3f} s, largest DI of a wall {damage:.3f}; {shown}"


def _of_other_walls(space, number, face, snapshot, magnify):
    """Ends of bricks of other walls in the corners of a wall, by its number, as its face shows
    them: (n, 4, 2) [m]."""
    history, placing = space.history, space.history.placing
    sign, half = placing.sign_of(face)[number], placing.thickness[number] / 2
    where = [
        placing.in_wall(number, space.corners(*how).reshape(-1, 3)).reshape(-1, 8, 3)
        for how in ((None,), (snapshot, magnify))
    ]
    low, high = where[0].min(axis=1), where[0].max(axis=1)
    start = placing.left[number]
    least, most = np.array([start, -half]), np.array([start + placing.length[number], half])
    within = np.minimum(high[:, :2], most) - np.maximum(low[:, :2], least) > TINY
    of_wall = history.house.body_depth_m < 2 * half + TINY  # floors are bodies of all their walls
    chosen = within.all(axis=1) & of_wall & (history.house.body_wall != number)
    sides = where[1][chosen][:, SIDES]
    seen = sides[np.arange(len(sides)), (sign * sides[..., 1]).mean(axis=2).argmax(axis=1)]
    return seen[..., [0, 2]] - [start, 0.0]


def _with_corners(shape, history, number, sample, snapshot):
    """A WallShape of a wall, by its number, with its joints to other walls."""
    house, placing, found = history.house, history.placing, []
    opening, offset = history.opening_m[sample], np.abs(history.slip_by("displacement")[sample])
    for walls, joints in corner_joints(history).items():
        if placing.names[number] not in walls:
            continue
        table = history.joints.iloc[joints]
        local = table[["x_m", "y_m", "z_m"]].to_numpy()
        of = np.full(len(local), placing.names.index(walls[0]))
        places = placing.in_wall(number, placing.in_house(of, local[:, None])[:, 0])
        for (first, second, _), rows in table.groupby(
            ["first_body", "second_body", "kind"], observed=True
        ).indices.items():
            low, high = places[rows].min(axis=0), places[rows].max(axis=0)
            if high[2] - low[2] > TINY:  # upright: seen from its edge, or in the middle of its face
                low[0] = high[0] = (low[0] + high[0]) / 2
            points = joints[rows]
            found.append(
                (
                    [low[[0, 2]], high[[0, 2]]],
                    first if house.body_wall[first] == number else second,
                    (opening[points] > THRESHOLD).any(),
                    (offset[points] > THRESHOLD).any(),
                    history.broken[sample, points].any(),
                    np.hypot(opening[points], offset[points]).max(),
                )
            )
    if not found:
        return shape
    ends, body, opened, slipped, broken, width = map(np.array, zip(*found))
    motion = (
        np.zeros((len(history.bodies), 3)) if snapshot is None else history.displacement[snapshot]
    )
    ends = displaced(history.bodies, motion, body.astype(int), ends, shape.magnification)
    return replace(
        shape,
        segments=np.concatenate([shape.segments, ends - [placing.left[number], 0.0]]),
        state=np.append(shape.state, state_codes(opened, slipped, broken)),
        elastic=np.append(shape.elastic, np.zeros(len(ends), bool)),
        crack_width_m=np.append(shape.crack_width_m, width),
    )


# --- in perspective ------------------------------------------------------------------------------


class Eye:
    """Perspective of a house from an azimuth in plan [deg]; middle [m] and radius [m] of what is
    seen."""

    def __init__(self, azimuth, middle, radius):
        turn, above = np.radians([azimuth, ABOVE_DEG])
        towards = [np.cos(above) * np.cos(turn), np.cos(above) * np.sin(turn), np.sin(above)]
        self.towards, self.right = np.array(towards), np.array([-np.sin(turn), np.cos(turn), 0.0])
        self.up = np.cross(self.towards, self.right)
        self.middle, self.distance = middle, AWAY * radius
        self.place = middle + self.distance * self.towards

    def project(self, places):
        """Places (..., 3) [m] on the picture, (..., 2) [m], in scale at the middle."""
        away = places - self.middle
        scale = self.distance / (self.distance - away @ self.towards)
        return np.stack([away @ self.right, away @ self.up], -1) * scale[..., None]

    def sees(self, places, normals):
        """Whether planes at places with normals (..., 3) show their fronts, (...,) bool."""
        return np.sum((self.place - places) * normals, axis=-1) > 0


def polygons(space, eye, sample, snapshot, magnify, widest_pt):
    """What a PolyCollection of an InSpace needs, from back to front: places [m], colours of faces
    and edges, widths [pt].

    Course by course upwards: as the eye is above all of them, a lower one hides nothing of a higher
    one; in a course from far to near.
    """
    bodies, corners = space.history.bodies, space.corners(snapshot, magnify)
    sides = corners[:, SIDES]  # (n_bodies, 6, 4, 3)
    outwards = sides.mean(axis=2) - corners.mean(axis=1, keepdims=True)
    seen = eye.sees(sides.mean(axis=2), outwards)
    of = np.nonzero(seen)[0]
    level = np.append(bodies["z_m"].round(3), -np.inf)
    near = np.append((corners.mean(axis=1) - eye.middle) @ eye.towards, -np.inf)
    normal = outwards[seen] / np.linalg.norm(outwards[seen], axis=1, keepdims=True)
    light = DARKEST + (1 - DARKEST) * np.clip(normal @ (eye.right / 2 + [0, 0, 0.9]), 0, 1)
    kinds = kinds_of_bodies(bodies["course"])[of]
    paint = np.array([to_rgb(style.BODY_COLOURS[kind]) for kind in kinds]) * light[:, None]
    ends, codes, width, normals, joined = cracks(space, sample, snapshot, magnify)
    visible = eye.sees(ends.mean(axis=1), normals)
    joined, codes, width = joined[visible], codes[visible], width[visible]
    colours = np.array([to_rgb(run.JOINT_COLOURS[state]) for state in JOINT_STATES])[codes]
    order = np.lexsort(
        (
            np.append(near[of], near[joined].max(axis=1) + BEFORE_M),
            np.append(level[of], level[joined].max(axis=1)),
        )
    )
    places = [*eye.project(sides[seen]), *eye.project(ends[visible])]
    return (
        [places[k] for k in order],
        np.concatenate([paint, colours])[order],
        np.concatenate([np.full_like(paint, 0.5), colours])[order],
        np.append(np.full(len(of), 0.15), line_width(width, widest_pt))[order],
    )


class Perspective:
    """Axes with a house in perspective: `show` draws a moment from an azimuth [deg]."""

    def __init__(self, ax, history, page_pt):
        self.space, placing = InSpace(history), history.placing
        places = self.space.boxes.reshape(-1, 3)
        self.low, self.high = places.min(axis=0), places.max(axis=0)
        self.middle = (self.low + self.high) / 2
        self.radius = float(np.linalg.norm(self.high - self.low) / 2)
        outside = placing.sign_of("outside")[0] * placing.axes[0, 1]
        self.azimuth = float(np.degrees(np.arctan2(outside[1], outside[0]))) + BESIDE_DEG
        span = 2 * self.radius
        brick_m = history.bodies["height_m"][history.bodies["course"] >= 0].min()
        self.widest_pt = widest_line(brick_m, (span, span), page_pt)
        self.ground, self.drawn = (ax.add_collection(PolyCollection([])) for _ in range(2))
        self.ground.set(facecolor=style.GROUND_COLOUR, edgecolor="none")
        self.drawn.set(joinstyle="round")
        self.ax = ax
        ax.set(aspect="equal")
        ax.axis("off")

    def show(self, sample, snapshot, magnify, azimuth=None):
        """Draw a sample and snapshot, with displacements by a factor."""
        azimuth = self.azimuth if azimuth is None else azimuth
        eye = Eye(azimuth, self.middle, self.radius)
        places, face, edge, width = polygons(
            self.space, eye, sample, snapshot, magnify, self.widest_pt
        )
        self.drawn.set_verts(places)
        self.drawn.set(facecolor=face, edgecolor=edge, linewidth=width)
        margin = 0.12 * self.radius
        (x0, y0), (x1, y1) = self.low[:2] - margin, self.high[:2] + margin
        ground = np.array([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)])
        self.ground.set_verts([eye.project(ground)])

    def fit(self, azimuths):
        """Set the limits of the axes to what is seen from these azimuths [deg]; returns height over
        width."""
        margin = 0.15 * self.radius
        low, high = self.low - margin, self.high + margin
        corners = np.array(np.meshgrid(*zip(low, high))).reshape(3, -1).T
        seen = np.concatenate(
            [Eye(one, self.middle, self.radius).project(corners) for one in azimuths]
        )
        low, high = seen.min(axis=0), seen.max(axis=0)
        self.ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        return (high[1] - low[1]) / (high[0] - low[0])


def legend_of(history, sample, widest_pt):
    """Handles of the states and widths of cracks, and of the kinds of bodies, of a house."""
    part = history.parts[0]
    one = shape_at(part, sample, 0.0, magnify=0.0)
    shape = replace(
        one,
        elastic=np.zeros(1, bool),
        kinds=kinds_of_bodies(history.bodies["course"]),
        crack_width_m=widths(history, sample),
        widest_pt=widest_pt,
    )
    unseen = {"intact", f"failed, ≤ {THRESHOLD / MILLIMETRE:g} mm"}
    return [one for one in run.joint_handles(shape) if one.get_label() not in unseen]


@style.styled
def space_picture(history, sample="max", magnify=None, azimuth=None):
    """Figure of a house in perspective, deformed and exaggerated, with the cracks of the faces that
    are seen.

    sample, magnify: as of `elevation_picture`; azimuth: in plan of the eye from x towards y [deg],
    None for one beside the normal of the first wall.
    """
    sample, damage, snapshot = moment_of(history, sample)
    figure, ax = style.new_figure(1.0)
    seen = Perspective(ax, history, (72 * style.COLUMN_WIDTH,) * 2)
    magnify = magnification(seen.space, [snapshot]) if magnify is None else magnify
    seen.show(sample, snapshot, magnify, azimuth)
    ratio = seen.fit([seen.azimuth if azimuth is None else azimuth])
    figure.set_size_inches(style.COLUMN_WIDTH, min(style.COLUMN_WIDTH * ratio, 4.5))
    style.add_title(figure, history, _moment(history, sample, damage, snapshot, magnify))
    style.legend_below(figure, legend_of(history, sample, seen.widest_pt), columns=3)
    style.settle_layout(figure)
    return figure


# --- over time -----------------------------------------------------------------------------------


@style.styled
def walls_picture(history):
    """Figure over time: damage index, drift along and across each wall, opening of the corners."""
    check_samples(history)
    walls, corners = walls_table(history), corners_table(history)
    names, pairs = history.placing.names, list(dict.fromkeys(corners["corner"]))
    n_panels = 3 + bool(pairs)
    figure, axes = style.new_figure(1.15 * n_panels, rows=n_panels, sharex=True)
    columns = (
        ("DI", 1.0, "DI [-]", "damage index"),
        ("drift_ratio", 100.0, "drift [%]", "drift along the wall"),
        ("drift_across_ratio", 100.0, "drift [%]", "drift across the wall"),
    )
    for number, (ax, (name, factor, label, words)) in enumerate(zip(axes, columns)):
        for wall, (colour, line) in zip(names, LINES):
            one = walls[walls["wall"] == wall]
            ax.plot(one["time_s"], factor * one[name], color=colour, ls=line, label=wall)
        ax.set_ylabel(label)
        letter(ax, number, words)
    handles = axes[0].get_lines()[:]
    if pairs:
        for pair, (colour, line) in zip(pairs, LINES[len(names) :]):
            one = corners[corners["corner"] == pair]
            axes[3].plot(
                one["time_s"], one["opening_m"] / MILLIMETRE, color=colour, ls=line, label=pair
            )
        axes[3].set_ylabel("opening [mm]")
        letter(axes[3], 3, "corners, widest opening")
        from_zero(axes[3])
        handles += axes[3].get_lines()[:]
    from_zero(axes[0])
    figure.align_ylabels()
    style.add_title(figure, history)
    marks = style.mark_times(history, axes)
    style.legend_below(figure, [*handles, *marks], columns=3)
    return figure


# --- before a run --------------------------------------------------------------------------------


@style.styled
def house_preview(layout):
    """Figure of a house before it is run: its plan, with corners and the direction of the motion,
    and its walls as `damage.draw.preview.wall_preview` draws them; layout: that of the House."""
    house, space, handles = layout.space.house, layout.space, {}
    walls, n = [one.wall for one in house.bearing], layout.n_joints
    concrete = [one for one in house.floors if one.kind == "concrete"]
    concrete.sort(key=lambda floor: floor.level)
    lengths = [wall.length for wall in walls]
    scale = (PAGE_WIDTH - 0.5) / (1.1 * sum(lengths))  # [inch/m] of the walls
    ends = np.concatenate([_outline(one) for one in house.walls])
    plan = min(PAGE_WIDTH * np.ptp(ends[:, 1]) / np.ptp(ends[:, 0]), 3.0)
    high = max(wall.built_height for wall in walls) * scale
    figure = Figure(figsize=(PAGE_WIDTH, plan + high + 1.0), layout="constrained")
    cells = figure.add_gridspec(2, len(walls), height_ratios=(plan, high), width_ratios=lengths)
    handles |= _draw_plan(figure.add_subplot(cells[0, :]), house)
    bodies, joints, middle = body_table(layout), joint_table(layout), np.abs(space.y[:n]) < TINY
    for number, wall in enumerate(walls):
        ax = figure.add_subplot(cells[1, number])
        on_wall = middle & (space.joint_wall[:n] == number)
        of = (space.wall == number) & (bodies["course"] != SLAB_COURSE).to_numpy()
        tables = [
            one.assign(x_m=one["x_m"] - space.left[number]) for one in (bodies[of], joints[on_wall])
        ]
        slabs = bodies[bodies["course"] == SLAB_COURSE].sort_values("z_m")
        slabs = slabs[[wall.name in one.walls for one in concrete]]
        slabs = slabs.assign(x_m=wall.length / 2, length_m=wall.length)
        tables[0] = pd.concat([tables[0], slabs])
        found, _ = draw_preview(ax, plan_of(wall, layout.options), *tables)
        handles |= {handle.get_label(): handle for handle in found}
        ax.set_title(wall.name, loc="left", fontsize=7)
        ax.label_outer()
    title = f"house {house.name}: {len(bodies)} bodies, {n} contact points, "
    title += f"{layout.total_mass / 1e3:.3g} t; grey arrows: x of the walls"
    if any(corner.kind == "toothed" for corner in house.corners):
        title += "; ends that are missing are bricks of the other wall"
    figure.suptitle(title, x=0.01, ha="left")
    style.legend_below(figure, list(handles.values()), columns=6)
    style.settle_layout(figure)
    return figure


def _outline(placed):
    """Corners of a Placed wall in plan, (4, 2) [m]."""
    along, across = placed.axes[:2, :2]
    half = across * placed.wall.brick.thickness / 2
    ends = np.array([placed.origin, placed.origin + along * placed.wall.length])
    return np.concatenate([ends - half, ends[::-1] + half])


def _area(span):
    """Opposite corners in plan of a Span of timber, (2, 2) [m]."""
    return [
        one.origin + along * one.axes[0, :2]
        for one, along in ((span.one, span.along[0]), (span.other, span.other_along[1]))
    ]


def _draw_plan(ax, house):
    """Draw the plan of a house; returns {label: handle} of a legend."""
    corners = np.array([_outline(one) for one in house.walls])
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    found = {}
    for floor in house.floors:
        carrying = house.carrying(floor)
        spans = floor.spans(carrying) if floor.kind == "timber" else []
        for area in [_area(one) for one in spans] or [outline(carrying) @ carrying[0].axes[:2, :2]]:
            (x0, y0), (x1, y1) = area
            style.add_bodies(ax, [[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]], FLOORS[floor.kind])
        label = f"{floor.kind} floor at {floor.level:g} m"
        found[label] = style.area_handle(FLOORS[floor.kind], label)
    style.add_bodies(ax, corners, style.CAP_COLOUR, style.DARK)
    for placed in house.walls:
        along, across = placed.axes[:2, :2]
        for opening in placed.wall.openings:
            if not opening.sill <= SECTION_M < opening.sill + opening.height:
                continue
            span = placed.origin + np.outer([opening.left, opening.left + opening.width], along)
            half = across * placed.wall.brick.thickness / 2
            style.add_bodies(
                ax, [np.concatenate([span - half, span[::-1] + half])], "white", style.DARK
            )
        start = placed.origin + 0.08 * placed.wall.length * along
        middle = placed.origin + placed.wall.length / 2 * along
        turn = 90 - (90 - placed.direction) % 180  # from -90, left out, to 90
        ax.text(*middle, placed.wall.name, ha="center", va="center", rotation=turn, bbox=PAPER)
        ax.annotate("", start + 0.12 * placed.wall.length * along, start, arrowprops=ARROW)
    marks = {"toothed": "s", "butted": "o"}
    for corner in house.corners:
        one, other = (house.walls[house.names.index(name)] for name in corner.walls)
        axes = np.array([one.axes[0, :2], -other.axes[0, :2]]).T
        way = np.linalg.solve(axes, np.subtract(other.origin, one.origin))[0]
        ax.plot(
            *(one.origin + way * one.axes[0, :2]), marks[corner.kind], color=style.VERMILLION, ms=4
        )
    turn, middle = np.radians(house.heading), (low + high) / 2
    way = 0.15 * np.ptp(corners[..., 0]) * np.array([np.cos(turn), np.sin(turn)])
    ax.annotate("", middle + way, middle - way, arrowprops=ARROW | {"color": style.BLUE})
    ax.text(*middle, "motion", color=style.BLUE, ha="center", va="center", bbox=PAPER)
    margin = 0.05 * (high - low).max()
    ax.set(
        xlim=(low[0] - margin, high[0] + margin),
        ylim=(low[1] - margin, high[1] + margin),
        aspect="equal",
        xlabel="x [m]",
        ylabel="y [m]",
        title=f"plan at {SECTION_M:g} m",
    )
    ax.title.set(fontsize=7, ha="left", x=0.0)
    return found | {
        kind: style.mark_handle(marks[kind], f"{kind} corner")
        for kind in dict.fromkeys(one.kind for one in house.corners)
    }


# --- files ---------------------------------------------------------------------------------------

PICTURES = {
    "elevation_max": partial(elevation_picture, sample="max"),
    "elevation_end": partial(elevation_picture, sample="end"),
    "space_max": partial(space_picture, sample="max"),
    "walls": walls_picture,
    "energy": run.energy_picture,
}
"""{file name without suffix: function that draws it} of a house."""


def save_all(history, folder):
    """Write all pictures of a History as PNG and PDF into `folder`, those of a house or of a wall;
    returns their paths."""
    if not history.is_house:
        return run.save_all(history, folder)
    return style.save_figures(
        ((name, draw(history)) for name, draw in PICTURES.items()), folder, origin(history)
    )
